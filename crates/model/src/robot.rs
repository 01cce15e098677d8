//! The robot: its masses, geometry, motors and the friction of the ground it knows.

mod battery;
mod center_of_mass;
mod file;
mod limits;
mod motors;
mod ranges;
mod surface;
mod uncertainty;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use self::{
    battery::Battery,
    center_of_mass::CenterOfMass,
    file::RobotFile,
    limits::Limits,
    motors::{Motor, Motors},
    surface::{PaperSurface, SpeedFriction, Surface},
    uncertainty::{NORMAL_95, Uncertain, Uncertainty, interval},
};
use crate::{
    Error, Sides,
    builtin::{HUSKY_KG, HUSKY_TOP_MPS},
    knowledge::{ModelError, Posterior, PowerNoise, Sources},
    known::KnownMechanism,
    motion::RimSpeeds,
};

/// A skid-steered robot with one motor a side.
///
/// Read from JSON with [`Robot::from_json`]; every field is checked there once, so the rest of the
/// program relies on its ranges. SI units; axes: x forward, y left, z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(try_from = "RobotFile")]
pub struct Robot {
    /// What people call it.
    pub name: String,
    /// Mass with everything on board [kg].
    pub mass_kg: f64,
    /// a: front to rear axle [m].
    pub wheelbase_m: f64,
    /// b: left to right wheel centres [m].
    pub track_m: f64,
    /// Kinematic track [m]: `yaw_rate = (v_right - v_left) / slip_track_m`. Default: `track_m`.
    pub slip_track_m: f64,
    /// Wheel radius [m].
    pub wheel_radius_m: f64,
    /// From the ground to the lowest part of the body between the wheels, on level ground [m]. Default: a third of the wheel
    /// radius; see [`Robot::clearance_m`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_clearance_m: Option<f64>,
    /// Centre of mass relative to the geometric centre. Default: at the centre, on the ground.
    pub center_of_mass: CenterOfMass,
    /// Moment of inertia about the vertical [kg m²]. Default: a box of wheelbase by track, m (a² + b²) / 12.
    pub yaw_inertia_kgm2: f64,
    /// Highest rim speed of a wheel [m/s].
    pub max_wheel_speed_mps: f64,
    /// The drive train of each side.
    pub motors: Motors,
    /// Electronics that are always on [W]. Default 0.
    pub hotel_power_w: f64,
    /// Motor driver's own draw while driving, per side [W]. Default 0.
    pub drive_electronics_w: f64,
    /// The battery; without one, range questions are refused. Default: none.
    pub battery: Option<Battery>,
    /// What the robot must not be asked to do.
    pub limits: Limits,
    /// Friction by surface name.
    #[cfg_attr(feature = "openapi", schema(value_type = std::collections::HashMap<String, Surface>))]
    pub surfaces: BTreeMap<String, Surface>,
    /// The surface of ground that names none.
    pub default_surface: String,
    /// Relative one-sigma uncertainty of the parameters.
    pub uncertainty: Uncertainty,
    /// Where its numbers come from, in words. Default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Where single constants come from, by field. Default: none.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = std::collections::HashMap<String, crate::knowledge::Provenance>))]
    pub provenance: Sources,
    /// What a fit left open of constants that hang together; for these it goes before `uncertainty`. Default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
    /// What the model missed of the drives that the robot was fitted to. Default: by the least known of its constants.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_error: Option<ModelError>,
    /// Noise of the power that these drives recorded. Default: unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<PowerNoise>,
    /// What the fields above cannot hold, found by a diagnosis, say. Default: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<crate::KnownMechanismFile>))]
    pub mechanisms: Vec<KnownMechanism>,
}

impl Robot {
    /// Its mass over that of a Husky A200, as which its motors, and what it may carry and pull, are taken to grow.
    pub fn size(&self) -> f64 {
        self.mass_kg / HUSKY_KG
    }

    /// What its weight takes at top speed over what that of a Husky A200 does, as which its drivers are taken to grow.
    pub fn strength(&self) -> f64 {
        self.size() * self.max_wheel_speed_mps / HUSKY_TOP_MPS
    }

