//! Robots that are available by name.

use std::{collections::BTreeMap, sync::LazyLock};

use crate::{
    Error, Robot,
    robot::{Battery, CenterOfMass, Limits, Motor, Motors, PaperSurface, Surface, Uncertainty},
};

/// Robot files that the program carries; `robots/` has where their numbers come from.
const FILES: [&str; 9] = [
    include_str!("../robots/husky-a200-field.json"),
    include_str!("../robots/husky-a300.json"),
    include_str!("../robots/jackal.json"),
    include_str!("../robots/warthog.json"),
    include_str!("../robots/scout-2.json"),
    include_str!("../robots/scout-mini.json"),
    include_str!("../robots/bunker.json"),
    include_str!("../robots/leo-rover.json"),
    include_str!("../robots/rover-pro.json"),
];

static ALL: LazyLock<Vec<Robot>> = LazyLock::new(|| {
    let paper = [husky_a200(), configuration_a(), configuration_b(), configuration_c(), configuration_d()]
        .into_iter();
    paper.chain(FILES.iter().filter_map(|text| Robot::from_json(text).ok())).collect()
});

/// Every built-in robot: the Husky A200, the paper's configurations A to D (§IV, Fig. 6), and robots by their data sheets.
pub fn all() -> Vec<Robot> {
    ALL.clone()
}

/// A built-in robot by its name.
///
/// # Errors
/// [`Error::UnknownRobot`], which lists the names that exist.
pub fn by_name(name: &str) -> Result<Robot, Error> {
    ALL.iter().find(|robot| robot.name == name).cloned().ok_or_else(|| Error::UnknownRobot {
        name: name.to_owned(),
        known: ALL.iter().map(|robot| robot.name.clone()).collect(),
    })
}

/// Mass of a Husky A200 \[kg\] and its top speed, the limit of its firmware \[m/s\] (§IV): what figures that grow with a robot are of.
pub(crate) const HUSKY_KG: f64 = 90.0;
pub(crate) const HUSKY_TOP_MPS: f64 = 1.0;

/// The Clearpath Husky A200 of the paper with its centre of mass in the middle: 90 kg, base 0.54 m by 0.54 m,
/// motor constants of Table I, 1 m/s limit of its firmware (§IV).
pub fn husky_a200() -> Robot {
    Robot {
        name: "husky-a200".into(),
        mass_kg: HUSKY_KG,
        wheelbase_m: 0.54,
        track_m: 0.54,
        slip_track_m: 0.54,
        wheel_radius_m: 0.165,
        ground_clearance_m: None,
        center_of_mass: CenterOfMass::default(),
        yaw_inertia_kgm2: 5.0,
        max_wheel_speed_mps: HUSKY_TOP_MPS,
        motors: Motors {
            left: Motor { k1_w_per_n2: 0.0023, k2: 1.7158, force_n_per_a: None, idle_current_a: None },
            right: Motor { k1_w_per_n2: 0.0016, k2: 1.7723, force_n_per_a: None, idle_current_a: None },
            reference_temperature_c: 20.0,
            resistance_per_k: 0.0039,
            motor_constant_per_k: -0.0012,
            regeneration: 1.0,
        },
        hotel_power_w: 0.0,
        drive_electronics_w: 0.0,
        battery: Some(Battery::lead_acid(480.0, 24.0, 0.2)),
        limits: Limits { max_side_force_n: Some(600.0), max_pitch_rad: 0.52, max_roll_rad: 0.45 },
        surfaces: BTreeMap::from([("marble".into(), marble()), ("sandy_loam".into(), sandy_loam())]),
        default_surface: "marble".into(),
        uncertainty: Uncertainty::default(),
        source: None,
        provenance: Default::default(),
        posterior: None,
        model_error: None,
        noise: None,
        mechanisms: Vec::new(),
    }
}

/// Polished marble: the one constant set that reproduces the side forces of Table II
/// (`cargo run -p joulepath-model --example paper_tables`). Inner friction: Table II, M1, R ≤ R_c.
fn marble() -> Surface {
    Surface {
        mu_roll: 0.063,
        mu_skid: 0.29,
        slip_angle_scale_rad: 0.30,
        dogru_marques: Some(PaperSurface { inner_friction: Some(0.1742), by_speed: Vec::new() }),
        mechanisms: Vec::new(),
    }
}

/// Sandy loam, as fitted to the motor currents of a Husky A200 on eight drives (BorealTC, LaRocque et al., IROS 2024):
/// `cargo run --release -p joulepath-calibration --example husky_table`. 95 % intervals: μ_R 0.129 to 0.184, with the no-load
/// current of the motors in it; μ_S 0.302 to 0.524; the scale, which these drives do not determine, 0.03 to 0.27 rad.
fn sandy_loam() -> Surface {
    Surface {
        mu_roll: 0.157,
        mu_skid: 0.413,
        slip_angle_scale_rad: 0.138,
        dogru_marques: None,
        mechanisms: Vec::new(),
    }
}

