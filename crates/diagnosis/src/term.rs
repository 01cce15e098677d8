//! Terms that a discovery may be made of: a scale of power times dimensionless groups of what was recorded.

use model::{Robot, STANDARD_GRAVITY_MPS2};

use crate::{
    average::{Average, Input},
    constancy::MOVING_S,
};

/// A power that a term is measured in; it brings the unit, so that all else has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// m g |u|: a force in weights of the robot, at the side's rim.
    Force,
    /// P: what the model predicts.
    Power,
    /// One watt.
    Watt,
}

/// A dimensionless group of recorded quantities.
#[derive(Clone, Copy)]
pub(crate) struct Group {
    /// As an equation has it.
    pub(crate) symbol: &'static str,
    /// What it grows with, in words.
    pub(crate) words: &'static str,
    /// The recorded quantity behind it and its unit.
    pub(crate) quantity: Quantity,
    /// Its value, given the highest rim speed \[m/s\].
    value: fn(&Average, f64) -> f64,
}

impl Group {
    /// Whether it is the angle that wheels have turned.
    pub(crate) fn is_turn(&self) -> bool {
        self.quantity.0 == TURNED.0
    }
}

/// On which side a term acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum On {
    Both,
    Left,
    Right,
}

/// A term, its size still open.
#[derive(Clone)]
pub(crate) struct Term {
    pub(crate) scale: Scale,
    pub(crate) groups: Vec<&'static Group>,
    pub(crate) on: On,
}

/// A recorded quantity: its name, how it is read and its unit.
type Quantity = (&'static str, fn(&Average) -> f64, &'static str);

const MOVING: Quantity = ("time since it stood still", |a| a.input.moving_s, "s");
const TIME: Quantity = ("time since the drive began", |a| a.t_s, "s");
const PITCH: Quantity = ("pitch", |a| a.input.pitch_rad, "rad");
const ROLL: Quantity = ("roll", |a| a.input.roll_rad, "rad");
const SPEED: Quantity = ("speed", |a| a.input.speed_mps, "m/s");
const TURN: Quantity = ("difference of rim speeds", |a| a.input.difference_mps, "m/s");
const ACCELERATION: Quantity = ("acceleration", |a| a.input.accel_mps2, "m/s²");
const HEADING: Quantity = ("heading", |a| a.input.heading_rad, "rad");
const TURNED: Quantity = ("nearness to where each turn takes most", |a| a.input.nearness, "1");
const HEIGHT: Quantity = ("height", |a| a.input.height_m, "m");

const fn group(
    symbol: &'static str,
    words: &'static str,
    quantity: Quantity,
    value: fn(&Average, f64) -> f64,
) -> Group {
    Group { symbol, words, quantity, value }
}

