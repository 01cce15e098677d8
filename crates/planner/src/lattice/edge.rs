//! What one motion costs on the ground at hand: the edge energy that plan, matrix and reachability share.

use std::sync::Arc;

use model::Manoeuvre;
use terrain::Cell;

use crate::{
    grid::heading::Heading,
    ground::{
        spans::{Span, first_blocked, shifted},
        stance::Offset,
    },
    lattice::{
        graph::Lattice,
        objective::Surcharge,
        step::{Limits, PreparedStep, Step},
    },
};

/// Totals of one motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edge {
    /// Energy drawn from the battery; negative when more came back [J].
    pub energy_j: f64,
    /// Energy that flowed back into the battery, 0 or more [J].
    pub recovered_j: f64,
    /// Time [s].
    pub duration_s: f64,
    /// Length along the ground [m].
    pub length_m: f64,
    /// Height gained on the way up [m].
    pub climb_m: f64,
    /// Height lost on the way down, 0 or more [m].
    pub descent_m: f64,
    /// What preferences add in comparisons: cost factors of areas and prices.
    pub surcharge: Surcharge,
}

impl Edge {
    /// Adds one step.
    pub fn add(&mut self, step: &Step) {
        let energy_j = step.energy_j();
        self.energy_j += energy_j;
        self.recovered_j += (-energy_j).max(0.0);
        self.duration_s += step.duration_s;
        self.length_m += step.length_m;
        self.climb_m += step.rise_m.max(0.0);
        self.descent_m += (-step.rise_m).max(0.0);
        self.surcharge.add(&step.surcharge);
    }
}

/// One way to drive a motion, with everything prepared that does not depend on the cell it starts from.
pub(crate) struct Chain {
    /// Its steps, each with one manoeuvre per kind of ground.
    steps: Vec<(PreparedStep, Vec<Manoeuvre>)>,
    /// The pose in which it ends: the offset of its cell, and its heading.
    end: (Offset, Heading),
    sweep: Arc<[Span]>,
    /// Largest king's distance of a swept cell: with more clearance nothing can be touched.
    reach: u8,
    /// Cells that interpolation reads, as the corners of their bounding box.
    read_from: (i32, i32),
    read_to: (i32, i32),
    reverse: bool,
}

impl Chain {
    /// A chain of prepared steps, each with one manoeuvre per kind of ground, that sweeps some cells about where it starts.
    pub(crate) fn new(steps: Vec<(PreparedStep, Vec<Manoeuvre>)>, reverse: bool, sweep: Arc<[Span]>) -> Self {
        let reach = sweep.iter().map(Span::reach).max().unwrap_or(0);
        let corners = || {
            let read = steps.iter().flat_map(|(s, _)| [s.end.corner, s.end.far_corner(), s.middle]);
            read.chain([(0, 0)])
        };
        let read_from = corners().fold((0, 0), |low, corner| (low.0.min(corner.0), low.1.min(corner.1)));
        let read_to = corners().fold((0, 0), |high, corner| (high.0.max(corner.0), high.1.max(corner.1)));
        let reach = u8::try_from(reach).unwrap_or(u8::MAX);
        let end = steps.last().map_or(((0, 0), Heading::new(0)), |(step, _)| step.end_pose());
        Chain { steps, end, sweep, reach, read_from, read_to, reverse }
    }

    /// The cells it sweeps, as offsets from where it starts.
    pub(crate) fn sweep(&self) -> &Arc<[Span]> {
        &self.sweep
    }

    /// The pose in which it ends, as an offset of cells and a heading.
    pub(crate) fn end(&self) -> (Offset, Heading) {
        self.end
    }

    /// Its steps, each with the manoeuvres on all kinds of ground and whether it is driven backwards.
    pub(crate) fn steps_with_manoeuvres(&self) -> impl Iterator<Item = (&PreparedStep, &[Manoeuvre], bool)> {
        self.steps.iter().map(|(step, manoeuvres)| (step, &manoeuvres[..], self.reverse))
    }

    /// Totals on level ground of the robot's default surface, whatever its limits.
    pub(crate) fn on_level_ground(&self) -> Edge {
        self.on_level(self.classes().saturating_sub(1))
    }

    /// Number of kinds of ground that it is prepared for.
    fn classes(&self) -> usize {
        self.steps.first().map_or(0, |(_, manoeuvres)| manoeuvres.len())
    }

    fn on_level(&self, class: usize) -> Edge {
        let mut total = Edge::default();
        for (step, manoeuvres, reverse) in self.steps_with_manoeuvres() {
            let driven = manoeuvres
                .get(class)
                .and_then(|manoeuvre| step.drive(manoeuvre, 0.0, (0.0, 0.0), reverse, &Limits::NONE, class));
            if let Some(done) = driven {
                total.add(&done);
            }
        }
        total
    }

    /// Totals of driving this from a cell; `None` where ground, obstacles or limits forbid it.
    pub(crate) fn edge(&self, lattice: &Lattice, cell: Cell) -> Option<Edge> {
        let mut total = Edge::default();
        self.drive(lattice, cell, |step| total.add(step))?;
        Some(total)
    }

    /// Whether it would touch blocked ground or the world outside from a cell.
    fn touches(&self, lattice: &Lattice, cell: Cell) -> bool {
        first_blocked(&lattice.clearance, cell, &self.sweep).is_some()
    }

    /// Visits every step of driving this from a cell; `None`, possibly after some visits, where it is forbidden.
    pub(crate) fn drive(&self, lattice: &Lattice, cell: Cell, mut visit: impl FnMut(&Step)) -> Option<()> {
        let terrain = &lattice.terrain;
        let index = terrain.grid.index(cell);
        shifted(terrain, cell, self.read_from)?;
        shifted(terrain, cell, self.read_to)?;
        if lattice.clearance.at(index) <= self.reach && self.touches(lattice, cell) {
            return None;
        }
        let mut height_m = lattice.ground.height_m(terrain, cell);
        for (step, manoeuvres) in &self.steps {
            let manoeuvre_on = |class: usize| &manoeuvres[class];
            let (done, end_m) = step.drive_on(lattice, cell, height_m, self.reverse, manoeuvre_on)?;
            visit(&done);
            height_m = end_m;
        }
        let (end, heading) = self.end;
        (!lattice.ground.touches(terrain, shifted(terrain, cell, end)?, heading)).then_some(())
    }
}
