//! Columns of a table that have a rhythm of their own, brought onto one clock.
//!
//! Topics that are joined on the union of their stamps, as PlotJuggler and pandas do it, and loggers that write slow channels into every
//! n-th row leave cells empty between a channel's samples. Such a hole is none in the drive: a channel's own step says which holes are. As
//! for the topics of a bag, the rows are the stamps of the slowest channel that power is computed from, or those of the wheels where
//! that is a meter which is slower than robots move (`meter`).

use std::ops::Range;

use crate::{
    Channel, Error, Labels, PowerForm, Recording, Repair, Run,
    align::{Between, interpolate_within},
    gap::{self, Gaps},
    meter,
    watch::Looks,
};

/// Share of rows with a value from which on a channel of power is taken to have the rhythm of the rows and single holes.
const ROWS_OWN_SHARE: f64 = 0.7;

/// Share of the empty cells that have to lie between samples of one rhythm for a channel to have its own.
const RHYTHM_SHARE: f64 = 0.8;

/// Fewer samples show no rhythm.
const LEAST_SAMPLES: usize = 5;

/// Share of rows without a value, after all, that is worth telling, and the rows of which it is a share.
const TELLING_SHARE: f64 = 0.01;
const TELLING_ROWS: usize = 20;

/// Brings the channels of every run onto one clock: where power is sampled more slowly than there are rows, its samples become the rows;
/// empty cells between two samples no farther apart than `max_gap_s`, by default three of the channel's own median steps, are interpolated
/// linearly, headings on the shorter arc.
pub(crate) fn onto_one_clock(
    recording: &mut Recording,
    max_gap_s: Option<f64>,
    repairs: &mut Vec<Repair>,
    looks: &Looks,
) -> Result<(), Error> {
    if recording.channels.values().all(|values| values.iter().all(|value| !value.is_nan())) {
        return Ok(());
    }
    let clocks: Vec<Clock> = recording.runs.iter().map(|run| Clock::of(recording, run, max_gap_s)).collect();
    repairs.extend(clocks.iter().filter_map(|clock| clock.told(recording)));
    let is_thinner = clocks.iter().any(|clock| clock.base.is_some());
    let (mut all_filled, mut all_empty) = (Vec::new(), Vec::new());
    for (channel, values) in &mut recording.channels {
        looks.go_on()?;
        let between = if *channel == Channel::Heading { Between::ShorterArc } else { Between::Line };
        let (mut moved, mut filled) = (Vec::with_capacity(values.len()), 0);
        for clock in &clocks {
            filled += match &clock.meter {
                Some(_) if *channel != Channel::Voltage && channel.tells_power() => {
                    clock.hold(&recording.t_s, values, max_gap_s, &mut moved)
                }
                _ => clock.read(&recording.t_s, values, max_gap_s, between, &mut moved),
            };
        }
        *values = moved;
        all_empty.extend(told_empty(*channel, values));
        // A lost cell now and then is no news.
        if filled as f64 > TELLING_SHARE * values.len() as f64 {
            all_filled.push((*channel, filled));
        }
    }
    repairs.extend(told_filled(&all_filled).into_iter().chain(all_empty));
    if is_thinner {
        for values in recording.aside.values_mut() {
            looks.go_on()?;
            let mut moved = Vec::new();
            for clock in &clocks {
                clock.read(&recording.t_s, values, max_gap_s, Between::Line, &mut moved);
            }
            *values = moved;
        }
        keep_rows(recording, &clocks);
    }
    mark_readings(recording, &clocks);
    Ok(())
}

/// What was filled in which channels.
fn told_filled(filled: &[(Channel, usize)]) -> Option<Repair> {
    let counts: Vec<String> = filled.iter().map(|(channel, count)| format!("{count} of {channel}")).collect();
    let what = format!(
        "{} were interpolated between samples of the column, over {} of its own steps at most",
        counts.join(", "),
        gap::GAP_STEPS
    );
    (!counts.is_empty()).then(|| Repair { place: "empty cells".into(), what })
}

/// What stays empty of a channel that a model needs.
fn told_empty(channel: Channel, values: &[f64]) -> Option<Repair> {
    let is_needed =
        channel.tells_power() || matches!(channel, Channel::LeftSpeed | Channel::RightSpeed | Channel::Pitch);
    let empty = values.iter().filter(|value| value.is_nan()).count();
    let is_telling = values.len() >= TELLING_ROWS && empty as f64 > TELLING_SHARE * values.len() as f64;
    // A prediction goes on where only the slope is missing.
    let then = match channel {
        Channel::Pitch => "predictions take the ground for level there",
        _ => "no energy is counted there",
    };
    let what = format!(
        "{empty} of {} rows have no value, in holes that are too long to interpolate over; {then}",
        values.len()
    );
    (is_needed && is_telling && empty < values.len())
        .then(|| Repair { place: format!("column {channel}"), what })
}

