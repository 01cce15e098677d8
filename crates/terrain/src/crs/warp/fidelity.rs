//! What warping changed: heights of the source against the warped ground's at the source's own cell centres.

use std::fmt;

use rayon::prelude::*;

use super::{DegreeFrame, Lattice, WarpRefusal};
use crate::{Cell, Terrain, crs::Earth};

/// Differences of heights at the source's cell centres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fidelity {
    /// Centres where both are known.
    cells: usize,
    /// Centres that the source knows and the warped ground does not.
    lost: usize,
    /// Sum of the differences' squares [m²].
    squares_m2: f64,
    largest_m: f64,
}

impl Fidelity {
    /// Reads the warped ground back, bilinear, at every known cell of the source.
    ///
    /// # Errors
    /// A place that the projection does not reach.
    pub(super) fn of(
        frame: &DegreeFrame,
        source: &Terrain,
        warped: &Terrain,
        earth: &Earth,
    ) -> Result<Self, WarpRefusal> {
        let place = |[column, row]: [f64; 2]| {
            let place_m =
                earth.place_m(frame.place_deg([column + 0.5, row + 0.5])).map_err(WarpRefusal::Projection)?;
            Ok([0, 1].map(|axis| (place_m[axis] - warped.grid.origin_m[axis]) / warped.grid.cell_size_m))
        };
        let places = Lattice::of(frame.size, &place)?;
        let [west_m, south_m] = warped.grid.origin_m;
        let of_row = |row: usize| {
            let mut fidelity = Fidelity::default();
            for column in 0..frame.size.columns {
                let Some(height_m) = source.elevation_m(Cell { row, column }) else { continue };
                let [x, y] = places.at(column as f64, row as f64);
                let cell_m = warped.grid.cell_size_m;
                fidelity.add(height_m, warped.elevation_at_m(west_m + x * cell_m, south_m + y * cell_m));
            }
            fidelity
        };
        // Rows are summed in their order, whatever the number of threads.
        let rows: Vec<Fidelity> = (0..frame.size.rows).into_par_iter().map(of_row).collect();
        Ok(rows.iter().fold(Fidelity::default(), Fidelity::with))
    }

    fn add(&mut self, height_m: f64, warped_m: Option<f64>) {
        let Some(warped_m) = warped_m else {
            self.lost += 1;
            return;
        };
        let off_m = (warped_m - height_m).abs();
        self.cells += 1;
        self.squares_m2 += off_m * off_m;
        self.largest_m = self.largest_m.max(off_m);
    }

    fn with(self, next: &Self) -> Self {
        Fidelity {
            cells: self.cells + next.cells,
            lost: self.lost + next.lost,
            squares_m2: self.squares_m2 + next.squares_m2,
            largest_m: self.largest_m.max(next.largest_m),
        }
    }
}

impl fmt::Display for Fidelity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.cells == 0 {
            return f.write_str("no cell of the file can be read back there, so that the error is not known");
        }
        let rms_m = (self.squares_m2 / self.cells as f64).sqrt();
        write!(
            f,
            "read back at the file's own cell centres they are off by {rms_m:.3} m (RMS), {:.3} m at most",
            self.largest_m
        )?;
        if self.lost > 0 {
            write!(f, "; {} cells at the border or beside unknown ground cannot be read back", self.lost)?;
        }
        Ok(())
    }
}
