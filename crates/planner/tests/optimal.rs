//! The planner's paths are the best there are, by other people's algorithms on the explicit graph.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use model::{PowerModel, Robot, STANDARD_GRAVITY_MPS2, builtin};
use petgraph::{
    algo::{bellman_ford, dijkstra},
    graph::NodeIndex,
};
use planner::{
    CostTable, Error, FieldEnds, GoalField, HEADINGS, Heading, Lattice, Objective, Outcome, Patience, Prices,
    Query, Search, Settings, State, Workspace, plan, search,
};
use rand::{Rng, RngExt};
use serde_json::json;
use terrain::{Cell, Grid, Terrain, areas::Areas};

mod ground;

/// The lattice poses that a query's ends stand for, found without the planner's own snapping: only queries whose
/// ends need none are compared.
fn plain_ends(lattice: &Lattice, query: &planner::Query) -> Option<(Vec<usize>, Vec<usize>)> {
    let grid = &lattice.terrain.grid;
    let standing = |x: f64, y: f64, heading: Option<f64>| -> Vec<usize> {
        let cell = grid.cell_at(x, y).unwrap();
        let wanted = heading.map(Heading::nearest);
        let all = Heading::all().filter(|h| wanted.is_none_or(|w| w == *h));
        all.map(|heading| State { cell, heading })
            .filter(|s| lattice.stand(*s).is_ok())
            .map(|s| lattice.index(s))
            .collect()
    };
    let starts = standing(query.start.x_m, query.start.y_m, query.start.heading_rad);
    let mut goals = standing(query.goal.x_m, query.goal.y_m, query.goal.heading_rad);
    if starts.is_empty() || goals.is_empty() {
        return None;
    }
    for index in 0..grid.cells() {
        let [x, y] = grid.center_m(grid.cell(index));
        if (x - query.goal.x_m).hypot(y - query.goal.y_m) <= query.goal.tolerance_m {
            goals.extend(standing(x, y, query.goal.heading_rad));
        }
    }
    Some((starts, goals))
}

#[test]
fn the_best_path_equals_petgraphs_dijkstra_on_hundreds_of_random_maps() {
    let mut random = ground::random(20);
    let (mut compared, mut reached) = (0, 0);
    while compared < 240 {
        let terrain = ground::small_terrain(&mut random, 9);
        let regeneration = [0.0, 0.5, 1.0][compared % 3];
        let robot = ground::some_robot(&mut random, regeneration);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Distance, Objective::Time][compared % 4];
        let Some(is_reached) = is_best(&terrain, &robot, &query, objective) else { continue };
        compared += 1;
        reached += usize::from(is_reached);
    }
    assert!(reached > 120, "only {reached} of {compared} maps had a path to compare");
}

#[test]
fn the_best_path_is_so_too_where_cells_are_small_and_the_body_may_touch_the_ground() {
    let mut random = ground::random(22);
    let (mut compared, mut reached) = (0, 0);
    while compared < 24 {
        let terrain = ground::rough_terrain(&mut random, 22);
        let robot = ground::some_robot(&mut random, [0.0, 1.0][compared % 2]);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let Some(is_reached) = is_best(&terrain, &robot, &query, Objective::Energy) else { continue };
        compared += 1;
        reached += usize::from(is_reached);
    }
    assert!(reached > 8 && reached < compared, "{reached} of {compared} maps had a path");
}

/// Ground with a few areas over it: rectangles and lines of every effect.
fn with_areas(random: &mut impl Rng, terrain: Terrain) -> Terrain {
    let features: Vec<_> = (0..random.random_range(1..5))
        .map(|_| {
            let mut place = || {
                terrain.grid.at_fraction_m(random.random_range(0.0..1.0), random.random_range(0.0..1.0))
            };
            let ([ax, ay], [bx, by]) = (place(), place());
            let geometry = match random.random_bool(0.7) {
                true => json!({"type": "Polygon", "coordinates": [[[ax, ay], [bx, ay], [bx, by], [ax, by], [ax, ay]]]}),
                false => json!({"type": "LineString", "coordinates": [[ax, ay], [bx, by]]}),
            };
            let properties = match random.random_range(0..6) {
                0 => json!({"surface": "sandy_loam"}),
                1 => json!({"max_speed_mps": random.random_range(0.1..0.6)}),
                2 => json!({"cost_factor": random.random_range(0.1..8.0)}),
                3 => json!({"cost_factor": 2.5, "surface": "sandy_loam", "max_speed_mps": 0.3}),
                4 => json!({"one_way_rad": random.random_range(-3.1..3.1)}),
                _ => json!({"keep_out": ax + ay > bx + by, "cost_factor": 1.5}),
            };
            json!({"type": "Feature", "geometry": geometry, "properties": properties})
        })
        .collect();
    let areas = Areas::of(&json!({"type": "FeatureCollection", "features": features}), &terrain).unwrap();
    terrain.with_areas(areas)
}