    /// Reads and checks a robot file.
    ///
    /// # Errors
    /// [`Error::Json`] names the place of a missing, unknown or mistyped field; [`Error::OutOfRange`] and
    /// [`Error::UnknownSurface`] name the field whose value cannot be right.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let file: RobotFile = document::from_json(text.as_bytes())?;
        Robot::try_from(file)
    }

    /// The friction of a surface by name.
    ///
    /// # Errors
    /// [`Error::UnknownSurface`], which lists the known ones.
    pub fn surface(&self, name: &str) -> Result<&Surface, Error> {
        self.surfaces.get(name).ok_or_else(|| Error::UnknownSurface {
            name: name.to_owned(),
            known: self.surfaces.keys().cloned().collect(),
        })
    }

    /// Both motors as a pair.
    pub fn motor_sides(&self) -> Sides<Motor> {
        Sides { left: self.motors.left, right: self.motors.right }
    }

    /// R': half the slip track, the turning radius at which the inner wheels stand still [m].
    pub fn half_slip_track_m(&self) -> f64 {
        self.slip_track_m / 2.0
    }

    /// Height of ground between the wheels, above the plane on which these stand, that the body just passes over [m].
    ///
    /// Where the file does not say, a third of the wheel radius: less than any rover of four equal wheels is built with (a
    /// Husky A200 has 0.13 m on wheels of 0.165 m), so that what was not measured is not risked.
    pub fn clearance_m(&self) -> f64 {
        const OF_WHEEL_RADIUS: f64 = 1.0 / 3.0;
        self.ground_clearance_m.unwrap_or(OF_WHEEL_RADIUS * self.wheel_radius_m)
    }

    /// Rim speeds of the wheels at a body speed and yaw rate [m/s].
    pub fn rim_speeds_mps(&self, speed_mps: f64, yaw_rate_radps: f64) -> Sides<f64> {
        RimSpeeds::of(self).at_mps(speed_mps, yaw_rate_radps)
    }

    /// Checks every field's range; reading a file does this already, code that builds a robot may call it.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::UnknownSurface`] for the first field that cannot be right.
    pub fn validate(&self) -> Result<(), Error> {
        ranges::check(self)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Error, Robot, builtin};

    fn husky_json() -> serde_json::Value {
        serde_json::to_value(builtin::husky_a200()).unwrap()
    }

    fn read(value: &serde_json::Value) -> Result<Robot, Error> {
        Robot::from_json(&value.to_string())
    }

    #[test]
    fn a_robot_survives_a_round_trip_through_json() {
        assert_eq!(read(&husky_json()).unwrap(), builtin::husky_a200());
    }

    #[test]
    fn a_missing_slip_track_is_the_track_and_a_missing_inertia_that_of_a_box() {
        let mut file = husky_json();
        let object = file.as_object_mut().unwrap();
        object.remove("slip_track_m");
        object.remove("yaw_inertia_kgm2");
        let robot = read(&file).unwrap();
        assert_eq!(robot.slip_track_m, 0.54);
        assert_eq!(robot.yaw_inertia_kgm2, 90.0 * 2.0 * 0.54f64.powi(2) / 12.0);
    }

    #[test]
    fn a_missing_clearance_is_a_third_of_the_wheel_radius() {
        let mut file = husky_json();
        assert_eq!(read(&file).unwrap().clearance_m(), 0.165 / 3.0);
        file["ground_clearance_m"] = 0.13.into();
        assert_eq!(read(&file).unwrap().clearance_m(), 0.13);
        file["ground_clearance_m"] = 130.0.into();
        assert_eq!(read(&file).unwrap_err().field(), Some("ground_clearance_m"));
    }

    #[test]
    fn names_are_neither_empty_nor_longer_than_can_be_shown() {
        let named = |name: &str| {
            let mut file = husky_json();
            file["name"] = name.into();
            read(&file)
        };
        for name in ["h", &"é".repeat(200)] {
            assert_eq!(named(name).unwrap().name, name);
        }
        for name in ["", &"n".repeat(201), "two\nlines", "a\u{1b}[2J"] {
            let error = named(name).unwrap_err();
            assert_eq!(error.field(), Some("name"), "{name}");
            assert!(error.to_string().len() < 200, "{error}");
        }
        let mut file = husky_json();
        file["surfaces"]["s".repeat(300)] = file["surfaces"]["marble"].clone();
        assert_eq!(read(&file).unwrap_err().field(), Some("surfaces"));
    }

    #[test]
    fn an_unknown_field_is_named_with_its_place() {
        let mut file = husky_json();
        file["motors"]["left"]["k3"] = 1.0.into();
        let message = read(&file).unwrap_err().to_string();
        assert!(message.contains("motors.left") && message.contains("k3"), "{message}");
    }

    #[test]
    fn wrong_magnitudes_are_refused_by_field() {
        for (pointer, value) in [
            ("/wheelbase_m", 5400.0),
            ("/track_m", 540.0),
            ("/mass_kg", -1.0),
            ("/motors/left/k2", 0.5),
            ("/motors/regeneration", 1.5),
            ("/surfaces/marble/mu_skid", 29.0),
            ("/limits/max_pitch_rad", 30.0),
            ("/battery/reserve_fraction", 20.0),
            ("/battery/peukert_exponent", 11.6),
            ("/battery/ageing_factor", 80.0),
            ("/battery/temperature_c", 298.0),
            ("/battery/charge_efficiency", 85.0),
            ("/center_of_mass/left_m", 0.4),
            ("/slip_track_m", 54.0),
            ("/uncertainty/k1", 5.0),
        ] {
            let mut file = husky_json();
            *file.pointer_mut(pointer).unwrap() = value.into();
            let message = read(&file).unwrap_err().to_string();
            let field = pointer.trim_start_matches('/').replace('/', ".");
            assert!(message.contains(&field), "{pointer}: {message}");
        }
    }

    #[test]
    fn a_default_surface_that_does_not_exist_is_refused_with_the_known_ones() {
        let mut file = husky_json();
        file["default_surface"] = "lava".into();
        let message = read(&file).unwrap_err().to_string();
        assert!(message.contains("lava") && message.contains("marble"), "{message}");
    }
}
