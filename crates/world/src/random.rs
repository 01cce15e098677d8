//! Random numbers that depend on a seed and on what they are for, and on nothing else.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    source: Pcg64Mcg,
    spare: Option<f64>,
}

impl Random {
    /// The stream of a seed for one purpose; streams of other purposes do not move it.
    pub(crate) fn new(seed: u64, purpose: &str) -> Self {
        // FNV-1a, 64 bits: offset basis and prime of the published algorithm.
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for byte in seed.to_le_bytes().iter().chain(purpose.as_bytes()) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        Random { source: Pcg64Mcg::seed_from_u64(hash), spare: None }
    }

    /// A number from a range, evenly.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.source.random::<f64>()
    }

    /// A number from a range, evenly on a logarithmic scale; both ends positive.
    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Whether something of this probability happens.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.source.random::<f64>() < probability
    }

    /// One of a list.
    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[((self.source.random::<f64>() * from.len() as f64) as usize).min(from.len() - 1)]
    }

    /// A seed for something else.
    pub(crate) fn seed(&mut self) -> u64 {
        // Files carry seeds as numbers that a double holds exactly.
        self.source.random::<u64>() >> 12
    }

    /// A number from the standard normal distribution, by the polar form of Box and Muller.
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let square = a * a + b * b;
            if square > 0.0 && square < 1.0 {
                let scale = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(b * scale);
                return a * scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn purposes_are_streams_of_their_own_and_seeds_give_the_same_again() {
        let first = |seed, purpose| Random::new(seed, purpose).normal();
        assert_eq!(first(1, "gyro"), first(1, "gyro"));
        assert_ne!(first(1, "gyro"), first(2, "gyro"));
        assert_ne!(first(1, "gyro"), first(1, "power"));
    }

    #[test]
    fn normal_numbers_have_mean_zero_and_variance_one() {
        let mut random = Random::new(5, "test");
        let values: Vec<f64> = (0..20_000).map(|_| random.normal()).collect();
        let mean = values.iter().sum::<f64>() / 20_000.0;
        let variance = values.iter().map(|x| x * x).sum::<f64>() / 20_000.0;
        // Standard errors are 0.007 and 0.010.
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.04, "{mean} {variance}");
    }
}
