//! The native half of the Python package `joulepath`: what computes.
//!
//! Requests are the JSON documents of the HTTP API and answers are too, by the functions that the service answers with; numbers by
//! row or by pose are numpy arrays. What Python people see of it is written in Python, in `python/joulepath`.

// Arguments come out of Python by value.
#![allow(clippy::needless_pass_by_value)]

mod command;
mod computation;
mod data_sheet;
mod diagnosis;
mod map;
mod path;
mod planner;
mod power;
mod problem;
mod recording;
mod robot;
mod simulation;
mod table;

#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        command::command,
        data_sheet::robot_of_data_sheet,
        diagnosis::{Diagnosed, Predicted, calibrate, diagnose, predict},
        map::Map,
        path::Path,
        planner::Planner,
        power::power,
        recording::Recording,
        robot::Robot,
        simulation::simulate,
    };
}
