//! Mechanisms that go with what hardly differed: drives of one speed do not show that friction grows with speed.

use crate::{average::Average, search::State, series::Series};

/// Standard deviation of speed on the way, over its mean, below which drives are of one speed. There and back in lanes it is 0.11, by the
/// ends of lanes alone; where drivers change speed as they please, or stop and go, 0.38 to 0.49 (drives of the independent world).
const LEAST_DIFFERENCE: f64 = 0.2;
/// Speeds below are no speed [m/s].
const STANDING_MPS: f64 = 0.05;

/// That drives do not show what one of several mechanisms says, in words. The fit tells it from others then by how curves differ from
/// straight lines only, in which furrows, fans and resonances do as well. Nothing that explains as much is in its place where the model
/// errs: what the curves show is neither. Where healthy drives show the model to be right, it is one name of several.
pub(crate) fn doubt(series: &Series, state: &State, which: usize) -> Option<String> {
    let name = state.found[which].applied.mechanism.name();
    (name == "speed_dependent_friction" && difference(&series.averages) < LEAST_DIFFERENCE)
        .then(|| "the drives are of one speed, so that growing with speed is not shown".to_owned())
}

/// Standard deviation of speed over its mean, along the way of the drives under suspicion.
fn difference(averages: &[Average]) -> f64 {
    let speeds = averages.iter().filter(|a| a.suspect && a.channel == 0).map(|a| a.input.speed_mps.abs());
    let speeds_mps: Vec<f64> = speeds.filter(|speed_mps| *speed_mps > STANDING_MPS).collect();
    let way: f64 = speeds_mps.iter().sum();
    let mean = |of: &dyn Fn(f64) -> f64| speeds_mps.iter().map(|v| v * of(*v)).sum::<f64>() / way.max(1e-9);
    let middle_mps = mean(&|v| v);
    mean(&|v| (v - middle_mps).powi(2)).sqrt() / middle_mps.max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::Input;

    fn difference_of(speeds_mps: &[f64]) -> f64 {
        let average = |speed_mps: &f64| Average {
            channel: 0,
            run: 0,
            suspect: true,
            t_s: 0.5,
            input: Input { speed_mps: *speed_mps, ..Input::default() },
        };
        difference(&speeds_mps.iter().map(average).collect::<Vec<_>>())
    }

    #[test]
    fn speeds_differ_by_what_is_driven_with_each_and_standing_is_no_speed() {
        assert!(difference_of(&[0.8, -0.8, 0.0, 0.8]) < 1e-12, "there and back is one speed");
        // As much way at 0.2 as at 0.6 m/s, which takes three times as long: mean 0.4, deviation 0.2.
        let speeds = [0.2, 0.2, 0.2, 0.6, 0.0];
        assert!((difference_of(&speeds) - 0.5).abs() < 1e-12, "{}", difference_of(&speeds));
        assert_eq!(difference_of(&[0.0]), 0.0);
    }
}
