//! Whether a robot gets to a goal, and back, on its charge.

use model::{Robot, robot::Battery};
use planner::{Goal, Objective, Plan, Planner, Pose, Query, Start, State};

use crate::{
    Error,
    carries::{Carries, Reachable},
    chance::{Chance, Doubt, Drawn},
    error::within,
    journey::Journey,
    level::level_m,
    likely::{Likely, draws},
    meter::Meter,
    pace::{BestSpeed, Paced, best_speed},
    pack::Pack,
    replanned::{Anew, Replanned, replanned},
    round_trip::{Homeward, Outward},
    run::{Conditions, Outcome, Passage},
    turning::{TurningPoint, last_turning_point, state_at},
};

/// Most draws of one question.
pub const MOST_SAMPLES: usize = 100_000;
/// Most draws that are planned anew.
const MOST_REPLANNED: usize = 100;

/// A question about range.
#[derive(Clone, Debug)]
pub struct Question {
    /// From where to where and how; its settings must be the planner's. Its goal is not looked at where `farthest` is set.
    pub query: Query,
    /// Whether the goal is the farthest place that the charge reaches.
    pub farthest: bool,
    /// Whether the way back to the start is part of it.
    pub back: bool,
    /// Charge when it sets out, 1 full.
    pub charge: f64,
    /// Air and motors when it sets out.
    pub ambient_c: f64,
    /// How uncertain everything is.
    pub doubt: Doubt,
    /// Draws over the fixed path.
    pub samples: usize,
    /// Draws that are planned anew, of those.
    pub replanned: usize,
    /// Which draws.
    pub seed: u64,
}

/// One way there, or back.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// The path.
    pub plan: Plan,
    /// Its poses as they were passed, as the files say: charge, voltage and temperatures at each.
    pub passages: Vec<Passage>,
}

/// The answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// What is likely to come of it.
    pub likely: Likely,
    /// Energy as planned: the sum of the paths' edges, motors as warm as when it sets out and every joule taken back [J].
    pub planned_j: f64,
    /// The same with motors that warm on the way and a battery that takes what it can, as the files say.
    pub nominal: Outcome,
    /// There, and back where that was asked for.
    pub legs: Vec<Leg>,
    /// The last point of the way there from which turning back still works; `None` where there is none.
    pub turning: Option<TurningPoint>,
    /// The best speed.
    pub best_speed: BestSpeed,
    /// Draws planned anew.
    pub replanned: Option<Replanned>,
    /// How far the charge carries, where no goal was named.
    pub carries: Option<Carries>,
    /// Charge when it sets out.
    pub charge: f64,
    /// Charge that must stay.
    pub reserve: f64,
}

/// Battery and conditions of a robot that sets out with a charge.
///
/// # Errors
/// No battery, a charge outside 0 to 1 or one that the reserve takes up, an air temperature that cannot be.
pub(crate) fn set_out(robot: &Robot, charge: f64, ambient_c: f64) -> Result<(&Battery, Conditions), Error> {
    let battery = robot.battery.as_ref().ok_or(Error::NoBattery)?;
    within("charge", charge, [0.0, 1.0], "give a fraction, 1 for a full battery")?;
    within("ambient_c", ambient_c, [-60.0, 80.0], "give degrees Celsius")?;
    let reserve = battery.reserve_fraction;
    if reserve >= charge {
        return Err(Error::ReserveAboveCharge { charge, reserve });
    }
    Ok((battery, Conditions { ambient_c, motor_c: ambient_c, reserve }))
}

/// Checks what concerns draws.
pub(crate) fn check_doubt(doubt: &Doubt, samples: usize) -> Result<(), Error> {
    within("samples", samples as f64, [1.0, MOST_SAMPLES as f64], "a thousand tell a quantile well")?;
    within("elevation_sigma_m", doubt.elevation_sigma_m, [0.0, 100.0], "give metres")?;
    within("elevation_scale_m", doubt.elevation_scale_m, [0.01, 1e6], "give metres")
}

