//! The part of the lattice that the best path within limits can run through, as an explicit graph in double precision.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, HashMap},
};

use planner::{ExactField, Heading, Lattice, Patience, State, work};
use rayon::prelude::*;
use terrain::Cell;

use crate::{
    bounded::{Bounded, TABLE_ROUNDING, variants},
    error::Error,
    limits::{Amounts, plus, weighed},
};

/// States through which a weighted sum of amounts can stay within a limit, with all their motions between them.
pub(crate) struct Corridor {
    pub(crate) states: Vec<State>,
    /// Nodes that the path may start from.
    pub(crate) starts: Vec<u32>,
    /// Nodes that it may end in, with the energy of their height above the lowest goal [J].
    pub(crate) goals: Vec<(u32, f64)>,
    /// Where the arcs of each node begin; one more than nodes.
    first: Vec<u32>,
    arcs: Vec<Arc>,
    /// Where the arcs into each node begin in `into`; one more than nodes.
    first_into: Vec<u32>,
    /// Nodes that arcs come from, with the arcs, by the node that they lead to.
    into: Vec<(u32, u32)>,
}

/// A motion in one of its variants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub(crate) to: u32,
    pub(crate) motion: u16,
    pub(crate) variant: u16,
    pub(crate) takes: Amounts,
}

/// Motions that a path may have for each row and column of the map, at a unit of cost each.
const MOTIONS_PER_SIDE: usize = 16;
/// States whose arcs are worked out between two looks at the clock.
const STATES_IN_A_LOOK: usize = 32;
/// Most states of a corridor: their arcs take 2 GB.
const MOST_STATES: usize = 1 << 22;

impl Corridor {
    /// The states on paths of which the weighted sum is at most `most`; `None` where they are too many.
    pub(crate) fn new(bounded: &Bounded<'_>, sum: Amounts, most: f64) -> Result<Option<Self>, Error> {
        let patience = &bounded.query.patience;
        let late = || Error::Planner(planner::Error::Timeout { expanded: 0 });
        let table = bounded.table(sum);
        let grid = &bounded.planner.lattice().terrain.grid;
        // Where motions cost next to nothing they still have a unit each.
        let units = (MOTIONS_PER_SIDE * (grid.rows + grid.columns)) as f64;
        let most = most * (1.0 + 2.0 * TABLE_ROUNDING) + units / table.units();
        let seeds: Vec<(State, f64)> = bounded.ends.starts.iter().map(|start| (*start, 0.0)).collect();
        let goals = bounded.goals_in(&sum);
        let (from, to) = rayon::join(
            || ExactField::from_starts(&table, &seeds, most, patience).ok_or_else(late),
            || ExactField::to_goals(&table, &goals, most, patience).ok_or_else(late),
        );
        let (from, to) = (from?, to?);
        let lattice = bounded.planner.lattice();
        let holds = |state: &State| {
            from.cost(*state).zip(to.cost(*state)).is_some_and(|(before, after)| before + after <= most)
        };
        let Some(states) = states_that(lattice, holds, patience).ok_or_else(late)? else { return Ok(None) };
        let mut node = HashMap::with_capacity(states.len());
        let mut pacer = patience.pacer();
        for (i, state) in states.iter().enumerate() {
            pacer.after(work::STATE).ok_or_else(late)?;
            node.insert(lattice.index(*state), i as u32);
        }
        drop(pacer);
        looked(patience).ok_or_else(late)?;
        let at = |state: State| node.get(&lattice.index(state)).copied();
        let leaving = |state: &State| -> Vec<Arc> {
            let arcs = (0..lattice.motions_per_state()).flat_map(|motion| {
                let end =
                    lattice.successor(*state, motion).filter(|_| table.cost(*state, motion).is_finite());
                let end = end.and_then(|end| Some((end, at(end)?)));
                end.into_iter().flat_map(move |(end, to)| {
                    variants(lattice, *state, end, motion).map(move |(variant, takes)| Arc {
                        to,
                        motion: motion as u16,
                        variant: variant as u16,
                        takes,
                    })
                })
            });
            arcs.collect()
        };
        let some = |states: &[State]| -> Option<Vec<Vec<Arc>>> {
            if patience.is_over() {
                return None;
            }
            patience.worked(states.len() as u64 * lattice.motions_per_state() as u64 * work::MOTION);
            Some(states.iter().map(leaving).collect())
        };
        let arcs: Vec<Vec<Vec<Arc>>> =
            states.par_chunks(STATES_IN_A_LOOK).map(some).collect::<Option<_>>().ok_or_else(late)?;
        let starts = bounded.ends.starts.iter().filter_map(|start| at(*start)).collect();
        let goals = bounded.goals.iter().filter_map(|(goal, after_j)| Some((at(*goal)?, *after_j))).collect();
        let arcs = arcs.into_iter().flatten().collect::<Vec<_>>();
        looked(patience).ok_or_else(late)?;
        Ok(Some(Self::of(states, (starts, goals), &arcs, patience).ok_or_else(late)?))
    }

