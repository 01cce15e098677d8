//! The table that every format is read into.

use std::{
    collections::{BTreeMap, HashMap},
    ops::Range,
};

use serde::Serialize;

use crate::{
    Channel,
    gap::{self, Gaps},
};

/// Drives of a robot as rows of channels in SI units. Made by the readers, which check it: every column has as many
/// values as there are times, runs cover the rows in order, times are finite and increase within a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Time of each row \[s\], increasing within a run.
    pub t_s: Vec<f64>,
    /// Channels by row; NaN is a gap.
    pub channels: BTreeMap<Channel, Vec<f64>>,
    /// Columns that are no channel, by their own names and in their own units; NaN is a gap.
    pub aside: BTreeMap<String, Vec<f64>>,
    /// The surface driven on, by row.
    pub surface: Option<Labels>,
    /// The drives, in order.
    pub runs: Vec<Run>,
    /// By row, whether a reading of a power meter that is slower than the wheels ends with it: power then holds over the rows since the reading
    /// before, of which it is the mean. Empty where power has the rhythm of the rows.
    pub reading_ends: Vec<bool>,
    /// Wheel radius that turned angular rates of wheels into rim speeds; `None` where rim speeds were recorded \[m\].
    pub wheel_radius_m: Option<f64>,
}

/// One drive: consecutive rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its name, unique in the recording.
    pub name: String,
    /// Its rows.
    pub rows: Range<usize>,
    /// Steps of time longer than this are gaps, over which nothing may be integrated or interpolated, unless the rhythm around them is as slow
    /// \[s\]; [`Recording::step_s`] judges each.
    pub gap_s: f64,
    /// Unix time of `t_s = 0`, where the source tells \[s\].
    pub start_unix_s: Option<f64>,
}

/// A text column: names and which of them each row has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// The distinct names, in order of appearance.
    pub names: Vec<String>,
    /// By row, the index of its name; [`Labels::NONE`] where there is none.
    pub index: Vec<u32>,
}

/// In which of the contract's forms a recording tells power.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum PowerForm {
    /// `power_left_w` and `power_right_w`.
    Sides,
    /// `power_w`.
    Battery,
    /// `current_a` and `voltage_v`.
    CurrentAndVoltage,
    /// `motor_current_left_a` and `motor_current_right_a`.
    MotorCurrents,
}

impl PowerForm {
    /// The forms, the most telling first, with the channels that each needs.
    pub const ALL: [(PowerForm, [Channel; 2]); 4] = [
        (PowerForm::Sides, [Channel::LeftPower, Channel::RightPower]),
        (PowerForm::Battery, [Channel::Power, Channel::Power]),
        (PowerForm::CurrentAndVoltage, [Channel::Current, Channel::Voltage]),
        (PowerForm::MotorCurrents, [Channel::LeftMotorCurrent, Channel::RightMotorCurrent]),
    ];

    /// The channels that it needs.
    pub fn channels(self) -> [Channel; 2] {
        let own = PowerForm::ALL.iter().find(|(form, _)| *form == self);
        own.map_or([Channel::Power; 2], |(_, channels)| *channels)
    }
}

