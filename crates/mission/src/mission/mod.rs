//! Many stops: the best order, the charge on the way and the weakest leg.

mod graph;
mod headings;
mod held_karp;
mod labels;
mod local_search;
mod order;

use std::time::Duration;

use model::PowerModel;
use planner::{Patience, Place, Planner, Route, State};
use routing::Waypoint;

pub use graph::Role;
use graph::{Network, Node, named};
use labels::{Limits, cheapest_within};
use order::{Order, best_order};

use crate::{
    Error,
    chance::{Chance, Doubt, Drawn},
    error::within,
    journey::{Journey, Stop},
    likely::{Likely, draws},
    meter::Meter,
    pack::Pack,
    range::{check_doubt, set_out},
    run::{Conditions, Outcome, Passage},
};

/// Most waypoints of one mission.
pub const MOST_WAYPOINTS: usize = 40;
/// Most waypoints whose order is proven best.
pub const MOST_EXACT: usize = 12;
/// Most chargers of one mission.
pub const MOST_CHARGERS: usize = 8;

/// A place to stop at, and what is done there.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    /// Where.
    pub place: Waypoint,
    /// Work and charging, in order.
    pub stops: Vec<Stop>,
}

/// A mission to plan.
#[derive(Clone, Debug)]
pub struct MissionQuestion {
    /// Where the robot sets out.
    pub start: Waypoint,
    /// What is to be visited.
    pub waypoints: Vec<Site>,
    /// Chargers that may be driven to, as often as it helps.
    pub chargers: Vec<Site>,
    /// Whether the waypoints are to be visited in their own order.
    pub in_order: bool,
    /// Whether the mission ends where it began.
    pub back: bool,
    /// When it has to be over; infinite for never [s].
    pub deadline_s: f64,
    /// Charge when the robot sets out, 1 full.
    pub charge: f64,
    /// Temperature of air and motors when it sets out [°C].
    pub ambient_c: f64,
    /// How uncertain everything is.
    pub doubt: Doubt,
    /// Draws over the plan.
    pub samples: usize,
    /// Which draws.
    pub seed: u64,
    /// How far places may be moved to ground where the robot can stand; `None` means one cell [m].
    pub snap_radius_m: Option<f64>,
    /// When to give up.
    pub patience: Patience,
}

/// A planned mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Mission {
    /// Whether it can be driven within charge and deadline, as the files say.
    pub feasible: bool,
    /// Stops in order, the start first.
    pub calls: Vec<Call>,
    /// Ways between them.
    pub routes: Vec<Route>,
    /// What comes of it as the files say.
    pub nominal: Outcome,
    /// What is likely to come of it.
    pub likely: Likely,
    /// Number of the leg that leaves the least charge above the reserve, from 0.
    pub weakest_leg: usize,
    /// Energy of the ways alone [J].
    pub ways_j: f64,
    /// No order of the waypoints has ways that take less, as long as no charger is driven to [J].
    pub bound_j: f64,
    /// Time for the order itself, energies between stops at hand.
    pub order_time: Duration,
    /// Charge that must stay.
    pub reserve: f64,
}

/// One stop of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Call {
    /// What it is.
    pub role: Role,
    /// East, north and heading.
    pub pose: [f64; 3],
    /// Since the start [s].
    pub arrival_s: f64,
    /// See `arrival_s` [s].
    pub departure_s: f64,
    /// Drawn since the start on arrival [J].
    pub energy_j: f64,
    /// Charge on arrival.
    pub arrival_charge: f64,
    /// Charge on departure.
    pub departure_charge: f64,
}

