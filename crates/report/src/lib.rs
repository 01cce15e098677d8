//! HTML pages of a diagnosis, of a trial's scoreboard, of a prediction and of planned paths.
//!
//! A page is one self-contained document without scripts or outside resources, for light and dark screens and for narrow ones.
//! Everything that is written into it passes one escaper, that of `maud`. The crate computes no result: what a page shows stands
//! in the structures of `diagnosis`, `prove` and `calibration`.

mod axis;
mod bar;
mod diagnosis_page;
mod document;
mod figures;
mod labels;
mod prediction_page;
mod real_scoreboard_page;
mod route_page;
mod scoreboard_page;

pub use diagnosis_page::diagnosis_page;
pub use prediction_page::prediction_page;
pub use real_scoreboard_page::real_scoreboard_page;
pub use route_page::{RoutePage, route_page};
pub use scoreboard_page::scoreboard_page;
