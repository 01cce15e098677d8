//! Columns of one channel, over its own averages or over all.

use crate::average::Average;

/// Which averages are of a channel.
pub(crate) fn places(averages: &[Average], channel: usize) -> Vec<usize> {
    (0..averages.len()).filter(|i| averages[*i].channel == channel).collect()
}

/// Number of channels.
pub(crate) fn count(averages: &[Average]) -> usize {
    averages.iter().map(|average| average.channel + 1).max().unwrap_or(0)
}

/// Columns over the averages of a channel as columns over so many averages, 0 in other channels.
pub(crate) fn spread(columns: &[Vec<f64>], places: &[usize], averages: usize) -> Vec<Vec<f64>> {
    let column = |own: &Vec<f64>| {
        let mut column = vec![0.0; averages];
        places.iter().zip(own).for_each(|(place, value)| column[*place] = *value);
        column
    };
    columns.iter().map(column).collect()
}
