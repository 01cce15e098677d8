//! What turning costs on level ground, to choose among curves before any is driven.

use model::Acceleration;

use crate::{
    connection::{Connection, Side, WORDS, Waypoint},
    free::FreeGround,
    primitive::Piece,
};

/// Radii double from R' (half the slip track) on; so many doublings reach half a kilometre for a Husky.
const DOUBLINGS: usize = 11;
/// Arcs wider than so many times the distance between two poses hardly differ from the straight.
const WIDEST_PER_DISTANCE: f64 = 16.0;

/// Costs on level ground of the robot's default surface, in the objective's own unit.
pub(crate) struct LevelRates {
    /// 0 for turns on the spot, then R' and its doublings [m].
    radii_m: Vec<f64>,
    /// By direction (forward, reverse).
    directions: Vec<Direction>,
}

struct Direction {
    straight_per_m: f64,
    /// By side and radius: per radian on the spot, else per metre.
    arcs: [Vec<f64>; 2],
}

impl LevelRates {
    pub(crate) fn new(ground: &FreeGround<'_>) -> Self {
        let tightest_m = ground.lattice.robot.half_slip_track_m();
        let doubled = (0..=DOUBLINGS).map(|k| tightest_m * (1u64 << k) as f64);
        let radii_m: Vec<f64> = std::iter::once(0.0).chain(doubled).collect();
        let directions = [false, true]
            .into_iter()
            .filter(|reverse| !reverse || ground.lattice.settings.reverse)
            .map(|reverse| Direction {
                straight_per_m: rate(ground, 1.0, 0.0, reverse),
                arcs: [1.0, -1.0].map(|sign| {
                    radii_m
                        .iter()
                        .map(|&r| rate(ground, r, sign, reverse) / if r > 0.0 { r } else { 1.0 })
                        .collect()
                }),
            })
            .collect();
        LevelRates { radii_m, directions }
    }

    /// Half the slip track [m].
    pub(crate) fn tightest_m(&self) -> f64 {
        self.radii_m[1]
    }

    /// Cost of a connection on level ground; infinite where there is none.
    pub(crate) fn cost(&self, connection: &Connection, from: &Waypoint, to: &Waypoint) -> f64 {
        let Some(shape) = connection.shape(from, to) else { return f64::INFINITY };
        let direction = &self.directions[usize::from(connection.reverse)];
        let arc = |i: usize| {
            let (radius_m, turn_rad) = (connection.radii_m[i], shape.turns_rad[i]);
            let side = if turn_rad >= 0.0 { Side::Left } else { Side::Right };
            turn_rad.abs() * self.per_rad(direction, side, radius_m)
        };
        arc(0) + direction.straight_per_m * shape.straight_m + arc(1)
    }

    /// The cheapest way for two arcs of given radii to bend.
    pub(crate) fn reworded(&self, connection: &Connection, from: &Waypoint, to: &Waypoint) -> Connection {
        let words = WORDS.map(|sides| Connection { sides, ..*connection });
        let cost = |c: &Connection| self.cost(c, from, to);
        words.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(*connection)
    }

    /// Connections between two poses, the cheapest first: one for each way to bend and each direction that exists.
    pub(crate) fn connections(&self, from: &Waypoint, to: &Waypoint, radii: Radii) -> Vec<Connection> {
        let mut found: Vec<(f64, Connection)> = (0..self.directions.len())
            .flat_map(|direction| WORDS.map(|sides| (direction == 1, sides)))
            .filter_map(|(reverse, sides)| self.best_radii(from, to, radii, sides, reverse))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, connection)| connection).collect()
    }

    fn best_radii(
        &self,
        from: &Waypoint,
        to: &Waypoint,
        radii: Radii,
        sides: [Side; 2],
        reverse: bool,
    ) -> Option<(f64, Connection)> {
        let distance_m = (to.x_m - from.x_m).hypot(to.y_m - from.y_m);
        let useful_m = self.tightest_m().max(WIDEST_PER_DISTANCE * distance_m);
        let useful = || self.radii_m.iter().copied().filter(move |r| *r <= useful_m);
        let mut best: Option<(f64, Connection)> = None;
        let mut consider = |radii_m: [f64; 2]| {
            let connection = Connection { radii_m, sides, reverse };
            let cost = self.cost(&connection, from, to);
            if cost < best.map_or(f64::INFINITY, |b| b.0) {
                best = Some((cost, connection));
            }
            best.map_or(radii_m, |b| b.1.radii_m)
        };
        if radii == Radii::EveryPair {
            useful().for_each(|first| useful().for_each(|last| radii_m = consider([first, last])));
            return best;
        }
        let mut radii_m = [0.0; 2];
        useful().for_each(|both| radii_m = consider([both, both]));
        let last_m = radii_m[1];
        useful().for_each(|first_m| radii_m = consider([first_m, last_m]));
        let first_m = radii_m[0];
        useful().for_each(|last_m| radii_m = consider([first_m, last_m]));
        best
    }

    /// Per radian, between the radii of the table in proportion to the doublings.
    fn per_rad(&self, direction: &Direction, side: Side, radius_m: f64) -> f64 {
        let arcs = &direction.arcs[usize::from(side == Side::Right)];
        if radius_m == 0.0 {
            return arcs[0];
        }
        let doublings = (radius_m / self.tightest_m()).log2().clamp(0.0, DOUBLINGS as f64);
        let below = (doublings as usize).min(DOUBLINGS - 1);
        let above = doublings - below as f64;
        radius_m * (arcs[1 + below] * (1.0 - above) + arcs[2 + below] * above)
    }
}

/// How many radii to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Radii {
    /// Equal ones, then the first and the last for themselves.
    InTurn,
    /// All of the first with all of the last.
    EveryPair,
}

/// Cost of a piece by its length, or by its turn on the spot.
fn rate(ground: &FreeGround<'_>, length_m: f64, turn_rad: f64, reverse: bool) -> f64 {
    let piece = Piece { start_m: [0.0, 0.0], heading_rad: 0.0, length_m, turn_rad };
    let surface = ground.lattice.surfaces.len() - 1;
    let manoeuvre = ground.lattice.manoeuvre(&piece, reverse, surface);
    let motion = manoeuvre.motion();
    let duration_s =
        if length_m > 0.0 { length_m / motion.speed_mps.abs() } else { turn_rad / motion.yaw_rate_radps };
    let bus_w = manoeuvre.power_on_grade(1.0, 0.0, Acceleration::NONE).bus_w;
    let weights = ground.weights;
    weights.per_j * bus_w * duration_s + weights.per_m * length_m + weights.per_s * duration_s
}
