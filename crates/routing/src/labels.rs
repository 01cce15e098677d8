//! The search for the best path within limits: labels of all amounts, dropped only when another is no worse in every one.

use std::{cmp::Reverse, collections::BinaryHeap};

use planner::{Pacer, Patience, work};
use rayon::prelude::*;

use crate::{
    corridor::{Ahead, Corridor, Ordered},
    limits::{Amounts, only, plus, weighed},
};

/// What to search for.
pub(crate) struct Labelling<'c> {
    pub(crate) corridor: &'c Corridor,
    /// Place of what the path is to have least of.
    pub(crate) objective: usize,
    /// Most of each amount; infinite where there is no limit.
    pub(crate) most: Amounts,
    /// A weighted sum that bounds the objective from below, with what is taken off.
    pub(crate) bound: (Amounts, f64),
    /// Whether a path of at most so much of the objective is good enough, given that none has less than the second.
    pub(crate) suffices: &'c dyn Fn(f64, f64) -> bool,
    pub(crate) patience: &'c Patience,
}

/// How the search ended.
pub(crate) struct Labelled {
    /// The node that the best path starts from and its motions, where it is better than the one known before.
    pub(crate) path: Option<(u32, Vec<(usize, usize)>)>,
    /// No path within the limits has less of the objective; infinite where there is none.
    pub(crate) least: f64,
    /// Labels that were expanded.
    pub(crate) expanded: u64,
    /// Whether patience ended, or memory for labels, before what was asked for was proven.
    pub(crate) late: bool,
}

/// A path to a node.
struct Label {
    node: u32,
    /// The label that it came from; its own place where it starts.
    from: u32,
    /// The arc that it came by, among those that leave the node before.
    arc: u8,
    /// Whether another label at the node is no worse in every amount.
    dominated: bool,
    takes: Amounts,
}

/// The best path so far: a label, and the way on from it among those worked out for all nodes.
#[derive(Clone, Copy)]
struct Best {
    amount: f64,
    label: u32,
    way_on: usize,
}

/// Amounts that differ by less than this share of what the whole path takes are taken for equal: rounding of sums.
const ROUNDING: f64 = 1e-10;
/// Most labels: 3 GB.
const MOST_LABELS: usize = 1 << 26;
/// Work of taking up a label: a place in the queue and those it leads to.
const LABEL: u64 = 8 * work::STATE;

impl Labelling<'_> {
    /// Searches in the order of the lower bound for a path with less of the objective than `known`.
    ///
    /// At every node a label is kept unless another has no more of the objective and of every limited amount; a label is
    /// dropped when what is still ahead, exact for each amount alone, takes it beyond a limit or its bound beyond the best
    /// path known. So what the first label in turn is bounded by is the least there is. Each label is also tried with the
    /// ways on that are best for one amount or the sum: the paths that this makes prune the rest.
    pub(crate) fn search(&self, known: f64) -> Labelled {
        let Some(mut run) = Run::new(self, known) else {
            return Labelled { path: None, least: f64::NEG_INFINITY, expanded: 0, late: true };
        };
        for &start in &self.corridor.starts {
            let from = run.labels.len() as u32;
            run.take(Label { node: start, from, arc: 0, dominated: false, takes: Amounts::default() }, 0.0);
        }
        while let Some(Reverse((Ordered(least), id))) = run.open.pop() {
            if run.labels[id as usize].dominated {
                continue;
            }
            let found = run.best.map_or(known, |best| best.amount);
            if least >= found - run.tolerance[self.objective]
                || (run.best.is_some() && (self.suffices)(found, least))
            {
                return run.ended(least.min(found), false);
            }
            let work = run.work();
            let is_late = run.pacer.after(work).is_none();
            if is_late || run.labels.len() >= MOST_LABELS {
                return run.ended(least, true);
            }
            run.expand(id, least);
        }
        let least = run.best.map_or(known, |best| best.amount);
        run.ended(least, false)
    }
}

/// A search under way.
struct Run<'r> {
    labelling: &'r Labelling<'r>,
    /// The objective's place, then those of limited amounts.
    active: Vec<usize>,
    /// Ways on: by each active amount alone, in their order, then by the sum of the bound.
    ahead: Vec<Ahead>,
    /// What counts as equal of each amount.
    tolerance: Amounts,
    known: f64,
    labels: Vec<Label>,
    /// Labels of each node that no other beats.
    at_node: Vec<Vec<u32>>,
    open: BinaryHeap<Reverse<(Ordered, u32)>>,
    best: Option<Best>,
    expanded: u64,
    /// Labels that were compared since the last look at the work done.
    compared: u64,
    pacer: Pacer<'r>,
}

