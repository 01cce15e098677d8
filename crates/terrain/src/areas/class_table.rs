//! What classes of a raster change: a table from class to the properties of an area.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use super::{AreaError, Effect};

/// Properties for each class; classes with none are known and change nothing.
pub(super) struct ClassTable(BTreeMap<i64, Option<Map<String, Value>>>);

impl ClassTable {
    /// Reads a table as `{"80": {"keep_out": true}, "40": {"surface": "sandy_loam"}, "50": null}`.
    ///
    /// # Errors
    /// A class that is no whole number, or properties that cannot be, by their place.
    pub(super) fn of(document: &Value) -> Result<Self, AreaError> {
        let fault = |at: String, what: &str| AreaError { at, what: what.to_owned() };
        let Value::Object(entries) = document else {
            let what = "is no object of classes: give one as {\"80\": {\"keep_out\": true}, \"40\": {\"surface\": \"sandy_loam\"}}";
            return Err(fault("classes".into(), what));
        };
        let mut table = BTreeMap::new();
        for (name, value) in entries {
            let at = format!("classes.{name}");
            let class = name.trim().parse().map_err(|_| {
                fault(at.clone(), "is no class, which is a whole number as it stands in the raster")
            })?;
            let properties = match value {
                Value::Null => None,
                Value::Object(properties) => Some(properties.clone()),
                _ => return Err(fault(at, "is no object of properties, nor null")),
            };
            if let Some(properties) = &properties {
                check(properties, &at)?;
            }
            table.insert(class, properties);
        }
        Ok(ClassTable(table))
    }

    /// The properties of a class that changes something.
    pub(super) fn properties(&self, class: i64) -> Option<&Map<String, Value>> {
        self.0.get(&class)?.as_ref()
    }

    /// Whether a class stands in the table.
    pub(super) fn knows(&self, class: i64) -> bool {
        self.0.contains_key(&class)
    }

    /// Classes of the table.
    pub(super) fn classes(&self) -> impl Iterator<Item = i64> {
        self.0.keys().copied()
    }
}

/// Refuses properties that an area may not have, by their place in the table.
fn check(properties: &Map<String, Value>, at: &str) -> Result<(), AreaError> {
    let mut others = Vec::new();
    let effect = Effect::of(properties, at, &mut others).map_err(|error| AreaError {
        at: error.at.strip_prefix("areas.").map(str::to_owned).unwrap_or(error.at),
        what: error.what,
    })?;
    let known = Effect::known();
    if let Some(other) = others.first() {
        let what = format!("means nothing here; what counts is {known}");
        return Err(AreaError { at: format!("{at}.{other}"), what });
    }
    if effect.is_any() {
        return Ok(());
    }
    let what = format!("says nothing that an area may change: give one of {known}, or null");
    Err(AreaError { at: at.to_owned(), what })
}
