//! Rows that lie too far apart for what robots do between them.

use recording::Recording;

/// Rows farther apart see no change of speed \[s\]: wheels of a Husky take one to two seconds from a speed to another.
const MOST_STEP_S: f64 = 2.0;

/// What has to be said of rows that miss what happens between them.
pub(crate) fn rhythm_note(recording: &Recording) -> Option<String> {
    let steps = recording.runs.iter().flat_map(|run| run.rows.clone().skip(1));
    let mut steps_s: Vec<f64> = steps.map(|row| recording.t_s[row] - recording.t_s[row - 1]).collect();
    let middle = steps_s.len() / 2;
    if steps_s.is_empty() {
        return None;
    }
    let step_s = *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1;
    (step_s > MOST_STEP_S).then(|| {
        format!(
            "rows lie {step_s:.1} s apart, and robots start, stop and turn within that: energies are those of straight lines from row to row; if rows lie \
             closer, `t_s` is not in seconds"
        )
    })
}
