//! Which column, or which field of which topic, holds which channel in which unit.

mod file;

use serde::{Deserialize, Serialize};

pub use self::file::MapFile;
use crate::{
    Channel, Combine, Conversion, Error, ReadingReport, Recording, Repair, drawn,
    rate::{beyond_wrap, rates},
};

/// A checked map. Read from JSON:
///
/// ```json
/// {
///   "name": "my-robot",
///   "wheel_radius_m": 0.165,
///   "sources": [
///     {"channel": "v_left_mps", "topic": "/joint_states",
///      "fields": ["velocity[name=front_left_wheel]", "velocity[name=rear_left_wheel]"], "unit": "rad/s"},
///     {"channel": "pitch_rad", "topic": "*/imu/data", "fields": ["orientation.pitch"]},
///     {"channel": "power_w", "column": "P_bat", "unit": "kW"}
///   ]
/// }
/// ```
///
/// A source names a `channel` (also `t_s`, `run` or `surface`), or with `aside` a column of its own name, and takes it from
/// `column` (or `columns`) of a table or from `fields` of a `topic`; several are combined by `combine`: `mean` (default),
/// `sum` or `product`. `unit` is that of the result, by default the channel's own; `scale` multiplies it. A topic
/// beginning with `*` stands for any namespace before the rest. Where several sources give one channel, the first that
/// covers most of the drive is taken. `topics` with the same `fields` are added up or averaged.
///
/// A field path is names with dots; `[2]` picks an element of an array and `[name=front_left_wheel]` that element whose
/// place in the text array `name` of the same message holds the given text. Behind a quaternion, `roll`, `pitch` and
/// `heading` give the angles in this program's signs: left side up, nose up, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// What reports call it.
    pub name: String,
    /// The topic whose stamps become the rows; by default the slowest of those that tell power.
    pub base: Option<String>,
    /// Which of a message's times counts.
    pub stamp: Stamp,
    /// Longest distance between neighbours that is interpolated across \[s\]; by default three median steps of the
    /// stream.
    pub max_gap_s: Option<f64>,
    /// The surface of the whole drive, where the file does not tell.
    pub surface: Option<String>,
    /// The namespace of the robot that is meant by `*`, where a file holds several.
    pub namespace: Option<String>,
    /// Radius of the wheels whose angular rates it makes rim speeds of \[m\].
    pub wheel_radius_m: Option<f64>,
    /// Where each channel comes from.
    pub sources: Vec<Source>,
}

/// Where one channel comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// What it becomes.
    pub target: Target,
    /// Where it lies.
    pub place: Place,
    /// How several columns or fields become one value.
    pub combine: Combine,
    /// Separation of the wheels that a twist is taken apart by; NaN for anything else \[m\].
    pub separation_m: f64,
    /// The values are positions, whose rate of change is meant.
    pub derivative: bool,
    /// Where a counter of positions begins again, in the unit of the channel.
    pub wraps_at: Option<f64>,
    /// What brings it into SI.
    pub conversion: Conversion,
    /// The unit it comes in, for the report.
    pub unit: String,
    /// Whether the map names that unit.
    pub is_unit_given: bool,
    /// How the sign of a current is known.
    pub sign: Sign,
    /// Whether it is added to the source before it, as the topic of a second battery pack.
    pub is_further_part: bool,
}

/// How the sign of a battery's current is known, of which drivers have both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Sign {
    /// As it comes, times the source's `scale`.
    #[default]
    Given,
    /// So that the battery is drawn from while the wheels turn, on the whole: a drive that is charged on balance has to be read with `given`.
    Drawn,
}

/// What a column or field becomes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// The time of the row.
    Time,
    /// The name of the run.
    Run,
    /// The name of the surface.
    Surface,
    /// A channel.
    Channel(Channel),
    /// A column that is no channel, kept under its own name.
    Aside(String),
}

impl Target {
    /// Whether it is the rim speed of a side.
    pub(crate) fn is_wheel_speed(&self) -> bool {
        matches!(self, Target::Channel(Channel::LeftSpeed | Channel::RightSpeed))
    }
}

/// Where a source lies.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// In columns of a table.
    Columns(Vec<String>),
    /// In fields of a topic's messages.
    Topic {
        /// The topic; a leading `*` stands for any namespace.
        topic: String,
        /// Field paths.
        fields: Vec<String>,
    },
}

