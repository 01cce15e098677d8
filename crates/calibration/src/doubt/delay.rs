//! Power that lags behind the wheels, or runs ahead of them.

use model::Robot;
use recording::{PowerForm, Recording, Watch};

use super::{Doubt, change::EVIDENCE, driving::ALIKE_S};
use crate::{
    Drives, Error,
    drives::Stretch,
    field::with_new_ground,
    power::{columns_by_row, seen_w},
};

/// Delays that are tried, to both sides \[s\].
const MOST_S: f64 = 10.0;
/// Their steps \[s\]: what a delay between a motor's driver and an encoder is on a Husky.
const STEP_S: f64 = 0.1;
/// Delays up to this are those of drivers and filters, and averages over a second hardly see them \[s\].
const USUAL_S: f64 = 0.45;
/// A delay is believed when power then follows at least so well (r²).
const FOLLOWS: f64 = 0.5;
/// And when what is not followed shrinks to this share: a delay that hardly changes it is none that matters.
const CLEARLY_BETTER: f64 = 0.9;
/// Rows that are looked at, in pieces spread over all drives.
const MOST_ROWS: usize = 20_000;

/// How well recorded power follows the prediction at each delay.
struct Follows {
    delay_s: f64,
    r2: f64,
}

/// Tells of a delay of power.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub(super) fn delay(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Option<Doubt>, Error> {
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    if drives.placement.is_some() {
        // Where the windows of a slow meter lie is found by itself.
        return Ok(None);
    }
    let drives = drives.thinned(MOST_ROWS)?;
    let robot = &with_new_ground(robot, &drives);
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let sides = columns_by_row(&drives, robot, |i, power| {
        let [first, second] = seen_w(robot, form, &drives.rows[i], power);
        (first, second)
    })?;
    let steps = (MOST_S / STEP_S).round() as i64;
    let mut all = Vec::new();
    for step in -steps..=steps {
        drives.go_on()?;
        let delay_s = step as f64 * STEP_S;
        all.push(Follows { delay_s, r2: followed(&drives, [&sides.0, &sides.1], form, delay_s) });
    }
    Ok(doubt(&drives, &all))
}

fn doubt(drives: &Drives, all: &[Follows]) -> Option<Doubt> {
    let best = all.iter().max_by(|a, b| a.r2.total_cmp(&b.r2))?;
    let given = all.iter().find(|one| one.delay_s.abs() < STEP_S / 2.0)?;
    let evidence = compared_s(drives) / ALIKE_S * ((1.0 - given.r2) / (1.0 - best.r2)).ln();
    let is_inner = best.delay_s.abs() < MOST_S - STEP_S;
    let is_clear = evidence >= EVIDENCE && 1.0 - best.r2 < CLEARLY_BETTER * (1.0 - given.r2);
    // Delays are told to a row: readings in one may be a row apart.
    if best.delay_s.abs() - row_s(drives) <= USUAL_S || best.r2 < FOLLOWS || !is_inner || !is_clear {
        return None;
    }
    let way = if best.delay_s > 0.0 { "lags behind" } else { "runs ahead of" };
    Some(Doubt {
        name: "power_delay",
        statement: format!(
            "power {way} the wheels by {:.1} s: it then follows the model in {:.0} % of its variation instead of {:.0} %",
            best.delay_s.abs(),
            100.0 * best.r2.max(0.0),
            100.0 * given.r2.max(0.0)
        ),
        cure: format!(
            "log power and wheel speeds by one clock, or move the times of power by {:+.1} s before tables are joined",
            -best.delay_s
        ),
    })
}

/// Time that is compared at all delays: without as much of both ends of a stretch \[s\].
fn compared_s(drives: &Drives) -> f64 {
    let of = |stretch: &Stretch| {
        let rows = drives.rows.get(stretch.rows.clone()).unwrap_or_default();
        rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last.t_s - first.t_s - 2.0 * MOST_S)
    };
    drives.stretches.iter().map(of).filter(|compared_s| *compared_s > 0.0).sum()
}

/// Mean time between rows [s].
fn row_s(drives: &Drives) -> f64 {
    let of = |stretch: &Stretch| {
        let t_s = |row: usize| drives.rows[row].t_s;
        let last = stretch.rows.end.max(stretch.rows.start + 1) - 1;
        [t_s(last) - t_s(stretch.rows.start), (last - stretch.rows.start) as f64]
    };
    let all = drives.stretches.iter().filter(|stretch| !stretch.rows.is_empty()).map(of);
    let [lasts_s, steps] = all.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    if steps > 0.0 { lasts_s / steps } else { 0.0 }
}

/// Squared correlation of what was recorded a delay later with what is predicted, over rows of the same stretch, signed; sides about means of
/// their own.
fn followed(drives: &Drives, predicted_w: [&[f64]; 2], form: PowerForm, delay_s: f64) -> f64 {
    let mut sums = [0.0; 3];
    for (predicted_w, recorded) in predicted_w.into_iter().zip(&drives.recorded) {
        let mut pairs: Vec<[f64; 2]> = Vec::new();
        for stretch in &drives.stretches {
            let rows = &drives.rows[stretch.rows.clone()];
            let (Some(first), Some(last)) = (rows.first(), rows.last()) else { continue };
            let step_s = (last.t_s - first.t_s) / (rows.len().max(2) - 1) as f64;
            let mut later = 0;
            for (i, row) in rows.iter().enumerate() {
                let wanted_s = row.t_s + delay_s;
                // Compared is one set of rows at all delays, so that none has an easier part of the drive.
                if row.t_s - first.t_s < MOST_S || last.t_s - row.t_s < MOST_S {
                    continue;
                }
                while later + 1 < rows.len()
                    && (rows[later + 1].t_s - wanted_s).abs() <= (rows[later].t_s - wanted_s).abs()
                {
                    later += 1;
                }
                let at = stretch.rows.start + later;
                let watts = if form == PowerForm::MotorCurrents { recorded[at].abs() } else { recorded[at] };
                let is_near = (rows[later].t_s - wanted_s).abs() <= step_s;
                if is_near && row.used && watts.is_finite() {
                    pairs.push([predicted_w[stretch.rows.start + i], watts]);
                }
            }
        }
        let count = pairs.len().max(1) as f64;
        let [p0, r0] = pairs.iter().fold([0.0; 2], |[p0, r0], [p, r]| [p0 + p / count, r0 + r / count]);
        for [p, r] in pairs {
            let by = [(p - p0) * (r - r0), (p - p0).powi(2), (r - r0).powi(2)];
            sums.iter_mut().zip(by).for_each(|(sum, x)| *sum += x);
        }
    }
    let r = sums[0] / (sums[1] * sums[2]).sqrt().max(f64::MIN_POSITIVE);
    r * r.abs()
}
