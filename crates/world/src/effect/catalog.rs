//! The names of all effects, with unit and range of their strength.

use serde::{Deserialize, Serialize};

/// Every effect that a world can conceal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum EffectName {
    /// Windings and cases warm up; strength 1 is a Husky's motor.
    MotorHeating,
    /// Mass on board that the file does not know.
    Payload,
    /// The centre of mass lies elsewhere; `direction_rad` says where.
    CenterOfMass,
    /// The centre of mass lies higher, so that slopes and accelerations shift load.
    LoadTransfer,
    /// Rolling and skid friction of the ground change by a fraction.
    SurfaceChange,
    /// Rolling friction grows with speed.
    SpeedDependentFriction,
    /// Rotors and gears have inertia of their own.
    Inertia,
    /// Electronics draw from the battery.
    HotelLoad,
    /// A fraction of the returned power is lost.
    Regeneration,
    /// Air that blows, drag of still air included.
    Wind,
    /// Wheels sink in.
    SoftSoil,
    /// Wheels slip more under pull.
    WheelSlip,
    /// One side is held back by a constant force.
    DrivetrainDrag,
    /// A trailer.
    TowedLoad,
    /// Rolling friction grows with the slope.
    GradeDependentFriction,
    /// The pitch sensor is mounted askew.
    PitchBias,
    /// The wheels are smaller than the file says, so encoders report too much.
    WheelRadius,
    /// Power is reported too large.
    PowerScale,
    /// Power is reported with a constant on top.
    PowerOffset,
    /// Power is reported late.
    ClockOffset,
    /// A brake that binds until it is warm.
    BindingBrake,
    /// Water stands in hollows.
    Puddles,
    /// A load that slides to the lower side.
    LooseLoad,
    /// Drivers that lose at low duty.
    LowDutyLoss,
    /// A bump once per turn of a wheel.
    WheelBump,
    /// Turning on a slope meets more resistance.
    TurnOnSlope,
    /// A fan of the drivers that follows the battery's voltage.
    VoltageFan,
    /// Furrows that are hard to cross.
    Furrows,
    /// Grease that stiffens while the robot stands.
    StickyStart,
    /// A frame that rings at one speed.
    Resonance,
}

/// Where the truth of an effect lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Physics that a diagnosis can name.
    Physics,
    /// A fault of measurement that a diagnosis can name.
    Measurement,
    /// Physics that no name of a diagnosis stands for.
    Unlisted,
}

