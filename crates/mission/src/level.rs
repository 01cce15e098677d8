//! How far a charge carries on level ground.

use model::Grade;
use planner::{Lattice, Patience, Step as PlannedStep, Surcharge, body_motion};
use rayon::prelude::*;

use crate::{
    Error,
    chance::{Chance, Doubt, Drawn},
    journey::{Journey, Part, Step},
    likely::{LEAST_DRAWS, Spread},
    meter::Meter,
    run::{Conditions, Traveller},
};

/// Distance straight on over level ground of the robot's default surface until the reserve is reached, over draws; `None` where
/// that draws nothing, so that no charge ends it.
///
/// # Errors
/// Patience that ends first.
pub(crate) fn level_m(
    lattice: &Lattice,
    drawn: &Drawn<'_>,
    conditions: &Conditions,
    samples: usize,
    patience: &Patience,
) -> Result<Option<Spread>, Error> {
    let level = LevelDrive::new(lattice)?;
    let doubt = Doubt { elevation_sigma_m: 0.0, ..*drawn.doubt };
    let drawn = Drawn { doubt: &doubt, ..*drawn };
    let one = |number: usize| {
        let mut meter = Meter::new(patience, "driving on level ground");
        level.length_m(&drawn.chance(0.0, number as u64), conditions, &mut meter)
    };
    let lengths: Result<Vec<f64>, Error> =
        (0..samples).into_par_iter().with_min_len(LEAST_DRAWS).map(one).collect();
    let found = Spread::of(lengths?);
    Ok(found.p95.is_finite().then_some(found))
}

/// A steady drive, prepared once for all draws.
struct LevelDrive {
    journey: Journey,
    speed_mps: f64,
}

/// Share of the usable charge that one step may take: voltage and power are held within it.
const CHARGE_SHARE: f64 = 1.0 / 256.0;
/// Share of the time since setting out that a step may take, while motors warm.
const TIME_SHARE: f64 = 0.1;
/// Shortest time that a step is cut to for the motors' sake: short beside the time constant of a winding, 46 s [s].
const LEAST_STEP_S: f64 = 10.0;
/// Most steps. Steps that grow by a tenth come to 10³⁰ s in 700; what charge is left then is used up in one.
const MOST_STEPS: usize = 1024;

impl LevelDrive {
    fn new(lattice: &Lattice) -> Result<Self, Error> {
        let (robot, settings) = (&lattice.robot, &lattice.settings);
        let motion = body_motion(robot, settings.speed_mps, None, 0.0, false);
        let step = PlannedStep {
            end_m: [0.0; 2],
            heading_rad: 0.0,
            length_m: 0.0,
            rise_m: 0.0,
            duration_s: 0.0,
            motion,
            grade: Grade::LEVEL,
            stance_grade: 0.0,
            surface: 0,
            bus_w: 0.0,
            surcharge: Surcharge::default(),
        };
        let mut journey = Journey::new(settings.power_model);
        journey.drive(robot, &[step], std::slice::from_ref(&robot.default_surface))?;
        Ok(LevelDrive { journey, speed_mps: motion.speed_mps })
    }

    /// Way until the charge is down to the reserve [m]; infinite where it does not fall.
    ///
    /// Power is steady but for motors that warm and a voltage that falls, so that steps are as long as these allow.
    fn length_m(
        &self,
        chance: &Chance,
        conditions: &Conditions,
        meter: &mut Meter<'_>,
    ) -> Result<f64, Error> {
        let Some(Part::Step(kind)) = self.journey.parts.first() else { return Ok(0.0) };
        let mut traveller = Traveller::new(&self.journey, chance, conditions);
        let usable = chance.charge - conditions.reserve;
        let mut driven_s = 0.0;
        for number in 1..=MOST_STEPS {
            meter.spend(1)?;
            let left = traveller.charge - conditions.reserve;
            if left <= 0.0 {
                break;
            }
            let Some(charge_per_s) = traveller.charge_per_s(kind).filter(|rate| !rate.is_nan()) else {
                break;
            };
            if charge_per_s >= 0.0 {
                return Ok(f64::INFINITY);
            }
            let to_reserve_s = left / -charge_per_s;
            let held_s = (CHARGE_SHARE * usable / -charge_per_s).min(LEAST_STEP_S.max(TIME_SHARE * driven_s));
            if to_reserve_s <= held_s || number == MOST_STEPS {
                driven_s += to_reserve_s;
                break;
            }
            traveller.step(&Step { duration_s: held_s, ..*kind });
            driven_s += held_s;
        }
        Ok(driven_s * self.speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::Pack;
    use model::{Robot, builtin};
    use planner::{Planner, Settings};
    use terrain::{Grid, Terrain};

    fn length_m(robot: &Robot, speed_mps: f64) -> f64 {
        let grid = Grid { rows: 5, columns: 5, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let terrain = Terrain::new(grid, &[0.0; 25]).unwrap();
        let settings = Settings { speed_mps, ..Settings::of(robot) };
        let planner = Planner::new(&terrain, robot, settings).unwrap();
        let battery = robot.battery.as_ref().unwrap();
        let conditions = Conditions { ambient_c: 20.0, motor_c: 20.0, reserve: battery.reserve_fraction };
        let chance = Chance::nominal(robot, Pack::new(battery, 1.0), 1.0);
        let patience = Patience::for_looks(1);
        let level = LevelDrive::new(planner.lattice()).unwrap();
        level.length_m(&chance, &conditions, &mut Meter::new(&patience, "testing")).unwrap()
    }

    /// A Husky of constant temperature, voltage and capacity: energy is charge.
    fn ideal() -> Robot {
        let mut robot = builtin::husky_a200();
        let battery = robot.battery.as_mut().unwrap();
        battery.peukert_exponent = 1.0;
        battery.internal_resistance_ohm = Some(0.0);
        (battery.full_voltage_v, battery.empty_voltage_v) = (Some(24.0), Some(24.0));
        (robot.motors.resistance_per_k, robot.motors.motor_constant_per_k) = (0.0, 0.0);
        robot
    }

    #[test]
    fn the_way_is_the_usable_energy_over_that_of_a_metre_in_few_steps() {
        // Rolling force of a side: μ m g / 2; power of both by eq. 2.
        for (mu_roll, capacity_wh, speed_mps) in
            [(0.063, 480.0, 0.5), (0.063, 1e6, 0.5), (1e-6, 480.0, 0.5), (1e-12, 1e6, 0.01)]
        {
            let mut robot = ideal();
            for surface in robot.surfaces.values_mut() {
                surface.mu_roll = mu_roll;
            }
            robot.battery.as_mut().unwrap().capacity_wh = capacity_wh;
            let side_n = mu_roll * 90.0 * 9.80665 / 2.0;
            let power_w = (0.0023 + 0.0016) * side_n * side_n + (1.7158 + 1.7723) * side_n * speed_mps;
            let expected_m = 0.8 * capacity_wh * 3600.0 / power_w * speed_mps;
            let found_m = length_m(&robot, speed_mps);
            assert!((found_m / expected_m - 1.0).abs() < 1e-6, "{found_m} for {expected_m}");
        }
    }

    #[test]
    fn what_draws_nothing_carries_without_end() {
        let mut robot = ideal();
        for surface in robot.surfaces.values_mut() {
            surface.mu_roll = 0.0;
        }
        (robot.hotel_power_w, robot.drive_electronics_w) = (0.0, 0.0);
        assert_eq!(length_m(&robot, 0.5), f64::INFINITY);
        robot.hotel_power_w = 1e-300;
        assert!(length_m(&robot, 0.5) > 1e300);
    }
}
