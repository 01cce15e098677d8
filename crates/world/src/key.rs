//! The key of a concealed drive: what acted, how strongly, and how much of the power it made.

use serde::Serialize;

use crate::{
    Drive, Effect, EffectName, Error, Family, Log, RobotFile, World,
    effect::{drag_area_m2, trailer_kg},
    simulate::{Simulation, simulate_closely},
};

/// What is true of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// One entry for each effect; none for a healthy robot.
    pub truths: Vec<Truth>,
    /// Mean power of the same drive without any effect [W].
    pub healthy_mean_w: f64,
    /// Fields of the robot file that the healthy robot differs in, for worlds with scatter.
    pub robot: RobotFile,
}

/// One effect as it was.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Its name; for listed effects the contract's mechanism.
    pub effect: EffectName,
    /// Physics, measurement, or none that is listed.
    pub family: Family,
    /// Its size, where a listed mechanism has the same quantity by the name that reports give it.
    pub parameters: Vec<TruthParameter>,
    /// From when on it acted [s].
    pub onset_s: f64,
    /// Where it acted, if not everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<crate::Place>,
    /// On which side, where it acts on one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<crate::Side>,
    /// Mean change of the recorded power by this effect alone, while it acted, over the mean power without it [-].
    pub power_share: f64,
    /// Root mean square of that change over the mean power [-].
    pub power_change: f64,
    /// Root mean square changes of what else is recorded, in each channel's own unit: rim speed, yaw rate, pitch.
    pub channel_changes: [f64; 3],
}

/// The size of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TruthParameter {
    /// What is measured by it.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
}

impl Key {
    /// Works out the key by driving again without each effect: noise is the same, so what differs is the effect.
    ///
    /// # Errors
    /// Those of [`crate::simulate`].
    pub fn of(world: &World, robot: &RobotFile, drive: &Drive) -> Result<Self, Error> {
        let healthy = simulate_closely(&world.without_effects(), robot, drive)?;
        let healthy_mean_w = mean_w(&healthy.log, 0.0);
        let truths = world.effects.iter().map(|effect| Truth::of(effect, world, robot, drive, &healthy));
        Ok(Key { truths: truths.collect::<Result<_, _>>()?, healthy_mean_w, robot: healthy.robot.clone() })
    }
}

impl Truth {
    fn of(
        effect: &Effect,
        world: &World,
        robot: &RobotFile,
        drive: &Drive,
        healthy: &Simulation,
    ) -> Result<Self, Error> {
        let alone = World { effects: vec![effect.clone()], ..world.clone() };
        let log = simulate_closely(&alone, robot, drive)?.log;
        let (plain, base_w) = (&healthy.log, mean_w(&healthy.log, effect.onset_s).abs().max(1e-9));
        Ok(Truth {
            effect: effect.effect,
            family: effect.effect.family(),
            parameters: parameters(effect, robot),
            onset_s: effect.onset_s,
            place: effect.place,
            side: effect.effect.acts_on_a_side().then(|| effect.side.unwrap_or(crate::Side::Left)),
            power_share: moments(&log, plain, effect.onset_s, total_w).0 / base_w,
            power_change: moments(&log, plain, effect.onset_s, total_w).1 / base_w,
            channel_changes: [
                moments(&log, plain, effect.onset_s, |r| (r.rim_mps[0] + r.rim_mps[1]) / 2.0).1,
                moments(&log, plain, effect.onset_s, |r| r.yaw_rate_radps).1,
                moments(&log, plain, effect.onset_s, |r| r.pitch_rad).1,
            ],
        })
    }
}

/// Power of a row: at the battery, which sees drivers and electronics [W].
fn total_w(row: &crate::Row) -> f64 {
    row.battery_w
}

fn mean_w(log: &Log, from_s: f64) -> f64 {
    let powers: Vec<f64> =
        log.rows.iter().filter(|r| r.t_s >= from_s).map(total_w).filter(|w| w.is_finite()).collect();
    powers.iter().sum::<f64>() / powers.len().max(1) as f64
}

/// Mean and root mean square of the difference of a channel between two recordings of the same drive.
fn moments(log: &Log, plain: &Log, from_s: f64, channel: fn(&crate::Row) -> f64) -> (f64, f64) {
    let pairs = log.rows.iter().zip(&plain.rows).filter(|(row, _)| row.t_s >= from_s);
    let differences: Vec<f64> =
        pairs.map(|(a, b)| channel(a) - channel(b)).filter(|d| d.is_finite()).collect();
    let count = differences.len().max(1) as f64;
    let square = differences.iter().map(|d| d * d).sum::<f64>() / count;
    (differences.iter().sum::<f64>() / count, square.sqrt())
}

/// What an effect amounts to, in the quantities by which reports tell its mechanism; else by its own strength.
fn parameters(effect: &Effect, robot: &RobotFile) -> Vec<TruthParameter> {
    use EffectName as E;
    let one = |name, value, unit| TruthParameter { name, value, unit };
    let (s, name) = (effect.strength, effect.effect);
    let [ahead, aside] = [s * effect.direction_rad.cos(), s * effect.direction_rad.sin()];
    match name {
        E::Payload => vec![one("mass_kg", s, "kg")],
        E::CenterOfMass => vec![one("forward_m", ahead, "m"), one("left_m", aside, "m")],
        E::LoadTransfer => vec![one("height_m", s, "m")],
        E::SurfaceChange => vec![one("roll_change", s, "1"), one("skid_change", s, "1")],
        E::SpeedDependentFriction => vec![one("per_mps", s, "s/m")],
        E::Inertia => vec![one("kg_per_side", s / 2.0, "kg")],
        E::HotelLoad => vec![one("power_w", s, "W")],
        E::Regeneration => vec![one("added", -s * robot.motors.regeneration, "1")],
        E::Wind => vec![
            one("drag_area_m2", drag_area_m2(robot)[0], "m²"),
            one("east_mps", ahead, "m/s"),
            one("north_mps", aside, "m/s"),
        ],
        E::DrivetrainDrag => {
            let sides = [0, 1].map(|side| if side == effect.side() { s } else { 0.0 });
            vec![one("left_n", sides[0], "N"), one("right_n", sides[1], "N")]
        }
        E::TowedLoad => vec![one("rolling_n", s, "N"), one("mass_kg", trailer_kg(s), "kg")],
        E::GradeDependentFriction => vec![one("per_slope", s, "1")],
        E::PitchBias => vec![one("bias_rad", s, "rad")],
        // Reports say by how much the wheels turn faster than recorded.
        E::WheelRadius => vec![one("scale", 1.0 / (1.0 + s) - 1.0, "1")],
        E::PowerScale => vec![one("gain", s, "1")],
        E::PowerOffset => vec![one("offset_w", s, "W")],
        E::ClockOffset => vec![one("delay_s", s, "s")],
        _ => vec![one("strength", s, name.unit())],
    }
}
