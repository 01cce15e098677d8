//! The ranges that a robot's fields must lie in.
//!
//! They are wide enough for anything from a desk toy to a mining loader and narrow enough that a
//! value in the wrong unit (millimetres, degrees, per cent) falls outside.

use super::{Battery, Robot};
use crate::{Error, knowledge, known_limits};

const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;

/// Longest name of a robot or a surface [characters]: two lines of a report.
const LONGEST_NAME: usize = 200;

/// Checks one robot, field by field.
pub(crate) fn check(robot: &Robot) -> Result<(), Error> {
    check_name("name", &robot.name)?;
    for name in robot.surfaces.keys() {
        check_name("surfaces", name)?;
    }
    check_body(robot)?;
    check_motors(robot)?;
    check_electrics(robot)?;
    check_surfaces(robot)?;
    known_limits::check(robot)?;
    knowledge::check(robot)?;
    let u = &robot.uncertainty;
    for (field, value) in [
        ("uncertainty.mu_roll", u.mu_roll),
        ("uncertainty.mu_skid", u.mu_skid),
        ("uncertainty.k1", u.k1),
        ("uncertainty.k2", u.k2),
        ("uncertainty.mass_kg", u.mass_kg),
        ("uncertainty.hotel_power_w", u.hotel_power_w),
    ] {
        within(field, value, 0.0, 1.0, "give a relative sigma, 0.1 for 10 %")?;
    }
    Ok(())
}

fn check_name(field: &str, name: &str) -> Result<(), Error> {
    let (characters, longest) = (name.chars().count(), LONGEST_NAME);
    if (1..=longest).contains(&characters) && !name.contains(char::is_control) {
        return Ok(());
    }
    Err(Error::Name { field: field.to_owned(), characters, longest })
}

fn check_body(robot: &Robot) -> Result<(), Error> {
    let metres = "give metres";
    within("mass_kg", robot.mass_kg, 0.1, 20_000.0, "give kilograms")?;
    within("wheelbase_m", robot.wheelbase_m, 0.02, 10.0, metres)?;
    within("track_m", robot.track_m, 0.02, 10.0, metres)?;
    within(
        "slip_track_m",
        robot.slip_track_m,
        robot.track_m * 0.5,
        robot.track_m * 10.0,
        "give metres; the kinematic track is the track or somewhat wider",
    )?;
    within("wheel_radius_m", robot.wheel_radius_m, 0.005, 2.0, metres)?;
    if let Some(clearance_m) = robot.ground_clearance_m {
        within("ground_clearance_m", clearance_m, 0.0, 5.0, "give metres from the ground to the body")?;
    }
    let c = &robot.center_of_mass;
    let inside = "give metres from the geometric centre, inside the wheels";
    within(
        "center_of_mass.forward_m",
        c.forward_m,
        -robot.wheelbase_m / 2.0,
        robot.wheelbase_m / 2.0,
        inside,
    )?;
    within("center_of_mass.left_m", c.left_m, -robot.track_m / 2.0, robot.track_m / 2.0, inside)?;
    within("center_of_mass.height_m", c.height_m, 0.0, 5.0, "give metres above the ground")?;
    within("yaw_inertia_kgm2", robot.yaw_inertia_kgm2, 1e-6, 1e6, "give kg m²")?;
    within("max_wheel_speed_mps", robot.max_wheel_speed_mps, 0.01, 30.0, "give metres per second")
}

fn check_motors(robot: &Robot) -> Result<(), Error> {
    let m = &robot.motors;
    for (side, motor) in [("left", &m.left), ("right", &m.right)] {
        within(&format!("motors.{side}.k1_w_per_n2"), motor.k1_w_per_n2, 0.0, 10.0, "give watts per N²")?;
        within(
            &format!("motors.{side}.k2"),
            motor.k2,
            1.0,
            20.0,
            "it is electrical over mechanical power, so never below 1",
        )?;
        if let Some(force) = motor.force_n_per_a {
            within(
                &format!("motors.{side}.force_n_per_a"),
                force,
                1e-3,
                1e4,
                "give newtons at the rim per ampere",
            )?;
        }
        if let Some(idle_a) = motor.idle_current_a {
            within(
                &format!("motors.{side}.idle_current_a"),
                idle_a,
                0.0,
                100.0,
                "give amperes at standstill",
            )?;
        }
    }
    within("motors.reference_temperature_c", m.reference_temperature_c, -60.0, 150.0, "give °C")?;
    within("motors.resistance_per_k", m.resistance_per_k, 0.0, 0.02, "give 1/K; copper has 0.0039")?;
    within(
        "motors.motor_constant_per_k",
        m.motor_constant_per_k,
        -0.01,
        0.0,
        "give 1/K; magnets weaken, so it is not positive",
    )?;
    within("motors.regeneration", m.regeneration, 0.0, 1.0, "give a fraction")
}

