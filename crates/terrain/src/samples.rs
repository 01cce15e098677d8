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
        samples.par_iter_mut().for_each(|sample| *sample = single(f64::from(*sample)));
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
        let single = |sample| {
            let z_m = elevation_m(sample);
            if fill_value::is_never_ground(z_m) { f32::NAN } else { (z_m - base_m) as f32 }
        };
        let terrain = Terrain::of_relative(grid, base_m, T::to_single(samples, single));
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
        for (index, sample) in chunk.iter().enumerate() {
            let z_m = elevation_m((*sample).into());
            if Terrain::holds(z_m) && !fill_value::is_never_ground(z_m) {
                survey.lowest_m = survey.lowest_m.min(z_m);
            } else if fill_value::is_never_ground(z_m) {
                if survey.unmarked == 0 {
                    survey.first_unmarked = z_m;
                }
                survey.unmarked += 1;
            } else if !z_m.is_nan() {
                survey.absurd = survey.absurd.or(Some((start + index, z_m)));
            }
        }
        survey
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
