//! Prices of changing between driving ahead, backing up and turning on the spot.

use crate::{
    lattice::{
        graph::Lattice,
        objective::{Objective, Surcharge},
        primitive::{Kind, Motion},
        step::Step,
    },
    path::{route::Route, stops::stop_j},
};

/// What the robot did last, as far as the price of what it does next depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Mode {
    /// Nothing yet, or turning on the spot before it drove.
    Standing,
    /// Driving ahead.
    Ahead,
    /// Backing up.
    Astern,
    /// Turning on the spot after driving ahead.
    StoppedAhead,
    /// Turning on the spot after backing up.
    StoppedAstern,
}

/// A stretch by what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Ahead,
    Astern,
    Spin,
}

/// Prices of changes under an objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Changes {
    /// Of a stop on the way.
    stop: Surcharge,
    /// Of a change of direction, beside the stop that it takes.
    direction: Surcharge,
}

impl Mode {
    /// Both marks of what a stretch does next: the mode after it, whether the robot stopped for it, and whether it changed direction.
    pub(crate) fn followed_by(self, way: Way) -> (Mode, bool, bool) {
        use Mode as M;
        match (self, way) {
            (M::Standing, Way::Spin) => (M::Standing, false, false),
            (M::Standing, Way::Ahead) | (M::Ahead, Way::Ahead) => (M::Ahead, false, false),
            (M::Standing, Way::Astern) | (M::Astern, Way::Astern) => (M::Astern, false, false),
            (M::Ahead | M::StoppedAhead, Way::Spin) => (M::StoppedAhead, false, false),
            (M::Astern | M::StoppedAstern, Way::Spin) => (M::StoppedAstern, false, false),
            (M::StoppedAhead, Way::Ahead) => (M::Ahead, true, false),
            (M::StoppedAstern, Way::Astern) => (M::Astern, true, false),
            (M::Ahead | M::StoppedAhead, Way::Astern) => (M::Astern, true, true),
            (M::Astern | M::StoppedAstern, Way::Ahead) => (M::Ahead, true, true),
        }
    }
}

impl Way {
    /// What a motion of the lattice does.
    pub(crate) fn of(motion: &Motion) -> Self {
        match motion.kind {
            Kind::PointTurn { .. } => Way::Spin,
            _ if motion.reverse => Way::Astern,
            _ => Way::Ahead,
        }
    }

    fn of_step(step: &Step) -> Self {
        match step.motion.speed_mps {
            0.0 => Way::Spin,
            speed_mps if speed_mps < 0.0 => Way::Astern,
            _ => Way::Ahead,
        }
    }
}

impl Changes {
    /// The prices of a lattice's settings; `None` where changes cost nothing under the objective.
    pub(crate) fn of(lattice: &Lattice, objective: Objective) -> Option<Self> {
        let (settings, robot) = (&lattice.settings, &lattice.robot);
        let prices = &settings.prices;
        let stop_j = if prices.stops { stop_j(robot, settings.speed_mps) } else { 0.0 };
        let changes = Changes {
            stop: Surcharge { j: stop_j, ..Surcharge::default() },
            direction: Surcharge { j: prices.direction_change_j, m: 0.0, s: prices.direction_change_s },
        };
        let weights = lattice.weights(objective);
        let weighs = |surcharge: &Surcharge| weights.of_surcharge(surcharge) > 0.0;
        (weighs(&changes.stop) || weighs(&changes.direction)).then_some(changes)
    }

    /// What a change adds.
    pub(crate) fn price(&self, stops: bool, turns_back: bool) -> Surcharge {
        let mut price = if stops { self.stop } else { Surcharge::default() };
        if turns_back {
            price.add(&self.direction);
        }
        price
    }

    /// Adds what the changes along a route weigh to its totals.
    pub(crate) fn charge(&self, route: &mut Route) {
        let mut mode = Mode::Standing;
        for step in &route.steps {
            let (next, stops, turns_back) = mode.followed_by(Way::of_step(step));
            route.total.surcharge.add(&self.price(stops, turns_back));
            mode = next;
        }
    }
}
