//! Quaternions of messages as rotations: those of one other length than 1 are rotations too, as integers of a sensor's own scale.

/// How far the square of a length may be off: more than single precision leaves is another length.
const TOLERANCE: f64 = 1e-2;

/// The lengths of the quaternions of a topic so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lengths {
    /// Square of the length of the one before; NaN before the first, and 1 from the first of that length on.
    square: f64,
    normalised: usize,
    left_out: usize,
}

impl Lengths {
    pub(crate) const NONE: Lengths = Lengths { square: f64::NAN, normalised: 0, left_out: 0 };

    /// The rotation that a quaternion is; zeros, which drivers leave that know no orientation, and lengths that change are none.
    pub(crate) fn rotation(&mut self, [x, y, z, w]: [f64; 4]) -> Option<[f64; 4]> {
        let square = x * x + y * y + z * z + w * w;
        if !square.is_finite() || square == 0.0 {
            return None;
        }
        let is = |length: f64| (square / length - 1.0).abs() <= TOLERANCE;
        if is(1.0) {
            self.square = 1.0;
            return Some([x, y, z, w]);
        }
        if is(self.square) {
            self.normalised += 1;
            return Some([x, y, z, w].map(|part| part / square.sqrt()));
        }
        self.left_out += 1;
        if self.square != 1.0 {
            self.square = square;
        }
        None
    }

    /// What was done to those of another length.
    pub(crate) fn told(&self) -> Option<String> {
        match (self.normalised, self.left_out) {
            (0, 0) => None,
            (0, left_out) => Some(format!(
                "{left_out} orientations have another length than 1, which changes: they are no rotations, and no angle was taken from them"
            )),
            (normalised, left_out) => Some(format!(
                "{normalised} orientations have the length {:.4} and were normalised; {left_out} were left out",
                self.square.sqrt()
            )),
        }
    }

    /// Those that it left out or normalised.
    pub(crate) fn count(&self) -> usize {
        self.normalised + self.left_out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_other_length_is_a_scale_and_lengths_that_change_are_no_rotations() {
        let scaled = |by: f64| [0.0, 0.6 * by, 0.0, 0.8 * by];
        let mut lengths = Lengths::NONE;
        let read: Vec<_> = (0..4).map(|_| lengths.rotation(scaled(16_384.0))).collect();
        assert!(read[0].is_none() && read[1..].iter().all(|q| q.is_some_and(|q| (q[1] - 0.6).abs() < 1e-12)));
        assert!(lengths.told().is_some_and(|told| told.contains("the length 16384.0000")));
        let mut changing = Lengths::NONE;
        assert!((1..9).all(|by| changing.rotation(scaled(2.0 * f64::from(by))).is_none()));
        assert!(changing.told().is_some_and(|told| told.starts_with("8 orientations")));
        let mut healthy = Lengths::NONE;
        assert!(healthy.rotation([0.0; 4]).is_none() && healthy.rotation(scaled(1.0)).is_some());
        assert!(healthy.rotation(scaled(3.0)).is_none() && healthy.rotation(scaled(3.0)).is_none());
        healthy = Lengths::NONE;
        assert!(healthy.rotation(scaled(1.001)).is_some() && healthy.told().is_none());
    }
}
