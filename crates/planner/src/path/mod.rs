//! Path that was found: its poses, its totals, and the interval of its energy.
//! Stops along it, the clearance beside it and the relief that its cells hide are computed here as well.

pub(crate) mod between;
pub(crate) mod coarse;
pub(crate) mod room;
pub(crate) mod route;
pub(crate) mod stops;
pub(crate) mod uncertainty;
pub(crate) mod unlimited;
