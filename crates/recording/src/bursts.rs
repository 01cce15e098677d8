//! Times at which samples arrived in bursts, spread over the time between the bursts.
//!
//! A sample that has no stamp of its own has the time at which it was received or written. Where a driver, a network or a buffer hands on
//! several at once, these times stand close together and then pause; the samples were taken evenly all the while.

use crate::{Recording, Repair, gap};

/// Longest time from burst to burst \[s\]: buffers and polls are emptied more often, and longer pauses are those of a drive.
const LONGEST_PERIOD_S: f64 = 2.0;

/// Fewer times show no bursts.
const LEAST_TIMES: usize = 20;

/// Share of a period that a burst lasts at most: samples of an even rhythm lie farther apart.
const BURST_SHARE: f64 = 0.2;

/// A step shorter than this share of the period is one within a burst.
const STEP_SHARE: f64 = 0.25;

/// Fewest samples of a burst: of two at once, the median step is still that from one pair to the next, and pairs may have two senders.
const LEAST_SIZE: usize = 3;

/// Share of the samples that have to lie in such bursts.
const LEAST_SHARE: f64 = 0.8;

/// Samples that arrived in bursts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bursts {
    /// Evenly spread times \[s\].
    pub(crate) t_s: Vec<f64>,
    /// Number of bursts.
    pub(crate) count: usize,
    /// Median time from burst to burst \[s\].
    pub(crate) period_s: f64,
}

impl Bursts {
    /// The bursts of times that never go back; `None` where they have an even rhythm or another one.
    pub(crate) fn of(t_s: &[f64]) -> Option<Bursts> {
        if t_s.len() < LEAST_TIMES {
            return None;
        }
        let steps_s: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let period_s = step_of_half_the_time(&steps_s).filter(|period_s| *period_s <= LONGEST_PERIOD_S)?;
        // The first of each burst.
        let is_first = |at: &usize| *at == 0 || steps_s[at - 1] >= STEP_SHARE * period_s;
        let mut begins: Vec<usize> = (0..t_s.len()).filter(is_first).collect();
        let count = begins.len();
        begins.push(t_s.len());
        let crowded: usize =
            begins.windows(2).map(|pair| pair[1] - pair[0]).filter(|size| *size >= LEAST_SIZE).sum();
        let lasting_s: f64 = begins.windows(2).map(|pair| t_s[pair[1] - 1] - t_s[pair[0]]).sum();
        let is_bursts = crowded as f64 >= LEAST_SHARE * t_s.len() as f64
            && lasting_s <= BURST_SHARE * count as f64 * period_s
            && count > 2;
        is_bursts.then(|| Bursts { t_s: spread(t_s, &begins, period_s), count, period_s })
    }

    /// What was found and done, for the report.
    pub(crate) fn told(&self, samples: &str) -> String {
        format!(
            "{samples} came in {} bursts, about {:.3} s from one to the next; their times were spread evenly between the bursts",
            self.count, self.period_s
        )
    }
}

/// Spreads the rows of runs that came in bursts. Rows that hold some channels each are not of one source.
pub(crate) fn spread_bursts(recording: &mut Recording, repairs: &mut Vec<Repair>) {
    if recording.channels.values().any(|values| values.iter().any(|value| value.is_nan())) {
        return;
    }
    for run in &mut recording.runs {
        let t_s = &mut recording.t_s[run.rows.clone()];
        // Times that repeat are rounded, or those of several drives.
        if t_s.windows(2).any(|pair| pair[1] <= pair[0]) {
            continue;
        }
        if let Some(bursts) = Bursts::of(t_s) {
            repairs.push(Repair { place: format!("run `{}`", run.name), what: bursts.told("rows") });
            t_s.copy_from_slice(&bursts.t_s);
            run.gap_s = gap::threshold_s(t_s);
        }
    }
}

/// The step within which half of all time passes, counted from the shortest.
fn step_of_half_the_time(steps_s: &[f64]) -> Option<f64> {
    let mut sorted = steps_s.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let half_s = sorted.iter().sum::<f64>() / 2.0;
    let mut passed_s = 0.0;
    sorted.into_iter().find(|step_s| {
        passed_s += step_s;
        passed_s >= half_s
    })
}

