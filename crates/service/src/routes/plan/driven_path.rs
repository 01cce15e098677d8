//! The paths of an answer: that of the lattice, and the one that is to be followed, which pictures, files and the page show.

use super::{PlanAnswer, PoseAnswer};
use crate::routes::compare::CompareAnswer;

/// Totals and poses of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenPath<'a> {
    /// Energy drawn from the battery [J].
    pub energy_j: f64,
    /// Central 95 % interval of it [J].
    pub energy_interval_j: [f64; 2],
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub distance_m: f64,
    /// Height gained on the way up [m].
    pub climb_m: f64,
    /// Height lost on the way down [m].
    pub descent_m: f64,
    /// Energy that flowed back into the battery [J].
    pub recovered_j: f64,
    /// Energy of the lattice's path, of which it may be a refinement [J].
    pub lattice_energy_j: f64,
    /// The path, pose by pose.
    pub poses: &'a [PoseAnswer],
}

impl PlanAnswer {
    /// The lattice's path, of which a bound is proven.
    #[must_use]
    pub fn lattice_path(&self) -> DrivenPath<'_> {
        DrivenPath {
            energy_j: self.energy_j,
            energy_interval_j: self.energy_interval_j,
            duration_s: self.duration_s,
            distance_m: self.distance_m,
            climb_m: self.climb_m,
            descent_m: self.descent_m,
            recovered_j: self.recovered_j,
            lattice_energy_j: self.energy_j,
            poses: &self.poses,
        }
    }

    /// The refined path where there is one, else that of the lattice.
    #[must_use]
    pub fn followed_path(&self) -> DrivenPath<'_> {
        match &self.refined {
            Some(refined) => DrivenPath {
                energy_j: refined.energy_j,
                energy_interval_j: refined.energy_interval_j,
                duration_s: refined.duration_s,
                distance_m: refined.distance_m,
                climb_m: refined.climb_m,
                descent_m: refined.descent_m,
                recovered_j: refined.recovered_j,
                lattice_energy_j: self.energy_j,
                poses: &refined.poses,
            },
            None => self.lattice_path(),
        }
    }
}

impl CompareAnswer {
    /// What the energy-minimal path saves, as a share of the size of the shortest path's energy, of the paths that are shown.
    #[must_use]
    pub fn followed_saving_fraction(&self) -> f64 {
        self.refined_saving_fraction.unwrap_or(self.saving_fraction)
    }
}
