//! How far averages scatter about a model that is right, and how they hang together in time.

use std::collections::HashMap;

use crate::average::{Average, Input};

/// Scatter of each channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    channels: Vec<Scatter>,
    /// By how much drives under suspicion scatter more, by channel.
    suspect: Vec<f64>,
}

/// Variance a² + (b P)² + (c d)² + (e v̇)² + (f ḋ)², with errors of neighbours correlated by ρ.
///
/// P is what is predicted, d the difference of both rim speeds, v̇ and ḋ how fast speed and difference change: what models miss of
/// turns and of gaining speed scatters more than what they miss of driving straight on, at the same power.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scatter {
    /// a², in the channel's unit squared.
    floor2: f64,
    /// b², c², e², f².
    growth2: [f64; GROWTHS],
    /// Correlation from one average to the next.
    rho: f64,
}

/// What scatter grows with.
const GROWTHS: usize = 4;

/// Squares of it.
fn squares(input: &Input, predicted: f64) -> [f64; GROWTHS] {
    [predicted, input.difference_mps, input.accel_mps2, input.swing_mps2].map(|x| x * x)
}

/// Most of a correlation that is taken out before fitting; what is left is the blocks' business.
const MOST_RHO: f64 = 0.95;

impl Noise {
    /// Measures the noise of errors about predictions, channel by channel, on averages that are trusted.
    ///
    /// Others scatter as much, or more where they change more from one second to the next: their errors themselves may be what
    /// is looked for. Of drives under suspicion that have to be trusted, so may be what lasts, so that it counts as no noise.
    pub(crate) fn of(errors: &[f64], predicted: &[f64], averages: &[Average], trusted: &[bool]) -> Self {
        let count = averages.iter().map(|a| a.channel + 1).max().unwrap_or(0);
        let of_channel =
            |channel: usize| (0..averages.len()).filter(move |i| averages[*i].channel == channel);
        let passing = passing(errors, averages);
        let scatter = |channel: usize| {
            let places: Vec<usize> = of_channel(channel).filter(|i| trusted[*i]).collect();
            Scatter::of(&passing, predicted, averages, places)
        };
        let channels: Vec<Scatter> = (0..count).map(scatter).collect();
        let jumps = |channel: usize, of_trusted: bool| {
            let places =
                of_channel(channel).filter(|i| *i > 0 && follows(averages, *i) && trusted[*i] == of_trusted);
            let scaled = |i: usize| errors[i] / channels[channel].sigma(&averages[i].input, predicted[i]);
            median(&mut places.map(|i| (scaled(i) - scaled(i - 1)).abs()).collect::<Vec<f64>>())
        };
        let more = |channel: usize| {
            let (here, there) = (jumps(channel, false), jumps(channel, true));
            if there > 0.0 { (here / there).max(1.0) } else { 1.0 }
        };
        let suspect = (0..count).map(more).collect();
        Noise { channels, suspect }
    }

    /// One-sigma scatter of a channel about a prediction, in drives that are trusted.
    pub(crate) fn sigma_of(&self, channel: usize, input: &Input, predicted: f64) -> f64 {
        self.channels[channel].sigma(input, predicted)
    }

    /// One-sigma scatter of an average about its prediction.
    pub(crate) fn sigma(&self, average: &Average, predicted: f64) -> f64 {
        let more = if average.suspect { self.suspect[average.channel] } else { 1.0 };
        more * self.sigma_of(average.channel, &average.input, predicted)
    }

    /// By what share it is more or less than another, mean of all averages.
    pub(crate) fn change_from(&self, other: &Noise, (averages, predicted): (&[Average], &[f64])) -> f64 {
        let change = |(average, p): (&Average, &f64)| {
            (self.fresh_sigma(average, *p) / other.fresh_sigma(average, *p)).ln().abs()
        };
        averages.iter().zip(predicted).map(change).sum::<f64>() / averages.len().max(1) as f64
    }

    /// What the average before does not tell of an error, one sigma.
    pub(crate) fn fresh_sigma(&self, average: &Average, predicted: f64) -> f64 {
        (1.0 - self.channels[average.channel].rho.powi(2)).sqrt() * self.sigma(average, predicted)
    }

