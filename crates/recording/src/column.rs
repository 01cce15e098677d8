//! From the columns of a table to a recording: which column is what, and what must hold of the rows.

use std::{borrow::Cow, mem};

use crate::{
    Channel, Combine, Conversion, Error, Ignored, Labels, Map, Quantity, Recording, Repair, Source,
    TimeError,
    bursts::spread_bursts,
    clock::{TimeSource, check_time},
    coarse::period,
    divide::divide,
    error::Position,
    label_column::LabelColumn,
    map::{Place, Target},
    opposed_part,
    own_clocks::onto_one_clock,
    rate::{beyond_wrap, rates, unwrapped},
    report::{ChannelReport, ReadingReport},
    same_time::merge_same_times,
    source_choice::told_rivals,
    stuck_part,
    table::Table,
    units,
};

/// Why a column of text is not used, in a text file and in Parquet.
pub(crate) const NOT_A_NUMBER: &str = "no channel, and not a number";
pub(crate) const TEXT: &str = "it holds text";

/// How a column of the file is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Numbers; anything else is an error.
    Number,
    /// Text.
    Label,
    /// Numbers, if it holds nothing else.
    Perhaps,
}

/// What was read from a column.
#[derive(Debug)]
pub(crate) enum Column {
    Numbers(Vec<f64>),
    Labels(LabelColumn),
    /// Nothing of use, and why.
    Unusable(String),
}

/// Which columns become what.
pub(crate) struct Plan {
    /// How to read each column of the file.
    pub(crate) kinds: Vec<Kind>,
    headers: Vec<String>,
    entries: Vec<Entry>,
    ignored: Vec<Ignored>,
    /// What has to be said of the map.
    repairs: Vec<Repair>,
    surface: Option<String>,
    max_gap_s: Option<f64>,
}

struct Entry {
    target: Target,
    columns: Vec<usize>,
    combine: Combine,
    separation_m: f64,
    conversion: Conversion,
    unit: String,
    /// Whether a map names the unit.
    is_unit_given: bool,
    /// Whether its columns are positions, whose rate of change is meant.
    is_derivative: bool,
    /// Where these begin again, in the unit of the channel.
    wraps_at: Option<f64>,
}

impl Plan {
    /// Plans by the map first; columns that it does not name and that bear a contract's name are what they say, others are
    /// kept aside.
    pub(crate) fn new(headers: Vec<String>, map: Option<&Map>) -> Result<Plan, Error> {
        for (index, header) in headers.iter().enumerate() {
            if !header.is_empty() && headers[..index].contains(header) {
                let (channel, first) = (header.clone(), header.clone());
                return Err(Error::Duplicate { channel, first, second: header.clone() });
            }
        }
        let mut plan = Plan {
            kinds: vec![Kind::Perhaps; headers.len()],
            entries: Vec::new(),
            ignored: Vec::new(),
            repairs: Vec::new(),
            surface: map.and_then(|map| map.surface.clone()),
            max_gap_s: map.and_then(|map| map.max_gap_s),
            headers,
        };
        plan.add_mapped(map);
        plan.add_named_by_contract()?;
        if plan.time().is_none() {
            return Err(Error::missing_names(&["t_s".into()], &["t_s"], &plan.headers));
        }
        for entry in &plan.entries {
            let kind = match entry.target {
                Target::Run | Target::Surface => Kind::Label,
                Target::Aside(_) => Kind::Perhaps,
                Target::Time | Target::Channel(_) => Kind::Number,
            };
            for column in &entry.columns {
                plan.kinds[*column] = kind;
            }
        }
        Ok(plan)
    }

    fn add_mapped(&mut self, map: Option<&Map>) {
        for source in map.map_or(&[][..], |map| &map.sources) {
            let Place::Columns(names) = &source.place else { continue };
            let position = |name: &String| self.headers.iter().position(|header| header == name);
            let columns: Option<Vec<usize>> = names.iter().map(position).collect();
            let taken = self.entries.iter().any(|entry| entry.target == source.target);
            let reason = match columns {
                None => "the map names it, but the file has no such column",
                Some(_) if taken => {
                    self.tell_rivals(map, source, names);
                    "an earlier source of the map gives the same channel"
                }
                Some(columns) => {
                    self.entries.push(Entry {
                        target: source.target.clone(),
                        columns,
                        combine: source.combine,
                        separation_m: source.separation_m,
                        conversion: source.conversion,
                        unit: source.unit.clone(),
                        is_unit_given: source.is_unit_given,
                        is_derivative: source.derivative,
                        wraps_at: source.wraps_at,
                    });
                    continue;
                }
            };
            self.ignored.push(Ignored { name: names.join(", "), reason: reason.into() });
        }
    }

