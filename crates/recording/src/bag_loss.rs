//! What a damaged chunk of a ROS 1 bag cost: behind every chunk the index says how many messages it had, and when.

use crate::topic::Topics;

/// The chunk that was read last, until all of its index is.
#[derive(Default)]
pub(crate) struct LastChunk {
    at: u64,
    /// Messages that were read of it.
    read: u64,
    /// What is wrong with it, if that was seen.
    fault: Option<String>,
    /// Messages that its index names.
    indexed: u64,
    /// First and last time that its index names \[s\].
    times_s: Option<[f64; 2]>,
}

impl LastChunk {
    /// A chunk at a place of the file, of which so many messages were read.
    pub(crate) fn new(at: u64, read: u64, fault: Option<String>) -> Self {
        LastChunk { at, read, fault, ..LastChunk::default() }
    }

    /// Takes note of what one index record says: a time in seconds and nanoseconds and a place, 12 bytes each.
    pub(crate) fn index(&mut self, body: &[u8]) {
        for entry in body.as_chunks::<12>().0 {
            let [s0, s1, s2, s3, n0, n1, n2, n3, ..] = *entry;
            let seconds = f64::from(u32::from_le_bytes([s0, s1, s2, s3]));
            let t_s = seconds + 1e-9 * f64::from(u32::from_le_bytes([n0, n1, n2, n3]));
            let [first, last] = self.times_s.unwrap_or([t_s, t_s]);
            self.times_s = Some([first.min(t_s), last.max(t_s)]);
            self.indexed += 1;
        }
    }

    /// Says what was lost, if anything was.
    pub(crate) fn settle(self, topics: &mut Topics<'_>) {
        let lost = self.indexed.saturating_sub(self.read);
        if self.fault.is_none() && lost == 0 {
            return;
        }
        let fault = self.fault.unwrap_or_else(|| "a chunk is damaged".to_owned());
        let cost = match self.times_s {
            Some([first_s, last_s]) if lost > 0 => format!(
                ", which cost {lost} of its {} messages, of all topics, between {first_s:.3} and {last_s:.3} s of the log's clock",
                self.indexed
            ),
            _ => String::new(),
        };
        topics.tell(self.at, &format!("{fault}{cost}"));
    }
}
