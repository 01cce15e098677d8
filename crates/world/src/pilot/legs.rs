//! Legs of a drive: what to do until when.

use std::f64::consts::{PI, TAU};

use crate::{DriveKind, random::Random};

/// One manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leg {
    /// Nothing.
    Stand { for_s: f64 },
    /// Speed and yaw rate for a time.
    Arc { speed_mps: f64, yaw_radps: f64, for_s: f64 },
    /// A heading held over a distance.
    Straight { speed_mps: f64, heading_rad: f64, for_m: f64 },
    /// A turn by an angle.
    Turn { speed_mps: f64, yaw_radps: f64, by_rad: f64 },
}

impl Leg {
    /// Whether it is done; one that gets stuck ends after a while.
    pub(super) fn is_over(&self, since_s: f64, driven_m: f64, turned_rad: f64) -> bool {
        /// No leg takes longer [s].
        const PATIENCE_S: f64 = 90.0;
        since_s > PATIENCE_S
            || match *self {
                Leg::Stand { for_s } | Leg::Arc { for_s, .. } => since_s >= for_s,
                Leg::Straight { for_m, .. } => driven_m >= for_m,
                Leg::Turn { by_rad, .. } => turned_rad.abs() >= by_rad.abs(),
            }
    }

    /// Speed [m/s] and yaw rate [rad/s] that it wants at a speed and heading.
    pub(super) fn speeds(&self, now_mps: f64, now_rad: f64) -> [f64; 2] {
        /// Gain of the held heading [1/s] and the fastest correction [rad/s].
        const HOLD_PER_S: f64 = 0.8;
        const CORRECTION_RADPS: f64 = 0.25;
        match *self {
            Leg::Stand { .. } => [0.0; 2],
            Leg::Arc { speed_mps, yaw_radps, .. } => [speed_mps, yaw_radps],
            // Who still goes too fast for the turn takes it wider.
            Leg::Turn { speed_mps, yaw_radps, .. } => {
                let most_radps = SIDEWAYS_MPS2[1] / now_mps.abs();
                [speed_mps, yaw_radps.clamp(-most_radps, most_radps)]
            }
            Leg::Straight { speed_mps, heading_rad, .. } => {
                let off_rad = wrapped(heading_rad - now_rad);
                [speed_mps, (HOLD_PER_S * off_rad).clamp(-CORRECTION_RADPS, CORRECTION_RADPS)]
            }
        }
    }
}

/// An angle between −π and π.
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

/// Deals out the legs of a drive.
#[derive(Debug)]
pub(super) struct Legs {
    kind: DriveKind,
    random: Random,
    top_mps: f64,
    middle_m: [f64; 2],
    radius_m: f64,
    heading_rad: f64,
    count: usize,
}

/// Accelerations towards the inside of a curve [m/s²] that drivers of such robots allow themselves.
const SIDEWAYS_MPS2: [f64; 2] = [0.04, 0.14];

impl Legs {
    pub(super) fn new(
        kind: DriveKind,
        random: Random,
        top_mps: f64,
        middle_m: [f64; 2],
        radius_m: f64,
        heading_rad: f64,
    ) -> Self {
        Legs { kind, random, top_mps, middle_m, radius_m, heading_rad, count: 0 }
    }

    /// The next leg, from a place and heading.
    pub(super) fn next(&mut self, place_m: [f64; 2], now_rad: f64) -> Leg {
        self.count += 1;
        let outward_m = [place_m[0] - self.middle_m[0], place_m[1] - self.middle_m[1]];
        let astray = outward_m[0].hypot(outward_m[1]) > self.radius_m;
        match self.kind {
            DriveKind::LawnMower => self.lane(),
            DriveKind::Hill => self.hill(),
            _ if astray => self.homeward(outward_m, now_rad),
            DriveKind::Straight => Leg::Straight {
                speed_mps: self.speed(),
                heading_rad: self.heading_rad,
                for_m: self.random.between(2.0, 8.0),
            },
            DriveKind::StopAndGo => self.stop_and_go(now_rad),
            DriveKind::Rich | DriveKind::Path => self.rich(now_rad),
        }
    }

    /// Any speed that wheels hold well.
    fn speed(&mut self) -> f64 {
        self.top_mps * self.random.between(0.2, 1.0)
    }

    fn sideways_mps2(&mut self) -> f64 {
        self.random.between(SIDEWAYS_MPS2[0], SIDEWAYS_MPS2[1])
    }

