//! Elevations out of samples of files: checked, counted from the lowest, and kept in single precision.

use rayon::prelude::*;

use crate::{Error, Grid, Terrain, Warning, WarningKind, fill_value};

/// Samples that are looked at by one task at a time.
const CHUNK: usize = 1 << 16;

/// A number that elevations come in.
pub(crate) trait Sample: Copy + Into<f64> + Send + Sync {
    /// Single-precision numbers out of samples, in their room if they fit it.
    fn to_single(samples: Vec<Self>, single: impl Fn(f64) -> f32 + Sync) -> Vec<f32>;
}

impl Sample for f32 {
    fn to_single(mut samples: Vec<Self>, single: impl Fn(f64) -> f32 + Sync) -> Vec<f32> {
        samples.par_chunks_mut(CHUNK).for_each(|chunk| {
            for sample in chunk {
                *sample = single(f64::from(*sample));
            }
        });
        samples
    }
}

impl Sample for f64 {
    fn to_single(samples: Vec<Self>, single: impl Fn(f64) -> f32 + Sync) -> Vec<f32> {
        samples.par_iter().map(|sample| single(*sample)).collect()
    }
}

impl Terrain {
    /// Builds ground from as many samples as a checked grid has cells; a function gives their elevations [m], NaN where unknown.
    /// Samples in single precision are turned into elevations where they lie. Samples that are elevations themselves may be
    /// conventional fill values that no ground has, which are unknown, with a warning.
    ///
    /// # Errors
    /// An absurd elevation, or no known cell at all.
    pub(crate) fn from_samples<T: Sample>(
        grid: Grid,
        samples: Vec<T>,
        elevation_m: impl Fn(f64) -> f64 + Sync,
    ) -> Result<Self, Error> {
        debug_assert_eq!(samples.len(), grid.cells());
        let survey = Survey::of(&grid, &samples, &elevation_m)?;
        let base_m = survey.lowest_m;
        let relative_m = if survey.unmarked == 0 {
            T::to_single(samples, |sample| (elevation_m(sample) - base_m) as f32)
        } else {
            T::to_single(samples, |sample| {
                let z_m = elevation_m(sample);
                if fill_value::is_never_ground(z_m) { f32::NAN } else { (z_m - base_m) as f32 }
            })
        };
        let terrain = Terrain::of_relative(grid, base_m, relative_m);
        Ok(match survey.warning() {
            Some(warning) => terrain.with_warning(warning),
            None => terrain,
        })
    }
}

/// What samples hold.
pub(crate) struct Survey {
    /// Lowest known elevation [m].
    pub(crate) lowest_m: f64,
    /// Conventional fill values that nothing marks: how many, and the first.
    unmarked: usize,
    first_unmarked: f64,
    /// The first sample whose elevation no ground has, and that elevation.
    absurd: Option<(usize, f64)>,
}

impl Survey {
    /// Looks at all samples.
    ///
    /// # Errors
    /// The first elevation that no ground has by its cell, or no known elevation.
    pub(crate) fn of<T: Sample>(
        grid: &Grid,
        samples: &[T],
        elevation_m: &(impl Fn(f64) -> f64 + Sync),
    ) -> Result<Self, Error> {
        let chunks = samples.par_chunks(CHUNK).enumerate();
        let parts: Vec<Survey> =
            chunks.map(|(i, chunk)| Self::of_chunk(i * CHUNK, chunk, elevation_m)).collect();
        let survey = parts.iter().fold(Self::empty(), Self::followed_by);
        if let Some((index, value)) = survey.absurd {
            let (min, max) = (Terrain::LOWEST_M, Terrain::HIGHEST_M);
            let cell = grid.cell(index);
            return Err(Error::Elevation { row: cell.row, column: cell.column, value, min, max });
        }
        if survey.lowest_m.is_infinite() { Err(Error::AllUnknown) } else { Ok(survey) }
    }

    fn empty() -> Self {
        Survey { lowest_m: f64::INFINITY, unmarked: 0, first_unmarked: f64::NAN, absurd: None }
    }