/// All groups. θ pitch, φ roll, v mean rim speed, Δ right less left rim speed, u the side's rim speed, a acceleration, ψ
/// heading, t time since the drive began, s since the robot stood still, z height, α the angle that the side's wheels have turned, all as
/// recorded.
pub(crate) static GROUPS: [Group; 33] = [
    group("|sin θ|", "the slope along the way, up or down", PITCH, |a, _| a.input.pitch_rad.sin().abs()),
    group("(sin θ)₊", "climbing", PITCH, |a, _| a.input.pitch_rad.sin().max(0.0)),
    group("(−sin θ)₊", "descending", PITCH, |a, _| (-a.input.pitch_rad.sin()).max(0.0)),
    group("|tan φ|", "the slope across the way", ROLL, |a, _| a.input.roll_rad.tan().abs()),
    group("(tan φ)₊", "leaning to the right", ROLL, |a, _| a.input.roll_rad.tan().max(0.0)),
    group("(−tan φ)₊", "leaning to the left", ROLL, |a, _| (-a.input.roll_rad.tan()).max(0.0)),
    group("|v|/u_max", "speed", SPEED, |a, fastest| a.input.speed_mps.abs() / fastest),
    group("(v/u_max)²", "the square of speed", SPEED, |a, fastest| (a.input.speed_mps / fastest).powi(2)),
    group("e^(−|u|/0.2 u_max)", "creeping", SPEED, |a, fastest| {
        (-a.input.rim_mps.abs() / (0.2 * fastest)).exp()
    }),
    group("|Δ|/u_max", "turning", TURN, |a, fastest| a.input.difference_mps.abs() / fastest),
    group("(Δ)₊/u_max", "turning left", TURN, |a, fastest| a.input.difference_mps.max(0.0) / fastest),
    group("(−Δ)₊/u_max", "turning right", TURN, |a, fastest| {
        (-a.input.difference_mps).max(0.0) / fastest
    }),
    group("(a)₊/g", "speeding up", ACCELERATION, |a, _| {
        a.input.accel_mps2.max(0.0) / STANDARD_GRAVITY_MPS2
    }),
    group("(−a)₊/g", "slowing down", ACCELERATION, |a, _| {
        (-a.input.accel_mps2).max(0.0) / STANDARD_GRAVITY_MPS2
    }),
    group("e^(−s/3 s)", "having just stood still", MOVING, |a, _| (-a.input.moving_s / MOVING_S).exp()),
    group("e^(−t/60 s)", "the first minute", TIME, |a, _| (-a.t_s / 60.0).exp()),
    group("e^(−t/300 s)", "the first minutes", TIME, |a, _| (-a.t_s / 300.0).exp()),
    group("t/1000 s", "time", TIME, |a, _| a.t_s / 1000.0),
    group("cos ψ", "heading east, and less heading west", HEADING, |a, _| known(a.input.heading_rad.cos())),
    group("sin ψ", "heading north, and less heading south", HEADING, |a, _| {
        known(a.input.heading_rad.sin())
    }),
    group("cos 2ψ", "driving east or west, and less driving north or south", HEADING, |a, _| {
        known((2.0 * a.input.heading_rad).cos())
    }),
    group("sin 2ψ", "driving north-east or south-west, and less across", HEADING, |a, _| {
        known((2.0 * a.input.heading_rad).sin())
    }),
    group("e^(−((|v| − 0.2 u_max)/0.1 u_max)²)", "speeds about 0.2 of the highest", SPEED, near::<2>),
    group("e^(−((|v| − 0.3 u_max)/0.1 u_max)²)", "speeds about 0.3 of the highest", SPEED, near::<3>),
    group("e^(−((|v| − 0.4 u_max)/0.1 u_max)²)", "speeds about 0.4 of the highest", SPEED, near::<4>),
    group("e^(−((|v| − 0.5 u_max)/0.1 u_max)²)", "speeds about 0.5 of the highest", SPEED, near::<5>),
    group("e^(−((|v| − 0.6 u_max)/0.1 u_max)²)", "speeds about 0.6 of the highest", SPEED, near::<6>),
    group("e^(−((|v| − 0.7 u_max)/0.1 u_max)²)", "speeds about 0.7 of the highest", SPEED, near::<7>),
    group("e^(−((|v| − 0.8 u_max)/0.1 u_max)²)", "speeds about 0.8 of the highest", SPEED, near::<8>),
    group("e^(−((|v| − 0.9 u_max)/0.1 u_max)²)", "speeds about 0.9 of the highest", SPEED, near::<9>),
    group("(1 + cos(α − α₀))/2", "each turn of the wheels", TURNED, |a, _| a.input.nearness),
    group("(z̄ − z)₊/1 m", "low ground", HEIGHT, |a, _| known(-a.input.height_m).max(0.0)),
    group("(z − z̄)₊/1 m", "high ground", HEIGHT, |a, _| known(a.input.height_m).max(0.0)),
];

/// How near a speed is to so many tenths of the highest, 1 at it.
fn near<const TENTHS: u32>(average: &Average, fastest_mps: f64) -> f64 {
    (-(10.0 * average.input.speed_mps.abs() / fastest_mps - f64::from(TENTHS)).powi(2)).exp()
}

