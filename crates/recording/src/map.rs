//! Which column, or which field of which topic, holds which channel in which unit.

use serde::{Deserialize, Serialize};

use crate::{
    Channel, Combine, Conversion, Error, Quantity, ReadingReport, Recording, Repair, drawn,
    rate::{beyond_wrap, rates},
    units,
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
/// the file holds is taken.
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

/// A map as its file has it, before it is checked.
#[derive(Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = RecordingMap))]
#[serde(deny_unknown_fields)]
pub struct MapFile {
    /// What reports call it.
    name: String,
    /// Radius that speeds in rad/s are multiplied by [m].
    wheel_radius_m: Option<f64>,
    /// Separation of the wheels that a twist is taken apart by [m].
    wheel_separation_m: Option<f64>,
    /// Topic whose stamps become the rows. Default: the slowest of those that tell power.
    base: Option<String>,
    /// Which of a message's times counts. Default: header.
    #[serde(default)]
    stamp: Stamp,
    /// Longest distance between neighbours that is interpolated across. Default: three median steps [s].
    max_gap_s: Option<f64>,
    /// Surface of the whole drive, where the file does not tell.
    surface: Option<String>,
    /// Namespace that a leading `*` of a topic stands for.
    namespace: Option<String>,
    /// Where each channel comes from.
    sources: Vec<SourceFile>,
}

/// A source of a map as its file has it.
#[derive(Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct SourceFile {
    /// Channel that it becomes, `t_s`, `run` or `surface`; this or `aside`.
    channel: Option<String>,
    /// Name of a column of its own.
    aside: Option<String>,
    /// Column of a table; this, `columns` or `topic` with `fields`.
    column: Option<String>,
    /// Columns that are combined.
    #[serde(default)]
    columns: Vec<String>,
    /// Topic; a leading `*` stands for any namespace.
    topic: Option<String>,
    /// Field paths within its messages.
    #[serde(default)]
    fields: Vec<String>,
    /// How several become one. Default: their mean.
    #[serde(default)]
    combine: Combine,
    /// Unit that it comes in. Default: that of the channel.
    unit: Option<String>,
    /// Factor on the value. Default: 1.
    scale: Option<f64>,
    /// Whether the rate of change is meant.
    #[serde(default)]
    derivative: bool,
    /// Value at which a counter begins anew.
    wraps_at: Option<f64>,
    /// How the sign of a current is known. Default: as it comes.
    #[serde(default)]
    sign: Sign,
}