/// Marks where readings of slow meters end.
fn mark_readings(recording: &mut Recording, clocks: &[Clock]) {
    if clocks.iter().all(|clock| clock.meter.is_none()) {
        return;
    }
    let mut ends = vec![false; recording.rows()];
    for (run, clock) in recording.runs.iter().zip(clocks) {
        let Some((_, stamps_s)) = &clock.meter else { continue };
        let readings: Vec<(f64, f64)> = stamps_s.iter().map(|t_s| (*t_s, 0.0)).collect();
        let held = meter::held(&readings, &recording.t_s[run.rows.clone()]);
        ends[run.rows.clone()].copy_from_slice(&held.ends);
    }
    recording.reading_ends = ends;
}

/// Takes the rows of the clocks for times, labels and runs.
fn keep_rows(recording: &mut Recording, clocks: &[Clock]) {
    if let Some(surface) = &mut recording.surface {
        surface.index = clocks.iter().flat_map(|clock| clock.labels(surface)).collect();
    }
    let mut from = 0;
    let t_s: Vec<f64> = clocks.iter().flat_map(|clock| &clock.rows).map(|row| recording.t_s[*row]).collect();
    for (run, clock) in recording.runs.iter_mut().zip(clocks) {
        let rows = from..from + clock.rows.len();
        from = rows.end;
        // Runs whose rows stay keep what was found of them.
        *run = Run::new(run.name.clone(), rows, &t_s, run.start_unix_s);
    }
    recording.t_s = t_s;
}

/// The rows of a run that stay.
struct Clock {
    run: Run,
    rows: Vec<usize>,
    /// The channel whose samples they are; `None` where all rows stay.
    base: Option<Channel>,
    /// The channel of power whose readings hold over their periods, and their times \[s\].
    meter: Option<(Channel, Vec<f64>)>,
}

impl Clock {
    fn of(recording: &Recording, run: &Run, max_gap_s: Option<f64>) -> Clock {
        let all = || Clock { run: run.clone(), rows: run.rows.clone().collect(), base: None, meter: None };
        let Some((base, samples)) = slowest_of_power(recording, run) else { return all() };
        // Rows before its first and behind its last sample show nothing of its rhythm.
        let spanned = samples.first().zip(samples.last()).map_or(0, |(first, last)| last - first + 1);
        let is_dense = samples.len() as f64 >= ROWS_OWN_SHARE * spanned as f64;
        if is_dense || !has_rhythm(&recording.t_s, &samples) {
            return all();
        }
        let own_s: Vec<f64> = samples.iter().map(|row| recording.t_s[*row]).collect();
        let (wheel, wheels) = slowest_wheel(recording, run);
        let wheels_s: Vec<f64> = wheels.iter().map(|row| recording.t_s[*row]).collect();
        let steps = gap::median_step_s(&own_s).zip(gap::median_step_s(&wheels_s));
        if wheels.len() >= LEAST_SAMPLES
            && steps.is_some_and(|(own_s, wheel_s)| meter::is_slow(own_s, wheel_s, max_gap_s))
        {
            let is_all = wheels.len() == run.rows.len();
            let meter = Some((base, own_s));
            let rows = with_ends(&recording.t_s, run, wheels);
            return Clock { run: run.clone(), rows, base: (!is_all).then_some(wheel), meter };
        }
        let rows = with_ends(&recording.t_s, run, samples);
        Clock { run: run.clone(), rows, base: Some(base), meter: None }
    }

    fn told(&self, recording: &Recording) -> Option<Repair> {
        if let Some((meter, stamps_s)) = &self.meter {
            let what = meter_words(meter.name(), gap::median_step_s(stamps_s)?);
            return Some(Repair { place: format!("run `{}`", self.run.name), what });
        }
        let base = self.base?;
        let t_s: Vec<f64> = self.rows.iter().map(|row| recording.t_s[*row]).collect();
        let step_s = gap::median_step_s(&t_s)?;
        let what = format!(
            "{base} has a value in {} of {} rows, about {step_s:.3} s apart: these are the rows now, at which the other channels are \
             interpolated between their own samples",
            self.rows.len(),
            self.run.rows.len()
        );
        Some(Repair { place: format!("run `{}`", self.run.name), what })
    }

