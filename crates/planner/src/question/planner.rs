//! Everything that questions about one map, robot and way of driving can share.

use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::{Arc, Mutex, OnceLock, PoisonError},
    time::Instant,
};

use model::Robot;
use rayon::prelude::*;
use terrain::{CellRange, Terrain};

use crate::{
    error::Error,
    field::fields::{FieldCache, FieldKey},
    frontier::labels::Workspace,
    grid::{heading::Heading, state::State},
    lattice::{
        graph::{Lattice, Settings},
        objective::Objective,
    },
    path::{
        route::{Pose, Route},
        uncertainty::energy_interval_j,
    },
    patience::Patience,
    pose_field::exact::ExactField,
    question::{
        ends::Ends,
        guided::over_bounds_first,
        query::{Comparison, Goal, Plan, Query, SearchReport, Snap, Start},
        relatives::Relatives,
    },
    refinement::refine::RefinedPath,
    search::{astar::Found, changes::Changes},
    table::{cost_table::CostTable, step_costs::StepCosts},
};

/// A planner for a robot on a piece of ground, which remembers what it has worked out: costs of motions, fields of goals
/// that were asked for, and memory to search in. Questions may come from several threads at once.
pub struct Planner {
    lattice: Arc<Lattice>,
    tables: [OnceLock<CostTable>; 3],
    fields: FieldCache,
    relatives: Relatives,
    workspaces: Mutex<Vec<Workspace>>,
}

impl Planner {
    /// Returns a planner, however long its preparation takes.
    ///
    /// # Errors
    /// As [`Planner::prepare`], but for the deadline.
    pub fn new(terrain: &Terrain, robot: &Robot, settings: Settings) -> Result<Self, Error> {
        Self::prepare(terrain, robot, settings, &Patience::default())
    }

    /// Returns a planner with its motions prepared; costs are worked out where and when they are needed.
    ///
    /// # Errors
    /// As [`Lattice::prepare`].
    pub fn prepare(
        terrain: &Terrain,
        robot: &Robot,
        settings: Settings,
        patience: &Patience,
    ) -> Result<Self, Error> {
        Ok(Self::over(Lattice::prepare(terrain, robot, settings, patience)?))
    }

    fn over(lattice: Arc<Lattice>) -> Self {
        Planner {
            lattice,
            tables: [const { OnceLock::new() }; 3],
            fields: FieldCache::default(),
            relatives: Relatives::default(),
            workspaces: Mutex::default(),
        }
    }

    /// A planner for the same robot on ground that differs in some cells; costs that these do not touch are kept, and fields of goals that
    /// were worked out from such costs alone.
    ///
    /// # Errors
    /// As [`Lattice::prepare`].
    pub fn patched(
        &self,
        terrain: &Terrain,
        changed: &CellRange,
        patience: &Patience,
    ) -> Result<Self, Error> {
        let lattice = self.lattice.over(terrain, patience)?;
        if terrain.grid != self.lattice.terrain.grid {
            return Ok(Self::over(lattice));
        }
        let fields = self.fields.kept_where(|objective, tile| {
            self.tables[objective as usize]
                .get()
                .is_some_and(|table| table.is_untouched(tile, &lattice, changed))
        });
        let planner = Planner { fields, ..Self::over(Arc::clone(&lattice)) };
        for (old, new) in self.tables.iter().zip(&planner.tables) {
            if let Some(old) = old.get() {
                let _ = new.set(old.patched(&lattice, changed));
            }
        }
        Ok(planner)
    }

    /// The robot's motions over the ground.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// Costs of all motions under an objective.
    pub fn table(&self, objective: Objective) -> &CostTable {
        self.tables[objective as usize].get_or_init(|| CostTable::lazy(&self.lattice, objective))
    }

    /// Bytes held for further questions, the ground apart.
    pub fn bytes(&self) -> usize {
        let tables = self.tables.iter().filter_map(OnceLock::get).map(CostTable::bytes).sum::<usize>();
        let workspaces = self.workspaces.lock().unwrap_or_else(PoisonError::into_inner);
        tables + self.fields.bytes() + workspaces.iter().map(Workspace::bytes).sum::<usize>()
    }

