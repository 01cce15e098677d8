//! What turning costs on level ground, to choose among curves before any is driven.

use std::f64::consts::FRAC_PI_2;

use model::{Acceleration, Grade};

use crate::{
    lattice::{edge::Edge, objective::Surcharge, primitive::Piece},
    refinement::{
        connection::{Connection, Ends, Shape, Side, WORDS, Waypoint},
        free::FreeGround,
    },
};

/// Radii double from R' (half the slip track) on; so many doublings reach half a kilometre for a Husky.
const DOUBLINGS: usize = 11;
/// Radii of the table within a doubling.
const PER_DOUBLING: usize = 4;
/// Arcs wider than so many times the distance between two poses hardly differ from the straight.
const WIDEST_PER_DISTANCE: f64 = 16.0;

/// Radii are settled when moves by this share of a doubling no longer pay: half a per cent.
const SETTLED_DOUBLINGS: f64 = 1.0 / 128.0;
/// Most moves; a few dozen settle any radii, and more only follow rounding.
const MOST_MOVES: usize = 1000;
/// The cost has valleys along which two arcs just touch; so many of the first radii, each with its best last one, are
/// settled.
const SETTLED_SEEDS: usize = 8;
/// So many of the curves between two poses, the best by level ground, are worth driving: a third one won 0.001 % of the energy of twenty paths.
const DRIVEN: usize = 2;
/// Ways to change two radii, as signs of the powers of two: both together first.
pub(crate) const BENDS: [[f64; 2]; 8] =
    [[1.0, 1.0], [-1.0, -1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];

/// Costs on level ground of the robot's default surface, in the objective's own unit.
pub(crate) struct LevelRates {
    /// 0 for turns on the spot, then from R' on [m].
    radii_m: Vec<f64>,
    /// By direction (forward, reverse).
    directions: Vec<Direction>,
    /// Position of the first radius that may be driven: 1 where the robot may not turn on the spot.
    first: usize,
}

struct Direction {
    straight_per_m: f64,
    /// By side and radius, per radian.
    per_rad: [Vec<f64>; 2],
}

impl LevelRates {
    pub(crate) fn new(ground: &FreeGround<'_>) -> Self {
        let lattice = ground.lattice;
        let tightest_m = lattice.settings.tightest_m(&lattice.robot);
        let within = |k: usize| (k as f64 / PER_DOUBLING as f64).exp2();
        let doubled = (0..=DOUBLINGS * PER_DOUBLING).map(|k| tightest_m * within(k));
        let radii_m: Vec<f64> = std::iter::once(0.0).chain(doubled).collect();
        let directions = [false, true]
            .into_iter()
            .filter(|reverse| !reverse || ground.lattice.settings.reverse)
            .map(|reverse| Direction {
                straight_per_m: rate(ground, 1.0, 0.0, reverse),
                per_rad: [1.0, -1.0]
                    .map(|sign| radii_m.iter().map(|&r| rate(ground, r, sign, reverse)).collect()),
            })
            .collect();
        let first = usize::from(!lattice.settings.spins());
        LevelRates { radii_m, directions, first }
    }

    /// Radius of the tightest arc [m].
    pub(crate) fn tightest_m(&self) -> f64 {
        self.radii_m[1]
    }

    /// Cost of a connection between two poses on level ground; infinite where there is none.
    fn cost_between(&self, connection: &Connection, ends: &Ends) -> f64 {
        let Some(shape) = connection.shape_between(ends) else { return f64::INFINITY };
        let direction = &self.directions[usize::from(connection.reverse)];
        let arc = |i: usize| {
            let (radius_m, turn_rad) = (connection.radii_m[i], shape.turns_rad[i]);
            let side = if turn_rad >= 0.0 { Side::Left } else { Side::Right };
            turn_rad.abs() * self.per_rad(direction, side, radius_m)
        };
        arc(0) + direction.straight_per_m * shape.straight_m + arc(1)
    }

    /// The cheapest way for two arcs of given radii to bend; the one that they have where neither comes round more than a quarter, as
    /// the others have an arc that does or hardly differ. `None` where no straight touches both arcs.
    pub(crate) fn reworded(
        &self,
        connection: &Connection,
        from: &Waypoint,
        to: &Waypoint,
    ) -> Option<Connection> {
        let ends = Ends::new(from, to, connection.reverse);
        let is_flat = |shape: Shape| shape.turns_rad.iter().all(|turn_rad| turn_rad.abs() <= FRAC_PI_2);
        if connection.shape_between(&ends).is_some_and(is_flat) {
            return Some(*connection);
        }
        let words = WORDS.map(|sides| Connection { sides, ..*connection });
        let costs = words.map(|word| (self.cost_between(&word, &ends), word));
        let cheapest = costs.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        cheapest.filter(|(cost, _)| cost.is_finite()).map(|(_, word)| word)
    }

    /// Connections between two poses that are worth driving, each of its own direction and way to bend, the cheapest first.
    pub(crate) fn connections(&self, from: &Waypoint, to: &Waypoint, radii: Radii) -> Vec<Connection> {
        let distance_m = (to.x_m - from.x_m).hypot(to.y_m - from.y_m);
        let useful_m = self.tightest_m().max(WIDEST_PER_DISTANCE * distance_m);
        let useful = self.radii_m.iter().take_while(|r| **r <= useful_m).count();
        let words: Vec<Word<'_>> = (0..self.directions.len())
            .flat_map(|direction| {
                let ends = Ends::new(from, to, direction == 1);
                WORDS.map(|sides| Word { rates: self, useful, ends, sides, reverse: direction == 1 })
            })
            .collect();
        let cheapest_first = |mut found: Vec<(f64, Connection)>| {
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.into_iter().take(DRIVEN).map(|(_, connection)| connection).collect()
        };
        match radii {
            Radii::EveryPair => cheapest_first(words.iter().filter_map(Word::every_pair).collect()),
            Radii::InTurn => {
                let mut equal: Vec<_> =
                    words.iter().filter_map(|word| Some((word, word.equal_radii()?))).collect();
                equal.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
                let best = equal.into_iter().take(DRIVEN);
                cheapest_first(best.filter_map(|(word, (_, [_, last]))| word.in_turn(last)).collect())
            }
        }
    }

    /// The best radii near those of a connection of known cost, by moves of either or both that get smaller.
    fn settled(&self, (mut least, mut best): (f64, Connection), ends: &Ends) -> (f64, Connection) {
        let mut size = 1.0 / PER_DOUBLING as f64;
        for _ in 0..MOST_MOVES {
            if size <= SETTLED_DOUBLINGS {
                break;
            }
            let moved = BENDS.map(|bend| best.bent(bend.map(|way| way * size), self.tightest_m()));
            let cheapest = moved
                .map(|connection| (self.cost_between(&connection, ends), connection))
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match cheapest.filter(|(cost, _)| *cost < least) {
                Some(better) => (least, best) = better,
                None => size /= 2.0,
            }
        }
        (least, best)
    }

    /// Per radian, between the radii of the table in proportion to the doublings.
    fn per_rad(&self, direction: &Direction, side: Side, radius_m: f64) -> f64 {
        let per_rad = &direction.per_rad[usize::from(side == Side::Right)];
        if radius_m == 0.0 {
            return per_rad[0];
        }
        let steps = (DOUBLINGS * PER_DOUBLING) as f64;
        let place = ((radius_m / self.tightest_m()).log2() * PER_DOUBLING as f64).clamp(0.0, steps);
        let below = (place as usize).min(DOUBLINGS * PER_DOUBLING - 1);
        let above = place - below as f64;
        // By the metre the cost changes least from one radius to the next.
        let per_m = |place: usize| per_rad[1 + place] / self.radii_m[1 + place];
        radius_m * (per_m(below) * (1.0 - above) + per_m(below + 1) * above)
    }
}

/// A way to bend from one pose to another.
struct Word<'r> {
    rates: &'r LevelRates,
    /// Number of radii that differ from the straight.
    useful: usize,
    ends: Ends,
    sides: [Side; 2],
    reverse: bool,
}

