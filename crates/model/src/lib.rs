//! Friction and power physics of skid-steered wheeled robots.
//!
//! Two forms of the physics of Dogru & Marques, *A Physics-Based Power Model for Skid-Steered Wheeled Mobile
//! Robots* (IEEE T-RO, 2018), behind one function, [`power()`]: the default `force-balance`, continuous over all
//! turning radii, and `dogru-marques`, the paper as printed. Equation numbers in this crate are the paper's.
//!
//! Pure functions, no I/O, no async. SI units; x forward, y left, z up; pitch positive nose-up, roll positive left
//! side up, yaw rate positive turning left; power positive when drawn from the battery.

mod balance;
pub mod builtin;
pub mod data_sheet;
mod elementary;
mod error;
pub mod fit;
mod gravity;
pub mod inversion;
mod kernel;
pub mod knowledge;
mod known;
mod known_limits;
mod lateral;
pub mod least_squares;
pub mod mechanism;
mod motion;
mod motor;
pub mod paper;
mod power;
mod power_bound;
mod prepared;
pub mod robot;
pub mod rolling;
mod sides;
pub mod skid;
pub mod thermal;
pub mod worth;

pub use balance::{Friction, FrictionShape, ShapeLaw};
pub use error::Error;
pub use gravity::{Attitude, Grade, STANDARD_GRAVITY_MPS2};
pub use kernel::{PowerKernel, Real};
pub use known::{KnownMechanism, KnownMechanismFile};
pub use lateral::SidewaysPull;
pub use motion::{Acceleration, Motion};
pub use motor::WarmMotor;
pub use power::{Manoeuvre, Power, PowerModel, power};
pub use power_bound::{LENGTH_PER_SQUARED_GRADE, PowerBound};
pub use prepared::{MomentColumns, PowerColumns, PreparedSurface};
pub use robot::Robot;
pub use sides::Sides;
