//! Least costs along a row of a tile, where a cell's hangs on its neighbour's: one cell after the other.

use crate::{
    field::{
        stencil::Side,
        sweep::{Sweep, groups_of},
    },
    grid::cost::{ENDLESS, decode_lanes},
    table::tile_builder::{GROUPS, LANES, Lanes},
};

impl Sweep {
    /// Steps within a row: one cell after the other, but only where a look at all of them side by side has shown that any
    /// falls.
    #[inline(always)]
    pub(crate) fn relax_along(&mut self, row: usize, groups: u8, least: &[Lanes]) -> u64 {
        let (mut fallen, mut groups) = (0, groups);
        while groups != 0 {
            let mut now = 0;
            for side in [Side::West, Side::East] {
                let falling = self.falling_along(row, side, groups | groups_of(now), least);
                now |= self.scan(row, side, falling, least);
            }
            fallen |= now;
            let [west, east] = &self.stencil.along;
            groups = groups_of(west.origins(now) | east.origins(now));
        }
        fallen
    }

    /// Groups of lanes in which a step to one side lowers any cost.
    #[inline(always)]
    fn falling_along(&self, row: usize, side: Side, groups: u8, least: &[Lanes]) -> u8 {
        let mut falling = 0;
        for group in (0..GROUPS).filter(|group| groups >> group & 1 == 1) {
            let at = self.place(row) + group * LANES;
            let Some(own) = self.costs[at..].first_chunk::<LANES>() else { continue };
            let mut any = 0u32;
            for (step, columns) in &self.stencil.along[side as usize].steps {
                let ends = self.costs[(at as isize + columns) as usize..].first_chunk::<LANES>();
                let step = group * self.stencil.count + step;
                if let (Some(ends), Some(codes)) = (ends, least.get(step)) {
                    let costs = decode_lanes(&codes.0);
                    for x in 0..LANES {
                        any |= u32::from(ends[x] + costs[x] < own[x]);
                    }
                }
            }
            falling |= (any as u8) << group;
        }
        falling
    }

    /// Lowers one cell after the other by steps to one side, beginning there, in groups of lanes and on from them.
    #[inline(always)]
    fn scan(&mut self, row: usize, side: Side, falling: u8, least: &[Lanes]) -> u64 {
        let (mut fallen, mut falling) = (0, falling);
        for i in 0..GROUPS {
            let group = if side == Side::West { i } else { GROUPS - 1 - i };
            if falling >> group & 1 == 1 {
                let count = self.stencil.count;
                let here = self.scan_group(row, side, group, &least[group * count..][..count]);
                falling |= groups_of(self.stencil.along[side as usize].origins(here));
                fallen |= here;
            }
        }
        fallen
    }

    /// Takes the step to the next cell, whose cost is at hand, together with each of the steps further.
    #[inline(always)]
    fn scan_group(&mut self, row: usize, side: Side, group: usize, least: &[Lanes]) -> u64 {
        let at = self.place(row) + group * LANES;
        let steps = || self.stencil.along[side as usize].steps.iter();
        let codes = |step: &usize| least.get(*step).map_or([ENDLESS; LANES], |codes| decode_lanes(&codes.0));
        let next =
            steps().find(|(_, columns)| columns.abs() == 1).map_or([ENDLESS; LANES], |(i, _)| codes(i));
        let count = steps().filter(|(_, columns)| columns.abs() != 1).count();
        let mut fallen = 0;
        for i in 0..count.max(1) {
            let steps = self.stencil.along[side as usize].steps.iter();
            let step = steps.filter(|(_, columns)| columns.abs() != 1).nth(i);
            let (further, far) = step.map_or(([ENDLESS; LANES], 0), |(i, columns)| (codes(i), *columns));
            fallen |= scan_lanes(&mut self.costs, at, side, &next, (&further, far));
        }
        fallen << (group * LANES)
    }
}

/// Lowers the costs of a group of lanes one after the other; returns those that fell.
#[inline(always)]
fn scan_lanes(
    costs: &mut [u32],
    at: usize,
    side: Side,
    next: &[u32; LANES],
    (further, far): (&[u32; LANES], isize),
) -> u64 {
    let mut fallen = 0;
    let mut last = costs[if side == Side::West { at - 1 } else { at + LANES }];
    for i in 0..LANES {
        let x = if side == Side::West { i } else { LANES - 1 - i };
        let before = costs[at + x];
        let end = costs[((at + x) as isize + far) as usize];
        last = (last + next[x]).min(end + further[x]).min(before);
        costs[at + x] = last;
        fallen |= u64::from(last < before) << x;
    }
    fallen
}
