//! Recordings of many rows a second, brought to means over a tenth of a second.
//!
//! What a robot draws is judged second by second, and nothing that it does takes less than a tenth of one. Rates of change between
//! neighbouring rows of a faster recording are mostly the encoder's steps: force and loss that follow them are not the robot's.

use std::{borrow::Cow, collections::BTreeMap, ops::Range};

use crate::{Channel, Error, Labels, Recording, Run, Watch, unwatched, watch::Looks};

/// Time from row to row that is aimed at [s].
const STEP_S: f64 = 0.1;
/// Steps longer than this stay as they are [s].
const SHORT_S: f64 = 0.06;

impl Recording {
    /// The same drives with rows no closer than about a tenth of a second: means over neighbours of the same run and the same ground, without a
    /// gap between them. Recordings that have no more rows stay as they are.
    pub fn thinned(&self) -> Cow<'_, Recording> {
        // Only a watch that breaks has no answer.
        self.thinned_watched(&unwatched()).unwrap_or(Cow::Borrowed(self))
    }

    /// The same drives as [`Recording::thinned`] has them, followed by a watch.
    ///
    /// # Errors
    /// [`Error::Stopped`] soon after the watch breaks.
    pub fn thinned_watched(&self, watch: &Watch) -> Result<Cow<'_, Recording>, Error> {
        let looks = Looks::new(watch);
        let groups = self.runs.iter().map(|run| self.groups(run, &mut looks.clone()));
        let groups: Vec<Vec<Range<usize>>> = groups.collect::<Result<_, _>>()?;
        if groups.iter().flatten().count() == self.rows() {
            return Ok(Cow::Borrowed(self));
        }
        let all: Vec<Range<usize>> = groups.iter().flatten().cloned().collect();
        let column = |values: &Vec<f64>| -> Result<Vec<f64>, Error> {
            looks.go_on()?;
            Ok(all.iter().map(|rows| mean(&values[rows.clone()])).collect())
        };
        let mut thin = Recording {
            t_s: column(&self.t_s)?,
            channels: columns(&self.channels, column)?,
            aside: columns(&self.aside, column)?,
            surface: self.surface.as_ref().map(|labels| Labels {
                names: labels.names.clone(),
                index: all.iter().map(|rows| labels.index[rows.start]).collect(),
            }),
            runs: Vec::new(),
            reading_ends: match self.reading_ends.is_empty() {
                true => Vec::new(),
                false => all.iter().map(|rows| self.ends_reading(rows.end - 1)).collect(),
            },
            wheel_radius_m: self.wheel_radius_m,
        };
        if let Some(headings_rad) = self.channel(Channel::Heading) {
            let means_rad = all.iter().map(|rows| mean_angle(&headings_rad[rows.clone()])).collect();
            thin.channels.insert(Channel::Heading, means_rad);
        }
        let mut from = 0;
        for (run, groups) in self.runs.iter().zip(&groups) {
            let rows = from..from + groups.len();
            from = rows.end;
            thin.runs.push(Run::new(run.name.clone(), rows, &thin.t_s, run.start_unix_s));
        }
        Ok(Cow::Owned(thin))
    }

    fn ends_reading(&self, row: usize) -> bool {
        self.reading_ends.get(row).copied().unwrap_or(false)
    }

    /// Rows of a run that become one each.
    fn groups(&self, run: &Run, looks: &mut Looks) -> Result<Vec<Range<usize>>, Error> {
        let mut steps_s: Vec<f64> = run.rows.clone().filter_map(|row| self.step_s(run, row)).collect();
        let middle = steps_s.len() / 2;
        let step_s = match steps_s.is_empty() {
            true => STEP_S,
            false => *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1,
        };
        let most = if step_s < SHORT_S { (STEP_S / step_s.max(1e-6)).round() as usize } else { 1 };
        let label = |row: usize| self.surface.as_ref().map(|labels| labels.index[row]);
        let mut groups: Vec<Range<usize>> = Vec::new();
        for row in run.rows.clone() {
            looks.worked(1)?;
            match groups.last_mut() {
                Some(group)
                    if group.len() < most
                        && self.step_s(run, row - 1).is_some()
                        && !self.ends_reading(row - 1)
                        && label(row) == label(group.start) =>
                {
                    group.end = row + 1;
                }
                _ => groups.push(row..row + 1),
            }
        }
        Ok(groups)
    }
}

