//! k1 and k2 of eq. 2 from what data sheets tell of motors and gears.
//!
//! A side has n motors that share its force F evenly, wheels of radius r, and gears of ratio G and efficiency η between them. With
//! the torque at a wheel per ampere of its motor, K = η G K_t, eqs. 1 and 2 of Dogru & Marques (2018) read
//!
//! ```text
//! I = F r / (n K)                       current of one motor
//! P = n (R I² + K_e ω_m I)              winding and induced voltage, ω_m = G u / r, K_e = K_t
//!   = R r² / (n K²) · F²  +  1/η · u F
//! k1 = R r² / (n K²),   k2 = 1 / (η η_o)
//! ```
//!
//! where η_o is what drivers, brushes, iron and belts let through.

use super::{Constant, Drive, MotorSheet};
use crate::{Error, builtin, knowledge::Provenance, robot::Motor};

/// η_o: share that drivers, brushes, iron and belts together let through [-]; an assumption. Gears of 0.65 and this give the k2
/// of a Husky A200.
const OTHER_EFFICIENCY: f64 = 0.88;
/// Relative one-sigma uncertainty of η_o times an η from a data sheet, which is that of the rated load [-].
const EFFICIENCY_SIGMA: f64 = 0.12;
/// Relative one-sigma uncertainty of a k2 that is a Husky's [-]: 95 % are 1.30 to 2.34, gears of 0.87 to 0.49.
const BORROWED_K2_SIGMA: f64 = 0.15;
/// Relative one-sigma uncertainty of a torque constant: makers of small motors state ±10 % [-].
const TORQUE_CONSTANT_SIGMA: f64 = 0.05;
/// Relative one-sigma uncertainty of the resistance of winding, driver, plugs and cables, of which a data sheet has the first [-].
const RESISTANCE_SIGMA: f64 = 0.25;
/// Heat of the winding over shaft power at the rated point [-]; an assumption: motors of 50 to 500 W turn some 75 % into shaft
/// power, and most of what is left is copper's.
const COPPER_SHARE: f64 = 0.25;
/// Relative one-sigma uncertainty of a k1 from it [-]: 95 % lie within a factor of 4.
const COPPER_SHARE_SIGMA: f64 = 0.70;
/// Rated power of a side over mass and top speed where nothing is known of the motors [W s/(kg m)]; an assumption: between 1.4, of
/// which [`COPPER_SHARE`] makes the k1 of a Husky A200, and 7.4 of a Jackal of 17 kg and 2 m/s, whose two motors have 500 W.
const SPECIFIC_POWER: f64 = 3.2;
/// Relative one-sigma uncertainty of a k1 from it, which puts both of them one sigma off [-].
const SPECIFIC_POWER_SIGMA: f64 = 0.80;

/// U I / (ω_0 T) at most, of a bare motor and of one with its gears [-]. Without losses it is 1, since torque per ampere and volts per radian a
/// second are one constant; what is lost by friction of brushes halves it at most, and worm gears let a quarter through.
const MOST_BARE: f64 = 2.0;
const MOST_GEARED: f64 = 2.0 / 0.25;
/// Top speed over that without load at most [-]: batteries stand up to a fifth above their nominal voltage, and wheels carry tyres of other sizes.
const MOST_OVER_FREE_SPEED: f64 = 1.5;

/// Motor constants of a side with their uncertainty and reasons.
pub(super) struct DriveConstants {
    pub(super) motor: Motor,
    pub(super) k1: Constant,
    pub(super) k2: Constant,
}

/// What a robot's motors carry.
#[derive(Clone, Copy)]
pub(super) struct Load {
    pub(super) mass_kg: f64,
    pub(super) wheel_radius_m: f64,
    pub(super) max_wheel_speed_mps: f64,
}

/// Motor constants of a side.
///
/// # Errors
/// The first figure that cannot be right, by its name.
pub(super) fn constants(drive: &Drive, load: Load) -> Result<DriveConstants, Error> {
    check(drive)?;
    check_speed(drive, load)?;
    let k2 = k2(drive)?;
    let (k1, torque_nm_per_a) = match drive.sheet {
        MotorSheet::Constants { .. } | MotorSheet::Stall { .. } => k1_of_circuit(drive, load),
        MotorSheet::RatedPower { power_w } => (k1_of_rated_power(drive, load, power_w), None),
        MotorSheet::Unknown => (k1_of_size(load), None),
    };
    let force_n_per_a = torque_nm_per_a.map(|torque| torque / load.wheel_radius_m);
    let motor = Motor { k1_w_per_n2: k1.value, k2: k2.value, force_n_per_a, idle_current_a: None };
    Ok(DriveConstants { motor, k1, k2 })
}

