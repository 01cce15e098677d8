//! A robot as its file has it, before it is checked.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Battery, CenterOfMass, Limits, Motors, Robot, Surface, Uncertainty};
use crate::{
    Error,
    knowledge::{ModelError, Posterior, PowerNoise, Sources},
    known::KnownMechanism,
};

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