    /// Finds a path that has least of an objective, or as little as the query's bound asks for.
    ///
    /// The query's settings must be the planner's.
    ///
    /// # Errors
    /// Ends off the map or where the robot cannot stand, no path, or patience that ended before there was one.
    pub fn plan(&self, query: &Query, objective: Objective) -> Result<Plan, Error> {
        let began = Instant::now();
        over_bounds_first(query.bound, |costs| {
            let ends = self.ends_over(query, objective, costs)?;
            let found = self.plan_between(&ends, (query, objective), costs, began);
            self.explained_at_last(found, &ends, (query, objective), costs)
        })
    }

    /// Finds the energy-minimal, shortest and fastest paths, side by side where there are cores.
    ///
    /// # Errors
    /// As [`Planner::plan`].
    pub fn compare(&self, query: &Query) -> Result<Comparison, Error> {
        let began = Instant::now();
        over_bounds_first(query.bound, |costs| {
            let ends = self.ends_over(query, Objective::Energy, costs)?;
            let one = |objective| self.plan_between(&ends, (query, objective), costs, began);
            let (energy, (distance, time)) = rayon::join(
                || one(Objective::Energy),
                || rayon::join(|| one(Objective::Distance), || one(Objective::Time)),
            );
            let energy = self.explained_at_last(energy, &ends, (query, Objective::Energy), costs)?;
            Ok(Comparison { energy, distance: distance?, time: time? })
        })
    }

