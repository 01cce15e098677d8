//! Where a robot's centre of mass lies.

use serde::{Deserialize, Serialize};

/// Where the centre of mass lies relative to the geometric centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CenterOfMass {
    /// Towards the front axle [m].
    pub forward_m: f64,
    /// Towards the left wheels [m].
    pub left_m: f64,
    /// Above the ground [m]. Slopes, turns and accelerations shift load by it (eq. 14); 0, as where it is not known, shifts none.
    pub height_m: f64,
}
