//! What the forms of mechanisms leave open: how a robot has it is not quite as the equation says, and that is no second mechanism.

use model::{
    Robot,
    mechanism::{self, Kind},
};
use rayon::prelude::*;

use crate::{
    Error,
    average::Average,
    baseline::differences,
    constancy::{Quantity, changing},
    polish::form_sigma,
    series::{Applied, Series},
};

/// What a mechanism may go with otherwise than its equation says: how the robot is driven.
const WITH: [Quantity; 8] = [
    |a| a.input.speed_mps.abs(),
    |a| a.input.speed_mps.powi(2),
    |a| a.input.difference_mps.abs(),
    |a| a.input.pitch_rad,
    |a| a.input.pitch_rad.abs(),
    |a| a.input.roll_rad,
    |a| a.input.roll_rad.abs(),
    |a| a.input.accel_mps2.abs(),
];

/// Whether there is no doubt of what a mechanism does: faults of meters and standing loads do the same whatever robot and ground are like.
pub(crate) fn is_certain(name: &str) -> bool {
    name == "hotel_load" || mechanism::by_name(name).is_some_and(|one| one.kind() == Kind::Measurement)
}

/// What mechanisms that act may do otherwise than their equations say, per one sigma: more or less as each quantity of [`WITH`] is far from
/// its mean.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn forms(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    let of_each = |which: usize| {
        let mut others = applied.to_vec();
        let name = others.remove(which).mechanism.name();
        if !is_open(series, name) {
            return Ok(Vec::new());
        }
        Ok(of_one(series, name, &differences(predicted, &series.predict(robot, &others)?)))
    };
    let all: Vec<Vec<Vec<f64>>> =
        (0..applied.len()).into_par_iter().map(of_each).collect::<Result<_, Error>>()?;
    Ok(all.concat())
}

/// The same of one mechanism, of which the effect is known.
pub(crate) fn of_one(series: &Series, name: &str, effect: &[f64]) -> Vec<Vec<f64>> {
    if is_open(series, name) { of_effect(&series.averages, effect, form_sigma(series)) } else { Vec::new() }
}

/// Whether the form of a mechanism leaves anything open: not where healthy drives show the model to be right.
fn is_open(series: &Series, name: &str) -> bool {
    form_sigma(series) > 0.0 && !is_certain(name)
}

fn of_effect(averages: &[Average], effect: &[f64], sigma: f64) -> Vec<Vec<f64>> {
    let columns = WITH.iter().filter_map(|of| changing(averages, effect, *of));
    columns.map(|column| column.iter().map(|x| sigma * x).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    #[test]
    fn what_meters_do_is_certain_and_what_ground_does_is_not() {
        for name in ["power_scale", "pitch_bias", "hotel_load"] {
            assert!(is_certain(name), "{name}");
        }
        for name in ["wind", "soft_soil", "center_of_mass"] {
            assert!(!is_certain(name), "{name}");
        }
    }

    #[test]
    fn a_form_may_miss_its_share_of_an_effect_per_sigma_of_what_it_may_go_with_and_nothing_where_that_stays()
    {
        // Speeds of 0.5 and 1.5 m/s in turn: one sigma below and above their mean.
        let average = |i: usize| {
            let input = Input { speed_mps: 0.5 + (i % 2) as f64, ..Input::default() };
            Average { channel: 0, run: 0, suspect: true, t_s: i as f64, input }
        };
        let averages: Vec<Average> = (0..100).map(average).collect();
        let columns = of_effect(&averages, &[50.0; 100], 0.1);
        assert_eq!(columns.len(), 2, "speed and its square alone change");
        for (i, value) in columns[0].iter().enumerate() {
            let sign = if i % 2 == 0 { -1.0 } else { 1.0 };
            assert!((value - 5.0 * sign).abs() < 1e-9, "{i}: {value}");
        }
    }
}
