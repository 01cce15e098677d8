//! `joulepath robot new`.

use std::{path::PathBuf, str::FromStr};

use clap::{Args, ValueEnum};
use model::data_sheet::{
    BatterySheet, Constant, DataSheet, Description, Drive, GROUNDS, GroundSheet, MotorSheet,
};
use serde_json::json;

use super::{ask, check};
use crate::{failure::BadInput, files, output};

/// Revolutions per minute in a radian per second.
const RPM_PER_RADPS: f64 = 60.0 / std::f64::consts::TAU;

#[derive(Args)]
#[command(infer_long_args = true)]
pub(crate) struct Arguments {
    /// What to call the robot [default: the name of the file]
    #[arg(long)]
    name: Option<String>,
    /// Where to write the robot file
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Mass with everything on board [kg]
    #[arg(long)]
    mass_kg: Option<f64>,
    /// The mass was weighed, not read from a data sheet
    #[arg(long)]
    weighed: bool,
    /// Front to rear axle [m]; of tracks, the length on the ground
    #[arg(long)]
    wheelbase_m: Option<f64>,
    /// Left to right wheel centres [m]
    #[arg(long)]
    track_m: Option<f64>,
    /// Wheel radius [m]
    #[arg(long)]
    wheel_radius_m: Option<f64>,
    /// Top speed [m/s]
    #[arg(long)]
    max_speed_mps: Option<f64>,
    /// Ground: a known one, or NAME=MU_ROLL,MU_SKID[,SLIP_ANGLE_SCALE_RAD] as measured; the first is the default
    #[arg(long, value_name = "GROUND")]
    surface: Vec<GroundArgument>,
    #[command(flatten)]
    motor: MotorArguments,
    #[command(flatten)]
    rest: RestArguments,
    /// Print the explanation as a JSON document
    #[arg(long)]
    json: bool,
}

/// What is known of the motors.
#[derive(Args)]
struct MotorArguments {
    /// Motors that drive each side
    #[arg(long, default_value_t = 1)]
    motors_per_side: u32,
    /// Torque per current of a motor [N m/A]; with its resistance and the gear ratio
    #[arg(long, conflicts_with_all = ["stall_torque_nm", "rated_power_w"])]
    torque_constant_nm_per_a: Option<f64>,
    /// Resistance of a motor's winding [Ω]
    #[arg(long, requires = "torque_constant_nm_per_a")]
    motor_resistance_ohm: Option<f64>,
    /// Turns of the motor per turn of the wheel [default: 1, figures of the geared motor]
    #[arg(long)]
    gear_ratio: Option<f64>,
    /// Efficiency of the gears, 0 to 1
    #[arg(long)]
    gear_efficiency: Option<f64>,
    /// Torque of a stalled motor [N m]; with its current
    #[arg(long, conflicts_with = "rated_power_w")]
    stall_torque_nm: Option<f64>,
    /// Current of a stalled motor [A]
    #[arg(long, requires = "stall_torque_nm")]
    stall_current_a: Option<f64>,
    /// Voltage that stall and free speed are given for [V] [default: that of the battery]
    #[arg(long)]
    motor_voltage_v: Option<f64>,
    /// Revolutions per minute of a motor without load
    #[arg(long, requires = "stall_torque_nm")]
    no_load_rpm: Option<f64>,
    /// Rated power of a motor [W], where nothing else is known
    #[arg(long)]
    rated_power_w: Option<f64>,
}

