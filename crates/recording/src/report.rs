//! What a reading says about itself.

use std::fmt;

use serde::Serialize;

use crate::{Channel, Error, PowerForm, Recording, gap, watch::Looks};

/// What was found, used, left aside, repaired, missing and suspicious.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ReadingReport {
    /// The file, or the name that the reader was given.
    pub source: String,
    /// `CSV`, `Parquet`, `MCAP`, `ROS 2 SQLite bag` or `ROS 1 bag`.
    pub format: String,
    /// The map that named the channels, where there was one.
    pub map: Option<String>,
    /// Rows of the recording.
    pub rows: usize,
    /// The form in which it tells power.
    pub power_form: Option<PowerForm>,
    /// The drives.
    pub runs: Vec<RunReport>,
    /// The channels, and where each came from.
    pub channels: Vec<ChannelReport>,
    /// Columns kept aside under their own names.
    pub aside: Vec<String>,
    /// Columns, topics and sources of the map that were not used, and why.
    pub ignored: Vec<Ignored>,
    /// The streams of a bag or MCAP file.
    pub streams: Vec<StreamReport>,
    /// How the streams were brought onto one clock.
    pub alignment: Option<AlignmentReport>,
    /// What was wrong with the file and mended.
    pub repairs: Vec<Repair>,
    /// What a person should look at before trusting the numbers.
    pub suspicions: Vec<Suspicion>,
}

/// One drive.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct RunReport {
    /// Its name.
    pub run: String,
    /// Its rows.
    pub rows: usize,
    /// From its first row to its last \[s\].
    pub duration_s: f64,
    /// One over the median step \[Hz\].
    pub rate_hz: Option<f64>,
    /// Pauses of the rows.
    pub gaps: usize,
    /// The longest of them \[s\].
    pub longest_gap_s: Option<f64>,
}

/// One channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ChannelReport {
    /// Which.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "power_w"))]
    pub channel: Channel,
    /// The column, or topic and field, that it came from.
    pub from: String,
    /// The unit it came in.
    pub unit: String,
    /// Rows with a value.
    pub present: usize,
    /// Stretches of rows without one.
    pub gaps: usize,
    /// Least value, in the channel's unit.
    pub least: f64,
    /// Greatest value, in the channel's unit.
    pub greatest: f64,
}

/// A column, topic or source that was not used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Ignored {
    /// Its name.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// The messages of one topic.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct StreamReport {
    /// The topic.
    pub topic: String,
    /// Its type.
    pub type_name: String,
    /// Messages read.
    pub messages: usize,
    /// One over the median step \[Hz\].
    pub rate_hz: Option<f64>,
    /// `header stamp` or `log time`.
    pub clock: &'static str,
}

/// How streams were brought onto one clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct AlignmentReport {
    /// The topic whose stamps became the rows.
    pub base: String,
    /// The method in words.
    pub method: String,
    /// For each other topic, how far neighbours may lie apart to be interpolated across \[s\].
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<Vec<serde_json::Value>>))]
    pub max_gap_s: Vec<(String, f64)>,
}

/// What was wrong with the file and mended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Repair {
    /// Where: line, row, byte or topic.
    pub place: String,
    /// What was wrong, and what was done.
    pub what: String,
}

/// What kind of doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum SuspicionKind {
    /// The same value in every row.
    Constant,
    /// Stuck at its greatest or least value.
    Saturated,
    /// A magnitude that another unit would explain.
    Unit,
    /// A sign that flips for single rows.
    Sign,
    /// A sign opposed to that of what it should agree with.
    Opposed,
    /// A current or power that never changes its sign although the robot's motion does.
    Unsigned,
    /// Wheel speeds and yaw rate that do not belong together.
    Slip,
    /// Axes of a sensor that are not the robot's.
    Mounting,
    /// Most of it is gaps.
    Sparse,
}

/// A doubt about a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Suspicion {
    /// Which channel.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "power_w"))]
    pub channel: Channel,
    /// In which run; `None` for the whole recording.
    pub run: Option<String>,
    /// What kind of doubt.
    pub kind: SuspicionKind,
    /// In words, with numbers.
    pub statement: String,
}

impl ReadingReport {
    /// Whether wheel speeds came as angular rates.
    pub(crate) fn has_wheel_rates(&self) -> bool {
        let is_wheel =
            |used: &&ChannelReport| matches!(used.channel, Channel::LeftSpeed | Channel::RightSpeed);
        let rates = crate::units::unit_names(crate::Quantity::AngularRate);
        self.channels.iter().filter(is_wheel).any(|used| rates.contains(&used.unit.as_str()))
    }