impl Source {
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
        Map::checked(document::from_json(text.as_bytes())?)
    }

    /// Reads and checks a map that is part of a document parsed before.
    ///
    /// # Errors
    /// As [`Map::from_json`].
    pub fn from_value(value: &serde_json::Value) -> Result<Map, Error> {
        Map::checked(document::from_value(value)?)
    }

    fn checked(file: MapFile) -> Result<Map, Error> {
        let positive = [
            ("wheel_radius_m", file.wheel_radius_m),
            ("wheel_separation_m", file.wheel_separation_m),
            ("max_gap_s", file.max_gap_s),
        ];
        for (path, value) in positive {
            if value.is_some_and(|v| !v.is_finite() || v <= 0.0) {
                return Err(Error::Map { path: path.into(), message: "must be positive".into() });
            }
        }
        let wheels = (file.wheel_radius_m, file.wheel_separation_m);
        let sources = file.sources.into_iter().enumerate().map(|(i, source)| source.check(i, wheels));
        Ok(Map {
            name: file.name,
            base: file.base,
            stamp: file.stamp,
            max_gap_s: file.max_gap_s,
            surface: file.surface,
            namespace: file.namespace,
            sources: sources.collect::<Result<_, _>>()?,
        })
    }

    /// Takes the rates of columns of positions, run by run; those of topics were taken before they were brought onto one clock.
    ///
    /// # Errors
    /// [`Error::Map`] where a counter goes beyond the value at which it is said to begin anew.
    pub(crate) fn derive_columns(&self, recording: &mut Recording) -> Result<(), Error> {
        let Recording { t_s, channels, runs, .. } = recording;
        for (index, source) in self.sources.iter().enumerate().filter(|(_, source)| source.derivative) {
            let (Target::Channel(channel), Place::Columns(_)) = (&source.target, &source.place) else {
                continue;
            };
            let Some(values) = channels.get_mut(channel) else { continue };
            source.check_wraps(index, values)?;
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

impl SourceFile {
    fn check(
        self,
        index: usize,
        (wheel_radius_m, separation_m): (Option<f64>, Option<f64>),
    ) -> Result<Source, Error> {
        let wrong = |field: &str, message: &str| Error::Map {
            path: format!("sources[{index}]{field}"),
            message: message.into(),
        };
        let target = match (self.channel, self.aside) {
            (Some(channel), None) => match channel.as_str() {
                "t_s" => Target::Time,
                "run" => Target::Run,
                "surface" => Target::Surface,
                _ => Target::Channel(Channel::try_from(channel).map_err(|e| wrong(".channel", &e))?),
            },
            (None, Some(name)) => Target::Aside(name),
            _ => return Err(wrong("", "needs either `channel` or `aside`")),
        };
        let columns: Vec<String> = self.column.into_iter().chain(self.columns).collect();
        let place = match (self.topic, columns.is_empty(), self.fields.is_empty()) {
            (None, false, true) => Place::Columns(columns),
            (Some(topic), true, false) => Place::Topic { topic, fields: self.fields },
            _ => return Err(wrong("", "needs either `column` or `columns`, or `topic` with `fields`")),
        };
        if matches!(target, Target::Time | Target::Run | Target::Surface) {
            match &place {
                Place::Columns(names) if names.len() == 1 => {}
                _ => return Err(wrong("", "t_s, run and surface come from one column each")),
            }
        }
        let scale = self.scale.unwrap_or(1.0);
        if !scale.is_finite() || scale == 0.0 {
            return Err(wrong(".scale", "must be finite and not 0"));
        }
        let is_unit_given = self.unit.is_some();
        let (conversion, unit) = conversion(index, &target, self.unit, wheel_radius_m)?;
        let conversion = conversion.scaled(scale);
        let count = match &place {
            Place::Columns(names) => names.len(),
            Place::Topic { fields, .. } => fields.len(),
        };
        if self.combine.is_of_twist() && !(count == 2 && target.is_wheel_speed() && separation_m.is_some()) {
            let message = "of a twist are rim speeds only, from a speed and a yaw rate, with the map's `wheel_separation_m`";
            return Err(wrong(".combine", message));
        }
        if self.derivative && !target.is_wheel_speed() {
            return Err(wrong(".derivative", "is for rim speeds only"));
        }
        if self.sign == Sign::Drawn && target != Target::Channel(Channel::Current) {
            return Err(wrong(".sign", "is for `current_a` only"));
        }
        if self.wraps_at.is_some_and(|at| !(at.is_finite() && at > 0.0 && self.derivative)) {
            return Err(wrong(".wraps_at", "must be positive, beside `derivative`"));
        }
        Ok(Source {
            target,
            place,
            combine: self.combine,
            separation_m: separation_m.unwrap_or(f64::NAN),
            derivative: self.derivative,
            wraps_at: self.wraps_at.map(|at| (conversion.factor * at).abs()),
            conversion,
            unit,
            is_unit_given,
            sign: self.sign,
        })
    }
}

fn conversion(
    index: usize,
    target: &Target,
    unit: Option<String>,
    wheel_radius_m: Option<f64>,
) -> Result<(Conversion, String), Error> {
    let (quantity, name) = match target {
        Target::Channel(channel) => (channel.quantity(), channel.name()),
        Target::Time => (Quantity::Time, "t_s"),
        // What is kept aside is kept in the unit that it comes in.
        _ => return Ok((Conversion::IDENTITY, unit.unwrap_or_default())),
    };
    let unit = unit.unwrap_or_else(|| units::si_unit(quantity).to_owned());
    match Conversion::from_unit(quantity, &unit, wheel_radius_m) {
        Some(conversion) => Ok((conversion, unit)),
        None => Err(Error::Unit {
            index,
            needs_radius: Conversion::from_unit(quantity, &unit, Some(1.0)).is_some(),
            unit,
            channel: name.to_owned(),
            known: units::unit_names(quantity),
        }),
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