    /// Appends a column at the rows that stay; tells how many empty cells of them were filled.
    fn read(
        &self,
        t_s: &[f64],
        values: &[f64],
        max_gap_s: Option<f64>,
        between: Between,
        moved: &mut Vec<f64>,
    ) -> usize {
        let rows = self.run.rows.clone();
        let kept = self.rows.iter().map(|row| values[*row]);
        let is_empty = |value: f64| value.is_nan();
        if !values[rows.clone()].iter().copied().any(is_empty) {
            moved.extend(kept);
            return 0;
        }
        let samples: Vec<f64> =
            rows.clone().filter(|row| !values[*row].is_nan()).map(|row| t_s[row]).collect();
        if samples.len() < LEAST_SAMPLES {
            moved.extend(kept);
            return 0;
        }
        let at_s: Vec<f64> = self.rows.iter().map(|row| t_s[*row]).collect();
        let before = kept.filter(|value| is_empty(*value)).count();
        let start = moved.len();
        moved.extend(interpolate_within(&t_s[rows.clone()], &values[rows], &at_s, max_gap_s, between));
        before - moved[start..].iter().copied().filter(|value| is_empty(*value)).count()
    }

    /// Appends a column of power at the rows that stay: held over its periods where it is slow, else interpolated; tells how many empty cells
    /// were filled by interpolation.
    fn hold(&self, t_s: &[f64], values: &[f64], max_gap_s: Option<f64>, moved: &mut Vec<f64>) -> usize {
        let known = self.run.rows.clone().filter(|row| !values[*row].is_nan());
        let readings: Vec<(f64, f64)> = known.map(|row| (t_s[row], values[row])).collect();
        let own_s: Vec<f64> = readings.iter().map(|reading| reading.0).collect();
        let at_s: Vec<f64> = self.rows.iter().map(|row| t_s[*row]).collect();
        let steps = gap::median_step_s(&own_s).zip(gap::median_step_s(&at_s));
        if steps.is_some_and(|(own_s, row_s)| meter::is_slow(own_s, row_s, max_gap_s)) {
            moved.extend(meter::held(&readings, &at_s).values);
            return 0;
        }
        self.read(t_s, values, max_gap_s, Between::Line, moved)
    }

    /// The label of each row that stays: its own, or else that of the row before with one.
    fn labels(&self, labels: &Labels) -> Vec<u32> {
        let (mut last, mut at) = (Labels::NONE, self.run.rows.start);
        let mut kept = Vec::with_capacity(self.rows.len());
        for &row in &self.rows {
            for index in &labels.index[at..=row] {
                last = if *index == Labels::NONE { last } else { *index };
            }
            at = row + 1;
            kept.push(last);
        }
        kept
    }
}

/// Rows of samples, and at about their step those of the run before the first and behind the last: a channel that ends before the drive
/// leaves seconds that are told, not fewer seconds.
fn with_ends(t_s: &[f64], run: &Run, samples: Vec<usize>) -> Vec<usize> {
    let own_s: Vec<f64> = samples.iter().map(|row| t_s[*row]).collect();
    let ends = samples.first().zip(samples.last()).zip(gap::median_step_s(&own_s));
    let Some(((&first, &last), step_s)) = ends else { return samples };
    // Within a gap of the ends is where any two rhythms begin and end.
    let is_far = |one: usize, other: usize| t_s[other] - t_s[one] > gap::GAP_STEPS * step_s;
    let mut rows = Vec::with_capacity(samples.len());
    if is_far(run.rows.start, first) {
        thin(t_s, run.rows.start..first, step_s, &mut rows);
    }
    rows.extend(&samples);
    if is_far(last, run.rows.end - 1) {
        thin(t_s, last + 1..run.rows.end, step_s, &mut rows);
    }
    rows
}

/// Appends rows no closer to one another than a step, the last of them in any case.
fn thin(t_s: &[f64], rows: Range<usize>, step_s: f64, kept: &mut Vec<usize>) {
    let end = rows.end;
    for row in rows {
        let is_next =
            kept.last().is_none_or(|last| t_s[row] - t_s[*last] >= (1.0 - gap::STEP_ROUNDING) * step_s);
        if is_next || row + 1 == end {
            kept.push(row);
        }
    }
}

