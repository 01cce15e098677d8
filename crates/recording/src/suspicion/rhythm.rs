//! Speeds that change more slowly than robots do: their times are longer than the true ones.

use crate::{
    Channel, Recording, Run,
    clock::rounded,
    gap::median_step_s,
    report::{Suspicion, SuspicionKind as Kind},
};

/// Steps from which times are doubted \[s\]: 1 kHz in milliseconds. Slower logs in smaller units are refused by their steps.
const LEAST_STEP_S: f64 = 1.0;
/// Time within which robots start, stop and turn \[s\].
const MANOEUVRE_S: f64 = 10.0;
/// Share of the range of its speed that a robot changes it by, once at least, within a manoeuvre.
const LEAST_SHARE: f64 = 0.3;
/// Share of its greatest speed that the range has to be: a robot that cruises all the time shows no manoeuvre.
const LEAST_RANGE: f64 = 0.5;
/// Fewer speeds show no range.
const LEAST_ROWS: usize = 50;

/// A doubt about the times of a run, by its wheel speeds.
pub(super) fn slow_motion(recording: &Recording, run: &Run) -> Option<Suspicion> {
    let t_s = recording.t_s.get(run.rows.clone())?;
    let step_s = median_step_s(t_s).filter(|step_s| *step_s >= LEAST_STEP_S)?;
    let sides = [Channel::LeftSpeed, Channel::RightSpeed];
    let shares =
        sides.map(|side| share_changed(t_s, recording.channel(side)?.get(run.rows.clone())?, step_s));
    let [Some(left), Some(right)] = shares else { return None };
    let share = left.max(right);
    (share < LEAST_SHARE).then(|| Suspicion {
        channel: Channel::LeftSpeed,
        run: Some(run.name.clone()),
        kind: Kind::Unit,
        statement: format!(
            "within {MANOEUVRE_S} s it never changes by more than {:.0} % of its range, and robots start and stop within seconds: rows \
             are {} s apart, is `t_s` in milliseconds? Give its unit in a map",
            100.0 * share,
            rounded(step_s)
        ),
    })
}

/// The greatest change of a speed within a manoeuvre, as a share of its range between the 5th and the 95th percentile; `None` where
/// the range shows no manoeuvre.
fn share_changed(t_s: &[f64], speed_mps: &[f64], step_s: f64) -> Option<f64> {
    let rows: Vec<(f64, f64)> = t_s
        .iter()
        .skip(1)
        .zip(speed_mps.windows(3))
        .map(|(t, of)| (*t, median_of_three(of)))
        .filter(|row| row.1.is_finite())
        .collect();
    if rows.len() < LEAST_ROWS {
        return None;
    }
    let mut sorted: Vec<f64> = rows.iter().map(|row| row.1).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let [low, high] = [5, 95].map(|percent| sorted[(sorted.len() - 1) * percent / 100]);
    let (range, top) = (high - low, high.abs().max(low.abs()));
    if range < LEAST_RANGE * top || range <= 0.0 {
        return None;
    }
    let mut end = 0;
    let mut greatest = 0.0_f64;
    for (row, &(t, speed)) in rows.iter().enumerate() {
        end = end.max(row);
        // A step that lasts as long as a manoeuvre shows it whole.
        while rows.get(end + 1).is_some_and(|next| next.0 - t <= MANOEUVRE_S.max(1.5 * step_s)) {
            end += 1;
        }
        greatest = rows.get(end).map_or(greatest, |later| greatest.max((later.1 - speed).abs()));
    }
    Some(greatest / range)
}

/// The middle one of three speeds, which leaves out a lone outlier.
fn median_of_three(speeds_mps: &[f64]) -> f64 {
    match speeds_mps {
        [a, b, c] => a.max(*b).min(a.min(*b).max(*c)),
        _ => f64::NAN,
    }
}
