//! Robots from what their data sheets tell.

use model::data_sheet::{BatterySheet, DataSheet, Drive, GroundSheet, MotorSheet};
use pyo3::prelude::*;
use serde::Deserialize;
use service::{Problem, ProblemType};

use crate::{
    problem::{exception, invalid_request},
    robot::Robot,
};

/// What a data sheet tells, by the names of `joulepath robot new`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sheet {
    name: String,
    mass_kg: f64,
    #[serde(default)]
    weighed: bool,
    wheelbase_m: f64,
    track_m: f64,
    slip_track_m: Option<f64>,
    wheel_radius_m: f64,
    ground_clearance_m: Option<f64>,
    max_speed_mps: f64,
    max_pitch_rad: Option<f64>,
    #[serde(default = "one")]
    motors_per_side: u32,
    rated_power_w: Option<f64>,
    motor_torque_constant_nm_per_a: Option<f64>,
    motor_resistance_ohm: Option<f64>,
    gear_ratio: Option<f64>,
    gear_efficiency: Option<f64>,
    regeneration: Option<f64>,
    hotel_power_w: Option<f64>,
    battery_wh: Option<f64>,
    battery_v: Option<f64>,
    #[serde(default = "yes")]
    battery_is_lithium: bool,
    surfaces: Vec<String>,
}

fn one() -> u32 {
    1
}

fn yes() -> bool {
    true
}

/// A robot from a data sheet, as JSON.
#[pyfunction]
pub(crate) fn robot_of_data_sheet(py: Python<'_>, sheet: &str) -> PyResult<Robot> {
    let read: Result<Sheet, Problem> =
        document::from_json(sheet.as_bytes()).map_err(|error| invalid_request(&error));
    let described = read.and_then(|sheet| {
        let described = sheet.described()?.describe();
        described.map_err(|error| Problem::invalid_robot(&error, ""))
    });
    described.and_then(|described| Robot::of(described.robot)).map_err(|problem| exception(py, problem))
}

impl Sheet {
    fn described(self) -> Result<DataSheet, Problem> {
        let drive = Drive {
            motors_per_side: self.motors_per_side,
            sheet: self.motor()?,
            gear_efficiency: self.gear_efficiency,
        };
        let battery = match (self.battery_wh, self.battery_v) {
            (None, None) => None,
            (capacity_wh, nominal_voltage_v) => Some(BatterySheet {
                capacity_wh: capacity_wh.ok_or_else(|| lacks("battery_wh"))?,
                nominal_voltage_v: nominal_voltage_v.ok_or_else(|| lacks("battery_v"))?,
                is_lithium: self.battery_is_lithium,
            }),
        };
        Ok(DataSheet {
            name: self.name,
            mass_kg: self.mass_kg,
            is_weighed: self.weighed,
            wheelbase_m: self.wheelbase_m,
            track_m: self.track_m,
            slip_track_m: self.slip_track_m,
            wheel_radius_m: self.wheel_radius_m,
            ground_clearance_m: self.ground_clearance_m,
            max_wheel_speed_mps: self.max_speed_mps,
            max_pitch_rad: self.max_pitch_rad,
            drive,
            regeneration: self.regeneration,
            hotel_power_w: self.hotel_power_w,
            battery,
            grounds: self.surfaces.into_iter().map(GroundSheet::Known).collect(),
        })
    }

    fn motor(&self) -> Result<MotorSheet, Problem> {
        match (self.motor_torque_constant_nm_per_a, self.rated_power_w) {
            (Some(torque_constant_nm_per_a), None) => Ok(MotorSheet::Constants {
                torque_constant_nm_per_a,
                resistance_ohm: self.motor_resistance_ohm.ok_or_else(|| lacks("motor_resistance_ohm"))?,
                gear_ratio: self.gear_ratio.ok_or_else(|| lacks("gear_ratio"))?,
            }),
            (None, Some(power_w)) => Ok(MotorSheet::RatedPower { power_w }),
            (None, None) => Ok(MotorSheet::Unknown),
            (Some(_), Some(_)) => {
                let detail =
                    "rated_power_w and motor_torque_constant_nm_per_a are both given: leave out the power";
                Err(Problem::new(ProblemType::InvalidRequest, detail).at("/rated_power_w"))
            }
        }
    }
}

fn lacks(name: &str) -> Problem {
    let detail = format!("{name} is missing, which belongs to what else is given: give it too");
    Problem::new(ProblemType::InvalidRequest, detail).at(document::pointer(name))
}
