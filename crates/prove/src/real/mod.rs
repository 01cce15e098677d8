//! The proof on real drives: a robot is fitted on part of the runs of a ground, and known changes are put into the others.
//!
//! Every case is one ground whose runs are split at random into a healthy and a suspect half. A third of the suspect halves stay as they
//! were recorded; some get one known change of a known strength, from the start or from some time on; in some a run goes on over another
//! ground. Names of grounds and runs are taken off, keys are committed to, and the diagnosis runs as it does in the concealed trial.

mod board;
mod change;
mod csv;
mod deal;
mod force;
mod ground;
mod key;
mod peers;
mod reading;
mod score;
mod splice;
mod split;
mod strength;
mod trial;

pub use board::{
    Answers, ChangeRow, GroundRow, OnsetRow, RealBoard, RealBoards, RealPeerRow, RealWayBoard, board,
};
pub use change::{Act, Change, Direction};
pub use deal::{Begins, RealCase, RealKind, STRENGTHS_Z, Wanted, deal};
pub use ground::Ground;
pub use key::{Border, Onset, Put, RealKey};
pub use peers::RealPeerScore;
pub use score::{PLACED_S, RealScore, score};
pub use splice::splice;
pub use split::{Split, split};
pub use strength::{Noise, Strength};
pub use trial::RealTrial;
