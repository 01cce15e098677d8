//! How far few or neighbouring blocks stand for many that are apart.

/// Blocks over which errors may hang together: an inclinometer that wanders does over a minute.
const BLOCKS: usize = 4;
/// Most of it: what wanders for a minute made 1.25, and what the form of a strong effect misses in the few blocks that hold it is no reason
/// to doubt that it is there.
const MOST: f64 = 1.5;

/// Variance of a sum over blocks, over that of as many that do not hang together; 1 where they do not, or speak against each other (Newey
/// and West, Econometrica 55, 1987). `scores` are products of what is explained and what is left, block by block.
pub(super) fn lasting(scores: &[f64]) -> f64 {
    let lagged = |lag: usize| -> f64 {
        let later = scores.get(lag..).unwrap_or_default();
        scores.iter().zip(later).map(|(one, other)| one * other).sum()
    };
    let weight = |lag: usize| 2.0 * (1.0 - lag as f64 / (BLOCKS + 1) as f64);
    let together: f64 = (1..=BLOCKS).map(|lag| weight(lag) * lagged(lag)).sum();
    (1.0 + together / lagged(0).max(1e-300)).clamp(1.0, MOST)
}

/// Among how many parts something is spread, of which each has so much: as many as there are if each has as much of it, one if one holds all.
pub(crate) fn spread(shares: &[f64]) -> f64 {
    let squares: f64 = shares.iter().map(|share| share * share).sum();
    shares.iter().sum::<f64>().powi(2) / squares.max(1e-300)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_that_hang_together_count_as_fewer() {
        let alternating: Vec<f64> = (0..60).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(lasting(&alternating), 1.0);
        // Two neighbours are alike in every seven blocks, and the rest are nothing.
        let pairs: Vec<f64> = (0..600).map(|i| [1.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0][i % 7]).collect();
        let expected = 1.0 + 2.0 * 0.8 * 0.3 / 1.09;
        assert!((lasting(&pairs) - expected).abs() < 0.02, "{}", lasting(&pairs));
        assert_eq!(lasting(&[]), 1.0);
        assert_eq!(lasting(&[2.0, 2.0]), MOST);
    }

    #[test]
    fn what_few_blocks_hold_is_spread_among_few() {
        assert_eq!(spread(&[3.0; 40]), 40.0);
        assert!((spread(&[1.0, 1.0, 1.0, 1e-9, 0.0]) - 3.0).abs() < 1e-6);
        assert_eq!(spread(&[]), 0.0);
    }
}
