//! The trade-off between energy and time over a map, and what its points take to find.
//!
//!     cargo run --release -p joulepath-routing --example tradeoff [-- MAP [COUNT [SIDE]]]

use std::{
    error::Error,
    path::PathBuf,
    time::{Duration, Instant},
};

use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use routing::{Limits, alternatives, plan_within};
use terrain::io;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let count: usize = arguments.next().map_or(Ok(7), |n| n.parse())?;
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    let [start, goal] =
        [[0.08, 0.12], [0.9, 0.88]].map(|[east, north]| terrain.grid.at_fraction_m(east, north));
    let query = Query {
        start: Start { x_m: start[0], y_m: start[1], heading_rad: None },
        goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(&robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    let [slow, fast] = [Objective::Energy, Objective::Time]
        .map(|objective| planner.plan(&query, objective).map(|plan| plan.route.total.duration_s));
    let (slow_s, fast_s) = (slow?, fast?);
    for share in [0.9, 0.5, 0.1] {
        let most_s = fast_s + share * (slow_s - fast_s);
        let limits = Limits { max_time_s: Some(most_s), ..Limits::default() };
        let began = Instant::now();
        let query = patient(&query);
        let plan = plan_within(&planner, &query, Objective::Energy, &limits)?;
        let total = &plan.route.total;
        println!(
            "at most {most_s:.1} s: {:.2} kJ in {:.1} s, {} labels in {:.2} s, bound {:?}",
            total.energy_j / 1e3,
            total.duration_s,
            plan.search.expanded,
            began.elapsed().as_secs_f64(),
            plan.search.bound
        );
    }
    let began = Instant::now();
    let query = Query { bound: 1.01, ..patient(&query) };
    let found = alternatives(&planner, &query, Objective::Time, &Limits::default(), count)?;
    println!("\n{:>10} {:>9} {:>9} {:>10}", "energy", "time", "length", "labels");
    for plan in &found.plans {
        let total = &plan.route.total;
        println!(
            "{:>7.2} kJ {:>7.1} s {:>7.1} m {:>10}",
            total.energy_j / 1e3,
            total.duration_s,
            total.length_m,
            plan.search.expanded
        );
    }
    println!("{} points in {:.1} s", found.plans.len(), began.elapsed().as_secs_f64());
    Ok(())
}

/// The same question with half a minute from now.
fn patient(query: &Query) -> Query {
    Query { patience: Patience::until(Instant::now() + Duration::from_secs(30)), ..query.clone() }
}
