//! Encoders of one side of which one has the other sign: their mean would be nothing.

use crate::{Error, STANDS_MPS};

/// Fewer rows in which both turn say nothing.
const LEAST_ROWS: usize = 20;

/// Refuses the mean of parts of which two turn against each other in most rows in which both turn: the wheels of one side of a skid-steered
/// robot stand on the same ground and turn the same way.
///
/// # Errors
/// [`Error::Opposed`] with the two.
pub(crate) fn refuse(parts: &[Vec<f64>], names: &[String]) -> Result<(), Error> {
    let Some((first, others)) = parts.split_first() else { return Ok(()) };
    for (other, second) in others.iter().zip(names.iter().skip(1)) {
        let turns = |(a, b): &(&f64, &f64)| a.abs() > STANDS_MPS && b.abs() > STANDS_MPS;
        let both: Vec<bool> = first.iter().zip(other).filter(turns).map(|(a, b)| a * b < 0.0).collect();
        let rows = both.iter().filter(|opposed| **opposed).count();
        if both.len() >= LEAST_ROWS && 2 * rows > both.len() {
            let first = names.first().cloned().unwrap_or_default();
            return Err(Error::Opposed { first, second: second.clone(), rows, of: both.len() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_turn_against_each_other_are_refused_and_noise_about_nothing_is_not() {
        let names = ["front", "rear"].map(str::to_owned);
        let turns: Vec<f64> = (0..200).map(|row| 0.5 * (0.05 * f64::from(row)).sin()).collect();
        let by = |factor: f64| turns.iter().map(|v| factor * v).collect::<Vec<_>>();
        assert!(refuse(&[by(1.0), by(0.9)], &names).is_ok());
        let refused = refuse(&[by(1.0), by(-1.0)], &names).unwrap_err().to_string();
        assert!(refused.contains("`front` and `rear`") && refused.contains("sign"), "{refused}");
        assert!(refuse(&[by(0.01), by(-0.01)], &names).is_ok());
    }
}
