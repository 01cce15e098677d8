//! Parts of recordings, for drives that are to play the suspect's role.

use recording::{Labels, Recording, Run};

/// A recording's drives taken apart: some, and all others; a lone drive is cut into its halves.
///
/// Each pair is a suspect, of so many seconds at least where there are as many, and what it is held against.
pub(crate) fn one_and_others(recording: &Recording, least_s: f64) -> Vec<(Recording, Recording)> {
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
    let groups = grouped(recording, least_s);
    let others = |i: usize| -> Vec<Run> {
        groups.iter().enumerate().filter(|(j, _)| *j != i).flat_map(|(_, runs)| runs.to_vec()).collect()
    };
    (0..groups.len())
        .map(|i| (of_runs(recording, groups[i]), of_runs(recording, &others(i))))
        .filter(|(_, others)| !others.runs.is_empty())
        .collect()
}

/// Neighbouring drives that are so long together; two groups at least.
fn grouped(recording: &Recording, least_s: f64) -> Vec<&[Run]> {
    let runs = &recording.runs;
    let seconds = |run: &Run| {
        let times = &recording.t_s[run.rows.clone()];
        times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first)
    };
    let (mut groups, mut start, mut length_s) = (Vec::new(), 0, 0.0);
    for (i, run) in runs.iter().enumerate() {
        length_s += seconds(run);
        if length_s >= least_s {
            groups.push(start..i + 1);
            (start, length_s) = (i + 1, 0.0);
        }
    }
    // What is left over is too short by itself.
    let several = groups.len() > 1;
    match groups.last_mut() {
        Some(last) if several => last.end = runs.len(),
        _ => groups = vec![0..runs.len() / 2, runs.len() / 2..runs.len()],
    }
    groups.into_iter().map(|group| &runs[group]).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives of so many seconds, a row each.
    fn drives(seconds: &[usize]) -> Recording {
        let mut recording = Recording::default();
        for (i, &count) in seconds.iter().enumerate() {
            let start = recording.t_s.len();
            recording.t_s.extend((0..=count).map(|t| t as f64));
            let rows = start..recording.t_s.len();
            recording.runs.push(Run { name: format!("{i}"), rows, gap_s: 5.0, start_unix_s: None });
        }
        recording
    }

    fn names(seconds: &[usize]) -> Vec<String> {
        let pairs = one_and_others(&drives(seconds), 120.0);
        let listed =
            |part: &Recording| part.runs.iter().map(|run| run.name.clone()).collect::<Vec<_>>().join(" ");
        pairs.iter().map(|(one, others)| format!("{} | {}", listed(one), listed(others))).collect()
    }

    #[test]
    fn short_drives_go_together_until_they_are_long_enough() {
        assert_eq!(names(&[200, 300]), ["0 | 1", "1 | 0"]);
        assert_eq!(names(&[250, 20, 25, 270, 150]), ["0 | 1 2 3 4", "1 2 3 | 0 4", "4 | 0 1 2 3"]);
        assert_eq!(names(&[130, 130, 40]), ["0 | 1 2", "1 2 | 0"]);
        assert_eq!(names(&[30, 40, 20]), ["0 | 1 2", "1 2 | 0"], "even where all are short");
        assert_eq!(names(&[300]), ["0 (first half) | 0 (second half)", "0 (second half) | 0 (first half)"]);
    }
}
