//! Hard limits on a path, and the three quantities that they are on.

use planner::{Edge, Objective, Surcharge, Weights};

/// What a path may take at most; what is `None` is not limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Energy drawn from the battery on arrival [J].
    pub max_energy_j: Option<f64>,
    /// Time [s].
    pub max_time_s: Option<f64>,
    /// Length along the ground [m].
    pub max_distance_m: Option<f64>,
}

impl Limits {
    /// Whether nothing is limited.
    pub fn is_empty(&self) -> bool {
        *self == Limits::default()
    }

    /// Whether a path's totals keep within them.
    pub fn hold(&self, total: &Edge) -> bool {
        let within = |limit: Option<f64>, value: f64| limit.is_none_or(|limit| value <= limit);
        within(self.max_energy_j, total.energy_j)
            && within(self.max_time_s, total.duration_s)
            && within(self.max_distance_m, total.length_m)
    }
}

/// Energy beyond lifting [J], length [m] and time [s] of a motion or a path, in the order of [`Objective`].
pub(crate) type Amounts = [f64; 3];

/// Place of an objective among amounts.
pub(crate) const fn place(objective: Objective) -> usize {
    objective as usize
}

/// Sum of two.
pub(crate) fn plus(a: &Amounts, b: &Amounts) -> Amounts {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Weighted sum.
pub(crate) fn weighed(amounts: &Amounts, weights: &Amounts) -> f64 {
    amounts[0] * weights[0] + amounts[1] * weights[1] + amounts[2] * weights[2]
}

/// One amount alone.
pub(crate) fn only(at: usize) -> Amounts {
    std::array::from_fn(|i| if i == at { 1.0 } else { 0.0 })
}

/// Weights as the planner's tables take them.
pub(crate) fn weights([per_j, per_m, per_s]: Amounts) -> Weights {
    Weights { per_j, per_m, per_s, of_surcharge: Surcharge::default() }
}
