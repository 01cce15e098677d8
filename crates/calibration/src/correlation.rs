//! How errors of neighbouring seconds hang together.

/// Errors that are white noise and a first-order process added: neighbours k apart in a series are alike by
///
/// ```text
/// ρ_k = a φ^k,   k ≥ 1
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// a: share of the variance that the process has.
    pub share: f64,
    /// φ: how much of it stays from one value to the next.
    pub stays: f64,
}

/// What stays longer than this is no different from an offset of a run, of which few seconds say nothing.
const MOST_STAYS: f64 = 0.9;

impl Correlation {
    /// Errors that have nothing to do with one another.
    pub const NONE: Correlation = Correlation { share: 0.0, stays: 0.0 };

    /// From the first two autocorrelations, φ = ρ₂/ρ₁ and a = ρ₁/φ. Of white noise the first lies within 2/√n of zero; then there is
    /// no process.
    pub(crate) fn of(errors: &[f64], series: &[usize]) -> Correlation {
        let alike = |apart: usize| {
            let pairs = (apart..errors.len()).filter(|&i| series[i] == series[i - apart]);
            let (product, square, count) = pairs.fold((0.0, 0.0, 0usize), |(product, square, count), i| {
                (product + errors[i] * errors[i - apart], square + errors[i - apart].powi(2), count + 1)
            });
            (if square > 0.0 { product / square } else { 0.0 }, count)
        };
        let ((first, count), (second, _)) = (alike(1), alike(2));
        if first * (count as f64).sqrt() < 2.0 {
            return Correlation::NONE;
        }
        // A process alone has φ = ρ₁; white noise beside it makes the ratio larger.
        let stays = (second / first).clamp(first.min(MOST_STAYS), MOST_STAYS);
        Correlation { share: (first / stays).min(1.0), stays }
    }

    /// Variance of a mean of many neighbours over that of as many that have nothing to do with one another.
    pub(crate) fn inflation(self) -> f64 {
        1.0 + 2.0 * self.share * self.stays / (1.0 - self.stays)
    }

    /// Adds to every value what its neighbours of the same series are alike with it: `R x`.
    pub(crate) fn spread(self, values: &mut [f64], series: &[usize]) {
        let own = values.to_vec();
        let follows = |i: usize| series[i] == series[i - 1];
        let (mut behind, mut ahead) = (0.0, 0.0);
        for i in 1..own.len() {
            behind = if follows(i) { self.stays * (behind + own[i - 1]) } else { 0.0 };
            values[i] += self.share * behind;
        }
        for i in (1..own.len()).rev() {
            ahead = if follows(i) { self.stays * (ahead + own[i]) } else { 0.0 };
            values[i - 1] += self.share * ahead;
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn white_noise_and_a_process_are_told_apart() {
        let mut random = Pcg64Mcg::new(5);
        let mut uniform = || random.random_range(-1.0..1.0f64);
        let mut slow = 0.0;
        // Both of variance 1/3.
        let errors: Vec<f64> = (0..200_000)
            .map(|_| {
                slow = 0.8 * slow + 0.6 * uniform();
                slow + uniform()
            })
            .collect();
        let found = Correlation::of(&errors, &vec![0; errors.len()]);
        assert_relative_eq!(found.share, 0.5, epsilon = 0.02);
        assert_relative_eq!(found.stays, 0.8, epsilon = 0.02);
        let white: Vec<f64> = (0..100).map(|_| uniform()).collect();
        assert_eq!(Correlation::of(&white, &[0; 100]), Correlation::NONE);
    }

    #[test]
    fn spreading_is_the_product_with_the_matrix_of_correlations_series_by_series() {
        let (correlation, series) = (Correlation { share: 0.6, stays: 0.5 }, [0, 0, 0, 1, 1]);
        let x = [1.0, -2.0, 3.0, 0.5, 4.0];
        let mut spread = x;
        correlation.spread(&mut spread, &series);
        for i in 0..x.len() {
            let alike = |j: usize| match i.abs_diff(j) {
                0 => 1.0,
                _ if series[i] != series[j] => 0.0,
                apart => 0.6 * 0.5f64.powi(apart as i32),
            };
            let row: f64 = (0..x.len()).map(|j| alike(j) * x[j]).sum();
            assert_relative_eq!(spread[i], row, epsilon = 1e-12);
        }
    }
}
