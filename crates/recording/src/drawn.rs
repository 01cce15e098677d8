//! The sign of a battery's current where drivers of one topic have both: `sensor_msgs/BatteryState` has what is drawn negative, and some
//! publish it positive.

use crate::{Channel, Recording, Repair, STANDS_MPS};

/// Turns the current so that it is drawn on the whole while the wheels turn, and says which sign it had.
pub(crate) fn settle(recording: &mut Recording, place: &str) -> Option<Repair> {
    let [left, right] = [Channel::LeftSpeed, Channel::RightSpeed].map(|side| recording.channel(side));
    let turns =
        |row: usize| [left, right].into_iter().flatten().any(|speed_mps| speed_mps[row].abs() > STANDS_MPS);
    let current_a = recording.channel(Channel::Current)?;
    let driven = (0..current_a.len()).filter(|row| current_a[*row].is_finite() && turns(*row));
    let (sum_a, count) = driven.fold((0.0, 0), |(sum, count), row| (sum + current_a[row], count + 1));
    if count == 0 {
        return None;
    }
    let mean_a = sum_a / f64::from(count);
    let sign = if mean_a < 0.0 { "negative" } else { "positive" };
    if mean_a < 0.0 {
        recording
            .channels
            .get_mut(&Channel::Current)?
            .iter_mut()
            .for_each(|current_a| *current_a = -*current_a);
    }
    let what = format!(
        "its current is {mean_a:.2} A on average while the wheels turn: what is drawn was taken to be {sign} there, since drivers have both signs; where the \
         battery was charged on balance, name it in a map with `scale` 1 or -1"
    );
    Some(Repair { place: place.to_owned(), what })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn a_drive_draws_whatever_the_sign_of_the_driver() {
        for sign in [1.0, -1.0] {
            let channels = BTreeMap::from([
                (Channel::LeftSpeed, vec![0.0, 0.5, 0.5, 0.5]),
                (Channel::RightSpeed, vec![0.0, 0.5, 0.4, 0.5]),
                (Channel::Current, vec![-9.0 * sign, 3.0 * sign, -2.0 * sign, 4.0 * sign]),
            ]);
            let mut recording = Recording { channels, ..Recording::default() };
            let said = settle(&mut recording, "topic /bms").unwrap();
            assert_eq!(recording.channel(Channel::Current).unwrap(), [-9.0, 3.0, -2.0, 4.0]);
            assert!(
                said.what.contains(if sign > 0.0 { "positive there" } else { "negative there" }),
                "{said:?}"
            );
        }
    }
}
