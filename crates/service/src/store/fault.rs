//! What a store's failures mean to who asked.

use std::{error::Error, io};

use super::plain_words::plain_words;
use crate::problem::{Problem, ProblemType};

/// A store that cannot be used now; a full one is the client's to know.
pub(crate) fn cannot(action: &str, error: &(dyn Error + 'static)) -> Problem {
    if is_full(error) {
        return full("the store's disk is full: delete a map or a recording first");
    }
    tracing::error!(error = plain_words(error), "cannot {action} the store");
    let detail = format!("the service cannot {action} its store at the moment: try again in a few seconds");
    Problem::new(ProblemType::StoreUnavailable, detail)
}

/// A store that holds as much as it may.
pub(crate) fn full(detail: impl Into<String>) -> Problem {
    Problem::new(ProblemType::StoreFull, detail)
}

/// Whether somewhere below it is a disk without room.
fn is_full(error: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(error);
    while let Some(error) = cause {
        let kind = error.downcast_ref::<io::Error>().map(io::Error::kind);
        if matches!(kind, Some(io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)) {
            return true;
        }
        cause = error.source();
    }
    false
}
