//! Unknown ground that is driven on all the same: as what, and at what risk.

use std::sync::Arc;

use super::{AreaError, zones::Zones};
use crate::{Cell, Error, Surfaces, Terrain, Warning, WarningKind, fill_voids::WIDEST_VOID_M};

/// What unknown ground is taken for where the robot may drive on it.
#[derive(Clone, Debug, PartialEq)]
pub struct UnknownGround {
    /// What it is made of: a name that the robot knows; the robot's default where none is given.
    pub surface: Option<String>,
    /// What a metre of it weighs besides what it takes, for what may lie there, 0 or more [J/m].
    pub risk_j_per_m: f64,
}

impl UnknownGround {
    /// Largest risk [J/m].
    pub const LARGEST_RISK_J_PER_M: f64 = 1e5;
}

impl Terrain {
    /// This ground with its unknown cells open to the robot when it is driven on, and a warning that says so.
    ///
    /// # Errors
    /// A risk below nothing or beyond the largest.
    pub fn with_unknown_ground(mut self, unknown: UnknownGround) -> Result<Self, AreaError> {
        let (risk, most) = (unknown.risk_j_per_m, UnknownGround::LARGEST_RISK_J_PER_M);
        if !(0.0..=most).contains(&risk) {
            let what = format!("is {risk}, but must be a number from 0 to {most}");
            return Err(AreaError { at: "unknown_ground.risk_j_per_m".to_owned(), what });
        }
        let cells = self.relative_m.iter().filter(|z| z.is_nan()).count();
        if cells == 0 {
            return Ok(self);
        }
        let detail = format!(
            "{cells} cells of unknown ground are open to the robot: their elevations are guessed from the ground around them, and nothing tells what lies there"
        );
        self = self.with_warning(Warning::new(WarningKind::UnknownGround, detail));
        self.unknown_ground = Some(Arc::new(unknown));
        Ok(self)
    }

    /// Fills unknown ground and marks it with its surface and risk.
    pub(super) fn open_unknown(
        &mut self,
        unknown: &UnknownGround,
        zones: &mut Zones,
        is_over: &dyn Fn() -> bool,
    ) -> Result<(), Error> {
        let cells: Vec<usize> = (0..self.grid.cells()).filter(|i| self.relative_m[*i].is_nan()).collect();
        // Across holes by lines from side to side, and what is left from the ground beside it.
        let across = self.clone().with_filled_voids(WIDEST_VOID_M)?;
        self.relative_m = across.relative_m;
        self.spread(is_over)?;
        let mut filled = self.filled.as_ref().map_or_else(|| vec![false; self.grid.cells()], |f| f.to_vec());
        cells.iter().for_each(|cell| filled[*cell] = true);
        self.filled = Some(Arc::new(filled));
        let risky = zones.risky(unknown.risk_j_per_m);
        cells.iter().for_each(|cell| zones.rule[*cell] = risky);
        if let Some(name) = &unknown.surface {
            let unnamed =
                || Surfaces { names: Vec::new(), class: vec![Surfaces::UNNAMED; self.grid.cells()] };
            let surfaces = Arc::make_mut(self.surfaces.get_or_insert_with(|| Arc::new(unnamed())));
            let class = surfaces.class_of(Some(name))?;
            cells.iter().for_each(|cell| surfaces.class[*cell] = class);
        }
        Ok(())
    }

    /// Gives unknown cells the mean of what is known beside them, ring by ring from the known ground outwards.
    fn spread(&mut self, is_over: &dyn Fn() -> bool) -> Result<(), Error> {
        let grid = self.grid;
        let relative_m = Arc::make_mut(&mut self.relative_m);
        let beside = |cell: Cell| {
            let rows = cell.row.saturating_sub(1)..(cell.row + 2).min(grid.rows);
            let columns = cell.column.saturating_sub(1)..(cell.column + 2).min(grid.columns);
            rows.flat_map(move |row| columns.clone().map(move |column| grid.index(Cell { row, column })))
        };
        let is_rim = |relative_m: &[f32], index: usize| {
            relative_m[index].is_nan() && beside(grid.cell(index)).any(|near| !relative_m[near].is_nan())
        };
        let mut rim: Vec<usize> = (0..grid.cells()).filter(|index| is_rim(relative_m, *index)).collect();
        while !rim.is_empty() {
            if is_over() {
                return Err(Error::OutOfTime);
            }
            let mean_m = |index: &usize| {
                let known: Vec<f32> =
                    beside(grid.cell(*index)).map(|near| relative_m[near]).filter(|z| !z.is_nan()).collect();
                (*index, known.iter().sum::<f32>() / known.len() as f32)
            };
            let found: Vec<(usize, f32)> = rim.iter().map(mean_m).collect();
            found.iter().for_each(|(index, z_m)| relative_m[*index] = *z_m);
            let mut next: Vec<usize> = rim
                .iter()
                .flat_map(|index| beside(grid.cell(*index)))
                .filter(|near| relative_m[*near].is_nan())
                .collect();
            next.sort_unstable();
            next.dedup();
            rim = next;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    #[test]
    fn unknown_ground_is_guessed_from_around_and_marked() {
        let grid = Grid { rows: 8, columns: 8, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        // A plane with a hole within and a corner without.
        let z: Vec<f64> = (0..64)
            .map(|i| grid.cell(i))
            .map(|c| match (c.row, c.column) {
                (3 | 4, 3 | 4) | (6 | 7, 6 | 7) => f64::NAN,
                _ => 10.0 + c.column as f64 * 0.1,
            })
            .collect();
        let unknown = UnknownGround { surface: Some("grass".into()), risk_j_per_m: 12.0 };
        let terrain = Terrain::new(grid, &z).unwrap().with_unknown_ground(unknown).unwrap();
        assert!(terrain.is_blocked(Cell { row: 3, column: 3 }), "only when it is driven on");
        assert!(terrain.warnings()[0].detail.starts_with("8 cells"));
        let driven = terrain.as_driven(&|| false).unwrap();
        for (index, known_m) in z.iter().enumerate() {
            let (cell, zones) = (grid.cell(index), driven.zones().unwrap());
            let was_unknown = known_m.is_nan();
            let plane_m = 10.0 + cell.column as f64 * 0.1;
            let off_m = (driven.elevation_m(cell).unwrap() - plane_m).abs();
            assert!(off_m < if cell.row >= 6 { 0.15 } else { 1e-5 }, "{cell:?}: {off_m}");
            let risk = zones.rules[usize::from(zones.rule[index])].risk_j_per_m;
            assert_eq!(risk, if was_unknown { 12.0 } else { 0.0 });
            assert_eq!(driven.filled().unwrap()[index], was_unknown);
            assert_eq!(driven.surface_class(cell) == 0, was_unknown);
        }
    }
}