/// The samples of each burst at even steps up to its last, which arrived when it was taken; those of the first burst, and behind a pause,
/// at the step of most.
fn spread(t_s: &[f64], begins: &[usize], period_s: f64) -> Vec<f64> {
    let mut sizes: Vec<usize> = begins.windows(2).map(|pair| pair[1] - pair[0]).collect();
    sizes.sort_unstable();
    let usual_step_s = period_s / sizes[sizes.len() / 2] as f64;
    let mut even_s: Vec<f64> = Vec::with_capacity(t_s.len());
    for pair in begins.windows(2) {
        let (size, last_s) = (pair[1] - pair[0], t_s[pair[1] - 1]);
        let since_s = even_s.last().map_or(f64::INFINITY, |before_s| last_s - before_s);
        let step_s = if since_s <= 2.0 * period_s {
            since_s / size as f64
        } else {
            usual_step_s.min(since_s / size as f64)
        };
        even_s.extend((1..=size).map(|i| last_s - step_s * (size - i) as f64));
    }
    even_s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times of samples of some step that are handed on so many at once, a millisecond apart or less.
    fn handed_on(step_s: f64, at_once: usize, apart_s: f64) -> Vec<f64> {
        let period_s = step_s * at_once as f64;
        (0..600).map(|i| period_s * (i / at_once + 1) as f64 + apart_s * (i % at_once) as f64).collect()
    }

    #[test]
    fn bursts_of_every_size_are_spread_to_the_true_step() {
        for (step_s, at_once, apart_s) in [
            (0.05, 5, 0.0005),
            (0.1, 4, 0.001),
            (0.01, 10, 0.0),
            (0.01, 100, 1e-5),
            (0.1, 3, 0.004),
            (0.02, 7, 1e-6),
        ] {
            let bursts = Bursts::of(&handed_on(step_s, at_once, apart_s)).unwrap();
            let steps_s = bursts.t_s.windows(2).map(|pair| pair[1] - pair[0]);
            let even = steps_s.filter(|own_s| (own_s - step_s).abs() < 0.05 * step_s).count();
            assert!(even >= 590, "{step_s} s, {at_once} at once: {even} even steps");
            assert!(
                bursts.count.abs_diff(600 / at_once) <= 1
                    && (bursts.period_s - step_s * at_once as f64).abs() < 0.02
            );
        }
    }

    #[test]
    fn other_rhythms_are_left_as_they_are() {
        let even: Vec<f64> = (0..600).map(|i| 0.1 * f64::from(i)).collect();
        let jittered = even.iter().enumerate().map(|(i, t)| t + 0.03 * (7.0 * i as f64).sin()).collect();
        let two_rates =
            (0..300).map(|i| if i < 30 { f64::from(i) } else { 30.0 + 0.1 * f64::from(i - 30) }).collect();
        let paused = (0..600).map(|i| 0.01 * f64::from(i) + 1.5 * f64::from(i / 100)).collect();
        let union = (0..600).map(|i| 0.1 * f64::from(i / 2) + 0.043 * f64::from(i % 2)).collect();
        let pairs = (0..600).map(|i| 0.1 * f64::from(i / 2) + 1e-4 * f64::from(i % 2)).collect();
        let few = vec![0.0; 5];
        for t_s in [even, jittered, two_rates, paused, union, pairs, few] {
            assert_eq!(Bursts::of(&t_s), None);
        }
    }

    #[test]
    fn a_pause_between_bursts_stays_one() {
        let mut t_s = handed_on(0.05, 5, 0.0005);
        t_s[300..].iter_mut().for_each(|t| *t += 8.0);
        let even_s = Bursts::of(&t_s).unwrap().t_s;
        assert!((even_s[300] - even_s[299] - 8.05).abs() < 0.01, "{:?}", &even_s[298..302]);
        assert!(even_s.windows(2).all(|pair| pair[1] > pair[0]));
    }
}
