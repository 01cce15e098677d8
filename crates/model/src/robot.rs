//! The robot: its masses, geometry, motors and the friction of the ground it knows.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{
    Error, Sides,
    builtin::{HUSKY_KG, HUSKY_TOP_MPS},
    knowledge::{ModelError, Posterior, PowerNoise, Sources},
    known::KnownMechanism,
    robot_limits,
};
pub use crate::{battery::Battery, knowledge::Uncertainty};

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

/// Where the centre of mass lies relative to the geometric centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CenterOfMass {
    /// Towards the front axle [m].
    pub forward_m: f64,
    /// Towards the left wheels [m].
    pub left_m: f64,
    /// Above the ground [m]. Slopes, turns and accelerations shift load by it (eq. 14); 0, as where it is not known, shifts none.
    pub height_m: f64,
}

/// Both sides' motors and what they share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// The left side's constants.
    pub left: Motor,
    /// The right side's constants.
    pub right: Motor,
    /// T0: temperature at which k1 and k2 hold [°C]. Default 20.
    #[serde(default = "reference_temperature_c")]
    pub reference_temperature_c: f64,
    /// α_R of eq. 7 [1/K]. Default 0.0039 (copper).
    #[serde(default = "resistance_per_k")]
    pub resistance_per_k: f64,
    /// α_M of eq. 8 [1/K]. Default −0.0012 (ferrite magnets lose torque when hot).
    #[serde(default = "motor_constant_per_k")]
    pub motor_constant_per_k: f64,
    /// Fraction of the back-driven power `u F / k2` that reaches the bus, 0 to 1. Default 1.
    #[serde(default = "regeneration")]
    pub regeneration: f64,
}

/// Equivalent motor constants of one side (eq. 2, Table I).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// k1: copper loss per squared wheel force [W/N²].
    pub k1_w_per_n2: f64,
    /// k2: electrical per mechanical power, at least 1 (gears and belts only lose) [-].
    pub k2: f64,
    /// Wheel force per motor current [N/A]; needed only for recordings of motor current.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n_per_a: Option<f64>,
    /// Motor current that is read while the robot stands, of recordings of motor current [A]. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub idle_current_a: Option<f64>,
}

/// What the robot must not be asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Largest force a side may be asked for [N]. Default: no limit but the pitch's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_side_force_n: Option<f64>,
    /// Steepest climb or descent [rad]. Default 0.52 (30°).
    pub max_pitch_rad: f64,
    /// Steepest sideways tilt [rad]. Default 0.45 (26°).
    pub max_roll_rad: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { max_side_force_n: None, max_pitch_rad: 0.52, max_roll_rad: 0.45 }
    }
}

/// Friction of one kind of ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// μ_R: rolling resistance over normal load [-].
    pub mu_roll: f64,
    /// μ_S: lateral skid resistance over normal load [-].
    pub mu_skid: f64,
    /// α_s: slip angle over which skid resistance saturates [rad]; 0 is the paper's Coulomb skid. Default 0.30.
    #[serde(default = "slip_angle_scale_rad")]
    pub slip_angle_scale_rad: f64,
    /// What only the paper's printed form needs. Default: derived from the values above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dogru_marques: Option<PaperSurface>,
    /// What acts on this ground alone and changes its friction. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<crate::KnownMechanismFile>))]
    pub mechanisms: Vec<KnownMechanism>,
}

/// The paper's own description of a surface: constants per speed and a constant inner friction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PaperSurface {
    /// Friction of the inner side for R ≤ R_c (Table II) [-]. Default: half of eq. 16 at R_0 = 0 plus half μ_R.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner_friction: Option<f64>,
    /// (μ_R, μ_S) at increasing speeds (Fig. 13); between them they are interpolated. Default: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_speed: Vec<SpeedFriction>,
}

/// The coefficients of eq. 16 as fitted at one speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct SpeedFriction {
    /// Translational speed of the fit [m/s].
    pub speed_mps: f64,
    /// μ_R fitted there [-].
    pub mu_roll: f64,
    /// μ_S fitted there [-].
    pub mu_skid: f64,
}

impl Surface {
    /// The same ground with rolling and skid resistance multiplied.
    ///
    /// In the printed form's opposite sides mostly skid counts, so its inner friction goes with μ_S.
    #[must_use]
    pub fn scaled(&self, roll: f64, skid: f64) -> Surface {
        let mut scaled = self.clone();
        scaled.mu_roll *= roll;
        scaled.mu_skid *= skid;
        if let Some(paper) = &mut scaled.dogru_marques {
            paper.inner_friction = paper.inner_friction.map(|friction| friction * skid);
            for row in &mut paper.by_speed {
                row.mu_roll *= roll;
                row.mu_skid *= skid;
            }
        }
        scaled
    }
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
        let turned = 1.0 / (1.0 - self.wheel_slip());
        let half = yaw_rate_radps * self.half_slip_track_m() / (1.0 - self.turning_slip());
        Sides { left: turned * (speed_mps - half), right: turned * (speed_mps + half) }
    }

    /// Checks every field's range; reading a file does this already, code that builds a robot may call it.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::UnknownSurface`] for the first field that cannot be right.
    pub fn validate(&self) -> Result<(), Error> {
        robot_limits::check(self)
    }
}

