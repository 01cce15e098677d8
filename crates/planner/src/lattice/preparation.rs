//! What is worked out of a robot's motions before any ground is looked at.

use std::sync::Arc;

use model::{Manoeuvre, Robot};

use crate::{
    error::Error,
    grid::heading::HEADINGS,
    ground::{footprint::Footprint, spans::Span},
    lattice::{
        edge::Chain,
        graph::{Settings, manoeuvre},
        ground_class::GroundClass,
        primitive::{Motion, Piece},
        step::{STEP_CELLS, prepare_steps},
        swept::sweep,
    },
    patience::{Pacer, Patience, work},
};

/// Most manoeuvres of all steps on all surfaces: a quarter of a gigabyte. A Husky on cells of 0.1 m with ten surfaces has some 50 000.
const MOST_MANOEUVRES: usize = 1 << 20;

/// Preparation of the motions of a robot on cells of one size.
pub(crate) struct Preparation<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) settings: &'a Settings,
    /// Kinds of ground.
    pub(crate) classes: &'a [GroundClass],
    pub(crate) cell_size_m: f64,
    pub(crate) patience: &'a Patience,
}

/// What has been prepared so far, and the look at the clock.
struct Progress<'p> {
    /// Pieces and the cells they sweep.
    sweeps: Vec<(Vec<Piece>, Arc<[Span]>)>,
    pacer: Pacer<'p>,
}

impl Preparation<'_> {
    /// Chains of steps by heading, motion and variant.
    ///
    /// # Errors
    /// Patience that ended, or more manoeuvres than memory should hold.
    pub(crate) fn chains(
        &self,
        motions: &[Vec<Motion>; HEADINGS],
    ) -> Result<[Vec<Vec<Chain>>; HEADINGS], Error> {
        self.check_size(motions)?;
        let mut progress = Progress { sweeps: Vec::new(), pacer: self.patience.pacer() };
        let mut chains = [const { Vec::new() }; HEADINGS];
        for (chains, motions) in chains.iter_mut().zip(motions) {
            for motion in motions {
                let variants =
                    motion.variants.iter().map(|pieces| self.chain(pieces, motion.reverse, &mut progress));
                let variants: Option<Vec<Chain>> = variants.collect();
                chains.push(variants.ok_or(Error::Timeout { expanded: 0 })?);
            }
        }
        Ok(chains)
    }

    /// One way to drive a motion; `None` when patience ends first.
    fn chain(&self, pieces: &[Piece], reverse: bool, progress: &mut Progress<'_>) -> Option<Chain> {
        let mut steps = Vec::new();
        for piece in pieces {
            for step in prepare_steps(piece, reverse, self.cell_size_m, STEP_CELLS) {
                progress.pacer.after(self.classes.len() as u64 * work::MOTION)?;
                let manoeuvres = self.manoeuvres(piece, reverse, step.heading_rad);
                steps.push((step, manoeuvres));
            }
        }
        Some(Chain::new(steps, reverse, self.swept(pieces, progress)?))
    }

    /// The manoeuvres of a piece at a heading, one per kind of ground.
    fn manoeuvres(&self, piece: &Piece, reverse: bool, heading_rad: f64) -> Vec<Manoeuvre> {
        let on = |class| manoeuvre(self.robot, self.settings, (piece, reverse, heading_rad), class);
        self.classes.iter().map(on).collect()
    }

    /// The cells that pieces sweep. A robot that backs along a motion sweeps what one driving forwards along it does.
    fn swept(&self, pieces: &[Piece], progress: &mut Progress<'_>) -> Option<Arc<[Span]>> {
        if let Some((_, spans)) = progress.sweeps.iter().find(|(known, _)| known == pieces) {
            return Some(Arc::clone(spans));
        }
        let spans: Arc<[Span]> =
            sweep(pieces, &Footprint::of(self.robot), self.cell_size_m, &mut progress.pacer)?.into();
        progress.sweeps.push((pieces.to_vec(), Arc::clone(&spans)));
        Some(spans)
    }

    fn check_size(&self, motions: &[Vec<Motion>; HEADINGS]) -> Result<(), Error> {
        let pieces =
            motions.iter().flatten().flat_map(|m| m.variants.iter().flatten().map(|p| (p, m.reverse)));
        let steps: usize =
            pieces.map(|(p, reverse)| prepare_steps(p, reverse, self.cell_size_m, STEP_CELLS).len()).sum();
        let surfaces = self.classes.len();
        if steps * surfaces <= MOST_MANOEUVRES {
            return Ok(());
        }
        let most = MOST_MANOEUVRES / steps;
        Err(Error::TooManySurfaces { surfaces, most, cell_size_m: self.cell_size_m })
    }
}

#[cfg(test)]
mod tests {
    use model::builtin;
    use terrain::areas::Rule;

    use super::*;
    use crate::lattice::primitive::motions;

    #[test]
    fn preparing_a_huge_robot_on_fine_cells_looks_at_the_clock_again_and_again() {
        let mut robot = builtin::husky_a200();
        (robot.wheelbase_m, robot.track_m, robot.slip_track_m) = (1.4, 1.5, 3.0);
        let cell_size_m = 0.05;
        let settings = Settings { reverse: true, ..Settings::of(&robot) };
        let class = GroundClass { surface: robot.surfaces["marble"].clone(), name: 0, rule: Rule::FREE };
        let motions = motions(&robot, cell_size_m, &settings).unwrap();
        let prepared = |patience: Patience| {
            let (patience, meter) = patience.metered();
            let preparation = Preparation {
                robot: &robot,
                settings: &settings,
                classes: std::slice::from_ref(&class),
                cell_size_m,
                patience: &patience,
            };
            (preparation.chains(&motions).map(|_| ()), meter)
        };
        let (outcome, meter) = prepared(Patience::default());
        assert_eq!(outcome, Ok(()));
        let looks = meter.total() / work::LOOK_EVERY;
        assert!(looks > 50 && meter.largest() <= work::MOST_BETWEEN_LOOKS, "{meter:?}");
        for fewer in [0, 1, looks / 2, looks * 8 / 10] {
            let (outcome, meter) = prepared(Patience::for_looks(fewer));
            assert_eq!(outcome, Err(Error::Timeout { expanded: 0 }), "{fewer} of {looks} looks");
            assert!(meter.overrun() <= work::MOST_BETWEEN_LOOKS, "{meter:?}");
        }
    }
}
