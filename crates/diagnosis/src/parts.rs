//! Parts of recordings, for drives that are to play the suspect's role.

use recording::{Labels, Recording, Run};

/// A recording's drives taken apart: one, and all others; a lone drive is cut into its halves.
///
/// Each pair is a suspect and what it is held against.
pub(crate) fn one_and_others(recording: &Recording) -> Vec<(Recording, Recording)> {
    if let [run] = &recording.runs[..] {
        let middle = run.rows.start + run.rows.len() / 2;
        let half = |rows: std::ops::Range<usize>, name: &str| Run {
            name: format!("{} ({name} half)", run.name),
            rows,
            ..run.clone()
        };
        let first = of_runs(recording, &[half(run.rows.start..middle, "first")]);
        let second = of_runs(recording, &[half(middle..run.rows.end, "second")]);
        return vec![(first.clone(), second.clone()), (second, first)];
    }
    let others = |i: usize| -> Vec<Run> {
        recording.runs.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, run)| run.clone()).collect()
    };
    (0..recording.runs.len())
        .map(|i| (of_runs(recording, &recording.runs[i..=i]), of_runs(recording, &others(i))))
        .collect()
}

/// The rows of some drives.
fn of_runs(recording: &Recording, runs: &[Run]) -> Recording {
    let pick = |values: &[f64]| -> Vec<f64> {
        runs.iter().flat_map(|run| values[run.rows.clone()].iter().copied()).collect()
    };
    let mut at = 0;
    let moved = |run: &Run| {
        let rows = at..at + run.rows.len();
        at = rows.end;
        Run { rows, ..run.clone() }
    };
    Recording {
        t_s: pick(&recording.t_s),
        channels: recording.channels.iter().map(|(channel, values)| (*channel, pick(values))).collect(),
        aside: recording.aside.iter().map(|(name, values)| (name.clone(), pick(values))).collect(),
        surface: recording.surface.as_ref().map(|labels| Labels {
            names: labels.names.clone(),
            index: runs.iter().flat_map(|run| labels.index[run.rows.clone()].iter().copied()).collect(),
        }),
        runs: runs.iter().map(moved).collect(),
    }
}