impl Word<'_> {
    fn connection(&self, radii: [usize; 2]) -> Connection {
        let radii_m = radii.map(|i| self.rates.radii_m[i]);
        Connection { radii_m, sides: self.sides, reverse: self.reverse }
    }

    /// Cost with radii of the table on level ground; infinite where there is none.
    fn cost(&self, radii: [usize; 2]) -> f64 {
        let direction = &self.rates.directions[usize::from(self.reverse)];
        let Some(shape) = self.connection(radii).shape_between(&self.ends) else { return f64::INFINITY };
        let arc = |i: usize| {
            let turn_rad = shape.turns_rad[i];
            turn_rad.abs() * direction.per_rad[usize::from(turn_rad < 0.0)][radii[i]]
        };
        arc(0) + direction.straight_per_m * shape.straight_m + arc(1)
    }

    fn cheapest(&self, candidates: impl Iterator<Item = [usize; 2]>) -> Option<(f64, [usize; 2])> {
        let costs = candidates.map(|radii| (self.cost(radii), radii));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(cost, _)| cost.is_finite())
    }

    /// Positions of 0, R' and its doublings.
    fn doubled(&self) -> impl Iterator<Item = usize> {
        (self.rates.first..1).chain((1..self.useful).step_by(PER_DOUBLING))
    }

    /// The best of two equal radii.
    fn equal_radii(&self) -> Option<(f64, [usize; 2])> {
        self.cheapest(self.doubled().map(|both| [both, both]))
    }

    /// The best first radius with a last one, then the best last radius with that.
    fn in_turn(&self, last: usize) -> Option<(f64, Connection)> {
        let (_, [first, _]) = self.cheapest(self.doubled().map(|first| [first, last]))?;
        let (least, radii) = self.cheapest(self.doubled().map(|last| [first, last]))?;
        Some((least, self.connection(radii)))
    }

    /// The best of all pairs of radii, settled between those of the table.
    fn every_pair(&self) -> Option<(f64, Connection)> {
        let useful = self.rates.first..self.useful;
        let mut seeds: Vec<(f64, [usize; 2])> = useful
            .clone()
            .filter_map(|first| self.cheapest(useful.clone().map(|last| [first, last])))
            .collect();
        seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let settled = seeds.into_iter().take(SETTLED_SEEDS);
        settled
            .map(|(cost, radii)| self.rates.settled((cost, self.connection(radii)), &self.ends))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// How many radii to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Radii {
    /// Equal ones, then the first and the last for themselves, by doublings.
    InTurn,
    /// All of the first with all of the last, four to a doubling.
    EveryPair,
}

