//! Where model and recording differ, which physics was left out, how big it is, and how sure that is.
//!
//! Suspect drives are fitted together with healthy ones, if there are any: what both share is the robot or the model, what only
//! the suspect ones have is looked for among the mechanisms of `model::mechanism`. A mechanism is never judged by whether it
//! lowers the error, which with thousands of correlated rows every term does, but by what it explains beside everything else,
//! by blocks of time, and on drives that were held out.

mod alternatives;
mod as_hard;
mod average;
mod baseline;
mod candidates;
mod channel;
mod chart;
mod climb;
mod constancy;
mod corrected;
mod diagnose;
mod discover;
mod discovered;
mod discrepancy;
mod doubts;
mod edges;
mod error;
mod evidence;
mod explainable;
mod foremost;
mod gates;
mod ground;
mod group;
mod imitate;
mod judged;
mod knobs;
mod linear;
mod locate;
mod manner;
mod meter;
mod misfit;
mod missed;
mod names;
mod needed;
mod next_drive;
mod noise;
mod nuisance;
mod null;
mod off_middle;
mod onset;
mod outside;
mod page;
mod pairs;
mod part;
mod parts;
mod plain;
mod polish;
mod profile;
mod ranked;
mod refitted;
mod refused;
mod regime;
mod region;
pub mod report;
mod sag;
mod search;
mod secant;
mod second_ground;
mod series;
mod shapes;
mod shared;
mod span;
mod term;
mod turning;
mod undoing;
mod usual;
mod visits;
mod weigh;
mod widths;
mod words;

pub use average::{Average, Input};
pub use diagnose::{Question, diagnose, diagnose_watched};
pub use error::Error;
pub use imitate::imitate;
pub use plain::Plain;
pub use refused::Refused;
pub use region::Region;
pub use report::{Diagnosis, Finding, Verdict};
pub use search::{Found, Search, search};
pub use series::{Applied, Series};
pub use span::Span;