    /// Prepares what divides by the scatter about predictions and takes out what the average before tells.
    pub(crate) fn whitening(&self, predicted: &[f64], averages: &[Average]) -> Whitening {
        let of = |i: usize| {
            let rho = self.channels[averages[i].channel].rho;
            let sigma = self.sigma(&averages[i], predicted[i]);
            if i > 0 && follows(averages, i) {
                [1.0 / sigma, rho / self.sigma(&averages[i - 1], predicted[i - 1])]
            } else {
                [(1.0 - rho * rho).sqrt() / sigma, 0.0]
            }
        };
        Whitening { rows: (0..averages.len()).map(of).collect() }
    }
}

/// Makes errors, or columns of them, independent and of one sigma 1.
pub(crate) struct Whitening {
    /// Weight of each value and of the one before it, which is taken out.
    rows: Vec<[f64; 2]>,
}

impl Whitening {
    /// The same of values.
    pub(crate) fn of(&self, values: &[f64]) -> Vec<f64> {
        let before = |i: usize| if i > 0 { values[i - 1] } else { 0.0 };
        self.rows.iter().enumerate().map(|(i, [own, last])| own * values[i] - last * before(i)).collect()
    }

    /// The same of the values of one channel, whose averages lie at such places: what is taken out of one is of its channel too.
    pub(crate) fn of_channel(&self, places: &[usize], values: &[f64]) -> Vec<f64> {
        let before = |k: usize| if k > 0 { values[k - 1] } else { 0.0 };
        let of = |(k, place): (usize, &usize)| {
            let [own, last] = self.rows[*place];
            own * values[k] - last * before(k)
        };
        places.iter().enumerate().map(of).collect()
    }
}

impl Scatter {
    fn sigma(&self, input: &Input, predicted: f64) -> f64 {
        let growth = squares(input, predicted).iter().zip(self.growth2).map(|(x, by)| x * by).sum::<f64>();
        (self.floor2 + growth).sqrt()
    }

    /// Squared errors by their size, large ones cut, so that what mechanisms do now and then matters little (Huber's second
    /// proposal, Ann. Math. Stat. 35, 1964).
    fn of(errors: &[f64], predicted: &[f64], averages: &[Average], places: Vec<usize>) -> Self {
        let mut sizes: Vec<f64> = places.iter().map(|i| errors[*i].abs()).collect();
        // The median of a normal distribution's size is 0.6745 σ.
        let usual2 = (median(&mut sizes) / 0.6745).powi(2).max(LEAST_VARIANCE);
        let mut scatter = Scatter { floor2: usual2, growth2: [0.0; GROWTHS], rho: 0.0 };
        let rows: Vec<[f64; GROWTHS + 1]> = places
            .iter()
            .map(|i| {
                let [power, turn, accel, swing] = squares(&averages[*i].input, predicted[*i]);
                [1.0, power, turn, accel, swing]
            })
            .collect();
        for _ in 0..ROUNDS {
            let one = |(row, i): (&[f64; GROWTHS + 1], &usize)| {
                let variance = scatter.sigma(&averages[*i].input, predicted[*i]).powi(2);
                (*row, errors[*i].powi(2).min(LARGE * LARGE * variance) / WITHIN, variance.powi(-2))
            };
            let [floor2, growth2 @ ..] = not_negative(rows.iter().zip(&places).map(one));
            scatter.growth2 = growth2;
            scatter.floor2 = floor2.max(LEAST_SHARE * usual2);
        }
        let (mut both, mut own) = (0.0, 0.0);
        for i in places.into_iter().filter(|i| *i > 0 && follows(averages, *i)) {
            let sigma = |i: usize| scatter.sigma(&averages[i].input, predicted[i]);
            let [a, b] = [i - 1, i].map(|i| (errors[i] / sigma(i)).clamp(-3.0, 3.0));
            both += a * b;
            own += a * a;
        }
        scatter.rho = if own > 0.0 { (both / own).clamp(0.0, MOST_RHO) } else { 0.0 };
        scatter
    }
}

