//! Questions of many paths at once, on the motions and costs of the planner: matrices between poses, what a charge reaches,
//! the trade-off between energy, time and distance, and paths within hard limits.
//!
//! No I/O, no async. Answers do not depend on the number of threads.

mod charge;
mod error;
mod joints;
mod matrix;
mod outline;
mod reach;
mod waypoint;

pub use charge::available_j;
pub use error::{Contradiction, Error};
pub use joints::{Joint, Joints, joints};
pub use matrix::{Gap, Matrix, Question, matrix};
pub use outline::{Polygon, outline};
pub use reach::{Kind, Reach, reach};
pub use waypoint::Waypoint;
