//! Ranges of what files may say.

use crate::Error;

/// Refuses a value outside a range, not-a-number included.
pub(crate) fn within(
    field: impl Into<String>,
    value: f64,
    [min, max]: [f64; 2],
    hint: &'static str,
) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(Error::OutOfRange { field: field.into(), value, min, max, hint })
}
