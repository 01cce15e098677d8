//! Noise of one-second averages, identified from quick differences of residuals, so that no effect of a longer duration inflates it.
//!
//! AR(1) of variance a² + (b P)² in each channel. Of such noise
//!
//! ```text
//! var(e_i − e_{i−2}) / var(e_i − e_{i−1}) = 1 + ρ,   var(e_i − 2 e_{i−1} + e_{i−2}) = 2 σ² (1 − ρ)(3 − ρ)
//! ```

/// One value: its place in a series of one channel of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Channel.
    pub(crate) channel: usize,
    /// Whether it comes right after the value before it.
    pub(crate) follows: bool,
}

/// Noise of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChannelNoise {
    /// a².
    pub(crate) floor2: f64,
    /// b².
    pub(crate) gain2: f64,
    /// ρ.
    pub(crate) correlation: f64,
}

/// Noise by channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Channel by channel.
    pub(crate) channels: Vec<ChannelNoise>,
}

/// Largest correlation of neighbours: it falls to 1/e in 4.5 s. What lasts longer is no noise.
const LARGEST_CORRELATION: f64 = 0.8;
/// Squares count up to so many of their expectation, those beyond 1.5 standard deviations as that, and the mean of what is so cut of a
/// normal distribution (Huber's second proposal, Ann. Math. Stat. 35, 1964).
const CUT: f64 = 2.25;
const MEAN_OF_CUT: f64 = 0.778_465;
/// Rounds of weighing squares by what was found.
const ROUNDS: usize = 8;
/// Least share of the typical variance that does not grow with power: a floor of nothing would weigh seconds without power without bound.
const LEAST_FLOOR: f64 = 0.05;
/// Second differences that tell how noise grows: so many squares tell a variance to a third. Sums over stretches have none.
const LEAST_BENDS: usize = 20;
/// No meter is closer, in watts or metres per second, squared.
const LEAST_VARIANCE: f64 = 1e-8;
/// Median of |x| of a standard normal distribution.
const MEDIAN_OF_SIZE: f64 = 0.674_49;

impl Noise {
    /// Identifies the noise of residuals about predictions.
    pub(crate) fn of(residuals: &[f64], predicted: &[f64], places: &[Place]) -> Self {
        let count = places.iter().map(|place| place.channel + 1).max().unwrap_or(0);
        let of = |channel: usize| {
            let own: Vec<usize> = (0..places.len()).filter(|i| places[*i].channel == channel).collect();
            ChannelNoise::of(residuals, predicted, places, &own)
        };
        Noise { channels: (0..count).map(of).collect() }
    }

    /// Standard deviation of a value.
    pub(crate) fn sigma(&self, channel: usize, predicted: f64) -> f64 {
        let noise = &self.channels[channel];
        (noise.floor2 + noise.gain2 * predicted * predicted).sqrt()
    }

    /// What makes values independent and of variance one: own and previous weight of each.
    pub(crate) fn whitening(&self, predicted: &[f64], places: &[Place]) -> Whitening {
        let of = |(i, place): (usize, &Place)| {
            let rho = self.channels[place.channel].correlation;
            let fresh = (1.0 - rho * rho).sqrt();
            let own = 1.0 / self.sigma(place.channel, predicted[i]);
            if place.follows && i > 0 {
                let last = rho / self.sigma(place.channel, predicted[i - 1]);
                [own / fresh, last / fresh]
            } else {
                [own, 0.0]
            }
        };
        Whitening { rows: places.iter().enumerate().map(of).collect() }
    }
}

impl ChannelNoise {
    fn of(residuals: &[f64], predicted: &[f64], places: &[Place], own: &[usize]) -> Self {
        let steps = |lag: usize| -> Vec<f64> {
            let is_whole = |i: &usize| *i >= lag && (0..lag).all(|back| places[*i - back].follows);
            own.iter().filter(|i| is_whole(i)).map(|i| residuals[*i] - residuals[*i - lag]).collect()
        };
        let [one, two] = [1, 2].map(|lag| robust_variance(&steps(lag)));
        let correlation = if one > 0.0 { (two / one - 1.0).clamp(0.0, LARGEST_CORRELATION) } else { 0.0 };
        let factor = 2.0 * (1.0 - correlation) * (3.0 - correlation);
        let is_middle = |i: &usize| *i >= 2 && places[*i].follows && places[*i - 1].follows;
        let squares: Vec<[f64; 2]> = own
            .iter()
            .filter(|i| is_middle(i))
            .map(|i| {
                let bend = residuals[*i] - 2.0 * residuals[*i - 1] + residuals[*i - 2];
                [bend * bend / factor, predicted[*i - 1].powi(2)]
            })
            .collect();
        if squares.len() < LEAST_BENDS {
            return ChannelNoise::of_sparse(residuals, own);
        }
        let [floor2, gain2] = growth(&squares);
        ChannelNoise { floor2, gain2, correlation }
    }

    /// That of values too far apart for second differences: half the variance of steps.
    fn of_sparse(residuals: &[f64], own: &[usize]) -> Self {
        let steps: Vec<f64> = own.windows(2).map(|pair| residuals[pair[1]] - residuals[pair[0]]).collect();
        ChannelNoise {
            floor2: (0.5 * robust_variance(&steps)).max(LEAST_VARIANCE),
            gain2: 0.0,
            correlation: 0.0,
        }
    }
}

