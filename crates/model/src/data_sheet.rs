//! A robot described from its data sheet: every constant of its file, with where it comes from and how well it is known.

mod ground;
mod motor;

use std::collections::BTreeMap;

pub use self::ground::{GROUNDS, Ground, GroundSheet};
use self::ground::{MU_ROLL_SIGMA, MU_SKID_SIGMA};
use crate::{
    Error, Robot,
    knowledge::{Provenance, Sources},
    robot::{Battery, CenterOfMass, Limits, Motors, Uncertainty},
};

/// What a data sheet tells of a robot. What is left out is borrowed from robots that were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSheet {
    /// What people call it.
    pub name: String,
    /// Mass [kg].
    pub mass_kg: f64,
    /// Whether it was weighed as it drives, instead of read.
    pub is_weighed: bool,
    /// Front to rear axle [m].
    pub wheelbase_m: f64,
    /// Left to right wheel centres [m].
    pub track_m: f64,
    /// Kinematic track, as of its controller [m].
    pub slip_track_m: Option<f64>,
    /// Wheel radius [m].
    pub wheel_radius_m: f64,
    /// Ground to body [m].
    pub ground_clearance_m: Option<f64>,
    /// Top speed [m/s].
    pub max_wheel_speed_mps: f64,
    /// Steepest climb [rad].
    pub max_pitch_rad: Option<f64>,
    /// Motors and gears.
    pub drive: Drive,
    /// Share of braking power that its drivers give back [-].
    pub regeneration: Option<f64>,
    /// Power of its electronics while it stands [W].
    pub hotel_power_w: Option<f64>,
    /// Its battery.
    pub battery: Option<BatterySheet>,
    /// Grounds that it drives on, the default first.
    pub grounds: Vec<GroundSheet>,
}

/// Motors and gears of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// n: motors that drive each side.
    pub motors_per_side: u32,
    /// What is known of one of them.
    pub sheet: MotorSheet,
    /// η: efficiency of its gears [-].
    pub gear_efficiency: Option<f64>,
}

/// What is known of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorSheet {
    /// Its constants.
    Constants {
        /// K_t: torque per current [N m/A].
        torque_constant_nm_per_a: f64,
        /// R: resistance of the winding [Ω].
        resistance_ohm: f64,
        /// G: turns of the motor per turn of the wheel [-].
        gear_ratio: f64,
    },
    /// What it does when it is held, and without load. With a gear ratio of 1 both are of the geared motor.
    Stall {
        /// T: torque [N m].
        torque_nm: f64,
        /// I: current [A].
        current_a: f64,
        /// U: voltage of both [V].
        voltage_v: f64,
        /// G: turns of the shaft that these are of per turn of the wheel [-].
        gear_ratio: f64,
        /// ω_0: speed of the same shaft without load [rad/s].
        no_load_speed_radps: Option<f64>,
    },
    /// Its rated power alone.
    RatedPower {
        /// P [W].
        power_w: f64,
    },
    /// Nothing.
    Unknown,
}

/// A battery by its data sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatterySheet {
    /// Capacity [Wh].
    pub capacity_wh: f64,
    /// Nominal voltage [V].
    pub nominal_voltage_v: f64,
    /// Whether its cells are lithium ones, instead of sealed lead-acid.
    pub is_lithium: bool,
}

/// A constant of a described robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// What it is: a field of the file, or `k1` and `k2` of both sides.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// Relative one-sigma uncertainty; none where the file has no place for it.
    pub sigma: Option<f64>,
    /// Where it comes from.
    pub provenance: Provenance,
    /// How, in a sentence.
    pub because: String,
}

/// A described robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The robot, checked.
    pub robot: Robot,
    /// What was derived or borrowed, and how.
    pub constants: Vec<Constant>,
}