/// Answers a question about range.
///
/// # Errors
/// What cannot be asked, and what the planner says of start and goal. A battery that does not suffice is an answer.
pub fn range(planner: &Planner, question: &Question) -> Result<Range, Error> {
    let robot = &planner.lattice().robot;
    let (battery, conditions) = set_out(robot, question.charge, question.ambient_c)?;
    check_doubt(&question.doubt, question.samples)?;
    within(
        "replanned",
        question.replanned as f64,
        [0.0, MOST_REPLANNED as f64],
        "each is a plan of its own",
    )?;
    let drawn =
        Drawn { robot, battery, charge: question.charge, doubt: &question.doubt, seed: question.seed };
    let chance = Chance::nominal(robot, Pack::new(battery, 1.0), question.charge);
    let asked = Asked { planner, question, drawn, chance, conditions };
    if !question.farthest {
        let way = Way::plan(planner, &question.query, question.back)?;
        return asked.judge(way, None, None);
    }
    let patience = &question.query.patience;
    let level_m = level_m(planner.lattice(), &asked.drawn, &asked.conditions, question.samples, patience)?;
    let reachable = Reachable::new(planner, &question.query, question.back)?;
    let (way, whole_map) = asked.farthest_way(&reachable)?;
    asked.judge(way, reachable.homeward, Some(Carries { level_m, whole_map }))
}

/// A question with what its answers are made of.
struct Asked<'a> {
    planner: &'a Planner,
    question: &'a Question,
    drawn: Drawn<'a>,
    /// Everything as the files say.
    chance: Chance,
    conditions: Conditions,
}

impl<'a> Asked<'a> {
    /// The way to the farthest place that is reached as the files say, and whether there is none farther.
    ///
    /// Least energies of the lattice tell which places an energy reaches; what the battery gives for them depends on how fast and
    /// how warm the robot gets there, so that the energy is brought down until the way holds.
    fn farthest_way(&self, reachable: &Reachable<'_>) -> Result<(Way, bool), Error> {
        /// Ways that are looked at before the nearest found so far has to do.
        const TRIES: usize = 8;
        /// By how much the energy is lowered beyond what the last way lacked.
        const MARGIN: f64 = 0.99;
        let Asked { planner, question, chance, conditions, .. } = self;
        let mut meter = Meter::new(&question.query.patience, "driving to the farthest place");
        let battery_j = (question.charge - conditions.reserve) * chance.pack.full_j();
        let (mut budget_j, mut last) = (battery_j, None);
        for _ in 0..TRIES {
            let Some((goal, whole_map)) = reachable.farthest(planner, budget_j) else { break };
            let query = Query { goal, ..question.query.clone() };
            let out = planner.plan(&query, Objective::Energy)?;
            let way = Way::along(planner, query, out, question.back)?;
            let outcome = way.journey.run(chance, conditions, &mut meter, |_| {})?;
            let succeeds = outcome.succeeds();
            budget_j = MARGIN * budget_j * (1.0 - outcome.missing_j / outcome.energy_j.max(1e-9)).max(0.1);
            last = Some((way, whole_map));
            if succeeds {
                break;
            }
        }
        last.ok_or(Error::NowhereToGo)
    }

    /// Everything about a way that the question asks for; `homeward` where it is known already.
    fn judge(
        &self,
        way: Way,
        homeward: Option<Homeward<'a>>,
        carries: Option<Carries>,
    ) -> Result<Range, Error> {
        let Asked { planner, question, drawn, chance, conditions } = self;
        let Way { queries, plans, journey, surfaces } = way;
        let patience = &question.query.patience;
        let mut passages = Vec::new();
        let mut meter = Meter::new(patience, "driving the way");
        let nominal = journey.run(chance, conditions, &mut meter, |passage| passages.push(*passage))?;
        let outcomes = draws(&journey, drawn, conditions, question.samples, patience)?;
        let drives: Vec<_> = plans.iter().map(|plan| &plan.route.steps[..]).collect();
        let paced = Paced { robot: drawn.robot, drives: &drives, surfaces: &surfaces, journey: &journey };
        let best_speed = best_speed(&paced, chance, conditions, patience)?;
        let out = &plans[0].route;
        let homeward = match homeward {
            Some(homeward) => homeward,
            None => Homeward::new(planner, start_of(planner, &plans[0])?.cell, patience)?,
        };
        let turning = last_turning_point(planner, (out, &homeward), chance, conditions, patience)?;
        let anew = Anew { planner, queries: &queries, fixed: &journey, drawn, conditions };
        let replanned = replanned(&anew, question.replanned, patience)?;
        let planned_j = plans.iter().map(|plan| plan.route.total.energy_j).sum();
        let mut left = passages.into_iter();
        let leg = |plan: Plan| Leg { passages: left.by_ref().take(plan.route.steps.len()).collect(), plan };
        Ok(Range {
            likely: Likely::of(&outcomes),
            planned_j,
            nominal,
            legs: plans.into_iter().map(leg).collect(),
            turning,
            best_speed,
            replanned,
            carries,
            charge: question.charge,
            reserve: conditions.reserve,
        })
    }
}

