//! Whether the battery lasts.
pub mod pack;