    /// Explains why there is no path where bounds of costs have not led astray.
    fn explained_at_last(
        &self,
        found: Result<Plan, Error>,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<Plan, Error> {
        match costs {
            StepCosts::Related | StepCosts::Bounds => found,
            StepCosts::Least => found.map_err(|error| self.explained(error, ends, query, objective)),
        }
    }

    /// Answers many questions on all cores, in their order.
    pub fn plan_many(&self, queries: &[Query], objective: Objective) -> Vec<Result<Plan, Error>> {
        queries.par_iter().map(|query| self.plan(query, objective)).collect()
    }

    /// Works out the exact cost to the query's goal from every pose and keeps it, so that any plan to that goal is only a
    /// walk. It takes four bytes for each pose, and less time than a search over the whole map.
    ///
    /// # Errors
    /// As [`Planner::plan`]; the query's start is not looked at.
    pub fn hold_goal(&self, query: &Query, objective: Objective) -> Result<(), Error> {
        let ends = self.ends(query, objective)?;
        let table = self.table(objective);
        let goals = ends.goals_with_potential(&self.lattice, objective);
        let exact = ExactField::to_goals(table, &goals, f64::INFINITY, &query.patience)
            .ok_or(Error::Timeout { expanded: 0 })?;
        self.fields.keep_exact(FieldKey::new(objective, &ends.goals), exact);
        Ok(())
    }

    fn plan_between(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
        began: Instant,
    ) -> Result<Plan, Error> {
        let changes = Changes::of(&self.lattice, objective);
        // A goal that is held knows nothing of changes.
        let walked = if changes.is_none() { self.walk(ends, objective, &query.patience)? } else { None };
        let found = match walked {
            Some(found) => found,
            None => self.search(ends, (query, objective), costs)?,
        };
        if !joins(&self.lattice, &found, &ends.starts, |end| ends.goals.contains(end)) {
            return Err(Error::Untraceable);
        }
        let duration = began.elapsed();
        let path = (found.start, &found.motions[..]);
        let mut route = Route::drive(&self.lattice, objective, path, &query.patience)?;
        if let Some(changes) = &changes {
            changes.charge(&mut route);
        }
        let search = SearchReport::proven(&found, objective, &route.total, duration);
        let mut plan = self.answer(ends, (query, objective), route, search)?;
        // Last: an answer that is there must not be lost to it.
        if query.refine {
            plan.refined = RefinedPath::of(&self.lattice, objective, &plan.route, &query.patience);
        }
        Ok(plan)
    }

    /// Fields of goals that were asked for.
    pub(crate) fn fields(&self) -> &FieldCache {
        &self.fields
    }

    /// The answer that drives chosen motions, each with the variant to drive it in, from a pose between the ends of a
    /// question. It is not refined.
    ///
    /// # Errors
    /// Motions that cannot be driven, or patience that ended on a long path.
    pub fn plan_along(
        &self,
        (ends, query): (&Ends, &Query),
        start: State,
        ways: &[(usize, usize)],
        search: SearchReport,
    ) -> Result<Plan, Error> {
        let ways = ways.iter().map(|&(motion, variant)| (motion, Some(variant)));
        let route = Route::drive_by(&self.lattice, start, ways, |_, _| None, &query.patience)?;
        self.answer(ends, (query, Objective::Energy), route, search)
    }

    /// A path of the lattice as the answer to a question under an objective, with exact ends if it asks for them, not refined.
    fn answer(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        route: Route,
        search: SearchReport,
    ) -> Result<Plan, Error> {
        let lattice = &self.lattice;
        let end = route.poses.last().and_then(|pose| state_of(lattice, pose));
        let goal = end.map_or(0, |end| ends.goal_at(&end));
        let asked = query.goals().nth(goal).unwrap_or(&query.goal);
        let route = match query.exact_ends {
            true => self.with_exact_ends(route, (ends, asked), query, objective),
            false => route,
        };
        let energy_interval_j =
            energy_interval_j(&route, lattice, &query.patience).ok_or(Error::Timeout { expanded: 0 })?;
        Ok(Plan {
            energy_interval_j,
            goal,
            short_of_goal_m: None,
            start_snap: start_snap(&route, &query.start),
            goal_snap: goal_snap(&route, ends, asked),
            route,
            refined: None,
            search,
        })
    }

    /// The way to a goal that is held.
    fn walk(&self, ends: &Ends, objective: Objective, patience: &Patience) -> Result<Option<Found>, Error> {
        let Some(exact) = self.fields.exact(&FieldKey::new(objective, &ends.goals)) else { return Ok(None) };
        let table = self.table(objective);
        let Some((start, motions)) = exact.walk(table, &ends.starts, patience)? else { return Ok(None) };
        let units = exact.units_at(start).unwrap_or(0);
        let least = table.proven(f64::from(units)) + ends.besides(&self.lattice, objective);
        Ok(Some(Found { least, ..Found::along(start, motions) }))
    }

    /// Planners of the same ground whose fields may serve.
    pub(crate) fn relatives(&self) -> &Relatives {
        &self.relatives
    }

    /// The table of an objective if anything was asked under it.
    pub(crate) fn table_at_hand(&self, objective: Objective) -> Option<&CostTable> {
        self.tables[objective as usize].get()
    }

    /// Lends memory to search in, which is kept for the next search.
    pub(crate) fn with_workspace<T>(&self, search: impl FnOnce(&mut Workspace) -> T) -> T {
        let kept = self.workspaces.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut workspace = kept.unwrap_or_else(|| Workspace::of(&self.lattice));
        let outcome = search(&mut workspace);
        self.workspaces.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
        outcome
    }
}

/// Whether a path begins at one of the starts and its motions lead to a goal.
pub(crate) fn joins(
    lattice: &Lattice,
    found: &Found,
    starts: &[State],
    is_goal: impl Fn(&State) -> bool,
) -> bool {
    let end = found.motions.iter().try_fold(found.start, |state, &motion| lattice.successor(state, motion));
    starts.contains(&found.start) && end.is_some_and(|end| is_goal(&end))
}

fn start_snap(route: &Route, start: &Start) -> Snap {
    let first = route.poses.first().map_or((start.x_m, start.y_m, 0.0), |p| (p.x_m, p.y_m, p.heading_rad));
    Snap {
        distance_m: (first.0 - start.x_m).hypot(first.1 - start.y_m),
        turn_rad: start.heading_rad.map_or(0.0, |h| crate::grid::heading::turn_rad(h, first.2)),
    }
}

fn goal_snap(route: &Route, ends: &Ends, goal: &Goal) -> Snap {
    let end = route.poses.last().map_or((goal.x_m, goal.y_m, 0.0), |p| (p.x_m, p.y_m, p.heading_rad));
    let turn = |heading_rad: f64| {
        let turn_rad = crate::grid::heading::turn_rad(heading_rad, end.2);
        let is_opposite = goal.either_way && turn_rad.abs() > FRAC_PI_2;
        if is_opposite { crate::grid::heading::turn_rad(heading_rad + PI, end.2) } else { turn_rad }
    };
    Snap {
        distance_m: (end.0 - goal.x_m).hypot(end.1 - goal.y_m),
        turn_rad: goal.heading_rad.map_or(ends.goal.turn_rad, turn),
    }
}

/// The lattice's pose that a pose at a cell's centre is.
fn state_of(lattice: &Lattice, pose: &Pose) -> Option<State> {
    let cell = lattice.terrain.grid.cell_at(pose.x_m, pose.y_m)?;
    Some(State { cell, heading: Heading::nearest(pose.heading_rad) })
}
