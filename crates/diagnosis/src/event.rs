//! What happened a few times only: too much to be noise, and too seldom to be evidence of anything.

use crate::{
    report::{Place, Range},
    series::Series,
    visits,
    weigh::{BLOCK_S, blocks},
};

/// Share of what is beyond noise that a few blocks hold where it is an event.
const MOST: f64 = 0.5;

/// What happened too seldom to be evidence.
pub(crate) struct Event {
    /// When, and how far power was off there, in words.
    pub(crate) words: String,
    /// When.
    pub(crate) place: Place,
}

/// When a few blocks of drives under suspicion hold most of the errors beyond noise, and how far power was off there; `None` where errors
/// are all over the drives.
pub(crate) fn event(series: &Series, errors_w: &[f64], floor_w: f64) -> Option<Event> {
    let block = blocks(series);
    let mut beyond_w2 = vec![(0.0, 0.0, None, [0.0; 2]); block.iter().max().map_or(0, |last| last + 1)];
    for i in (0..errors_w.len()).filter(|i| series.is_power(*i) && series.averages[*i].suspect) {
        let (sum_w2, count, first, by_side_w2) = &mut beyond_w2[block[i]];
        if let Some(own_w2) = by_side_w2.get_mut(series.averages[i].channel) {
            *own_w2 += errors_w[i].powi(2);
        }
        *sum_w2 += errors_w[i].powi(2) - floor_w.powi(2);
        *count += 1.0;
        first.get_or_insert(i);
    }
    beyond_w2.retain(|(sum_w2, ..)| *sum_w2 > 0.0);
    beyond_w2.sort_by(|a, b| b.0.total_cmp(&a.0));
    let all_w2: f64 = beyond_w2.iter().map(|(sum_w2, ..)| sum_w2).sum();
    let few = beyond_w2.iter().take(visits::LEAST as usize - 1);
    if few.map(|(sum_w2, ..)| sum_w2).sum::<f64>() < MOST * all_w2 {
        return None;
    }
    let (sum_w2, count, first, by_side_w2) = beyond_w2.first()?;
    let average = &series.averages[(*first)?];
    let from_s = BLOCK_S * (average.t_s.max(0.0) / BLOCK_S).floor();
    let to_s = from_s + BLOCK_S;
    let name = series.names.get(average.run).filter(|_| series.names.len() > 1).cloned();
    let drive = name.as_ref().map_or(String::new(), |name| format!(" of drive {name}"));
    let power = if series.channels() == 2 { of_side(*by_side_w2) } else { "power" };
    let when = format!("from {from_s:.0} to {to_s:.0} s{drive}");
    let off_w = (sum_w2 / count + floor_w.powi(2)).sqrt();
    let words = format!("{when} {power} was off by {off_w:.0} W, root mean square");
    let range = Range { name, ..Range::of("t_s", [Some(from_s), Some(to_s)]) };
    let place = Place { kind: "time", statement: when, range, share_of_excess: sum_w2 / all_w2 };
    Some(Event { words, place })
}

/// Share of squared errors that one side holds where it is the one that was off.
const ON_ONE_SIDE: f64 = 0.8;

/// Which power was off, by the squared errors of the left and the right side.
fn of_side([left_w2, right_w2]: [f64; 2]) -> &'static str {
    match left_w2 / (left_w2 + right_w2) {
        share if share >= ON_ONE_SIDE => "the power of the left side",
        share if share <= 1.0 - ON_ONE_SIDE => "the power of the right side",
        _ => "the power of a side",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_is_named_that_holds_most_of_it() {
        assert_eq!(of_side([90.0, 10.0]), "the power of the left side");
        assert_eq!(of_side([10.0, 90.0]), "the power of the right side");
        assert_eq!(of_side([60.0, 40.0]), "the power of a side");
        assert_eq!(of_side([0.0, 0.0]), "the power of a side");
    }
}