/// Settings with some prices and bans.
fn with_preferences(random: &mut impl Rng, settings: Settings) -> Settings {
    let prices = Prices {
        reverse_j_per_m: random.random_range(0.0..200.0),
        reverse_s_per_m: random.random_range(0.0..5.0),
        spin_j_per_rad: random.random_range(0.0..200.0),
        spin_s_per_rad: random.random_range(0.0..5.0),
        ..Prices::default()
    };
    Settings {
        prices: if random.random_bool(0.7) { prices } else { Prices::default() },
        spin: random.random_bool(0.7),
        least_radius_m: if random.random_bool(0.2) { 1.2 } else { 0.0 },
        ..settings
    }
}

#[test]
fn the_best_path_is_so_too_with_areas_prices_and_bans() {
    let mut random = ground::random(23);
    let (mut compared, mut reached) = (0, 0);
    while compared < 240 {
        let terrain = ground::small_terrain(&mut random, 9);
        let terrain = with_areas(&mut random, terrain);
        let robot = ground::some_robot(&mut random, [0.0, 1.0][compared % 2]);
        let mut query = ground::some_query(&mut random, &terrain, &robot);
        query.settings = with_preferences(&mut random, query.settings);
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Distance, Objective::Time][compared % 4];
        let Some(is_reached) = is_best(&terrain, &robot, &query, objective) else { continue };
        compared += 1;
        reached += usize::from(is_reached);
    }
    assert!(reached > 80, "only {reached} of {compared} maps had a path to compare");
}

/// Whether there is a path, and that it is the best; `None` where the robot stands at neither end.
fn is_best(terrain: &Terrain, robot: &Robot, query: &Query, objective: Objective) -> Option<bool> {
    let lattice = Lattice::new(terrain, robot, query.settings).unwrap();
    let (starts, goals) = plain_ends(&lattice, query)?;
    let graph = ground::explicit_graph(&lattice, objective);
    let potential_j = |state: usize| match objective {
        Objective::Energy => lattice.potential_j(lattice.state(state).cell),
        _ => 0.0,
    };
    let mut best = f64::INFINITY;
    for &start in &starts {
        let reached = dijkstra(&graph, NodeIndex::new(start), None, |e| e.weight().0);
        for &goal in &goals {
            if let Some(cost) = reached.get(&NodeIndex::new(goal)) {
                best = best.min(cost + potential_j(goal) - potential_j(start));
            }
        }
    }
    match plan(terrain, robot, query, objective) {
        Ok(found) => {
            let total = &found.route.total;
            let cost = objective.compared(total);
            // The table rounds costs, which are energies without lifting, up by at most its rounding.
            let rise_m = total.climb_m - total.descent_m;
            let lifted_j = lattice.kappa() * robot.mass_kg * STANDARD_GRAVITY_MPS2 * rise_m;
            let paid = if objective == Objective::Energy { best - lifted_j } else { best };
            let room = paid * CostTable::LARGEST_ROUNDING + 1e-3 * paid.min(1.0);
            assert!(cost <= best + room + 2e-3, "{objective:?}: {cost}, but the best is {best}");
            assert!(cost >= best - 2e-3, "{objective:?}: {cost} beats the best, {best}");
            Some(true)
        }
        Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. }) => {
            assert!(best.is_infinite(), "there is a path of cost {best}");
            Some(false)
        }
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn the_least_energy_equals_bellman_fords_on_energies_that_may_be_negative() {
    let mut random = ground::random(21);
    let (mut compared, mut negative) = (0, 0);
    while compared < 12 {
        let terrain = ground::small_terrain(&mut random, 6);
        let robot = ground::some_robot(&mut random, 1.0);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let lattice = Lattice::new(&terrain, &robot, query.settings).unwrap();
        let Some((starts, goals)) = plain_ends(&lattice, &query) else { continue };
        let Ok(found) = plan(&terrain, &robot, &query, Objective::Energy) else { continue };
        compared += 1;
        let graph = ground::explicit_graph(&lattice, Objective::Energy).map(|_, ()| (), |_, w| w.1);
        negative += graph.edge_weights().filter(|w| **w < 0.0).count();
        let best = starts
            .iter()
            .map(|&start| {
                let paths = bellman_ford(&graph, NodeIndex::new(start)).expect("no cycle may create energy");
                goals.iter().map(|&goal| paths.distances[goal]).fold(f64::INFINITY, f64::min)
            })
            .fold(f64::INFINITY, f64::min);
        let energy_j = found.route.total.energy_j;
        assert!(
            (energy_j - best).abs() < 1e-5 * (best.abs() + 100.0),
            "{energy_j} J, but the best is {best} J"
        );
    }
    assert!(negative > 100, "the maps must have descents that return energy, {negative} had");
}

