//! A recording as the file that the diagnosis gets.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{BufWriter, Write},
    path::Path,
};

use recording::{Channel, Recording};

use crate::Error;

/// Decimals that each channel was recorded with.
pub(crate) type Decimals = BTreeMap<Channel, usize>;

/// Decimals beyond which a number counts as not rounded.
const MOST_DECIMALS: usize = 6;
/// Decimals of the time: a run that another goes on in keeps its rhythm to a tenth of a millisecond.
const TIME_DECIMALS: usize = 4;

/// How many decimals the numbers of each channel have.
///
/// Changed numbers are rounded to as many, so that the digits do not tell where a change begins.
pub(crate) fn decimals(recording: &Recording) -> Decimals {
    recording.channels.iter().map(|(channel, values)| (*channel, decimals_of(values))).collect()
}

fn decimals_of(values: &[f64]) -> usize {
    let is_whole = |value: f64| (value - value.round()).abs() < 1e-6 * value.abs().max(1.0);
    let fits = |digits: usize| {
        let factor = 10_f64.powi(digits as i32);
        values.iter().filter(|value| value.is_finite()).all(|value| is_whole(factor * value))
    };
    (0..MOST_DECIMALS).find(|digits| fits(*digits)).unwrap_or(MOST_DECIMALS)
}

/// Writes a recording; gaps are empty cells.
pub(crate) fn write(recording: &Recording, decimals: &Decimals, path: &Path) -> Result<(), Error> {
    let file = File::create(path).map_err(Error::file(path))?;
    let mut out = BufWriter::new(file);
    rows(recording, decimals, &mut out).and_then(|()| out.flush()).map_err(Error::file(path))
}

fn rows(recording: &Recording, decimals: &Decimals, out: &mut impl Write) -> std::io::Result<()> {
    let names: Vec<&str> = recording.channels.keys().map(|channel| channel.name()).collect();
    writeln!(out, "run,t_s,{}", names.join(","))?;
    for run in &recording.runs {
        for row in run.rows.clone() {
            write!(out, "{},{:.TIME_DECIMALS$}", run.name, recording.t_s[row])?;
            for (channel, values) in &recording.channels {
                let digits = decimals.get(channel).copied().unwrap_or(MOST_DECIMALS);
                match values[row] {
                    value if value.is_finite() => write!(out, ",{value:.digits$}")?,
                    _ => write!(out, ",")?,
                }
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use recording::read_paths;

    use super::*;
    use crate::real::ground::tests::drives;

    #[test]
    fn what_is_written_is_read_as_it_was_and_changed_numbers_have_no_more_digits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("recording.csv");
        let mut recording = drives(&[12, 15], 0.0125);
        recording.surface = None;
        let known = decimals(&recording);
        assert_eq!((known[&Channel::Pitch], known[&Channel::LeftSpeed]), (4, 1));
        recording.channels.entry(Channel::Pitch).or_default()[3] = 0.012_345_678;
        // A hole at the beginning has no neighbours to be filled from.
        recording.channels.entry(Channel::Roll).or_default()[0] = f64::NAN;
        write(&recording, &known, &path).unwrap();
        let read = read_paths(&[&path], None).unwrap().0;
        assert_eq!((read.rows(), read.runs.len(), &read.t_s), (27, 2, &recording.t_s));
        assert_eq!(read.channel(Channel::Pitch).unwrap()[3], 0.0123);
        assert!(read.channel(Channel::Roll).unwrap()[0].is_nan());
    }
}
