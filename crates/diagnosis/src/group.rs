//! Dimensionless groups of recorded quantities, of which terms outside the list are made.

use model::STANDARD_GRAVITY_MPS2;

use crate::{
    average::Average,
    constancy::{BUILT_UP_S, MOVING_S},
};

/// A dimensionless group of recorded quantities.
#[derive(Clone, Copy)]
pub(crate) struct Group {
    /// As an equation has it.
    pub(crate) symbol: &'static str,
    /// What it grows with, in words.
    pub(crate) words: &'static str,
    /// The recorded quantity behind it and its unit.
    pub(crate) quantity: Quantity,
    /// Its value, given the highest rim speed \[m/s\]; time is that since what it is a group of set in.
    pub(crate) value: fn(&Average, f64) -> f64,
    /// Whether it is 1 about some value of the quantity and next to nothing elsewhere.
    is_peak: bool,
}

/// What a group that is about some value has to reach for drives to tell anything of it.
const REACHED: f64 = 0.5;

impl Group {
    /// Whether drives under suspicion tell anything of it: speeds that they never had tell nothing.
    pub(crate) fn is_reached(&self, averages: &[Average], fastest_mps: f64) -> bool {
        !self.is_peak || averages.iter().any(|a| a.suspect && (self.value)(a, fastest_mps) > REACHED)
    }

    /// Whether it is of what the model's power follows: models miss nothing that goes with where a robot is, where it heads and when.
    pub(crate) fn is_of_driving(&self) -> bool {
        let of_driving = [MOVING, PITCH, ROLL, STEEPNESS, SPEED, FORWARDS, TURN, ACCELERATION, OF_LATE];
        of_driving.iter().any(|(name, ..)| *name == self.quantity.0)
    }

    /// Its place among [`GROUPS`].
    pub(crate) fn place(&self) -> Option<usize> {
        GROUPS.iter().position(|group| group.symbol == self.symbol)
    }

    /// Whether it goes with time since it set in.
    pub(crate) fn is_of_time(&self) -> bool {
        self.quantity.0 == TIME.0
    }

    /// Whether it tells where the robot heads.
    pub(crate) fn is_of_heading(&self) -> bool {
        self.quantity.0 == HEADING.0
    }

    /// Whether it is the angle that wheels have turned.
    pub(crate) fn is_turn(&self) -> bool {
        self.quantity.0 == TURNED.0
    }
}

/// A recorded quantity: its name, how it is read and its unit.
pub(crate) type Quantity = (&'static str, fn(&Average) -> f64, &'static str);

const MOVING: Quantity = ("time since it stood still", |a| a.input.moving_s, "s");
const OF_LATE: Quantity = ("way driven of late", |a| a.input.of_late_m, "m");
const TIME: Quantity = ("time since it began", |a| a.t_s, "s");
const PITCH: Quantity = ("pitch", |a| a.input.pitch_rad, "rad");
const ROLL: Quantity = ("roll", |a| a.input.roll_rad, "rad");
const STEEPNESS: Quantity =
    ("steepness", |a| a.input.pitch_rad.sin().hypot(a.input.roll_rad.sin()).asin(), "rad");
const SPEED: Quantity = ("speed", |a| a.input.speed_mps.abs(), "m/s");
const FORWARDS: Quantity = ("speed forwards", |a| a.input.speed_mps, "m/s");
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
    Group { symbol, words, quantity, value, is_peak: false }
}

/// A group about a speed.
const fn about(symbol: &'static str, words: &'static str, value: fn(&Average, f64) -> f64) -> Group {
    Group { is_peak: true, ..group(symbol, words, SPEED, value) }
}

