//! Power of many moments at once, by the one function that computes power.

use std::f64::consts::FRAC_PI_2;

use model::{Attitude, Motion, PowerModel, Sides, robot::Surface};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::{prelude::*, types::PyDict};
use rayon::prelude::*;
use serde_json::json;
use service::{Problem, ProblemType};

use crate::{
    computation::{Computation, beside},
    problem::{Failure, internal},
    robot::Robot,
};

/// Moments between two looks for Ctrl-C: some 10 ms of one thread.
const MOMENTS_A_LOOK: usize = 1 << 15;
/// Fewest moments that a thread takes at a time: below that, sharing them out takes longer than they do.
const LEAST_MOMENTS: usize = 1 << 10;
/// Absolute zero [°C].
const LOWEST_C: f64 = -273.15;

/// Inputs by moment, each of one value for all or of as many as there are moments.
struct Inputs<'a> {
    moments: usize,
    columns: [(&'static str, &'a [f64]); 6],
}

/// Power by moment: battery, motor drivers and wheel forces, left and right. The arrays are those of speed, yaw rate, pitch, roll and
/// the temperature of each motor, each of one value or of as many as the others.
#[pyfunction]
pub(crate) fn power<'py>(
    py: Python<'py>,
    robot: &Robot,
    inputs: [PyReadonlyArray1<'py, f64>; 6],
    surface: Option<&str>,
    power_model: &str,
) -> PyResult<Bound<'py, PyDict>> {
    const NAMES: [&str; 6] =
        ["speed_mps", "yaw_rate_radps", "pitch_rad", "roll_rad", "motor_temp_left_c", "motor_temp_right_c"];
    let mut columns = [("", &[][..]); 6];
    for ((column, name), values) in columns.iter_mut().zip(NAMES).zip(&inputs) {
        *column = (name, values.as_slice()?);
    }
    let moments = if columns.iter().any(|(_, values)| values.is_empty()) {
        0
    } else {
        columns.iter().map(|(_, values)| values.len()).max().unwrap_or_default()
    };
    let inputs = Inputs { moments, columns };
    let robot = &robot.robot;
    let powers = beside(py, None, |computation| {
        let model = model_of(power_model)?;
        let name = surface.unwrap_or(&robot.default_surface);
        let surface = robot
            .surface(name)
            .map_err(|error| Problem::new(ProblemType::UnknownSurface, error.to_string()).at("/surface"))?;
        inputs.check()?;
        inputs.powers(model, robot, surface, computation)
    })?;
    let columns = PyDict::new(py);
    let add = |name: &str, value: fn(&model::Power) -> f64| {
        columns.set_item(name, PyArray1::from_iter(py, powers.iter().map(value)))
    };
    add("power_w", |power| power.bus_w)?;
    add("power_left_w", |power| power.side_w.left)?;
    add("power_right_w", |power| power.side_w.right)?;
    add("force_left_n", |power| power.force_n.left)?;
    add("force_right_n", |power| power.force_n.right)?;
    Ok(columns)
}

impl Inputs<'_> {
    fn check(&self) -> Result<(), Failure> {
        for (name, values) in self.columns {
            let refused = |row: usize, class, remedy: &str| {
                let place = if values.len() == 1 { name.to_owned() } else { format!("{name}[{row}]") };
                let detail = format!("{place} is {}: {remedy}", values[row]);
                let problem = Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{name}"));
                Err(Failure::of_class(problem, class))
            };
            if let Some(row) = values.iter().position(|value| !value.is_finite()) {
                return refused(row, "NotANumberError", "give numbers; leave gaps out, or fill them");
            }
            let (least, most, remedy) = match name {
                "pitch_rad" | "roll_rad" => (
                    -FRAC_PI_2,
                    FRAC_PI_2,
                    "it must lie in -1.571 to 1.571; give radians, numpy.radians(x) of degrees",
                ),
                "motor_temp_left_c" | "motor_temp_right_c" => {
                    (LOWEST_C, f64::INFINITY, "it must lie above -273.15; give degrees Celsius")
                }
                _ => continue,
            };
            if let Some(row) = values.iter().position(|value| !(least..=most).contains(value)) {
                return refused(row, "UnitError", remedy);
            }
        }
        Ok(())
    }

    fn powers(
        &self,
        model: PowerModel,
        robot: &model::Robot,
        surface: &Surface,
        computation: &Computation,
    ) -> Result<Vec<model::Power>, Failure> {
        let at = |row: usize| self.columns.map(|(_, values)| values[if values.len() == 1 { 0 } else { row }]);
        let power = |row: usize| {
            let [speed_mps, yaw_rate_radps, pitch_rad, roll_rad, left_c, right_c] = at(row);
            let motion = Motion::of_body(robot, speed_mps, yaw_rate_radps);
            let motors_c = Sides { left: left_c, right: right_c };
            model::power(model, robot, surface, motion, Attitude { pitch_rad, roll_rad }, motors_c)
        };
        let mut powers = Vec::with_capacity(self.moments);
        for from in (0..self.moments).step_by(MOMENTS_A_LOOK) {
            if computation.is_called_off() {
                return Err(internal("called off").into());
            }
            let until = self.moments.min(from + MOMENTS_A_LOOK);
            powers.par_extend((from..until).into_par_iter().with_min_len(LEAST_MOMENTS).map(power));
        }
        Ok(powers)
    }
}

fn model_of(name: &str) -> Result<PowerModel, Problem> {
    serde_json::from_value(json!(name)).map_err(|_| {
        let detail = format!("power_model is {name:?}, but must be \"force-balance\" or \"dogru-marques\"");
        Problem::new(ProblemType::InvalidRequest, detail).at("/power_model")
    })
}