/// What a plan can do without.
#[derive(Args)]
struct RestArguments {
    /// Share of braking power that the drivers give back, 0 to 1
    #[arg(long)]
    regeneration: Option<f64>,
    /// Power of the electronics while the robot stands [W]
    #[arg(long)]
    hotel_power_w: Option<f64>,
    /// Track that the controller turns by [m] [default: 1.5 of the track]
    #[arg(long)]
    slip_track_m: Option<f64>,
    /// From the ground to the body [m]
    #[arg(long)]
    ground_clearance_m: Option<f64>,
    /// Steepest climb [rad]
    #[arg(long)]
    max_pitch_rad: Option<f64>,
    /// Capacity of the battery [Wh]
    #[arg(long, requires = "battery_v")]
    battery_wh: Option<f64>,
    /// Nominal voltage of the battery [V]
    #[arg(long)]
    battery_v: Option<f64>,
    /// Cells of the battery
    #[arg(long, value_enum, default_value = "lithium")]
    battery_cells: Cells,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Cells {
    Lithium,
    LeadAcid,
}

/// A ground by name, with its friction where it was measured.
#[derive(Clone)]
struct GroundArgument(GroundSheet);

impl FromStr for GroundArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((name, numbers)) = text.split_once('=') else {
            return Ok(GroundArgument(GroundSheet::Known(text.to_owned())));
        };
        let parsed: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
        let (mu_roll, mu_skid, slip_angle_scale_rad) = match parsed.as_deref() {
            Ok([roll, skid]) => (*roll, *skid, None),
            Ok([roll, skid, scale]) => (*roll, *skid, Some(*scale)),
            _ => return Err("give NAME, or NAME=MU_ROLL,MU_SKID as in lawn=0.09,0.4".into()),
        };
        Ok(GroundArgument(GroundSheet::Measured {
            name: name.to_owned(),
            mu_roll,
            mu_skid,
            slip_angle_scale_rad,
        }))
    }
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let sheet = arguments.sheet()?;
    let found = sheet.describe().map_err(|error| BadInput(format!("data sheet: {error}")))?;
    let path = &arguments.out;
    files::write(path, serde_json::to_string_pretty(&found.robot)? + "\n")?;
    if arguments.json {
        let constants: Vec<_> = found.constants.iter().map(constant).collect();
        return output::json(&json!({ "file": path, "robot": found.robot, "constants": constants }));
    }
    output::text(explanation(&found, arguments)?)
}

fn constant(constant: &Constant) -> serde_json::Value {
    json!({
        "name": constant.name,
        "value": constant.value,
        "unit": constant.unit,
        "sigma": constant.sigma,
        "provenance": constant.provenance,
        "because": constant.because,
    })
}

/// Every constant with its reason, and what plans will be worth.
fn explanation(found: &Description, arguments: &Arguments) -> anyhow::Result<String> {
    let mut text = format!("wrote {}\n\n", arguments.out.display());
    for c in &found.constants {
        let unit = if c.unit.is_empty() { String::new() } else { format!(" {}", c.unit) };
        let sigma = match c.sigma {
            Some(sigma) if sigma > 0.0 => format!(" ± {:.0} %", 100.0 * sigma),
            _ => String::new(),
        };
        let provenance = serde_json::to_value(c.provenance)?;
        let provenance = provenance.as_str().unwrap_or_default();
        text += &format!("{} = {:.5}{unit}{sigma} ({provenance}): {}\n", c.name, c.value, c.because);
    }
    text.push('\n');
    text += &check::summary(&found.robot, &check::worths(&found.robot)?);
    Ok(text)
}

