//! How far averages scatter about a model that is right, and how they hang together in time.

use crate::series::Average;

/// Scatter of each channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    channels: Vec<Scatter>,
    /// By how much drives under suspicion scatter more, by channel.
    suspect: Vec<f64>,
}

/// Variance floor² + (gain P)², with errors of neighbours correlated by ρ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scatter {
    /// What remains at no power, in the channel's unit.
    floor: f64,
    /// Growth with power [-].
    gain: f64,
    /// Correlation from one average to the next.
    rho: f64,
}

/// Most of a correlation that is taken out before fitting; what is left is the blocks' business.
const MOST_RHO: f64 = 0.95;

impl Noise {
    /// Measures the noise of errors about predictions, channel by channel, on averages that are trusted.
    ///
    /// Others scatter as much, or more where they change more from one second to the next: their errors themselves may be what
    /// is looked for.
    pub(crate) fn of(errors: &[f64], predicted: &[f64], averages: &[Average], trusted: &[bool]) -> Self {
        let count = averages.iter().map(|a| a.channel + 1).max().unwrap_or(0);
        let of_channel =
            |channel: usize| (0..averages.len()).filter(move |i| averages[*i].channel == channel);
        let scatter = |channel: usize| {
            let places: Vec<usize> = of_channel(channel).filter(|i| trusted[*i]).collect();
            Scatter::of(errors, predicted, averages, places)
        };
        let channels: Vec<Scatter> = (0..count).map(scatter).collect();
        let jumps = |channel: usize, of_trusted: bool| {
            let places =
                of_channel(channel).filter(|i| *i > 0 && follows(averages, *i) && trusted[*i] == of_trusted);
            let scaled = |i: usize| errors[i] / channels[channel].sigma(predicted[i]);
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
    pub(crate) fn sigma_of(&self, channel: usize, predicted: f64) -> f64 {
        self.channels[channel].sigma(predicted)
    }

    /// One-sigma scatter of an average about its prediction.
    pub(crate) fn sigma(&self, average: &Average, predicted: f64) -> f64 {
        let more = if average.suspect { self.suspect[average.channel] } else { 1.0 };
        more * self.sigma_of(average.channel, predicted)
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
}

impl Scatter {
    fn sigma(&self, predicted: f64) -> f64 {
        self.floor.hypot(self.gain * predicted)
    }

    /// Where power is lowest the floor shows, where it is highest the gain; medians, so that what mechanisms do now and then
    /// matters little.
    fn of(errors: &[f64], predicted: &[f64], averages: &[Average], mut places: Vec<usize>) -> Self {
        let in_time = places.clone();
        places.sort_by(|a, b| predicted[*a].abs().total_cmp(&predicted[*b].abs()));
        let third = (places.len() / 3).max(1).min(places.len());
        let spread = |places: &[usize]| {
            let mut sizes: Vec<f64> = places.iter().map(|i| errors[*i].abs()).collect();
            // The median of a normal distribution's size is 0.6745 σ.
            median(&mut sizes) / 0.6745
        };
        let level = |places: &[usize]| {
            let mut sizes: Vec<f64> = places.iter().map(|i| predicted[*i].abs()).collect();
            median(&mut sizes)
        };
        let (low, high) = (&places[..third], &places[places.len() - third..]);
        let (a, b) = (spread(low).powi(2), spread(high).powi(2));
        let (p, q) = (level(low).powi(2), level(high).powi(2));
        // A channel that hardly changes does not tell.
        let gain2 = if q > VARIES * p { ((b - a) / (q - p)).max(0.0) } else { 0.0 };
        let floor2 = (a - gain2 * p).max(0.05 * a).max(LEAST_VARIANCE);
        let sigma = |i: usize| (floor2 + gain2 * predicted[i] * predicted[i]).sqrt();
        let (mut both, mut own) = (0.0, 0.0);
        for i in in_time.into_iter().filter(|i| *i > 0 && follows(averages, *i)) {
            let [a, b] = [i - 1, i].map(|i| (errors[i] / sigma(i)).clamp(-3.0, 3.0));
            both += a * b;
            own += a * a;
        }
        let rho = if own > 0.0 { (both / own).clamp(0.0, MOST_RHO) } else { 0.0 };
        Scatter { floor: floor2.sqrt(), gain: gain2.sqrt(), rho }
    }
}

/// How much larger the square of a channel's upper third has to be than that of its lower for growth of noise to be told.
const VARIES: f64 = 1.5;
/// A channel that never changes has this variance, of watts or metres per second: no meter is closer.
const LEAST_VARIANCE: f64 = 1e-6;

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
