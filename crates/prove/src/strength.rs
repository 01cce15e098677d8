//! How strong an effect is for a detector that knows it: what it changes, in units of the meters' noise.

use world::{Log, PowerChannels, RobotFile, Row, Sensors};

/// Length of the averages [s].
const AVERAGE_S: f64 = 1.0;
/// Share of the power that goes with speed; copper takes the rest.
const SPEED_SHARE: f64 = 0.7;
/// Standard gravity [m/s²].
const GRAVITY_MPS2: f64 = 9.80665;

/// Whether what the power is computed from is at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misled {
    /// Speeds and slopes are as recorded: only what changes in the power counts.
    No,
    /// Speeds and slopes may be recorded wrongly: what they make one compute counts as much as power itself.
    Yes,
}

/// A meter: its reading and the part of the robot's load and speed that it answers for.
struct Meter {
    power_w: fn(&Row) -> f64,
    rim_mps: fn(&Row) -> f64,
    load_share: f64,
}

const LEFT: Meter = Meter { power_w: |r| r.side_w[0], rim_mps: |r| r.rim_mps[0], load_share: 0.5 };
const RIGHT: Meter = Meter { power_w: |r| r.side_w[1], rim_mps: |r| r.rim_mps[1], load_share: 0.5 };
const BATTERY: Meter =
    Meter { power_w: |r| r.battery_w, rim_mps: |r| (r.rim_mps[0] + r.rim_mps[1]) / 2.0, load_share: 1.0 };

/// Strength of what differs between a recording and its twin without the effect.
///
/// ```text
/// z = √ Σ (ΔP / σ)²
/// ```
///
/// over one-second averages of every power meter, σ being the noise of such an average. Both recordings have the same noise, so
/// that ΔP is the effect. A detector that knows when and how the effect acts sees it at z standard deviations.
pub fn z(log: &Log, twin: &Log, robot: &RobotFile, misled: Misled) -> f64 {
    let sensors = &twin.sensors;
    let length = (AVERAGE_S * sensors.rate_hz).round().max(1.0) as usize;
    let pairs = log.rows.chunks(length).zip(twin.rows.chunks(length));
    let whole = pairs.filter(|(now, then)| now.len() == length && then.len() == length);
    let squares = whole.flat_map(|(now, then)| {
        meters(sensors.power).iter().map(move |meter| {
            let change_w = difference_w(meter, now, then, robot, misled)?;
            Some((change_w / sigma_w(sensors, mean(then, meter.power_w)?, length)).powi(2))
        })
    });
    squares.flatten().sum::<f64>().sqrt()
}

/// The meters of a recording. Motor currents are judged by the power they stand for.
fn meters(power: PowerChannels) -> &'static [Meter] {
    match power {
        PowerChannels::SidesAndBattery => &[LEFT, RIGHT, BATTERY],
        PowerChannels::Sides | PowerChannels::MotorCurrents => &[LEFT, RIGHT],
        PowerChannels::Battery | PowerChannels::CurrentAndVoltage => &[BATTERY],
    }
}

/// Change of what one cannot explain of an average [W].
fn difference_w(meter: &Meter, now: &[Row], then: &[Row], robot: &RobotFile, misled: Misled) -> Option<f64> {
    let power_w = mean(then, meter.power_w)?;
    let change_w = mean(now, meter.power_w)? - power_w;
    if misled == Misled::No {
        return Some(change_w);
    }
    let speed_mps = mean(then, meter.rim_mps)?;
    let faster_mps = mean(now, meter.rim_mps)? - speed_mps;
    let steeper_rad = mean(now, |r| r.pitch_rad)? - mean(then, |r| r.pitch_rad)?;
    let k2 = (robot.motors.left.k2 + robot.motors.right.k2) / 2.0;
    let lifting_w = k2 * robot.mass_kg * GRAVITY_MPS2 * meter.load_share * speed_mps * steeper_rad;
    let share = if speed_mps.abs() > 1e-3 { faster_mps / speed_mps } else { 0.0 };
    Some(change_w - lifting_w - SPEED_SHARE * power_w * share)
}

