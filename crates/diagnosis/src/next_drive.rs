//! The drive that would tell explanations apart: the manoeuvre of a small catalogue at which they predict most different power.

use model::{
    Acceleration, Attitude, Friction, FrictionShape, Manoeuvre, Motion, Robot, Sides, mechanism::Moment,
    robot::Surface,
};

use crate::{alternatives::Explanation, average::Input, noise::Noise, series::Applied};

/// A manoeuvre that anyone can drive.
struct Figure {
    /// In words, to go behind "drive" or "let the robot".
    words: &'static str,
    /// Speed and yaw rate as shares of the fastest.
    speed: f64,
    yaw: f64,
    /// Whether the figure is driven on a slope, nose up or down.
    slope: f64,
    /// Forward acceleration [m/s²].
    gain_mps2: f64,
    /// Heading [rad].
    heading_rad: f64,
    /// After so long a drive that motors have reached their temperature.
    warm: bool,
}

impl Figure {
    /// What an average of it has for inputs that scatter hangs on.
    fn input(&self, robot: &Robot) -> Input {
        Input {
            difference_mps: self.yaw * 2.0 * robot.max_wheel_speed_mps,
            accel_mps2: self.gain_mps2,
            ..Input::default()
        }
    }
}

const PLAIN: Figure =
    Figure { words: "", speed: 0.0, yaw: 0.0, slope: 0.0, gain_mps2: 0.0, heading_rad: 0.0, warm: false };
/// Acceleration of a brisk start, half of what a Husky reaches [m/s²].
const START_MPS2: f64 = 0.5;
const CATALOGUE: [Figure; 14] = [
    Figure { words: "stand still", ..PLAIN },
    Figure { words: "drive straight and slowly on level ground", speed: 0.3, ..PLAIN },
    Figure { words: "drive straight and fast on level ground, towards east", speed: 0.9, ..PLAIN },
    Figure {
        words: "drive straight and fast on level ground, towards west",
        speed: 0.9,
        heading_rad: std::f64::consts::PI,
        ..PLAIN
    },
    Figure { words: "drive backwards on level ground", speed: -0.5, ..PLAIN },
    Figure { words: "drive straight uphill", speed: 0.5, slope: 1.0, ..PLAIN },
    Figure { words: "drive straight uphill, fast", speed: 0.9, slope: 1.0, ..PLAIN },
    Figure { words: "drive straight downhill", speed: 0.5, slope: -1.0, ..PLAIN },
    Figure { words: "spin left on the spot", yaw: 0.6, ..PLAIN },
    Figure { words: "spin right on the spot", yaw: -0.6, ..PLAIN },
    Figure { words: "drive wide arcs to the left", speed: 0.6, yaw: 0.25, ..PLAIN },
    Figure { words: "drive wide arcs to the right", speed: 0.6, yaw: -0.25, ..PLAIN },
    Figure { words: "start and stop briskly again and again", speed: 0.4, gain_mps2: START_MPS2, ..PLAIN },
    Figure {
        words: "drive straight at half speed once cold and once after half an hour of hard driving",
        speed: 0.5,
        warm: true,
        ..PLAIN
    },
];
/// The slope of a ramp that is easily found [rad]: 8 degrees.
const RAMP_RAD: f64 = 0.14;
/// Differences below cannot be told apart by a drive of some minutes, in sigma of a second's average.
const LEAST_SIGMAS: f64 = 0.3;