impl Place {
    /// The columns or fields.
    pub(crate) fn names(&self) -> &[String] {
        match self {
            Place::Columns(names) | Place::Topic { fields: names, .. } => names,
        }
    }
}

/// Which of a message's times counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Stamp {
    /// `header.stamp` where every message of the topic has one, else the time it was logged.
    #[default]
    Header,
    /// The time at which it was logged.
    Log,
}

impl Source {
    /// Whether it is the mean of what encoders of one side tell.
    pub(crate) fn is_mean_of_wheels(&self) -> bool {
        self.combine == Combine::Mean && self.target.is_wheel_speed()
    }

    /// Refuses a counter that goes beyond the value at which it is said to begin anew.
    pub(crate) fn check_wraps(&self, index: usize, positions: &[f64]) -> Result<(), Error> {
        let Some(wraps_at) = self.wraps_at else { return Ok(()) };
        let Some(farthest) = beyond_wrap(positions, wraps_at) else { return Ok(()) };
        // Both as they stand in the map and in the file.
        let [wraps_at, farthest] =
            [wraps_at / self.conversion.factor.abs(), farthest / self.conversion.factor];
        Err(Error::Map {
            path: format!("sources[{index}].wraps_at"),
            message: format!(
                "a counter that begins anew at {wraps_at} has no values as far as {farthest}; give the number of its own counts, before \"scale\" and unit"
            ),
        })
    }
}

impl Map {
    /// Reads and checks a map.
    ///
    /// # Errors
    /// The place of whatever is missing, unknown, contradictory or in a unit that its channel cannot have.
    pub fn from_json(text: &str) -> Result<Map, Error> {
        document::from_json::<MapFile>(text.as_bytes())?.checked()
    }

    /// Reads and checks a map that is part of a document parsed before.
    ///
    /// # Errors
    /// As [`Map::from_json`].
    pub fn from_value(value: &serde_json::Value) -> Result<Map, Error> {
        document::from_value::<MapFile>(value)?.checked()
    }

    /// Takes the rates of columns of positions, run by run; those of topics were taken before they were brought onto one clock.
    ///
    /// # Errors
    /// [`Error::Map`] where a counter goes beyond the value at which it is said to begin anew.
    pub(crate) fn derive_columns(&self, recording: &mut Recording) -> Result<(), Error> {
        let Recording { t_s, channels, runs, .. } = recording;
        for (index, source) in self.sources.iter().enumerate().filter(|(_, source)| source.derivative) {
            let (Target::Channel(channel), Place::Columns(names)) = (&source.target, &source.place) else {
                continue;
            };
            let Some(values) = channels.get_mut(channel) else { continue };
            if names.len() == 1 {
                source.check_wraps(index, values)?;
            }
            for run in runs.iter() {
                if let (Some(t_s), Some(own)) = (t_s.get(run.rows.clone()), values.get_mut(run.rows.clone()))
                {
                    let rates = rates(t_s, own, source.wraps_at);
                    own.copy_from_slice(&rates);
                }
            }
        }
        Ok(())
    }

    /// Finds the sign of a current that came of a column and is to be drawn; that of a topic was found before.
    pub(crate) fn settle_drawn_column(
        &self,
        recording: &mut Recording,
        report: &ReadingReport,
    ) -> Option<Repair> {
        let from = &report.channels.iter().find(|used| used.channel == Channel::Current)?.from;
        let is_read = |source: &&Source| match &source.place {
            Place::Columns(names) => source.sign == Sign::Drawn && names.join(", ") == *from,
            Place::Topic { .. } => false,
        };
        self.sources.iter().find(is_read).and_then(|_| drawn::settle(recording, &format!("column `{from}`")))
    }

    /// Whether it is one of the built-in maps, whose sources are alternatives.
    pub(crate) fn is_built_in(&self) -> bool {
        Map::BUILT_IN.contains(&self.name.as_str())
    }

    /// Whether any of its sources is a column of a table.
    pub(crate) fn names_columns(&self) -> bool {
        self.sources.iter().any(|source| matches!(source.place, Place::Columns(_)))
    }

