//! Questions of many paths at once, on the motions and costs of the planner: matrices between poses, what a charge reaches,
//! the trade-off between energy, time and distance, and paths within hard limits.
//!
//! No I/O, no async. Answers do not depend on the number of threads.

mod alternatives;
mod bounded;
mod charge;
mod corridor;
mod error;
mod joints;
mod labels;
mod limits;
mod matrix;
mod multiplier;
mod outline;
mod reach;
mod waypoint;
mod within;

pub use alternatives::{Alternatives, alternatives};
pub use charge::available_j;
pub use error::{Contradiction, Error};
pub use joints::{Joint, Joints, joints};
pub use limits::Limits;
pub use matrix::{Gap, Matrix, Question, matrix};
pub use outline::{Polygon, outline};
pub use reach::{Kind, Reach, reach};
pub use waypoint::Waypoint;
pub use within::plan_within;
