//! Two forms of power in one recording that contradict each other.

use recording::{Channel, PowerForm, Recording};

use super::{Doubt, second::median};

/// Gain of two meters of the same power against each other: shunts and dividers of 5 % each.
const GAINS: f64 = 1.1;
/// The least efficiency of drivers, of what the battery gives beyond the standing load.
const DRIVERS: f64 = 0.7;
/// Variance in common from which a ratio is that of the meters: else they have other clocks, or one is not of this drive.
const LEAST_R2: f64 = 0.5;
/// Fewer rows tell nothing.
const LEAST_ROWS: usize = 50;

/// Tells of power that two columns tell differently, before one of them is chosen.
pub(super) fn contradicting(recording: &Recording) -> Option<Doubt> {
    let taken = recording.power_form()?;
    let others = [PowerForm::Sides, PowerForm::Battery, PowerForm::CurrentAndVoltage];
    let holds = |form: &PowerForm| form.channels().iter().all(|c| recording.channel(*c).is_some());
    others
        .into_iter()
        .filter(|form| *form != taken && taken != PowerForm::MotorCurrents && holds(form))
        .find_map(|other| contradiction(recording, taken, other))
}

fn contradiction(recording: &Recording, taken: PowerForm, other: PowerForm) -> Option<Doubt> {
    let [least_ratio, ratio, most_ratio] = ratio(recording, taken, other)?;
    // Drivers take what the battery gives beyond what the motors have.
    let least = if taken == PowerForm::Sides { DRIVERS / GAINS } else { 1.0 / GAINS };
    let [name, beside] = [taken, other].map(words);
    (most_ratio < least || least_ratio > GAINS).then(|| Doubt {
        name: "powers_contradict",
        statement: format!("power by {name} varies {ratio:.2} times as much as by {beside}, and {name} would be taken"),
        cure: format!("find out which is right, give the other its unit or \"scale\" in a map ({:.3} for {name}), or leave it out", 1.0 / ratio),
    })
}

fn words(form: PowerForm) -> &'static str {
    match form {
        PowerForm::Sides => "`power_left_w` and `power_right_w`",
        PowerForm::CurrentAndVoltage => "`current_a` times `voltage_v`",
        _ => "`power_w`",
    }
}

/// How much more one form varies than another, about their medians, so that standing loads do not count: by the line of one on the other, by the
/// ratio of spreads, and by the line the other way round. Noise and delays of either leave the truth between the first and the last.
fn ratio(recording: &Recording, taken: PowerForm, other: PowerForm) -> Option<[f64; 3]> {
    let of = |form: PowerForm, row: usize| {
        let [a, b] =
            form.channels().map(|c: Channel| recording.channel(c).map_or(f64::NAN, |values| values[row]));
        match form {
            PowerForm::Sides => a + b,
            PowerForm::CurrentAndVoltage => a * b,
            _ => a,
        }
    };
    let pairs: Vec<[f64; 2]> = (0..recording.rows())
        .map(|row| [of(taken, row), of(other, row)])
        .filter(|pair| pair.iter().all(|w| w.is_finite()))
        .collect();
    let middle = [0, 1].map(|i| median(pairs.iter().map(|pair| pair[i]).collect()).unwrap_or(0.0));
    let [aa, ab, bb] = pairs.iter().fold([0.0; 3], |[aa, ab, bb], [a, b]| {
        let (a, b) = (a - middle[0], b - middle[1]);
        [aa + a * a, ab + a * b, bb + b * b]
    });
    (pairs.len() >= LEAST_ROWS && ab > 0.0 && ab * ab > LEAST_R2 * aa * bb)
        .then(|| [ab / bb, (aa / bb).sqrt(), aa / ab])
}
