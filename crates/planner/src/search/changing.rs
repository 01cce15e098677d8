//! A* over poses and what the robot did last, where changes of that have a price.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, HashMap},
};

use crate::{
    field::goal_field::GoalField,
    frontier::labels::UNREACHED,
    grid::{
        cost::{FORBIDDEN, decode},
        heading::HEADINGS,
        layout::{Layout, Shift},
        state::State,
    },
    patience::{Pacer, work},
    search::{
        astar::{Found, Outcome, Search},
        changes::{Changes, Mode, Way},
    },
    table::{
        cost_table::CostTable,
        tile_builder::{QUAD, code_place},
    },
};

/// Weights of the estimate, one pass after the other, as the search without changes has them.
const WEIGHTS: [f64; 3] = [1.2, 1.05, 1.0];
/// Work of one expansion: labels lie in a table by their hash.
const EXPANSION: u64 = 8 * work::STATE;

/// A pose and what the robot did last.
type Node = (u32, Mode);

/// How a node was reached at least cost.
#[derive(Clone, Copy)]
struct Label {
    cost: u32,
    /// The node before and the motion from it; `None` at a start.
    from: Option<(Node, u16)>,
}

/// A motion as the search takes it.
struct Move {
    shift: Shift,
    heading: u32,
    way: Way,
}

/// The best path so far: its cost and the node at its end, by the labels of its pass.
struct Best {
    total: u32,
    start: State,
    motions: Vec<usize>,
}

/// Finds a path from any start to any goal whose cost, with that of changes, is within the bound asked for.
///
/// The field's estimate leaves changes out, so that it never exceeds what is ahead; along a motion it falls by at most the motion's cost,
/// and changes only add to that.
pub(crate) fn search_changing(
    table: &CostTable,
    field: &GoalField,
    query: &Search<'_>,
    changes: &Changes,
) -> Outcome {
    let lattice = table.lattice();
    let least =
        query.starts.iter().map(|s| field.units_at(lattice.layout.pack(*s))).min().unwrap_or(UNREACHED);
    if least == UNREACHED {
        return Outcome::Unreachable;
    }
    let goals =
        query.goals.iter().map(|(goal, after)| (lattice.layout.pack(*goal), (after * table.units()) as u32));
    let mut passes = Passes {
        table,
        field,
        query,
        goals: goals.collect(),
        moves: moves(table),
        changes,
        expanded: 0,
        least,
        best: None,
    };
    let mut pacer = query.patience.pacer();
    let loosest = query.bound.max(WEIGHTS[0]);
    for weight in [loosest].into_iter().chain(WEIGHTS[1..].iter().copied()) {
        if passes.run(weight, &mut pacer).is_none() {
            return passes.outcome(true);
        }
        if passes.best.is_none() {
            return Outcome::Unreachable;
        }
        if passes.is_proven() {
            break;
        }
    }
    passes.outcome(false)
}

struct Passes<'p> {
    table: &'p CostTable,
    field: &'p GoalField,
    query: &'p Search<'p>,
    goals: HashMap<u32, u32>,
    moves: Vec<Move>,
    changes: &'p Changes,
    expanded: u64,
    /// No path costs less than this.
    least: u32,
    best: Option<Best>,
}

