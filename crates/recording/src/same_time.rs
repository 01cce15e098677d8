//! Rows of one time that complete each other, as tables put below one another and sorted by time have them.

use crate::{Error, Labels, Recording, Repair, watch::Looks};

/// Makes one row of neighbours in a run that have the same time and fill each other's gaps. Returns the rows that stay, where
/// some do not.
pub(crate) fn merge_same_times(
    recording: &mut Recording,
    repairs: &mut Vec<Repair>,
    looks: &Looks,
) -> Result<Option<Vec<usize>>, Error> {
    if recording.t_s.windows(2).all(|pair| pair[0] != pair[1]) {
        return Ok(None);
    }
    looks.go_on()?;
    let begins = |row: usize| recording.runs.iter().any(|run| run.rows.start == row);
    let mut rows = vec![0];
    let mut taken = Vec::new();
    for row in 1..recording.rows() {
        let first = rows[rows.len() - 1];
        let group = first..row;
        if recording.t_s[row] == recording.t_s[first]
            && !begins(row)
            && group.clone().all(|other| agree(recording, other, row))
        {
            taken.push((first, row));
        } else {
            rows.push(row);
        }
    }
    if taken.is_empty() {
        return Ok(None);
    }
    for values in recording.channels.values_mut().chain(recording.aside.values_mut()) {
        for (first, row) in &taken {
            if values[*first].is_nan() {
                values[*first] = values[*row];
            }
        }
        *values = rows.iter().map(|row| values[*row]).collect();
    }
    if let Some(surface) = &mut recording.surface {
        for (first, row) in &taken {
            if surface.index[*first] == Labels::NONE {
                surface.index[*first] = surface.index[*row];
            }
        }
        surface.index = rows.iter().map(|row| surface.index[*row]).collect();
    }
    recording.t_s = rows.iter().map(|row| recording.t_s[*row]).collect();
    for run in &mut recording.runs {
        let at = |row: usize| rows.partition_point(|kept| *kept < row);
        run.rows = at(run.rows.start)..at(run.rows.end);
        run.gap_s = crate::gap::threshold_s(&recording.t_s[run.rows.clone()]);
    }
    let what =
        format!("{} rows have the time of the row before them and complete it; they became one", taken.len());
    repairs.push(Repair { place: "all rows".into(), what });
    Ok(Some(rows))
}

/// Whether two rows fill each other's gaps: no channel has a value in both, which rounded times would give two rows as well.
fn agree(recording: &Recording, one: usize, other: usize) -> bool {
    let completes = |values: &Vec<f64>| values[one].is_nan() || values[other].is_nan();
    let is_same = |values: &Vec<f64>| completes(values) || values[one] == values[other];
    let labels = recording.surface.as_ref();
    let is_same_ground = |labels: &Labels| {
        let [one, other] = [labels.index[one], labels.index[other]];
        one == other || one == Labels::NONE || other == Labels::NONE
    };
    labels.is_none_or(is_same_ground)
        && recording.channels.values().all(completes)
        && recording.aside.values().all(is_same)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{Channel, Run, unwatched};

    #[test]
    fn rows_of_one_time_become_one_where_they_complete_each_other() {
        let nan = f64::NAN;
        let t_s = vec![0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0];
        let channels = BTreeMap::from([
            (Channel::LeftSpeed, vec![1.0, nan, 2.0, nan, nan, 3.0, 4.0]),
            (Channel::Power, vec![nan, 10.0, nan, 20.0, nan, nan, nan]),
        ]);
        let runs = vec![Run::new("drive".into(), 0..7, &t_s, None)];
        let mut recording = Recording { t_s, channels, runs, ..Recording::default() };
        let mut repairs = Vec::new();
        let rows =
            merge_same_times(&mut recording, &mut repairs, &crate::watch::Looks::new(&unwatched())).unwrap();
        assert_eq!(rows, Some(vec![0, 2, 5, 6]));
        assert_eq!(recording.t_s, [0.0, 1.0, 2.0, 2.0], "rows that contradict each other stay");
        assert_eq!(recording.channel(Channel::Power).unwrap()[..2], [10.0, 20.0]);
        assert_eq!((recording.runs[0].rows.clone(), repairs.len()), (0..4, 1));
    }
}
