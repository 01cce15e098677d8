//! Columns named as powers of the sides that are none, beside the battery's.

use serde_json::{Value, json};

use super::InspectedField;
use crate::{Channel, Conversion, Quantity, Recording};

/// Fewer rows with all powers say nothing.
const LEAST_ROWS: usize = 20;

/// Takes the powers of the sides out of the sources where they explain nothing of the battery's: what is a part of a whole leaves a rest that varies
/// less than the whole. Duties and torques named as powers, whose sign is that of the speed, do not.
pub(super) fn leave_out(recording: &Recording, sources: &mut Vec<Value>, fields: &mut [InspectedField]) {
    let of = |channel: Channel| sources.iter().find(|source| source["channel"] == channel.name());
    let values =
        |channel: Channel| of(channel).and_then(|source| column_of(recording, source, channel.quantity()));
    let (Some(left_w), Some(right_w)) = (values(Channel::LeftPower), values(Channel::RightPower)) else {
        return;
    };
    let product = || -> Option<Vec<f64>> {
        let (current_a, voltage_v) = (values(Channel::Current)?, values(Channel::Voltage)?);
        Some(current_a.iter().zip(&voltage_v).map(|(a, v)| a * v).collect())
    };
    let Some(battery_w) = values(Channel::Power).or_else(product) else { return };
    let rows =
        left_w.iter().zip(&right_w).zip(&battery_w).map(|((left, right), whole)| (left + right, *whole));
    let rows: Vec<(f64, f64)> = rows.filter(|(sides, whole)| !(sides + whole).is_nan()).collect();
    let whole = variance(rows.iter().map(|(_, whole)| *whole));
    let rest = variance(rows.iter().map(|(sides, whole)| whole - sides));
    if rows.len() < LEAST_ROWS || rest < whole {
        return;
    }
    for channel in [Channel::LeftPower, Channel::RightPower] {
        sources.retain(|source| source["channel"] != channel.name());
        for field in fields.iter_mut().filter(|field| field.channel.as_deref() == Some(channel.name())) {
            field.reason = format!(
                "left out: it may be {channel} by its name, but `{}` does not follow from it as a whole from its parts: choose",
                if values_are_of(sources, Channel::Power) { "power_w" } else { "current_a" }
            );
            (field.channel, field.unit) = (None, None);
        }
    }
}

/// Has the sign of a battery's current found that is negative on the whole: drivers count discharge as negative (`sensor_msgs/BatteryState`), and a
/// drive draws.
pub(super) fn draw_negative_current(recording: &Recording, sources: &mut [Value]) -> Option<String> {
    let source = sources.iter_mut().find(|source| source["channel"] == Channel::Current.name())?;
    let current_a = column_of(recording, source, Quantity::Current)?;
    let known = current_a.iter().filter(|value| !value.is_nan());
    (known.sum::<f64>() < 0.0).then(|| {
        source["sign"] = json!("drawn");
        let name = Channel::Current;
        format!("{name} is negative on the whole: `\"sign\": \"drawn\"` turns it so that driving draws; take it out if the battery was charged")
    })
}

fn values_are_of(sources: &[Value], channel: Channel) -> bool {
    sources.iter().any(|source| source["channel"] == channel.name())
}

/// What a source makes of its columns, in SI; those of the contract's own names stay out of question.
fn column_of(recording: &Recording, source: &Value, quantity: Quantity) -> Option<Vec<f64>> {
    let names: Vec<&str> = source["columns"].as_array()?.iter().filter_map(Value::as_str).collect();
    let parts: Vec<&Vec<f64>> = names.iter().filter_map(|name| recording.aside.get(*name)).collect();
    let unit = Conversion::from_unit(quantity, source["unit"].as_str()?, None)?;
    let (first, rest) = parts.split_first().filter(|_| parts.len() == names.len())?;
    let mut sum = (*first).clone();
    for part in rest {
        sum.iter_mut().zip(part.iter()).for_each(|(sum, value)| *sum += value);
    }
    let by = if source["combine"] == "sum" { 1.0 } else { 1.0 / parts.len() as f64 };
    Some(sum.into_iter().map(|value| unit.apply(by * value)).collect())
}

fn variance(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    values.map(|value| (value - mean).powi(2)).sum::<f64>() / count
}
