//! Effects that a world conceals: what the file says of each, and which physics stands behind the name.

mod act;
mod catalog;
mod drive_train;
mod electronics;
mod friction;
mod load;
mod measurement;
mod outside;
mod unlisted;

use serde::{Deserialize, Serialize};

pub(crate) use act::{Act, Conditions, Distortion, Surroundings};
pub use catalog::{EffectName, Family};
pub(crate) use outside::{air_force_n, drag_area_m2, trailer_kg};

use crate::{Error, limits::within};

/// One effect of a world file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Which one.
    pub effect: EffectName,
    /// How strong, in the unit of [`EffectName::unit`]; its range is [`EffectName::range`].
    pub strength: f64,
    /// From when on it acts, in the recording's time [s]. Default 0.
    #[serde(default)]
    pub onset_s: f64,
    /// Where it acts; default: everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
    /// Which side, where it acts on one. Default: left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// A direction [rad]: where wind blows to and furrows run, counter-clockwise from east; where the centre of mass
    /// moves, counter-clockwise from forward. Default 0.
    #[serde(default)]
    pub direction_rad: f64,
}

/// A rectangle on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// From west to east [m].
    pub x_m: [f64; 2],
    /// From south to north [m].
    pub y_m: [f64; 2],
}

/// A side of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// 0 left, 1 right.
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

impl Effect {
    /// An effect that acts everywhere from the start.
    pub fn new(effect: EffectName, strength: f64) -> Self {
        Effect { effect, strength, onset_s: 0.0, place: None, side: None, direction_rad: 0.0 }
    }

    /// Checks every range.
    pub(crate) fn check(&self, i: usize) -> Result<(), Error> {
        let field = |name: &str| format!("effects[{i}].{name}");
        within(field("strength"), self.strength, self.effect.range(), self.effect.unit())?;
        within(field("onset_s"), self.onset_s, [0.0, 1e7], "give seconds from the start")?;
        within(field("direction_rad"), self.direction_rad, [-10.0, 10.0], "give radians")?;
        if let Some(place) = self.place {
            for (axis, [low, high]) in [("x_m", place.x_m), ("y_m", place.y_m)] {
                within(
                    field(&format!("place.{axis}[1]")),
                    high,
                    [low, f64::MAX],
                    "give the smaller number first",
                )?;
            }
        }
        Ok(())
    }

    /// Whether it acts at a time and place.
    pub(crate) fn acts(&self, t_s: f64, [x_m, y_m]: [f64; 2]) -> bool {
        let inside = |place: Place| {
            (place.x_m[0]..=place.x_m[1]).contains(&x_m) && (place.y_m[0]..=place.y_m[1]).contains(&y_m)
        };
        t_s >= self.onset_s && self.place.is_none_or(inside)
    }

    /// The side that it acts on.
    pub(crate) fn side(&self) -> usize {
        self.side.map_or(0, Side::index)
    }

    /// What it does.
    pub(crate) fn actor(&self) -> Box<dyn Act> {
        use EffectName as E;
        let s = self.strength;
        match self.effect {
            E::Payload => Box::new(load::Payload { mass_kg: s }),
            E::CenterOfMass => {
                Box::new(load::Shift { by_m: [s * self.direction_rad.cos(), s * self.direction_rad.sin()] })
            }
            E::LoadTransfer => Box::new(load::Height { by_m: s }),
            E::SurfaceChange => Box::new(friction::Surface { fraction: s }),
            E::SpeedDependentFriction => Box::new(friction::WithSpeed { per_mps: s }),
            E::GradeDependentFriction => Box::new(friction::WithGrade { per_grade: s }),
            E::SoftSoil => Box::new(friction::Sinkage { rolling: s }),
            E::WheelSlip => Box::new(friction::Loose { slip_per_pull: s }),
            E::MotorHeating => Box::new(drive_train::Heating { scale: s }),
            E::Inertia => Box::new(drive_train::Rotors { mass_kg: s }),
            E::Regeneration => Box::new(drive_train::LostReturn { fraction: s }),
            E::DrivetrainDrag => Box::new(drive_train::Drag { force_n: s, side: self.side() }),
            E::HotelLoad => Box::new(electronics::Hotel { power_w: s }),
            E::Wind => Box::new(outside::Gale { speed_mps: s, toward_rad: self.direction_rad }),
            E::TowedLoad => Box::new(outside::Trailer::new(s)),
            E::PitchBias => Box::new(measurement::Pitch { bias_rad: s }),
            E::WheelRadius => Box::new(measurement::Encoder { excess: s }),
            E::PowerScale => Box::new(measurement::PowerGain { excess: s }),
            E::PowerOffset => Box::new(measurement::PowerOffset { offset_w: s }),
            E::ClockOffset => Box::new(measurement::Clock { late_s: s }),
            E::BindingBrake => Box::new(unlisted::Brake::new(s, self.side())),
            E::Puddles => Box::new(unlisted::Puddles { drag_n_per_m: s }),
            E::LooseLoad => Box::new(unlisted::LooseLoad::new(s)),
            E::LowDutyLoss => Box::new(electronics::LowDuty { power_w: s }),
            E::WheelBump => Box::new(unlisted::Bump { force_n: s, side: self.side() }),
            E::TurnOnSlope => Box::new(unlisted::TurnOnSlope { moment_nm: s }),
            E::VoltageFan => Box::new(electronics::Fan { power_w: s }),
            E::Furrows => Box::new(unlisted::Furrows { force_n: s, along_rad: self.direction_rad }),
            E::StickyStart => Box::new(unlisted::Sticky::new(s)),
            E::Resonance => Box::new(unlisted::Resonance { force_n: s }),
        }
    }
}
