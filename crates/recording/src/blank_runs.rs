//! Rows that do not say to which run they belong.

use std::ops::Range;

use crate::{Labels, Repair, cell::is_missing};

/// Gives rows without a run that of the rows before them; where there are none, or time goes back on the way, that of the rows behind.
/// `None` where no row names a run.
pub(crate) fn fill_blanks(mut labels: Labels, t_s: &[f64], repairs: &mut Vec<Repair>) -> Option<Labels> {
    let is_blank: Vec<bool> = labels.names.iter().map(|name| is_missing(name)).collect();
    let missing = |index: u32| is_blank.get(index as usize).is_none_or(|blank| *blank);
    let mut blank = 0;
    let mut start = 0;
    while start < labels.index.len() {
        if !missing(labels.index[start]) {
            start += 1;
            continue;
        }
        let rest = &labels.index[start..];
        let end = start + rest.iter().position(|index| !missing(*index)).unwrap_or(rest.len());
        let before = start.checked_sub(1).map(|row| labels.index[row]);
        let after = labels.index.get(end).copied();
        let first = before.or(after)?;
        let cut = goes_back(t_s, start..end).unwrap_or(end);
        labels.index[start..cut].fill(first);
        labels.index[cut..end].fill(after.unwrap_or(first));
        blank += end - start;
        start = end;
    }
    if blank > 0 {
        let what = format!(
            "{blank} rows have no name; they were taken for rows of the run before them, or of the run behind where time begins anew"
        );
        repairs.push(Repair { place: "column `run`".into(), what });
    }
    Some(labels)
}

/// The first of some rows whose time is earlier than that of the row before.
fn goes_back(t_s: &[f64], mut rows: Range<usize>) -> Option<usize> {
    rows.find(|&row| row > 0 && t_s[row] < t_s[row - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: u32 = Labels::NONE;

    fn filled(index: &[u32], t_s: &[f64]) -> Option<Vec<u32>> {
        let labels = Labels { names: vec!["a".into(), "b".into(), "NA".into()], index: index.into() };
        fill_blanks(labels, t_s, &mut Vec::new()).map(|labels| labels.index)
    }

    #[test]
    fn blank_rows_take_the_run_around_them() {
        let t_s = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        for (index, expected) in [
            ([0, NONE, 0, 1, 2, 1], [0, 0, 0, 1, 1, 1]),
            ([NONE, 2, 0, NONE, 1, NONE], [0, 0, 0, 0, 1, 1]),
            ([0, NONE, NONE, 1, NONE, NONE], [0, 0, 0, 1, 1, 1]),
        ] {
            assert_eq!(filled(&index, &t_s), Some(expected.into()));
        }
        assert_eq!(filled(&[NONE, 2, NONE, NONE, 2, 2], &t_s), None);
    }

    #[test]
    fn where_time_begins_anew_blank_rows_belong_to_the_run_behind() {
        let t_s = [0.0, 1.0, 2.0, 0.0, 1.0, 2.0];
        assert_eq!(filled(&[0, NONE, NONE, NONE, 1, 1], &t_s), Some(vec![0, 0, 0, 1, 1, 1]));
    }
}
