//! What happened a few times only: too much to be noise, and too seldom to be evidence of anything.

use crate::{
    series::Series,
    visits,
    weigh::{BLOCK_S, blocks},
};

/// Share of what is beyond noise that a few blocks hold where it is an event.
const MOST: f64 = 0.5;

/// When a few blocks of drives under suspicion hold most of the errors beyond noise, and how far power was off there, in words; `None` where
/// errors are all over the drives.
pub(crate) fn event(series: &Series, errors_w: &[f64], floor_w: f64) -> Option<String> {
    let block = blocks(series);
    let mut beyond_w2 = vec![(0.0, 0.0, None); block.iter().max().map_or(0, |last| last + 1)];
    for i in (0..errors_w.len()).filter(|i| series.is_power(*i) && series.averages[*i].suspect) {
        let (sum_w2, count, first) = &mut beyond_w2[block[i]];
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
    let (sum_w2, count, first) = beyond_w2.first()?;
    let average = &series.averages[(*first)?];
    let from_s = BLOCK_S * (average.t_s.max(0.0) / BLOCK_S).floor();
    let drive = match &series.names[..] {
        names if names.len() > 1 => format!(" of drive {}", names.get(average.run)?),
        _ => String::new(),
    };
    let power = if series.channels() == 2 { "the power of a side" } else { "power" };
    Some(format!(
        "from {from_s:.0} to {:.0} s{drive} {power} was off by {:.0} W, root mean square",
        from_s + BLOCK_S,
        (sum_w2 / count + floor_w.powi(2)).sqrt()
    ))
}
