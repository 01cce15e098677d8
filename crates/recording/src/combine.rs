//! How several columns or fields become one value.

use serde::{Deserialize, Serialize};

/// How several columns or fields become one value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// Their mean, as of the wheels of a side.
    #[default]
    Mean,
    /// Their sum, as of currents.
    Sum,
    /// Their product, as of current and voltage.
    Product,
    /// Rim speed of the left side from odometry: of speed v and yaw rate ω, v − ω b/2, b the map's `wheel_separation_m`.
    LeftOfTwist,
    /// That of the right side: v + ω b/2.
    RightOfTwist,
}

impl Combine {
    /// Whether it takes a speed and a yaw rate.
    pub(crate) fn is_of_twist(self) -> bool {
        matches!(self, Combine::LeftOfTwist | Combine::RightOfTwist)
    }

    /// One value of several; NaN when one of them is. A twist's needs the separation of the wheels \[m\].
    pub(crate) fn of(self, values: impl Iterator<Item = f64>, separation_m: f64) -> f64 {
        let half_m = match self {
            Combine::LeftOfTwist => -0.5 * separation_m,
            Combine::RightOfTwist => 0.5 * separation_m,
            _ => 0.0,
        };
        if self.is_of_twist() {
            return values.zip([1.0, half_m]).map(|(value, by)| by * value).sum();
        }
        let (mut count, mut sum, mut product) = (0.0, 0.0, 1.0);
        for value in values {
            count += 1.0;
            sum += value;
            product *= value;
        }
        match self {
            Combine::Mean => sum / count,
            Combine::Sum => sum,
            Combine::Product => product,
            Combine::LeftOfTwist | Combine::RightOfTwist => f64::NAN,
        }
    }
}
