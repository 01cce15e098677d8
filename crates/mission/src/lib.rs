//! Whether the battery lasts: range with its uncertainty, the last point to turn back, and the order of waypoints.
//!
//! A [`Journey`] is a way to drive with its stops, prepared from the planner's routes. `Journey::run` drives it with one robot,
//! battery and ground as they may be, a [`Chance`]: power comes from the model's one power function, motors warm on the way
//! (eqs. 7-10), the [`Pack`] drains by Peukert's law and sags. [`range()`] does so a thousand times.
//!
//! Deterministic for any number of threads. No I/O, no async. SI units; charge is a fraction of the capacity, 1 full.

mod carries;
mod chance;
mod error;
mod journey;
mod level;
mod likely;
mod meter;
mod mission;
mod pace;
mod pack;
mod range;
mod replanned;
mod round_trip;
mod run;
mod turning;

pub use carries::Carries;
pub use chance::{Chance, Doubt, Drawn, MODEL_MEAN, MODEL_SIGMA};
pub use error::Error;
pub use journey::{Journey, Stop};
pub use likely::{Likely, Spread, draws};
pub use mission::{
    Call, MOST_CHARGERS, MOST_EXACT, MOST_WAYPOINTS, Mission, MissionError, MissionQuestion, Role, Site,
    mission,
};
pub use pace::BestSpeed;
pub use pack::{Delivery, Pack};
pub use range::{Leg, MOST_SAMPLES, Question, Range, range};
pub use replanned::Replanned;
pub use run::{Conditions, Outcome, Passage, Stall};
pub use turning::TurningPoint;