/// All groups. θ pitch, φ roll, γ how steep the ground under the robot is, v mean rim speed, Δ right less left rim speed, u the side's rim speed, a acceleration, ψ
/// heading, t time since the drive began or it set in, s since the robot stood still, h way driven of
/// which less and less counts the longer ago it was, z height, α the angle that the side's wheels have turned, all as
/// recorded.
pub(crate) static GROUPS: [Group; 41] = [
    group("|sin θ|", "the slope along the way, up or down", PITCH, |a, _| a.input.pitch_rad.sin().abs()),
    group("(sin θ)₊", "climbing", PITCH, |a, _| a.input.pitch_rad.sin().max(0.0)),
    group("(−sin θ)₊", "descending", PITCH, |a, _| (-a.input.pitch_rad.sin()).max(0.0)),
    group("sin γ", "how steep the ground is", STEEPNESS, |a, _| {
        a.input.pitch_rad.sin().hypot(a.input.roll_rad.sin())
    }),
    group("|tan φ|", "the slope across the way", ROLL, |a, _| a.input.roll_rad.tan().abs()),
    group("tan φ", "leaning to the right, and less to the left", ROLL, |a, _| a.input.roll_rad.tan()),
    group("(tan φ)₊", "leaning to the right", ROLL, |a, _| a.input.roll_rad.tan().max(0.0)),
    group("(−tan φ)₊", "leaning to the left", ROLL, |a, _| (-a.input.roll_rad.tan()).max(0.0)),
    group("|v|/u_max", "speed", SPEED, |a, fastest| a.input.speed_mps.abs() / fastest),
    group("(v/u_max)²", "the square of speed", SPEED, |a, fastest| (a.input.speed_mps / fastest).powi(2)),
    group("e^(−|u|/0.2 u_max)", "creeping", SPEED, |a, fastest| {
        (-a.input.rim_mps.abs() / (0.2 * fastest)).exp()
    }),
    group("1/(1 + |u|/0.1 u_max)", "slowness", SPEED, |a, fastest| {
        1.0 / (1.0 + a.input.rim_mps.abs() / (0.1 * fastest))
    }),
    group("tanh(v/0.05 u_max)", "driving forwards, and less backwards", FORWARDS, |a, fastest| {
        (a.input.speed_mps / (0.05 * fastest)).tanh()
    }),
    group("tanh((−v)₊/0.05 u_max)", "driving backwards", FORWARDS, |a, fastest| {
        ((-a.input.speed_mps).max(0.0) / (0.05 * fastest)).tanh()
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
    group("1 − e^(−s/20 s)", "how long it has not stood still", MOVING, |a, _| {
        1.0 - (-a.input.moving_s / BUILT_UP_S).exp()
    }),
    group("e^(−h/(30 s u_max))", "having driven little of late", OF_LATE, |a, fastest| {
        (-a.input.of_late_m / (30.0 * fastest)).exp()
    }),
    group("e^(−t/15 s)", "the first quarter of a minute", TIME, |a, _| (-a.t_s / 15.0).exp()),
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
    about("e^(−((|v| − 0.2 u_max)/0.1 u_max)²)", "speeds about 0.2 of the highest", near::<2>),
    about("e^(−((|v| − 0.3 u_max)/0.1 u_max)²)", "speeds about 0.3 of the highest", near::<3>),
    about("e^(−((|v| − 0.4 u_max)/0.1 u_max)²)", "speeds about 0.4 of the highest", near::<4>),
    about("e^(−((|v| − 0.5 u_max)/0.1 u_max)²)", "speeds about 0.5 of the highest", near::<5>),
    about("e^(−((|v| − 0.6 u_max)/0.1 u_max)²)", "speeds about 0.6 of the highest", near::<6>),
    about("e^(−((|v| − 0.7 u_max)/0.1 u_max)²)", "speeds about 0.7 of the highest", near::<7>),
    about("e^(−((|v| − 0.8 u_max)/0.1 u_max)²)", "speeds about 0.8 of the highest", near::<8>),
    about("e^(−((|v| − 0.9 u_max)/0.1 u_max)²)", "speeds about 0.9 of the highest", near::<9>),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    #[test]
    fn groups_of_what_was_before_grow_with_driving_and_fade_with_what_warms() {
        let of = |symbol: &str, moving_s: f64, of_late_m: f64| {
            let input = Input { moving_s, of_late_m, ..Input::default() };
            let average = Average { channel: 0, run: 0, suspect: true, t_s: 900.0, input };
            let group = GROUPS.iter().find(|group| group.symbol == symbol);
            group.map(|group| (group.value)(&average, 2.0)).unwrap_or(f64::NAN)
        };
        let built_up = |moving_s: f64| of("1 − e^(−s/20 s)", moving_s, 0.0);
        assert_eq!(built_up(0.0), 0.0);
        assert!((built_up(20.0) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
        // 60 m at 2 m/s at most are half a minute at full speed.
        let cold = |of_late_m: f64| of("e^(−h/(30 s u_max))", 0.0, of_late_m);
        assert_eq!(cold(0.0), 1.0);
        assert!((cold(60.0) - (-1.0_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn backwards_is_a_quantity_of_its_own() {
        let of = |speed_mps: f64| {
            let input = Input { speed_mps, ..Input::default() };
            let average = Average { channel: 0, run: 0, suspect: true, t_s: 0.0, input };
            let group = GROUPS.iter().find(|group| group.words == "driving backwards");
            group.map(|group| (group.value)(&average, 2.0)).unwrap_or(f64::NAN)
        };
        assert_eq!([of(0.0), of(1.0)], [0.0; 2]);
        assert!(of(-0.5) > 0.99 && of(-0.05) < 0.5, "{} {}", of(-0.5), of(-0.05));
    }
}