    fn of_chunk<T: Sample>(start: usize, chunk: &[T], elevation_m: impl Fn(f64) -> f64) -> Self {
        let mut survey = Self::empty();
        for (piece, first) in chunk.chunks(LANES * 32).zip((start..).step_by(LANES * 32)) {
            match lowest_plain_m(piece, &elevation_m) {
                Some(lowest_m) => survey.lowest_m = survey.lowest_m.min(lowest_m),
                None => survey.look_at_each(first, piece, &elevation_m),
            }
        }
        survey
    }

    fn look_at_each<T: Sample>(&mut self, first: usize, piece: &[T], elevation_m: impl Fn(f64) -> f64) {
        for (index, sample) in piece.iter().enumerate() {
            let z_m = elevation_m((*sample).into());
            if Terrain::holds(z_m) && !fill_value::is_never_ground(z_m) {
                self.lowest_m = self.lowest_m.min(z_m);
            } else if fill_value::is_never_ground(z_m) {
                if self.unmarked == 0 {
                    self.first_unmarked = z_m;
                }
                self.unmarked += 1;
            } else if !z_m.is_nan() {
                self.absurd = self.absurd.or(Some((first + index, z_m)));
            }
        }
    }

    fn followed_by(self, next: &Self) -> Self {
        Survey {
            lowest_m: self.lowest_m.min(next.lowest_m),
            first_unmarked: if self.unmarked > 0 { self.first_unmarked } else { next.first_unmarked },
            unmarked: self.unmarked + next.unmarked,
            absurd: self.absurd.or(next.absurd),
        }
    }

    /// A warning of fill values that nothing marks.
    pub(crate) fn warning(&self) -> Option<Warning> {
        let (first, cells) = (self.first_unmarked, self.unmarked);
        let word = if cells == 1 { "cell holds" } else { "cells hold" };
        (cells > 0).then(|| {
            let detail = format!(
                "{cells} {word} {first:?}, a value by which programs mark missing ground and which no header marks here: taken as unknown ground"
            );
            Warning::new(WarningKind::UnmarkedNodata, detail)
        })
    }
}

/// Samples that are compared side by side.
const LANES: usize = 8;

/// The lowest elevation of a piece in which every sample is one beyond doubt: none unknown, absurd or a fill value. Without
/// branches, so that it is done several samples at a time.
fn lowest_plain_m<T: Sample>(piece: &[T], elevation_m: impl Fn(f64) -> f64) -> Option<f64> {
    let mut lowest_m = [f64::INFINITY; LANES];
    let mut all_plain = [true; LANES];
    let (samples, rest) = piece.as_chunks::<LANES>();
    let mut look = |lane: usize, sample: T| {
        let z_m = elevation_m(sample.into());
        all_plain[lane] &= z_m.abs() < fill_value::LEAST_MAGNITUDE;
        lowest_m[lane] = if z_m < lowest_m[lane] { z_m } else { lowest_m[lane] };
    };
    for samples in samples {
        for (lane, sample) in samples.iter().enumerate() {
            look(lane, *sample);
        }
    }
    rest.iter().for_each(|sample| look(0, *sample));
    let is_plain = all_plain.iter().all(|plain| *plain);
    is_plain.then(|| lowest_m.iter().copied().fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_survey_by_pieces_finds_what_a_look_at_each_sample_finds(
            mut samples in prop::collection::vec(-500.0..9000.0f64, 1..2000),
            odd in prop::collection::vec((any::<prop::sample::Index>(), 0..5usize), 0..4),
        ) {
            for (index, kind) in odd {
                *index.get_mut(&mut samples) = [f64::NAN, -9999.0, 1e38, 30_000.0, -10_500.0][kind];
            }
            let mut each = Survey::empty();
            each.look_at_each(7, &samples, |z| z);
            let pieces = Survey::of_chunk(7, &samples, |z| z);
            prop_assert_eq!(pieces.lowest_m, each.lowest_m);
            prop_assert_eq!(pieces.unmarked, each.unmarked);
            prop_assert_eq!(pieces.first_unmarked.to_bits(), each.first_unmarked.to_bits());
            prop_assert_eq!(pieces.absurd, each.absurd);
        }
    }
}
