//! Whether a robot gets to a goal, and back, on its charge.

use model::{Robot, robot::Battery};
use planner::{Goal, Objective, Plan, Planner, Pose, Query, Start};

use crate::{
    Error,
    carries::{Carries, farthest, level_m},
    chance::{Chance, Doubt, Drawn},
    error::within,
    journey::Journey,
    likely::{Likely, draws},
    pace::{BestSpeed, best_speed},
    pack::Pack,
    replanned::{Replanned, replanned},
    run::{Conditions, Outcome, Passage},
    turning::{TurningPoint, last_turning_point},
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
    if !question.farthest {
        let way = Way::plan(planner, &question.query, question.back)?;
        return way.judge(planner, question, &drawn, &chance, &conditions, None);
    }
    let level_m = level_m(planner, question, &drawn, &conditions)?;
    let (way, whole_map) = farthest_way(planner, question, &chance, &conditions)?;
    way.judge(planner, question, &drawn, &chance, &conditions, Some(Carries { level_m, whole_map }))
}

/// The way to the farthest place that is reached as the files say, and whether there is none farther.
///
/// Least energies of the lattice tell which places an energy reaches; what the battery gives for them depends on how fast and
/// how warm the robot gets there, so that the energy is brought down until the way holds.
fn farthest_way(
    planner: &Planner,
    question: &Question,
    chance: &Chance,
    conditions: &Conditions,
) -> Result<(Way, bool), Error> {
    /// Ways that are looked at before the nearest found so far has to do.
    const TRIES: usize = 8;
    /// By how much the energy is lowered beyond what the last way lacked.
    const MARGIN: f64 = 0.99;
    let battery_j = (question.charge - conditions.reserve) * chance.pack.full_j();
    let (mut budget_j, mut last) = (battery_j, None);
    for _ in 0..TRIES {
        let Some((goal, whole_map)) = farthest(planner, &question.query, question.back, budget_j)? else {
            break;
        };
        let way = Way::plan(planner, &Query { goal, ..question.query.clone() }, question.back)?;
        let outcome = way.journey.run(chance, conditions, |_| {});
        let succeeds = outcome.succeeds();
        budget_j = MARGIN * budget_j * (1.0 - outcome.missing_j / outcome.energy_j.max(1e-9)).max(0.1);
        last = Some((way, whole_map));
        if succeeds {
            break;
        }
    }
    last.ok_or(Error::NowhereToGo)
}

/// A way there, and back where that was asked for, ready to be driven.
struct Way {
    queries: Vec<Query>,
    plans: Vec<Plan>,
    journey: Journey,
    surfaces: Vec<String>,
}

impl Way {
    fn plan(planner: &Planner, query: &Query, back: bool) -> Result<Self, Error> {
        let lattice = planner.lattice();
        let (mut queries, mut plans) = (vec![query.clone()], vec![planner.plan(query, Objective::Energy)?]);
        if back {
            let home = homeward(query, &plans[0]);
            plans.push(planner.plan(&home, Objective::Energy)?);
            queries.push(home);
        }
        let surfaces = planner::surface_names(lattice);
        let mut journey = Journey::new(lattice.settings.power_model);
        for plan in &plans {
            journey.drive(&lattice.robot, &plan.route.steps, &surfaces)?;
        }
        Ok(Way { queries, plans, journey, surfaces })
    }

    /// Everything about it that a question asks for.
    fn judge(
        self,
        planner: &Planner,
        question: &Question,
        drawn: &Drawn<'_>,
        chance: &Chance,
        conditions: &Conditions,
        carries: Option<Carries>,
    ) -> Result<Range, Error> {
        let Way { queries, plans, journey, surfaces } = self;
        let mut passages = Vec::new();
        let nominal = journey.run(chance, conditions, |passage| passages.push(*passage));
        let outcomes = draws(&journey, drawn, conditions, question.samples);
        let steps: Vec<_> = plans.iter().map(|plan| &plan.route.steps[..]).collect();
        let best_speed = best_speed(drawn.robot, &steps, &surfaces, &journey, chance, conditions)?;
        let patience = &question.query.patience;
        let turning = last_turning_point(planner, &plans[0].route, chance, conditions, patience)?;
        let chances: Vec<Chance> =
            (0..question.replanned as u64).map(|number| drawn.chance(journey.length_m(), number)).collect();
        let replanned = replanned(planner, &queries, &chances, &journey, conditions)?;
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
            reserve: conditions.reserve,
        })
    }
}

/// The question of the way back from where a plan ends to where it begins, in any heading.
fn homeward(query: &Query, out: &Plan) -> Query {
    let place = |pose: Option<&Pose>| pose.map_or([0.0; 2], |p| [p.x_m, p.y_m]);
    let [start, end] = [out.route.poses.first(), out.route.poses.last()];
    let ([x_m, y_m], heading_rad) = (place(end), end.map(|p| p.heading_rad));
    let [home_x_m, home_y_m] = place(start);
    Query {
        start: Start { x_m, y_m, heading_rad },
        goal: Goal { x_m: home_x_m, y_m: home_y_m, heading_rad: None, tolerance_m: 0.0 },
        ..query.clone()
    }
}
