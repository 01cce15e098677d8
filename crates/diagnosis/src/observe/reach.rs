//! What drives do that those did not by which the error of a model is known.

use model::knowledge::Regimes;

/// What a smooth curve is good for beyond its ends, as a share of the range that it was fitted in.
const REACH: f64 = 0.1;

/// One quantity that goes beyond what is known.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Beyond {
    name: &'static str,
    unit: &'static str,
    known: [f64; 2],
    here: [f64; 2],
}

impl Beyond {
    /// In words of a report.
    pub(crate) fn words(&self) -> String {
        let Beyond { name, unit, known: [low, high], here } = self;
        format!("{name} {:.2} to {:.2} {unit} (known for {low:.2} to {high:.2})", here[0], here[1])
    }
}

/// Quantities that go beyond known regimes by more than a smooth curve is good for.
pub(crate) fn beyond(known: &Regimes, here: &Regimes) -> Vec<Beyond> {
    let quantities = [
        ("speed", "m/s", known.speed_mps, here.speed_mps),
        ("difference of the sides' speeds", "m/s", known.difference_mps, here.difference_mps),
        ("pitch", "rad", known.pitch_rad, here.pitch_rad),
    ];
    let is_beyond = |[low, high]: [f64; 2], here: [f64; 2]| {
        let reach = REACH * (high - low);
        here[0] < low - reach || here[1] > high + reach
    };
    quantities
        .into_iter()
        .filter(|(_, _, known, here)| is_beyond(*known, *here))
        .map(|(name, unit, known, here)| Beyond { name, unit, known, here })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_that_no_known_drive_made_are_beyond_and_a_tenth_more_speed_is_not() {
        let known = Regimes { speed_mps: [0.0, 1.0], difference_mps: [-0.1, 0.1], pitch_rad: [-0.1, 0.1] };
        let here = Regimes { speed_mps: [0.0, 1.09], difference_mps: [-0.6, 0.1], ..known };
        let found = beyond(&known, &here);
        assert_eq!(found.len(), 1);
        assert_eq!(
            found[0].words(),
            "difference of the sides' speeds -0.60 to 0.10 m/s (known for -0.10 to 0.10)"
        );
        assert!(beyond(&known, &known).is_empty());
    }
}
