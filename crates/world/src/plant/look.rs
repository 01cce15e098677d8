//! How the ground lies, what effects do about it, and how the wheels are loaded.

use super::{BEARING_SHARE, Lie, Plant};
use crate::{
    Error,
    contact::Brush,
    effect::{Conditions, Surroundings, air_force_n, drag_area_m2},
    plant::{GRAVITY_MPS2, LOOK_STEPS},
};

/// Load that a wheel gains per metre of twist of the ground over a quarter of the weight [1/m]: 8 N/mm of a Husky.
const TWIST_PER_M: f64 = 36.0;

impl Plant<'_> {
    /// Looks at the ground, at what effects do, and at the loads that follow from both.
    pub(super) fn look(&mut self) -> Result<(), Error> {
        let (sin, cos) = self.heading_rad.sin_cos();
        let (mut z, mut along, mut across, mut twist_m) = ([0.0; 4], 0.0, 0.0, 0.0);
        let mut surface = [0; 4];
        for (i, wheel) in self.wheels.iter().enumerate() {
            let [x, y] = wheel.at_m;
            let (x_m, y_m) = (self.place_m[0] + x * cos - y * sin, self.place_m[1] + x * sin + y * cos);
            let spot = self.ground.spot(x_m, y_m).ok_or(Error::UnknownGround { t_s: self.t_s, x_m, y_m })?;
            let forward = spot.slope[0] * cos + spot.slope[1] * sin;
            let left = spot.slope[1] * cos - spot.slope[0] * sin;
            z[i] = spot.z_m;
            along += forward / 4.0;
            across += left / 4.0;
            twist_m += (x * left - y * forward) / 4.0;
            surface[i] = self.ground.surface(x_m, y_m);
        }
        let (pitch_rad, roll_rad) = (along.atan(), across.atan());
        self.lie = Lie {
            z_m: z.iter().sum::<f64>() / 4.0,
            pitch: pitch_rad.sin_cos(),
            roll: roll_rad.sin_cos(),
            twist_m,
            pitch_rad,
            roll_rad: (across * pitch_rad.cos()).atan(),
        };
        self.apply_effects();
        self.load(&surface, (z[0] - z[1] - z[2] + z[3]) / 4.0);
        Ok(())
    }

    fn apply_effects(&mut self) {
        let seen = self.surroundings();
        let mut conditions = Conditions::default();
        for (effect, actor) in &mut self.effects {
            if effect.acts(self.t_s, self.place_m) {
                actor.act(&seen, &mut conditions);
            }
        }
        if let Some(wind) = self.wind {
            let force_n = air_force_n(&seen, wind.speed_mps, wind.toward_rad);
            conditions.push_n[0] += force_n[0];
            conditions.push_n[1] += force_n[1];
        }
        // Drives that change mass under way take its energies with them.
        let before = self.mechanical_j();
        self.conditions = conditions;
        let after = self.mechanical_j();
        self.ledger.kinetic_j -= after[0] - before[0];
        self.ledger.potential_j -= after[1] - before[1];
    }

    fn surroundings(&self) -> Surroundings {
        Surroundings {
            step_s: self.step_s * f64::from(LOOK_STEPS),
            place_m: self.place_m,
            height_m: self.lie.z_m,
            heading_rad: self.heading_rad,
            speed_mps: self.speed[0],
            yaw_rate_radps: self.speed[2],
            pitch_rad: self.lie.pitch_rad,
            roll_rad: self.lie.roll_rad,
            rim_mps: [0, 1].map(|i| self.sides[i].rim_mps),
            rim_m: [0, 1].map(|i| self.sides[i].rim_m),
            wheel_radius_m: self.robot.wheel_radius_m,
            drag_area_m2: drag_area_m2(self.robot),
            mass_kg: self.robot.mass_kg,
            duty: [0, 1].map(|i| self.sides[i].duty),
            relative_voltage: self.battery.relative_voltage(),
            around_m: if self.wants_surroundings { self.around_m() } else { self.lie.z_m },
        }
    }

    /// Mean height of the ground around [m].
    fn around_m(&self) -> f64 {
        /// How far around: wider than a puddle, closer than the next hill [m].
        const AROUND_M: f64 = 2.0;
        let [x, y] = self.place_m;
        let at = |dx: f64, dy: f64| self.ground.spot(x + dx, y + dy).map_or(self.lie.z_m, |spot| spot.z_m);
        (at(AROUND_M, 0.0) + at(-AROUND_M, 0.0) + at(0.0, AROUND_M) + at(0.0, -AROUND_M)) / 4.0
    }

    /// Loads of the wheels from attitude, centre of mass, accelerations and twisted ground; what they make of rolling.
    pub(super) fn load(&mut self, surface: &[usize; 4], warp_m: f64) {
        let normal_n = self.mass_kg() * GRAVITY_MPS2 * self.lie.pitch.1 * self.lie.roll.1;
        let height_m = self.robot.center_of_mass.height_m + self.conditions.center_m[2];
        let center_m = self.center_m();
        let front = (center_m[0] - height_m * self.carried_n[0] / normal_n) / self.robot.wheelbase_m;
        let left = (center_m[1] - height_m * self.carried_n[1] / normal_n) / self.robot.track_m;
        let nominal_n = self.robot.mass_kg * GRAVITY_MPS2 / 4.0;
        let track_ratio = self.robot.slip_track_m() / self.robot.track_m;
        let dug_in = [0, 1, 2, 3].map(|i| dug_in(self.slide_mps(i), self.sides[i % 2].rim_mps));
        self.sides.iter_mut().for_each(|side| side.rolling_n = 0.0);
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let (ahead, beside) = (wheel.at_m[0].signum(), wheel.at_m[1].signum());
            let share = (0.5 + ahead * front) * (0.5 + beside * left);
            wheel.load_n = (normal_n * share + TWIST_PER_M * nominal_n * warp_m * ahead * beside).max(0.0);
            let law = &self.ground.surfaces[surface[i]];
            let c = &self.conditions;
            wheel.brush =
                Brush::new(law.mu_skid * c.skid_factor, law.slip_angle_scale_rad, track_ratio, c.compliance);
            let carcass = law.mu_roll * c.roll_factor * (1.0 - BEARING_SHARE);
            let coefficient = carcass + c.sinkage * dug_in[i] * (wheel.load_n / nominal_n).cbrt();
            self.sides[i % 2].rolling_n += coefficient * wheel.load_n;
        }
    }
}

