//! Friction of kinds of ground, as measured under a Husky A200: what a robot borrows that has not been driven yet.

use std::collections::BTreeMap;

use crate::{Error, robot::Surface};

/// A kind of ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// What maps and recordings call it.
    pub name: &'static str,
    /// μ_R [-].
    pub mu_roll: f64,
    /// μ_S [-].
    pub mu_skid: f64,
    /// α_s [rad].
    pub slip_angle_scale_rad: f64,
    /// Where the figures come from.
    pub source: &'static str,
}

/// Relative one-sigma uncertainty of a μ_R that another robot was measured on, on ground of the same name [-]: an assumption. With
/// it 95 % of robots on asphalt have 0.067 to 0.145, which is from half to all of the way between marble and sandy loam.
pub(super) const MU_ROLL_SIGMA: f64 = 0.20;
/// The same of μ_S [-]. Tyres differ more across than along: a Husky's on firm ground have 0.29 on marble and 0.62 on asphalt.
pub(super) const MU_SKID_SIGMA: f64 = 0.30;

/// Fitted to motor currents of a Husky A200 (BorealTC, LaRocque et al., IROS 2024), whose no-load current is in μ_R:
/// `cargo run --release -p joulepath-calibration --example husky_table`.
const BOREAL: &str = "fitted to motor currents of a Husky A200 (BorealTC, LaRocque et al., IROS 2024)";

/// Grounds by name.
pub const GROUNDS: [Ground; 6] = [
    Ground {
        name: "marble",
        mu_roll: 0.063,
        mu_skid: 0.29,
        slip_angle_scale_rad: 0.30,
        source: "side forces of a Husky A200 on polished marble (Dogru & Marques 2018, Table II)",
    },
    Ground { name: "flooring", mu_roll: 0.103, mu_skid: 0.374, slip_angle_scale_rad: 0.094, source: BOREAL },
    Ground { name: "asphalt", mu_roll: 0.098, mu_skid: 0.618, slip_angle_scale_rad: 0.114, source: BOREAL },
    Ground {
        name: "grass",
        mu_roll: 0.10,
        mu_skid: 0.41,
        slip_angle_scale_rad: 0.138,
        source: "no robot's: rolling the geometric mean of marble and sandy loam, skid that of sandy loam",
    },
    Ground {
        name: "sandy_loam",
        mu_roll: 0.157,
        mu_skid: 0.413,
        slip_angle_scale_rad: 0.138,
        source: BOREAL,
    },
    Ground { name: "ice", mu_roll: 0.121, mu_skid: 0.069, slip_angle_scale_rad: 0.010, source: BOREAL },
];

/// Friction that a robot is described with.
#[derive(Clone, Debug, PartialEq)]
pub enum GroundSheet {
    /// As of a ground of [`GROUNDS`].
    Known(String),
    /// Measured under this robot, by the name that maps call it.
    Measured {
        /// Its name.
        name: String,
        /// μ_R [-].
        mu_roll: f64,
        /// μ_S [-].
        mu_skid: f64,
        /// α_s; that of the paper's marble where it is not known [rad].
        slip_angle_scale_rad: Option<f64>,
    },
}

impl GroundSheet {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            GroundSheet::Known(name) | GroundSheet::Measured { name, .. } => name,
        }
    }

    /// Its friction, and the ground that it is borrowed from.
    ///
    /// # Errors
    /// [`Error::UnknownGround`], which lists the known ones.
    pub fn surface(&self) -> Result<(Surface, Option<Ground>), Error> {
        let of = |mu_roll: f64, mu_skid: f64, slip_angle_scale_rad: f64| Surface {
            mu_roll,
            mu_skid,
            slip_angle_scale_rad,
            dogru_marques: None,
            mechanisms: Vec::new(),
        };
        match self {
            GroundSheet::Measured { mu_roll, mu_skid, slip_angle_scale_rad, .. } => {
                let scale_rad = slip_angle_scale_rad.unwrap_or(GROUNDS[0].slip_angle_scale_rad);
                Ok((of(*mu_roll, *mu_skid, scale_rad), None))
            }
            GroundSheet::Known(name) => {
                let ground = GROUNDS.into_iter().find(|ground| ground.name == name);
                let ground = ground.ok_or_else(|| Error::UnknownGround {
                    name: name.clone(),
                    known: GROUNDS.iter().map(|ground| ground.name.to_owned()).collect(),
                })?;
                Ok((of(ground.mu_roll, ground.mu_skid, ground.slip_angle_scale_rad), Some(ground)))
            }
        }
    }
}

/// The friction of several grounds by their names.
pub(super) fn surfaces(sheets: &[GroundSheet]) -> Result<BTreeMap<String, Surface>, Error> {
    sheets.iter().map(|sheet| Ok((sheet.name().to_owned(), sheet.surface()?.0))).collect()
}