    /// Whether a topic's name is what a source means by `pattern`.
    pub(crate) fn topic_matches(pattern: &str, topic: &str) -> bool {
        match pattern.strip_prefix('*') {
            Some(rest) => topic.ends_with(rest),
            None => topic == pattern,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_maps_are_valid() {
        for name in Map::BUILT_IN {
            assert_eq!(Map::built_in(name).unwrap().name, name);
        }
        assert_eq!(Map::built_in("rover"), None);
    }

    #[test]
    fn rim_speeds_come_of_odometry_and_of_wrapping_counters() {
        let text = r#"{"name": "lab", "wheel_separation_m": 0.5, "sources": [
            {"channel": "t_s", "column": "t"},
            {"channel": "v_left_mps", "columns": ["v", "w"], "combine": "left_of_twist"},
            {"channel": "v_right_mps", "column": "ticks", "scale": 0.01, "derivative": true, "wraps_at": 100},
            {"channel": "power_w", "column": "p"}]}"#;
        let map = Map::from_json(text).unwrap();
        let mut table = "t,v,w,ticks,p\n".to_owned();
        for i in 0..60 {
            table += &format!("{},0.6,0.4,{},{}\n", 0.1 * f64::from(i), (7 * i) % 100, 50 + i % 3);
        }
        let read = crate::read(table.into_bytes(), crate::Format::Csv, "lab", Some(&map)).unwrap().recording;
        let worst = |channel, wanted: f64| {
            let values = read.channel(channel).unwrap();
            values.iter().map(|value| (value - wanted).abs()).fold(0.0, f64::max)
        };
        // 0.6 − 0.4 · 0.5 / 2, and seven ticks of a centimetre in a tenth of a second.
        assert!(worst(Channel::LeftSpeed, 0.5) < 1e-12 && worst(Channel::RightSpeed, 0.7) < 1e-9);
        for (broken, place) in [
            (text.replace("0.5,", "-1,"), "wheel_separation_m"),
            (text.replace("\"wheel_separation_m\": 0.5,", ""), "sources[1].combine"),
            (text.replace("\"derivative\": true, ", ""), "sources[2].wraps_at"),
        ] {
            let error = Map::from_json(&broken).unwrap_err().to_string();
            assert!(error.contains(place), "{error}");
        }
    }

    #[test]
    fn a_star_stands_for_any_namespace() {
        assert!(Map::topic_matches("*/imu/data", "/a200_0001/imu/data"));
        assert!(Map::topic_matches("*/imu/data", "/imu/data"));
        assert!(!Map::topic_matches("/imu/data", "/a200_0001/imu/data"));
    }

    #[test]
    fn bad_maps_are_refused_by_place() {
        let with = |source: &str| format!(r#"{{"name": "m", "sources": [{source}]}}"#);
        for (text, said) in [
            (with(r#"{"channel": "power_w", "column": "p", "unit": "A"}"#), "sources[0].unit: `A`"),
            (with(r#"{"channel": "power_w", "column": "p", "unit": "A"}"#), "W, kW"),
            (with(r#"{"channel": "v_left_mps", "column": "l", "unit": "rad/s"}"#), "wheel_radius_m"),
            (with(r#"{"channel": "v_lefft_mps", "column": "l"}"#), "v_left_mps, v_right_mps"),
            (with(r#"{"channel": "power_w"}"#), "sources[0]: needs either"),
            (with(r#"{"channel": "power_w", "aside": "p", "column": "p"}"#), "`channel` or `aside`"),
            (with(r#"{"channel": "power_w", "column": "p", "topic": "/p", "fields": ["data"]}"#), "needs"),
            (with(r#"{"channel": "power_w", "column": "p", "scale": 0}"#), "scale"),
            (with(r#"{"channel": "t_s", "topic": "/p", "fields": ["t"]}"#), "one column"),
            (with(r#"{"channel": "power_w", "colum": "p"}"#), "sources[0].colum"),
            (r#"{"name": "m", "wheel_radius_m": -1, "sources": []}"#.into(), "wheel_radius_m"),
            (r#"{"name": "m"}"#.into(), "sources"),
        ] {
            let message = Map::from_json(&text).unwrap_err().to_string();
            assert!(message.contains(said), "{text}\n  said: {message}");
        }
    }
}
