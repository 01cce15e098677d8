//! Exit status of a failed command.

use std::fmt;

use service::{Problem, ProblemType};

/// Wrong input: the message says what, where, and how to mend it.
#[derive(Debug)]
pub(crate) struct BadInput(pub(crate) String);

impl fmt::Display for BadInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}

/// A problem of the engine, as an error of the command line.
#[derive(Debug)]
pub(crate) struct Refused(pub(crate) Problem);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.detail)
    }
}

impl std::error::Error for Refused {}

/// A battery that does not last: an answer, which has been printed, and an exit status of its own.
#[derive(Debug)]
pub(crate) struct OutOfCharge(pub(crate) String);

impl fmt::Display for OutOfCharge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for OutOfCharge {}

/// Exit status after wrong input.
pub(crate) const BAD_INPUT: u8 = 2;

/// 2 for wrong input, 3 for no path, none within limits or out of charge, 1 for anything else.
pub(crate) fn exit_code(error: &anyhow::Error) -> u8 {
    if error.downcast_ref::<BadInput>().is_some() {
        BAD_INPUT
    } else if error.downcast_ref::<OutOfCharge>().is_some() {
        3
    } else if let Some(Refused(problem)) = error.downcast_ref::<Refused>() {
        match problem.kind {
            ProblemType::NoPath | ProblemType::LimitsContradict => 3,
            ProblemType::Timeout | ProblemType::Internal => 1,
            _ => BAD_INPUT,
        }
    } else {
        1
    }
}
