//! How often drives came through a part of the ground.

use crate::{average::Average, evidence::spread, region::Region};

/// Blocks that have to speak for a mechanism: one visit is an event, not evidence.
pub(crate) const LEAST: f64 = 6.0;

/// The suspect drives, cut into blocks.
pub(crate) struct Visits<'a> {
    averages: &'a [Average],
    /// Number of the block of each average.
    blocks: Vec<usize>,
}

impl<'a> Visits<'a> {
    /// Of averages, with the number of each one's block.
    pub(crate) fn of(averages: &'a [Average], blocks: Vec<usize>) -> Self {
        Visits { averages, blocks }
    }

    /// Blocks that what suspect drives went through of a region would fill if it lay in each alike: (Σ n)² / Σ n² of the averages n
    /// of every block that lie in it.
    fn count(&self, region: Region) -> f64 {
        let mut within = vec![0.0; self.blocks.iter().max().map_or(0, |last| last + 1)];
        for (average, block) in self.averages.iter().zip(&self.blocks) {
            if average.suspect && region.contains(average.input.position_m) {
                within[*block] += 1.0;
            }
        }
        spread(&within)
    }

    /// Whether drives came through a region often enough to tell it from what happened once.
    pub(crate) fn are_enough(&self, region: Region) -> bool {
        self.count(region) >= LEAST
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    #[test]
    fn a_long_stay_is_one_visit_and_coming_back_counts() {
        let at = |x_m: f64| {
            let input = Input { position_m: [x_m, 0.0], ..Input::default() };
            Average { channel: 0, run: 0, suspect: true, t_s: 0.0, input }
        };
        // Ten blocks of ten averages: all of the first in the west, one of each in the east.
        let averages: Vec<Average> = (0..100)
            .map(|i| {
                at(if i < 10 {
                    -5.0
                } else if i % 10 == 0 {
                    5.0
                } else {
                    0.0
                })
            })
            .collect();
        let visits = Visits::of(&averages, (0..100).map(|i| i / 10).collect());
        let between = |x_m: [f64; 2]| Region { x_m, y_m: [-1.0, 1.0] };
        let counts = [[-9.0, -1.0], [1.0, 9.0], [20.0, 30.0]].map(|x_m| visits.count(between(x_m)));
        assert_eq!(counts, [1.0, 9.0, 0.0]);
        assert!(!visits.are_enough(between([-9.0, -1.0])) && visits.are_enough(between([1.0, 9.0])));
    }
}