impl Recording {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.t_s.len()
    }

    /// Duration of all runs \[s\].
    pub fn duration_s(&self) -> f64 {
        let of_run = |run: &Run| {
            let end = run.rows.end.saturating_sub(1);
            self.t_s.get(end).zip(self.t_s.get(run.rows.start)).map_or(0.0, |(end, start)| end - start)
        };
        self.runs.iter().map(of_run).sum()
    }

    /// A channel by row, NaN in gaps; `None` where the recording lacks it.
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(&channel).map(Vec::as_slice)
    }

    /// The most telling form of power that the recording holds.
    pub fn power_form(&self) -> Option<PowerForm> {
        let holds = |channel: &Channel| self.channels.contains_key(channel);
        PowerForm::ALL.iter().find(|(_, needs)| needs.iter().all(holds)).map(|(form, _)| *form)
    }

    /// Whether readings of a slow power meter end in a run.
    pub fn has_slow_meter(&self, run: &Run) -> bool {
        self.reading_ends.get(run.rows.clone()).is_some_and(|ends| ends.contains(&true))
    }

    /// The time from a row of a run to the next \[s\]; `None` for its last row and before a gap. A gap is told by the rhythm around it: a
    /// robot that reports once a minute while it is parked has no gaps there, and one of 100 s where it drives.
    pub fn step_s(&self, run: &Run, row: usize) -> Option<f64> {
        if row + 1 >= run.rows.end || row < run.rows.start {
            return None;
        }
        let step_s = self.t_s.get(row + 1)? - self.t_s.get(row)?;
        let t_s = self.t_s.get(run.rows.clone())?;
        let is_gap = Gaps::OutOfRhythm(run.gap_s).is_gap(t_s, row - run.rows.start);
        (!is_gap).then_some(step_s)
    }

    /// The same drives with some of their runs alone.
    pub fn of_runs(&self, keep: impl Fn(&Run) -> bool) -> Recording {
        let kept: Vec<&Run> = self.runs.iter().filter(|run| keep(run)).collect();
        fn column<T: Copy>(kept: &[&Run], values: &[T]) -> Vec<T> {
            kept.iter().flat_map(|run| values.get(run.rows.clone()).unwrap_or_default()).copied().collect()
        }
        let columns = |values: &Vec<f64>| column(&kept, values);
        let mut from = 0;
        let run = |run: &&Run| {
            let rows = from..from + run.rows.len();
            from = rows.end;
            Run { rows, ..(*run).clone() }
        };
        Recording {
            t_s: columns(&self.t_s),
            channels: self.channels.iter().map(|(channel, values)| (*channel, columns(values))).collect(),
            aside: self.aside.iter().map(|(name, values)| (name.clone(), columns(values))).collect(),
            surface: self
                .surface
                .as_ref()
                .map(|labels| Labels { names: labels.names.clone(), index: column(&kept, &labels.index) }),
            reading_ends: column(&kept, &self.reading_ends),
            runs: kept.iter().map(run).collect(),
            wheel_radius_m: self.wheel_radius_m,
        }
    }

    /// The runs of several recordings behind one another. A channel that one of them lacks is a gap there, but for the power of a
    /// battery whose current and voltage it has; a run whose name is taken gets a number behind it.
    pub fn join(parts: impl IntoIterator<Item = Recording>) -> Recording {
        let mut joined = Recording::default();
        let mut names = RunNames::default();
        let mut parts: Vec<Recording> = parts.into_iter().collect();
        if parts.iter().any(|part| part.channel(Channel::Power).is_some()) {
            parts.iter_mut().for_each(Recording::tell_battery_power);
        }
        for part in parts {
            joined.append(part, &mut names);
        }
        joined
    }

    /// Multiplies current and voltage where the power of the battery is not told itself.
    fn tell_battery_power(&mut self) {
        let factors = self.channel(Channel::Current).zip(self.channel(Channel::Voltage));
        if let (None, Some((current_a, voltage_v))) = (self.channel(Channel::Power), factors) {
            let power_w = current_a.iter().zip(voltage_v).map(|(i, u)| i * u).collect();
            self.channels.insert(Channel::Power, power_w);
        }
    }

    fn append(&mut self, part: Recording, names: &mut RunNames) {
        let (before, added) = (self.rows(), part.rows());
        self.wheel_radius_m = self.wheel_radius_m.or(part.wheel_radius_m);
        self.t_s.extend(part.t_s);
        append_columns(&mut self.channels, part.channels, before, added);
        append_columns(&mut self.aside, part.aside, before, added);
        if self.surface.is_some() || part.surface.is_some() {
            let surface = self.surface.get_or_insert_with(|| Labels::unnamed(before));
            surface.append(&part.surface.unwrap_or_else(|| Labels::unnamed(added)));
        }
        if !(self.reading_ends.is_empty() && part.reading_ends.is_empty()) {
            self.reading_ends.resize(before, false);
            self.reading_ends.extend(part.reading_ends);
            self.reading_ends.resize(before + added, false);
        }
        for mut run in part.runs {
            run.name = names.free(run.name);
            run.rows = run.rows.start + before..run.rows.end + before;
            self.runs.push(run);
        }
    }
}

/// Names of runs that are taken, each with the number that the next run of that name gets.
#[derive(Default)]
struct RunNames(HashMap<String, u64>);

impl RunNames {
    /// The name, with a number behind it where it is taken. Every number of a name is tried once, however many runs share it.
    fn free(&mut self, name: String) -> String {
        let mut number = match self.0.get(&name) {
            None => {
                self.0.insert(name.clone(), 2);
                return name;
            }
            Some(number) => *number,
        };
        let mut numbered = format!("{name}-{number}");
        while self.0.contains_key(&numbered) {
            number += 1;
            numbered = format!("{name}-{number}");
        }
        self.0.insert(name, number + 1);
        self.0.insert(numbered.clone(), 2);
        numbered
    }
}

fn append_columns<K: Ord>(
    columns: &mut BTreeMap<K, Vec<f64>>,
    part: BTreeMap<K, Vec<f64>>,
    before: usize,
    added: usize,
) {
    for (key, values) in part {
        columns.entry(key).or_insert_with(|| vec![f64::NAN; before]).extend(values);
    }
    for values in columns.values_mut() {
        values.resize(before + added, f64::NAN);
    }
}

impl Run {
    /// A run over rows of a recording, its gaps told by its own rhythm.
    pub(crate) fn new(name: String, rows: Range<usize>, t_s: &[f64], start_unix_s: Option<f64>) -> Run {
        let gap_s = gap::threshold_s(t_s.get(rows.clone()).unwrap_or_default());
        Run { name, rows, gap_s, start_unix_s }
    }
}

impl Labels {
    /// The index of a row without a name.
    pub const NONE: u32 = u32::MAX;

