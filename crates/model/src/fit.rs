//! The paper's own fits: motor constants from a lifting test, friction coefficients from measured friction,
//! temperature coefficients from a heating run.

use crate::{
    Error, Robot,
    inversion::{SideOnSlope, SlopeSign},
    least_squares,
    motor::WarmMotor,
    paper::turning_friction_columns,
    robot::{Motor, Motors},
    rolling,
};

/// One steady lift of a known weight by one wheel (§V-A, Fig. 7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftSample {
    /// Pull of the weight at the rim [N].
    pub force_n: f64,
    /// Rim speed [m/s].
    pub rim_speed_mps: f64,
    /// Power at the motor driver [W].
    pub power_w: f64,
}

/// k1 and k2 of eq. 2 from lifts at several speeds, by least squares (Table I).
///
/// With a single weight the spread of speeds separates the two: k1 F² is the intercept, k2 F the slope.
///
/// # Errors
/// [`Error::Undetermined`] when all lifts ran at one speed, or fewer than two were made.
pub fn motor_from_lifts(samples: &[LiftSample]) -> Result<WarmMotor, Error> {
    let rows: Vec<_> =
        samples.iter().map(|s| ([s.force_n * s.force_n, s.rim_speed_mps * s.force_n], s.power_w)).collect();
    let [k1_w_per_n2, k2] = least_squares::linear(&rows).ok_or(Error::Undetermined {
        count: samples.len(),
        parameters: "k1 and k2",
        hint: "lift the weight at two or more different speeds",
    })?;
    Ok(WarmMotor { k1_w_per_n2, k2 })
}

/// Friction of the outer side as measured at one turning radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionSample {
    /// R0: distance from the geometric centre to the instantaneous centre [m].
    pub radius_m: f64,
    /// δy: offset of the centre of mass towards the outer wheels [m].
    pub outward_m: f64,
    /// Force of the outer side over m g cos γ, from eq. 6 [-].
    pub friction: f64,
}

/// (μ_R, μ_S) of eq. 16 from measured friction at one speed, by least squares (§V-C, Fig. 13).
///
/// # Errors
/// [`Error::Undetermined`] when the radii are all alike.
pub fn rolling_and_skid(robot: &Robot, samples: &[FrictionSample]) -> Result<(f64, f64), Error> {
    let correction = rolling::center_of_mass_correction(robot);
    let rows: Vec<_> = samples
        .iter()
        .map(|s| {
            let (roll, skid) = turning_friction_columns(robot, s.radius_m, s.outward_m, correction);
            ([roll, skid], s.friction)
        })
        .collect();
    let [mu_roll, mu_skid] = least_squares::linear(&rows).ok_or(Error::Undetermined {
        count: samples.len(),
        parameters: "mu_R and mu_S",
        hint: "drive two or more clearly different turning radii",
    })?;
    Ok((mu_roll, mu_skid))
}

/// One instant of a heating run: steady driving on level ground while the motor warms (§V-B).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatingSample {
    /// Motor temperature [°C].
    pub temperature_c: f64,
    /// Rim speed of the side [m/s].
    pub rim_speed_mps: f64,
    /// Power at the side's driver [W].
    pub power_w: f64,
}

/// α_R and α_M with which the friction seen through eq. 6 varies least over a heating run [1/K].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureCoefficients {
    /// α_R of eq. 7 [1/K].
    pub resistance_per_k: f64,
    /// α_M of eq. 8 [1/K].
    pub motor_constant_per_k: f64,
    /// Standard deviation of the friction before, with both coefficients zero [-].
    pub spread_before: f64,
    /// Standard deviation of the friction with the coefficients found [-].
    pub spread_after: f64,
}

