//! The key of a concealed drive: what acted, how strongly, and how much of the power it made.

use serde::Serialize;

use crate::{
    Drive, Effect, EffectName, Error, Family, Log, RobotFile, World,
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
    /// Its size.
    pub parameter: TruthParameter,
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
        let (unit, strength) = (effect.effect.unit(), effect.strength);
        Ok(Truth {
            effect: effect.effect,
            family: effect.effect.family(),
            parameter: TruthParameter { name: parameter_name(effect.effect), value: strength, unit },
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

/// What the strength of an effect measures.
fn parameter_name(effect: EffectName) -> &'static str {
    use EffectName as E;
    match effect {
        E::MotorHeating => "warming",
        E::Payload => "mass_kg",
        E::CenterOfMass => "shift_m",
        E::LoadTransfer => "height_m",
        E::SurfaceChange => "friction_change",
        E::SpeedDependentFriction => "friction_per_mps",
        E::Inertia => "rim_mass_kg",
        E::HotelLoad => "power_w",
        E::Regeneration => "lost_fraction",
        E::Wind => "wind_speed_mps",
        E::SoftSoil => "rolling_coefficient",
        E::WheelSlip => "slip_per_pull",
        E::DrivetrainDrag | E::TowedLoad => "force_n",
        E::GradeDependentFriction => "friction_per_grade",
        E::PitchBias => "bias_rad",
        E::WheelRadius => "encoder_excess",
        E::PowerScale => "power_excess",
        E::PowerOffset => "offset_w",
        E::ClockOffset => "power_late_s",
        _ => "strength",
    }
}