    fn sign(&mut self) -> f64 {
        if self.random.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Turns to the middle, then drives there.
    fn homeward(&mut self, outward_m: [f64; 2], now_rad: f64) -> Leg {
        let home_rad = (-outward_m[1]).atan2(-outward_m[0]);
        let off_rad = wrapped(home_rad - now_rad);
        self.heading_rad = home_rad;
        if off_rad.abs() > 0.3 {
            let yaw_radps = off_rad.signum() * self.random.between(0.4, 0.9);
            return Leg::Turn { speed_mps: 0.0, yaw_radps, by_rad: off_rad };
        }
        Leg::Straight {
            speed_mps: self.speed(),
            heading_rad: home_rad,
            for_m: self.random.between(4.0, 10.0),
        }
    }

    fn rich(&mut self, now_rad: f64) -> Leg {
        let (speed_mps, sign) = (self.speed(), self.sign());
        let speed_mps = if self.random.chance(0.15) { -0.6 * speed_mps } else { speed_mps };
        match self.random.between(0.0, 1.0) {
            x if x < 0.27 => {
                Leg::Straight { speed_mps, heading_rad: now_rad, for_m: self.random.between(1.5, 6.0) }
            }
            x if x < 0.82 => {
                // From tight to wide, evenly on a logarithmic scale [m].
                let radius_m = self.random.log_between(0.25, 6.0);
                let most_radps = (self.sideways_mps2() / radius_m).sqrt().min(1.1);
                let yaw_radps = (speed_mps.abs() / radius_m).min(most_radps);
                let speed_mps = speed_mps.signum() * yaw_radps * radius_m;
                Leg::Arc { speed_mps, yaw_radps: sign * yaw_radps, for_s: self.random.between(3.0, 8.0) }
            }
            x if x < 0.94 => {
                let yaw_radps = sign * self.random.between(0.25, 1.1);
                Leg::Arc { speed_mps: 0.0, yaw_radps, for_s: self.random.between(2.0, 6.0) }
            }
            _ => Leg::Stand { for_s: self.random.between(1.0, 3.0) },
        }
    }

    fn stop_and_go(&mut self, now_rad: f64) -> Leg {
        if self.count.is_multiple_of(2) {
            return Leg::Stand { for_s: self.random.between(0.5, 3.0) };
        }
        let speed_mps = self.speed();
        if self.random.chance(0.35) {
            let yaw_radps = self.sign() * self.random.between(0.3, 1.0);
            let fastest_mps = (self.sideways_mps2() / yaw_radps.abs()).min(speed_mps);
            let speed_mps = if self.random.chance(0.5) { 0.0 } else { fastest_mps };
            return Leg::Arc { speed_mps, yaw_radps, for_s: self.random.between(1.0, 3.0) };
        }
        Leg::Straight { speed_mps, heading_rad: now_rad, for_m: self.random.between(0.5, 3.0) }
    }

    /// Lanes of one length, joined by half circles of the lanes' spacing to alternate sides, no faster than drivers take such curves.
    fn lane(&mut self) -> Leg {
        /// Distance between lanes [m].
        const SPACING_M: f64 = 1.6;
        let length_m = (1.2 * self.radius_m).min(20.0);
        let lane = self.count / 2;
        if !self.count.is_multiple_of(2) {
            return Leg::Straight {
                speed_mps: 0.7 * self.top_mps,
                heading_rad: self.heading_rad,
                for_m: length_m,
            };
        }
        // After a field's width the lanes go back.
        let lanes = ((self.radius_m / SPACING_M) as usize).max(2);
        let back = if (lane / lanes).is_multiple_of(2) { 1.0 } else { -1.0 };
        let side = back * if lane.is_multiple_of(2) { 1.0 } else { -1.0 };
        self.heading_rad += PI;
        let radius_m = SPACING_M / 2.0;
        let speed_mps = (0.45 * self.top_mps).min((SIDEWAYS_MPS2[1] * radius_m).sqrt());
        Leg::Turn { speed_mps, yaw_radps: side * speed_mps / radius_m, by_rad: PI }
    }

    fn hill(&mut self) -> Leg {
        if self.count.is_multiple_of(2) {
            self.heading_rad += PI;
            let yaw_radps = self.sign() * self.random.between(0.4, 0.8);
            return Leg::Turn { speed_mps: 0.0, yaw_radps, by_rad: PI };
        }
        let for_m = (0.8 * self.radius_m).min(12.0);
        Leg::Straight { speed_mps: self.speed(), heading_rad: self.heading_rad, for_m }
    }
}