    /// Says of a map of the user that the file has the columns of two of its sources of one channel.
    fn tell_rivals(&mut self, map: Option<&Map>, source: &Source, names: &[String]) {
        let Target::Channel(channel) = source.target else { return };
        let Some(first) = self.entries.iter().find(|entry| entry.target == source.target) else { return };
        if !map.is_some_and(Map::is_built_in) {
            let both = [self.names(first), names.join(", ")];
            self.repairs.extend(told_rivals(channel, &both, "", "`columns`"));
        }
    }

    fn add_named_by_contract(&mut self) -> Result<(), Error> {
        for (index, header) in self.headers.iter().enumerate() {
            if self.entries.iter().any(|entry| entry.columns.contains(&index)) {
                continue;
            }
            if header.is_empty() {
                let name = format!("column {}", index + 1);
                self.ignored.push(Ignored { name, reason: "it has no name".into() });
                continue;
            }
            let (target, unit) = match header.as_str() {
                "t_s" => (Target::Time, "s"),
                "run" => (Target::Run, ""),
                "surface" => (Target::Surface, ""),
                name => match Channel::from_name(name) {
                    Some(channel) => (Target::Channel(channel), units::si_unit(channel.quantity())),
                    None => (Target::Aside(name.to_owned()), ""),
                },
            };
            if let Some(other) = self.entries.iter().find(|entry| entry.target == target) {
                let first = other.columns.first().and_then(|&column| self.headers.get(column));
                let (first, channel) = (first.cloned().unwrap_or_default(), header.clone());
                return Err(Error::Duplicate { channel, first, second: header.clone() });
            }
            let (combine, conversion) = (Combine::Mean, Conversion::IDENTITY);
            let (columns, unit) = (vec![index], unit.into());
            let separation_m = f64::NAN;
            self.entries.push(Entry {
                target,
                columns,
                combine,
                separation_m,
                conversion,
                unit,
                is_unit_given: false,
                is_derivative: false,
                wraps_at: None,
            });
        }
        Ok(())
    }

    /// The column that tells time, or the first of those that do together.
    pub(crate) fn time(&self) -> Option<usize> {
        let entry = self.entries.iter().find(|entry| entry.target == Target::Time)?;
        entry.columns.first().copied()
    }

    /// Whether a column alone tells time.
    pub(crate) fn is_time(&self, column: usize) -> bool {
        let alone = |entry: &Entry| entry.target == Target::Time && entry.columns == [column];
        self.entries.iter().any(alone)
    }

    /// The columns that have to hold numbers.
    pub(crate) fn needed(&self) -> impl Iterator<Item = usize> {
        self.kinds.iter().enumerate().filter(|(_, kind)| **kind == Kind::Number).map(|(column, _)| column)
    }

    /// What a column alone is taken to measure, and in which unit; `None` where others belong to it.
    pub(crate) fn unit_of(&self, column: usize) -> Option<(Quantity, &str)> {
        let entry = self.entries.iter().find(|entry| entry.columns == [column])?;
        let quantity = match entry.target {
            Target::Time => Quantity::Time,
            Target::Channel(channel) => channel.quantity(),
            Target::Run | Target::Surface | Target::Aside(_) => return None,
        };
        Some((quantity, &entry.unit))
    }

    /// The name of a column.
    pub(crate) fn header(&self, column: usize) -> &str {
        self.headers.get(column).map_or("", String::as_str)
    }

    /// By column, where its numbers begin again, in their own unit: those of headings do.
    pub(crate) fn periods(&self) -> Vec<Option<f64>> {
        let mut periods = vec![None; self.headers.len()];
        let heading = Target::Channel(Channel::Heading);
        for entry in self.entries.iter().filter(|entry| entry.target == heading) {
            entry.columns.iter().for_each(|&column| periods[column] = Some(period(entry.conversion.factor)));
        }
        periods
    }

