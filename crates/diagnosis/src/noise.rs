//! How far averages scatter about a model that is right, and how they hang together in time.

use crate::series::Average;

/// Variance floor² + (gain P)², with errors of neighbours correlated by ρ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// What remains at no power [W].
    pub(crate) floor_w: f64,
    /// Growth with power [-].
    pub(crate) gain: f64,
    /// Correlation from one average to the next.
    pub(crate) rho: f64,
}

/// Most of a correlation that is taken out before fitting; what is left is the blocks' business.
const MOST_RHO: f64 = 0.95;

impl Noise {
    /// Measures the noise of errors about predictions [W].
    ///
    /// Where power is lowest the floor shows, where it is highest the gain; medians, so that what mechanisms do now and then
    /// matters little.
    pub(crate) fn of(errors_w: &[f64], predicted_w: &[f64], averages: &[Average]) -> Self {
        let mut order: Vec<usize> = (0..errors_w.len()).collect();
        order.sort_by(|a, b| predicted_w[*a].abs().total_cmp(&predicted_w[*b].abs()));
        let third = (order.len() / 3).max(1);
        let spread = |places: &[usize]| {
            let mut sizes: Vec<f64> = places.iter().map(|i| errors_w[*i].abs()).collect();
            // The median of a normal distribution's size is 0.6745 σ.
            median(&mut sizes) / 0.6745
        };
        let level = |places: &[usize]| {
            let mut sizes: Vec<f64> = places.iter().map(|i| predicted_w[*i].abs()).collect();
            median(&mut sizes)
        };
        let (low, high) = (&order[..third.min(order.len())], &order[order.len() - third.min(order.len())..]);
        let (a, b) = (spread(low).powi(2), spread(high).powi(2));
        let (p, q) = (level(low).powi(2), level(high).powi(2));
        let gain2 = if q > p { ((b - a) / (q - p)).max(0.0) } else { 0.0 };
        let floor2 = (a - gain2 * p).max(0.05 * a.max(1e-6)).max(1e-6);
        let mut noise = Noise { floor_w: floor2.sqrt(), gain: gain2.sqrt(), rho: 0.0 };
        let scaled: Vec<f64> = errors_w.iter().zip(predicted_w).map(|(e, p)| e / noise.sigma_w(*p)).collect();
        let (mut both, mut own) = (0.0, 0.0);
        for i in 1..scaled.len() {
            if follows(averages, i) {
                let [a, b] = [scaled[i - 1], scaled[i]].map(|z| z.clamp(-3.0, 3.0));
                both += a * b;
                own += a * a;
            }
        }
        noise.rho = if own > 0.0 { (both / own).clamp(0.0, MOST_RHO) } else { 0.0 };
        noise
    }

    /// One-sigma scatter at a power [W].
    pub(crate) fn sigma_w(&self, power_w: f64) -> f64 {
        self.floor_w.hypot(self.gain * power_w)
    }

    /// Divides by the scatter and takes out what the average before tells.
    pub(crate) fn whiten(&self, values: &[f64], predicted_w: &[f64], averages: &[Average]) -> Vec<f64> {
        let scaled: Vec<f64> = values.iter().zip(predicted_w).map(|(e, p)| e / self.sigma_w(*p)).collect();
        let stationary = (1.0 - self.rho * self.rho).sqrt();
        (0..scaled.len())
            .map(|i| {
                if i > 0 && follows(averages, i) {
                    scaled[i] - self.rho * scaled[i - 1]
                } else {
                    stationary * scaled[i]
                }
            })
            .collect()
    }
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
