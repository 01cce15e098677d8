//! Two publishers on one topic: a `joint_state_publisher` beside the broadcaster sends zeros between the speeds of the wheels.

use crate::{Repair, stream::Stream};

/// Speeds below which a wheel may just have stopped \[m/s\]: a wheel that is faster in both neighbours does not stand still between them.
const MOVES_MPS: f64 = 0.1;
/// Share of the messages of moving wheels that has to be zero before a second publisher is told: encoders that miss are far rarer.
const LEAST_SHARE: f64 = 0.1;

/// Leaves out the speeds of messages in which all wheels are exactly zero between moving ones, and says so.
pub(crate) fn leave_zeros_out(topic: &str, stream: &mut Stream, wheels: &[bool]) -> Option<Repair> {
    let own: Vec<usize> = (0..stream.columns.len()).filter(|at| wheels.get(*at) == Some(&true)).collect();
    let told = |row: &usize| own.iter().any(|column| !stream.columns[*column][*row].is_nan());
    let rows: Vec<usize> = (0..stream.t_ns.len()).filter(told).collect();
    let fastest =
        |row: usize| own.iter().map(|column| stream.columns[*column][row].abs()).fold(0.0, f64::max);
    let moves: Vec<bool> = rows.iter().map(|row| fastest(*row) > MOVES_MPS).collect();
    let moving = moves.iter().filter(|moves| **moves).count();
    let mut zeros = Vec::new();
    let mut at = 0;
    while at < rows.len() {
        let begin = at;
        while at < rows.len() && fastest(rows[at]) == 0.0 {
            at += 1;
        }
        // A second publisher may be a little faster than the first: a few zeros in a row.
        let is_between =
            begin > 0 && at < rows.len() && moves[begin - 1] && moves[at] && (1..=3).contains(&(at - begin));
        if is_between {
            zeros.extend_from_slice(&rows[begin..at]);
        }
        at = at.max(begin + 1);
    }
    if zeros.is_empty() || (zeros.len() as f64) < LEAST_SHARE * (moving + zeros.len()) as f64 {
        return None;
    }
    for column in own {
        zeros.iter().for_each(|row| stream.columns[column][*row] = f64::NAN);
    }
    let what = format!(
        "{} messages have all wheels at exactly 0 between moving ones, as of a second publisher on the topic; their speeds were left out",
        zeros.len()
    );
    Some(Repair { place: format!("topic {topic}"), what })
}

#[cfg(test)]
mod tests {
    use crate::stream::Samples;

    use super::*;

    fn stream(speed_mps: &[f64]) -> Stream {
        let ns: Vec<i64> = (1..=speed_mps.len() as i64).map(|i| i * 50_000_000).collect();
        let mut samples = Samples::new(std::iter::empty(), false);
        (samples.log_ns, samples.stamp_ns, samples.columns) = (ns.clone(), ns, vec![speed_mps.to_vec()]);
        samples.into_stream("/joints", crate::Stamp::Header, &mut Vec::new()).unwrap()
    }

    #[test]
    fn zeros_between_moving_wheels_are_a_second_publishers_and_a_stop_is_none() {
        let mut mixed = stream(&[0.5, 0.0, 0.6, 0.0, 0.7, 0.0, 0.6]);
        let told = leave_zeros_out("/joints", &mut mixed, &[true]).unwrap();
        assert!(told.what.starts_with("3 messages") && told.what.contains("second publisher"), "{told:?}");
        assert_eq!(mixed.columns[0].iter().filter(|v| v.is_nan()).count(), 3);
        let stop: Vec<f64> =
            [vec![0.5; 20], vec![0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05], vec![0.5; 20]].concat();
        assert_eq!(leave_zeros_out("/joints", &mut stream(&stop), &[true]), None);
        let mut missed = vec![0.5; 60];
        missed[30] = 0.0;
        assert_eq!(leave_zeros_out("/joints", &mut stream(&missed), &[true]), None, "one lost count");
    }
}
