//! Stretches of drives, with how far power was off in each.

use crate::{
    baseline::Baseline,
    report::{Place, Range},
    series::Series,
    weigh::{BLOCK_S, blocks},
};

/// Averages of a stretch of some length [`BLOCK_S`] of one drive.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stretch {
    run: usize,
    from_s: f64,
    /// Whether it is of a drive under suspicion.
    pub(crate) suspect: bool,
    count: f64,
    sum_w: f64,
    squares_w2: f64,
    noise_w2: f64,
    /// Squared errors of the left and of the right side.
    by_side_w2: [f64; 2],
}

impl Stretch {
    /// Squared errors beyond noise [W²].
    pub(crate) fn beyond_w2(&self) -> f64 {
        self.squares_w2 - self.noise_w2
    }

    /// Squared errors over those that noise makes.
    pub(crate) fn times_noise(&self) -> f64 {
        self.squares_w2 / self.noise_w2.max(f64::MIN_POSITIVE)
    }

    /// Mean error, whose sign tells whether power was more or less than it should be [W].
    pub(crate) fn mean_w(&self) -> f64 {
        self.sum_w / self.count.max(1.0)
    }

    /// Whether it is long enough to be held against others.
    pub(crate) fn is_whole(&self) -> bool {
        self.count >= 0.5 * BLOCK_S
    }

    /// When it was and how far power was off in it, in words.
    pub(crate) fn words(&self, series: &Series) -> String {
        let power = if series.channels() == 2 { of_side(self.by_side_w2) } else { "power" };
        let off_w = (self.squares_w2 / self.count.max(1.0)).sqrt();
        let digits = if off_w < 10.0 { 1 } else { 0 };
        format!("{} {power} was off by {off_w:.digits$} W, root mean square", self.when(series))
    }

    /// It as a place, with its share of squared errors beyond noise.
    pub(crate) fn place(&self, series: &Series, all_w2: f64) -> Place {
        let edges_s = [Some(self.from_s), Some(self.from_s + BLOCK_S)];
        let range = Range { name: self.drive(series), ..Range::of("t_s", edges_s) };
        Place {
            kind: "time",
            statement: self.when(series),
            range,
            share_of_excess: self.beyond_w2() / all_w2,
        }
    }

    fn when(&self, series: &Series) -> String {
        let drive = self.drive(series).map_or(String::new(), |name| format!(" of drive {name}"));
        format!("from {:.0} to {:.0} s{drive}", self.from_s, self.from_s + BLOCK_S)
    }

    fn drive(&self, series: &Series) -> Option<String> {
        series.names.get(self.run).filter(|_| series.names.len() > 1).cloned()
    }
}

/// All of them, drive by drive as time goes on.
pub(crate) fn stretches(series: &Series, base: &Baseline, errors_w: &[f64]) -> Vec<Stretch> {
    let block = blocks(series);
    let mut all = vec![Stretch::default(); block.iter().max().map_or(0, |last| last + 1)];
    for i in (0..errors_w.len()).filter(|i| series.is_power(*i)) {
        let average = &series.averages[i];
        let stretch = &mut all[block[i]];
        stretch.run = average.run;
        stretch.from_s = BLOCK_S * (average.t_s.max(0.0) / BLOCK_S).floor();
        stretch.suspect = average.suspect;
        stretch.count += 1.0;
        stretch.sum_w += errors_w[i];
        stretch.squares_w2 += errors_w[i].powi(2);
        stretch.noise_w2 += base.noise.fresh_sigma(average, base.predicted_w[i]).powi(2);
        if let Some(own_w2) = stretch.by_side_w2.get_mut(average.channel) {
            *own_w2 += errors_w[i].powi(2);
        }
    }
    all.retain(|stretch| stretch.count > 0.0);
    all
}

/// Share of squared errors that one side holds where it is the one that was off.
const ON_ONE_SIDE: f64 = 0.8;

/// Which power was off, by the squared errors of the left and the right side.
fn of_side([left_w2, right_w2]: [f64; 2]) -> &'static str {
    match left_w2 / (left_w2 + right_w2) {
        share if share >= ON_ONE_SIDE => "the power of the left side",
        share if share <= 1.0 - ON_ONE_SIDE => "the power of the right side",
        _ => "the power of a side",
    }
}

#[cfg(test)]
impl Stretch {
    /// One with so many times the squared errors that noise makes, of a mean with a sign.
    pub(crate) fn of(suspect: bool, times_noise: f64, sign: f64) -> Self {
        Stretch {
            suspect,
            count: BLOCK_S,
            sum_w: sign * times_noise.sqrt() * BLOCK_S,
            squares_w2: times_noise * BLOCK_S,
            noise_w2: BLOCK_S,
            ..Stretch::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_is_named_that_holds_most_of_it() {
        assert_eq!(of_side([90.0, 10.0]), "the power of the left side");
        assert_eq!(of_side([10.0, 90.0]), "the power of the right side");
        assert_eq!(of_side([60.0, 40.0]), "the power of a side");
        assert_eq!(of_side([0.0, 0.0]), "the power of a side");
    }

    #[test]
    fn what_noise_makes_is_not_beyond_it() {
        let stretch = Stretch::of(true, 3.0, 1.0);
        assert_eq!([stretch.times_noise(), stretch.beyond_w2()], [3.0, 2.0 * BLOCK_S]);
        assert!(stretch.is_whole());
    }
}
