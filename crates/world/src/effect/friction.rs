//! Ground that rubs otherwise than the file says.

use super::{Act, Conditions, Surroundings};

/// Other ground: rolling and skid by the same fraction.
#[derive(Debug)]
pub(super) struct Surface {
    pub(super) fraction: f64,
}

impl Act for Surface {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.roll_factor *= 1.0 + self.fraction;
        out.skid_factor *= 1.0 + self.fraction;
    }
}

/// Rolling friction that grows with the wheels' speed, as carcasses lose more the faster they are kneaded.
#[derive(Debug)]
pub(super) struct WithSpeed {
    pub(super) per_mps: f64,
}

impl Act for WithSpeed {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        let speed_mps = (seen.rim_mps[0].abs() + seen.rim_mps[1].abs()) / 2.0;
        out.roll_factor *= (1.0 + self.per_mps * speed_mps).max(0.1);
    }
}

/// Rolling friction that grows with the steepness of the ground, whichever way it slopes.
#[derive(Debug)]
pub(super) struct WithGrade {
    pub(super) per_grade: f64,
}

impl Act for WithGrade {
    fn act(&mut self, seen: &Surroundings, out: &mut Conditions) {
        out.roll_factor *= 1.0 + self.per_grade * seen.pitch_rad.sin().hypot(seen.roll_rad.sin());
    }
}

/// Soil that is pressed together under the wheels: resistance grows faster than load (Bekker 1969), and wheels that slip dig in.
#[derive(Debug)]
pub(super) struct Sinkage {
    pub(super) rolling: f64,
}

impl Act for Sinkage {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.sinkage += self.rolling;
    }
}

/// Loose ground that shears under pull.
#[derive(Debug)]
pub(super) struct Loose {
    pub(super) slip_per_pull: f64,
}

impl Act for Loose {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.compliance += self.slip_per_pull;
    }
}
