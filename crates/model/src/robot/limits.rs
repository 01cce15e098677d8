//! What a robot must not be asked to do.

use serde::{Deserialize, Serialize};

/// What the robot must not be asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Largest force a side may be asked for [N]. Default: no limit but the pitch's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_side_force_n: Option<f64>,
    /// Steepest climb or descent [rad]. Default 0.52 (30°).
    pub max_pitch_rad: f64,
    /// Steepest sideways tilt [rad]. Default 0.45 (26°).
    pub max_roll_rad: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { max_side_force_n: None, max_pitch_rad: 0.52, max_roll_rad: 0.45 }
    }
}
