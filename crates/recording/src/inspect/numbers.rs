//! What the numbers of a column say of a guess by its name.

use super::guess::Guess;
use crate::{Conversion, Quantity};

/// What a guess has to know of the numbers of a column.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    /// Greatest magnitude.
    pub(super) greatest: f64,
    /// Whether all are whole.
    pub(super) is_whole: bool,
}

impl Seen {
    pub(super) fn of(values: &[f64]) -> Seen {
        let known = || values.iter().filter(|value| !value.is_nan());
        Seen {
            greatest: known().fold(0.0, |greatest: f64, value| greatest.max(value.abs())),
            is_whole: known().all(|value| value.fract() == 0.0),
        }
    }

    /// Of numbers up to a magnitude.
    #[cfg(test)]
    pub(super) fn up_to(greatest: f64) -> Seen {
        Seen { greatest, is_whole: false }
    }
}

/// Greatest number of the enumerations of `sensor_msgs/BatteryState` (`POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE`): what is whole and no
/// greater may be one, and no robot of 5 kg to 5 t drives on whole watts up to it.
const GREATEST_OF_ENUMERATIONS: f64 = 8.0;

/// The guess if its numbers may be those of its channel in its unit, or why they are not.
pub(super) fn agree(guess: Guess, values: &[f64]) -> Result<Guess, String> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    let (channel, quantity) = (guess.channel, guess.channel.quantity());
    if is_counted_up(&sorted) && matches!(quantity, Quantity::Speed | Quantity::Power | Quantity::Current) {
        return Err(format!(
            "left out: it never falls, as an energy or a count of ticks, and {channel} does"
        ));
    }
    if quantity == Quantity::Power {
        no_power(&sorted, channel.name())?;
    }
    // Wheels of any radius a robot has turn as their angular rates say.
    let Some(unit) = Conversion::from_unit(quantity, guess.unit, None) else {
        return Ok(guess);
    };
    sorted.iter_mut().for_each(|value| *value = unit.apply(*value).abs());
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(&high) = sorted.get(sorted.len().saturating_sub(1) * 99 / 100) else { return Ok(guess) };
    let [least, most] = channel.plausible_magnitude();
    if high > most || (high > 0.0 && high < least) {
        let unit = guess.unit;
        return Err(format!(
            "left out: as {channel} in {unit} its numbers reach {high:.4}, and a robot's lie between {least} and {most}; name its unit in the map"
        ));
    }
    Ok(guess)
}

/// Refuses what stands still or is an enumeration: a robot that drives draws more at one time than at another.
fn no_power(values: &[f64], channel: &str) -> Result<(), String> {
    let Some(first) = values.first() else { return Ok(()) };
    if values.len() > 1 && values.iter().all(|value| value == first) {
        return Err(format!("left out: it is {first} in every row, and {channel} changes as a robot drives"));
    }
    let seen = Seen::of(values);
    if seen.is_whole && seen.greatest <= GREATEST_OF_ENUMERATIONS {
        return Err(format!(
            "left out: its numbers are whole and {} at most, as those of flags; name it as {channel} in the map if it is",
            seen.greatest
        ));
    }
    Ok(())
}

/// Whether numbers rise all the way, as those of counters do.
fn is_counted_up(values: &[f64]) -> bool {
    /// More rises in a row than any drive begins with.
    const RISES: usize = 100;
    let rises = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    rises >= RISES && values.windows(2).all(|pair| pair[1] >= pair[0])
}
