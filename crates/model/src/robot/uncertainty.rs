//! How well a robot's parameters are known, one by one.

use serde::{Deserialize, Serialize};

/// Relative one-sigma uncertainty of the parameters, 0.1 meaning 10 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// Of every surface's μ_R. Default 0.10.
    pub mu_roll: f64,
    /// Of every surface's μ_S. Default 0.10.
    pub mu_skid: f64,
    /// Of both sides' k1. Default 0.05.
    pub k1: f64,
    /// Of both sides' k2. Default 0.02.
    pub k2: f64,
    /// Of the mass. Default 0.02.
    pub mass_kg: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Uncertainty { mu_roll: 0.10, mu_skid: 0.10, k1: 0.05, k2: 0.02, mass_kg: 0.02 }
    }
}
