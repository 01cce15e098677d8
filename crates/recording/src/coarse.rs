//! Rows beyond what is held in memory, brought to means of neighbours.
//!
//! What a robot draws is fitted and judged by averages over a second, so that rows of a long recording may be joined before they are
//! read to the end: whenever the rows at hand fill the [`Room`](crate::Room), neighbours become one row until they fill half of it.

use std::{f64::consts::PI, ops::Range};

use crate::{Repair, gap::GAP_STEPS};

/// How rows of a table, or messages of a topic, stand for several of the file each.
#[derive(Clone, Debug)]
pub(crate) struct Coarse {
    /// Rows of the file that a row stands for at most: a power of two.
    per_row: u32,
    /// How many rows of the file each row stands for. Rows behind its end were read since and stand for themselves.
    weight: Vec<u32>,
}

impl Default for Coarse {
    fn default() -> Self {
        Coarse { per_row: 1, weight: Vec::new() }
    }
}

/// Neighbouring rows that become one each, in order, and how many rows of the file each then stands for.
#[derive(Debug)]
pub(crate) struct Groups {
    rows: Vec<Range<usize>>,
    /// By row before it was joined.
    weight: Vec<u32>,
}

impl Coarse {
    /// Rows of the file that a row stands for.
    pub(crate) fn weight(&self, row: usize) -> u32 {
        self.weight.get(row).copied().unwrap_or(1)
    }

    /// The row of the file that a row begins with.
    pub(crate) fn first_in_file(&self, row: usize) -> usize {
        let before = self.weight.iter().take(row).map(|weight| *weight as usize);
        before.sum::<usize>() + row.saturating_sub(self.weight.len())
    }

    /// Whether any row stands for several.
    pub(crate) fn is_joined(&self) -> bool {
        self.per_row > 1
    }

    /// What was done, for the report; `None` where every row stands for itself.
    pub(crate) fn told(&self, place: &str, t_s: &[f64]) -> Option<Repair> {
        let rows: usize = self.first_in_file(t_s.len());
        let what = format!(
            "{rows} are more than are held in memory; each is now the mean over up to {} neighbours, {:.3} s, and what is shorter is \
             smoothed: cut the file into several where that matters",
            self.per_row,
            median_rise(t_s)
        );
        self.is_joined().then(|| Repair { place: place.to_owned(), what })
    }

    /// Groups neighbours so that at most so many rows are left, each of twice as many rows of the file as often as need be. `None`
    /// where that does not help any more. Rows are joined only where `together` says of the later one that it continues the one before
    /// and time increases by no more than a gap.
    pub(crate) fn group(
        &mut self,
        t: &[f64],
        most_rows: usize,
        together: impl Fn(usize) -> bool,
    ) -> Option<Groups> {
        let joined = self.weight.len().min(t.len());
        let (before, since) = t.split_at(joined);
        let longest = [before, since].map(|t| GAP_STEPS * median_rise(t));
        let follows = |row: usize| {
            let step = t[row] - t[row - 1];
            step > 0.0 && step <= longest[usize::from(row > joined)] && together(row)
        };
        let mut fewest = usize::MAX;
        loop {
            let rows = self.grouped(t.len(), follows);
            if rows.len() <= most_rows {
                let weight = (0..t.len()).map(|row| self.weight(row)).collect();
                let groups = Groups { rows, weight };
                self.weight = groups.weights();
                return Some(groups);
            }
            if rows.len() == fewest || self.per_row > u32::MAX / 2 {
                return None;
            }
            fewest = rows.len();
            self.per_row *= 2;
        }
    }

    fn grouped(&self, rows: usize, follows: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
        let mut groups: Vec<Range<usize>> = Vec::new();
        let mut stands_for = 0;
        for row in 0..rows {
            let more = self.weight(row);
            match groups.last_mut() {
                Some(group) if stands_for + more <= self.per_row && follows(row) => {
                    group.end = row + 1;
                    stands_for += more;
                }
                _ => {
                    groups.push(row..row + 1);
                    stands_for = more;
                }
            }
        }
        groups
    }
}

impl Groups {
    /// How many rows are left.
    pub(crate) fn count(&self) -> usize {
        self.rows.len()
    }

    fn weights(&self) -> Vec<u32> {
        self.rows.iter().map(|group| self.weight[group.clone()].iter().sum()).collect()
    }

    /// The mean of each group over the rows of the file that have a value. Numbers that begin again after a period, as headings
    /// do, are averaged about the first of each group.
    pub(crate) fn average(&self, values: &mut Vec<f64>, period: Option<f64>) {
        for (at, group) in self.rows.iter().enumerate() {
            let first = values[group.start];
            if group.len() > 1 {
                let present = group.clone().filter(|&row| !values[row].is_nan());
                let about = present.clone().next().map_or(first, |row| values[row]);
                let (sum, weight) = present.fold((0.0, 0.0), |(sum, weight), row| {
                    let (more, from) = (f64::from(self.weight[row]), values[row] - about);
                    let from = period.map_or(from, |period| wrapped(from, period));
                    (sum + more * from, weight + more)
                });
                values[at] = if weight > 0.0 { about + sum / weight } else { f64::NAN };
            } else {
                values[at] = first;
            }
        }
        values.truncate(self.rows.len());
    }