/// The channel of power that is sampled most slowly in a run, and the rows of its samples. A voltage changes little and is left out.
fn slowest_of_power(recording: &Recording, run: &Run) -> Option<(Channel, Vec<usize>)> {
    let samples = |channel: Channel| -> Vec<usize> {
        let values = recording.channel(channel).unwrap_or_default();
        run.rows.clone().filter(|row| values.get(*row).is_some_and(|value| !value.is_nan())).collect()
    };
    let holds =
        |channels: &[Channel; 2]| channels.iter().all(|channel| samples(*channel).len() >= LEAST_SAMPLES);
    let (_, channels) = PowerForm::ALL.iter().find(|(_, channels)| holds(channels))?;
    let telling = channels.iter().filter(|channel| **channel != Channel::Voltage);
    telling.map(|channel| (*channel, samples(*channel))).min_by_key(|(_, samples)| samples.len())
}

/// The side's speed that is sampled more slowly in a run, and the rows of its samples.
fn slowest_wheel(recording: &Recording, run: &Run) -> (Channel, Vec<usize>) {
    let samples = |channel: Channel| -> (Channel, Vec<usize>) {
        let values = recording.channel(channel).unwrap_or_default();
        let known = |row: &usize| values.get(*row).is_some_and(|value| !value.is_nan());
        (channel, run.rows.clone().filter(known).collect())
    };
    let (left, right) = (samples(Channel::LeftSpeed), samples(Channel::RightSpeed));
    if right.1.len() < left.1.len() { right } else { left }
}

/// What a reading says of a slow meter.
pub(crate) fn meter_words(meter: &str, step_s: f64) -> String {
    format!(
        "{meter} has a reading every {step_s:.3} s, which is slower than the wheels: the rows are the wheels', and each reading holds over the \
         time since the one before, to be compared with the mean of what is predicted over its period"
    )
}