    /// Fills in what can be told from the recording itself.
    pub(crate) fn describe(&mut self, recording: &Recording, looks: &Looks) -> Result<(), Error> {
        let mut looks = looks.clone();
        self.rows = recording.rows();
        self.power_form = recording.power_form();
        for run in &recording.runs {
            looks.worked(run.rows.len())?;
            self.runs.push(RunReport::new(recording, run));
        }
        self.aside = recording.aside.keys().cloned().collect();
        for report in &mut self.channels {
            looks.worked(self.rows)?;
            report.describe(recording.channel(report.channel).unwrap_or_default());
        }
        Ok(())
    }
}

impl RunReport {
    fn new(recording: &Recording, run: &crate::Run) -> RunReport {
        let t_s = recording.t_s.get(run.rows.clone()).unwrap_or_default();
        let rows = run.rows.start..run.rows.end.saturating_sub(1);
        let before_gaps = rows.filter(|row| recording.step_s(run, *row).is_none());
        let gaps: Vec<f64> = before_gaps.map(|row| recording.t_s[row + 1] - recording.t_s[row]).collect();
        RunReport {
            run: run.name.clone(),
            rows: t_s.len(),
            duration_s: t_s.last().unwrap_or(&0.0) - t_s.first().unwrap_or(&0.0),
            rate_hz: gap::median_step_s(t_s).map(|step_s| 1.0 / step_s),
            gaps: gaps.len(),
            longest_gap_s: gaps.into_iter().max_by(f64::total_cmp),
        }
    }
}

impl ChannelReport {
    /// A channel and its origin; the rest follows from its values.
    pub(crate) fn new(channel: Channel, from: String, unit: String) -> ChannelReport {
        ChannelReport { channel, from, unit, present: 0, gaps: 0, least: 0.0, greatest: 0.0 }
    }

    fn describe(&mut self, values: &[f64]) {
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut before = true;
        for value in values {
            let present = !value.is_nan();
            self.present += usize::from(present);
            self.gaps += usize::from(before && !present);
            before = present;
            (least, greatest) = (least.min(*value), greatest.max(*value));
        }
        (self.least, self.greatest) = (least, greatest);
    }
}

impl fmt::Display for ReadingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}, {} rows", self.source, self.format, self.rows)?;
        match &self.map {
            Some(map) => writeln!(f, ", map `{map}`")?,
            None => writeln!(f)?,
        }
        for run in &self.runs {
            let rate = run.rate_hz.map_or("one row".into(), |rate| format!("{rate:.1} Hz"));
            write!(f, "  run {}: {} rows, {:.1} s, {rate}", run.run, run.rows, run.duration_s)?;
            match run.longest_gap_s {
                Some(longest) => writeln!(f, ", {} gaps, the longest {longest:.2} s", run.gaps)?,
                None => writeln!(f)?,
            }
        }
        for c in &self.channels {
            write!(f, "  {} from {} [{}]: {:.4} to {:.4}", c.channel, c.from, c.unit, c.least, c.greatest)?;
            match self.rows - c.present.min(self.rows) {
                0 => writeln!(f)?,
                missing => writeln!(f, ", {missing} rows missing in {} gaps", c.gaps)?,
            }
        }
        if !self.aside.is_empty() {
            writeln!(f, "  kept aside: {}", self.aside.join(", "))?;
        }
        for stream in &self.streams {
            let rate = stream.rate_hz.map_or(String::new(), |rate| format!(", {rate:.1} Hz"));
            let (topic, messages, clock) = (&stream.topic, stream.messages, stream.clock);
            writeln!(f, "  topic {topic} ({}): {messages} messages{rate}, {clock}", stream.type_name)?;
        }
        if let Some(alignment) = &self.alignment {
            writeln!(f, "  aligned: {}", alignment.method)?;
        }
        for ignored in &self.ignored {
            writeln!(f, "  not used: {}: {}", ignored.name, ignored.reason)?;
        }
        for repair in &self.repairs {
            writeln!(f, "  repaired: {}: {}", repair.place, repair.what)?;
        }
        for doubt in &self.suspicions {
            let run = doubt.run.as_ref().map_or(String::new(), |run| format!(", run {run}"));
            writeln!(f, "  suspicious: {}{run}: {}", doubt.channel, doubt.statement)?;
        }
        Ok(())
    }
}
