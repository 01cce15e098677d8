//! JSON documents read into types.
//!
//! One place decides which forms are accepted and how a mistake is worded, for requests and files alike:
//!
//! * a struct is written as an object, never as an array of its fields;
//! * a name of an enum without content is written as a string;
//! * no name stands twice in an object;
//! * all missing fields are reported together; of an unknown name the nearest known one is suggested;
//! * a mistake carries its path, and its line and column.
//!
//! ```
//! #[derive(Debug, serde::Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Pose {
//!     x_m: f64,
//!     y_m: f64,
//! }
//!
//! let said = |text: &str| document::from_json::<Pose>(text.as_bytes()).unwrap_err().to_string();
//! assert_eq!(said("{}"), "missing fields `x_m`, `y_m`");
//! assert_eq!(said("[1, 2]"), "expected an object with `x_m`, `y_m`, but found an array (line 1, column 1)");
//! ```

mod access;
mod error;
mod fault;
mod place;
mod placeholder;
mod read;
mod strict;

pub use crate::{
    error::{Error, Mistake},
    place::pointer,
    read::{from_json, from_value},
};