/// Whether most rows between samples lie within steps that are no gaps of the samples' own rhythm.
fn has_rhythm(t_s: &[f64], samples: &[usize]) -> bool {
    let own_s: Vec<f64> = samples.iter().map(|row| t_s[*row]).collect();
    let gaps = Gaps::of(&own_s, None);
    let (mut within, mut between) = (0, 0);
    for (at, pair) in samples.windows(2).enumerate() {
        let rows = pair[1] - pair[0] - 1;
        between += rows;
        within += if gaps.is_gap(&own_s, at) { 0 } else { rows };
    }
    within as f64 >= RHYTHM_SHARE * between as f64
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use approx::assert_relative_eq;

    use super::*;
    use crate::unwatched;

    const DURATION_S: f64 = 60.0;

    fn power_w(t_s: f64) -> f64 {
        100.0 + 40.0 * (0.3 * t_s).sin()
    }

    /// Wheels every 0.1 s, and power by its own step and offset, on the union of their stamps.
    fn joined(step_s: f64, offset_s: f64) -> Recording {
        let ticks = |step_s: f64| (DURATION_S / step_s) as usize;
        let wheels = (0..ticks(0.1)).map(|i| (0.1 * i as f64, false));
        let power = (0..ticks(step_s)).map(|i| (step_s * i as f64 + offset_s, true));
        let mut rows: Vec<(f64, bool)> = wheels.chain(power).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let t_s: Vec<f64> = rows.iter().map(|row| row.0).collect();
        let column = |of_power: bool, of: fn(f64) -> f64| -> Vec<f64> {
            rows.iter().map(|row| if row.1 == of_power { of(row.0) } else { f64::NAN }).collect()
        };
        let channels = BTreeMap::from([
            (Channel::LeftSpeed, column(false, |t| 0.5 + 0.01 * t)),
            (Channel::RightSpeed, column(false, |t| 0.5 - 0.01 * t)),
            (Channel::Power, column(true, power_w)),
        ]);
        let runs = vec![Run::new("drive".into(), 0..t_s.len(), &t_s, None)];
        Recording { t_s, channels, runs, ..Recording::default() }
    }

    fn aligned(mut recording: Recording) -> (Recording, Vec<Repair>) {
        let mut repairs = Vec::new();
        onto_one_clock(&mut recording, None, &mut repairs, &Looks::new(&unwatched())).unwrap();
        (recording, repairs)
    }

    /// The trapezoid over steps that are no gaps.
    fn energy_j(recording: &Recording) -> f64 {
        let power_w = recording.channel(Channel::Power).unwrap();
        let run = &recording.runs[0];
        let area = |row: usize| Some(recording.step_s(run, row)? * (power_w[row] + power_w[row + 1]) / 2.0);
        (0..recording.rows()).filter_map(area).filter(|joules| joules.is_finite()).sum()
    }

    #[test]
    fn no_rhythm_of_power_beside_the_wheels_loses_energy() {
        let truth_j: f64 = (0..60_000).map(|i| 1e-3 * power_w(1e-3 * f64::from(i))).sum();
        for (step_s, offset_s) in
            [(1.0, 0.043), (0.2, 0.043), (0.1, 0.043), (0.1, 1e-5), (0.02, 0.003), (0.5, 0.0001), (2.0, 0.01)]
        {
            let (recording, repairs) = aligned(joined(step_s, offset_s));
            let lost = 1.0 - energy_j(&recording) / truth_j;
            assert!(lost.abs() < 0.04, "{step_s} s, {offset_s} s: {lost} {repairs:?}");
            for channel in [Channel::LeftSpeed, Channel::RightSpeed] {
                let values = recording.channel(channel).unwrap();
                let empty = values.iter().filter(|value| value.is_nan()).count();
                assert!(empty as f64 <= 3.0 + 0.01 * values.len() as f64, "{step_s} s: {empty} of {channel}");
            }
            assert!(!repairs.is_empty());
        }
    }

    #[test]
    fn short_holes_are_filled_and_long_ones_stay_and_are_told() {
        let mut recording = joined(0.1, 0.0);
        let t_s: Vec<f64> = (0..600).map(|i| 0.1 * f64::from(i)).collect();
        let power = t_s.iter().map(|t| if (20.0..30.0).contains(t) { f64::NAN } else { power_w(*t) });
        let mut power: Vec<f64> = power.collect();
        (80..101).step_by(2).for_each(|row| power[row] = f64::NAN);
        power[300] = f64::NAN;
        recording.channels = BTreeMap::from([(Channel::Power, power)]);
        recording.runs = vec![Run::new("drive".into(), 0..600, &t_s, None)];
        recording.t_s = t_s;
        let (recording, repairs) = aligned(recording);
        let power = recording.channel(Channel::Power).unwrap();
        assert_relative_eq!(power[100], power_w(10.0), epsilon = 0.1);
        let empty: Vec<usize> = (0..600).filter(|row| power[*row].is_nan()).collect();
        assert_eq!((recording.rows(), empty.first(), empty.last()), (600, Some(&200), Some(&300)));
        assert!(repairs[0].what.starts_with("11 of power_w were interpolated"), "{repairs:?}");
        assert!(repairs[1].what.starts_with("101 of 600 rows have no value"), "{repairs:?}");
    }

    #[test]
    fn a_channel_that_ends_before_the_drive_does_leaves_its_seconds_in_the_recording() {
        for (step_s, offset_s) in [(0.1, 0.0), (0.1, 0.043), (0.2, 0.043), (1.0, 0.043), (0.02, 0.003)] {
            for (from_s, until_s) in [(0.0, 30.0), (30.0, 60.0), (20.0, 40.0)] {
                let mut recording = joined(step_s, offset_s);
                let t_s = recording.t_s.clone();
                let power = recording.channels.get_mut(&Channel::Power).unwrap();
                let lost = |t: f64| t < from_s || t > until_s;
                power.iter_mut().zip(&t_s).for_each(|(watts, t)| {
                    if lost(*t) {
                        *watts = f64::NAN;
                    }
                });
                let (recording, _) = aligned(recording);
                let power = recording.channel(Channel::Power).unwrap();
                let counted = |row: &usize| !power[*row].is_nan() && !power[*row + 1].is_nan();
                let counted_s: f64 = (0..recording.rows() - 1)
                    .filter(counted)
                    .filter_map(|row| recording.step_s(&recording.runs[0], row))
                    .sum();
                assert_relative_eq!(recording.duration_s(), DURATION_S, epsilon = 1.5);
                assert_relative_eq!(counted_s, until_s - from_s, epsilon = 2.5 * step_s.max(0.1));
            }
        }
    }

    #[test]
    fn labels_hold_until_the_next_and_whole_tables_stay_as_they_are() {
        let mut recording = joined(1.0, 0.043);
        let label = |t: &f64| match () {
            () if *t == 0.0 => 0,
            () if (*t - 30.0).abs() < 1e-9 => 1,
            () => Labels::NONE,
        };
        let index = recording.t_s.iter().map(label).collect();
        recording.surface = Some(Labels { names: vec!["ice".into(), "mud".into()], index });
        let (recording, _) = aligned(recording);
        let surface = recording.surface.as_ref().unwrap();
        assert_eq!((surface.get(299), surface.get(300), recording.rows()), (Some("ice"), Some("mud"), 600));
        // Nothing tells NaN from NaN: the rows without a reading are those after the last one.
        let (again, repairs) = aligned(recording.clone());
        assert_eq!(again.t_s, recording.t_s);
        assert!(
            repairs.len() == 1 && repairs[0].what.starts_with("9 of 600 rows have no value"),
            "{repairs:?}"
        );
    }
}
