//! A way to drive with its stops, prepared to be driven a thousand times by robots that differ a little.

use std::collections::{HashMap, hash_map::Entry};

use model::{Grade, Motion, PowerModel, Robot};
use planner::{HiddenRelief, Lattice, Route, Step as PlannedStep, body_motion, hidden_relief};

use crate::Error;

/// Drives and stops in order.
///
/// What the steps of all paths have in common is few: motions and surfaces. They are kept once, and power is prepared once for
/// each.
#[derive(Clone, Debug)]
pub struct Journey {
    pub(crate) model: PowerModel,
    pub(crate) kinds: Vec<StepKind>,
    pub(crate) parts: Vec<Part>,
    /// Surfaces that are driven on.
    pub(crate) surfaces: Vec<String>,
    /// Way of all drives along the ground [m].
    length_m: f64,
}

/// A motion on a surface.
#[derive(Clone, Debug)]
pub(crate) struct StepKind {
    pub(crate) motion: Motion,
    /// Index into the journey's surfaces.
    pub(crate) surface: usize,
}

/// One thing after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Step(Step),
    Stop(Stop),
}

/// A stretch at constant grade, surface and curvature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Index into the journey's kinds.
    pub(crate) kind: usize,
    /// How the ground carries the weight.
    pub(crate) grade: Grade<f64>,
    pub(crate) duration_s: f64,
    /// Its middle, along the ground since the start [m].
    pub(crate) middle_m: f64,
    /// Whether it gets anywhere: turns on the spot do not.
    pub(crate) moves: bool,
    /// Relief that its cell hides; `None` where cells are not far coarser than the robot.
    pub(crate) hidden: Option<HiddenRelief>,
}

/// A stay at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// Work.
    Work {
        /// How long [s].
        duration_s: f64,
        /// Drawn besides the hotel load [W].
        power_w: f64,
    },
    /// A charger.
    Charge {
        /// Charge to reach, 1 full.
        level: f64,
        /// Power of the charger at the battery's terminals, beyond the hotel load [W].
        power_w: f64,
    },
}

impl Journey {
    /// Nothing yet.
    pub fn new(model: PowerModel) -> Self {
        Journey { model, kinds: Vec::new(), parts: Vec::new(), surfaces: Vec::new(), length_m: 0.0 }
    }

    /// Adds a route over a lattice's map, with what the map's cells hide under it.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn drive_route(
        &mut self,
        lattice: &Lattice,
        route: &Route,
        surfaces: &[String],
    ) -> Result<(), Error> {
        let from = self.parts.len();
        self.drive(&lattice.robot, &route.steps, surfaces)?;
        let added = self.parts.iter_mut().skip(from);
        for (part, relief) in added.zip(hidden_relief(route, lattice)) {
            if let Part::Step(step) = part {
                step.hidden = Some(relief);
            }
        }
        Ok(())
    }

    /// Adds the steps of a route; `surfaces` names the surface of each index that they carry.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn drive(&mut self, robot: &Robot, steps: &[PlannedStep], surfaces: &[String]) -> Result<(), Error> {
        self.add(robot, steps, surfaces, |motion| motion)
    }

    /// Adds the steps of a route driven at another speed; arcs are slower where their outer wheels would be too fast.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn drive_at(
        &mut self,
        robot: &Robot,
        steps: &[PlannedStep],
        surfaces: &[String],
        speed_mps: f64,
    ) -> Result<(), Error> {
        self.add(robot, steps, surfaces, |motion| {
            let reverse = motion.speed_mps < 0.0;
            let radius_m = motion.turning_radius_m();
            let radius_m = radius_m.is_finite().then_some(if reverse { -radius_m } else { radius_m });
            let paced = body_motion(robot, speed_mps, radius_m, motion.yaw_rate_radps, reverse);
            Motion { heading_rad: motion.heading_rad, ..paced }
        })
    }

    fn add(
        &mut self,
        robot: &Robot,
        steps: &[PlannedStep],
        surfaces: &[String],
        paced: impl Fn(Motion) -> Motion,
    ) -> Result<(), Error> {
        let mut known = HashMap::new();
        for step in steps {
            let kind = match known.entry((bits(&step.motion), step.surface)) {
                Entry::Occupied(kind) => *kind.get(),
                Entry::Vacant(new) => {
                    let name = surfaces.get(step.surface).unwrap_or(&robot.default_surface);
                    *new.insert(self.kind(robot, paced(step.motion), name)?)
                }
            };
            let motion = &self.kinds[kind].motion;
            let moves = step.motion.speed_mps != 0.0;
            let slower = if moves {
                step.motion.speed_mps / motion.speed_mps
            } else {
                step.motion.yaw_rate_radps / motion.yaw_rate_radps
            };
            self.parts.push(Part::Step(Step {
                kind,
                grade: step.grade,
                duration_s: step.duration_s * slower,
                middle_m: self.length_m + step.length_m / 2.0,
                moves,
                hidden: None,
            }));
            self.length_m += step.length_m;
        }
        Ok(())
    }

    /// Adds a stop.
    pub fn stop(&mut self, stop: Stop) {
        self.parts.push(Part::Stop(stop));
    }

    /// Way of all drives along the ground [m].
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    fn kind(&mut self, robot: &Robot, motion: Motion, name: &str) -> Result<usize, Error> {
        robot.surface(name)?;
        // Only mechanisms ask where the robot heads; without them a motion is the same in all headings.
        let motion = if robot.has_mechanisms() { motion } else { Motion { heading_rad: None, ..motion } };
        let surface = self.surfaces.iter().position(|known| known == name).unwrap_or_else(|| {
            self.surfaces.push(name.to_owned());
            self.surfaces.len() - 1
        });
        let same = |kind: &StepKind| kind.motion == motion && kind.surface == surface;
        Ok(self.kinds.iter().position(same).unwrap_or_else(|| {
            self.kinds.push(StepKind { motion, surface });
            self.kinds.len() - 1
        }))
    }
}

/// A motion as what it can be looked up by.
fn bits(motion: &Motion) -> ([u64; 4], Option<u64>) {
    let Motion { speed_mps, yaw_rate_radps, rim_speeds_mps, heading_rad } = motion;
    let speeds = [*speed_mps, *yaw_rate_radps, rim_speeds_mps.left, rim_speeds_mps.right];
    (speeds.map(f64::to_bits), heading_rad.map(f64::to_bits))
}
