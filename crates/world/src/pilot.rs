//! Who drives: a drive file turned into a reference in time, and a robot kept on it.
//!
//! The reference depends on the drive alone, so that robots under different effects are asked for the same motion at the
//! same places and times; what keeps them on it is the feedback of a robot that knows where it is.

mod legs;

use crate::{Drive, DriveKind, RobotFile, ground::Ground, random::Random};

use legs::{Leg, Legs, wrapped};

/// How fast commands may change [m/s² and rad/s²].
const SLEW_MPS2: f64 = 0.5;
const SLEW_RADPS2: f64 = 1.0;
/// How far ahead a path is aimed at [m].
const LOOKAHEAD_M: f64 = 0.7;
/// Share of the wheels' top speed that the reference uses; the rest is for feedback.
const REFERENCE_SHARE: f64 = 0.93;
/// Gains of the feedback along [1/s], across [1/m²] and of the heading [1/s] (Kanayama et al. 1990), and its limits.
const ALONG_PER_S: f64 = 0.4;
const ACROSS_PER_M2: f64 = 1.0;
const HEADING_PER_S: f64 = 0.8;
const MOST_MPS: f64 = 0.08;
const MOST_RADPS: f64 = 0.15;

/// Drives one run.
#[derive(Debug)]
pub(crate) struct Pilot<'a> {
    drive: &'a Drive,
    legs: Legs,
    leg: Leg,
    /// Time, turn and way since the leg began.
    since_s: f64,
    turned_rad: f64,
    driven_m: f64,
    /// Where the reference is.
    place_m: [f64; 2],
    heading_rad: f64,
    /// Its speed [m/s] and yaw rate [rad/s].
    command: [f64; 2],
    /// The pose of a path that is passed next.
    next_pose: usize,
    top_mps: f64,
    rim_limit_mps: f64,
    half_track_m: f64,
}

impl<'a> Pilot<'a> {
    /// The pilot of one run.
    pub(crate) fn new(drive: &'a Drive, robot: &RobotFile, ground: &Ground, run: usize) -> Self {
        let mut random = Random::new(drive.seed.wrapping_add(run as u64 * 0x9E37_79B9), "drive");
        let (middle_m, radius_m) = ground.arena();
        let (mut place_m, mut heading_rad) = (middle_m, random.between(-3.0, 3.0));
        if run > 0 {
            place_m = [0, 1].map(|i| middle_m[i] + radius_m * random.between(-0.3, 0.3));
        }
        let first = drive.start.as_ref().or(drive.poses.first());
        if let Some(start) = first {
            place_m = [start.x_m, start.y_m];
            heading_rad = start.heading_rad.unwrap_or(heading_rad);
        }
        if drive.kind == DriveKind::Path && first.is_some_and(|p| p.heading_rad.is_none()) {
            heading_rad = (drive.poses[1].y_m - place_m[1]).atan2(drive.poses[1].x_m - place_m[0]);
        }
        let slope = ground.spot(place_m[0], place_m[1]).map_or([0.0; 2], |spot| spot.slope);
        if drive.kind == DriveKind::Hill && slope != [0.0; 2] {
            heading_rad = slope[1].atan2(slope[0]);
        }
        let top_mps =
            drive.speed_mps.unwrap_or(0.9 * robot.max_wheel_speed_mps).min(robot.max_wheel_speed_mps);
        Pilot {
            drive,
            legs: Legs::new(drive.kind, random, top_mps, middle_m, radius_m, heading_rad),
            leg: Leg::Stand { for_s: 1.0 },
            since_s: 0.0,
            turned_rad: 0.0,
            driven_m: 0.0,
            place_m,
            heading_rad,
            command: [0.0; 2],
            next_pose: 1,
            top_mps,
            rim_limit_mps: robot.max_wheel_speed_mps,
            half_track_m: robot.slip_track_m() / 2.0,
        }
    }

    /// Where the run begins.
    pub(crate) fn start(&self) -> ([f64; 2], f64) {
        (self.place_m, self.heading_rad)
    }