/// Rounds in which variances are fitted and squared errors weighed by them in turn.
const ROUNDS: usize = 12;
/// Errors beyond so many sigma count as so many, and the mean square of what is so cut of a normal distribution.
const LARGE: f64 = 1.5;
const WITHIN: f64 = 0.778_465;
/// Sweeps over the coefficients, one after the other, within a round.
const SWEEPS: usize = 200;
/// Least share of the usual variance that is there whatever the robot does.
const LEAST_SHARE: f64 = 0.05;
/// A channel that never changes has this variance, of watts or metres per second: no meter is closer.
const LEAST_VARIANCE: f64 = 1e-6;

/// Coefficients, none below 0, of the weighted least squares of values by rows, by descent along each in turn.
fn not_negative<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64, f64)>) -> [f64; N] {
    let (mut square, mut right) = ([[0.0; N]; N], [0.0; N]);
    for (row, value, weight) in rows {
        for i in 0..N {
            right[i] += weight * row[i] * value;
            (0..N).for_each(|j| square[i][j] += weight * row[i] * row[j]);
        }
    }
    let mut found = [0.0; N];
    for _ in 0..SWEEPS {
        for i in 0..N {
            if square[i][i] > 0.0 {
                let others: f64 = (0..N).filter(|j| *j != i).map(|j| square[i][j] * found[j]).sum();
                found[i] = ((right[i] - others) / square[i][i]).max(0.0);
            }
        }
    }
    found
}

/// Length of stretches whose mean is what lasts [s]: several times as long as what sensors and models miss hangs together.
const LASTING_S: f64 = 120.0;

/// Errors, those of drives under suspicion less their means over long stretches.
fn passing(errors: &[f64], averages: &[Average]) -> Vec<f64> {
    let stretch = |a: &Average| (a.channel, a.run, (a.t_s / LASTING_S) as usize);
    let mut sums: HashMap<(usize, usize, usize), (f64, f64)> = HashMap::new();
    for (error, average) in errors.iter().zip(averages) {
        let (sum, count) = sums.entry(stretch(average)).or_default();
        *sum += error;
        *count += 1.0;
    }
    let less_mean = |(error, average): (&f64, &Average)| {
        let (sum, count) = sums[&stretch(average)];
        if average.suspect { error - sum / count } else { *error }
    };
    errors.iter().zip(averages).map(less_mean).collect()
}

/// Whether an average comes right after the one before it.
fn follows(averages: &[Average], i: usize) -> bool {
    let (a, b) = (&averages[i - 1], &averages[i]);
    a.run == b.run && a.channel == b.channel && b.t_s - a.t_s < 1.5 * calibration::average::AVERAGE_S
}

/// The median, which sorts.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { 0.0 } else { values[values.len() / 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_is_told_apart_by_what_it_grows_with() {
        let average = |i: usize| {
            let input = Input {
                difference_mps: if i.is_multiple_of(3) { 0.4 } else { 0.0 },
                accel_mps2: 0.1 * (i % 7) as f64,
                ..Input::default()
            };
            Average { channel: 0, run: 0, suspect: false, t_s: i as f64, input }
        };
        let averages: Vec<Average> = (0..4000).map(average).collect();
        let predicted: Vec<f64> = (0..4000).map(|i| 10.0 + 40.0 * (0.37 * i as f64).sin()).collect();
        // Signs alternate and sizes run through those of a normal distribution.
        let normal = |i: usize| {
            let share = ((i as f64 * 0.618_033_988_75) % 1.0).clamp(1e-4, 1.0 - 1e-4);
            2.0_f64.sqrt() * statrs::function::erf::erf_inv(2.0 * share - 1.0)
        };
        let truth = Scatter { floor2: 0.25, growth2: [4e-4, 9.0, 0.0, 0.0], rho: 0.0 };
        let errors: Vec<f64> =
            (0..4000).map(|i| truth.sigma(&averages[i].input, predicted[i]) * normal(i)).collect();
        let found = Scatter::of(&errors, &predicted, &averages, (0..4000).collect());
        let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.1;
        assert!(is_near(found.floor2, 0.25), "{found:?}");
        assert!(is_near(found.growth2[0], 4e-4) && is_near(found.growth2[1], 9.0), "{found:?}");
        assert!(found.growth2[2] < 0.05, "{found:?}");
    }
}