#[test]
fn the_field_never_exceeds_the_true_cost_and_never_drops_by_more_than_a_motion_costs() {
    let mut random = ground::random(22);
    let mut ended_early = 0;
    for case in 0..24 {
        let terrain = ground::small_terrain(&mut random, if case % 2 == 1 { 100 } else { 8 });
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][case % 3]);
        let mut settings = planner::Settings::of(&robot);
        settings.speed_mps = random.random_range(0.1..1.0);
        let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
        let objective = [Objective::Energy, Objective::Distance, Objective::Time][case / 2 % 3];
        let table = CostTable::new(&lattice, objective, &Patience::default()).unwrap();
        let goal = random.random_range(0..terrain.grid.cells());
        // Every heading, one or a few, which do not cost the same.
        let headings: Vec<Heading> = Heading::all().take([HEADINGS, 1, 3][case / 2 % 5 % 3]).collect();
        let poses = |cell| headings.iter().map(move |heading| State { cell, heading: *heading });
        let goals: Vec<(State, f64)> =
            poses(terrain.grid.cell(goal)).map(|goal| (goal, 3.0 * goal.heading.index() as f64)).collect();
        // Half of the fields end early, soon after one cell.
        let near = |goal: usize| goal.saturating_sub(5);
        let start = terrain.grid.cell(near(goal));
        let ends = FieldEnds { goals: &goals, start: if case % 2 == 0 { None } else { Some(start) } };
        let field = GoalField::new(&table, ends, &Patience::default()).unwrap();
        let mut graph = ground::table_graph(&lattice, &table);
        graph.reverse();
        let mut truth = vec![f64::INFINITY; lattice.states()];
        for (goal, after) in &goals {
            let from = NodeIndex::new(lattice.index(*goal));
            for (node, cost) in dijkstra(&graph, from, None, |e| *e.weight()) {
                truth[node.index()] = truth[node.index()].min(cost + after);
            }
        }
        let whole = GoalField::new(&table, FieldEnds { start: None, ..ends }, &Patience::default()).unwrap();
        let states = || (0..lattice.states()).map(|i| lattice.state(i));
        ended_early += usize::from(states().any(|state| field.at(state) < whole.at(state)));
        for (state, truth) in truth.iter().enumerate() {
            let bound = field.at(lattice.state(state));
            assert!(bound <= truth * (1.0 + 1e-6) + 1e-6, "state {state}: bound {bound} above {truth}");
            for motion in 0..lattice.motions_per_state() {
                let cost = table.cost(lattice.state(state), motion);
                let Some(next) = lattice.successor(lattice.state(state), motion) else { continue };
                let next_bound = field.at(next);
                assert!(bound <= cost + next_bound + 1e-9, "the bound drops faster than the cost");
            }
        }
    }
    assert!(ended_early >= 2, "fields must end early in some cases, {ended_early} did");
}

