//! What electronics draw.

use super::{Act, Conditions, Surroundings};

/// A consumer at the battery.
#[derive(Debug)]
pub(super) struct Hotel {
    pub(super) power_w: f64,
}

impl Act for Hotel {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.hotel_w += self.power_w;
    }
}

/// Drivers whose diodes conduct while the duty is low.
#[derive(Debug)]
pub(super) struct LowDuty {
    pub(super) power_w: f64,
}

impl Act for LowDuty {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// Duty over which the loss fades, e-fold.
        const FADES_OVER: f64 = 0.08;
        for side in 0..2 {
            if seen.rim_mps[side].abs() > STANDSTILL_MPS {
                out.driver_w[side] += self.power_w * (-seen.duty[side].abs() / FADES_OVER).exp();
            }
        }
    }
}

/// Below this a side stands [m/s].
const STANDSTILL_MPS: f64 = 0.004;

/// A fan on both drivers, which runs with the cube of what the battery's voltage leaves above its threshold.
#[derive(Debug)]
pub(super) struct Fan {
    pub(super) power_w: f64,
}

impl Act for Fan {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        /// Voltages at which it stands and at which it runs fully, over the nominal one.
        const RUNS: [f64; 2] = [0.98, 1.06];
        let share = ((seen.relative_voltage - RUNS[0]) / (RUNS[1] - RUNS[0])).clamp(0.0, 1.2);
        for side in &mut out.driver_w {
            *side += self.power_w / 2.0 * share.powi(3);
        }
    }
}
