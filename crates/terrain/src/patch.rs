//! A rectangle of cells that has changed since the map was made.

use std::{ops::Range, sync::Arc};

use serde::{Deserialize, Serialize};

use crate::{Cell, Error, Surfaces, Terrain, areas::Areas};

/// New values for a rectangle of cells, or other areas over the map; what is left out stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Row of the rectangle's southernmost cells. Default: 0.
    #[serde(default)]
    pub row: u64,
    /// Column of its westernmost cells. Default: 0.
    #[serde(default)]
    pub column: u64,
    /// Elevation by row and column, −11 000 to 22 000 or null [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elevation_m: Option<Vec<Vec<Option<f64>>>>,
    /// Surface names by row and column; null means the robot's default surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<Vec<Vec<Option<String>>>>,
    /// Obstacles by row and column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<Vec<Vec<bool>>>,
    /// Areas over the map in place of those that it has: a GeoJSON feature collection, of which one without features takes them away.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<Object>))]
    pub areas: Option<serde_json::Value>,
}

/// A rectangle of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellRange {
    /// Its rows.
    pub rows: Range<usize>,
    /// Its columns.
    pub columns: Range<usize>,
}

impl CellRange {
    fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.rows.clone().flat_map(|row| self.columns.clone().map(move |column| Cell { row, column }))
    }
}

impl Terrain {
    /// This ground with a rectangle of cells changed, and which cells those are.
    ///
    /// # Errors
    /// A patch without any layer, layers of different shapes, cells off the map, or an absurd elevation.
    pub fn patched(&self, patch: &Patch) -> Result<(Terrain, CellRange), Error> {
        let has_layers = patch.elevation_m.is_some() || patch.surface.is_some() || patch.obstacle.is_some();
        let changed = match &patch.areas {
            Some(_) if !has_layers => CellRange { rows: 0..self.grid.rows, columns: 0..self.grid.columns },
            _ => self.range_of(patch)?,
        };
        let mut terrain = self.clone();
        if let Some(rows) = &patch.elevation_m {
            let relative_m = Arc::make_mut(&mut terrain.relative_m);
            for (cell, value) in changed.cells().zip(rows.iter().flatten()) {
                if let Some(filled) = &mut terrain.filled {
                    Arc::make_mut(filled)[self.grid.index(cell)] = false;
                }
                let Some(value) = value else {
                    relative_m[self.grid.index(cell)] = f32::NAN;
                    continue;
                };
                let (min, max) = (Self::LOWEST_M, Self::HIGHEST_M);
                if !(min..=max).contains(value) {
                    let (row, column) = (cell.row - changed.rows.start, cell.column - changed.columns.start);
                    return Err(Error::Elevation { row, column, value: *value, min, max });
                }
                relative_m[self.grid.index(cell)] = (value - self.base_m) as f32;
            }
        }
        if let Some(rows) = &patch.obstacle {
            let obstacle = terrain.obstacle.get_or_insert_with(|| Arc::new(vec![false; self.grid.cells()]));
            let obstacle = Arc::make_mut(obstacle);
            for (cell, value) in changed.cells().zip(rows.iter().flatten()) {
                obstacle[self.grid.index(cell)] = *value;
            }
        }
        if let Some(rows) = &patch.surface {
            terrain.name_surfaces(&changed, rows.iter().flatten().map(Option::as_deref))?;
        }
        if let Some(areas) = &patch.areas {
            let areas = Areas::of(areas, &terrain)?;
            terrain = terrain.with_areas(areas);
        }
        Ok((terrain, changed))
    }

