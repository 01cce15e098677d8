//! What is doubted of a recording of a Husky.

use calibration::{Doubt, doubts};
use model::{Robot, builtin};
use recording::{Recording, unwatched};

pub(crate) fn robot() -> Robot {
    builtin::husky_a200()
}

pub(crate) fn found(recording: &Recording) -> Vec<Doubt> {
    doubts(&robot(), recording, &unwatched()).unwrap()
}

/// The doubt of a name, which has to be the only one.
pub(crate) fn only(recording: &Recording, name: &str) -> Doubt {
    let mut told = found(recording);
    assert!(told.len() == 1 && told[0].name == name, "{name}: {told:?}");
    told.remove(0)
}