/// a² and b² of squared values and squared powers, large squares cut.
fn growth(squares: &[[f64; 2]]) -> [f64; 2] {
    let mut sizes: Vec<f64> = squares.iter().map(|[square, _]| square.sqrt()).collect();
    let typical2 = (median(&mut sizes) / MEDIAN_OF_SIZE).powi(2).max(LEAST_VARIANCE);
    let (mut floor2, mut gain2) = (typical2, 0.0);
    for _ in 0..ROUNDS {
        let (mut gram, mut right) = ([0.0; 3], [0.0; 2]);
        for &[square, power2] in squares {
            let variance = floor2 + gain2 * power2;
            let cut = square.min(CUT * variance) / MEAN_OF_CUT;
            let weight = variance.powi(-2);
            gram = [gram[0] + weight, gram[1] + weight * power2, gram[2] + weight * power2 * power2];
            right = [right[0] + weight * cut, right[1] + weight * power2 * cut];
        }
        let determinant = gram[0] * gram[2] - gram[1] * gram[1];
        if determinant.abs() <= 1e-12 * gram[0] * gram[2] || gram[0] <= 0.0 {
            break;
        }
        gain2 = ((gram[0] * right[1] - gram[1] * right[0]) / determinant).max(0.0);
        floor2 = ((right[0] - gain2 * gram[1]) / gram[0]).max(LEAST_FLOOR * typical2);
    }
    [floor2, gain2]
}

fn robust_variance(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    (median(&mut sizes) / MEDIAN_OF_SIZE).powi(2)
}

pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Weights that make values independent and of variance one.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    rows: Vec<[f64; 2]>,
}

impl Whitening {
    /// The first values made so; there may be fewer than rows.
    pub(crate) fn apply(&self, values: &[f64]) -> Vec<f64> {
        let before = |i: usize| if i > 0 { values[i - 1] } else { 0.0 };
        let one = |(i, value): (usize, &f64)| {
            let [own, last] = self.rows[i];
            own * value - last * before(i)
        };
        values.iter().enumerate().map(one).collect()
    }

    /// Undoes [`Whitening::apply`] of the first rows.
    pub(crate) fn undo(&self, white: &[f64]) -> Vec<f64> {
        let mut before = 0.0;
        let one = |(value, [own, last]): (&f64, &[f64; 2])| {
            before = (value + last * before) / own;
            before
        };
        white.iter().zip(&self.rows).map(one).collect()
    }

    /// The same with every row times a factor, as of a weight or of tempering.
    pub(crate) fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let one = |(i, row): (usize, &[f64; 2])| row.map(|weight| weight * factor(i));
        Whitening { rows: self.rows.iter().enumerate().map(one).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standard normal numbers, the same in every run, by the inverse of Φ at a golden-ratio sequence with a shuffle.
    fn normal(i: usize) -> f64 {
        let bits = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (bits ^ (bits >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let share = ((mixed ^ (mixed >> 32)) >> 11) as f64 / (1_u64 << 53) as f64;
        2.0_f64.sqrt() * statrs::function::erf::erf_inv(2.0 * share.clamp(1e-6, 1.0 - 1e-6) - 1.0)
    }

    fn series(rho: f64, effect: impl Fn(usize) -> f64) -> (Vec<f64>, Vec<f64>, Vec<Place>) {
        let mut last = 0.0;
        let predicted: Vec<f64> = (0..6000).map(|i| 50.0 + 40.0 * (0.05 * i as f64).sin()).collect();
        let residuals = (0..6000)
            .map(|i| {
                last = rho * last + (1.0 - rho * rho).sqrt() * normal(i);
                (0.25 + (0.02 * predicted[i]).powi(2)).sqrt() * last + effect(i)
            })
            .collect();
        let places = (0..6000).map(|i| Place { channel: 0, follows: i > 0 }).collect();
        (residuals, predicted, places)
    }

    #[test]
    fn floor_gain_and_correlation_are_those_of_the_series() {
        for rho in [0.0, 0.5] {
            let (residuals, predicted, places) = series(rho, |_| 0.0);
            let found = Noise::of(&residuals, &predicted, &places).channels[0];
            assert!((found.correlation - rho).abs() < 0.08, "{found:?}");
            assert!((found.floor2 / 0.25 - 1.0).abs() < 0.25, "{found:?}");
            assert!((found.gain2.sqrt() / 0.02 - 1.0).abs() < 0.1, "{found:?}");
        }
    }

    #[test]
    fn effects_that_set_in_or_follow_the_drive_hardly_change_the_noise() {
        let sigma = |size: f64| {
            let effect = |i: usize| if i > 3000 { size * (1.0 + (0.05 * i as f64).sin()) } else { 0.0 };
            let (residuals, predicted, places) = series(0.0, effect);
            Noise::of(&residuals, &predicted, &places).sigma(0, 50.0)
        };
        assert!((sigma(5.0) / sigma(0.0) - 1.0).abs() < 0.1, "{} {}", sigma(5.0), sigma(0.0));
    }

    #[test]
    fn whitened_noise_is_independent_and_of_variance_one() {
        let (residuals, predicted, places) = series(0.5, |_| 0.0);
        let noise = Noise::of(&residuals, &predicted, &places);
        let whitening = noise.whitening(&predicted, &places);
        let white = whitening.apply(&residuals);
        let back = whitening.undo(&white[..4000]);
        assert!(back.iter().zip(&residuals).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs())));
        let variance = white.iter().map(|x| x * x).sum::<f64>() / 6000.0;
        let lagged = white.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / 6000.0;
        assert!((variance - 1.0).abs() < 0.12 && lagged.abs() < 0.08, "{variance} {lagged}");
    }
}
