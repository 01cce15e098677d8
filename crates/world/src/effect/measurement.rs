//! Readings that are not what they seem.

use super::{Act, Distortion};

/// A tilted pitch sensor.
#[derive(Debug)]
pub(super) struct Pitch {
    pub(super) bias_rad: f64,
}

impl Act for Pitch {
    fn distort(&self, out: &mut Distortion) {
        out.pitch_rad += self.bias_rad;
    }
}

/// Encoders that count with a wrong radius.
#[derive(Debug)]
pub(super) struct Encoder {
    pub(super) excess: f64,
}

impl Act for Encoder {
    fn distort(&self, out: &mut Distortion) {
        out.rim_factor *= 1.0 + self.excess;
    }
}

/// A shunt of the wrong size.
#[derive(Debug)]
pub(super) struct PowerGain {
    pub(super) excess: f64,
}

impl Act for PowerGain {
    fn distort(&self, out: &mut Distortion) {
        out.power_factor *= 1.0 + self.excess;
    }
}

/// An amplifier that is off zero.
#[derive(Debug)]
pub(super) struct PowerOffset {
    pub(super) offset_w: f64,
}

impl Act for PowerOffset {
    fn distort(&self, out: &mut Distortion) {
        out.power_w += self.offset_w;
    }
}

/// A power meter whose clock is late.
#[derive(Debug)]
pub(super) struct Clock {
    pub(super) late_s: f64,
}

impl Act for Clock {
    fn distort(&self, out: &mut Distortion) {
        out.power_late_s += self.late_s;
    }
}