/// Why a mission cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MissionError {
    /// As for range.
    #[error(transparent)]
    Question(#[from] Error),
    /// What the routing between places says.
    #[error(transparent)]
    Routing(routing::Error),
    /// Too many waypoints or chargers, or none.
    #[error("{count} {list} were given, but a mission takes {least} to {most}: split it")]
    Count {
        /// `waypoints` or `chargers`.
        list: &'static str,
        /// How many.
        count: usize,
        /// Least.
        least: usize,
        /// Most.
        most: usize,
    },
    /// A waypoint that the robot cannot get to.
    #[error("waypoints[{waypoint}] cannot be reached: {reason}")]
    Unreachable {
        /// Its position.
        waypoint: usize,
        /// Why.
        reason: planner::Error,
    },
    /// A waypoint from which the robot cannot get back.
    #[error("from waypoints[{waypoint}] there is no way back: {reason}")]
    NoWayHome {
        /// Its position.
        waypoint: usize,
        /// Why.
        reason: planner::Error,
    },
    /// No chain of motions through all waypoints.
    #[error(
        "no chain of motions leads through all waypoints in any order: allow reverse, or leave headings open"
    )]
    NoChain,
    /// A deadline that no plan can keep.
    #[error(
        "the deadline of {deadline_s} s is too short: the mission takes {least_s:.0} s at least; raise speed_mps or deadline_s, or drop waypoints"
    )]
    DeadlineTooShort {
        /// The deadline [s].
        deadline_s: f64,
        /// Time of the fastest order of the ways at hand, stops included [s].
        least_s: f64,
    },
}

impl From<planner::Error> for MissionError {
    fn from(error: planner::Error) -> Self {
        MissionError::Question(Error::Plan(error))
    }
}

/// Plans a mission.
///
/// The order of least energy is looked for first, by [`MOST_EXACT`] waypoints at most proven. Driven with motors that warm and a
/// battery that sags it may turn out to break the reserve or the deadline; then the order of least energy that keeps both is,
/// with chargers where they help. Where there is none, the first one is the answer, which says what is missing.
///
/// # Errors
/// What cannot be asked: counts, charge, places off the map or unreachable, a deadline that no order keeps.
pub fn mission(planner: &Planner, question: &MissionQuestion) -> Result<Mission, MissionError> {
    let robot = &planner.lattice().robot;
    check(question)?;
    let (battery, conditions) = set_out(robot, question.charge, question.ambient_c)?;
    check_doubt(&question.doubt, question.samples)?;
    let pack = Pack::new(battery, 1.0);
    let nodes = nodes(question);
    let states = states(planner, &nodes, question)?;
    let network =
        Network::new(planner, nodes, &pack, question.charge, &question.patience, question.snap_radius_m)?;
    let order = best_order(planner, &network, &states, question)?;
    refuse_deadline(&network, question, &pack)?;
    let tour = Tour { planner, question, network: &network, states: &states, conditions };
    let chance = Chance::nominal(robot, pack, question.charge);
    let first = tour.drive(&order.nodes, &chance)?.ok_or(MissionError::NoChain)?;
    let driven = if first.keeps(question) { first } else { tour.within_limits(&order, first, &chance)? };
    let drawn =
        Drawn { robot, battery, charge: question.charge, doubt: &question.doubt, seed: question.seed };
    let outcomes = draws(&driven.journey, &drawn, &conditions, question.samples, &question.patience)?;
    Ok(driven.answer(&tour, &order, Likely::of(&outcomes)))
}

fn check(question: &MissionQuestion) -> Result<(), MissionError> {
    for (list, count, least, most) in [
        ("waypoints", question.waypoints.len(), 1, MOST_WAYPOINTS),
        ("chargers", question.chargers.len(), 0, MOST_CHARGERS),
    ] {
        if count < least || count > most {
            return Err(MissionError::Count { list, count, least, most });
        }
    }
    if question.deadline_s != f64::INFINITY {
        within("deadline_s", question.deadline_s, [1e-3, 1e9], "give seconds from setting out")?;
    }
    let sites = question.waypoints.iter().enumerate().map(|(i, site)| ("waypoints", i, site));
    let chargers = question.chargers.iter().enumerate().map(|(i, site)| ("chargers", i, site));
    for (list, i, site) in sites.chain(chargers) {
        for stop in &site.stops {
            match *stop {
                Stop::Work { duration_s, power_w } => {
                    within(format!("{list}[{i}].service_s"), duration_s, [0.0, 1e7], "give seconds")?;
                    within(format!("{list}[{i}].service_power_w"), power_w, [0.0, 1e6], "give watts")?;
                }
                Stop::Charge { level, power_w } => {
                    within(format!("{list}[{i}].level"), level, [0.0, 1.0], "give a fraction, 1 for full")?;
                    within(format!("{list}[{i}].power_w"), power_w, [1e-3, 1e6], "give watts")?;
                }
            }
        }
    }
    Ok(())
}

