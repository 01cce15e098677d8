//! Two grounds in one run: from a border on, rows of a run over another ground.

use recording::{Channel, Recording, Run};

use crate::{Error, real::ground::duration_s};

/// Channels that count on from where they are, and so have to go on without a step.
const COUNTED: [Channel; 4] = [Channel::X, Channel::Y, Channel::Z, Channel::Heading];

/// The last run of a recording up to a time after its beginning, and from then on the rows of a run over another ground; earlier runs
/// stay as they are. Times go on at the rhythm of the other run, positions and headings from where they were.
///
/// # Errors
/// Recordings without rows on both sides of the border.
pub fn splice(
    recording: &Recording,
    border_s: f64,
    other: &Recording,
    run: &Run,
) -> Result<Recording, Error> {
    let last = recording.runs.last().ok_or(Error::NoBorder { border_s })?;
    let began_s = recording.t_s.get(last.rows.start).copied().unwrap_or_default();
    let before = last.rows.clone().filter(|row| recording.t_s[*row] - began_s < border_s).count();
    let end = last.rows.start + before;
    if before == 0 || run.rows.len() < 2 {
        return Err(Error::NoBorder { border_s });
    }
    let first = run.rows.start;
    let step_s = other.t_s[first + 1] - other.t_s[first];
    let moved_s = recording.t_s[end - 1] + step_s - other.t_s[first];
    let mut spliced = recording.clone();
    spliced.t_s.truncate(end);
    spliced.t_s.extend(other.t_s[run.rows.clone()].iter().map(|t_s| t_s + moved_s));
    for (channel, values) in &mut spliced.channels {
        values.truncate(end);
        match other.channel(*channel) {
            Some(new) => {
                let new = &new[run.rows.clone()];
                let from = if COUNTED.contains(channel) { values[end - 1] - new[0] } else { 0.0 };
                values.extend(new.iter().map(|value| value + from));
            }
            None => values.extend(vec![f64::NAN; run.rows.len()]),
        }
    }
    if let Some(last) = spliced.runs.last_mut() {
        last.rows.end = end + run.rows.len();
    }
    Ok(spliced)
}

/// The same runs with the longest one last.
pub(crate) fn longest_last(recording: &Recording) -> Vec<usize> {
    let mut order: Vec<usize> = (0..recording.runs.len()).collect();
    let lasts_s = |run: &usize| duration_s(recording, &recording.runs[*run]);
    if let Some(longest) = order.iter().copied().max_by(|a, b| lasts_s(a).total_cmp(&lasts_s(b))) {
        order.retain(|run| *run != longest);
        order.push(longest);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::ground::tests::drives;

    #[test]
    fn time_goes_on_rising_positions_without_a_step_and_the_rest_is_that_of_the_other_ground() {
        let mut here = drives(&[50, 100], 0.0);
        here.channels.insert(Channel::X, (0..150).map(|i| f64::from(i) * 0.05).collect());
        let mut there = drives(&[80, 60], 0.2);
        there.channels.insert(Channel::X, (0..140).map(|i| 100.0 + f64::from(i) * 0.05).collect());
        let spliced = splice(&here, 4.0, &there, &there.runs[1]).unwrap();
        assert_eq!((spliced.rows(), spliced.runs[1].rows.clone()), (50 + 40 + 60, 50..150));
        assert_eq!(spliced.t_s[..90], here.t_s[..90]);
        let times_s = &spliced.t_s[50..];
        assert!(times_s.windows(2).all(|pair| (pair[1] - pair[0] - 0.1).abs() < 1e-9), "{times_s:?}");
        let x_m = &spliced.channel(Channel::X).unwrap()[50..];
        assert!(x_m.windows(2).all(|pair| (0.0..0.06).contains(&(pair[1] - pair[0]))), "{x_m:?}");
        let pitch_rad = spliced.channel(Channel::Pitch).unwrap();
        assert_eq!([pitch_rad[89], pitch_rad[90]], [0.0, 0.2]);
    }

    #[test]
    fn a_border_before_the_beginning_is_refused_and_the_longest_run_is_the_one_that_is_cut() {
        let here = drives(&[50, 100, 20], 0.0);
        assert!(matches!(splice(&here, 0.0, &here, &here.runs[1]), Err(Error::NoBorder { .. })));
        assert_eq!(longest_last(&here), [0, 2, 1]);
    }
}
