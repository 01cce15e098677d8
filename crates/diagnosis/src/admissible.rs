//! Whether drives can be diagnosed at all, before anything is fitted.

use recording::{Recording, Run};

use crate::Error;

/// Rows may be so far apart \[s\]: speeds change within a second or two, and averages are of one.
const MOST_STEP_S: f64 = 5.0;

/// Refuses rows that are too far apart, and drives that are among the healthy ones.
///
/// # Errors
/// See above.
pub(crate) fn check(suspect: &Recording, healthy: Option<&Recording>) -> Result<(), Error> {
    for recording in [Some(suspect), healthy].into_iter().flatten() {
        let step_s = median_step_s(recording);
        if step_s > MOST_STEP_S {
            return Err(Error::TooCoarse { step_s, most_s: MOST_STEP_S });
        }
    }
    for (run, other) in healthy.iter().flat_map(|healthy| {
        suspect.runs.iter().flat_map(|run| healthy.runs.iter().map(move |other| (run, other)))
    }) {
        if healthy.is_some_and(|healthy| are_same((suspect, run), (healthy, other))) {
            return Err(Error::Same { drive: run.name.clone(), healthy: other.name.clone() });
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
    let of = |recording: &Recording, run: &Run, channel| {
        recording.channel(channel).and_then(|values| values.get(run.rows.clone())).map(bits)
    };
    let told: Vec<_> = suspect.channels.keys().filter(|channel| channel.tells_power()).copied().collect();
    run.rows.len() == other.rows.len()
        && told.iter().any(|channel| of(suspect, run, *channel).is_some())
        && told.iter().all(|channel| of(suspect, run, *channel) == of(healthy, other, *channel))
}

#[cfg(test)]
mod tests {
    use recording::Channel;

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
    fn a_drive_is_not_held_against_itself() {
        let said = check(&drive(0.1, 1.0), Some(&drive(0.1, 1.0))).unwrap_err().to_string();
        assert!(said.contains("drive 1"), "{said}");
        assert!(check(&drive(0.1, 1.0), Some(&drive(0.1, 2.0))).is_ok());
    }
}
