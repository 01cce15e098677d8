//! A map as its file has it, and what must hold of it.

use serde::Deserialize;

use super::{Map, Place, Sign, Source, Stamp, Target};
use crate::{Channel, Combine, Conversion, Error, Quantity, units};

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
#[derive(Clone, Deserialize)]
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
    /// Several topics that are added up, or averaged, as those of two battery packs; each has the same `fields`.
    #[serde(default)]
    topics: Vec<String>,
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

impl MapFile {
    /// The map, if nothing of it is wrong.
    pub(super) fn checked(self) -> Result<Map, Error> {
        let file = self;
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
            wheel_radius_m: file.wheel_radius_m,
            sources: sources.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect(),
        })
    }
}

impl SourceFile {
    fn check(mut self, index: usize, wheels: (Option<f64>, Option<f64>)) -> Result<Vec<Source>, Error> {
        if self.topics.is_empty() {
            return self.check_one(index, wheels).map(|source| vec![source]);
        }
        let by = self.share(index)?;
        let topics = std::mem::take(&mut self.topics);
        let of_topic = |(at, topic): (usize, String)| {
            let scale = Some(by * self.scale.unwrap_or(1.0));
            let one = SourceFile { topic: Some(topic), scale, ..self.clone() };
            Ok(Source { is_further_part: at > 0, ..one.check_one(index, wheels)? })
        };
        topics.into_iter().enumerate().map(of_topic).collect()
    }

    /// What each of several topics counts for in the whole.
    fn share(&self, index: usize) -> Result<f64, Error> {
        let wrong = |message: &str| {
            Err(Error::Map { path: format!("sources[{index}].topics"), message: message.into() })
        };
        match self.combine {
            _ if self.topic.is_some() => wrong("stands in the place of `topic`"),
            Combine::Sum => Ok(1.0),
            Combine::Mean if self.topics.len() > 1 => Ok(1.0 / self.topics.len() as f64),
            Combine::Mean => Ok(1.0),
            _ => wrong("are added up or averaged: \"combine\" is \"sum\" or \"mean\""),
        }
    }

    fn check_one(
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
        let is_stamp = self.combine == Combine::SecondsAndNanoseconds;
        if is_stamp && target != Target::Time {
            return Err(wrong(".combine", "seconds and nanoseconds are a time: `t_s`"));
        }
        if matches!(target, Target::Time | Target::Run | Target::Surface) {
            match &place {
                Place::Columns(names) if names.len() == if is_stamp { 2 } else { 1 } => {}
                _ => {
                    return Err(wrong(
                        "",
                        "t_s, run and surface come from one column each, or t_s from two by \"combine\": \"seconds_and_nanoseconds\"",
                    ));
                }
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
            is_further_part: false,
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