/// Kinematic track over track where no controller tells it [-]: 1.46 fitted to a Husky A200 (BorealTC), 1.5 of the controller of a
/// Jackal and 1.875 of that of a Husky A200 (clearpath_common, `clearpath_control/config`).
const SLIP_TRACK_RATIO: f64 = 1.5;
/// Electronics over mass [W/kg]; an assumption: capacity over standby time in Clearpath's manuals gives 1.1 for a Husky A300, 1.2 for
/// an A200 and 2.0 for a Jackal, whose computers are small for none.
const HOTEL_W_PER_KG: f64 = 1.2;
/// Relative one-sigma uncertainty of a hotel power from it [-]: 95 % are 0.7 to 2.2 W/kg.
const HOTEL_SIGMA: f64 = 0.30;
/// Relative one-sigma uncertainty of a mass from a data sheet, which is that of an empty robot [-].
const MASS_SIGMA: f64 = 0.07;
/// Relative one-sigma uncertainty of a mass from a balance [-].
const WEIGHED_SIGMA: f64 = 0.02;
/// Share that drivers give back where nobody measured it [-]: bridges that brake by shorting the motor give nothing, those of four
/// quadrants nearly all.
const REGENERATION: f64 = 0.5;

impl DataSheet {
    /// The robot with every constant of its file.
    ///
    /// # Errors
    /// The first figure that cannot be right, by its name here or in the robot's file.
    pub fn describe(&self) -> Result<Description, Error> {
        let load = motor::Load {
            mass_kg: self.mass_kg,
            wheel_radius_m: self.wheel_radius_m,
            max_wheel_speed_mps: self.max_wheel_speed_mps,
        };
        check("mass", self.mass_kg, 0.1, 20_000.0, "give kilograms")?;
        check("max_speed", self.max_wheel_speed_mps, 0.01, 30.0, "give metres per second")?;
        check("wheel_radius", self.wheel_radius_m, 0.005, 2.0, "give metres")?;
        let drive = motor::constants(&self.drive, load)?;
        let rest = self.rest()?;
        let first = self.grounds.first().ok_or(Error::OutOfRange {
            field: "surface".into(),
            value: 0.0,
            min: 1.0,
            max: GROUNDS.len() as f64,
            hint: "name at least one ground",
        })?;
        let of = |name: &str| rest.iter().find(|constant| constant.name == name);
        let value = |name: &str, otherwise: f64| of(name).map_or(otherwise, |constant| constant.value);
        let robot = Robot {
            name: self.name.clone(),
            mass_kg: self.mass_kg,
            wheelbase_m: self.wheelbase_m,
            track_m: self.track_m,
            slip_track_m: value("slip_track_m", self.track_m),
            wheel_radius_m: self.wheel_radius_m,
            ground_clearance_m: self.ground_clearance_m,
            center_of_mass: CenterOfMass::default(),
            yaw_inertia_kgm2: self.mass_kg * (self.wheelbase_m.powi(2) + self.track_m.powi(2)) / 12.0,
            max_wheel_speed_mps: self.max_wheel_speed_mps,
            motors: Motors { regeneration: value("motors.regeneration", 1.0), ..Motors::alike(drive.motor) },
            hotel_power_w: value("hotel_power_w", 0.0),
            drive_electronics_w: 0.0,
            battery: self.battery.map(BatterySheet::battery),
            limits: Limits {
                max_pitch_rad: self.max_pitch_rad.unwrap_or(Limits::default().max_pitch_rad),
                ..Limits::default()
            },
            surfaces: ground::surfaces(&self.grounds)?,
            default_surface: first.name().to_owned(),
            uncertainty: self.uncertainty(&drive, of("hotel_power_w"))?,
            source: None,
            provenance: Sources::new(),
            posterior: None,
            model_error: None,
            noise: None,
            mechanisms: Vec::new(),
        };
        let mut constants = vec![drive.k1, drive.k2];
        constants.extend(rest);
        let robot =
            Robot { source: Some(source(&constants)), provenance: self.provenance(&constants), ..robot };
        robot.validate()?;
        Ok(Description { robot, constants })
    }

