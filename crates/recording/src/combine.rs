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
}

impl Combine {
    /// One value of several; NaN when one of them is.
    pub(crate) fn of(self, values: impl Iterator<Item = f64>) -> f64 {
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
        }
    }
}
