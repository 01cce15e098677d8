//! What happened a few times only: too much to be noise, and too seldom to be evidence of anything; and what comes again and again though
//! nothing that was recorded tells when.

use crate::{
    baseline::Baseline,
    report::Place,
    series::Series,
    stretches::{Stretch, stretches},
    visits,
};

/// Share of what is beyond noise that a few stretches hold where it is an event.
const MOST: f64 = 0.5;

/// Squared errors over noise, in times of those in as many of the stretches of healthy drives, from which stretches are far off. Of 29
/// healthy drives, decoys among them, in two worlds with forms of their own the sixth of some 45 stretches came to 1.2 times at most, and
/// where a bearing seized for some seconds every minute to 5 and 7 times.
const FAR: f64 = 3.0;

/// Squared errors over noise in the middle one of stretches, in times of those of healthy drives, up to which most are as they are in
/// healthy drives: 1.05 and 1.6 times where the bearing seized.
const ALIKE: f64 = 2.0;

/// Share of stretches that are far off in which power is off one way.
const ONE_WAY: f64 = 0.8;

/// Stretches that are told one by one.
const TOLD: usize = 5;

/// What happened in some stretches of drives and follows nothing that was recorded.
pub(crate) struct Event {
    /// When it was the greatest, and how far power was off there, in words.
    pub(crate) words: String,
    /// In how many stretches of how many power was further off than healthy drives are, where there are enough of them to be evidence that
    /// something is missing.
    pub(crate) recurs: Option<[usize; 2]>,
    /// When: the greatest of the stretches that are far off, or those few that hold most.
    pub(crate) places: Vec<Place>,
}

impl Event {
    /// When stretches of drives under suspicion are far off that are enough to be evidence, or so few that they are none and yet hold most of
    /// the errors beyond noise; `None` where errors are all over the drives.
    pub(crate) fn of(series: &Series, base: &Baseline, errors_w: &[f64]) -> Option<Self> {
        let all = stretches(series, base, errors_w);
        let far = far_off(&all);
        let recurs = (far >= visits::LEAST as usize).then(|| {
            let count = all.iter().filter(|stretch| stretch.suspect).count();
            [far, count]
        });
        let mut beyond: Vec<&Stretch> =
            all.iter().filter(|stretch| stretch.suspect && stretch.beyond_w2() > 0.0).collect();
        beyond.sort_by(|a, b| b.beyond_w2().total_cmp(&a.beyond_w2()));
        let sum_w2 = |count: usize| beyond.iter().take(count).map(|stretch| stretch.beyond_w2()).sum::<f64>();
        let all_w2 = sum_w2(beyond.len());
        let few = (1..visits::LEAST as usize).find(|count| sum_w2(*count) >= MOST * all_w2);
        let told = if recurs.is_some() { TOLD } else { few? };
        let places = beyond.iter().take(told).map(|stretch| stretch.place(series, all_w2)).collect();
        Some(Event { words: beyond.first()?.words(series), recurs, places })
    }

    /// Whether there is enough of it to be evidence that something is missing.
    pub(crate) fn comes_again(&self) -> bool {
        self.recurs.is_some()
    }
}

/// In how many stretches of drives under suspicion power is further off than it is in healthy ones; in none, as far as one can tell, without
/// healthy drives, where most others are not as they are in healthy drives, or where power is more here and less there: then it is not
/// something that comes and goes.
fn far_off(all: &[Stretch]) -> usize {
    let sorted = |suspect: bool| {
        let whole = all.iter().filter(|stretch| stretch.suspect == suspect && stretch.is_whole());
        let mut sorted: Vec<&Stretch> = whole.collect();
        sorted.sort_by(|a, b| b.times_noise().total_cmp(&a.times_noise()));
        sorted
    };
    let [suspect, healthy] = [true, false].map(sorted);
    let median = |all: &[&Stretch]| all.get(all.len() / 2).map_or(0.0, |stretch| stretch.times_noise());
    // The same share of the healthy drives' stretches as is evidence of the others.
    let same = (visits::LEAST * healthy.len() as f64 / suspect.len().max(1) as f64).floor();
    let Some(usual) = healthy.get((same as usize).max(1) - 1) else { return 0 };
    let far = suspect.iter().filter(|stretch| stretch.times_noise() > FAR * usual.times_noise().max(1.0));
    let far: Vec<f64> = far.map(|stretch| stretch.mean_w()).collect();
    let is_alike = median(&suspect) <= ALIKE * median(&healthy).max(1.0);
    let more = far.iter().filter(|mean_w| **mean_w > 0.0).count() as f64 / far.len().max(1) as f64;
    if is_alike && more.max(1.0 - more) >= ONE_WAY { far.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretches of suspect and of healthy drives.
    fn drives(suspect: &[f64], healthy: &[f64]) -> Vec<Stretch> {
        let of = |suspect: bool| move |times: &f64| Stretch::of(suspect, times.abs(), times.signum());
        suspect.iter().map(of(true)).chain(healthy.iter().map(of(false))).collect()
    }

    #[test]
    fn stretches_are_far_off_that_are_so_more_often_than_healthy_ones() {
        let mut suspect = vec![1.0; 40];
        suspect[..8].fill(9.0);
        let mut healthy = vec![1.0; 40];
        assert_eq!(far_off(&drives(&suspect, &healthy)), 8);
        // A few times each drive is far off.
        healthy[..5].fill(20.0);
        assert_eq!(far_off(&drives(&suspect, &healthy)), 8);
        healthy[..6].fill(20.0);
        assert_eq!(far_off(&drives(&suspect, &healthy)), 0);
    }

    #[test]
    fn fewer_healthy_stretches_are_held_against_the_same_share() {
        let mut suspect = vec![1.0; 60];
        suspect[..8].fill(9.0);
        // Two of twenty are as six of sixty.
        let mut healthy = vec![1.0; 20];
        healthy[0] = 20.0;
        assert_eq!(far_off(&drives(&suspect, &healthy)), 8);
        healthy[1] = 20.0;
        assert_eq!(far_off(&drives(&suspect, &healthy)), 0);
    }

    #[test]
    fn what_is_dealt_over_all_stretches_or_adds_here_and_takes_there_does_not_come_and_go() {
        let healthy = vec![1.0; 40];
        assert_eq!(far_off(&drives(&[9.0; 40], &healthy)), 0);
        let mut suspect = vec![1.0; 40];
        suspect[..8].fill(9.0);
        suspect[..2].fill(-9.0);
        assert_eq!(far_off(&drives(&suspect, &healthy)), 0);
        suspect[..8].fill(-9.0);
        assert_eq!(far_off(&drives(&suspect, &healthy)), 8);
    }

    #[test]
    fn without_healthy_drives_none_is_further_off_than_they_are() {
        assert_eq!(far_off(&drives(&[30.0; 9], &[])), 0);
    }
}
