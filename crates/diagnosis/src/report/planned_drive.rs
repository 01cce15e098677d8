//! Drives that anyone can make, as recordings of their motion with no power recorded yet.

use std::collections::BTreeMap;

use model::Robot;
use recording::{Channel, Labels, Recording, Run};

/// A manoeuvre, repeated or held for as long as it takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlannedDrive {
    /// The manoeuvre in words, to go behind "let the robot".
    pub(crate) words: &'static str,
    /// Speed and difference of the sides' speeds, as shares of the highest wheel speed.
    speed: f64,
    turn: f64,
    /// Pitch as a multiple of [`RAMP_RAD`].
    ramp: f64,
    /// Whether it starts and stops again and again.
    stops: bool,
    heading_rad: f64,
    /// Duration \[s\].
    pub(crate) duration_s: f64,
}

const STEADY: PlannedDrive = PlannedDrive {
    words: "",
    speed: 0.0,
    turn: 0.0,
    ramp: 0.0,
    stops: false,
    heading_rad: 0.0,
    duration_s: 180.0,
};

/// Manoeuvres that need nothing but some ground and a ramp.
pub(crate) const CATALOGUE: [PlannedDrive; 14] = [
    PlannedDrive { words: "stand still", ..STEADY },
    PlannedDrive { words: "drive straight and slowly on level ground", speed: 0.3, ..STEADY },
    PlannedDrive { words: "drive straight and fast on level ground, towards east", speed: 0.9, ..STEADY },
    PlannedDrive {
        words: "drive straight and fast on level ground, towards west",
        speed: 0.9,
        heading_rad: std::f64::consts::PI,
        ..STEADY
    },
    PlannedDrive { words: "drive backwards on level ground", speed: -0.5, ..STEADY },
    PlannedDrive { words: "drive straight up a ramp of about 8 degrees", speed: 0.5, ramp: 1.0, ..STEADY },
    PlannedDrive {
        words: "drive straight and fast up a ramp of about 8 degrees",
        speed: 0.9,
        ramp: 1.0,
        ..STEADY
    },
    PlannedDrive { words: "drive straight down a ramp of about 8 degrees", speed: 0.5, ramp: -1.0, ..STEADY },
    PlannedDrive { words: "spin left on the spot", turn: 1.2, ..STEADY },
    PlannedDrive { words: "spin right on the spot", turn: -1.2, ..STEADY },
    PlannedDrive { words: "drive wide arcs to the left", speed: 0.6, turn: 0.5, ..STEADY },
    PlannedDrive { words: "drive wide arcs to the right", speed: 0.6, turn: -0.5, ..STEADY },
    PlannedDrive { words: "start and stop briskly again and again", speed: 0.8, stops: true, ..STEADY },
    PlannedDrive {
        words: "drive straight and fast for half an hour, beginning with cold motors",
        speed: 0.9,
        duration_s: 1800.0,
        ..STEADY
    },
];

/// A ramp that is easily found \[rad\]: 8 degrees.
const RAMP_RAD: f64 = 0.14;
/// Acceleration of a brisk start \[m/s²\], half of what a Husky reaches.
const START_MPS2: f64 = 0.5;
/// Rows of short drives, and of long ones \[s\].
const STEP_S: f64 = 0.2;
const LONG_STEP_S: f64 = 1.0;
const LONG_S: f64 = 600.0;

impl PlannedDrive {
    /// Its motion on a surface, with power by side or of the battery that is there but means nothing, and with a gyroscope or without one.
    pub(crate) fn recording(
        &self,
        robot: &Robot,
        surface: &str,
        by_side: bool,
        has_gyroscope: bool,
    ) -> Recording {
        let step_s = if self.duration_s > LONG_S { LONG_STEP_S } else { STEP_S };
        let rows = (self.duration_s / step_s) as usize;
        let fastest_mps = robot.max_wheel_speed_mps;
        let side = |sign: f64| -> Vec<f64> {
            let of = |i: usize| {
                self.speed_mps(i as f64 * step_s, fastest_mps) + sign * 0.5 * self.turn * fastest_mps
            };
            (0..rows).map(of).collect()
        };
        let yaw_rate_radps = self.turn * fastest_mps / robot.slip_track_m;
        let heading_rad = |i: usize| self.heading_rad + yaw_rate_radps * i as f64 * step_s;
        let mut channels = BTreeMap::from([
            (Channel::LeftSpeed, side(-1.0)),
            (Channel::RightSpeed, side(1.0)),
            (Channel::Heading, (0..rows).map(heading_rad).collect()),
            (Channel::Pitch, vec![self.ramp * RAMP_RAD; rows]),
            (Channel::Roll, vec![0.0; rows]),
        ]);
        if has_gyroscope {
            channels.insert(Channel::YawRate, vec![yaw_rate_radps; rows]);
        }
        let powers: &[Channel] =
            if by_side { &[Channel::LeftPower, Channel::RightPower] } else { &[Channel::Power] };
        channels.extend(powers.iter().map(|channel| (*channel, vec![0.0; rows])));
        Recording {
            t_s: (0..rows).map(|i| i as f64 * step_s).collect(),
            channels,
            surface: Some(Labels::constant(surface, rows)),
            runs: vec![Run {
                name: "planned".into(),
                rows: 0..rows,
                gap_s: 5.0 * step_s,
                start_unix_s: None,
            }],
            ..Recording::default()
        }
    }

    /// Speed at a time, trapezoids where it stops again and again.
    fn speed_mps(&self, t_s: f64, fastest_mps: f64) -> f64 {
        let speed_mps = self.speed * fastest_mps;
        if !self.stops {
            return speed_mps;
        }
        let ramp_s = (speed_mps / START_MPS2).max(1.0);
        let phase_s = t_s % (4.0 * ramp_s);
        let up = (phase_s / ramp_s).min(1.0);
        let down = ((3.0 * ramp_s - phase_s) / ramp_s).clamp(0.0, 1.0);
        speed_mps * up.min(down)
    }
}
