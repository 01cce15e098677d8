//! Ends of a question that may be moved: places that are connected are preferred to nearer ones that are not.

use std::sync::Arc;

use crate::{
    error::{Error, Place},
    field::{
        fields::FieldKey,
        goal_field::{FieldEnds, GoalField},
    },
    grid::state::State,
    lattice::objective::Objective,
    question::{
        ends::{Ends, asked_goal, asked_start},
        planner::Planner,
        query::Query,
        snap::{Candidates, Snapped},
    },
    table::step_costs::StepCosts,
};

impl Planner {
    /// Both ends of a question on the lattice: the nearest places where the robot can stand, or, where these are not
    /// connected and may be moved, the connected places within the snap radius that are moved least in sum.
    ///
    /// An end may be moved where the query gives a snap radius, or where the robot cannot stand in its own cell. Where there are
    /// several goals each stays at the place nearest to it, and those where the robot cannot stand do not count. Connected
    /// is what chains of motions join whose headings need not.
    ///
    /// # Errors
    /// Ends off the map or where the robot cannot stand, numbers out of range, or patience that ended.
    pub fn ends(&self, query: &Query, objective: Objective) -> Result<Ends, Error> {
        self.ends_over(query, objective, StepCosts::Least)
    }

    /// The same by a field over what steps are taken to cost: bounds may lead where nothing can be driven.
    pub(crate) fn ends_over(
        &self,
        query: &Query,
        objective: Objective,
        costs: StepCosts,
    ) -> Result<Ends, Error> {
        let ends = Ends::find(self.lattice(), query)?;
        let may_move = |end: &Snapped| query.snap_radius_m.is_some() || !end.is_home;
        let is_only = query.other_goals.is_empty();
        let movable = [is_only && may_move(&ends.start), is_only && may_move(&ends.goal)];
        if movable == [false, false] || self.is_connected(&ends, (query, objective), costs)? {
            return Ok(ends);
        }
        Ok(self.nearest_connected_ends(&ends, movable, query, objective)?.unwrap_or(ends))
    }

    /// Whether the field of the goal, which a search needs too, comes to the start.
    fn is_connected(
        &self,
        ends: &Ends,
        (query, objective): (&Query, Objective),
        costs: StepCosts,
    ) -> Result<bool, Error> {
        let key = FieldKey::new(objective, &ends.goals);
        if let Some(exact) = self.fields().exact(&key) {
            return Ok(ends.starts.iter().any(|start| exact.cost(*start).is_some()));
        }
        let field = self.guide(ends, (query, objective), costs)?;
        Ok(ends.starts.iter().any(|start| field.leads_from_pose(*start)))
    }

    /// The connected ends that are moved least in sum; `None` where there are none within the snap radius.
    fn nearest_connected_ends(
        &self,
        nearest: &Ends,
        [start_may_move, goal_may_move]: [bool; 2],
        query: &Query,
        objective: Objective,
    ) -> Result<Option<Ends>, Error> {
        let lattice = self.lattice();
        let mut starts = match start_may_move {
            true => Offers::further(Candidates::new(lattice, asked_start(lattice, query), &query.patience)?),
            false => Offers::only(nearest.start.clone()),
        };
        let mut goals = match goal_may_move {
            true => Offers::further(Candidates::new(
                lattice,
                asked_goal(lattice, query, (Place::Goal, &query.goal)),
                &query.patience,
            )?),
            false => Offers::only(nearest.goal.clone()),
        };
        let mut best: Option<(f64, Snapped, Snapped)> = None;
        let mut fields: Vec<Arc<GoalField>> = Vec::new();
        while let Some(goal) = goals.next()? {
            if best.as_ref().is_some_and(|(moved_m, ..)| goal.moved_m() >= *moved_m) {
                break;
            }
            // From a goal that leads to an earlier one no start leads that does not lead to that one too.
            if fields.iter().any(|field| goal.states().any(|state| field.leads_from_pose(state))) {
                continue;
            }
            let field = self.field_of(&goal, query, objective)?;
            let most_m = best.as_ref().map_or(f64::INFINITY, |(moved_m, ..)| moved_m - goal.moved_m());
            if let Some(start) = starts.nearest_within(most_m, |state| field.leads_from_pose(state))? {
                best = Some((goal.moved_m() + start.moved_m(), start, goal));
            }
            fields.push(field);
        }
        best.map(|(_, start, goal)| Ends::of(lattice, query, start, goal)).transpose()
    }

    /// The field of a place over all ground that leads to it.
    fn field_of(&self, goal: &Snapped, query: &Query, objective: Objective) -> Result<Arc<GoalField>, Error> {
        let goals: Vec<(State, f64)> = goal.states().map(|state| (state, 0.0)).collect();
        let ends = FieldEnds { goals: &goals, start: None };
        let field = GoalField::new(self.table(objective), ends, &query.patience);
        Ok(Arc::new(field.ok_or(Error::Timeout { expanded: 0 })?))
    }
}

/// Places for one end, the nearest first. Those that were taken from the candidates are kept to be looked at again.
struct Offers<'l> {
    known: Vec<Snapped>,
    further: Option<Candidates<'l>>,
    at: usize,
}

impl<'l> Offers<'l> {
    fn only(place: Snapped) -> Self {
        Offers { known: vec![place], further: None, at: 0 }
    }

    fn further(candidates: Candidates<'l>) -> Self {
        Offers { known: Vec::new(), further: Some(candidates), at: 0 }
    }

    fn get(&mut self, index: usize) -> Result<Option<&Snapped>, Error> {
        if index >= self.known.len()
            && let Some(place) = self.further.as_mut().and_then(Iterator::next)
        {
            self.known.push(place?);
        }
        Ok(self.known.get(index))
    }

    fn next(&mut self) -> Result<Option<Snapped>, Error> {
        let index = self.at;
        self.at += 1;
        Ok(self.get(index)?.cloned())
    }

    /// The first place, moved by less than `most_m`, of which any pose is accepted.
    fn nearest_within(
        &mut self,
        most_m: f64,
        accepts: impl Fn(State) -> bool,
    ) -> Result<Option<Snapped>, Error> {
        let mut index = 0;
        while let Some(place) = self.get(index)?.filter(|place| place.moved_m() < most_m) {
            if place.states().any(&accepts) {
                return Ok(Some(place.clone()));
            }
            index += 1;
        }
        Ok(None)
    }
}