    /// Constants besides k1 and k2.
    fn rest(&self) -> Result<Vec<Constant>, Error> {
        let constant = |name: &str, value: f64, unit, sigma, provenance, because: &str| Constant {
            name: name.into(),
            value,
            unit,
            sigma,
            provenance,
            because: because.into(),
        };
        let mut found = vec![match self.is_weighed {
            true => {
                constant("mass_kg", self.mass_kg, "kg", Some(WEIGHED_SIGMA), Provenance::Measured, "weighed")
            }
            false => constant(
                "mass_kg",
                self.mass_kg,
                "kg",
                Some(MASS_SIGMA),
                Provenance::DataSheet,
                "given; robots weigh more than their data sheets once they carry something",
            ),
        }];
        for sheet in &self.grounds {
            let (surface, borrowed) = sheet.surface()?;
            let name = sheet.name();
            let provenance = if borrowed.is_some() { Provenance::Borrowed } else { Provenance::Measured };
            let because = borrowed.map_or("given", |ground| ground.source);
            let [roll, skid] = friction_sigmas(borrowed.is_some());
            let at = |field: &str| format!("surfaces.{name}.{field}");
            found.extend([
                constant(&at("mu_roll"), surface.mu_roll, "", Some(roll), provenance, because),
                constant(&at("mu_skid"), surface.mu_skid, "", Some(skid), provenance, because),
            ]);
        }
        found.push(match self.hotel_power_w {
            Some(power_w) => {
                constant("hotel_power_w", power_w, "W", Some(0.0), Provenance::Measured, "given")
            }
            None => constant(
                "hotel_power_w",
                HOTEL_W_PER_KG * self.mass_kg,
                "W",
                Some(HOTEL_SIGMA),
                Provenance::Borrowed,
                "1.2 W for each kilogram, as robots of Clearpath stand by with; read it off while it stands",
            ),
        });
        found.push(match self.regeneration {
            Some(share) => constant("motors.regeneration", share, "", None, Provenance::Measured, "given"),
            None => constant(
                "motors.regeneration",
                REGENERATION,
                "",
                None,
                Provenance::Borrowed,
                "between drivers that give nothing back and those that give nearly all",
            ),
        });
        found.push(match self.slip_track_m {
            Some(track_m) => constant("slip_track_m", track_m, "m", None, Provenance::DataSheet, "given"),
            None => constant(
                "slip_track_m",
                SLIP_TRACK_RATIO * self.track_m,
                "m",
                None,
                Provenance::Borrowed,
                "1.5 of the track, as of a Jackal's controller and a Husky A200's drives",
            ),
        });
        Ok(found)
    }

    /// What the file states, the largest of each kind.
    fn uncertainty(
        &self,
        drive: &motor::DriveConstants,
        hotel: Option<&Constant>,
    ) -> Result<Uncertainty, Error> {
        let mut sigmas = [0.0f64; 2];
        for sheet in &self.grounds {
            let of = friction_sigmas(sheet.surface()?.1.is_some());
            sigmas = [sigmas[0].max(of[0]), sigmas[1].max(of[1])];
        }
        let sigma = |constant: &Constant| constant.sigma.unwrap_or(0.0).min(1.0);
        Ok(Uncertainty {
            mu_roll: sigmas[0],
            mu_skid: sigmas[1],
            k1: sigma(&drive.k1),
            k2: sigma(&drive.k2),
            mass_kg: if self.is_weighed { WEIGHED_SIGMA } else { MASS_SIGMA },
            hotel_power_w: hotel.map_or(0.0, sigma),
        })
    }

    /// Where each number of the file comes from.
    fn provenance(&self, constants: &[Constant]) -> Sources {
        let mut sources = BTreeMap::new();
        for constant in constants {
            let fields = match constant.name.as_str() {
                "k1" => vec!["motors.left.k1_w_per_n2".to_owned(), "motors.right.k1_w_per_n2".to_owned()],
                "k2" => vec!["motors.left.k2".to_owned(), "motors.right.k2".to_owned()],
                name => vec![name.to_owned()],
            };
            sources.extend(fields.into_iter().map(|field| (field, constant.provenance)));
        }
        let sheet = ["wheelbase_m", "track_m", "wheel_radius_m", "max_wheel_speed_mps"];
        let battery = ["battery.capacity_wh", "battery.nominal_voltage_v"];
        let battery = battery.iter().filter(|_| self.battery.is_some());
        let clearance = ["ground_clearance_m"];
        let clearance = clearance.iter().filter(|_| self.ground_clearance_m.is_some());
        let given = sheet.iter().chain(battery).chain(clearance);
        sources.extend(given.map(|field| ((*field).to_owned(), Provenance::DataSheet)));
        sources
    }
}

