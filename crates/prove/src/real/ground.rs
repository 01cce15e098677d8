//! One ground: a recording file of a real robot, and its runs.

use std::path::Path;

use recording::{Labels, Recording, Run, read_paths};

use crate::Error;

/// Drives of one robot over one ground.
#[derive(Clone, Debug)]
pub struct Ground {
    /// The surface that its rows name, or else the name of its file.
    pub name: String,
    /// All of its runs, without the name of the surface, which would give a change of it away.
    pub recording: Recording,
}

impl Ground {
    /// Reads the drives over one ground.
    ///
    /// # Errors
    /// A file that is no recording, and one with too few runs to keep a healthy half apart.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let (recording, _) = read_paths(&[path], None)
            .map_err(|source| Error::Recording { path: path.into(), source: Box::new(source) })?;
        let file = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let named = recording.surface.as_ref().and_then(|surface| surface.names.first().cloned());
        Ground::new(named.unwrap_or(file), recording).ok_or_else(|| Error::FewRuns { path: path.into() })
    }

    /// A ground of drives at hand; none of fewer than three runs.
    pub fn new(name: String, recording: Recording) -> Option<Self> {
        (recording.runs.len() >= LEAST_RUNS)
            .then_some(Ground { name, recording: Recording { surface: None, ..recording } })
    }

    /// All of its runs, with its name as their surface.
    pub(crate) fn labelled(&self) -> Recording {
        let surface = Some(Labels::constant(&self.name, self.recording.rows()));
        Recording { surface, ..self.recording.clone() }
    }

    /// Some of its runs, in the order given.
    pub fn part(&self, runs: &[usize]) -> Recording {
        part(&self.recording, runs)
    }

    /// Time from the first to the last row of a run [s].
    pub fn duration_s(&self, run: usize) -> f64 {
        self.recording.runs.get(run).map_or(0.0, |run| duration_s(&self.recording, run))
    }
}

/// Two runs to calibrate on, so that each can judge the other, and one to diagnose.
const LEAST_RUNS: usize = 3;

/// Time from the first to the last row of a run [s].
pub(crate) fn duration_s(recording: &Recording, run: &Run) -> f64 {
    let times_s = recording.t_s.get(run.rows.clone()).unwrap_or_default();
    times_s.last().zip(times_s.first()).map_or(0.0, |(last_s, first_s)| last_s - first_s)
}

/// Some runs of a recording, in the order given.
pub(crate) fn part(recording: &Recording, runs: &[usize]) -> Recording {
    let chosen: Vec<&Run> = runs.iter().filter_map(|run| recording.runs.get(*run)).collect();
    let pick = |values: &[f64]| -> Vec<f64> {
        chosen.iter().flat_map(|run| values[run.rows.clone()].iter().copied()).collect()
    };
    let mut end = 0;
    let moved = chosen.iter().map(|run| {
        let start = end;
        end += run.rows.len();
        Run { rows: start..end, ..(*run).clone() }
    });
    Recording {
        runs: moved.collect(),
        t_s: pick(&recording.t_s),
        channels: recording.channels.iter().map(|(channel, values)| (*channel, pick(values))).collect(),
        reading_ends: chosen
            .iter()
            .flat_map(|run| recording.reading_ends.get(run.rows.clone()).unwrap_or_default().iter().copied())
            .collect(),
        ..Recording::default()
    }
}

/// The same drives under names that tell nothing of ground and day.
pub(crate) fn nameless(recording: Recording) -> Recording {
    let named = |(i, run): (usize, Run)| Run { name: format!("drive-{}", i + 1), ..run };
    Recording { runs: recording.runs.into_iter().enumerate().map(named).collect(), ..recording }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::collections::BTreeMap;

    use recording::Channel;

    use super::*;

    /// Runs of so many rows at 10 Hz: straight on at 0.5 m/s with 4 A a side on a slope.
    pub(crate) fn drives(rows: &[usize], pitch_rad: f64) -> Recording {
        let all: usize = rows.iter().sum();
        let channels = [
            (Channel::LeftSpeed, 0.5),
            (Channel::RightSpeed, 0.5),
            (Channel::YawRate, 0.0),
            (Channel::Pitch, pitch_rad),
            (Channel::Roll, 0.0),
            (Channel::LeftMotorCurrent, 4.0),
            (Channel::RightMotorCurrent, 4.0),
        ];
        let mut end = 0;
        let run = |(i, rows): (usize, &usize)| {
            let start = end;
            end += rows;
            Run { name: format!("there-{i}"), rows: start..end, gap_s: 0.5, start_unix_s: None }
        };
        let runs: Vec<Run> = rows.iter().enumerate().map(run).collect();
        Recording {
            t_s: rows.iter().flat_map(|rows| (0..*rows).map(|i| i as f64 / 10.0)).collect(),
            channels: channels
                .map(|(channel, value)| (channel, vec![value; all]))
                .into_iter()
                .collect::<BTreeMap<_, _>>(),
            surface: Some(Labels::constant("marble", all)),
            runs,
            ..Recording::default()
        }
    }

    #[test]
    fn a_part_holds_the_runs_asked_for_and_no_name_of_the_ground() {
        let ground = Ground::new("marble".into(), drives(&[10, 20, 30], 0.0)).unwrap();
        let part = nameless(ground.part(&[2, 0]));
        assert_eq!((part.rows(), part.runs[0].rows.clone(), part.runs[1].rows.clone()), (40, 0..30, 30..40));
        assert_eq!((part.runs[0].name.as_str(), part.surface), ("drive-1", None));
        assert!((ground.duration_s(2) - 2.9).abs() < 1e-9);
        assert!(Ground::new("marble".into(), drives(&[10, 20], 0.0)).is_none());
    }
}