/// k2 of a Husky A200, the mean of its sides [-].
fn husky_k2() -> f64 {
    let husky = builtin::husky_a200().motors;
    (husky.left.k2 + husky.right.k2) / 2.0
}

/// η, and its relative one-sigma uncertainty [-].
fn gear_efficiency(drive: &Drive) -> (f64, f64) {
    let borrowed = (1.0 / (husky_k2() * OTHER_EFFICIENCY), BORROWED_K2_SIGMA);
    drive.gear_efficiency.map_or(borrowed, |eta| (eta, EFFICIENCY_SIGMA))
}

/// What of a shaft's torque reaches the wheel: of a geared motor the gears' losses are in its stall torque already [-].
fn through_gears(drive: &Drive, gear_ratio: f64) -> f64 {
    if gear_ratio == 1.0 { 1.0 } else { gear_efficiency(drive).0 }
}

fn k2(drive: &Drive) -> Result<Constant, Error> {
    let sheet = |value, because| constant("k2", value, "", EFFICIENCY_SIGMA, Provenance::DataSheet, because);
    if let MotorSheet::Stall {
        torque_nm,
        current_a,
        voltage_v,
        gear_ratio,
        no_load_speed_radps: Some(speed_radps),
    } = drive.sheet
    {
        let ratio = voltage_v * current_a / (speed_radps * torque_nm);
        let most = if gear_ratio == 1.0 { MOST_GEARED } else { MOST_BARE };
        super::check(
            "no_load_speed",
            ratio,
            1.0,
            most,
            "U I / (ω_0 T) of stall and free speed is 1 of a motor without losses: below 1 it would give more than it takes, and far above not even a motor's own torque would come out; give both at the same shaft, in N m and revolutions per minute",
        )?;
        let because = format!(
            "U I / (ω_0 T η_o) of torque and current at stall and speed without load, η_o = {OTHER_EFFICIENCY} assumed of driver, brushes, iron and belts"
        );
        return Ok(sheet(ratio / through_gears(drive, gear_ratio) / OTHER_EFFICIENCY, because));
    }
    Ok(match drive.gear_efficiency {
        Some(eta) => sheet(
            1.0 / (eta * OTHER_EFFICIENCY),
            format!(
                "1 / (η η_o), η = {eta} of the gears, η_o = {OTHER_EFFICIENCY} assumed of driver, brushes, iron and belts"
            ),
        ),
        None => constant(
            "k2",
            husky_k2(),
            "",
            BORROWED_K2_SIGMA,
            Provenance::Borrowed,
            "a Husky A200's (Dogru & Marques 2018, Table I): no efficiency is given".into(),
        ),
    })
}

/// k1 and K from the winding and what of its torque reaches the wheel; for sheets that tell neither, nothing.
fn k1_of_circuit(drive: &Drive, load: Load) -> (Constant, Option<f64>) {
    let (n, r_m) = (f64::from(drive.motors_per_side), load.wheel_radius_m);
    let (eta, eta_sigma) = gear_efficiency(drive);
    let (resistance_ohm, torque, gear_sigma, because) = match drive.sheet {
        MotorSheet::Constants { torque_constant_nm_per_a, resistance_ohm, gear_ratio } => {
            let because = format!(
                "R r² / (n (η G K_t)²), R = {resistance_ohm} Ω, r = {r_m} m, n = {n}, η = {eta:.3}, G = {gear_ratio}, K_t = {torque_constant_nm_per_a} N m/A"
            );
            (resistance_ohm, eta * gear_ratio * torque_constant_nm_per_a, eta_sigma, because)
        }
        MotorSheet::Stall { torque_nm, current_a, voltage_v, gear_ratio, .. } => {
            let (ohm, torque) = (
                voltage_v / current_a,
                through_gears(drive, gear_ratio) * gear_ratio * torque_nm / current_a,
            );
            let because = format!(
                "R r² / (n K²), R = U / I = {ohm:.3} Ω and K = T / I = {torque:.3} N m/A at the wheel of a stalled motor, r = {r_m} m, n = {n}"
            );
            (ohm, torque, if gear_ratio == 1.0 { 0.0 } else { eta_sigma }, because)
        }
        MotorSheet::RatedPower { .. } | MotorSheet::Unknown => return (k1_of_size(load), None),
    };
    let k1 = resistance_ohm * r_m.powi(2) / (n * torque.powi(2));
    let sigma =
        (4.0 * (TORQUE_CONSTANT_SIGMA.powi(2) + gear_sigma.powi(2)) + RESISTANCE_SIGMA.powi(2)).sqrt();
    (constant("k1", k1, K1_UNIT, sigma, Provenance::DataSheet, because), Some(torque))
}

