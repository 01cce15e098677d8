//! Cells of a value that stands for unknown ground, as whoever sent the map says.

use std::sync::Arc;

use crate::{Error, Terrain, Warning, WarningKind, fill_value};

impl Terrain {
    /// The ground with all cells of an elevation unknown, and a warning of how many there were.
    ///
    /// # Errors
    /// A value that is no number, or that every known cell has.
    pub fn with_nodata(self, nodata_m: f64) -> Result<Self, Error> {
        if nodata_m.is_nan() {
            return Err(Error::Nodata { value: nodata_m });
        }
        // A file may have kept the value in single precision.
        let marks = [nodata_m, f64::from(nodata_m as f32)].map(|mark| (mark - self.base_m) as f32);
        let is_marked = |z: &f32| marks.contains(z);
        let cells = self.relative_m.iter().filter(|z| is_marked(z)).count();
        let detail = match cells {
            // Unknown already, by the reader.
            0 if fill_value::is_never_ground(nodata_m) || !Self::holds(nodata_m) => return Ok(self),
            0 => format!("no cell holds {nodata_m}, which nodata was said to be"),
            1 => format!("1 cell of {nodata_m} was taken as unknown ground, as nodata was said to be"),
            _ => {
                format!("{cells} cells of {nodata_m} were taken as unknown ground, as nodata was said to be")
            }
        };
        let terrain = self.with_warning(Warning::new(WarningKind::GivenNodata, detail));
        if cells == 0 {
            return Ok(terrain);
        }
        terrain.without(is_marked)
    }

    /// Whether an elevation is one that ground may have.
    pub(crate) fn holds(elevation_m: f64) -> bool {
        (Self::LOWEST_M..=Self::HIGHEST_M).contains(&elevation_m)
    }

    /// The ground with some cells unknown, counted from the lowest of those that are left.
    fn without(mut self, is_marked: impl Fn(&f32) -> bool) -> Result<Self, Error> {
        let known = self.relative_m.iter().filter(|z| !z.is_nan() && !is_marked(z));
        let lowest_m = known.copied().fold(f32::INFINITY, f32::min);
        if lowest_m.is_infinite() {
            return Err(Error::AllUnknown);
        }
        for z in Arc::make_mut(&mut self.relative_m) {
            *z = if is_marked(z) { f32::NAN } else { *z - lowest_m };
        }
        self.base_m += f64::from(lowest_m);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Grid};

    #[test]
    fn cells_of_the_value_are_unknown_and_counted() {
        let grid = Grid { rows: 1, columns: 4, cell_size_m: 1.0, origin_m: [0.0; 2] };
        let terrain = Terrain::new(grid, &[0.0, 300.0, 0.0, 301.5]).unwrap();
        let told = terrain.clone().with_nodata(0.0).unwrap();
        assert_eq!(told.base_m(), 300.0);
        let z: Vec<Option<f64>> = (0..4).map(|column| told.elevation_m(Cell { row: 0, column })).collect();
        assert_eq!(z, [None, Some(300.0), None, Some(301.5)]);
        assert!(told.warnings()[0].detail.starts_with("2 cells of 0"), "{:?}", told.warnings());
        let none = terrain.clone().with_nodata(7.0).unwrap();
        assert!(none.warnings()[0].detail.starts_with("no cell holds 7"), "{:?}", none.warnings());
        assert!(terrain.with_nodata(f64::NAN).is_err());
        let level = Terrain::new(grid, &[5.0; 4]).unwrap();
        assert!(matches!(level.with_nodata(5.0), Err(Error::AllUnknown)));
    }

    #[test]
    fn a_value_kept_in_single_precision_is_met() {
        let grid = Grid { rows: 1, columns: 2, cell_size_m: 1.0, origin_m: [0.0; 2] };
        let terrain = Terrain::new(grid, &[f64::from(-12.3f32), 300.1]).unwrap();
        assert_eq!(terrain.with_nodata(-12.3).unwrap().elevation_m(Cell { row: 0, column: 0 }), None);
    }
}
