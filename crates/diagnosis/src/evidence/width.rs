//! Standard deviations of priors that are known to an order of magnitude only.

/// Factors by which a prior standard deviation may be too small.
pub(crate) const WIDTHS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// Log priors of the widths, which are twice as wide each.
pub(crate) fn log_priors() -> [f64; WIDTHS.len()] {
    halving_log_priors()
}

/// Log priors of so many amplitudes, each half as likely as the one before.
pub(crate) fn halving_log_priors<const COUNT: usize>() -> [f64; COUNT] {
    let half = |i: usize| 0.5_f64.powi(i as i32);
    let total: f64 = (0..COUNT).map(half).sum();
    std::array::from_fn(|i| (half(i) / total).ln())
}

/// The likeliest width of sizes together, its log prior, and the log density of the sizes with it, all in prior standard deviations and but for
/// constants that do not depend on them.
pub(crate) fn likeliest(sizes: &[f64]) -> (f64, f64, f64) {
    let squares: f64 = sizes.iter().map(|x| x * x).sum();
    let of = |(by, log_prior): (f64, f64)| {
        (by, log_prior, log_prior - 0.5 * squares / (by * by) - sizes.len() as f64 * by.ln())
    };
    let all = WIDTHS.into_iter().zip(log_priors()).map(of);
    all.max_by(|a, b| a.2.total_cmp(&b.2)).unwrap_or((WIDTHS[0], 0.0, -0.5 * squares))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn priors_of_widths_sum_to_one_and_large_sizes_have_wide_ones() {
        assert!((log_priors().map(f64::exp).iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let width = |sizes: &[f64]| likeliest(sizes).0;
        assert_eq!((width(&[]), width(&[0.0]), width(&[1.5])), (1.0, 1.0, 1.0));
        assert_eq!((width(&[4.0]), width(&[12.0]), width(&[0.3, 12.0])), (4.0, 8.0, 8.0));
        // Twelve prior standard deviations cost ln 15 + ln 8 + ½ 1.5² = 5.9 and not 72.
        assert!((likeliest(&[12.0]).2 + 15.0_f64.ln() + 8.0_f64.ln() + 1.125).abs() < 1e-12);
    }
}
