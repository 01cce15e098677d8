//! One of several encoders that a wheel speed is the mean of and that stands while the others turn: the mean would be too slow by its share.

use std::ops::Range;

use crate::{Repair, STANDS_MPS, gap};

/// Time for which an encoder does not repeat itself to the last digit while the others of its side turn \[s\]: a manoeuvre is shorter, and in
/// it wheels of one side of a skid-steered robot turn together.
const LEAST_S: f64 = 10.0;

/// Changes of the others by which they live: ten times in a row an encoder does not repeat itself by rounding alone.
const LEAST_CHANGES: usize = 10;

/// Which one of several parts, from 1 on, repeats itself while all others change; 0 where none or more do, NaN where nothing changes.
fn lone(before: &[f64], now: &[f64]) -> f64 {
    let stands: Vec<usize> = (0..now.len()).filter(|part| before.get(*part) == now.get(*part)).collect();
    match stands.as_slice() {
        _ if now.iter().any(|value| value.is_nan()) => f64::NAN,
        all if all.len() == now.len() => f64::NAN,
        [only] if now.len() > 1 => (only + 1) as f64,
        _ => 0.0,
    }
}

/// What [`lone`] tells by row of columns.
pub(crate) fn lone_of_columns<P: AsRef<[f64]>>(parts: &[P]) -> Vec<f64> {
    let rows = parts.iter().map(|part| part.as_ref().len()).min().unwrap_or(0);
    let at = |row: usize| -> Vec<f64> { parts.iter().map(|part| part.as_ref()[row]).collect() };
    if parts.len() < 2 {
        return Vec::new();
    }
    let mut before = vec![f64::NAN; parts.len()];
    let of = |row: usize| {
        let now = at(row);
        let told = lone(&before, &now);
        // Cells may be empty between samples.
        if !now.iter().any(|value| value.is_nan()) {
            before = now;
        }
        told
    };
    (0..rows).map(of).collect()
}

/// Leaves out the speeds of rows in which one of their parts stands, and says so. `lone` is what [`lone()`] told by row, `names` are the parts'.
pub(crate) fn leave_out(
    t_s: &[f64],
    lone: &[f64],
    speed_mps: &[f64],
    names: &[String],
    values: &mut [f64],
) -> Vec<Repair> {
    let mut repairs = Vec::new();
    for (part, rows) in standing(t_s, lone, speed_mps) {
        let Some(name) = names.get(part) else { continue };
        let others: Vec<&str> = names.iter().filter(|other| *other != name).map(String::as_str).collect();
        let [from_s, to_s] = [rows.start, rows.end - 1].map(|row| t_s[row] - t_s[0]);
        let what = format!(
            "it stands while {} turns, from {from_s:.1} s to {to_s:.1} s: a mean of both would be too slow, and no speed is taken from there; \
             leave `{name}` out of the map if its encoder is dead",
            others.join(", ")
        );
        repairs.push(Repair { place: name.clone(), what });
        values[rows].fill(f64::NAN);
    }
    repairs
}

/// The stretches of rows in which a part stands for long while the others turn.
fn standing(t_s: &[f64], lone: &[f64], speed_mps: &[f64]) -> Vec<(usize, Range<usize>)> {
    let longest_s = gap::threshold_s(t_s);
    let driven_s = |rows: &Range<usize>| -> f64 {
        let moves = rows.clone().skip(1).filter(|row| speed_mps[*row].abs() > STANDS_MPS);
        moves.map(|row| t_s[row] - t_s[row - 1]).filter(|step_s| (0.0..=longest_s).contains(step_s)).sum()
    };
    // Where nothing changes, the part that stood before goes on standing.
    let told: Vec<usize> = (0..lone.len()).filter(|row| !lone[*row].is_nan()).collect();
    let stretches = told.chunk_by(|a, b| lone[*a] == lone[*b]);
    let long = stretches.filter_map(|rows| {
        let (&first, &last) = (rows.first()?, rows.last()?);
        let part = lone[first];
        let is_one = part >= 1.0 && part.fract() == 0.0 && rows.len() >= LEAST_CHANGES;
        let span = first..last + 1;
        (is_one && driven_s(&span) >= LEAST_S).then(|| (part as usize - 1, span))
    });
    long.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_that_stands_while_the_other_turns_takes_its_rows_out_and_no_others() {
        let t_s: Vec<f64> = (0..600).map(|row| 0.1 * f64::from(row)).collect();
        let turns = |row: usize| 0.5 + 0.1 * (0.3 * row as f64).sin();
        let leave = |parts: &dyn Fn(usize) -> [f64; 2]| {
            let mean = |row: usize| parts(row).iter().sum::<f64>() / 2.0;
            let speed_mps: Vec<f64> = (0..600).map(mean).collect();
            let before = |row: usize| if row == 0 { [f64::NAN; 2] } else { parts(row - 1) };
            let told: Vec<f64> = (0..600).map(|row| lone(&before(row), &parts(row))).collect();
            let mut values = speed_mps.clone();
            let names = ["front", "rear"].map(str::to_owned);
            let repairs = leave_out(&t_s, &told, &speed_mps, &names, &mut values);
            (repairs, values.iter().filter(|value| value.is_nan()).count())
        };
        let dead = |row: usize| [turns(row), if row < 300 { turns(row) } else { 0.0 }];
        let (repairs, left) = leave(&dead);
        assert_eq!((repairs.len(), left), (1, 299), "the row of the last change is the last that lives");
        assert_eq!(repairs[0].place, "rear");
        assert!(repairs[0].what.contains("from 30.1 s to 59.9 s"), "{}", repairs[0].what);
        // Alike, coarse, and standing while the other flickers.
        let step = |v: f64, by: f64| (v / by).round() * by;
        assert_eq!(leave(&|row| [turns(row); 2]).1, 0);
        assert_eq!(leave(&|row| [step(turns(row), 0.05), step(turns(row + 3), 0.05)]).1, 0);
        assert_eq!(leave(&|row| [0.0, if row % 2 == 0 { 0.001 } else { 0.0 }]).1, 0);
    }
}
