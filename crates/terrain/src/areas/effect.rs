//! What an area changes.

use serde_json::{Map, Value};

use super::AreaError;

/// What an area changes about the ground and the way over it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// What the ground is made of there: a name that the robot knows.
    pub surface: Option<String>,
    /// Whether no part of the robot may be there.
    pub keep_out: bool,
    /// Highest forward speed there, above 0 [m/s].
    pub max_speed_mps: Option<f64>,
    /// What driving there weighs, in comparison: 2 avoids it as if friction, length and time were twice what they are.
    pub cost_factor: Option<f64>,
    /// The only way to drive there: no more than a quarter turn from this direction, counter-clockwise from east [rad].
    pub one_way_rad: Option<f64>,
}

/// Least cost factor: with less, detours over the area of ten times the length would pay.
const LEAST_COST_FACTOR: f64 = 0.1;
/// Largest cost factor; what is to be avoided more than this is a keep-out.
const LARGEST_COST_FACTOR: f64 = 1000.0;
/// Slowest speed that the planner drives at [m/s].
const LEAST_SPEED_MPS: f64 = 0.001;
/// Fastest speed of an area: no robot on wheels drives faster [m/s].
const LARGEST_SPEED_MPS: f64 = 100.0;
/// Once round, with room for rounding [rad].
const ONCE_ROUND_RAD: f64 = 6.3;

/// Properties that mean something here.
const KNOWN: [&str; 5] = ["surface", "keep_out", "max_speed_mps", "cost_factor", "one_way_rad"];

impl Effect {
    /// Reads a feature's properties; those that mean nothing here are added to `others`.
    pub(super) fn of(
        properties: &Map<String, Value>,
        at: &str,
        others: &mut Vec<String>,
    ) -> Result<Self, AreaError> {
        let number = |name: &str, (least, most): (f64, f64)| match properties.get(name) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => match value.as_f64().filter(|value| (least..=most).contains(value)) {
                Some(value) => Ok(Some(value)),
                None => {
                    let what = format!("is {value}, but must be a number from {least} to {most}");
                    Err(AreaError::new(&format!("{at}.{name}"), what))
                }
            },
        };
        let surface = match properties.get("surface") {
            None | Some(Value::Null) => None,
            Some(Value::String(name)) if !name.is_empty() => Some(name.clone()),
            Some(other) => {
                let what = format!("is {other}, but must be the name of one of the robot's surfaces");
                return Err(AreaError::new(&format!("{at}.surface"), what));
            }
        };
        let keep_out = match properties.get("keep_out") {
            None | Some(Value::Null) => false,
            Some(Value::Bool(keep_out)) => *keep_out,
            Some(other) => {
                let what = format!("is {other}, but must be true or false");
                return Err(AreaError::new(&format!("{at}.keep_out"), what));
            }
        };
        others.extend(properties.keys().filter(|name| !KNOWN.contains(&name.as_str())).cloned());
        Ok(Effect {
            surface,
            keep_out,
            max_speed_mps: number("max_speed_mps", (LEAST_SPEED_MPS, LARGEST_SPEED_MPS))?,
            cost_factor: number("cost_factor", (LEAST_COST_FACTOR, LARGEST_COST_FACTOR))?,
            one_way_rad: number("one_way_rad", (-ONCE_ROUND_RAD, ONCE_ROUND_RAD))?,
        })
    }

    /// Whether it changes anything.
    pub(super) fn is_any(&self) -> bool {
        *self != Effect::default()
    }

    /// Names of what an area may change.
    pub(super) fn known() -> String {
        KNOWN.join(", ")
    }
}