impl BatterySheet {
    fn battery(self) -> Battery {
        let lead_acid = Battery::lead_acid(self.capacity_wh, self.nominal_voltage_v, 0.2);
        if self.is_lithium { lead_acid.of_lithium() } else { lead_acid }
    }
}

/// Uncertainty of μ_R and μ_S, borrowed or measured.
fn friction_sigmas(is_borrowed: bool) -> [f64; 2] {
    let measured = Uncertainty::default();
    if is_borrowed { [MU_ROLL_SIGMA, MU_SKID_SIGMA] } else { [measured.mu_roll, measured.mu_skid] }
}

/// The reasons of a file in words.
fn source(constants: &[Constant]) -> String {
    let reasons = constants.iter().map(|constant| format!("{}: {}", constant.name, constant.because));
    format!("Described from a data sheet. {}.", reasons.collect::<Vec<_>>().join(". "))
}

fn check(field: &str, value: f64, min: f64, max: f64, hint: &'static str) -> Result<(), Error> {
    let is_in = value.is_finite() && (min..=max).contains(&value);
    if is_in { Ok(()) } else { Err(Error::OutOfRange { field: field.to_owned(), value, min, max, hint }) }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn sheet(drive: Drive) -> DataSheet {
        DataSheet {
            name: "mule".into(),
            mass_kg: 17.0,
            is_weighed: false,
            wheelbase_m: 0.262,
            track_m: 0.376,
            slip_track_m: None,
            wheel_radius_m: 0.098,
            ground_clearance_m: None,
            max_wheel_speed_mps: 2.0,
            max_pitch_rad: None,
            drive,
            regeneration: None,
            hotel_power_w: None,
            battery: None,
            grounds: vec![GroundSheet::Known("grass".into())],
        }
    }

    fn left(drive: Drive) -> crate::robot::Motor {
        sheet(drive).describe().unwrap().robot.motors.left
    }

    #[test]
    fn constants_stall_and_free_speed_of_one_motor_give_the_same_k1() {
        // K_t 0.03 N m/A, 0.5 Ω at 24 V: 48 A and 1.44 N m at stall, at the shaft behind gears of 20 and 0.75 21.6 N m.
        let constants =
            MotorSheet::Constants { torque_constant_nm_per_a: 0.03, resistance_ohm: 0.5, gear_ratio: 20.0 };
        let stall = |torque_nm, gear_ratio| MotorSheet::Stall {
            torque_nm,
            current_a: 48.0,
            voltage_v: 24.0,
            gear_ratio,
            no_load_speed_radps: None,
        };
        let geared = |sheet| left(Drive { motors_per_side: 2, sheet, gear_efficiency: Some(0.75) });
        let k1 = 0.5 * 0.098f64.powi(2) / (2.0 * 0.45f64.powi(2));
        for sheet in [constants, stall(1.44, 20.0), stall(21.6, 1.0)] {
            assert_relative_eq!(geared(sheet).k1_w_per_n2, k1, max_relative = 1e-12);
            assert_relative_eq!(geared(sheet).force_n_per_a.unwrap(), 0.45 / 0.098, max_relative = 1e-12);
            assert_relative_eq!(geared(sheet).k2, 1.0 / (0.75 * 0.88), max_relative = 1e-12);
        }
    }

    #[test]
    fn a_free_speed_tells_the_losses_between_winding_and_shaft() {
        let stall = |no_load_speed_radps| MotorSheet::Stall {
            torque_nm: 21.6,
            current_a: 48.0,
            voltage_v: 24.0,
            gear_ratio: 1.0,
            no_load_speed_radps,
        };
        // Ideal: 24 V over 0.03 V s and gears of 20 are 40 rad/s; K_e / K is then 1 / 0.75.
        let motor = left(Drive { motors_per_side: 1, sheet: stall(Some(40.0)), gear_efficiency: None });
        assert_relative_eq!(motor.k2, 1.0 / (0.75 * 0.88), max_relative = 1e-12);
        let drive = Drive { motors_per_side: 1, sheet: stall(Some(400.0)), gear_efficiency: None };
        assert_eq!(
            sheet(drive).describe().unwrap_err().field(),
            Some("no_load_speed"),
            "it would make energy"
        );
    }

    #[test]
    fn free_speeds_that_contradict_the_stall_or_the_top_speed_are_refused() {
        let refused = |current_a, gear_ratio, no_load_speed_radps| {
            let stall = MotorSheet::Stall {
                torque_nm: 0.9,
                current_a,
                voltage_v: 24.0,
                gear_ratio,
                no_load_speed_radps: Some(no_load_speed_radps),
            };
            let drive = Drive { motors_per_side: 1, sheet: stall, gear_efficiency: Some(0.75) };
            sheet(drive).describe().err().and_then(|error| error.field().map(str::to_owned))
        };
        // A bare motor of 24 V and 3000 rpm: 0.076 V s, and with 48 A only 0.019 N m/A of it.
        assert_eq!(refused(48.0, 10.0, 314.0), Some("no_load_speed".to_owned()));
        assert_eq!(refused(12.0, 10.0, 314.0), None);
        // Wheels of 0.098 m that turn freely with 0.31 m/s, on a robot of 2 m/s.
        assert_eq!(refused(12.0, 100.0, 314.0), Some("max_speed".to_owned()));
    }

    #[test]
    fn power_at_the_wheels_is_that_of_the_motors_circuit() {
        // Current, voltage and shaft by hand, against the one function that computes power.
        let drive = Drive {
            motors_per_side: 2,
            sheet: MotorSheet::Constants {
                torque_constant_nm_per_a: 0.03,
                resistance_ohm: 0.5,
                gear_ratio: 20.0,
            },
            gear_efficiency: Some(0.75),
        };
        let motor = left(drive);
        let (force_n, rim_mps) = (30.0, 0.8);
        let current_a = force_n / 2.0 * 0.098 / (0.75 * 20.0 * 0.03);
        let winding_w =
            2.0 * (current_a * current_a * 0.5 + 0.03 * 20.0 * rim_mps / 0.098 * current_a / 0.88);
        let motors = Motors::alike(motor);
        let ours_w = motor.at_temperature(&motors, 20.0).printed_power_w(force_n, rim_mps);
        assert_relative_eq!(ours_w, winding_w, max_relative = 1e-12);
    }

    #[test]
    fn what_no_sheet_gives_is_borrowed_and_says_so() {
        let drive = Drive { motors_per_side: 2, sheet: MotorSheet::Unknown, gear_efficiency: None };
        let found = sheet(drive).describe().unwrap();
        for constant in ["k1", "k2", "surfaces.grass.mu_roll", "hotel_power_w", "motors.regeneration"] {
            let constant = found.constants.iter().find(|c| c.name == constant).unwrap();
            assert_eq!(constant.provenance, Provenance::Borrowed, "{constant:?}");
            assert!(found.robot.source.as_ref().unwrap().contains(&constant.because));
        }
        assert_eq!(found.robot.uncertainty.k1, 0.80);
        assert_eq!(found.robot.provenance_of("motors.left.k2"), Some(Provenance::Borrowed));
        assert_eq!(Robot::from_json(&serde_json::to_string(&found.robot).unwrap()).unwrap(), found.robot);
    }

    #[test]
    fn figures_in_the_wrong_unit_are_refused_by_name() {
        let constants = |torque_constant_nm_per_a, resistance_ohm, gear_ratio| Drive {
            motors_per_side: 1,
            sheet: MotorSheet::Constants { torque_constant_nm_per_a, resistance_ohm, gear_ratio },
            gear_efficiency: Some(0.8),
        };
        let refused = |drive| sheet(drive).describe().unwrap_err().field().unwrap().to_owned();
        assert_eq!(refused(constants(300.0, 0.5, 20.0)), "torque_constant");
        assert_eq!(refused(constants(0.03, 0.0, 20.0)), "resistance");
        assert_eq!(
            refused(Drive { gear_efficiency: Some(75.0), ..constants(0.03, 0.5, 20.0) }),
            "gear_efficiency"
        );
        let unknown = GroundSheet::Known("lava".into());
        let error =
            DataSheet { grounds: vec![unknown], ..sheet(constants(0.03, 0.5, 20.0)) }.describe().unwrap_err();
        assert!(error.to_string().contains("lava") && error.to_string().contains("sandy_loam"), "{error}");
    }
}