/// How many times as deep as one that rolls a wheel sinks that slips:
///
/// ```text
/// (1 + S) / (1 - S/2)
/// ```
///
/// S from 0 to 1 the share of sliding in the tread's motion (Lyasko, Slip sinkage effect in soil-vehicle mechanics, 2010).
fn dug_in(slide_mps: [f64; 2], rim_mps: f64) -> f64 {
    /// Slower than this nothing digs [m/s].
    const CREEP_MPS: f64 = 0.01;
    let slides_mps = slide_mps[0].hypot(slide_mps[1]);
    let slip = slides_mps / slides_mps.hypot(rim_mps).hypot(CREEP_MPS);
    (1.0 + slip) / (1.0 - slip / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_that_rolls_sinks_as_deep_as_the_soil_lets_it_and_one_that_skids_up_to_four_times_as_deep() {
        assert_eq!(dug_in([0.0; 2], 0.5), 1.0);
        assert_eq!(dug_in([0.0; 2], 0.0), 1.0, "at rest");
        // Half its motion is sliding: 1.5 / 0.75.
        assert!((dug_in([0.0, 0.5], 0.75f64.sqrt()) - 2.0).abs() < 1e-3);
        let skidding = dug_in([0.3, 0.4], 0.0);
        assert!((3.9..4.0).contains(&skidding), "{skidding}");
    }
}