/// Mean of the rows that have a value.
fn mean(rows: &[Row], value: impl Fn(&Row) -> f64) -> Option<f64> {
    let values: Vec<f64> = rows.iter().map(value).filter(|v| v.is_finite()).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Noise of an average of so many readings, neighbours of which hang together by exp(-step / memory) [W].
fn sigma_w(sensors: &Sensors, power_w: f64, readings: usize) -> f64 {
    let n = readings as f64;
    let keep = (-1.0 / (sensors.rate_hz * sensors.power_noise_memory_s.max(1e-9))).exp();
    let together: f64 = (1..readings).map(|k| 2.0 * (n - k as f64) * keep.powi(k as i32)).sum();
    let one_w = sensors.power_noise_w.hypot(sensors.power_gain_noise * power_w);
    // Rounding to a step scatters by step/√12.
    let step_w = sensors.power_step_w / (12.0 * n).sqrt();
    (one_w * (n + together).sqrt() / n).hypot(step_w).max(1e-9)
}

#[cfg(test)]
mod tests {
    use world::{Drive, DriveKind, Effect, EffectName, World, example_robot, simulate};

    use super::*;

    fn world(effects: Vec<Effect>) -> World {
        let world = World::from_json(r#"{"terrain": "level", "seed": 4}"#).unwrap();
        World { effects, ..world }
    }

    fn drive() -> Drive {
        Drive::new(DriveKind::Rich, 120.0, 3)
    }

    #[test]
    fn the_noise_of_averages_is_what_the_world_makes() {
        let robot = example_robot();
        let noisy = simulate(&world(vec![]), &robot, &drive()).unwrap();
        let quiet = World { sensors: Sensors::perfect(), ..world(vec![]) };
        let quiet = simulate(&quiet, &robot, &drive()).unwrap();
        let errors: Vec<f64> = noisy
            .rows
            .chunks(10)
            .zip(quiet.rows.chunks(10))
            .filter_map(|(a, b)| {
                let power_w = mean(b, BATTERY.power_w)?;
                let full = a.iter().all(|row| row.battery_w.is_finite());
                full.then(|| {
                    (mean(a, BATTERY.power_w).unwrap() - power_w) / sigma_w(&noisy.sensors, power_w, 10)
                })
            })
            .collect();
        let spread = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        // 120 averages: standard error 0.065.
        assert!((spread - 1.0).abs() < 0.2, "{spread}");
    }

    #[test]
    fn strength_is_nothing_without_an_effect_and_grows_with_it() {
        let robot = example_robot();
        let log = |effects| simulate(&world(effects), &robot, &drive()).unwrap();
        let twin = log(vec![]);
        let at = |offset_w| {
            z(&log(vec![Effect::new(EffectName::PowerOffset, offset_w)]), &twin, &robot, Misled::Yes)
        };
        assert_eq!(z(&twin, &twin, &robot, Misled::No), 0.0);
        assert!((at(4.0) / at(2.0) - 2.0).abs() < 0.05, "{} {}", at(4.0), at(2.0));
        // 3 meters, 120 averages, two watts each, 0.7 W of noise at no power and more at some.
        let most = (3.0 * 120.0 * (2.0_f64 / 0.7).powi(2)).sqrt();
        assert!(at(2.0) < most && at(2.0) > 0.3 * most, "{} of {most}", at(2.0));
    }

    #[test]
    fn a_sensor_askew_counts_by_what_it_misleads_one_to() {
        let robot = example_robot();
        let log = |effects| simulate(&world(effects), &robot, &drive()).unwrap();
        let (twin, askew) = (log(vec![]), log(vec![Effect::new(EffectName::PitchBias, 0.01)]));
        assert_eq!(z(&askew, &twin, &robot, Misled::No), 0.0);
        assert!(z(&askew, &twin, &robot, Misled::Yes) > 10.0);
    }
}
