//! Fields of goals that were asked for lately.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use terrain::Cell;

use crate::{
    field::goal_field::{FieldEnds, GoalField},
    grid::state::State,
    lattice::objective::Objective,
    patience::Patience,
    pose_field::exact::ExactField,
    table::{cost_table::CostTable, step_costs::StepCosts},
};

/// What a field is for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldKey {
    objective: Objective,
    goals: Vec<State>,
}

impl FieldKey {
    pub(crate) fn new(objective: Objective, goals: &[State]) -> Self {
        FieldKey { objective, goals: goals.to_vec() }
    }
}

/// What is known of a goal.
struct Entry {
    key: FieldKey,
    /// The start towards which the field grew, if it does not cover the map.
    towards: Option<Cell>,
    field: Option<Arc<GoalField>>,
    /// What a field of another planner proves towards a start.
    related: Option<(Cell, Arc<GoalField>)>,
    exact: Option<Arc<ExactField>>,
}

impl Entry {
    fn own(&self, start: Cell) -> Option<Arc<GoalField>> {
        self.field.as_ref().filter(|_| self.towards.is_none_or(|cell| cell == start)).map(Arc::clone)
    }

    fn bytes(&self) -> usize {
        self.field.as_ref().map_or(0, |field| field.bytes())
            + self.related.as_ref().map_or(0, |(_, field)| field.bytes())
            + self.exact.as_ref().map_or(0, |exact| exact.bytes())
    }
}

/// The search that a field is for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Towards {
    /// Where it starts.
    pub(crate) start: Cell,
    /// What the field may take steps to cost.
    pub(crate) costs: StepCosts,
    /// The bound that it is to prove.
    pub(crate) bound: f64,
}

/// The goals asked for last, the latest at the end.
#[derive(Default)]
pub(crate) struct FieldCache {
    entries: Mutex<Vec<Entry>>,
}

/// Goals that are remembered, whatever they take.
const ENTRIES: usize = 8;
/// More are remembered while all together take no more bytes, as the fields of 64 goals on a map of 1000 × 1000 cells do,
const MOST_BYTES: usize = 256 << 20;
/// and while they are soon looked through.
const MOST_ENTRIES: usize = 256;
/// Up to so many cells a goal that is asked for from a second start gets a field over the whole map: the table that this
/// takes is a gigabyte and a third.
const MOST_CELLS_COVERED: usize = 1 << 22;

impl FieldCache {
    /// The field of a goal for a search from a start: the one at hand if it serves, or a new one; `None` when patience ends.
    ///
    /// One over costs of steps serves where bounds of them would do, not the other way round.
    pub(crate) fn field(
        &self,
        key: FieldKey,
        table: &CostTable,
        goals: &[(State, f64)],
        towards: Towards,
        patience: &Patience,
    ) -> Option<Arc<GoalField>> {
        let Towards { start, mut costs, bound } = towards;
        let mut towards = Some(start);
        if let Some(entry) = self.latest(&key) {
            let serves = |field: &&Arc<GoalField>| {
                entry.towards.is_none_or(|cell| cell == start)
                    && (field.costs() == costs || field.costs() == StepCosts::Least)
            };
            if let Some(field) = entry.field.as_ref().filter(serves) {
                return Some(Arc::clone(field));
            }
            let asked_before = entry.field.is_some() && entry.towards != Some(start);
            if asked_before && table.lattice().terrain.grid.cells() <= MOST_CELLS_COVERED {
                towards = None;
                costs = costs.for_many(bound);
            }
        }
        // The lock is not held meanwhile: others may want other goals.
        let ends = FieldEnds { goals, start: towards };
        let field = Arc::new(GoalField::over(table, costs, ends, patience)?);
        self.keep(key, |entry| {
            (entry.field, entry.towards, entry.related) = (Some(Arc::clone(&field)), towards, None);
        });
        Some(field)
    }

    /// The field of a goal towards a start, or all over the map, that was worked out from the planner's own costs.
    pub(crate) fn own(&self, key: &FieldKey, start: Cell) -> Option<Arc<GoalField>> {
        self.latest(key)?.own(start)
    }

    /// The same, or else what a field of another planner proves.
    pub(crate) fn at_hand(&self, key: &FieldKey, start: Cell) -> Option<Arc<GoalField>> {
        let entry = self.latest(key)?;
        let related = || entry.related.as_ref().filter(|(towards, _)| *towards == start);
        entry.own(start).or_else(|| related().map(|(_, field)| Arc::clone(field)))
    }

    /// Keeps what a field of another planner proves towards a start.
    pub(crate) fn keep_related(&self, key: FieldKey, start: Cell, field: &Arc<GoalField>) {
        self.keep(key, |entry| entry.related = Some((start, Arc::clone(field))));
    }

    /// The exact field of a goal that is held.
    pub(crate) fn exact(&self, key: &FieldKey) -> Option<Arc<ExactField>> {
        self.latest(key)?.exact.clone()
    }

    pub(crate) fn keep_exact(&self, key: FieldKey, exact: ExactField) {
        self.keep(key, |entry| entry.exact = Some(Arc::new(exact)));
    }

    /// The fields that depend on nothing but tiles which `is_untouched`, for other ground; exact ones cover all of it.
    pub(crate) fn kept_where(&self, is_untouched: impl Fn(Objective, usize) -> bool) -> Self {
        let stays = |entry: &&Entry| {
            let field = entry.field.as_ref();
            field.is_some_and(|field| {
                field.touched_tiles().all(|tile| is_untouched(entry.key.objective, tile))
            })
        };
        let known = self.lock();
        let entries = known.iter().filter(stays).map(|entry| Entry {
            key: entry.key.clone(),
            towards: entry.towards,
            field: entry.field.clone(),
            related: None,
            exact: None,
        });
        FieldCache { entries: Mutex::new(entries.collect()) }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.lock().iter().map(Entry::bytes).sum()
    }

    /// What is known of a goal, which becomes the latest.
    fn latest(&self, key: &FieldKey) -> Option<Entry> {
        let mut entries = self.lock();
        let at = entries.iter().position(|entry| entry.key == *key)?;
        let entry = entries.remove(at);
        let known = Entry {
            key: key.clone(),
            towards: entry.towards,
            field: entry.field.clone(),
            related: entry.related.clone(),
            exact: entry.exact.clone(),
        };
        entries.push(entry);
        Some(known)
    }

    fn keep(&self, key: FieldKey, change: impl FnOnce(&mut Entry)) {
        let mut entries = self.lock();
        let known = entries.iter().position(|entry| entry.key == key).map(|at| entries.remove(at));
        let mut entry =
            known.unwrap_or(Entry { key, towards: None, field: None, related: None, exact: None });
        change(&mut entry);
        entries.push(entry);
        let mut held: usize = entries.iter().map(Entry::bytes).sum();
        while entries.len() > ENTRIES && (held > MOST_BYTES || entries.len() > MOST_ENTRIES) {
            held -= entries.remove(0).bytes();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
