//! Rows in which a robot stands although its wheel speeds say that they move a little: noise about nothing.

use std::ops::Range;

use model::Sides;

use crate::{
    Error,
    drives::Drives,
    row::{Row, STANDSTILL_MPS},
    watch::{ROWS_A_LOOK, Watched},
};

/// Time on each side of a row over which noise is averaged away \[s\].
const AROUND_S: f64 = 0.5;
/// Averages of rim speeds below this are as good as none \[m/s\]: what is looked at for how noisy speeds are when a robot stands.
const SLOW_MPS: f64 = 0.02;
/// Rows that tell how noisy speeds are when a robot stands.
const LEAST_ROWS: usize = 20;
/// Standard deviations within which what is measured is nothing.
const SIGMAS: f64 = 4.0;
/// Median of the magnitude of normal noise over its standard deviation.
const MEDIAN_OF_NORMAL: f64 = 0.6745;
/// Second differences of white noise over it: √(1 + 4 + 1).
const OF_SECOND_DIFFERENCES: f64 = 2.449_489_742_783_178;

/// Rim speeds of rows in which the robot stands but for noise become nothing.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub(crate) fn settle(drives: &mut Drives) -> Result<(), Error> {
    let stretches: Vec<Range<usize>> = drives.stretches.iter().map(|stretch| stretch.rows.clone()).collect();
    let Some(sigma_mps) = noise_mps(&drives.rows, &stretches, &drives.watch)? else { return Ok(()) };
    for rows in stretches {
        settle_stretch(&mut drives.rows[rows], sigma_mps, &drives.watch)?;
    }
    Ok(())
}

/// Noise of rim speeds while a robot hardly moves \[m/s\]; `None` where that is told by too few rows, or is nothing worth a word.
fn noise_mps(rows: &[Row], stretches: &[Range<usize>], watch: &Watched) -> Result<Option<f64>, Error> {
    let mut seconds_mps = Vec::new();
    for stretch in stretches {
        let rows = &rows[stretch.clone()];
        for i in 1..rows.len().saturating_sub(1) {
            if i.is_multiple_of(ROWS_A_LOOK) {
                watch.go_on()?;
            }
            let (before, after) = (mean(rows, before(rows, i)), mean(rows, after(rows, i)));
            if [before.left, before.right, after.left, after.right].iter().all(|mps| mps.abs() < SLOW_MPS) {
                let at = |side: fn(&Row) -> f64| {
                    (side(&rows[i - 1]) - 2.0 * side(&rows[i]) + side(&rows[i + 1])).abs()
                };
                seconds_mps.extend([at(|row| row.rim_mps.left), at(|row| row.rim_mps.right)]);
            }
        }
    }
    if seconds_mps.len() < 2 * LEAST_ROWS {
        return Ok(None);
    }
    let middle = seconds_mps.len() / 2;
    let median_mps = *seconds_mps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let sigma_mps = median_mps / (MEDIAN_OF_NORMAL * OF_SECOND_DIFFERENCES);
    Ok((SIGMAS * sigma_mps > STANDSTILL_MPS).then_some(sigma_mps))
}

fn settle_stretch(rows: &mut [Row], sigma_mps: f64, watch: &Watched) -> Result<(), Error> {
    let is_nothing = |mps: Sides<f64>, count: usize| {
        let least_mps = (SIGMAS * sigma_mps / (count as f64).sqrt()).max(STANDSTILL_MPS);
        mps.left.abs() < least_mps && mps.right.abs() < least_mps
    };
    let stands = |i: usize| {
        let on_a_side = |range: Range<usize>| is_nothing(mean(rows, range.clone()), range.len());
        is_nothing(rows[i].rim_mps, 1) && (on_a_side(before(rows, i)) || on_a_side(after(rows, i)))
    };
    let mut standing: Vec<usize> = Vec::new();
    for piece in watch.pieces(0..rows.len()) {
        standing.extend(piece?.filter(|i| stands(*i)));
    }
    for i in standing {
        rows[i].rim_mps = Sides::both(0.0);
    }
    Ok(())
}

