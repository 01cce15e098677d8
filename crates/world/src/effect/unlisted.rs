//! Physics that no mechanism of a diagnosis stands for.

use super::{Act, Conditions, Surroundings, act::direction};

/// A brake that drags on one side until its own heat has opened the gap.
#[derive(Debug)]
pub(super) struct Brake {
    force_n: f64,
    side: usize,
    warmth_k: f64,
}

impl Brake {
    pub(super) fn new(force_n: f64, side: usize) -> Self {
        Brake { force_n, side, warmth_k: 0.0 }
    }
}

impl Act for Brake {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// Rise at which little of the drag is left [K], lining and the drum's face [J/K] and their cooling [W/K]: a watt opens it
        /// within some minutes.
        const OPENS_K: f64 = 12.0;
        const DRUM_J_PER_K: f64 = 15.0;
        const COOLING_W_PER_K: f64 = 0.03;
        let force_n = self.force_n * (-(self.warmth_k / OPENS_K).powi(2)).exp();
        let heat_w = force_n * seen.rim_mps[self.side].abs() - COOLING_W_PER_K * self.warmth_k;
        self.warmth_k += seen.step_s * heat_w / DRUM_J_PER_K;
        out.drag_n[self.side] += force_n;
    }
}

/// Water that stands where the ground is lower than around it.
#[derive(Debug)]
pub(super) struct Puddles {
    pub(super) drag_n_per_m: f64,
}

impl Act for Puddles {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let depth_m = (seen.around_m - seen.height_m).max(0.0);
        out.push_n[0] -=
            self.drag_n_per_m * depth_m * direction(seen.speed_mps) * (0.5 + seen.speed_mps.abs());
    }
}

/// A load that slides down to the lower side, slowly.
#[derive(Debug)]
pub(super) struct LooseLoad {
    per_rad_m: f64,
    left_m: f64,
}

impl LooseLoad {
    pub(super) fn new(per_rad_m: f64) -> Self {
        LooseLoad { per_rad_m, left_m: 0.0 }
    }
}

impl Act for LooseLoad {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// How long it takes to slide [s], and how far it can [m].
        const SLIDES_S: f64 = 0.8;
        const FARTHEST_M: f64 = 0.15;
        let rest_m = (-self.per_rad_m * seen.roll_rad).clamp(-FARTHEST_M, FARTHEST_M);
        self.left_m += (rest_m - self.left_m) * seen.step_s / SLIDES_S;
        out.center_m[1] += self.left_m;
    }
}

/// A stone in one tyre: a bump once per turn.
#[derive(Debug)]
pub(super) struct Bump {
    pub(super) force_n: f64,
    pub(super) side: usize,
}

impl Act for Bump {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let turned_rad = seen.rim_m[self.side] / seen.wheel_radius_m;
        let bump = ((1.0 + turned_rad.cos()) / 2.0).powi(4);
        out.drag_n[self.side] += self.force_n * bump;
    }
}

/// Ground that gives way sideways on slopes, so that turning there ploughs.
#[derive(Debug)]
pub(super) struct TurnOnSlope {
    pub(super) moment_nm: f64,
}

impl Act for TurnOnSlope {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let grade = seen.pitch_rad.sin().hypot(seen.roll_rad.sin());
        /// Yaw rate over which the moment turns round [rad/s].
        const TURNAROUND_RADPS: f64 = 0.05;
        out.moment_nm -= self.moment_nm * grade * (seen.yaw_rate_radps / TURNAROUND_RADPS).tanh();
    }
}

/// Furrows that let wheels run along and stop them across.
#[derive(Debug)]
pub(super) struct Furrows {
    pub(super) force_n: f64,
    pub(super) along_rad: f64,
}

impl Act for Furrows {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let across = (seen.heading_rad - self.along_rad).sin().powi(2);
        out.push_n[0] -= self.force_n * across * direction(seen.speed_mps);
    }
}

/// Grease that sets while the robot stands and is worked loose by driving.
#[derive(Debug)]
pub(super) struct Sticky {
    force_n: f64,
    set: f64,
}

impl Sticky {
    pub(super) fn new(force_n: f64) -> Self {
        Sticky { force_n, set: 1.0 }
    }
}

impl Act for Sticky {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// How long it takes to set [s] and how far to work loose [m].
        const SETS_S: f64 = 5.0;
        const LOOSENS_M: f64 = 0.7;
        let speed_mps = (seen.rim_mps[0].abs() + seen.rim_mps[1].abs()) / 2.0;
        self.set += seen.step_s * ((1.0 - self.set) / SETS_S - self.set * speed_mps / LOOSENS_M);
        for drag_n in &mut out.drag_n {
            *drag_n += self.force_n / 2.0 * self.set;
        }
    }
}

/// A frame that rings, and takes power, about one speed.
#[derive(Debug)]
pub(super) struct Resonance {
    pub(super) force_n: f64,
}

impl Act for Resonance {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// Speed at which it rings and how sharply [m/s].
        const RINGS_MPS: f64 = 0.45;
        const WITHIN_MPS: f64 = 0.08;
        let off = (seen.speed_mps.abs() - RINGS_MPS) / WITHIN_MPS;
        out.push_n[0] -= self.force_n / (1.0 + off * off) * direction(seen.speed_mps);
    }
}
