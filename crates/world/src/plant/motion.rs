//! Newton's law for the body and its wheels.

use super::{BEARING_SHARE, GRAVITY_MPS2, Plant};

/// Rim speed over which dry friction turns round [m/s].
const TURNAROUND_MPS: f64 = 0.008;
/// How long loads take to follow accelerations [s].
const LOAD_FOLLOWS_S: f64 = 0.05;

impl Plant<'_> {
    /// Forces of all tyres on the body [N], their moment [N m], and the force that holds each side's wheels [N].
    pub(super) fn tyres(&mut self) -> ([f64; 2], f64, [f64; 2]) {
        let center_m = self.center_m();
        let (mut force_n, mut moment_nm, mut held_n) = ([0.0; 2], 0.0, [0.0; 2]);
        for i in 0..self.wheels.len() {
            let (slide_mps, rim_mps) = (self.slide_mps(i), self.sides[i % 2].rim_mps);
            let wheel = &mut self.wheels[i];
            let (x, y) = (wheel.at_m[0] - center_m[0], wheel.at_m[1] - center_m[1]);
            let contact =
                wheel.brush.advance(wheel.load_n, wheel.deflection_m, slide_mps, rim_mps, self.step_s);
            wheel.deflection_m = contact.deflection_m;
            let [along_n, across_n] = contact.force_n;
            force_n[0] += along_n;
            force_n[1] += across_n;
            moment_nm += x * across_n - y * along_n;
            held_n[i % 2] += along_n;
            self.ledger.sliding_j += (along_n * slide_mps[0] + across_n * slide_mps[1]) * self.step_s;
        }
        (force_n, moment_nm, held_n)
    }

    /// How fast a wheel's tread slides over the ground, along and across [m/s].
    pub(super) fn slide_mps(&self, wheel: usize) -> [f64; 2] {
        let (at_m, center_m) = (self.wheels[wheel].at_m, self.center_m());
        let (x, y) = (at_m[0] - center_m[0], at_m[1] - center_m[1]);
        let [forward, left, yaw] = self.speed;
        [self.sides[wheel % 2].rim_mps - (forward - yaw * y), -(left + yaw * x)]
    }

    /// Newton's law for the body, in its own turning frame.
    pub(super) fn accelerate(&mut self, tyres_n: [f64; 2], tyre_moment_nm: f64) {
        let (mass_kg, c) = (self.mass_kg(), &self.conditions);
        let weight_n = mass_kg * GRAVITY_MPS2;
        let forward_n = tyres_n[0] + c.push_n[0] - weight_n * self.lie.pitch.0;
        let left_n = tyres_n[1] + c.push_n[1] - weight_n * self.lie.roll.0;
        let moment_nm = tyre_moment_nm + c.moment_nm - weight_n * self.lie.twist_m;
        let [forward, left, yaw] = self.speed;
        let before_yaw = yaw;
        self.speed = [
            forward + self.step_s * (forward_n / (mass_kg + c.towed_kg) + yaw * left),
            left + self.step_s * (left_n / mass_kg - yaw * forward),
            yaw + self.step_s * moment_nm / self.yaw_inertia_kgm2(),
        ];
        let outside_w = c.push_n[0] * (forward + self.speed[0]) / 2.0
            + c.push_n[1] * (left + self.speed[1]) / 2.0
            + c.moment_nm * (before_yaw + self.speed[2]) / 2.0;
        self.ledger.outside_j -= outside_w * self.step_s;
        let follow = self.step_s / LOAD_FOLLOWS_S;
        for (carried_n, tyre_n) in self.carried_n.iter_mut().zip(tyres_n) {
            *carried_n += follow * (tyre_n - *carried_n);
        }
    }

    /// Newton's law for the wheels of each side; dry friction is taken implicitly, since it stops what it brakes.
    pub(super) fn turn_wheels(&mut self, drive_n: [(f64, f64); 2], held_n: [f64; 2]) {
        let bearing_n = BEARING_SHARE * self.nominal_rolling() * self.robot.mass_kg * GRAVITY_MPS2 / 2.0;
        let rim_kg = self.rim_kg();
        for i in 0..2 {
            let s = &mut self.sides[i];
            let before_mps = s.rim_mps;
            if s.braked {
                self.ledger.gears_j +=
                    0.5 * rim_kg * before_mps * before_mps - held_n[i] * before_mps * self.step_s;
                s.rim_mps = 0.0;
                continue;
            }
            let (magnets_n, pressed_n) = drive_n[i];
            let gear_n = pressed_n + bearing_n + self.conditions.drag_n[i];
            let per_n = self.step_s / rim_kg;
            let free_mps = before_mps + per_n * (magnets_n - held_n[i]);
            s.rim_mps = slowed_mps(free_mps, per_n * (gear_n + s.rolling_n));
            let mean_mps = (before_mps + s.rim_mps) / 2.0;
            let slid_m = (s.rim_mps / TURNAROUND_MPS).tanh() * mean_mps * self.step_s;
            s.rim_m += mean_mps * self.step_s;
            self.ledger.gears_j += gear_n * slid_m;
            self.ledger.rolling_j += s.rolling_n * slid_m;
        }
    }

    /// Rolling coefficient of the default surface, which bearings were measured on.
    fn nominal_rolling(&self) -> f64 {
        self.robot.surfaces.get(&self.robot.default_surface).map_or(0.0, |s| s.mu_roll)
    }

    /// Where the geometric centre goes.
    pub(super) fn move_on(&mut self) {
        let center_m = self.center_m();
        let forward = (self.speed[0] + self.speed[2] * center_m[1]) * self.lie.pitch.1;
        let left = (self.speed[1] - self.speed[2] * center_m[0]) * self.lie.roll.1;
        let (sin, cos) = self.heading_rad.sin_cos();
        self.place_m[0] += self.step_s * (forward * cos - left * sin);
        self.place_m[1] += self.step_s * (forward * sin + left * cos);
        self.heading_rad += self.step_s * self.speed[2];
    }
}

/// The speed that dry friction leaves of `free_mps`, where it can take `most_mps` at most in a step [m/s]:
///
/// ```text
/// v + most tanh(v/T) = free
/// ```
///
/// Taken by the speed before the step, friction of a light wheel would throw it back and forth about standstill.
fn slowed_mps(free_mps: f64, most_mps: f64) -> f64 {
    /// Speeds over T from which on friction is whole.
    const WHOLE: f64 = 10.0;
    /// Far below what a sensor tells [m/s].
    const CLOSE_MPS: f64 = 1e-12;
    let free = free_mps.abs();
    let mut v = (free - most_mps).max(0.0);
    if v > WHOLE * TURNAROUND_MPS {
        return v.copysign(free_mps);
    }
    // Friction bends downwards with speed, so that Newton's steps from below never go too far.
    for _ in 0..50 {
        let share = (v / TURNAROUND_MPS).tanh();
        let slope = 1.0 + most_mps * (1.0 - share * share) / TURNAROUND_MPS;
        let step = (free - v - most_mps * share) / slope;
        v += step;
        if step.abs() < CLOSE_MPS {
            break;
        }
    }
    v.copysign(free_mps)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn friction_slows_and_never_turns_round(free_mps in -2.0..2.0f64, most_mps in 0.0..1.0f64) {
            let v = slowed_mps(free_mps, most_mps);
            prop_assert!(v * free_mps >= 0.0 && v.abs() <= free_mps.abs());
            let whole = v + most_mps * (v / TURNAROUND_MPS).tanh();
            prop_assert!((whole - free_mps).abs() < 1e-8, "{whole} for {free_mps}");
        }
    }
}