/// Finds α_R and α_M by the paper's criterion, the least variance of the estimated friction.
///
/// Friction may differ between rim speeds, so the variance is taken about the mean of each speed (to 0.01 m/s).
/// Copper cannot leave 0 ≤ α_R ≤ 0.01 and magnets −0.005 ≤ α_M ≤ 0, which bounds the search. A run at a
/// single speed determines only a combination of the two; the spread it reaches is still the least.
///
/// # Errors
/// [`Error::Undetermined`] when the temperature rises less than 5 K, [`Error::NoRealFriction`] when a power cannot be.
pub fn temperature_coefficients(
    motor: Motor,
    shared: &Motors,
    mass_kg: f64,
    samples: &[HeatingSample],
) -> Result<TemperatureCoefficients, Error> {
    let span = |f: fn(f64, f64) -> f64, start| samples.iter().map(|s| s.temperature_c).fold(start, f);
    let rise_k = span(f64::max, f64::NEG_INFINITY) - span(f64::min, f64::INFINITY);
    if samples.len() < 3 || rise_k < LEAST_RISE_K {
        return Err(Error::Undetermined {
            count: samples.len(),
            parameters: "alpha_R and alpha_M",
            hint: "let the motor warm by 5 K or more",
        });
    }
    let friction = |alphas: &[f64]| -> Result<Vec<f64>, Error> {
        let shared = Motors { resistance_per_k: alphas[0], motor_constant_per_k: alphas[1], ..*shared };
        samples
            .iter()
            .map(|s| friction_at(motor.at_temperature(&shared, s.temperature_c), mass_kg, s))
            .collect()
    };
    let spread = |alphas: &[f64]| friction(alphas).map(|mu| about_speed_means(samples, &mu));
    let before = spread(&[0.0, 0.0])?;
    let start = [shared.resistance_per_k, shared.motor_constant_per_k];
    let best = least_squares::nonlinear(
        |alphas| Ok::<_, Error>(spread(alphas).unwrap_or_else(|_| vec![f64::MAX.sqrt(); samples.len()])),
        &start,
        &[0.0, -0.005],
        &[0.01, 0.0],
    )?;
    let deviation = |r: &[f64]| (r.iter().map(|x| x * x).sum::<f64>() / r.len() as f64).sqrt();
    Ok(TemperatureCoefficients {
        resistance_per_k: best[0],
        motor_constant_per_k: best[1],
        spread_before: deviation(&before),
        spread_after: deviation(&spread(&best)?),
    })
}

/// Below this rise the temperature effect drowns in ordinary scatter of friction (about 0.3 % per kelvin).
pub const LEAST_RISE_K: f64 = 5.0;

fn friction_at(motor: WarmMotor, mass_kg: f64, sample: &HeatingSample) -> Result<f64, Error> {
    let side = SideOnSlope {
        motor,
        mass_kg,
        inclination_rad: 0.0,
        heading_from_contour_rad: 0.0,
        rim_speed_mps: sample.rim_speed_mps,
    };
    Ok(side.friction_from_power(sample.power_w, SlopeSign::Plus)?.friction)
}