    /// The first of each group, of what is the same throughout.
    pub(crate) fn first<T: Copy>(&self, values: &mut Vec<T>) {
        self.rows.iter().enumerate().for_each(|(at, group)| values[at] = values[group.start]);
        values.truncate(self.rows.len());
    }

    /// The mean of each group of integers, none of which lies as far from the first as a double could not tell.
    pub(crate) fn average_ns(&self, values_ns: &mut Vec<i64>) {
        for (at, group) in self.rows.iter().enumerate() {
            let first_ns = values_ns[group.start];
            let weighted = |row: usize| f64::from(self.weight[row]) * (values_ns[row] - first_ns) as f64;
            let sum_ns: f64 = group.clone().map(weighted).sum();
            let weight: u32 = self.weight[group.clone()].iter().sum();
            values_ns[at] = first_ns + (sum_ns / f64::from(weight)).round() as i64;
        }
        values_ns.truncate(self.rows.len());
    }
}

/// A difference in ± half a period.
fn wrapped(difference: f64, period: f64) -> f64 {
    let half = period / 2.0;
    (difference + half).rem_euclid(period) - half
}

/// The median of the steps by which time increases; zero where it never does.
fn median_rise(t: &[f64]) -> f64 {
    let mut rises: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).filter(|rise| *rise > 0.0).collect();
    let middle = rises.len() / 2;
    if rises.is_empty() { 0.0 } else { *rises.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The period of a heading in its own unit, of which one is so many radians.
pub(crate) fn period(rad_per_unit: f64) -> f64 {
    2.0 * PI / rad_per_unit.abs()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    fn seconds(rows: usize) -> Vec<f64> {
        (0..rows).map(|row| row as f64 * 0.1).collect()
    }

    #[test]
    fn neighbours_become_one_and_places_in_the_file_are_known() {
        let (mut coarse, mut t) = (Coarse::default(), seconds(100));
        let groups = coarse.group(&t, 25, |_| true).unwrap();
        groups.average(&mut t, None);
        assert_eq!((t.len(), coarse.per_row, coarse.first_in_file(3)), (25, 4, 12));
        assert_relative_eq!(t[0], 0.15, epsilon = 1e-12);
        // What is read since is joined to as much, and stands behind it.
        t.extend((100..120).map(|row| f64::from(row) * 0.1));
        let mut since = t.clone();
        let groups = coarse.group(&t, 30, |_| true).unwrap();
        groups.average(&mut since, None);
        assert_eq!((since.len(), coarse.per_row, coarse.first_in_file(26)), (30, 4, 104));
        assert_relative_eq!(since[29], 11.75, epsilon = 1e-9);
    }

    #[test]
    fn nothing_is_joined_over_a_gap_a_step_back_or_another_drive() {
        let mut t = seconds(64);
        t[32..].iter_mut().for_each(|t| *t += 5.0);
        t[48..].iter_mut().for_each(|t| *t -= 20.0);
        let mut coarse = Coarse::default();
        let groups = coarse.group(&t, 16, |row| row != 7).unwrap();
        let begins: Vec<usize> = groups.rows.iter().map(|group| group.start).collect();
        assert!([7, 32, 48].iter().all(|begin| begins.contains(begin)), "{begins:?}");
        assert!(coarse.group(&t, 2, |_| false).is_none(), "it ends where nothing helps");
    }

    #[test]
    fn gaps_do_not_count_and_headings_turn_by_the_shorter_arc() {
        let groups = Coarse::default().group(&seconds(4), 1, |_| true).unwrap();
        let mut values = vec![1.0, f64::NAN, 3.0, 2.0];
        groups.average(&mut values, None);
        assert_eq!(values, [2.0]);
        let mut headings_rad = vec![3.1, -3.1, 3.1, -3.1];
        groups.average(&mut headings_rad, Some(period(1.0)));
        assert_relative_eq!(headings_rad[0], PI, epsilon = 1e-12);
        let mut none = vec![f64::NAN; 4];
        groups.average(&mut none, None);
        assert!(none[0].is_nan());
    }

    proptest! {
        #[test]
        fn what_all_rows_add_up_to_stays_however_often_they_are_joined(
            values in proptest::collection::vec(-50.0..50.0f64, 40..400), most in 3..20usize
        ) {
            let (mut coarse, mut held, mut t) = (Coarse::default(), Vec::new(), Vec::new());
            for (row, value) in values.iter().enumerate() {
                held.push(*value);
                t.push(row as f64 * 0.1);
                if held.len() > 2 * most {
                    let groups = coarse.group(&t, most, |_| true).unwrap();
                    groups.average(&mut held, None);
                    groups.average(&mut t, None);
                }
            }
            prop_assert!(held.len() <= 2 * most);
            let sum: f64 = held.iter().enumerate().map(|(row, v)| f64::from(coarse.weight(row)) * v).sum();
            prop_assert!((sum - values.iter().sum::<f64>()).abs() < 1e-9 * values.len() as f64);
        }
    }
}
