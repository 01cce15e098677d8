//! A value for each side of the robot.

use serde::{Deserialize, Serialize};

/// One value for the left wheels and one for the right wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sides<T> {
    /// The left side (y > 0).
    pub left: T,
    /// The right side (y < 0).
    pub right: T,
}

impl<T> Sides<T> {
    /// Builds both sides from one function of the value at hand.
    #[inline(always)]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Sides<U> {
        Sides { left: f(self.left), right: f(self.right) }
    }

    /// Combines two pairs side by side.
    #[inline(always)]
    pub fn zip<U>(self, other: Sides<U>) -> Sides<(T, U)> {
        Sides { left: (self.left, other.left), right: (self.right, other.right) }
    }
}

impl<T: Copy> Sides<T> {
    /// The same value on both sides.
    #[inline(always)]
    pub const fn both(value: T) -> Self {
        Sides { left: value, right: value }
    }
}

impl Sides<f64> {
    /// Left plus right.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.left + self.right
    }
}
