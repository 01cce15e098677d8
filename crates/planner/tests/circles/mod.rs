//! The best circle-line-circle between two poses on level ground, by search over both radii: shares no code with the planner.

#![allow(dead_code)]

use std::f64::consts::{PI, TAU};

use model::{Attitude, Motion, Robot, Sides, power};
use planner::Settings;

/// Energy on level ground of the default surface.
pub(crate) struct Rates<'r> {
    robot: &'r Robot,
    settings: Settings,
    pub(crate) straight_j_per_m: f64,
    /// By sign of the turn (left, right) and radius of [`Rates::radii_m`].
    per_rad: [Vec<f64>; 2],
    radii_m: Vec<f64>,
}

impl<'r> Rates<'r> {
    pub(crate) fn new(robot: &'r Robot, settings: &Settings) -> Self {
        let mut rates = Rates {
            robot,
            settings: *settings,
            straight_j_per_m: 0.0,
            per_rad: [vec![], vec![]],
            radii_m: vec![],
        };
        let speed = settings.speed_mps;
        rates.straight_j_per_m = rates.power_w(speed, 0.0) / speed;
        // On the spot, then in steps of a sixth from a twentieth of half the slip track to 400 m.
        let half_m = robot.slip_track_m / 2.0;
        let grid = (0..).map(|k| half_m / 20.0 * 1.165f64.powi(k)).take_while(|r| *r < 400.0);
        rates.radii_m = std::iter::once(0.0).chain(grid).chain([half_m]).collect();
        rates.per_rad =
            [1.0, -1.0].map(|sign| rates.radii_m.iter().map(|r| rates.turn_j_per_rad(*r, sign)).collect());
        rates
    }

    fn power_w(&self, speed: f64, yaw: f64) -> f64 {
        let surface = self.robot.surface(&self.robot.default_surface).unwrap();
        let temperature = Sides::both(self.settings.motor_temperature_c);
        let motion = Motion::of_body(self.robot, speed, yaw);
        power(self.settings.power_model, self.robot, surface, motion, Attitude::LEVEL, temperature).bus_w
    }

    /// Per radian of an arc: on the spot and up to half the slip track at the yaw rate of that radius at the asked
    /// speed, beyond it at the asked speed or as fast as the outer wheel allows.
    pub(crate) fn turn_j_per_rad(&self, radius_m: f64, sign: f64) -> f64 {
        let half_m = self.robot.slip_track_m / 2.0;
        let fastest = self.robot.max_wheel_speed_mps / (1.0 + half_m / radius_m.max(half_m));
        let speed = self.settings.speed_mps.min(fastest);
        let yaw = speed / radius_m.max(half_m);
        self.power_w(yaw * radius_m, sign * yaw) / yaw
    }

    /// Energy of the curve with given bends (1 left, −1 right) and radii, by the energies per radian of its arcs.
    fn curve_j(
        &self,
        [a, b]: [[f64; 3]; 2],
        bends: [f64; 2],
        radii: [f64; 2],
        per_rad: impl Fn(usize, f64) -> f64,
    ) -> f64 {
        let center = |p: [f64; 3], r: f64| [p[0] - r * p[2].sin(), p[1] + r * p[2].cos()];
        let signed = [bends[0] * radii[0], bends[1] * radii[1]];
        let (c0, c1) = (center(a, signed[0]), center(b, signed[1]));
        let (dx, dy) = (c1[0] - c0[0], c1[1] - c0[1]);
        let apart = dx.hypot(dy);
        let gap = signed[1] - signed[0];
        if apart < gap.abs() {
            return f64::INFINITY;
        }
        let line = (apart * apart - gap * gap).sqrt();
        let heading = if apart < 1e-12 { a[2] } else { dy.atan2(dx) - (gap / apart).asin() };
        let turn = |i: usize, from: f64, to: f64| {
            let left = (to - from).rem_euclid(TAU);
            if radii[i] == 0.0 {
                return if left > PI { left - TAU } else { left };
            }
            let turn = if bends[i] > 0.0 { left } else { (from - to).rem_euclid(TAU) };
            bends[i] * if TAU - turn < 1e-9 { 0.0 } else { turn }
        };
        let turns = [turn(0, a[2], heading), turn(1, heading, b[2])];
        line * self.straight_j_per_m
            + turns[0].abs() * per_rad(0, turns[0])
            + turns[1].abs() * per_rad(1, turns[1])
    }

    /// Energy of the best curve: every pair of radii of the grid with every bend, then a polish of the best few.
    pub(crate) fn best_j(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        let mut found = Vec::new();
        for bends in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            for (i, &first) in self.radii_m.iter().enumerate() {
                for (j, &last) in self.radii_m.iter().enumerate() {
                    let known = |end: usize, turn: f64| self.per_rad[usize::from(turn < 0.0)][[i, j][end]];
                    found.push((self.curve_j([from, to], bends, [first, last], known), bends, [first, last]));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
            .iter()
            .take(12)
            .map(|&(j, bends, radii)| self.polished_j([from, to], bends, radii, j))
            .fold(f64::INFINITY, f64::min)
    }

    fn polished_j(&self, ends: [[f64; 3]; 2], bends: [f64; 2], mut radii: [f64; 2], mut best: f64) -> f64 {
        let mut step: f64 = 0.15;
        while step > 1e-5 {
            let factors = [
                [step, 0.0],
                [-step, 0.0],
                [0.0, step],
                [0.0, -step],
                [step, step],
                [-step, -step],
                [step, -step],
                [-step, step],
            ];
            let moved = factors.map(|[f, l]| [radii[0] * f.exp(), radii[1] * l.exp()]);
            let cost = |r: [f64; 2]| {
                self.curve_j(ends, bends, r, |end, turn| self.turn_j_per_rad(r[end], turn.signum()))
            };
            let (least, at) =
                moved.map(|r| (cost(r), r)).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            if least < best {
                (best, radii) = (least, at);
            } else {
                step /= 2.0;
            }
        }
        best
    }
}