    /// The name of a row.
    pub fn get(&self, row: usize) -> Option<&str> {
        let index = *self.index.get(row)?;
        self.names.get(index as usize).map(String::as_str)
    }

    /// The same name for every row.
    pub fn constant(name: &str, rows: usize) -> Labels {
        Labels { names: vec![name.to_owned()], index: vec![0; rows] }
    }

    /// Gives rows without a name this one.
    pub fn name_the_rest(&mut self, name: &str) {
        if !self.index.contains(&Labels::NONE) {
            return;
        }
        let known = self.names.iter().position(|other| other == name);
        let place = known.unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        });
        let place = u32::try_from(place).unwrap_or(Labels::NONE);
        self.index.iter_mut().filter(|index| **index == Labels::NONE).for_each(|index| *index = place);
    }

    pub(crate) fn unnamed(rows: usize) -> Labels {
        Labels { names: Vec::new(), index: vec![Labels::NONE; rows] }
    }

    fn append(&mut self, part: &Labels) {
        let mut known: HashMap<String, u32> = self.names.iter().cloned().zip(0u32..).collect();
        let mut index_of = |name: &String| {
            *known.entry(name.clone()).or_insert_with(|| {
                self.names.push(name.clone());
                u32::try_from(self.names.len() - 1).unwrap_or(Labels::NONE)
            })
        };
        let renamed: Vec<u32> = part.names.iter().map(&mut index_of).collect();
        let new = |index: &u32| renamed.get(*index as usize).copied().unwrap_or(Labels::NONE);
        self.index.extend(part.index.iter().map(new));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(channel: Channel, surface: Option<&str>) -> Recording {
        let t_s = vec![0.0, 0.1, 0.2, 0.9];
        Recording {
            channels: BTreeMap::from([(channel, vec![1.0, 2.0, 3.0, 4.0])]),
            surface: surface.map(|name| Labels::constant(name, 4)),
            runs: vec![Run::new("drive".into(), 0..4, &t_s, None)],
            t_s,
            ..Recording::default()
        }
    }

    #[test]
    fn joined_recordings_keep_their_runs_apart_and_lacking_channels_as_gaps() {
        let joined = Recording::join([part(Channel::Power, None), part(Channel::Current, Some("ice"))]);
        assert_eq!(joined.rows(), 8);
        assert_eq!(joined.runs[1].name, "drive-2");
        assert_eq!(joined.runs[1].rows, 4..8);
        let power_w = joined.channel(Channel::Power).unwrap();
        assert!(power_w[..4] == [1.0, 2.0, 3.0, 4.0] && power_w[4..].iter().all(|p| p.is_nan()));
        assert!(joined.channel(Channel::Current).unwrap()[..4].iter().all(|i| i.is_nan()));
        let surface = joined.surface.unwrap();
        assert_eq!((surface.get(0), surface.get(7)), (None, Some("ice")));
    }

    #[test]
    fn some_runs_of_a_recording_are_what_each_of_them_was() {
        let joined = Recording::join([part(Channel::Power, None), part(Channel::Power, Some("ice"))]);
        let second = joined.of_runs(|run| run.name == "drive-2");
        let alone = part(Channel::Power, Some("ice"));
        assert_eq!((&second.t_s, &second.channels), (&alone.t_s, &alone.channels));
        assert_eq!((second.runs.len(), second.runs[0].rows.clone()), (1, 0..4));
        assert_eq!(second.surface.as_ref().unwrap().get(3), Some("ice"));
        assert_eq!(joined.of_runs(|_| true), joined);
        assert_eq!(joined.of_runs(|_| false).rows(), 0);
    }

    #[test]
    fn rows_without_a_name_get_one_and_others_keep_theirs() {
        let joined = Recording::join([part(Channel::Power, None), part(Channel::Power, Some("ice"))]);
        let mut surface = joined.surface.unwrap();
        surface.name_the_rest("mud");
        assert_eq!((surface.get(0), surface.get(7)), (Some("mud"), Some("ice")));
        let before = surface.clone();
        surface.name_the_rest("moss");
        assert_eq!(surface, before, "every row has its name");
    }

    #[test]
    fn a_step_over_a_gap_or_out_of_the_run_is_none() {
        let recording = part(Channel::Power, None);
        let run = &recording.runs[0];
        let steps: Vec<bool> = (0..4).map(|row| recording.step_s(run, row).is_some()).collect();
        assert_eq!(steps, [true, true, false, false]);
    }

    #[test]
    fn the_most_telling_form_of_power_is_taken() {
        let mut recording = part(Channel::Current, None);
        assert_eq!(recording.power_form(), None);
        recording.channels.insert(Channel::Voltage, vec![24.0; 4]);
        assert_eq!(recording.power_form(), Some(PowerForm::CurrentAndVoltage));
        recording.channels.insert(Channel::Power, vec![24.0; 4]);
        assert_eq!(recording.power_form(), Some(PowerForm::Battery));
    }
}