    /// The recording of what was read, and the beginning of its report. `position` says where a row of the file stands.
    pub(crate) fn assemble(
        mut self,
        mut table: Table,
        name: &str,
        position: impl Fn(usize) -> Position,
    ) -> Result<(Recording, ReadingReport), Error> {
        table.settle()?;
        let looks = table.looks().clone();
        let Table { mut columns, coarse, .. } = table;
        let position = |row: usize| position(coarse.first_in_file(row));
        let (t_s, time_column, map_unit) = self.take_time(&mut columns)?;
        if t_s.is_empty() {
            return Err(Error::Empty {
                found: format!("a header of {} columns and no row", self.headers.len()),
            });
        }
        let mut recording = Recording { t_s, ..Recording::default() };
        let mut report = ReadingReport { repairs: mem::take(&mut self.repairs), ..ReadingReport::default() };
        let mut runs = None;
        for entry in mem::take(&mut self.entries) {
            looks.go_on()?;
            self.refuse_opposed(&entry, &columns, &recording.t_s)?;
            match self.combined(&entry, &mut columns, &recording.t_s, &mut report.repairs) {
                Ok(Column::Labels(labels)) if entry.target == Target::Run => {
                    runs = Some(labels.into_labels());
                }
                Ok(Column::Labels(labels)) => recording.surface = Some(labels.into_labels()),
                Ok(Column::Numbers(values)) => match entry.target {
                    Target::Channel(channel) => {
                        report.channels.push(ChannelReport::new(channel, self.names(&entry), entry.unit));
                        recording.channels.insert(channel, values);
                    }
                    Target::Aside(name) => {
                        recording.aside.insert(name, values);
                    }
                    _ => {}
                },
                Ok(Column::Unusable(reason)) | Err(reason) => {
                    self.ignored.push(Ignored { name: self.names(&entry), reason });
                }
            }
        }
        if let (None, Some(surface)) = (&recording.surface, &self.surface) {
            recording.surface = Some(Labels::constant(surface, recording.rows()));
        }
        let order = divide(&mut recording, runs, name, &mut report, &position, &looks)?;
        let merged = merge_same_times(&mut recording, &mut report.repairs, &looks)?;
        let before = |row: usize| merged.as_ref().map_or(row, |rows| rows[row]);
        let in_table = |row: usize| order.as_ref().map_or(before(row), |order| order[before(row)]);
        let source = TimeSource {
            column: &time_column,
            map_unit: map_unit.as_deref(),
            weight: &|row| coarse.weight(in_table(row)),
            position: &|row| position(in_table(row)),
        };
        spread_bursts(&mut recording, &mut report.repairs);
        check_time(&recording, &source).map_err(|error| self.long_table(&recording).unwrap_or(error))?;
        onto_one_clock(&mut recording, self.max_gap_s, &mut report.repairs, &looks)?;
        report.ignored = self.ignored;
        report.repairs.extend(coarse.told("all rows", &recording.t_s));
        Ok((recording, report))
    }

    /// What is wrong with a table whose rows hold one number each and its name beside it; `None` of another.
    fn long_table(&self, recording: &Recording) -> Option<Error> {
        let numbers = recording
            .channels
            .keys()
            .map(|channel| channel.name())
            .chain(recording.aside.keys().map(String::as_str));
        let numbers: Vec<&str> = numbers.collect();
        let is_text = |ignored: &&Ignored| ignored.reason.starts_with(NOT_A_NUMBER) || ignored.reason == TEXT;
        let names = self.ignored.iter().find(is_text)?.name.clone();
        match numbers.as_slice() {
            [value] => Some(Error::LongTable { names, values: (*value).to_owned() }),
            _ => None,
        }
    }

    /// Takes note that a column of the file stores times in a unit of its own type, from which it is read in seconds. A map that
    /// names the same unit does not apply it again.
    ///
    /// # Errors
    /// [`crate::TimeError::TypedUnit`] where a map names another unit.
    pub(crate) fn typed_time(&mut self, column: usize, own: &'static str) -> Result<(), Error> {
        let is_time = |entry: &&mut Entry| entry.target == Target::Time && entry.columns.contains(&column);
        let Some(entry) = self.entries.iter_mut().find(is_time) else { return Ok(()) };
        if entry.unit == own {
            let unit = Conversion::from_unit(Quantity::Time, own, None).unwrap_or(Conversion::IDENTITY);
            entry.conversion.factor /= unit.factor;
        } else if entry.unit != units::si_unit(Quantity::Time) {
            let (column, unit) = (self.headers[column].clone(), entry.unit.clone());
            return Err(TimeError::TypedUnit { column, unit, own }.into());
        }
        Ok(())
    }

    /// Takes note that a column holds times of the calendar or the clock, which were read in seconds: a unit in a map is that of numbers.
    pub(crate) fn calendar_time(&mut self, column: usize) {
        let is_time = |entry: &&mut Entry| entry.target == Target::Time && entry.columns == [column];
        for entry in self.entries.iter_mut().filter(is_time) {
            entry.conversion = Conversion::IDENTITY;
            entry.unit = units::si_unit(Quantity::Time).to_owned();
            entry.is_unit_given = false;
        }
    }

