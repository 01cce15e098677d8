//! Load: how much, where, and how high.

use super::{Act, Conditions, Surroundings};

/// Mass over the middle of the robot.
#[derive(Debug)]
pub(super) struct Payload {
    pub(super) mass_kg: f64,
}

impl Act for Payload {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.mass_kg += self.mass_kg;
    }
}

/// A centre of mass that is not where the file says, forward and left.
#[derive(Debug)]
pub(super) struct Shift {
    pub(super) by_m: [f64; 2],
}

impl Act for Shift {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.center_m[0] += self.by_m[0];
        out.center_m[1] += self.by_m[1];
    }
}

/// A centre of mass that is higher than the file says.
#[derive(Debug)]
pub(super) struct Height {
    pub(super) by_m: f64,
}

impl Act for Height {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.center_m[2] += self.by_m;
    }
}
