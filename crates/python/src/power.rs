//! Power of many moments at once, by the one function that computes power.

use std::f64::consts::FRAC_PI_2;

use model::{MomentColumns, PowerColumns, PowerModel, PreparedSurface, Sides};
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

/// Moments that a thread takes at a time and between two looks for Ctrl-C: a millisecond of it.
const MOMENTS_A_LOOK: usize = 1 << 14;
/// Values that are looked through before it is asked whether one was wrong, so that they are compared side by side.
const VALUES_A_LOOK: usize = 1 << 12;
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
    let [bus_w, left_w, right_w, left_n, right_n] = beside(py, None, |computation| {
        let model = model_of(power_model)?;
        let name = surface.unwrap_or(&robot.default_surface);
        let surface = robot
            .surface(name)
            .map_err(|error| Problem::new(ProblemType::UnknownSurface, error.to_string()).at("/surface"))?;
        inputs.check()?;
        inputs.powers(&PreparedSurface::new(model, robot, surface), computation)
    })?;
    let columns = PyDict::new(py);
    for (name, values) in [
        ("power_w", bus_w),
        ("power_left_w", left_w),
        ("power_right_w", right_w),
        ("force_left_n", left_n),
        ("force_right_n", right_n),
    ] {
        columns.set_item(name, PyArray1::from_vec(py, values))?;
    }
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
            if let Some(row) = first_without(values, |value| value.is_finite()) {
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
            if let Some(row) = first_without(values, |value| least <= value && value <= most) {
                return refused(row, "UnitError", remedy);
            }
        }
        Ok(())
    }

    /// By moment: battery, motor drivers and wheel forces, left and right.
    fn powers(
        &self,
        prepared: &PreparedSurface<'_>,
        computation: &Computation,
    ) -> Result<[Vec<f64>; 5], Failure> {
        let [speed_mps, yaw_rate_radps, pitch_rad, roll_rad, left_c, right_c] =
            self.columns.map(|(_, values)| values);
        let moments = MomentColumns {
            speed_mps,
            yaw_rate_radps,
            pitch_rad,
            roll_rad,
            motor_temperature_c: Sides { left: left_c, right: right_c },
        };
        let mut columns = [const { Vec::new() }; 5].map(|_: Vec<f64>| vec![0.0; self.moments]);
        let [bus_w, left_w, right_w, left_n, right_n] =
            columns.each_mut().map(|column| column.par_chunks_mut(MOMENTS_A_LOOK));
        bus_w.zip(left_w).zip(right_w).zip(left_n).zip(right_n).enumerate().try_for_each(
            |(piece, ((((bus_w, left_w), right_w), left_n), right_n))| {
                if computation.is_called_off() {
                    return Err(Failure::from(internal("called off")));
                }
                let (side_w, force_n) =
                    (Sides { left: left_w, right: right_w }, Sides { left: left_n, right: right_n });
                prepared.powers(&moments, piece * MOMENTS_A_LOOK, PowerColumns { bus_w, side_w, force_n });
                Ok(())
            },
        )?;
        Ok(columns)
    }
}

/// Place of the first value that is not right.
fn first_without(values: &[f64], is_right: impl Fn(f64) -> bool) -> Option<usize> {
    let wrong = |piece: &[f64]| !piece.iter().fold(true, |right, value| right & is_right(*value));
    let piece = values.chunks(VALUES_A_LOOK).position(wrong)?;
    let from = piece * VALUES_A_LOOK;
    values[from..].iter().position(|value| !is_right(*value)).map(|row| from + row)
}

fn model_of(name: &str) -> Result<PowerModel, Problem> {
    serde_json::from_value(json!(name)).map_err(|_| {
        let detail = format!("power_model is {name:?}, but must be \"force-balance\" or \"dogru-marques\"");
        Problem::new(ProblemType::InvalidRequest, detail).at("/power_model")
    })
}