fn check_electrics(robot: &Robot) -> Result<(), Error> {
    within("hotel_power_w", robot.hotel_power_w, 0.0, 1e5, "give watts")?;
    within("drive_electronics_w", robot.drive_electronics_w, 0.0, 1e4, "give watts per side")?;
    if let Some(battery) = &robot.battery {
        check_battery(battery)?;
    }
    if let Some(force) = robot.limits.max_side_force_n {
        within("limits.max_side_force_n", force, 0.1, 1e6, "give newtons")?;
    }
    within("limits.max_pitch_rad", robot.limits.max_pitch_rad, 0.001, HALF_PI, "give radians")?;
    within("limits.max_roll_rad", robot.limits.max_roll_rad, 0.001, HALF_PI, "give radians")
}

fn check_battery(b: &Battery) -> Result<(), Error> {
    let (volts, fraction) = ("give volts", "give a fraction");
    let nominal_v = b.nominal_voltage_v;
    within("battery.capacity_wh", b.capacity_wh, 1e-3, 1e6, "give watt hours")?;
    within("battery.nominal_voltage_v", nominal_v, 1.0, 1500.0, volts)?;
    within("battery.reserve_fraction", b.reserve_fraction, 0.0, 0.99, fraction)?;
    within("battery.peukert_exponent", b.peukert_exponent, 1.0, 2.0, "it is 1 to 1.6; 1 loses nothing")?;
    within("battery.rated_hours", b.rated_hours, 0.1, 200.0, "give hours")?;
    within("battery.ageing_factor", b.ageing_factor, 0.05, 1.2, "give capacity now over capacity when new")?;
    within("battery.temperature_c", b.temperature_c, -40.0, 80.0, "give °C")?;
    within("battery.capacity_per_k", b.capacity_per_k, 0.0, 0.05, "give 1/K")?;
    let of_nominal = |field: &str, value: f64, min: f64, max: f64| {
        within(
            field,
            value,
            min * nominal_v,
            max * nominal_v,
            "give volts of the whole pack, near the nominal voltage",
        )
    };
    of_nominal("battery.full_voltage_v", b.full_v(), 0.9, 1.5)?;
    of_nominal("battery.empty_voltage_v", b.empty_v(), 0.5, b.full_v() / nominal_v)?;
    of_nominal("battery.cutoff_voltage_v", b.cutoff_v(), 0.0, b.full_v() / nominal_v)?;
    within("battery.internal_resistance_ohm", b.resistance_ohm(), 0.0, 1e3, "give ohms")?;
    within(
        "battery.charge_acceptance_per_h",
        b.charge_acceptance_per_h,
        0.0,
        100.0,
        "give current over ampere hours",
    )?;
    within("battery.charge_efficiency", b.charge_efficiency, 0.0, 1.0, fraction)?;
    within("battery.capacity_sigma", b.capacity_sigma, 0.0, 1.0, "give a relative sigma, 0.05 for 5 %")?;
    within("battery.charge_sigma", b.charge_sigma, 0.0, 0.5, "give a fraction, 0.02 for 2 %")
}

fn check_surfaces(robot: &Robot) -> Result<(), Error> {
    for (name, s) in &robot.surfaces {
        let at = |field: &str| format!("surfaces.{name}.{field}");
        let ratio = "give a ratio to the normal load";
        within(&at("mu_roll"), s.mu_roll, 0.0, 2.0, ratio)?;
        within(&at("mu_skid"), s.mu_skid, 0.0, 3.0, ratio)?;
        within(&at("slip_angle_scale_rad"), s.slip_angle_scale_rad, 0.0, HALF_PI, "give radians")?;
        let Some(paper) = &s.dogru_marques else { continue };
        if let Some(inner) = paper.inner_friction {
            within(&at("dogru_marques.inner_friction"), inner, 0.0, 3.0, ratio)?;
        }
        let mut slowest_mps = 0.0;
        for (i, row) in paper.by_speed.iter().enumerate() {
            let at = |field: &str| format!("surfaces.{name}.dogru_marques.by_speed[{i}].{field}");
            within(
                &at("speed_mps"),
                row.speed_mps,
                slowest_mps,
                30.0,
                "give metres per second, slowest row first",
            )?;
            within(&at("mu_roll"), row.mu_roll, -1.0, 2.0, ratio)?;
            within(&at("mu_skid"), row.mu_skid, 0.0, 3.0, ratio)?;
            slowest_mps = row.speed_mps;
        }
    }
    robot.surface(&robot.default_surface).map(drop)
}

fn within(field: &str, value: f64, min: f64, max: f64, hint: &'static str) -> Result<(), Error> {
    if value.is_finite() && value >= min && value <= max {
        return Ok(());
    }
    Err(Error::OutOfRange { field: field.to_owned(), value, min, max, hint })
}