/// Name, family, unit, range of strength, and strengths that a Husky shows.
type Line = (EffectName, Family, &'static str, [f64; 2], [f64; 2]);

const LINES: [Line; 30] = {
    use EffectName as E;
    use Family::{Measurement as M, Physics as P, Unlisted as U};
    [
        (E::MotorHeating, P, "share of a Husky motor's warming", [0.0, 5.0], [0.3, 2.0]),
        (E::Payload, P, "kg", [-50.0, 500.0], [2.0, 30.0]),
        (E::CenterOfMass, P, "m", [0.0, 1.0], [0.02, 0.12]),
        (E::LoadTransfer, P, "m", [0.0, 3.0], [0.1, 0.6]),
        (E::SurfaceChange, P, "fraction of friction", [-0.9, 5.0], [0.03, 0.5]),
        (E::SpeedDependentFriction, P, "fraction of rolling friction per m/s", [-0.9, 10.0], [0.1, 2.0]),
        (E::Inertia, P, "kg at the rims, both sides", [0.0, 500.0], [10.0, 80.0]),
        (E::HotelLoad, P, "W", [0.0, 1000.0], [2.0, 40.0]),
        (E::Regeneration, P, "fraction of the returned power that is lost", [0.0, 1.0], [0.2, 1.0]),
        (E::Wind, P, "m/s", [0.0, 40.0], [4.0, 14.0]),
        (E::SoftSoil, P, "rolling coefficient on top at nominal load", [0.0, 1.0], [0.003, 0.06]),
        (E::WheelSlip, P, "slip per pull over load", [0.0, 5.0], [0.05, 1.0]),
        (E::DrivetrainDrag, P, "N", [0.0, 500.0], [1.0, 25.0]),
        (E::TowedLoad, P, "N of pull on level ground", [0.0, 500.0], [2.0, 40.0]),
        (
            E::GradeDependentFriction,
            P,
            "fraction of rolling friction per unit of grade",
            [0.0, 50.0],
            [0.5, 10.0],
        ),
        (E::PitchBias, M, "rad", [-0.5, 0.5], [0.003, 0.04]),
        (E::WheelRadius, M, "fraction", [-0.5, 0.5], [0.01, 0.15]),
        (E::PowerScale, M, "fraction", [-0.9, 2.0], [0.01, 0.2]),
        (E::PowerOffset, M, "W on each meter", [-500.0, 500.0], [1.0, 20.0]),
        (E::ClockOffset, M, "s", [-3.0, 3.0], [0.1, 0.8]),
        (E::BindingBrake, U, "N when cold", [0.0, 500.0], [4.0, 50.0]),
        (E::Puddles, U, "N per m of depth", [0.0, 1e4], [20.0, 400.0]),
        (E::LooseLoad, U, "m of sideways shift per rad", [0.0, 5.0], [0.3, 2.0]),
        (E::LowDutyLoss, U, "W per side at no duty", [0.0, 500.0], [3.0, 40.0]),
        (E::WheelBump, U, "N at its height", [0.0, 500.0], [5.0, 60.0]),
        (E::TurnOnSlope, U, "Nm per unit of grade", [0.0, 5000.0], [50.0, 1000.0]),
        (E::VoltageFan, U, "W at full voltage", [0.0, 500.0], [4.0, 40.0]),
        (E::Furrows, U, "N across", [0.0, 500.0], [4.0, 50.0]),
        (E::StickyStart, U, "N after a long stand", [0.0, 500.0], [10.0, 100.0]),
        (E::Resonance, U, "N at its peak", [0.0, 500.0], [5.0, 60.0]),
    ]
};

impl EffectName {
    /// All of them.
    pub fn all() -> impl Iterator<Item = EffectName> {
        LINES.iter().map(|line| line.0)
    }

    /// The name as files have it, which for listed effects is the contract's mechanism name.
    pub fn name(self) -> String {
        let quoted = serde_json::to_string(&self).unwrap_or_default();
        quoted.trim_matches('"').to_owned()
    }

    /// Where its truth lies.
    pub fn family(self) -> Family {
        self.line().1
    }

    /// Unit of its strength.
    pub fn unit(self) -> &'static str {
        self.line().2
    }

    /// Strengths that a world file may give.
    pub fn range(self) -> [f64; 2] {
        self.line().3
    }

    /// Strengths that are met on a robot of a Husky's size, from barely seen to plain.
    pub fn typical(self) -> [f64; 2] {
        self.line().4
    }

    /// Whether it acts on one side, so that its `side` matters.
    pub fn acts_on_a_side(self) -> bool {
        matches!(self, EffectName::DrivetrainDrag | EffectName::BindingBrake | EffectName::WheelBump)
    }

    fn line(self) -> &'static Line {
        // The table stands in the order of the enum; a test holds them together.
        &LINES[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_the_order_of_the_names_and_holds_every_mechanism() {
        for (i, name) in EffectName::all().enumerate() {
            assert_eq!(name as usize, i);
        }
        let listed = "motor_heating payload center_of_mass load_transfer surface_change speed_dependent_friction inertia \
            hotel_load regeneration wind soft_soil wheel_slip drivetrain_drag towed_load grade_dependent_friction \
            pitch_bias wheel_radius power_scale power_offset clock_offset";
        let names: Vec<String> =
            EffectName::all().filter(|n| n.family() != Family::Unlisted).map(EffectName::name).collect();
        assert_eq!(names, listed.split_whitespace().collect::<Vec<_>>());
        assert!(EffectName::all().filter(|n| n.family() == Family::Unlisted).count() >= 6);
    }

    #[test]
    fn typical_strengths_may_be_given() {
        for name in EffectName::all() {
            let ([low, high], [least, most]) = (name.typical(), name.range());
            assert!(low < high && least <= low && high <= most, "{name:?}");
        }
    }
}
