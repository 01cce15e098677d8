//! The robot file, read here by its own definition so that nothing of the model comes along.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Error, limits::within};

/// What a robot file says of a healthy robot. Fields and units are those of the file; see there for their meaning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RobotFile {
    pub name: String,
    pub mass_kg: f64,
    pub wheelbase_m: f64,
    pub track_m: f64,
    #[serde(default)]
    pub slip_track_m: Option<f64>,
    pub wheel_radius_m: f64,
    #[serde(default)]
    pub center_of_mass: CenterOfMass,
    #[serde(default)]
    pub yaw_inertia_kgm2: Option<f64>,
    pub max_wheel_speed_mps: f64,
    pub motors: Motors,
    #[serde(default)]
    pub hotel_power_w: f64,
    #[serde(default)]
    pub drive_electronics_w: f64,
    #[serde(default)]
    pub battery: Option<BatteryFile>,
    /// What the robot must not be asked to do; a drive is not checked against it.
    #[serde(default)]
    pub limits: serde_json::Value,
    pub surfaces: BTreeMap<String, SurfaceFile>,
    pub default_surface: String,
    #[serde(default)]
    pub uncertainty: Uncertainty,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_clearance_m: Option<f64>,
    /// Where the numbers come from, and what a fit left open of them: the truth of a world is what the numbers say.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub source: serde_json::Value,
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub provenance: serde_json::Value,
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub posterior: serde_json::Value,
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub model_error: serde_json::Value,
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub noise: serde_json::Value,
}

/// Where the centre of mass lies relative to the geometric centre, x forward, y left [m].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct CenterOfMass {
    pub forward_m: f64,
    pub left_m: f64,
    pub height_m: f64,
}

/// Both sides' motors and what they share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct Motors {
    pub left: MotorFile,
    pub right: MotorFile,
    #[serde(default = "reference_temperature_c")]
    pub reference_temperature_c: f64,
    #[serde(default = "resistance_per_k")]
    pub resistance_per_k: f64,
    #[serde(default = "motor_constant_per_k")]
    pub motor_constant_per_k: f64,
    #[serde(default = "regeneration")]
    pub regeneration: f64,
}

/// One side's equivalent motor constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct MotorFile {
    pub k1_w_per_n2: f64,
    pub k2: f64,
    #[serde(default)]
    pub force_n_per_a: Option<f64>,
    #[serde(default)]
    pub idle_current_a: Option<f64>,
}

/// The battery pack. What else a file says of it is for who predicts range: this world has cells of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct BatteryFile {
    pub capacity_wh: f64,
    pub nominal_voltage_v: f64,
    #[serde(default)]
    pub reserve_fraction: Option<f64>,
}

/// Friction of one kind of ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct SurfaceFile {
    pub mu_roll: f64,
    pub mu_skid: f64,
    #[serde(default = "slip_angle_scale_rad")]
    pub slip_angle_scale_rad: f64,
    /// What only the printed form of the paper needs.
    #[serde(default)]
    pub dogru_marques: Option<serde_json::Value>,
}

/// Relative one-sigma uncertainty of the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct Uncertainty {
    pub mu_roll: f64,
    pub mu_skid: f64,
    pub k1: f64,
    pub k2: f64,
    pub mass_kg: f64,
    #[serde(skip_serializing_if = "is_zero")]
    pub hotel_power_w: f64,
}

fn is_zero(sigma: &f64) -> bool {
    *sigma == 0.0
}

impl Default for Uncertainty {
    fn default() -> Self {
        Uncertainty { mu_roll: 0.10, mu_skid: 0.10, k1: 0.05, k2: 0.02, mass_kg: 0.02, hotel_power_w: 0.0 }
    }
}

/// Mass of a Husky A200 [kg] and its top speed [m/s] (Dogru & Marques 2018, §IV): what figures that grow with a robot are of.
const HUSKY_KG: f64 = 90.0;
const HUSKY_TOP_MPS: f64 = 1.0;

