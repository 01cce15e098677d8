//! Where model and recording differ: the stretches, ways of driving, places and sides that hold more than their share of the errors.

use model::Robot;

use crate::posterior::{engine::Found, observations::Observations, report::fitted::Corrected};
use crate::{
    locate,
    report::{Place, Range},
};

/// Places with more than their share: of what the findings take away, or of what is beyond noise where nothing is named.
pub(crate) fn places(
    observed: &Observations<'_>,
    file: &Robot,
    found: &Found,
    corrected: &Corrected,
) -> Vec<Place> {
    let variance = |i: usize| {
        let channel = observed.averages()[i].channel;
        found.baseline.noise.sigma(channel, found.baseline.predicted[i]).powi(2)
    };
    let recorded = &observed.series.recorded;
    let excess = |i: usize| {
        let with = recorded[i] - corrected.predicted[i];
        match &corrected.effect {
            Some(effect) => ((with + effect[i]).powi(2) - with.powi(2)) / variance(i),
            None => with.powi(2) / variance(i) - 1.0,
        }
    };
    // Healthy drives are no place.
    let mut all: Vec<f64> = (0..observed.test_rows).map(excess).collect();
    all.resize(observed.rows(), 0.0);
    let mut places = locate::places(observed.series, file, &all);
    if places.is_empty() {
        let range = Range::of("t_s", [None, None]);
        let statement = "all through the drives, nowhere in particular".into();
        places.push(Place { kind: "time", statement, range, share_of_excess: 1.0 });
    }
    places
}
