//! How much of a recording is held in memory.

use crate::Error;

/// Most numbers of one recording: 4 GiB. At 10 Hz and 15 channels that is 41 days of driving without a pause.
const MOST_NUMBERS: usize = 1 << 29;

/// Refuses what would not fit, before it has filled the memory.
pub(crate) fn refuse_too_many(rows: usize, columns: usize) -> Result<(), Error> {
    if rows.saturating_mul(columns) > MOST_NUMBERS {
        return Err(Error::TooLarge { most: MOST_NUMBERS });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_month_is_read_and_a_century_is_refused() {
        let rows = |days: usize| days * 86_400 * 10;
        assert!(refuse_too_many(rows(30), 15).is_ok());
        let message = refuse_too_many(rows(36_500), 15).unwrap_err().to_string();
        assert!(message.contains("cut it into several files"), "{message}");
        assert!(refuse_too_many(usize::MAX, 2).is_err());
    }
}