/// A robot as its file has it: unchecked, with the optional fields still open. [`Robot::try_from`] checks it.
///
/// The fields are those of [`Robot`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RobotFile {
    pub name: String,
    pub mass_kg: f64,
    pub wheelbase_m: f64,
    pub track_m: f64,
    pub slip_track_m: Option<f64>,
    pub wheel_radius_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_clearance_m: Option<f64>,
    #[serde(default)]
    pub center_of_mass: CenterOfMass,
    pub yaw_inertia_kgm2: Option<f64>,
    pub max_wheel_speed_mps: f64,
    pub motors: Motors,
    #[serde(default)]
    pub hotel_power_w: f64,
    #[serde(default)]
    pub drive_electronics_w: f64,
    pub battery: Option<Battery>,
    #[serde(default)]
    pub limits: Limits,
    #[cfg_attr(feature = "openapi", schema(value_type = std::collections::HashMap<String, Surface>))]
    pub surfaces: BTreeMap<String, Surface>,
    pub default_surface: String,
    #[serde(default)]
    pub uncertainty: Uncertainty,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = std::collections::HashMap<String, crate::knowledge::Provenance>))]
    pub provenance: Sources,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_error: Option<ModelError>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<PowerNoise>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<crate::KnownMechanismFile>))]
    pub mechanisms: Vec<KnownMechanism>,
}

impl From<Robot> for RobotFile {
    fn from(robot: Robot) -> Self {
        RobotFile {
            name: robot.name,
            mass_kg: robot.mass_kg,
            wheelbase_m: robot.wheelbase_m,
            track_m: robot.track_m,
            slip_track_m: Some(robot.slip_track_m),
            wheel_radius_m: robot.wheel_radius_m,
            ground_clearance_m: robot.ground_clearance_m,
            center_of_mass: robot.center_of_mass,
            yaw_inertia_kgm2: Some(robot.yaw_inertia_kgm2),
            max_wheel_speed_mps: robot.max_wheel_speed_mps,
            motors: robot.motors,
            hotel_power_w: robot.hotel_power_w,
            drive_electronics_w: robot.drive_electronics_w,
            battery: robot.battery,
            limits: robot.limits,
            surfaces: robot.surfaces,
            default_surface: robot.default_surface,
            uncertainty: robot.uncertainty,
            source: robot.source,
            provenance: robot.provenance,
            posterior: robot.posterior,
            model_error: robot.model_error,
            noise: robot.noise,
            mechanisms: robot.mechanisms,
        }
    }
}

impl TryFrom<RobotFile> for Robot {
    type Error = Error;

    fn try_from(file: RobotFile) -> Result<Self, Error> {
        let box_inertia_kgm2 = file.mass_kg * (file.wheelbase_m.powi(2) + file.track_m.powi(2)) / 12.0;
        let robot = Robot {
            name: file.name,
            mass_kg: file.mass_kg,
            wheelbase_m: file.wheelbase_m,
            track_m: file.track_m,
            slip_track_m: file.slip_track_m.unwrap_or(file.track_m),
            wheel_radius_m: file.wheel_radius_m,
            ground_clearance_m: file.ground_clearance_m,
            center_of_mass: file.center_of_mass,
            yaw_inertia_kgm2: file.yaw_inertia_kgm2.unwrap_or(box_inertia_kgm2),
            max_wheel_speed_mps: file.max_wheel_speed_mps,
            motors: file.motors,
            hotel_power_w: file.hotel_power_w,
            drive_electronics_w: file.drive_electronics_w,
            battery: file.battery,
            limits: file.limits,
            surfaces: file.surfaces,
            default_surface: file.default_surface,
            uncertainty: file.uncertainty,
            source: file.source,
            provenance: file.provenance,
            posterior: file.posterior,
            model_error: file.model_error,
            noise: file.noise,
            mechanisms: file.mechanisms,
        };
        robot.validate()?;
        Ok(robot)
    }
}

fn reference_temperature_c() -> f64 {
    20.0
}
fn resistance_per_k() -> f64 {
    0.0039
}
fn motor_constant_per_k() -> f64 {
    -0.0012
}
fn regeneration() -> f64 {
    1.0
}
fn slip_angle_scale_rad() -> f64 {
    0.30
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