/// Friction less the mean of all samples at the same speed.
fn about_speed_means(samples: &[HeatingSample], friction: &[f64]) -> Vec<f64> {
    let key = |s: &HeatingSample| (s.rim_speed_mps * 100.0).round() as i64;
    let mut means = std::collections::BTreeMap::<i64, (f64, f64)>::new();
    for (s, mu) in samples.iter().zip(friction) {
        let entry = means.entry(key(s)).or_default();
        *entry = (entry.0 + mu, entry.1 + 1.0);
    }
    samples
        .iter()
        .zip(friction)
        .map(|(s, mu)| means.get(&key(s)).map_or(0.0, |(sum, count)| mu - sum / count))
        .collect()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{builtin, gravity::STANDARD_GRAVITY_MPS2};

    #[test]
    fn lifting_6_9_kg_at_seven_speeds_gives_table_i_back() {
        let force_n = 6.9 * STANDARD_GRAVITY_MPS2;
        let truth = builtin::husky_a200().motors.left;
        let samples: Vec<LiftSample> = (1..=7)
            .map(|i| {
                let rim_speed_mps = 0.1 * f64::from(i);
                let power_w = truth.k1_w_per_n2 * force_n * force_n + truth.k2 * rim_speed_mps * force_n;
                LiftSample { force_n, rim_speed_mps, power_w }
            })
            .collect();
        let found = motor_from_lifts(&samples).unwrap();
        assert_relative_eq!(found.k1_w_per_n2, 0.0023, epsilon = 1e-9);
        assert_relative_eq!(found.k2, 1.7158, epsilon = 1e-9);
    }

    #[test]
    fn lifts_at_one_speed_do_not_separate_the_constants() {
        let sample = LiftSample { force_n: 67.7, rim_speed_mps: 0.3, power_w: 45.0 };
        let error = motor_from_lifts(&[sample; 4]).unwrap_err();
        assert!(error.to_string().contains("different speeds"), "{error}");
    }

    #[test]
    fn friction_made_by_eq_16_gives_its_coefficients_back_with_any_centre_of_mass() {
        for robot in builtin::all() {
            let correction = rolling::center_of_mass_correction(&robot);
            let samples: Vec<FrictionSample> = [0.3, 0.5, 1.0, 3.0, 9.0]
                .into_iter()
                .map(|radius_m| {
                    let (roll, skid) = turning_friction_columns(&robot, radius_m, 0.05, correction);
                    FrictionSample { radius_m, outward_m: 0.05, friction: 0.063 * roll + 0.29 * skid }
                })
                .collect();
            let (mu_roll, mu_skid) = rolling_and_skid(&robot, &samples).unwrap();
            assert_relative_eq!(mu_roll, 0.063, epsilon = 1e-9);
            assert_relative_eq!(mu_skid, 0.29, epsilon = 1e-9);
        }
    }

    fn heating_run(speeds_mps: &[f64]) -> Vec<HeatingSample> {
        let robot = builtin::husky_a200();
        let force_n = 0.16 * robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let mut samples = Vec::new();
        for &rim_speed_mps in speeds_mps {
            for step in 0..=14 {
                let temperature_c = 20.0 + 4.0 * f64::from(step);
                let motor = robot.motors.left.at_temperature(&robot.motors, temperature_c);
                let power_w = motor.printed_power_w(force_n, rim_speed_mps);
                samples.push(HeatingSample { temperature_c, rim_speed_mps, power_w });
            }
        }
        samples
    }

    #[test]
    fn a_heating_run_at_two_speeds_gives_both_temperature_coefficients() {
        let robot = builtin::husky_a200();
        let guess = Motors { resistance_per_k: 0.002, motor_constant_per_k: -0.0005, ..robot.motors };
        let samples = heating_run(&[0.1, 0.8]);
        let found = temperature_coefficients(robot.motors.left, &guess, robot.mass_kg, &samples).unwrap();
        assert_relative_eq!(found.resistance_per_k, 0.0039, epsilon = 1e-4);
        assert_relative_eq!(found.motor_constant_per_k, -0.0012, epsilon = 1e-4);
        assert!(found.spread_after < 0.01 * found.spread_before);
    }

    #[test]
    fn uncorrected_friction_drifts_with_heat_and_the_coefficients_remove_the_drift() {
        let robot = builtin::husky_a200();
        let samples = heating_run(&[0.27]);
        let found =
            temperature_coefficients(robot.motors.left, &robot.motors, robot.mass_kg, &samples).unwrap();
        assert!(found.spread_before > 0.005, "{}", found.spread_before);
        assert!(found.spread_after < 0.001, "{}", found.spread_after);
    }

    #[test]
    fn a_cold_run_determines_nothing() {
        let robot = builtin::husky_a200();
        let cold = &heating_run(&[0.27])[..2];
        assert!(temperature_coefficients(robot.motors.left, &robot.motors, 90.0, cold).is_err());
    }
}
