//! Where model and recording differ, which physics was left out, how big it is, and how sure that is.
//!
//! Suspect drives are fitted together with healthy ones, if there are any: what both share is the robot or the model, what only
//! the suspect ones have is looked for among the mechanisms of `model::mechanism`. A mechanism is never judged by whether it
//! lowers the error, which with thousands of correlated rows every term does, but by what it explains beside everything else,
//! by blocks of time, and on drives that were held out.

mod baseline;
mod candidates;
mod error;
mod evidence;
mod knobs;
mod noise;
mod nuisance;
mod plain;
mod search;
mod series;

pub use error::Error;
pub use plain::Plain;
pub use search::{Found, Search, search};
pub use series::{Applied, Average, Input, Series};