impl Arguments {
    /// All that flags and, on a terminal, answers tell.
    fn sheet(&self) -> anyhow::Result<DataSheet> {
        let needed = [
            ("--mass-kg", "mass with everything on board [kg]", self.mass_kg),
            ("--wheelbase-m", "front to rear axle [m]", self.wheelbase_m),
            ("--track-m", "left to right wheel centres [m]", self.track_m),
            ("--wheel-radius-m", "wheel radius [m]", self.wheel_radius_m),
            ("--max-speed-mps", "top speed [m/s]", self.max_speed_mps),
        ];
        let asks = ask::is_there_somebody();
        if !asks {
            let flags = needed.iter().filter(|(_, _, value)| value.is_none()).map(|(flag, ..)| *flag);
            let surface = Some("--surface").filter(|_| self.surface.is_empty());
            let missing: Vec<&str> = flags.chain(surface).collect();
            if !missing.is_empty() {
                let detail = format!("give {} (grounds known are {})", missing.join(", "), known_grounds());
                return Err(BadInput(detail).into());
            }
        }
        let mut numbers = [0.0; 5];
        for (number, (flag, question, given)) in numbers.iter_mut().zip(needed) {
            *number = given.map_or_else(|| ask::required(flag, question), Ok)?;
        }
        let [mass_kg, wheelbase_m, track_m, wheel_radius_m, max_wheel_speed_mps] = numbers;
        let mut grounds: Vec<GroundSheet> = self.surface.iter().map(|ground| ground.0.clone()).collect();
        if grounds.is_empty() {
            let question = format!("ground ({}, or NAME=MU_ROLL,MU_SKID)", known_grounds());
            grounds.push(ask::required::<GroundArgument>("--surface", &question)?.0);
        }
        let battery = self.battery(asks)?;
        let rest = &self.rest;
        let hotel_power_w = match rest.hotel_power_w {
            None if asks => {
                ask::optional("power of the electronics while it stands [W], empty if not known")?
            }
            given => given,
        };
        Ok(DataSheet {
            name: self.name(),
            mass_kg,
            is_weighed: self.weighed,
            wheelbase_m,
            track_m,
            slip_track_m: rest.slip_track_m,
            wheel_radius_m,
            ground_clearance_m: rest.ground_clearance_m,
            max_wheel_speed_mps,
            max_pitch_rad: rest.max_pitch_rad,
            drive: self
                .motor
                .drive(battery.map(|battery| battery.nominal_voltage_v).or(rest.battery_v), asks)?,
            regeneration: rest.regeneration,
            hotel_power_w,
            battery,
            grounds,
        })
    }

    fn name(&self) -> String {
        let stem = || self.out.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        self.name.clone().or_else(stem).unwrap_or_default()
    }

    fn battery(&self, asks: bool) -> anyhow::Result<Option<BatterySheet>> {
        let rest = &self.rest;
        let capacity_wh = match rest.battery_wh {
            None if asks => ask::optional("capacity of the battery [Wh], empty for none")?,
            given => given,
        };
        let Some(capacity_wh) = capacity_wh else { return Ok(None) };
        let nominal_voltage_v = match rest.battery_v {
            Some(given) => given,
            None => ask::required("--battery-v", "nominal voltage of the battery [V]")?,
        };
        Ok(Some(BatterySheet {
            capacity_wh,
            nominal_voltage_v,
            is_lithium: rest.battery_cells == Cells::Lithium,
        }))
    }
}

impl MotorArguments {
    /// What is known of the drive; on a terminal at least the rated power is asked for.
    fn drive(&self, battery_v: Option<f64>, asks: bool) -> anyhow::Result<Drive> {
        let lacks =
            |flags: &str| BadInput(format!("the motor's data sheet is not complete: give {flags} too"));
        let gear_ratio = self.gear_ratio;
        let sheet = if let Some(torque_constant_nm_per_a) = self.torque_constant_nm_per_a {
            MotorSheet::Constants {
                torque_constant_nm_per_a,
                resistance_ohm: self.motor_resistance_ohm.ok_or_else(|| lacks("--motor-resistance-ohm"))?,
                gear_ratio: gear_ratio.ok_or_else(|| lacks("--gear-ratio"))?,
            }
        } else if let Some(torque_nm) = self.stall_torque_nm {
            let voltage_v = self.motor_voltage_v.or(battery_v);
            MotorSheet::Stall {
                torque_nm,
                current_a: self.stall_current_a.ok_or_else(|| lacks("--stall-current-a"))?,
                voltage_v: voltage_v.ok_or_else(|| lacks("--motor-voltage-v"))?,
                gear_ratio: gear_ratio.unwrap_or(1.0),
                no_load_speed_radps: self.no_load_rpm.map(|rpm| rpm / RPM_PER_RADPS),
            }
        } else {
            let rated_power_w = match self.rated_power_w {
                None if asks => ask::optional("rated power of one motor [W], empty if not known")?,
                given => given,
            };
            rated_power_w.map_or(MotorSheet::Unknown, |power_w| MotorSheet::RatedPower { power_w })
        };
        Ok(Drive { motors_per_side: self.motors_per_side, sheet, gear_efficiency: self.gear_efficiency })
    }
}

fn known_grounds() -> String {
    GROUNDS.map(|ground| ground.name).join(", ")
}
