//! The concealed trial: does a diagnosis find what was hidden from it, and does it keep quiet where nothing was?
//!
//! Cases are drawn from the independent world. The diagnosis gets recording, robot and reference in a folder that holds nothing
//! else, and runs as a separate process. What is true of a case stands in a key, kept apart, whose SHA-256 is published before
//! the first diagnosis begins; keys are opened after the last one has ended, and one that has changed since is refused.
//!
//! [`real`] is the same on drives of a real robot, into some of which known changes are put.
//!
//! The crate knows the world, how recorded currents stand for forces, and the form of the diagnosis' report, and nothing of how a
//! diagnosis comes about.

mod board;
mod commitment;
mod deal;
mod error;
mod figures;
mod files;
mod key;
mod matching;
mod peer;
mod process;
mod rate;
pub mod real;
mod report;
mod score;
mod sealed;
mod stage;
mod strength;
mod together;
mod trial;
mod way;

pub use board::{Boards, Scoreboard, WayBoard, scoreboard};
pub use commitment::{Commitments, sha256};
pub use deal::{Dealt, SHARES, deal};
pub use error::Error;
pub use figures::{Cell, MechanismRow, OnsetRow, PeerRow, ShareRow, StrengthRow};
pub use files::{CALIBRATED, RECORDING, REFERENCE, ROBOT};
pub use key::{Kind, Parameter, SealedKey, Truth};
pub use peer::{PeerAnswer, PeerScore};
pub use process::{Diagnosis, FileBeside, Outcome};
pub use rate::Rate;
pub use report::{Estimate, Finding, Least, Report, Scope, Verdict};
pub use score::{CaseScore, ParameterScore, TruthScore, Twin, score};
pub use stage::{Progress, Stage};
pub use strength::{Misled, z};
pub use together::together;
pub use trial::Trial;
pub use way::Way;