impl RobotFile {
    /// Reads and checks a robot file.
    ///
    /// # Errors
    /// The place of whatever is missing, unknown or out of range.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let robot: RobotFile = document::from_json(text.as_bytes())?;
        robot.check()?;
        Ok(robot)
    }

    /// Mass over a Husky's.
    pub(crate) fn size(&self) -> f64 {
        self.mass_kg / HUSKY_KG
    }

    /// Top speed over a Husky's.
    pub(crate) fn fastness(&self) -> f64 {
        self.max_wheel_speed_mps / HUSKY_TOP_MPS
    }

    /// Effective track of the wheels' kinematics [m].
    pub(crate) fn slip_track_m(&self) -> f64 {
        self.slip_track_m.unwrap_or(self.track_m)
    }

    /// Moment of inertia about the vertical; where the file gives none, that of a box of the wheels' size [kg m²].
    pub(crate) fn yaw_inertia_kgm2(&self) -> f64 {
        let square_m2 = self.wheelbase_m.powi(2) + self.track_m.powi(2);
        self.yaw_inertia_kgm2.unwrap_or(self.mass_kg * square_m2 / 12.0)
    }

    fn check(&self) -> Result<(), Error> {
        const METRES: &str = "give metres";
        within("mass_kg", self.mass_kg, [1.0, 1e5], "give kilograms")?;
        within("wheelbase_m", self.wheelbase_m, [0.05, 10.0], METRES)?;
        within("track_m", self.track_m, [0.05, 10.0], METRES)?;
        within(
            "slip_track_m",
            self.slip_track_m(),
            [self.track_m, 10.0 * self.track_m],
            "it is never narrower than track_m",
        )?;
        within("wheel_radius_m", self.wheel_radius_m, [0.01, 2.0], METRES)?;
        let com = self.center_of_mass;
        within(
            "center_of_mass.forward_m",
            com.forward_m.abs(),
            [0.0, self.wheelbase_m / 2.0],
            "it lies between the axles",
        )?;
        within(
            "center_of_mass.left_m",
            com.left_m.abs(),
            [0.0, self.track_m / 2.0],
            "it lies between the wheels",
        )?;
        within("center_of_mass.height_m", com.height_m, [0.0, 5.0], METRES)?;
        within("yaw_inertia_kgm2", self.yaw_inertia_kgm2(), [1e-3, 1e6], "give kg m²")?;
        within("max_wheel_speed_mps", self.max_wheel_speed_mps, [0.05, 20.0], "give metres per second")?;
        self.check_power()?;
        self.check_surface("default_surface", &self.default_surface)
    }

    fn check_power(&self) -> Result<(), Error> {
        for (side, motor) in [("left", self.motors.left), ("right", self.motors.right)] {
            within(
                format!("motors.{side}.k1_w_per_n2"),
                motor.k1_w_per_n2,
                [1e-8, 10.0],
                "give watts per squared newton",
            )?;
            within(format!("motors.{side}.k2"), motor.k2, [1.0, 10.0], "electrical per mechanical power")?;
        }
        within("motors.regeneration", self.motors.regeneration, [0.0, 1.0], "give a fraction")?;
        within("hotel_power_w", self.hotel_power_w, [0.0, 1e5], "give watts")?;
        within("drive_electronics_w", self.drive_electronics_w, [0.0, 1e4], "give watts")?;
        for (name, surface) in &self.surfaces {
            within(format!("surfaces.{name}.mu_roll"), surface.mu_roll, [0.0, 1.0], "force over load")?;
            within(format!("surfaces.{name}.mu_skid"), surface.mu_skid, [0.0, 2.0], "force over load")?;
            within(
                format!("surfaces.{name}.slip_angle_scale_rad"),
                surface.slip_angle_scale_rad,
                [0.0, 2.0],
                "give radians",
            )?;
        }
        Ok(())
    }

    /// Refuses the name of a surface that the robot has no friction for.
    pub(crate) fn check_surface(&self, field: &str, name: &str) -> Result<(), Error> {
        if self.surfaces.contains_key(name) {
            return Ok(());
        }
        let known = self.surfaces.keys().cloned().collect();
        Err(Error::UnknownSurface { field: field.to_owned(), name: name.to_owned(), known })
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

/// A robot of the size of a Husky A200, for examples and tests: 90 kg, base 0.54 m by 0.54 m, motor constants and friction
/// on marble of Dogru & Marques (2018), Tables I and II.
pub fn example_robot() -> RobotFile {
    let motor = |k1_w_per_n2, k2| MotorFile { k1_w_per_n2, k2, force_n_per_a: None, idle_current_a: None };
    let ground =
        |mu_roll, mu_skid| SurfaceFile { mu_roll, mu_skid, slip_angle_scale_rad: 0.30, dogru_marques: None };
    RobotFile {
        name: "husky-like".into(),
        mass_kg: HUSKY_KG,
        wheelbase_m: 0.54,
        track_m: 0.54,
        slip_track_m: None,
        wheel_radius_m: 0.165,
        center_of_mass: CenterOfMass::default(),
        yaw_inertia_kgm2: Some(5.0),
        max_wheel_speed_mps: HUSKY_TOP_MPS,
        motors: Motors {
            left: motor(0.0023, 1.7158),
            right: motor(0.0016, 1.7723),
            reference_temperature_c: 20.0,
            resistance_per_k: 0.0039,
            motor_constant_per_k: -0.0012,
            regeneration: 1.0,
        },
        hotel_power_w: 0.0,
        drive_electronics_w: 0.0,
        battery: Some(BatteryFile {
            capacity_wh: 480.0,
            nominal_voltage_v: 24.0,
            reserve_fraction: Some(0.2),
        }),
        limits: serde_json::Value::Null,
        surfaces: BTreeMap::from([
            ("marble".into(), ground(0.063, 0.29)),
            ("sandy_loam".into(), ground(0.12, 0.30)),
        ]),
        default_surface: "marble".into(),
        uncertainty: Uncertainty::default(),
        ground_clearance_m: None,
        source: serde_json::Value::Null,
        provenance: serde_json::Value::Null,
        posterior: serde_json::Value::Null,
        model_error: serde_json::Value::Null,
        noise: serde_json::Value::Null,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_survives_a_round_trip_and_wrong_fields_are_named() {
        let mut file = serde_json::to_value(example_robot()).unwrap();
        assert_eq!(RobotFile::from_json(&file.to_string()).unwrap(), example_robot());
        file["motors"]["left"]["k2"] = 0.5.into();
        assert_eq!(RobotFile::from_json(&file.to_string()).unwrap_err().field(), Some("motors.left.k2"));
        file["motors"]["left"]["k3"] = 0.5.into();
        assert!(RobotFile::from_json(&file.to_string()).unwrap_err().to_string().contains("k3"));
    }
}