    fn of(
        states: Vec<State>,
        (starts, goals): (Vec<u32>, Vec<(u32, f64)>),
        arcs: &[Vec<Arc>],
        patience: &Patience,
    ) -> Option<Self> {
        let mut pacer = patience.pacer();
        let mut first = vec![0u32];
        let mut first_into = vec![0u32; arcs.len() + 1];
        for leaving in arcs {
            pacer.after(work::STATE)?;
            first.push(first.last().copied().unwrap_or(0) + leaving.len() as u32);
            for arc in leaving {
                first_into[arc.to as usize + 1] += 1;
            }
        }
        for i in 0..arcs.len() {
            first_into[i + 1] += first_into[i];
        }
        let mut all = Vec::with_capacity(first.last().map_or(0, |count| *count as usize));
        for leaving in arcs {
            pacer.after(work::STATE)?;
            all.extend_from_slice(leaving);
        }
        let arcs = all;
        let mut into = vec![(0, 0); arcs.len()];
        let mut next = first_into.clone();
        for node in 0..states.len() {
            pacer.after(work::STATE)?;
            for at in first[node]..first[node + 1] {
                let slot = &mut next[arcs[at as usize].to as usize];
                into[*slot as usize] = (node as u32, at);
                *slot += 1;
            }
        }
        drop(pacer);
        looked(patience)?;
        Some(Corridor { states, starts, goals, first, arcs, first_into, into })
    }

    /// The arcs that leave a node.
    pub(crate) fn leaving(&self, node: u32) -> &[Arc] {
        &self.arcs[self.first[node as usize] as usize..self.first[node as usize + 1] as usize]
    }

    /// An arc by its position among those that leave a node.
    pub(crate) fn arc(&self, node: u32, position: u8) -> &Arc {
        &self.leaving(node)[usize::from(position)]
    }

    /// Least of a weighted sum from every node to a goal, by Dijkstra's search; `None` where patience ends first.
    pub(crate) fn least_ahead(&self, sum: &Amounts, patience: &Patience) -> Option<Ahead> {
        let nowhere = AheadOf { least: f64::INFINITY, takes: Amounts::default(), arc: NO_ARC };
        let mut nodes = vec![nowhere; self.states.len()];
        let mut open = BinaryHeap::new();
        for (goal, after_j) in &self.goals {
            let after = after_j * sum[0];
            if after < nodes[*goal as usize].least {
                nodes[*goal as usize] = AheadOf { least: after, takes: [*after_j, 0.0, 0.0], arc: NO_ARC };
                open.push(Reverse((Ordered(after), *goal)));
            }
        }
        let mut pacer = patience.pacer();
        while let Some(Reverse((Ordered(least), node))) = open.pop() {
            pacer.after(2 * work::STATE)?;
            let here = nodes[node as usize];
            if least > here.least {
                continue;
            }
            let into = self.first_into[node as usize] as usize..self.first_into[node as usize + 1] as usize;
            for &(before, at) in &self.into[into] {
                let arc = &self.arcs[at as usize];
                let through = least + weighed(&arc.takes, sum);
                if through < nodes[before as usize].least {
                    nodes[before as usize] =
                        AheadOf { least: through, takes: plus(&here.takes, &arc.takes), arc: at };
                    open.push(Reverse((Ordered(through), before)));
                }
            }
        }
        drop(pacer);
        Some(Ahead { nodes })
    }

    /// The motions of the best way on from a node.
    pub(crate) fn way_on(&self, ahead: &Ahead, mut node: u32) -> Vec<(usize, usize)> {
        let mut motions = Vec::new();
        while let Some(arc) = self.arcs.get(ahead.nodes[node as usize].arc as usize) {
            motions.push(arc.driven());
            node = arc.to;
        }
        motions
    }
}

/// States of a lattice that pass, in their order; `None` inside where they are too many, outside where patience ends first.
fn states_that(
    lattice: &Lattice,
    passes: impl Fn(&State) -> bool + Sync,
    patience: &Patience,
) -> Option<Option<Vec<State>>> {
    let grid = &lattice.terrain.grid;
    let of_row = |row: usize| {
        if patience.is_over() {
            return None;
        }
        let (mut states, mut pacer) = (Vec::new(), patience.pacer());
        for column in 0..grid.columns {
            pacer.after(work::STATE)?;
            let cell = Cell { row, column };
            states.extend(Heading::all().map(|heading| State { cell, heading }).filter(&passes));
        }
        Some(states)
    };
    let rows: Vec<Vec<State>> = (0..grid.rows).into_par_iter().map(of_row).collect::<Option<_>>()?;
    let count: usize = rows.iter().map(Vec::len).sum();
    if count > MOST_STATES {
        return Some(None);
    }
    let (mut states, mut pacer) = (Vec::with_capacity(count), patience.pacer());
    for row in rows {
        pacer.after(row.len() as u64 * work::CELL)?;
        states.extend(row);
    }
    drop(pacer);
    Some(Some(states))
}

impl Arc {
    /// Motion and variant.
    pub(crate) fn driven(&self) -> (usize, usize) {
        (usize::from(self.motion), usize::from(self.variant))
    }
}

/// The best ways from all nodes to a goal, by a weighted sum.
pub(crate) struct Ahead {
    nodes: Vec<AheadOf>,
}

/// The best way from a node to a goal.
#[derive(Clone, Copy)]
pub(crate) struct AheadOf {
    /// Least of the weighted sum; infinite where no way leads.
    pub(crate) least: f64,
    /// What the way takes.
    pub(crate) takes: Amounts,
    /// Its first arc.
    arc: u32,
}

/// What stands for an arc at a goal.
const NO_ARC: u32 = u32::MAX;

impl Ahead {
    /// The way on from a node.
    pub(crate) fn of(&self, node: u32) -> &AheadOf {
        &self.nodes[node as usize]
    }
}

/// A number that is never NaN, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ordered(pub(crate) f64);

impl Eq for Ordered {}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// A look at the clock between two steps, of which each may leave work that it did not look after.
fn looked(patience: &Patience) -> Option<()> {
    (!patience.is_over()).then_some(())
}