/// Start, waypoints, home, chargers.
fn nodes(question: &MissionQuestion) -> Vec<Node> {
    let bare = |place: Waypoint| Site { place, stops: Vec::new() };
    let start = Node { role: Role::Start, site: bare(question.start) };
    let waypoints = question.waypoints.iter().enumerate();
    let waypoints = waypoints.map(|(i, site)| Node { role: Role::Waypoint(i), site: site.clone() });
    let open = Waypoint { heading_rad: None, ..question.start };
    let home = question.back.then(|| Node { role: Role::Home, site: bare(open) });
    let chargers = question.chargers.iter().enumerate();
    let chargers = chargers.map(|(i, site)| Node { role: Role::Charger(i), site: site.clone() });
    std::iter::once(start).chain(waypoints).chain(home).chain(chargers).collect()
}

/// The poses that stand for each node.
fn states(
    planner: &Planner,
    nodes: &[Node],
    question: &MissionQuestion,
) -> Result<Vec<Vec<State>>, MissionError> {
    let one = |(index, node): (usize, &Node)| {
        let place = Place::Listed { list: "places", index };
        let Waypoint { x_m, y_m, heading_rad } = node.site.place;
        let found =
            planner.states_at(place, [x_m, y_m], heading_rad, question.snap_radius_m, &question.patience);
        found.map_err(|error| named(nodes, routing::Error::Planner(error)))
    };
    nodes.iter().enumerate().map(one).collect()
}

/// A deadline below the time of the fastest order and of what is done at stops.
fn refuse_deadline(network: &Network, question: &MissionQuestion, pack: &Pack) -> Result<(), MissionError> {
    if question.deadline_s == f64::INFINITY {
        return Ok(());
    }
    let least_s = order::least_driving_s(network, question)?
        + question
            .waypoints
            .iter()
            .flat_map(|site| &site.stops)
            .map(|stop| match *stop {
                Stop::Work { duration_s, .. } => duration_s,
                // It may arrive full.
                Stop::Charge { level, power_w } => pack.charging_time_s(1.0, level, power_w).unwrap_or(0.0),
            })
            .sum::<f64>();
    if least_s > question.deadline_s {
        return Err(MissionError::DeadlineTooShort { deadline_s: question.deadline_s, least_s });
    }
    Ok(())
}

/// What driving an order needs.
struct Tour<'a> {
    planner: &'a Planner,
    question: &'a MissionQuestion,
    network: &'a Network,
    states: &'a [Vec<State>],
    conditions: Conditions,
}

/// An order as it was driven.
struct Driven {
    nodes: Vec<usize>,
    routes: Vec<Route>,
    journey: Journey,
    passages: Vec<Passage>,
    outcome: Outcome,
}