/// Configuration A: no extra weight; the batteries hold the centre of mass 3 cm behind the middle.
pub fn configuration_a() -> Robot {
    configuration("husky-a200-a", 90.0, -0.03, 0.0)
}

/// Configuration B: 14 kg on the front bring the centre of mass to the middle.
pub fn configuration_b() -> Robot {
    configuration("husky-a200-b", 104.0, 0.0, 0.0)
}

/// Configuration C: 28 kg on the back shift the centre of mass back to 11 cm behind the middle.
pub fn configuration_c() -> Robot {
    configuration("husky-a200-c", 118.0, -0.11, 0.0)
}

/// Configuration D: 28 kg on the outer side shift the centre of mass 8 cm that way; the batteries' 3 cm of the
/// bare robot remain as 3 · 90/118 = 2.3 cm. The paper's outer side is M2, the right one.
pub fn configuration_d() -> Robot {
    configuration("husky-a200-d", 118.0, -0.03 * 90.0 / 118.0, -0.08)
}

fn configuration(name: &str, mass_kg: f64, forward_m: f64, left_m: f64) -> Robot {
    let bare = husky_a200();
    Robot {
        name: name.into(),
        mass_kg,
        center_of_mass: CenterOfMass { forward_m, left_m, height_m: 0.0 },
        yaw_inertia_kgm2: bare.yaw_inertia_kgm2 * mass_kg / bare.mass_kg,
        ..bare
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worth::Moment;

    #[test]
    fn every_built_in_robot_is_valid_and_found_by_its_name() {
        for robot in all() {
            robot.validate().unwrap();
            assert_eq!(by_name(&robot.name).unwrap(), robot);
        }
        assert!(by_name("r2d2").unwrap_err().to_string().contains("husky-a200"));
    }

    #[test]
    fn every_file_is_read_and_says_where_its_numbers_come_from() {
        for text in FILES {
            let robot = Robot::from_json(text).unwrap();
            assert!(robot.source.as_ref().unwrap().len() > 100, "{}", robot.name);
            for field in ["mass_kg", "motors.left.k1_w_per_n2", "motors.right.k2", "hotel_power_w"] {
                assert!(robot.provenance_of(field).is_some(), "{}: {field}", robot.name);
            }
            for name in robot.surfaces.keys() {
                let field = format!("surfaces.{name}.mu_roll");
                assert!(robot.provenance_of(&field).is_some(), "{}: {field}", robot.name);
            }
        }
        assert_eq!(all().len(), 5 + FILES.len());
    }

    #[test]
    fn every_robot_draws_power_to_drive_and_more_to_climb() {
        for robot in all() {
            let [level, climb, descent, arc, spin] =
                Moment::ALL.map(|moment| moment.power_w(&robot).unwrap());
            let name = &robot.name;
            assert!(0.0 < level && level < climb && descent < level && arc > 0.0 && spin > 0.0, "{name}");
        }
    }

    #[test]
    fn a_borrowed_constant_is_never_stated_as_well_known() {
        for robot in FILES.map(|text| Robot::from_json(text).unwrap()) {
            for parameter in robot.uncertain() {
                let is_borrowed = robot.borrowed().contains(&parameter.name);
                assert!(!is_borrowed || parameter.sigma >= 0.07, "{}: {}", robot.name, parameter.name);
            }
        }
    }

    /// The manual of the Husky A300 tells how long two batteries last, on average and on standby: on average a third of the time is
    /// driven, at 2 m/s with 50 kg on level ground.
    #[test]
    fn a_husky_a300_draws_what_its_manual_says_within_its_interval() {
        let mut robot = by_name("husky-a300").unwrap();
        let (battery_wh, standby_w) = (1024.0, 1024.0 / 12.0);
        let driving_w = (battery_wh / 4.0 - 0.67 * standby_w) / 0.33;
        robot.mass_kg += 50.0;
        robot.max_wheel_speed_mps *= 2.0;
        let [low_w, high_w] = Moment::Level.worth(&robot).unwrap().interval_w;
        assert!(low_w < driving_w && driving_w < high_w, "{low_w} to {high_w} for {driving_w} W");
    }

    #[test]
    fn the_husky_in_the_field_is_the_husky_but_for_ground_electronics_and_drivers() {
        let (paper, field) = (husky_a200(), by_name("husky-a200-field").unwrap());
        assert_eq!((field.mass_kg, field.motors.left), (paper.mass_kg, paper.motors.left));
        assert_eq!((field.surfaces, field.default_surface.as_str()), (paper.surfaces, "sandy_loam"));
        assert_eq!((field.hotel_power_w, field.motors.regeneration), (60.0, 0.5));
    }
}