    /// The time column of the file in seconds, its name, and the unit that a map gives.
    fn take_time(&mut self, columns: &mut [Column]) -> Result<(Vec<f64>, String, Option<String>), Error> {
        let Some(at) = self.entries.iter().position(|entry| entry.target == Target::Time) else {
            return Err(Error::missing_names(&["t_s".into()], &["t_s"], &self.headers));
        };
        let entry = self.entries.remove(at);
        let name = self.names(&entry);
        match self.combined(&entry, columns, &[], &mut Vec::new()) {
            Ok(Column::Numbers(t_s)) => Ok((t_s, name, entry.is_unit_given.then_some(entry.unit))),
            Ok(Column::Unusable(reason)) | Err(reason) => Err(Error::Field {
                topic: "of the table".into(),
                field: name,
                reason: format!("time is needed, but {reason}"),
            }),
            Ok(Column::Labels(_)) => Err(Error::missing_names(&["t_s".into()], &["t_s"], &self.headers)),
        }
    }

    fn names(&self, entry: &Entry) -> String {
        let names: Vec<&str> = entry.columns.iter().map(|&column| self.headers[column].as_str()).collect();
        names.join(", ")
    }

    /// The one column that an entry makes of its columns, in rows of these times.
    fn combined(
        &self,
        entry: &Entry,
        columns: &mut [Column],
        t_s: &[f64],
        repairs: &mut Vec<Repair>,
    ) -> Result<Column, String> {
        if let &[only] = entry.columns.as_slice() {
            // One column is moved, which spares a copy of the whole file.
            let taken = mem::replace(&mut columns[only], Column::Unusable("it is used twice".into()));
            return Ok(match taken {
                Column::Numbers(mut values) => {
                    if entry.conversion != Conversion::IDENTITY {
                        values.iter_mut().for_each(|value| *value = entry.conversion.apply(*value));
                    }
                    Column::Numbers(values)
                }
                other => other,
            });
        }
        let mut parts: Vec<&[f64]> = Vec::with_capacity(entry.columns.len());
        for &column in &entry.columns {
            match &columns[column] {
                Column::Numbers(values) => parts.push(values),
                _ => return Err(format!("column `{}` holds no numbers", self.headers[column])),
            }
        }
        let parts = self.unwrapped(entry, parts)?;
        let values = entry.combine.of_columns(t_s, &parts, entry.separation_m);
        let mut values: Vec<f64> = values.into_iter().map(|value| entry.conversion.apply(value)).collect();
        if entry.combine == Combine::Mean && entry.target.is_wheel_speed() {
            let names: Vec<String> = entry.columns.iter().map(|&at| self.headers[at].clone()).collect();
            let speed_mps = if entry.is_derivative { rates(t_s, &values, None) } else { values.clone() };
            let lone = stuck_part::lone_of_columns(&parts);
            repairs.extend(stuck_part::leave_out(t_s, &lone, &speed_mps, &names, &mut values));
        }
        Ok(Column::Numbers(values))
    }

    /// Refuses encoders of one side of which one has the other sign.
    fn refuse_opposed(&self, entry: &Entry, columns: &[Column], t_s: &[f64]) -> Result<(), Error> {
        if entry.columns.len() < 2 || entry.combine != Combine::Mean || !entry.target.is_wheel_speed() {
            return Ok(());
        }
        let speeds = entry.columns.iter().filter_map(|column| match columns.get(*column) {
            Some(Column::Numbers(values)) => {
                let values: Vec<f64> = values.iter().map(|value| entry.conversion.apply(*value)).collect();
                Some(if entry.is_derivative { rates(t_s, &values, entry.wraps_at) } else { values })
            }
            _ => None,
        });
        let names: Vec<String> = entry.columns.iter().map(|&column| self.headers[column].clone()).collect();
        opposed_part::refuse(&speeds.collect::<Vec<_>>(), &names)
    }

    /// Counters that go on where they begin again, so that a mean of several does not jump by a part of a turn.
    fn unwrapped<'c>(&self, entry: &Entry, parts: Vec<&'c [f64]>) -> Result<Vec<Cow<'c, [f64]>>, String> {
        let Some(wraps_at) = entry.wraps_at.map(|at| at / entry.conversion.factor.abs()) else {
            return Ok(parts.into_iter().map(Cow::Borrowed).collect());
        };
        let of = |(part, column): (&[f64], &usize)| match beyond_wrap(part, wraps_at) {
            None => Ok(Cow::Owned(unwrapped(part, wraps_at))),
            Some(farthest) => Err(format!(
                "column `{}` goes as far as {farthest}, and is said to begin anew at {wraps_at}",
                self.headers[*column]
            )),
        };
        parts.into_iter().zip(&entry.columns).map(of).collect()
    }
}