#[test]
fn the_whole_field_is_everywhere_the_least_of_a_motion_and_the_field_at_its_end() {
    let mut random = ground::random(24);
    for case in 0..6 {
        let terrain = ground::small_terrain(&mut random, 150);
        let mut robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][case % 3]);
        // Arcs that lead into the next tile but one.
        if case % 2 == 1 {
            robot.slip_track_m = 100.0;
        }
        let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        let table = CostTable::new(&lattice, Objective::Energy, &Patience::default()).unwrap();
        let goal = terrain.grid.cell(random.random_range(0..terrain.grid.cells()));
        let goals: Vec<(State, f64)> =
            Heading::all().map(|h| (State { cell: goal, heading: h }, 0.0)).collect();
        let ends = FieldEnds { goals: &goals, start: None };
        let field = GoalField::new(&table, ends, &Patience::default()).unwrap();
        let at = |cell| field.at(State { cell, heading: Heading::new(0) });
        for cell in (0..terrain.grid.cells()).map(|i| terrain.grid.cell(i)).filter(|cell| *cell != goal) {
            let ways = Heading::all().flat_map(|heading| {
                let state = State { cell, heading };
                let (lattice, table) = (&lattice, &table);
                (0..lattice.motions_per_state()).filter_map(move |motion| {
                    let next = lattice.successor(state, motion).filter(|next| next.cell != cell)?;
                    Some(table.cost(state, motion) + at(next.cell))
                })
            });
            let (least, held) = (ways.fold(f64::INFINITY, f64::min), at(cell));
            assert!(held == least || (held - least).abs() < 1e-6 * least, "{cell:?}: {held}, not {least}");
        }
    }
}

#[test]
fn the_table_holds_each_motions_own_cost_rounded_up_by_less_than_its_rounding() {
    let mut random = ground::random(23);
    for case in 0..30 {
        let terrain = ground::small_terrain(&mut random, 70);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][case % 3]);
        let mut settings = Settings::of(&robot);
        settings.reverse = case % 2 == 1;
        settings.power_model = [PowerModel::ForceBalance, PowerModel::DogruMarques][case % 5 / 4];
        let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
        let objective = [Objective::Energy, Objective::Distance, Objective::Time][case / 10];
        let table = CostTable::new(&lattice, objective, &Patience::default()).unwrap();
        let mut forbidden_differently = 0;
        for _ in 0..5000 {
            let state = lattice.state(random.random_range(0..lattice.states()));
            let motion = random.random_range(0..lattice.motions_per_state());
            let held = table.cost(state, motion);
            let lifted_j = lattice
                .successor(state, motion)
                .map_or(0.0, |end| lattice.potential_j(end.cell) - lattice.potential_j(state.cell));
            let own = lattice
                .variants(state.cell, state.heading, motion)
                .flatten()
                .map(|edge| lattice.cost(objective, &edge, lifted_j))
                .fold(f64::INFINITY, f64::min);
            if held.is_infinite() != own.is_infinite() {
                // A motion within single precision of a limit may fall on either side of it.
                forbidden_differently += 1;
            } else if own.is_finite() {
                // One unit of the table, and the error of single precision.
                let unit = if objective == Objective::Energy { 2.5e-3 } else { 5e-5 };
                let single = 3e-5 * own + unit;
                assert!(held >= own - single, "{held} for {own}");
                assert!(held <= own * (1.0 + CostTable::LARGEST_ROUNDING) + single, "{held} for {own}");
            }
        }
        assert!(forbidden_differently <= 5, "{forbidden_differently} of 5000");
    }
}

#[test]
fn a_turn_at_the_goal_hardly_costs_a_search_more_than_any_heading_there() {
    let grid = Grid { rows: 200, columns: 200, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let level = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let robot = builtin::husky_a200();
    let lattice = Lattice::new(&level, &robot, Settings::of(&robot)).unwrap();
    let table = CostTable::lazy(&lattice, Objective::Energy);
    let cell = |column| Cell { row: 100, column };
    let starts = [State { cell: cell(80), heading: Heading::new(0) }];
    let patience = Patience::default();
    let expanded = |headings: &[Heading]| {
        let goals: Vec<(State, f64)> =
            headings.iter().map(|heading| (State { cell: cell(120), heading: *heading }, 0.0)).collect();
        let ends = FieldEnds { goals: &goals, start: Some(cell(80)) };
        let field = GoalField::new(&table, ends, &patience).unwrap();
        let query = Search { starts: &starts, goals: &goals, besides: 0.0, bound: 1.0, patience: &patience };
        match search(&table, &field, &query, &mut Workspace::of(&lattice)) {
            Outcome::Found(found) => found.expanded,
            other => panic!("{other:?}"),
        }
    };
    let all: Vec<Heading> = Heading::all().collect();
    let open = expanded(&all);
    for heading in all {
        // Without the turn worked out beforehand it would be up to two hundred times as many.
        let fixed = expanded(&[heading]);
        assert!(fixed <= 8 * open, "{fixed} expansions for {heading:?}, {open} for any heading");
    }
}
