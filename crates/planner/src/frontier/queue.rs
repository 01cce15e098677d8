//! A priority queue of integer keys that rarely fall: a ring of buckets.

/// Buckets of 2048 units, a thirtieth of a step on level ground.
pub(crate) const BUCKET_SHIFT: u32 = 11;

/// Keys are grouped into buckets of 2^`shift`; within a bucket the last in is the first out.
///
/// An item is a state alone, whose key its label tells. Where that is no longer in the bucket an item was popped from, the
/// item is stale: the state was reached at less cost, lies in an earlier bucket too, and has had its turn. A state reached
/// twice in one bucket is simply expanded again.
pub(crate) struct BucketQueue {
    ring: Vec<Vec<u32>>,
    shift: u32,
    /// Number of the bucket that is being emptied.
    current: u32,
    /// Number of the highest bucket that was ever filled.
    highest: u32,
    len: usize,
}

impl BucketQueue {
    pub(crate) fn new(shift: u32) -> Self {
        BucketQueue { ring: vec![Vec::new(); 1024], shift, current: 0, highest: 0, len: 0 }
    }

    /// Adds an item under a key; one below the current bucket takes the queue back to it.
    #[inline(always)]
    pub(crate) fn push(&mut self, key: u32, item: u32) {
        let bucket = key >> self.shift;
        if self.len == 0 {
            (self.current, self.highest) = (bucket, bucket);
        } else if bucket < self.current || bucket > self.highest {
            self.widen(bucket);
        }
        let slot = bucket as usize & (self.ring.len() - 1);
        self.ring[slot].push(item);
        self.len += 1;
    }

    /// Takes an item of the lowest bucket.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<u32> {
        if self.len == 0 {
            return None;
        }
        loop {
            let slot = self.current as usize & (self.ring.len() - 1);
            if let Some(item) = self.ring[slot].pop() {
                self.len -= 1;
                return Some(item);
            }
            self.current += 1;
        }
    }

    /// The item that will be popped next but for `further` others, if it is in the current bucket.
    #[inline(always)]
    pub(crate) fn peek(&self, further: usize) -> Option<u32> {
        let bucket = &self.ring[self.current as usize & (self.ring.len() - 1)];
        bucket.get(bucket.len().wrapping_sub(1 + further)).copied()
    }

    /// Whether a key belongs to the bucket that is being emptied.
    #[inline(always)]
    pub(crate) fn is_current(&self, key: u32) -> bool {
        key >> self.shift == self.current
    }

    /// Every key still in the queue is at least this.
    pub(crate) fn least_key(&self) -> u32 {
        self.current << self.shift
    }

    /// Items with the least key of the bucket that holds them, stale ones too, from the lowest bucket on.
    pub(crate) fn items(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let filled = if self.len == 0 { 0 } else { self.highest - self.current + 1 };
        (self.current..self.current + filled).flat_map(move |bucket| {
            let items = &self.ring[bucket as usize & (self.ring.len() - 1)];
            items.iter().map(move |item| (*item, bucket << self.shift))
        })
    }

    /// Whether a key belongs to the bucket of a least key.
    pub(crate) fn is_in(&self, key: u32, bucket_key: u32) -> bool {
        key >> self.shift == bucket_key >> self.shift
    }

    /// Forgets all items and starts anew; memory is kept.
    pub(crate) fn clear(&mut self) {
        if self.len > 0 {
            self.ring.iter_mut().for_each(Vec::clear);
        }
        (self.current, self.highest, self.len) = (0, 0, 0);
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.ring.iter().map(|bucket| bucket.capacity() * size_of::<u32>()).sum()
    }

    /// Takes a bucket beyond those from the current to the highest into the ring.
    #[inline(never)]
    fn widen(&mut self, bucket: u32) {
        let (lowest, highest) = (self.current.min(bucket), self.highest.max(bucket));
        let needed = (highest - lowest) as usize + 1;
        if needed > self.ring.len() {
            self.grow(needed);
        }
        (self.current, self.highest) = (lowest, highest);
    }

    #[cold]
    fn grow(&mut self, needed: usize) {
        let size = needed.next_power_of_two();
        let old_size = self.ring.len();
        let mut ring = vec![Vec::new(); size];
        for distance in 0..old_size {
            let bucket = self.current as usize + distance;
            ring[bucket & (size - 1)] = std::mem::take(&mut self.ring[bucket & (old_size - 1)]);
        }
        self.ring = ring;
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn items_come_out_in_the_order_of_their_buckets_even_when_the_ring_grows() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
        let mut queue = BucketQueue::new(4);
        let mut last = 0;
        queue.push(0, 0);
        let mut pushed = 1;
        let mut popped = 0;
        while let Some(key) = queue.pop() {
            popped += 1;
            assert!(key >> 4 >= last >> 4, "{key} after {last}");
            assert!(queue.least_key() <= key && queue.is_current(key));
            last = last.max(key);
            if pushed < 20_000 {
                for _ in 0..2 {
                    let far = random.random_range(0..if pushed % 100 == 0 { 200_000 } else { 500 });
                    queue.push(last + far, last + far);
                    pushed += 1;
                }
            }
        }
        assert_eq!(popped, pushed);
    }
}
