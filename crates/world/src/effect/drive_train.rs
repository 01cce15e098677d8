//! Motors, gears and rotors.

use super::{Act, Conditions, Surroundings};

/// Motors that warm up.
#[derive(Debug)]
pub(super) struct Heating {
    pub(super) scale: f64,
}

impl Act for Heating {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.warming += self.scale;
    }
}

/// Inertia of rotors and gears, which turn many times as fast as the wheels.
#[derive(Debug)]
pub(super) struct Rotors {
    pub(super) mass_kg: f64,
}

impl Act for Rotors {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.rim_kg += self.mass_kg / 2.0;
    }
}

/// Drivers that burn what motors return.
#[derive(Debug)]
pub(super) struct LostReturn {
    pub(super) fraction: f64,
}

impl Act for LostReturn {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.returned *= 1.0 - self.fraction;
    }
}

/// A bearing or belt that holds one side back.
#[derive(Debug)]
pub(super) struct Drag {
    pub(super) force_n: f64,
    pub(super) side: usize,
}

impl Act for Drag {
    fn act(&mut self, _: &Surroundings, out: &mut Conditions) {
        out.drag_n[self.side] += self.force_n;
    }
}