/// Cost of a piece by its length, or by its turn on the spot.
fn rate(ground: &FreeGround<'_>, length_m: f64, turn_rad: f64, reverse: bool) -> f64 {
    let piece = Piece { start_m: [0.0, 0.0], heading_rad: 0.0, length_m, turn_rad };
    let class = ground.lattice.classes.list.len() - 1;
    let manoeuvre = ground.manoeuvre(&piece, reverse, f64::NAN, class);
    let motion = manoeuvre.motion();
    let duration_s =
        if length_m > 0.0 { length_m / motion.speed_mps.abs() } else { turn_rad / motion.yaw_rate_radps };
    let bus_w = manoeuvre.power_on_grade(Grade::LEVEL, Acceleration::NONE).bus_w;
    let prices = &ground.lattice.settings.prices;
    let reversed_m = if reverse { length_m } else { 0.0 };
    let spun_rad = if length_m > 0.0 { 0.0 } else { turn_rad.abs() };
    let surcharge = Surcharge {
        j: prices.reverse_j_per_m * reversed_m + prices.spin_j_per_rad * spun_rad,
        m: 0.0,
        s: prices.reverse_s_per_m * reversed_m + prices.spin_s_per_rad * spun_rad,
    };
    ground.weights.of(&Edge {
        energy_j: bus_w * duration_s,
        length_m,
        duration_s,
        surcharge,
        ..Edge::default()
    })
}
