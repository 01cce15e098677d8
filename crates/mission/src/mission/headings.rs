//! A chain of places driven with headings that join, the best there are.

use planner::{ExactField, Found, Objective, Patience, Planner, Route, State};

/// The least-energy way through places in order, each given by the poses that stand for it in one cell: one route a leg.
///
/// One exact field a leg, from the last to the first: its goals are the poses of the place with what follows from each, so that
/// headings are chosen for the whole chain and not leg by leg. `Ok(None)` where no chain of motions leads through.
///
/// # Errors
/// Patience that ended first.
pub(crate) fn joined(
    planner: &Planner,
    places: &[Vec<State>],
    patience: &Patience,
) -> Result<Option<Vec<Route>>, planner::Error> {
    let lattice = planner.lattice();
    let table = planner.table(Objective::Energy);
    let Some((last, before)) = places.split_last() else { return Ok(Some(Vec::new())) };
    let mut goals: Vec<(State, f64)> = last.iter().map(|state| (*state, 0.0)).collect();
    let mut fields = Vec::new();
    for place in before.iter().rev() {
        let field = ExactField::to_goals(table, &goals, f64::INFINITY, patience);
        let field = field.ok_or(planner::Error::Timeout { expanded: 0 })?;
        // All poses share a cell, so that heights add the same to each and only differences count.
        let costs: Vec<(State, f64)> =
            place.iter().filter_map(|state| Some((*state, field.cost(*state)?))).collect();
        let least = costs.iter().map(|(_, cost)| *cost).fold(f64::INFINITY, f64::min);
        goals = costs.into_iter().map(|(state, cost)| (state, cost - least)).collect();
        if goals.is_empty() {
            return Ok(None);
        }
        fields.push(field);
    }
    let mut routes = Vec::new();
    let mut starts: Vec<State> =
        goals.into_iter().filter(|(_, after)| *after == 0.0).map(|(s, _)| s).collect();
    for field in fields.iter().rev() {
        let Some((start, motions)) = field.walk(table, &starts, patience)? else { return Ok(None) };
        let end = motions.iter().try_fold(start, |state, motion| lattice.successor(state, *motion));
        let found = Found::along(start, motions);
        routes.push(planner.drive(Objective::Energy, &found, patience)?);
        starts = end.into_iter().collect();
    }
    Ok(Some(routes))
}