/// One sentence: what to drive, and by how much the explanations will differ. `None` without any alternative.
pub(crate) fn next_drive(
    best: &Explanation,
    alternatives: &[Explanation],
    noise: &Noise,
    surface: &str,
    by_side: bool,
) -> Option<String> {
    let judged = |figure: &Figure| {
        let own_w = powers_w(best, figure, surface, by_side)?;
        let apart = |other: &Explanation| {
            let other_w = powers_w(other, figure, surface, by_side)?;
            let differ = |c: usize| {
                (own_w[c] - other_w[c]).abs() / noise.sigma_of(c, &figure.input(&best.robot), own_w[c])
            };
            // What comes behind the one power of a battery is no power.
            let channel = if by_side && differ(1) > differ(0) { 1 } else { 0 };
            Some((differ(channel), own_w[channel] - other_w[channel], channel, other.name))
        };
        let all: Option<Vec<_>> = alternatives.iter().map(apart).collect();
        all?.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let figures = CATALOGUE.iter().filter_map(|figure| judged(figure).map(|j| (figure, j)));
    let (figure, (sigmas, by_w, channel, other)) = figures.max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    if sigmas < LEAST_SIGMAS {
        return Some(format!(
            "no simple drive would tell `{}` from `{other}`: they differ by {:.1} W at most; look at the robot instead",
            best.name,
            by_w.abs()
        ));
    }
    let side = match (by_side, channel) {
        (false, _) => "",
        (true, 0) => " on the left side",
        (true, _) => " on the right side",
    };
    let ramp = if figure.slope == 0.0 { "" } else { ", on a slope of about 8 degrees" };
    Some(format!(
        "let the robot {}{ramp}, for a few minutes: `{}` predicts {:.1} W {} than `{other}`{side} there, {sigmas:.1} times the \
         scatter of a second",
        figure.words,
        best.name,
        by_w.abs(),
        if by_w > 0.0 { "more" } else { "less" }
    ))
}

/// Power of a figure, by side or of the battery [W].
fn powers_w(explanation: &Explanation, figure: &Figure, surface: &str, by_side: bool) -> Option<[f64; 2]> {
    let cold_w = power_w(explanation, figure, surface, by_side, Sides::both(0.0))?;
    if !figure.warm {
        return Some(cold_w.seen_w);
    }
    // What counts is how much more is drawn warm.
    let warm_w = power_w(explanation, figure, surface, by_side, cold_w.loss_w.map(|w| 2.0 * w))?;
    Some([0, 1].map(|c| 2.0 * warm_w.seen_w[c] - cold_w.seen_w[c]))
}

struct Seen {
    seen_w: [f64; 2],
    loss_w: Sides<f64>,
}

fn power_w(
    explanation: &Explanation,
    figure: &Figure,
    surface: &str,
    by_side: bool,
    loss_w: Sides<f64>,
) -> Option<Seen> {
    let Explanation { applied, robot, .. } = explanation;
    let mut robot: Robot = robot.clone();
    for one in applied {
        robot = one.mechanism.robot(&robot, &one.values).unwrap_or(robot);
    }
    let ground: &Surface = robot.surface(surface).ok()?;
    let fastest_mps = robot.max_wheel_speed_mps;
    let yaw_radps = figure.yaw * 2.0 * fastest_mps / robot.slip_track_m;
    let motion = Motion::of_body(&robot, figure.speed * fastest_mps, yaw_radps);
    let attitude = Attitude { pitch_rad: figure.slope * RAMP_RAD, roll_rad: 0.0 };
    let left_mps2 = motion.speed_mps * motion.yaw_rate_radps;
    let acceleration = Acceleration { forward_mps2: figure.gain_mps2, yaw_radps2: 0.0, left_mps2 };
    let rim_mps2 = Sides::both(figure.gain_mps2);
    let motion = motion.heading(figure.heading_rad);
    let mut moment = Moment { motion, acceleration, rim_mps2, attitude, loss_w };
    applied.iter().for_each(|one| one.mechanism.measure(&one.values, &mut moment));
    let adjustment = applied.iter().fold(robot.adjustment(ground, &moment), |all, one| {
        all.and(one.mechanism.adjust(&robot, &one.values, &moment))
    });
    let shape = FrictionShape::new(&robot, ground.slip_angle_scale_rad, &moment.motion);
    let motor_c = Sides::both(robot.motors.reference_temperature_c);
    let manoeuvre = Manoeuvre::adjusted(
        &robot,
        &Friction::new(&robot, ground),
        moment.motion,
        &shape,
        motor_c,
        &adjustment,
    );
    let power = manoeuvre.power_accelerating(moment.attitude, moment.acceleration);
    let true_w = if by_side { [power.side_w.left, power.side_w.right] } else { [power.bus_w, power.bus_w] };
    let read = |w: f64, one: &Applied| match by_side {
        true => one.mechanism.reading_w(&one.values, w),
        false => one.mechanism.battery_reading_w(&one.values, w),
    };
    let seen_w = true_w.map(|w| applied.iter().fold(w, read));
    let k1 = manoeuvre.kernel().k1_w_per_n2;
    Some(Seen { seen_w, loss_w: power.force_n.zip(k1).map(|(f, k1)| k1 * f * f) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::{builtin, mechanism};

    fn explanation(name: &str, values: Vec<f64>) -> Explanation {
        let mechanism = mechanism::by_name(name).unwrap_or(mechanism::ALL[0]);
        let applied = vec![Applied { mechanism, values, span: crate::Span::ALL }];
        Explanation { name: mechanism.name(), applied, robot: builtin::husky_a200() }
    }

    fn one_watt() -> Noise {
        watts([1.0, 1.0])
    }

    /// Noise of two channels.
    fn watts(sigma_w: [f64; 2]) -> Noise {
        let average = |i: u8| crate::Average {
            channel: usize::from(i % 2),
            run: 0,
            suspect: true,
            t_s: f64::from(i),
            input: crate::Input { position_m: [f64::NAN; 2], ..crate::Input::default() },
        };
        let averages: Vec<crate::Average> = (0..40).map(average).collect();
        // The median size of what is normal is 0.6745 of its width.
        let sign = |i: usize| if i % 4 < 2 { 0.6745 } else { -0.6745 };
        let errors: Vec<f64> = (0..40).map(|i| sign(i) * sigma_w[i % 2]).collect();
        Noise::of(&errors, &[10.0; 40], &averages, &[true; 40])
    }

    #[test]
    fn a_load_and_a_fan_part_where_the_load_is_lifted_or_dragged() {
        let (load, fan) = (explanation("payload", vec![10.0]), explanation("hotel_load", vec![5.0]));
        let said = next_drive(&load, &[fan], &one_watt(), "marble", false).unwrap_or_default();
        assert!(said.contains("uphill") || said.contains("spin"), "{said}");
        assert!(said.contains("payload") && said.contains("hotel_load"), "{said}");
    }

    #[test]
    fn of_the_power_of_a_battery_the_scatter_of_another_channel_says_nothing() {
        let (load, fan) = (explanation("payload", vec![10.0]), explanation("hotel_load", vec![5.0]));
        let said = |by_side: bool| {
            next_drive(&load, std::slice::from_ref(&fan), &watts([1.0, 1e-3]), "marble", by_side)
                .unwrap_or_default()
        };
        let times = |said: &str| {
            let words: Vec<&str> = said.split(' ').collect();
            let at = words.iter().position(|word| *word == "times").unwrap();
            words[at - 1].parse::<f64>().unwrap()
        };
        assert!(times(&said(false)) < 1e3 && times(&said(true)) > 1e3, "{} {}", said(false), said(true));
    }

    #[test]
    fn the_same_physics_under_two_names_is_not_told_apart_by_driving() {
        let (one, other) = (explanation("payload", vec![10.0]), explanation("payload", vec![10.0]));
        let said = next_drive(&one, &[other], &one_watt(), "marble", false).unwrap_or_default();
        assert!(said.starts_with("no simple drive"), "{said}");
        assert_eq!(next_drive(&one, &[], &one_watt(), "marble", false), None);
    }
}