    /// Rim speeds of a robot at a pose for the next `step_s`.
    pub(crate) fn command_mps(&mut self, place_m: [f64; 2], heading_rad: f64, step_s: f64) -> [f64; 2] {
        self.advance(step_s);
        let [speed, yaw] = self.command;
        if speed == 0.0 && yaw == 0.0 {
            return [0.0; 2];
        }
        let (sin, cos) = heading_rad.sin_cos();
        let (east, north) = (self.place_m[0] - place_m[0], self.place_m[1] - place_m[1]);
        let (behind_m, beside_m) = (cos * east + sin * north, cos * north - sin * east);
        let off_rad = wrapped(self.heading_rad - heading_rad);
        // A robot that turns on the spot cannot make up for where it is.
        let along_mps = if speed == 0.0 { 0.0 } else { (ALONG_PER_S * behind_m).clamp(-MOST_MPS, MOST_MPS) };
        let turn_radps = ACROSS_PER_M2 * speed * beside_m + HEADING_PER_S * off_rad;
        self.rims_mps([speed + along_mps, yaw + turn_radps.clamp(-MOST_RADPS, MOST_RADPS)], 1.0)
    }

    /// Rim speeds of a speed and yaw rate, slowed down together where one is beyond a share of the limit.
    fn rims_mps(&self, [speed, yaw]: [f64; 2], share: f64) -> [f64; 2] {
        let rims = [speed - yaw * self.half_track_m, speed + yaw * self.half_track_m];
        let fastest = rims[0].abs().max(rims[1].abs());
        let limit = share * self.rim_limit_mps;
        rims.map(|rim| if fastest > limit { rim * limit / fastest } else { rim })
    }

    /// Moves the reference on.
    fn advance(&mut self, step_s: f64) {
        let wanted = if self.drive.kind == DriveKind::Path { self.follow() } else { self.along_legs() };
        let [left, right] = self.rims_mps(wanted, REFERENCE_SHARE);
        let wanted = [(left + right) / 2.0, (right - left) / (2.0 * self.half_track_m)];
        for (i, slew) in [SLEW_MPS2, SLEW_RADPS2].into_iter().enumerate() {
            let most = slew * step_s;
            self.command[i] += (wanted[i] - self.command[i]).clamp(-most, most);
        }
        let [speed, yaw] = self.command;
        let (sin, cos) = (self.heading_rad + 0.5 * yaw * step_s).sin_cos();
        self.place_m[0] += speed * cos * step_s;
        self.place_m[1] += speed * sin * step_s;
        self.heading_rad += yaw * step_s;
        self.since_s += step_s;
        self.turned_rad += yaw * step_s;
        self.driven_m += speed.abs() * step_s;
    }

    fn along_legs(&mut self) -> [f64; 2] {
        if self.leg.is_over(self.since_s, self.driven_m, self.turned_rad) {
            self.leg = self.legs.next(self.place_m, self.heading_rad);
            (self.since_s, self.driven_m, self.turned_rad) = (0.0, 0.0, 0.0);
        }
        self.leg.speeds(self.command[0], self.heading_rad)
    }

    /// Aims at a point ahead on the path.
    fn follow(&mut self) -> [f64; 2] {
        /// Near enough to the last pose [m].
        const THERE_M: f64 = 0.15;
        let poses = &self.drive.poses;
        let distance_m = |i: usize| (poses[i].x_m - self.place_m[0]).hypot(poses[i].y_m - self.place_m[1]);
        while self.next_pose + 1 < poses.len() && distance_m(self.next_pose) < LOOKAHEAD_M {
            self.next_pose += 1;
        }
        let left_m = distance_m(self.next_pose);
        let last = self.next_pose + 1 == poses.len();
        if last && left_m < THERE_M {
            return [0.0; 2];
        }
        let goal = poses[self.next_pose];
        let bearing_rad = (goal.y_m - self.place_m[1]).atan2(goal.x_m - self.place_m[0]);
        let off_rad = wrapped(bearing_rad - self.heading_rad);
        // Beyond some 50 degrees the robot turns on the spot first.
        let speed = if off_rad.abs() > 0.9 { 0.0 } else { 0.6 * self.top_mps * off_rad.cos() };
        let slow = if last { (left_m / LOOKAHEAD_M).clamp(0.3, 1.0) } else { 1.0 };
        [speed * slow, (1.6 * off_rad).clamp(-0.9, 0.9)]
    }
}
