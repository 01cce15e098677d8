//! Questions of many paths at once, on the motions and costs of the planner: matrices between poses, what a charge reaches,
//! the trade-off between energy, time and distance, and paths within hard limits.
//!
//! No I/O, no async. Answers do not depend on the number of threads.

mod error;
mod joints;
mod matrix;
mod waypoint;

pub use error::Error;
pub use joints::{Joint, Joints, joints};
pub use matrix::{Gap, Matrix, Question, matrix};
pub use waypoint::Waypoint;
