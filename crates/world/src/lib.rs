//! A world of its own: a skid-steered robot simulated step by step, with what it conceals kept in a key.
//!
//! It shares no physics with the program that is to see through it: wheels are brushes of rubber, motors are circuits, the
//! battery sags, heat flows between winding and case, and sensors are late, coarse and noisy. A robot file says what a
//! healthy robot is; a [`World`] says where it drives, what its sensors are like and which effects act.
//!
//! ```
//! use world::{Drive, RobotFile, World, simulate};
//! # let robot = world::example_robot();
//! let world = World::from_json(r#"{"terrain": "level", "effects": [{"effect": "payload", "strength": 20, "onset_s": 10}]}"#)?;
//! let drive = Drive::from_json(r#"{"kind": "straight", "duration_s": 20, "seed": 1}"#)?;
//! let log = simulate(&world, &robot, &drive)?;
//! assert_eq!(log.rows.len(), 200);
//! # Ok::<(), world::Error>(())
//! ```

mod battery;
mod case;
mod contact;
mod drive;
mod effect;
mod error;
mod ground;
mod heat;
mod key;
mod ledger;
mod limits;
mod log;
mod motor;
mod observe;
mod pilot;
mod plant;
mod random;
mod robot;
mod sensors;
mod simulate;
mod trace;
mod world;

pub use case::{Case, CaseKind};
pub use drive::{Drive, DriveKind, Waypoint};
pub use effect::{Effect, EffectName, Family, Place, Side};
pub use error::Error;
pub use key::{Key, Truth, TruthParameter};
pub use ledger::Ledger;
pub use log::{Log, Row};
pub use robot::{RobotFile, example_robot};
pub use sensors::{PowerChannels, Sensors};
pub use simulate::{Simulation, simulate, simulate_all, simulate_closely};
pub use trace::Instant;
pub use world::{MapPath, Patch, Relief, Wind, World};
