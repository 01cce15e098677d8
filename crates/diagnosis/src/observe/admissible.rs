//! Whether drives can be diagnosed at all, before anything is fitted.

use recording::{Channel, Recording, Run};

use crate::Error;

/// Rows may be so far apart \[s\]: speeds change within a second or two, and averages are of one.
const MOST_STEP_S: f64 = 5.0;

/// Refuses times that cannot be those of a drive log, rows that are too far apart, and drives that are among the healthy ones.
///
/// # Errors
/// See above.
pub(crate) fn check(suspect: &Recording, healthy: Option<&Recording>) -> Result<(), Error> {
    for recording in [Some(suspect), healthy].into_iter().flatten() {
        recording.check_time()?;
        let step_s = median_step_s(recording);
        if step_s > MOST_STEP_S {
            return Err(Error::TooCoarse { step_s, most_s: MOST_STEP_S });
        }
    }
    let Some(healthy) = healthy else { return Ok(()) };
    for run in &suspect.runs {
        if let Some(same) = healthy.runs.iter().find(|other| are_same((suspect, run), (healthy, other))) {
            return Err(Error::Same { drive: run.name.clone(), healthy: same.name.clone() });
        }
    }
    Ok(())
}

/// Time between neighbouring rows of a run in the median; 0 of nothing \[s\].
fn median_step_s(recording: &Recording) -> f64 {
    let times = recording.runs.iter().filter_map(|run| recording.t_s.get(run.rows.clone()));
    let mut steps: Vec<f64> = times.flat_map(|t_s| t_s.windows(2).map(|pair| pair[1] - pair[0])).collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// Whether two runs hold the same values to the last digit: noise never comes twice.
fn are_same((suspect, run): (&Recording, &Run), (healthy, other): (&Recording, &Run)) -> bool {
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let of = |recording: &Recording, run: &Run, channel: Channel| {
        recording.channel(channel).and_then(|values| values.get(run.rows.clone())).map(bits)
    };
    let is_told = |channel: &Channel| {
        let values = suspect.channel(*channel).and_then(|values| values.get(run.rows.clone()));
        channel.tells_power() && values.is_some_and(|values| values.iter().any(|x| x.is_finite()))
    };
    // Gaps alone are alike in many drives.
    let mut told = suspect.channels.keys().copied().filter(is_told).peekable();
    told.peek().is_some() && told.all(|channel| of(suspect, run, channel) == of(healthy, other, channel))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(step_s: f64, seed: f64) -> Recording {
        let t_s: Vec<f64> = (0..200).map(|row| f64::from(row) * step_s).collect();
        let power_w = t_s.iter().map(|t| 50.0 + (seed * t).sin()).collect();
        let runs = vec![Run {
            name: format!("drive {seed}"),
            rows: 0..200,
            gap_s: 10.0 * step_s,
            start_unix_s: None,
        }];
        Recording { channels: [(Channel::Power, power_w)].into(), t_s, runs, ..Recording::default() }
    }

    #[test]
    fn milliseconds_are_refused_with_how_far_apart_rows_are() {
        let said = check(&drive(100.0, 1.0), None).unwrap_err().to_string();
        assert!(said.contains("100 s apart") && said.contains("seconds"), "{said}");
        assert!(check(&drive(1.0, 1.0), Some(&drive(100.0, 2.0))).is_err());
        assert!(check(&drive(1.0, 1.0), None).is_ok());
    }

    #[test]
    fn rows_that_show_no_change_of_speed_are_refused() {
        let said = check(&drive(1.0, 1.0), Some(&drive(8.0, 2.0))).unwrap_err().to_string();
        assert!(said.contains("8.0 s apart") && said.contains("5"), "{said}");
        assert!(check(&drive(5.0, 1.0), None).is_ok());
    }

    #[test]
    fn a_drive_is_not_held_against_itself() {
        let said = check(&drive(0.1, 1.0), Some(&drive(0.1, 1.0))).unwrap_err().to_string();
        assert!(said.contains("drive 1"), "{said}");
        assert!(check(&drive(0.1, 1.0), Some(&drive(0.1, 2.0))).is_ok());
        let mut gaps = drive(0.1, 1.0);
        gaps.channels.insert(Channel::Power, vec![f64::NAN; 200]);
        assert!(check(&gaps, Some(&gaps)).is_ok(), "drives without a number are no drives at all");
    }
}