/// Columns by name, each changed.
fn columns<K: Ord + Clone>(
    from: &BTreeMap<K, Vec<f64>>,
    change: impl Fn(&Vec<f64>) -> Result<Vec<f64>, Error>,
) -> Result<BTreeMap<K, Vec<f64>>, Error> {
    from.iter().map(|(name, values)| Ok((name.clone(), change(values)?))).collect()
}

/// Mean of what is no gap.
fn mean(values: &[f64]) -> f64 {
    let known = || values.iter().filter(|value| value.is_finite());
    known().sum::<f64>() / known().count() as f64
}

/// Mean of angles that may have gone once round.
fn mean_angle(values_rad: &[f64]) -> f64 {
    let of = |part: fn(f64) -> f64| mean(&values_rad.iter().map(|rad| part(*rad)).collect::<Vec<f64>>());
    of(f64::sin).atan2(of(f64::cos))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn recording(step_s: f64, rows: usize) -> Recording {
        let t_s: Vec<f64> = (0..rows).map(|i| step_s * i as f64).collect();
        let power_w = (0..rows).map(|i| i as f64).collect();
        Recording {
            channels: BTreeMap::from([(Channel::Power, power_w)]),
            runs: vec![Run::new("drive".into(), 0..rows, &t_s, None)],
            t_s,
            ..Recording::default()
        }
    }

    #[test]
    fn a_recording_of_fifty_hertz_becomes_one_of_ten() {
        let thin = recording(0.02, 23).thinned().into_owned();
        assert_eq!(thin.channel(Channel::Power), Some(&[2.0, 7.0, 12.0, 17.0, 21.0][..]));
        assert!((thin.t_s[1] - thin.t_s[0] - 0.1).abs() < 1e-12);
        assert_eq!(thin.runs[0].rows, 0..5);
        let slow = recording(0.1, 23);
        assert!(matches!(slow.thinned(), Cow::Borrowed(same) if *same == slow));
        assert!(matches!(thin.thinned(), Cow::Borrowed(_)), "what is thin stays so");
    }

    #[test]
    fn means_leave_out_gaps_and_go_round_with_headings_and_keep_grounds_apart() {
        let mut fast = recording(0.02, 10);
        fast.channels
            .insert(Channel::Heading, vec![PI - 0.01, 0.01 - PI, PI, PI, PI, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let power_w = fast.channels.get_mut(&Channel::Power).unwrap();
        power_w[1..5].fill(f64::NAN);
        let thin = fast.thinned().into_owned();
        assert_eq!(thin.channel(Channel::Power), Some(&[0.0, 7.0][..]));
        assert!((thin.channel(Channel::Heading).unwrap()[0].abs() - PI).abs() < 1e-9);
        fast.surface = Some(Labels {
            names: vec!["a".into(), "b".into()],
            index: [[0; 3].as_slice(), &[1; 7]].concat(),
        });
        let apart = fast.thinned().into_owned();
        assert_eq!(apart.surface.as_ref().map(|labels| labels.index.clone()), Some(vec![0, 1, 1]));
        assert_eq!(apart.channel(Channel::Power).map(|w| w[1..].to_vec()), Some(vec![6.0, 8.5]));
    }

    #[test]
    fn a_gap_is_not_averaged_over() {
        let mut fast = recording(0.02, 10);
        fast.t_s[3..].iter_mut().for_each(|t_s| *t_s += 60.0);
        fast.runs = vec![Run::new("drive".into(), 0..10, &fast.t_s, None)];
        let thin = fast.thinned().into_owned();
        assert_eq!(thin.rows(), 3);
        assert!((thin.t_s[0] - 0.02).abs() < 1e-12 && thin.t_s[1] > 60.0);
    }
}