/// k1 of motors that heat by [`COPPER_SHARE`] of their rated power at top speed.
fn k1_of_rated_power(drive: &Drive, load: Load, power_w: f64) -> Constant {
    let (n, top_mps) = (f64::from(drive.motors_per_side), load.max_wheel_speed_mps);
    let because = format!(
        "c u² / (n P), P = {power_w} W at top speed u = {top_mps} m/s, n = {n}, of which c = {COPPER_SHARE} heats the winding (assumed)"
    );
    let k1 = COPPER_SHARE * top_mps.powi(2) / (n * power_w);
    constant("k1", k1, K1_UNIT, COPPER_SHARE_SIGMA, Provenance::Borrowed, because)
}

/// k1 of motors of [`SPECIFIC_POWER`].
fn k1_of_size(load: Load) -> Constant {
    let top_mps = load.max_wheel_speed_mps;
    let power_w = SPECIFIC_POWER * load.mass_kg * top_mps;
    let because = format!(
        "c u² / P, a side's P = {power_w:.0} W at top speed u = {top_mps} m/s taken from mass and speed, of which c = {COPPER_SHARE} heats the winding (assumed): give the motors' data sheet"
    );
    let k1 = COPPER_SHARE * top_mps.powi(2) / power_w;
    constant("k1", k1, K1_UNIT, SPECIFIC_POWER_SIGMA, Provenance::Borrowed, because)
}

const K1_UNIT: &str = "W/N²";

fn constant(
    name: &'static str,
    value: f64,
    unit: &'static str,
    sigma: f64,
    provenance: Provenance,
    because: String,
) -> Constant {
    Constant { name: name.into(), value, unit, sigma: Some(sigma), provenance, because }
}

/// Refuses a top speed that the motors' free speed does not let the wheels have.
fn check_speed(drive: &Drive, load: Load) -> Result<(), Error> {
    let MotorSheet::Stall { gear_ratio, no_load_speed_radps: Some(speed_radps), .. } = drive.sheet else {
        return Ok(());
    };
    let free_mps = speed_radps / gear_ratio * load.wheel_radius_m;
    super::check(
        "max_speed",
        load.max_wheel_speed_mps,
        0.0,
        MOST_OVER_FREE_SPEED * free_mps,
        "the motors without load turn the wheels no faster: give the free speed of the shaft that the gear ratio begins at, or the robot's true top speed",
    )
}

fn check(drive: &Drive) -> Result<(), Error> {
    super::check(
        "motors_per_side",
        f64::from(drive.motors_per_side),
        1.0,
        20.0,
        "give how many motors drive a side",
    )?;
    if let Some(eta) = drive.gear_efficiency {
        super::check("gear_efficiency", eta, 0.05, 1.0, "give a fraction, 0.75 for 75 %")?;
    }
    let gears = "give turns of the motor per turn of the wheel";
    match drive.sheet {
        MotorSheet::Constants { torque_constant_nm_per_a, resistance_ohm, gear_ratio } => {
            super::check(
                "torque_constant",
                torque_constant_nm_per_a,
                1e-5,
                100.0,
                "give N m/A; mN m/A are a thousandth",
            )?;
            super::check("resistance", resistance_ohm, 1e-4, 1e3, "give ohms")?;
            super::check("gear_ratio", gear_ratio, 0.1, 2e3, gears)
        }
        MotorSheet::Stall { torque_nm, current_a, voltage_v, gear_ratio, no_load_speed_radps } => {
            super::check("stall_torque", torque_nm, 1e-4, 1e5, "give N m")?;
            super::check("stall_current", current_a, 1e-2, 1e4, "give amperes")?;
            super::check("motor_voltage", voltage_v, 1.0, 1500.0, "give volts")?;
            super::check("gear_ratio", gear_ratio, 0.1, 2e3, gears)?;
            no_load_speed_radps.map_or(Ok(()), |speed| {
                super::check("no_load_speed", speed, 1e-2, 1e5, "give the speed without load")
            })
        }
        MotorSheet::RatedPower { power_w } => {
            super::check("rated_power", power_w, 0.1, 1e6, "give watts of one motor")
        }
        MotorSheet::Unknown => Ok(()),
    }
}