/// A row and those shortly before.
fn before(rows: &[Row], i: usize) -> Range<usize> {
    let from = rows[..i].iter().rposition(|row| rows[i].t_s - row.t_s > AROUND_S).map_or(0, |last| last + 1);
    from..i + 1
}

/// A row and those shortly after.
fn after(rows: &[Row], i: usize) -> Range<usize> {
    let count = rows[i..].iter().take_while(|row| row.t_s - rows[i].t_s <= AROUND_S).count();
    i..i + count
}

fn mean(rows: &[Row], range: Range<usize>) -> Sides<f64> {
    let count = range.len().max(1) as f64;
    let sum =
        rows[range].iter().fold([0.0; 2], |sum, row| [sum[0] + row.rim_mps.left, sum[1] + row.rim_mps.right]);
    Sides { left: sum[0] / count, right: sum[1] / count }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten rows a second: rises to a speed and back to nothing, stands, and so on, with noise.
    fn rows(noise_mps: f64) -> Vec<Row> {
        let row = |i: usize| {
            let phase = (i % 100) as f64 / 10.0;
            let mps = if phase < 4.0 { 0.4 * (std::f64::consts::PI * phase / 4.0).sin() } else { 0.0 };
            // Of unit variance, and like nothing else.
            let noise = |k: usize| {
                let x = ((i * 7 + k * 31) as f64 * 12.9898).sin() * 43_758.545_3;
                (x - x.floor() - 0.5) * 12.0_f64.sqrt()
            };
            let rim_mps = Sides { left: mps + noise_mps * noise(0), right: mps + noise_mps * noise(1) };
            Row { t_s: i as f64 / 10.0, rim_mps, ..Row::default() }
        };
        (0..1000).map(row).collect()
    }

    fn settled(noise_mps: f64) -> Vec<Row> {
        let mut rows = rows(noise_mps);
        let (all, watch) = (0..rows.len(), Watched::default());
        if let Some(sigma_mps) = super::noise_mps(&rows, std::slice::from_ref(&all), &watch).unwrap() {
            settle_stretch(&mut rows, sigma_mps, &watch).unwrap();
        }
        rows
    }

    #[test]
    fn a_robot_that_stands_but_for_noise_stands_and_one_that_moves_does_not() {
        for noise_mps in [0.003, 0.007, 0.02] {
            let rows = settled(noise_mps);
            let is_standing = |i: &usize| i % 100 >= 42 && i % 100 < 98;
            let standing = (0..1000).filter(is_standing);
            let [of, still] =
                standing.fold([0, 0], |[of, still], i| [of + 1, still + usize::from(rows[i].stands())]);
            assert!(still * 100 >= of * 98, "{noise_mps}: {still} of {of}");
            let moving = (0..1000).filter(|i| (4..36).contains(&(i % 100)));
            assert_eq!(moving.filter(|i| rows[*i].stands()).count(), 0, "{noise_mps}");
        }
    }

    #[test]
    fn its_noise_is_that_of_the_rows_in_which_it_stands() {
        let rows = rows(0.01);
        let all = 0..rows.len();
        let sigma_mps =
            super::noise_mps(&rows, std::slice::from_ref(&all), &Watched::default()).unwrap().unwrap();
        assert!((sigma_mps / 0.01 - 1.0).abs() < 0.25, "{sigma_mps}");
    }

    #[test]
    fn encoders_that_are_still_and_drives_that_never_stand_are_left_alone() {
        assert_eq!(settled(0.0), rows(0.0));
        let mut creeping = rows(0.01);
        creeping.iter_mut().for_each(|row| row.rim_mps = row.rim_mps.map(|mps| mps + 0.05));
        let all = 0..creeping.len();
        assert_eq!(
            super::noise_mps(&creeping, std::slice::from_ref(&all), &Watched::default()).unwrap(),
            None
        );
    }
}