impl<'r> Run<'r> {
    /// The ways on from all nodes; `None` where patience ends first.
    fn new(labelling: &'r Labelling<'r>, known: f64) -> Option<Self> {
        let Labelling { corridor, objective, most, .. } = labelling;
        let limited = (0..3).filter(|at| at != objective && most[*at].is_finite());
        let active: Vec<usize> = [*objective].into_iter().chain(limited).collect();
        let sums: Vec<Amounts> = active.iter().map(|at| only(*at)).chain([labelling.bound.0]).collect();
        let scale = |at: usize| if at == *objective { known.min(most[at]) } else { most[at] };
        let finite = |scale: f64| if scale.is_finite() { scale.abs() } else { 0.0 };
        let patience = labelling.patience;
        let ahead = sums.par_iter().map(|sum| corridor.least_ahead(sum, patience)).collect::<Option<_>>()?;
        Some(Run {
            labelling,
            ahead,
            active,
            tolerance: std::array::from_fn(|at| ROUNDING * finite(scale(at))),
            known,
            labels: Vec::new(),
            at_node: vec![Vec::new(); corridor.states.len()],
            open: BinaryHeap::new(),
            best: None,
            expanded: 0,
            compared: 0,
            pacer: patience.pacer(),
        })
    }

    /// Work since it was last asked for.
    fn work(&mut self) -> u64 {
        LABEL + std::mem::take(&mut self.compared) * 2 * work::CELL
    }

    /// Less than this of the objective is worth looking for.
    fn aim(&self) -> f64 {
        self.best.map_or(self.known, |best| best.amount) - self.tolerance[self.labelling.objective]
    }

    /// The least of the objective that a label can lead to, or `None` where it leads to nothing.
    fn bound(&self, label: &Label) -> Option<f64> {
        let labelling = self.labelling;
        for (at, ahead) in self.active.iter().zip(&self.ahead) {
            if label.takes[*at] + ahead.of(label.node).least > labelling.most[*at] + self.tolerance[*at] {
                return None;
            }
        }
        let own = label.takes[labelling.objective] + self.ahead[0].of(label.node).least;
        let (sum, off) = &labelling.bound;
        let of_sum = weighed(&label.takes, sum) + self.ahead[self.active.len()].of(label.node).least - off;
        Some(own.max(of_sum)).filter(|bound| *bound < self.aim())
    }

    /// Takes up a label, unless it leads to nothing or another is no worse.
    fn take(&mut self, label: Label, least: f64) {
        let Some(bound) = self.bound(&label) else { return };
        let (active, tolerance) = (&self.active, &self.tolerance);
        let no_worse = |a: &Amounts, b: &Amounts| active.iter().all(|at| a[*at] <= b[*at] + tolerance[*at]);
        let labels = &mut self.labels;
        let here = &mut self.at_node[label.node as usize];
        self.compared += here.len() as u64;
        if here.iter().any(|other| no_worse(&labels[*other as usize].takes, &label.takes)) {
            return;
        }
        here.retain(|other| {
            let other = &mut labels[*other as usize];
            other.dominated = no_worse(&label.takes, &other.takes);
            !other.dominated
        });
        let id = labels.len() as u32;
        here.push(id);
        self.open.push(Reverse((Ordered(bound.max(least)), id)));
        self.complete(&label, id);
        self.labels.push(label);
    }

    /// Tries the ways on that are known from a label's node.
    fn complete(&mut self, label: &Label, id: u32) {
        let Labelling { objective, most, .. } = self.labelling;
        for way_on in 0..self.ahead.len() {
            let whole = plus(&label.takes, &self.ahead[way_on].of(label.node).takes);
            let within = self.active.iter().all(|at| whole[*at] <= most[*at] + self.tolerance[*at]);
            if within && whole[*objective] < self.aim() {
                self.best = Some(Best { amount: whole[*objective], label: id, way_on });
            }
        }
    }

    /// Takes up what a label's node leads to.
    fn expand(&mut self, id: u32, least: f64) {
        self.expanded += 1;
        let Label { node, takes, .. } = self.labels[id as usize];
        for (position, arc) in self.labelling.corridor.leaving(node).iter().enumerate() {
            let takes = plus(&takes, &arc.takes);
            let label = Label { node: arc.to, from: id, arc: position as u8, dominated: false, takes };
            self.take(label, least);
        }
    }

    fn ended(&self, least: f64, late: bool) -> Labelled {
        let corridor = self.labelling.corridor;
        let path = self.best.map(|best| {
            let (mut id, mut motions) = (best.label, Vec::new());
            while self.labels[id as usize].from != id {
                let label = &self.labels[id as usize];
                let before = self.labels[label.from as usize].node;
                motions.push(corridor.arc(before, label.arc).driven());
                id = label.from;
            }
            motions.reverse();
            motions.extend(corridor.way_on(&self.ahead[best.way_on], self.labels[best.label as usize].node));
            (self.labels[id as usize].node, motions)
        });
        Labelled { path, least, expanded: self.expanded, late }
    }
}
