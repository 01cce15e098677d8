//! A part of long recordings that stands for all: stretches spread evenly over every run.

use std::{borrow::Cow, ops::Range};

use crate::{Labels, Recording, Run};

/// Length of a stretch \[s\]: longer than manoeuvres and than what smooths averages.
const STRETCH_S: f64 = 60.0;

impl Recording {
    /// The same drives, or of more than so many seconds evenly spread stretches of a minute, each a run of its own.
    pub fn sampled(&self, most_s: f64) -> Cow<'_, Recording> {
        let lasts_s = self.duration_s();
        if lasts_s <= most_s {
            return Cow::Borrowed(self);
        }
        let every = lasts_s / most_s;
        let (mut runs, mut next) = (Vec::new(), 0.0);
        for (i, (run, rows)) in self.stretches().into_iter().enumerate() {
            if i as f64 >= next {
                next += every;
                runs.push((run, rows));
            }
        }
        Cow::Owned(self.only(&runs))
    }

    /// Duration of all runs \[s\].
    pub fn duration_s(&self) -> f64 {
        let of_run = |run: &Run| {
            let end = run.rows.end.saturating_sub(1);
            self.t_s.get(end).zip(self.t_s.get(run.rows.start)).map_or(0.0, |(end, start)| end - start)
        };
        self.runs.iter().map(of_run).sum()
    }

    /// All runs cut into stretches.
    fn stretches(&self) -> Vec<(&Run, Range<usize>)> {
        let mut stretches = Vec::new();
        for run in &self.runs {
            let times = &self.t_s[run.rows.clone()];
            let mut start = 0;
            while start < times.len() {
                let end = times.partition_point(|t_s| *t_s < times[start] + STRETCH_S).max(start + 1);
                stretches.push((run, run.rows.start + start..run.rows.start + end));
                start = end;
            }
        }
        stretches
    }

    fn only(&self, runs: &[(&Run, Range<usize>)]) -> Recording {
        let column = |values: &Vec<f64>| -> Vec<f64> {
            runs.iter().flat_map(|(_, rows)| values[rows.clone()].iter().copied()).collect()
        };
        let label = |labels: &Labels| Labels {
            names: labels.names.clone(),
            index: runs.iter().flat_map(|(_, rows)| labels.index[rows.clone()].iter().copied()).collect(),
        };
        let mut part = Recording {
            t_s: column(&self.t_s),
            channels: self.channels.iter().map(|(channel, values)| (*channel, column(values))).collect(),
            aside: self.aside.iter().map(|(name, values)| (name.clone(), column(values))).collect(),
            surface: self.surface.as_ref().map(label),
            runs: Vec::new(),
        };
        let mut from = 0;
        for (i, (run, rows)) in runs.iter().enumerate() {
            let own = from..from + rows.len();
            from = own.end;
            part.runs.push(Run {
                name: format!("{} {}", run.name, i + 1),
                rows: own,
                gap_s: run.gap_s,
                start_unix_s: run.start_unix_s,
            });
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use crate::{Channel, Recording, Run};

    fn drives(seconds: usize) -> Recording {
        let rows = 10 * seconds;
        let t_s: Vec<f64> = (0..rows).map(|row| row as f64 / 10.0).collect();
        let power_w: Vec<f64> = t_s.clone();
        let run = |name: &str, rows| Run { name: name.into(), rows, gap_s: 1.0, start_unix_s: None };
        let runs = vec![run("a", 0..rows / 2), run("b", rows / 2..rows)];
        Recording { t_s, channels: [(Channel::Power, power_w)].into(), runs, ..Recording::default() }
    }

    #[test]
    fn a_short_recording_stays_whole_and_a_long_one_is_spread_over_all_of_it() {
        let short = drives(600);
        assert_eq!(*short.sampled(600.0), short);
        let long = drives(6000);
        assert!((long.duration_s() - 5999.8).abs() < 1e-6, "{}", long.duration_s());
        let part = long.sampled(600.0).into_owned();
        assert!((part.rows() as f64 / 6000.0 - 1.0).abs() < 0.11, "{}", part.rows());
        assert_eq!(part.channel(Channel::Power).unwrap(), part.t_s, "rows stay together");
        let named = |name: &str| part.runs.iter().filter(|run| run.name.starts_with(name)).count();
        assert!(named("a").abs_diff(named("b")) <= 1, "{:?}", part.runs);
        assert_eq!(part.runs.last().unwrap().rows.end, part.rows());
        assert!(part.runs.windows(2).all(|pair| pair[0].rows.end == pair[1].rows.start));
    }
}