impl Passes<'_> {
    /// One pass in the order of cost plus weighted estimate; `None` when patience ends first.
    fn run(&mut self, weight: f64, pacer: &mut Pacer<'_>) -> Option<()> {
        let layout = &self.table.lattice().layout;
        let key = |cost: u32, ahead: u32| f64::from(cost) + weight * f64::from(ahead);
        let mut labels: HashMap<Node, Label> = HashMap::new();
        let mut open = BinaryHeap::new();
        for start in self.query.starts {
            let node = (layout.pack(*start), Mode::Standing);
            let ahead = self.field.units_at(node.0);
            if ahead != UNREACHED {
                labels.insert(node, Label { cost: 0, from: None });
                open.push(Reverse((key(0, ahead).to_bits(), 0, node)));
            }
        }
        let limit = self.best.as_ref().map_or(UNREACHED, |best| best.total);
        let mut end: Option<(u32, Node)> = None;
        let mut least_total = limit;
        // The key of what is open, where anything is left so. Of keys, which are 0 or more, the order is that of their bits.
        let mut least_key = None;
        while let Some(Reverse((bits, cost, node))) = open.pop() {
            if labels.get(&node).is_none_or(|label| label.cost != cost) {
                continue;
            }
            if f64::from_bits(bits) >= weight * f64::from(least_total) {
                least_key = Some(f64::from_bits(bits));
                break;
            }
            self.expanded += 1;
            if let Some(after) = self.goals.get(&node.0)
                && cost.saturating_add(*after) < least_total
            {
                least_total = cost + after;
                end = Some((least_total, node));
                if weight > 1.0 {
                    least_key = Some(f64::from_bits(bits));
                    break;
                }
            }
            pacer.after(EXPANSION)?;
            let codes = self.table.codes(Layout::tile(node.0), self.query.patience)?;
            let stride = self.table.stride();
            let codes = &codes[code_place(Layout::within(node.0), stride)..];
            let moves = &self.moves[(node.0 as usize & (HEADINGS - 1)) * stride..][..stride];
            for (motion, (code, step)) in (0u16..).zip(codes.iter().step_by(QUAD).zip(moves)) {
                if *code == FORBIDDEN {
                    continue;
                }
                let (mode, stops, turns_back) = node.1.followed_by(step.way);
                let next = (layout.shift(node.0, step.shift) | step.heading, mode);
                let total = cost.saturating_add(decode(*code)).saturating_add(self.units(stops, turns_back));
                let ahead = self.field.units_at(next.0);
                let is_lower = labels.get(&next).is_none_or(|label| total < label.cost);
                if is_lower && ahead != UNREACHED && total.saturating_add(ahead) < least_total {
                    labels.insert(next, Label { cost: total, from: Some((node, motion)) });
                    open.push(Reverse((key(total, ahead).to_bits(), total, next)));
                }
            }
        }
        // A path by an open node costs at least its key over the weight, and one that was left out no less than the best.
        let by_open = least_key.map_or(f64::INFINITY, |least_key| least_key / weight);
        let is_best = by_open >= f64::from(least_total);
        let proven = if is_best { least_total } else { (by_open as u32).saturating_sub(1) };
        self.least = self.least.max(proven);
        if let Some((total, node)) = end.filter(|(total, _)| *total < limit) {
            let (start, motions) = traced(&labels, node, layout);
            self.best = Some(Best { total, start, motions });
        }
        Some(())
    }

    /// What a change adds, in the table's units, rounded up.
    fn units(&self, stops: bool, turns_back: bool) -> u32 {
        if !(stops || turns_back) {
            return 0;
        }
        let price = self.changes.price(stops, turns_back);
        (self.table.weights().of_surcharge(&price) * self.table.units()).ceil() as u32
    }

    /// No path takes less than this when driven, in the objective's unit.
    fn proven_least(&self) -> f64 {
        self.table.proven(f64::from(self.least)) + self.query.besides
    }

    /// The best path's cost over the least possible, where that is above nothing.
    fn proven_bound(&self, best: &Best) -> Option<f64> {
        let least = self.proven_least();
        let most = self.table.at_most(f64::from(best.total) + 1.0) + self.query.besides;
        (least > 0.0).then(|| most / least)
    }

    fn is_proven(&self) -> bool {
        let Some(best) = &self.best else { return false };
        best.total <= self.least || self.proven_bound(best).is_some_and(|bound| bound <= self.query.bound)
    }

    fn outcome(self, late: bool) -> Outcome {
        let Some(best) = &self.best else { return Outcome::Timeout { expanded: self.expanded } };
        let optimal = best.total <= self.least;
        let bound = self.proven_bound(best);
        let late = late && !optimal && bound.is_none_or(|bound| bound > self.query.bound);
        let (start, motions) = (best.start, best.motions.clone());
        let least = self.proven_least();
        Outcome::Found(Found { start, motions, expanded: self.expanded, least, bound, optimal, late })
    }
}

/// The start of a node's path and the motions to it.
fn traced(labels: &HashMap<Node, Label>, end: Node, layout: &Layout) -> (State, Vec<usize>) {
    let (mut node, mut motions) = (end, Vec::new());
    while let Some((before, motion)) = labels.get(&node).and_then(|label| label.from) {
        motions.push(usize::from(motion));
        node = before;
    }
    motions.reverse();
    (layout.unpack(node.0), motions)
}

/// All motions by heading.
fn moves(table: &CostTable) -> Vec<Move> {
    let lattice = table.lattice();
    let one = |motion: &crate::lattice::primitive::Motion| Move {
        shift: lattice.layout.prepare(motion.columns, motion.rows),
        heading: motion.to.index() as u32,
        way: Way::of(motion),
    };
    lattice.motions.iter().flatten().map(one).collect()
}
