//! Which stretches of long drives are compared: after half an hour a diagnosis is limited by what the model misses, and not by noise.

use calibration::{Drives, average};

/// Driving of one kind that is compared \[s\].
const MOST_S: f64 = 1800.0;
/// Length of the stretches that are compared or left out as a whole \[s\]: those by which held-out errors go.
const STRETCH_S: f64 = 60.0;
/// Rows beside a stretch that what is late or is smoothed is told by \[s\].
const MARGIN_S: f64 = 3.0;

/// The stretches of drives that are compared.
pub(crate) struct Sample {
    /// By row: whether predictions need it; empty where they need all.
    needed: Vec<bool>,
    /// Driving that there is [s].
    pub(crate) driven_s: f64,
    /// Driving that is compared [s].
    pub(crate) compared_s: f64,
}

impl Sample {
    /// Leaves so many stretches of drives that they can be compared, evenly over all of them.
    pub(crate) fn of(drives: &mut Drives) -> Self {
        Sample::at_most(drives, MOST_S)
    }

    fn at_most(drives: &mut Drives, most_s: f64) -> Self {
        let driven_s = driven_s(&drives.averages);
        if driven_s <= most_s {
            return Sample { needed: Vec::new(), driven_s, compared_s: driven_s };
        }
        let share = most_s / driven_s;
        let mut so_far_s = 0.0;
        drives.averages.retain(|average| {
            let stretch = (so_far_s / STRETCH_S).floor();
            so_far_s += average.duration_s;
            ((stretch + 1.0) * share).floor() > (stretch * share).floor()
        });
        let mut needed = vec![false; drives.rows.len()];
        for average in &drives.averages {
            let t_s = |row: usize| drives.rows[row].t_s;
            let (Some(first), Some(last)) = (average.rows.clone().next(), average.rows.clone().next_back())
            else {
                continue;
            };
            let (mut from, mut to) = (first, last);
            while from > 0 && (0.0..MARGIN_S).contains(&(t_s(first) - t_s(from - 1))) {
                from -= 1;
            }
            while to + 1 < needed.len() && (0.0..MARGIN_S).contains(&(t_s(to + 1) - t_s(last))) {
                to += 1;
            }
            needed[from..=to].fill(true);
        }
        Sample { needed, driven_s, compared_s: self::driven_s(&drives.averages) }
    }

    /// Whether a row is needed.
    #[inline]
    pub(crate) fn needs(&self, row: usize) -> bool {
        self.needed.get(row).copied().unwrap_or(true)
    }

    /// What a report says of drives that were not compared as a whole.
    pub(crate) fn words(&self, of: &str) -> Option<String> {
        let Sample { driven_s, compared_s, .. } = self;
        (compared_s < driven_s).then(|| {
            format!(
                "of {driven_s:.0} s of {of}, {compared_s:.0} s were compared, stretches of {STRETCH_S:.0} s evenly over all of them: what lasts \
                 less than two minutes and lies between them is not seen"
            )
        })
    }
}

fn driven_s(averages: &[average::Average]) -> f64 {
    averages.iter().map(|average| average.duration_s).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::hills::drive;

    #[test]
    fn stretches_that_are_compared_lie_evenly_and_all_rows_about_them_are_predicted() {
        let robot = model::builtin::husky_a200();
        let recording = drive(&robot, 0.0, &[]);
        let mut drives = Drives::new(&robot, &recording).unwrap();
        let all = drives.averages.len();
        let sample = Sample::at_most(&mut drives, 300.0);
        assert!((sample.compared_s - 300.0).abs() <= 60.0, "{} s", sample.compared_s);
        assert!(
            drives.averages.len() < all && sample.words("driving").unwrap().contains("300 s were compared")
        );
        let last_s = recording.t_s.last().unwrap() - recording.t_s[0];
        let in_first_half = drives.averages.iter().filter(|a| a.t_s < last_s / 2.0).count();
        assert!((2 * in_first_half).abs_diff(drives.averages.len()) <= 120, "{in_first_half}");
        for average in &drives.averages {
            assert!(average.rows.clone().all(|row| sample.needs(row)));
        }
        assert!((0..drives.rows.len()).any(|row| !sample.needs(row)));
    }
}