    /// The cells that a patch covers: all its layers have one shape, which lies on the map.
    fn range_of(&self, patch: &Patch) -> Result<CellRange, Error> {
        fn shape<T>(layer: &'static str, rows: Option<&Vec<Vec<T>>>) -> Option<(&'static str, Vec<usize>)> {
            rows.map(|rows| (layer, rows.iter().map(Vec::len).collect()))
        }
        let layers = [
            shape("elevation_m", patch.elevation_m.as_ref()),
            shape("surface", patch.surface.as_ref()),
            shape("obstacle", patch.obstacle.as_ref()),
        ];
        let mut layers = layers.into_iter().flatten();
        let Some((first, widths)) = layers.next() else { return Err(Error::EmptyPatch) };
        let (rows, columns) = (widths.len(), widths.first().copied().unwrap_or(0));
        if columns == 0 {
            return Err(Error::EmptyPatch);
        }
        for (layer, widths) in [(first, widths)].into_iter().chain(layers) {
            if widths.len() != rows {
                return Err(Error::RowCount { layer, found: widths.len(), expected: rows });
            }
            if let Some(row) = widths.iter().position(|width| *width != columns) {
                return Err(Error::RowLength { layer, row, found: widths[row], expected: columns });
            }
        }
        let range = |field: &'static str, first: u64, count: usize, limit: usize| {
            let end = usize::try_from(first).ok().and_then(|first| first.checked_add(count));
            match end.filter(|end| *end <= limit) {
                Some(end) => Ok(end - count..end),
                None => Err(Error::PatchOutside { field, first, count, limit }),
            }
        };
        Ok(CellRange {
            rows: range("row", patch.row, rows, self.grid.rows)?,
            columns: range("column", patch.column, columns, self.grid.columns)?,
        })
    }

    fn name_surfaces<'a>(
        &mut self,
        changed: &CellRange,
        names: impl Iterator<Item = Option<&'a str>>,
    ) -> Result<(), Error> {
        let unnamed = || Surfaces { names: Vec::new(), class: vec![Surfaces::UNNAMED; self.grid.cells()] };
        let surfaces = Arc::make_mut(self.surfaces.get_or_insert_with(|| Arc::new(unnamed())));
        for (cell, name) in changed.cells().zip(names) {
            surfaces.class[self.grid.index(cell)] = surfaces.class_of(name)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, synthetic};

    fn ground() -> Terrain {
        let grid = Grid { rows: 6, columns: 5, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        Terrain::new(grid, &synthetic::relief(grid, 3, 8.0, 2.0)).unwrap()
    }

    #[test]
    fn a_patch_changes_its_own_cells_and_no_others() {
        let before = ground();
        let patch = Patch {
            row: 4,
            column: 1,
            elevation_m: Some(vec![vec![Some(7.5), None], vec![Some(-1.0), Some(2.0)]]),
            obstacle: Some(vec![vec![false, false], vec![true, false]]),
            surface: Some(vec![vec![Some("mud".into()), None], vec![None, Some("mud".into())]]),
            areas: None,
        };
        let (after, changed) = before.patched(&patch).unwrap();
        assert_eq!((changed.rows, changed.columns), (4..6, 1..3));
        for index in 0..before.grid.cells() {
            let cell = before.grid.cell(index);
            let inside = cell.row >= 4 && (1..3).contains(&cell.column);
            if !inside {
                assert_eq!(after.elevation_m(cell), before.elevation_m(cell));
                assert_eq!((after.is_blocked(cell), after.surface_class(cell)), (false, Surfaces::UNNAMED));
            }
        }
        let at = |row, column| Cell { row, column };
        approx::assert_relative_eq!(after.elevation_m(at(4, 1)).unwrap(), 7.5, epsilon = 1e-6);
        assert_eq!(after.elevation_m(at(4, 2)), None);
        assert!(after.is_blocked(at(5, 1)) && !after.is_blocked(at(5, 2)));
        assert_eq!(after.surfaces().unwrap().names, ["mud"]);
        assert_eq!((after.surface_class(at(4, 1)), after.surface_class(at(4, 2))), (0, Surfaces::UNNAMED));
        assert_eq!(before, ground(), "the ground before is still there");
    }

    #[test]
    fn a_patch_that_does_not_fit_says_what_is_wrong() {
        let obstacle = |rows: Vec<Vec<bool>>| Patch { obstacle: Some(rows), ..Patch::default() };
        let refused = |patch: &Patch| ground().patched(patch).unwrap_err().to_string();
        assert!(refused(&Patch::default()).contains("elevation_m, surface or obstacle"));
        assert!(refused(&obstacle(vec![vec![true], vec![true, false]])).contains("obstacle[1] has 2 values"));
        let outside = Patch { row: 5, ..obstacle(vec![vec![true], vec![true]]) };
        assert!(refused(&outside).contains("row 5 and 2 more"), "{}", refused(&outside));
        let far = Patch { column: u64::MAX, ..obstacle(vec![vec![true]]) };
        assert!(refused(&far).contains("column"));
        let odd = Patch { elevation_m: Some(vec![vec![Some(1.0)]]), ..obstacle(vec![vec![true, true]]) };
        assert!(refused(&odd).contains("obstacle[0] has 2 values"));
        let high = Patch { elevation_m: Some(vec![vec![Some(1e6)]]), ..Patch::default() };
        assert!(refused(&high).contains("elevation_m[0][0]"));
    }
}
