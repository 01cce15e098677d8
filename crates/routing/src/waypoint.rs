//! Places of which there are many in a question.

use planner::{Patience, Place, Planner, State};

use crate::error::Error;

/// A place, with the heading that the robot is to have there if it matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// East [m].
    pub x_m: f64,
    /// North [m].
    pub y_m: f64,
    /// Counter-clockwise from east, taken to the nearest of sixteen; `None` leaves it open [rad].
    pub heading_rad: Option<f64>,
}

impl Waypoint {
    /// The poses that stand for it, all in one cell.
    pub(crate) fn states(
        &self,
        planner: &Planner,
        place: Place,
        snap_radius_m: Option<f64>,
        patience: &Patience,
    ) -> Result<Vec<State>, Error> {
        Ok(planner.states_at(place, [self.x_m, self.y_m], self.heading_rad, snap_radius_m, patience)?)
    }
}

/// The poses of all places of a list of the question.
pub(crate) fn states_of(
    planner: &Planner,
    list: &'static str,
    waypoints: &[Waypoint],
    snap_radius_m: Option<f64>,
    patience: &Patience,
) -> Result<Vec<Vec<State>>, Error> {
    let one = |(index, waypoint): (usize, &Waypoint)| {
        waypoint.states(planner, Place::Listed { list, index }, snap_radius_m, patience)
    };
    waypoints.iter().enumerate().map(one).collect()
}