/// What was not recorded says nothing.
fn known(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// Every term of at most two groups, on the sides that were recorded apart.
pub(crate) fn all(channels: usize) -> Vec<Term> {
    let sides: &[On] = if channels == 2 { &[On::Both, On::Left, On::Right] } else { &[On::Both] };
    let mut products: Vec<Vec<&'static Group>> = vec![Vec::new()];
    for (i, one) in GROUPS.iter().enumerate() {
        products.push(vec![one]);
        // Two groups of one quantity make another group of it, not another dependence.
        let others = GROUPS[i + 1..].iter().filter(|other| other.quantity.0 != one.quantity.0);
        products.extend(others.map(|other| vec![one, other]));
    }
    let mut terms = Vec::new();
    for scale in [Scale::Force, Scale::Power, Scale::Watt] {
        for groups in &products {
            terms.extend(sides.iter().map(|on| Term { scale, groups: groups.clone(), on: *on }));
        }
    }
    terms
}

impl Term {
    /// Its value in every average of power under suspicion, 0 in the others; `predicted_w` is what the model says \[W\].
    pub(crate) fn column(&self, robot: &Robot, averages: &[Average], predicted_w: &[f64]) -> Vec<f64> {
        let weight_n = robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let fastest_mps = robot.max_wheel_speed_mps;
        let acts = |a: &Average| {
            a.suspect
                && match self.on {
                    On::Both => a.channel < 2,
                    On::Left => a.channel == 0,
                    On::Right => a.channel == 1,
                }
        };
        let scale_w = |input: &Input, predicted_w: f64| match self.scale {
            Scale::Force => weight_n * input.rim_mps.abs(),
            Scale::Power => predicted_w,
            Scale::Watt => 1.0,
        };
        let value = |(a, predicted_w): (&Average, &f64)| {
            if !acts(a) {
                return 0.0;
            }
            let groups = self.groups.iter().map(|group| (group.value)(a, fastest_mps));
            scale_w(&a.input, *predicted_w) * groups.product::<f64>()
        };
        averages.iter().zip(predicted_w).map(value).collect()
    }

    /// Whether it goes with nothing but the angle that wheels have turned.
    pub(crate) fn is_turn(&self) -> bool {
        self.scale == Scale::Force
            && self.on == On::Both
            && !self.groups.is_empty()
            && self.groups.iter().all(|group| group.is_turn())
    }

    /// Its right-hand side, as `c · m g |u| · |tan φ|`.
    pub(crate) fn equation(&self) -> String {
        let scale = match self.scale {
            Scale::Force => "m g |u|",
            Scale::Power => "P",
            Scale::Watt => "1 W",
        };
        let mut text = format!("c · {scale}");
        for group in &self.groups {
            text += " · ";
            text += group.symbol;
        }
        match self.on {
            On::Both => text,
            On::Left => text + " on the left side",
            On::Right => text + " on the right side",
        }
    }

    /// What it grows with, in words.
    pub(crate) fn words(&self) -> String {
        let scale = match self.scale {
            Scale::Force => "a force in the drive",
            Scale::Power => "a share of the power",
            Scale::Watt => "a power",
        };
        let side = match self.on {
            On::Both => "",
            On::Left => " of the left side",
            On::Right => " of the right side",
        };
        let groups: Vec<&str> = self.groups.iter().map(|group| group.words).collect();
        match groups[..] {
            [] => format!("{scale}{side} that is always there"),
            _ => format!("{scale}{side} that goes with {}", groups.join(" and with ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn average(channel: usize, roll_rad: f64) -> Average {
        let input = Input { rim_mps: -0.5, speed_mps: 0.4, roll_rad, height_m: f64::NAN, ..Input::default() };
        Average { channel, run: 0, suspect: true, t_s: 60.0, input }
    }

    #[test]
    fn a_force_on_side_slopes_has_its_weight_its_speed_and_its_side() {
        let across = GROUPS.iter().find(|group| group.symbol == "|tan φ|").unwrap();
        let term = Term { scale: Scale::Force, groups: vec![across], on: On::Left };
        let robot = model::builtin::husky_a200();
        let column = term.column(&robot, &[average(0, -0.1), average(1, -0.1)], &[50.0, 50.0]);
        assert!(
            (column[0] - 90.0 * STANDARD_GRAVITY_MPS2 * 0.5 * 0.1f64.tan()).abs() < 1e-9 && column[1] == 0.0
        );
        assert_eq!(term.equation(), "c · m g |u| · |tan φ| on the left side");
        assert!(term.words().contains("slope across the way"));
    }

    #[test]
    fn every_term_is_finite_even_where_heading_and_height_are_unknown() {
        let unknown =
            Average { input: Input { heading_rad: f64::NAN, ..average(0, 0.1).input }, ..average(0, 0.1) };
        for term in all(2) {
            let column = term.column(&model::builtin::husky_a200(), &[unknown], &[80.0]);
            assert!(column[0].is_finite(), "{}", term.equation());
        }
    }

    #[test]
    fn no_term_has_two_groups_of_one_quantity_and_none_stands_twice() {
        let mut equations: Vec<String> = all(2).iter().map(Term::equation).collect();
        let count = equations.len();
        equations.sort();
        equations.dedup();
        assert_eq!(equations.len(), count);
        assert!(all(1).iter().all(|term| term.on == On::Both && term.groups.len() <= 2));
    }
}
