//! Failures as the exceptions of `joulepath.errors`.

use pyo3::prelude::*;
use recording::TimeError;
use service::{Problem, ProblemType};

/// A failure, and the name of its class where its type alone does not tell it.
pub(crate) struct Failure {
    problem: Problem,
    class: Option<&'static str>,
}

impl Failure {
    /// A failure of a class of its own.
    pub(crate) fn of_class(problem: Problem, class: &'static str) -> Self {
        Failure { problem, class: Some(class) }
    }
}

impl From<Problem> for Failure {
    fn from(problem: Problem) -> Self {
        Failure { problem, class: None }
    }
}

/// The exception of a failure, made by the one function of the package that knows the classes.
pub(crate) fn exception(py: Python<'_>, failure: impl Into<Failure>) -> PyErr {
    let Failure { problem, class } = failure.into();
    let text = match serde_json::to_string(&problem) {
        Ok(text) => text,
        Err(error) => return pyo3::exceptions::PyRuntimeError::new_err(error.to_string()),
    };
    let made =
        py.import("joulepath.errors").and_then(|errors| errors.call_method1("from_problem", (text, class)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// A recording that cannot be read.
pub(crate) fn invalid_recording(error: &recording::Error) -> Failure {
    use recording::Error as E;
    let mut cause = error;
    while let E::InFile { source, .. } = cause {
        cause = source;
    }
    let (class, column) = match cause {
        E::Time(TimeError::TimeOrder { .. } | TimeError::RoundedTimes { .. }) => {
            (Some("TimeOrderError"), Some("t_s"))
        }
        E::Time(TimeError::NotSeconds { .. } | TimeError::TypedUnit { .. }) => {
            (Some("UnitError"), Some("t_s"))
        }
        E::Ragged { column, .. } => (Some("RaggedColumnsError"), Some(column.as_str())),
        E::Number { column, .. } => (Some("NotANumberError"), Some(column.as_str())),
        E::Field { field, .. } => (Some("ColumnTypeError"), Some(field.as_str())),
        _ => (None, None),
    };
    let problem = Problem::invalid_recording(error);
    let problem = match column {
        Some(column) => problem.at(document::pointer(column)),
        None => problem,
    };
    Failure { problem, class }
}

/// A request that cannot be read.
pub(crate) fn invalid_request(error: &document::Error) -> Problem {
    let problem = Problem::new(ProblemType::InvalidRequest, error.to_string());
    let pointers = error.mistakes().iter().filter(|mistake| !mistake.pointer.is_empty());
    pointers.fold(problem, |problem, mistake| problem.at(mistake.pointer.clone()))
}

/// A fault of this program, in words.
pub(crate) fn internal(what: impl std::fmt::Display) -> Problem {
    Problem::new(ProblemType::Internal, what.to_string())
}