impl Tour<'_> {
    /// Joins headings and drives an order; `None` where no chain of motions leads through.
    fn drive(&self, nodes: &[usize], chance: &Chance) -> Result<Option<Driven>, MissionError> {
        let places: Vec<Vec<State>> = nodes.iter().map(|node| self.states[*node].clone()).collect();
        let Some(routes) = headings::joined(self.planner, &places, &self.question.patience)? else {
            return Ok(None);
        };
        let lattice = self.planner.lattice();
        let surfaces = planner::surface_names(lattice);
        let model: PowerModel = lattice.settings.power_model;
        let mut journey = Journey::new(model);
        for (route, node) in routes.iter().zip(&nodes[1..]) {
            journey.drive_route(lattice, route, &surfaces).map_err(MissionError::Question)?;
            self.network.node(*node).site.stops.iter().for_each(|stop| journey.stop(*stop));
        }
        let mut passages = Vec::new();
        let mut meter = Meter::new(&self.question.patience, "driving the mission");
        let outcome = journey.run(chance, &self.conditions, &mut meter, |passage| passages.push(*passage))?;
        Ok(Some(Driven { nodes: nodes.to_vec(), routes, journey, passages, outcome }))
    }

    /// The cheapest order that keeps reserve and deadline when it is driven; `first` where none was found.
    fn within_limits(&self, order: &Order, first: Driven, chance: &Chance) -> Result<Driven, MissionError> {
        /// How often the charge of ways is corrected by what driving them took.
        const TRIES: usize = 4;
        let question = self.question;
        let mut charge_factor = 1.02;
        let mut meter = Meter::new(&question.patience, "looking for an order within charge and time");
        let exact = !question.in_order && question.waypoints.len() <= MOST_EXACT;
        let waypoints: Vec<usize> = (1..=self.network.waypoints).collect();
        let given: Vec<usize> = order.nodes.iter().copied().filter(|node| waypoints.contains(node)).collect();
        for _ in 0..TRIES {
            let limits = Limits {
                pack: &chance.pack,
                hotel_w: chance.robot.hotel_power_w,
                charge: question.charge,
                reserve: self.conditions.reserve,
                deadline_s: question.deadline_s,
                charge_factor,
            };
            let fixed = (!exact).then_some(&given[..]);
            let Some(nodes) = cheapest_within(self.network, &limits, fixed, &mut meter)? else { break };
            match self.drive(&nodes, chance)? {
                Some(driven) if driven.keeps(question) => return Ok(driven),
                _ => charge_factor *= 1.05,
            }
        }
        Ok(first)
    }
}

impl Driven {
    fn keeps(&self, question: &MissionQuestion) -> bool {
        self.outcome.succeeds() && self.outcome.duration_s <= question.deadline_s
    }

    fn answer(self, tour: &Tour<'_>, order: &Order, likely: Likely) -> Mission {
        let calls = self.calls(tour);
        let margins = calls.iter().skip(1).map(|call| call.arrival_charge);
        let weakest = margins.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(leg, _)| leg);
        Mission {
            feasible: self.keeps(tour.question),
            weakest_leg: weakest,
            ways_j: self.routes.iter().map(|route| route.total.energy_j).sum(),
            bound_j: order.bound_j,
            order_time: order.time,
            calls,
            routes: self.routes,
            nominal: self.outcome,
            likely,
            reserve: tour.conditions.reserve,
        }
    }

    /// When the robot comes to each stop and leaves it, and with what charge.
    fn calls(&self, tour: &Tour<'_>) -> Vec<Call> {
        let pose = |route: &Route, last: bool| {
            let place = if last { route.poses.last() } else { route.poses.first() };
            place.map_or([f64::NAN; 3], |p| [p.x_m, p.y_m, p.heading_rad])
        };
        let mut now = (0.0, 0.0, tour.question.charge);
        let mut calls = vec![Call {
            role: Role::Start,
            pose: self.routes.first().map_or([f64::NAN; 3], |route| pose(route, false)),
            arrival_s: 0.0,
            departure_s: 0.0,
            energy_j: 0.0,
            arrival_charge: now.2,
            departure_charge: now.2,
        }];
        let mut passages = self.passages.iter();
        for (route, &node) in self.routes.iter().zip(&self.nodes[1..]) {
            let node = tour.network.node(node);
            let mut pass = |count: usize| {
                if let Some(p) = passages.by_ref().take(count).last() {
                    now = (p.t_s, p.energy_j, p.charge);
                }
                now
            };
            let (arrival_s, energy_j, arrival_charge) = pass(route.steps.len());
            let (departure_s, _, departure_charge) = pass(node.site.stops.len());
            calls.push(Call {
                role: node.role,
                pose: pose(route, true),
                arrival_s,
                departure_s,
                energy_j,
                arrival_charge: arrival_charge.max(0.0),
                departure_charge: departure_charge.max(0.0),
            });
        }
        calls
    }
}
