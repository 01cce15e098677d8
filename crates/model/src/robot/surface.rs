//! Friction of the ground, as a robot file has it.

use serde::{Deserialize, Serialize};

use crate::known::KnownMechanism;

/// Friction of one kind of ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// μ_R: rolling resistance over normal load [-].
    pub mu_roll: f64,
    /// μ_S: lateral skid resistance over normal load [-].
    pub mu_skid: f64,
    /// α_s: slip angle over which skid resistance saturates [rad]; 0 is the paper's Coulomb skid. Default 0.30.
    #[serde(default = "slip_angle_scale_rad")]
    pub slip_angle_scale_rad: f64,
    /// What only the paper's printed form needs. Default: derived from the values above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dogru_marques: Option<PaperSurface>,
    /// What acts on this ground alone and changes its friction. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<crate::KnownMechanismFile>))]
    pub mechanisms: Vec<KnownMechanism>,
}

impl Surface {
    /// The same ground with rolling and skid resistance multiplied.
    ///
    /// In the printed form's opposite sides mostly skid counts, so its inner friction goes with μ_S.
    #[must_use]
    pub fn scaled(&self, roll: f64, skid: f64) -> Surface {
        let mut scaled = self.clone();
        scaled.mu_roll *= roll;
        scaled.mu_skid *= skid;
        if let Some(paper) = &mut scaled.dogru_marques {
            paper.inner_friction = paper.inner_friction.map(|friction| friction * skid);
            for row in &mut paper.by_speed {
                row.mu_roll *= roll;
                row.mu_skid *= skid;
            }
        }
        scaled
    }
}

/// The paper's own description of a surface: constants per speed and a constant inner friction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PaperSurface {
    /// Friction of the inner side for R ≤ R_c (Table II) [-]. Default: half of eq. 16 at R_0 = 0 plus half μ_R.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner_friction: Option<f64>,
    /// (μ_R, μ_S) at increasing speeds (Fig. 13); between them they are interpolated. Default: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_speed: Vec<SpeedFriction>,
}

/// The coefficients of eq. 16 as fitted at one speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct SpeedFriction {
    /// Translational speed of the fit [m/s].
    pub speed_mps: f64,
    /// μ_R fitted there [-].
    pub mu_roll: f64,
    /// μ_S fitted there [-].
    pub mu_skid: f64,
}

fn slip_angle_scale_rad() -> f64 {
    0.30
}
