//! Moving waypoints and widening arcs, one at a time, as long as it pays.

use crate::{
    patience::Patience,
    refinement::{
        connection::{Connection, Waypoint},
        course::{Course, Link, Way},
        free::FreeGround,
        rates::{BENDS, LevelRates, Radii},
        shortcut::best_link,
    },
};

/// First moves of a waypoint, in cells: to the next parallel lattice line is one.
const FIRST_MOVE_CELLS: f64 = 0.5;
/// First turns of a waypoint [rad]: half the widest gap between neighbouring headings.
const FIRST_TURN_RAD: f64 = 0.23;
/// First change of a radius, as a power of two: half a doubling.
const FIRST_DOUBLING: f64 = 0.5;
/// Radii are changed each for itself, and against each other, on courses of no more links; on longer ones only both together. That takes
/// 40 % less time there and finds as much: waypoints are many, and what one radius might gain their moves gain too.
const EVERY_BEND_LINKS: usize = 16;
/// Moves are halved so often: the last is by a thirty-second of a cell.
const HALVINGS: usize = 5;
/// Rounds over the whole course at each size of move.
const ROUNDS: usize = 4;
/// Waypoints are dropped after the first size of move and every other one, the last included.
const DROPS_EVERY: usize = 2;
/// Smallest share of a cost worth a change; less is rounding.
const LEAST_GAIN: f64 = 1e-7;

/// Improves a course in place until moves of the smallest size no longer pay or patience ends.
pub(crate) fn polish(ground: &FreeGround<'_>, rates: &LevelRates, course: &mut Course, patience: &Patience) {
    let mut polish = Polish { ground, rates, course };
    for halving in 0..HALVINGS {
        let size = 0.5f64.powi(halving as i32);
        let mut worth_trying = vec![true; polish.course.links.len()];
        for _ in 0..ROUNDS {
            worth_trying = polish.round(size, &worth_trying, patience);
            if !worth_trying.contains(&true) {
                break;
            }
        }
        if halving % DROPS_EVERY == 0 {
            polish.drop_waypoints(patience);
        }
        if patience.is_over() {
            return;
        }
    }
}

struct Polish<'a, 'l> {
    ground: &'a FreeGround<'l>,
    rates: &'a LevelRates,
    course: &'a mut Course,
}

impl Polish<'_, '_> {
    /// Tries to change the links that are worth it, and the waypoints between them, once; returns those that changed.
    fn round(&mut self, size: f64, worth_trying: &[bool], patience: &Patience) -> Vec<bool> {
        let mut changed = vec![false; worth_trying.len()];
        for i in 0..worth_trying.len() {
            if patience.is_over() {
                break;
            }
            if worth_trying[i] && self.bend(i, size) {
                changed[i] = true;
            }
            if i > 0 && (worth_trying[i - 1] || worth_trying[i]) && self.shift(i, size) {
                (changed[i - 1], changed[i]) = (true, true);
            }
        }
        changed
    }

    /// Tries other radii of a link.
    fn bend(&mut self, i: usize, size: f64) -> bool {
        let (from, to) = (self.course.waypoints[i], self.course.waypoints[i + 1]);
        let doublings = FIRST_DOUBLING * size;
        let ways = if self.course.links.len() <= EVERY_BEND_LINKS { &BENDS[..] } else { &BENDS[..2] };
        let mut better = false;
        for opposite in ways.chunks_exact(2) {
            // Where one way pays, the opposite does not.
            better |=
                opposite.iter().any(|bend| self.try_radii(i, [&from, &to], bend.map(|b| b * doublings)));
        }
        better
    }

    /// Changes a link's radii if that pays.
    fn try_radii(&mut self, i: usize, [from, to]: [&Waypoint; 2], doublings: [f64; 2]) -> bool {
        let Way::Free(connection) = self.course.links[i].way else { return false };
        let bent = connection.bent(doublings, self.rates.tightest_m());
        if bent == connection {
            return false;
        }
        let Some(bent) = self.rates.reworded(&bent, from, to) else { return false };
        match self.ground.cost_below(&bent, [from, to], worth_changing(self.course.links[i].cost)) {
            Some(cost) if self.ground.is_clear(&bent, from, to) => {
                self.course.links[i] = Link { way: Way::Free(bent), cost };
                true
            }
            _ => false,
        }
    }

    /// Tries to move and turn a waypoint.
    fn shift(&mut self, i: usize, size: f64) -> bool {
        let move_m = FIRST_MOVE_CELLS * size * self.ground.lattice.terrain.grid.cell_size_m;
        let turn_rad = FIRST_TURN_RAD * size;
        let mut better = false;
        // Along the path there is little to gain: the links' own curves settle where turns begin.
        for [across_m, turn_rad] in [[move_m, 0.0], [0.0, turn_rad]] {
            for sign in [1.0, -1.0] {
                let here = self.course.waypoints[i];
                let (sin, cos) = here.heading_rad.sin_cos();
                let there = Waypoint {
                    x_m: here.x_m - sign * across_m * sin,
                    y_m: here.y_m + sign * across_m * cos,
                    heading_rad: here.heading_rad + sign * turn_rad,
                };
                if self.try_waypoint(i, there) {
                    better = true;
                    break;
                }
            }
        }
        better
    }

    /// Puts a waypoint elsewhere if that pays.
    fn try_waypoint(&mut self, i: usize, there: Waypoint) -> bool {
        let (from, to) = (self.course.waypoints[i - 1], self.course.waypoints[i + 1]);
        let most = worth_changing(self.course.links[i - 1].cost + self.course.links[i].cost);
        let Some(least_after) = self.ground.least_between(&there, &to) else { return false };
        let Some(before) = self.relinked(i - 1, [&from, &there], most - least_after) else { return false };
        let Some(after) = self.relinked(i, [&there, &to], most - before.1) else { return false };
        if !self.ground.is_clear(&before.0, &from, &there) || !self.ground.is_clear(&after.0, &there, &to) {
            return false;
        }
        self.course.waypoints[i] = there;
        self.course.links[i - 1] = Link { way: Way::Free(before.0), cost: before.1 };
        self.course.links[i] = Link { way: Way::Free(after.0), cost: after.1 };
        true
    }

    /// A link's radii between other ends, or the best ones where it has none or they do not fit, if they cost less than `most`.
    fn relinked(&self, i: usize, [from, to]: [&Waypoint; 2], most: f64) -> Option<(Connection, f64)> {
        let kept = match self.course.links[i].way {
            Way::Free(connection) => self.rates.reworded(&connection, from, to),
            Way::Given(_) => None,
        };
        let connection = kept.or_else(|| self.rates.connections(from, to, Radii::InTurn).first().copied())?;
        Some((connection, self.ground.cost_below(&connection, [from, to], most)?))
    }

    /// Leaves out waypoints where one curve does better than two links.
    fn drop_waypoints(&mut self, patience: &Patience) {
        let mut i = 1;
        while i + 1 < self.course.waypoints.len() && !patience.is_over() {
            let most = worth_changing(self.course.links[i - 1].cost + self.course.links[i].cost);
            let ends = [&self.course.waypoints[i - 1], &self.course.waypoints[i + 1]];
            match best_link(self.ground, self.rates, ends, Radii::InTurn, most) {
                Some(link) => {
                    self.course.waypoints.remove(i);
                    self.course.links.remove(i);
                    self.course.links[i - 1] = link;
                }
                None => i += 1,
            }
        }
    }
}

/// What something else must cost less than to be worth a change.
fn worth_changing(cost: f64) -> f64 {
    cost - LEAST_GAIN * cost.abs()
}
