//! Who drives: a drive file turned into speeds and turns, with an eye on where the robot is.

mod legs;

use crate::{Drive, DriveKind, RobotFile, ground::Ground, random::Random};

use legs::{Leg, Legs};

/// How fast commands may change [m/s² and rad/s²].
const SLEW_MPS2: f64 = 0.8;
const SLEW_RADPS2: f64 = 1.6;
/// How far ahead a path is aimed at [m].
const LOOKAHEAD_M: f64 = 0.7;

/// Drives one run.
#[derive(Debug)]
pub(crate) struct Pilot<'a> {
    drive: &'a Drive,
    legs: Legs,
    leg: Leg,
    /// Time and heading since the leg began.
    since_s: f64,
    turned_rad: f64,
    driven_m: f64,
    last: Option<([f64; 2], f64)>,
    /// Commanded speed and yaw rate now.
    command: [f64; 2],
    /// The pose of a path that is passed next.
    next_pose: usize,
    top_mps: f64,
    rim_limit_mps: f64,
    half_track_m: f64,
}

impl<'a> Pilot<'a> {
    /// The pilot of one run, and where it begins.
    pub(crate) fn new(
        drive: &'a Drive,
        robot: &RobotFile,
        ground: &Ground,
        run: usize,
    ) -> (Self, [f64; 2], f64) {
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
        let legs = Legs::new(drive.kind, random, top_mps, middle_m, radius_m, heading_rad);
        let pilot = Pilot {
            drive,
            legs,
            leg: Leg::Stand { for_s: 1.0 },
            since_s: 0.0,
            turned_rad: 0.0,
            driven_m: 0.0,
            last: None,
            command: [0.0; 2],
            next_pose: 1,
            top_mps,
            rim_limit_mps: robot.max_wheel_speed_mps,
            half_track_m: robot.slip_track_m() / 2.0,
        };
        (pilot, place_m, heading_rad)
    }

    /// Rim speeds to hold for the next `step_s`.
    pub(crate) fn command_mps(&mut self, place_m: [f64; 2], heading_rad: f64, step_s: f64) -> [f64; 2] {
        let (before_m, before_rad) =
            self.last.replace((place_m, heading_rad)).unwrap_or((place_m, heading_rad));
        self.since_s += step_s;
        self.turned_rad += heading_rad - before_rad;
        self.driven_m += (place_m[0] - before_m[0]).hypot(place_m[1] - before_m[1]);
        let wanted = if self.drive.kind == DriveKind::Path {
            self.follow(place_m, heading_rad)
        } else {
            if self.leg.is_over(self.since_s, self.driven_m, self.turned_rad) {
                self.leg = self.legs.next(place_m, heading_rad);
                (self.since_s, self.driven_m, self.turned_rad) = (0.0, 0.0, 0.0);
            }
            self.leg.speeds(heading_rad)
        };
        for (i, slew) in [SLEW_MPS2, SLEW_RADPS2].into_iter().enumerate() {
            let most = slew * step_s;
            self.command[i] += (wanted[i] - self.command[i]).clamp(-most, most);
        }
        let [speed, yaw] = self.command;
        let rims = [speed - yaw * self.half_track_m, speed + yaw * self.half_track_m];
        let fastest = rims[0].abs().max(rims[1].abs());
        let scale = if fastest > self.rim_limit_mps { self.rim_limit_mps / fastest } else { 1.0 };
        rims.map(|rim| rim * scale)
    }

    /// Aims at a point ahead on the path.
    fn follow(&mut self, place_m: [f64; 2], heading_rad: f64) -> [f64; 2] {
        let poses = &self.drive.poses;
        let distance_m = |i: usize| (poses[i].x_m - place_m[0]).hypot(poses[i].y_m - place_m[1]);
        while self.next_pose + 1 < poses.len() && distance_m(self.next_pose) < LOOKAHEAD_M {
            self.next_pose += 1;
        }
        let left_m = distance_m(self.next_pose);
        let last = self.next_pose + 1 == poses.len();
        /// Near enough to the last pose [m].
        const THERE_M: f64 = 0.15;
        if last && left_m < THERE_M {
            return [0.0; 2];
        }
        let goal = poses[self.next_pose];
        let off_rad = legs::wrapped((goal.y_m - place_m[1]).atan2(goal.x_m - place_m[0]) - heading_rad);
        // Beyond some 50 degrees the robot turns on the spot first.
        let speed = if off_rad.abs() > 0.9 { 0.0 } else { 0.6 * self.top_mps * off_rad.cos() };
        let slow = if last { (left_m / LOOKAHEAD_M).clamp(0.3, 1.0) } else { 1.0 };
        [speed * slow, (1.6 * off_rad).clamp(-0.9, 0.9)]
    }
}