/// A way there, and back where that was asked for, ready to be driven.
struct Way {
    queries: Vec<Query>,
    plans: Vec<Plan>,
    journey: Journey,
    surfaces: Vec<String>,
}

impl Way {
    /// The way of least energy, there and back together.
    fn plan(planner: &Planner, query: &Query, back: bool) -> Result<Self, Error> {
        let out = planner.plan(query, Objective::Energy)?;
        if !back {
            return Self::along(planner, query.clone(), out, false);
        }
        let homeward = Homeward::new(planner, start_of(planner, &out)?.cell, &query.patience)?;
        match turned(planner, query, &out, &homeward)? {
            None => Self::along(planner, query.clone(), out, true),
            Some(goal) => {
                let query = Query { goal, ..query.clone() };
                let out = planner.plan(&query, Objective::Energy)?;
                Self::along(planner, query, out, true)
            }
        }
    }

    /// A way there, and home from where it ends.
    fn along(planner: &Planner, query: Query, out: Plan, back: bool) -> Result<Self, Error> {
        let lattice = planner.lattice();
        let home = back.then(|| homeward(&query, &out));
        let (mut queries, mut plans) = (vec![query], vec![out]);
        if let Some(home) = home {
            plans.push(planner.plan(&home, Objective::Energy)?);
            queries.push(home);
        }
        let surfaces = planner::surface_names(lattice);
        let mut journey = Journey::new(lattice.settings.power_model);
        for plan in &plans {
            journey.drive_route(lattice, &plan.route, &surfaces)?;
        }
        Ok(Way { queries, plans, journey, surfaces })
    }
}

/// The pose that a plan begins in.
fn start_of(planner: &Planner, plan: &Plan) -> Result<State, Error> {
    state_at(planner.lattice(), &plan.route, 0).ok_or(Error::NowhereToGo)
}

/// The goal in the heading that a way there has to end in, so that there and back together take least; `None` where the plan ends
/// in it.
///
/// # Errors
/// A goal that no way leads back from, or patience that ends first.
fn turned(
    planner: &Planner,
    query: &Query,
    out: &Plan,
    homeward: &Homeward<'_>,
) -> Result<Option<Goal>, Error> {
    let lattice = planner.lattice();
    let ends = planner.ends(query, Objective::Energy)?;
    let least_j = ends.goals.iter().filter_map(|goal| homeward.energy_j(*goal)).min_by(f64::total_cmp);
    let Goal { x_m, y_m, .. } = query.goal;
    let least_j = least_j.ok_or(Error::NoWayBack { x_m, y_m })?;
    let end = state_at(lattice, &out.route, out.route.poses.len().saturating_sub(1));
    // Where nothing is nearer home than the end of the best way there, both together are best.
    if end.and_then(|end| homeward.energy_j(end)).is_some_and(|home_j| home_j <= least_j) {
        return Ok(None);
    }
    let home = start_of(planner, out)?.cell;
    let outward = Outward::new(planner, &ends.starts, home, &query.patience)?;
    let joined = outward.best_of(ends.goals.iter().copied(), Some(homeward));
    let (state, _) = joined.ok_or(Error::NoWayBack { x_m, y_m })?;
    let [x_m, y_m] = lattice.terrain.grid.center_m(state.cell);
    Ok(Some(Goal {
        x_m,
        y_m,
        heading_rad: Some(state.heading.angle_rad()),
        either_way: false,
        tolerance_m: 0.0,
    }))
}

/// The question of the way back from where a plan ends to where it begins, in any heading.
fn homeward(query: &Query, out: &Plan) -> Query {
    let place = |pose: Option<&Pose>| pose.map_or([0.0; 2], |p| [p.x_m, p.y_m]);
    let [start, end] = [out.route.poses.first(), out.route.poses.last()];
    let ([x_m, y_m], heading_rad) = (place(end), end.map(|p| p.heading_rad));
    let [home_x_m, home_y_m] = place(start);
    Query {
        start: Start { x_m, y_m, heading_rad },
        goal: Goal { x_m: home_x_m, y_m: home_y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        ..query.clone()
    }
}
