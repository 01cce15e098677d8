//! How much of a recording is held in memory.

/// Numbers of one row that count at least: a calibration makes some thirty more of each.
const LEAST_OF_A_ROW: usize = 16;

/// How many numbers a recording may hold before its rows are brought to means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    numbers: usize,
}

impl Default for Room {
    /// 2²⁴ numbers, a million rows: 29 hours at 10 Hz. To predict or calibrate with them takes less than 1 GB.
    fn default() -> Self {
        Room { numbers: 1 << 24 }
    }
}

impl Room {
    /// The part of it for one of several files, by its bytes.
    #[must_use]
    pub fn share(self, bytes: u64, of_bytes: u64) -> Room {
        let share = bytes as f64 / of_bytes.max(1) as f64;
        Room { numbers: (self.numbers as f64 * share.min(1.0)) as usize }
    }

    /// Numbers that fit.
    pub(crate) fn numbers(self) -> usize {
        self.numbers
    }

    /// Rows of so many columns that fit.
    pub(crate) fn rows(self, columns: usize) -> usize {
        (self.numbers / columns.max(LEAST_OF_A_ROW)).max(2)
    }

    #[cfg(test)]
    pub(crate) fn of_rows(rows: usize) -> Room {
        Room { numbers: rows * LEAST_OF_A_ROW }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_of_driving_fits_and_files_share_by_their_bytes() {
        let room = Room::default();
        assert!(room.rows(12) > 86_400 * 10 && room.rows(12) == room.rows(3));
        assert_eq!(room.share(1, 4).rows(16), room.rows(16) / 4);
        assert!(room.share(0, 0).rows(16) > 0);
    }
}
