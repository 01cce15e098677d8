//! Planners of one robot on the same ground that drive at other speeds, with other loads or standing power: what one has worked out serves the
//! others.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use terrain::Cell;

use crate::{
    field::{fields::FieldKey, goal_field::GoalField, related::Related},
    grid::{heading::Heading, state::State},
    lattice::objective::Objective,
    patience::Patience,
    question::planner::Planner,
};

/// Planners whose fields may serve another one.
#[derive(Default)]
pub(crate) struct Relatives(Mutex<Vec<Weak<Planner>>>);

impl Relatives {
    fn add(&self, planner: &Arc<Planner>) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|known| known.strong_count() > 0);
        all.push(Arc::downgrade(planner));
    }

    fn all(&self) -> Vec<Arc<Planner>> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter().filter_map(Weak::upgrade).collect()
    }
}

impl Planner {
    /// Lets two planners know of each other. Where one is asked for a path whose bound is 1.05 or more, and the other has a field of the same
    /// goal, it first tries what that proves. It needs the same ground, and robots that differ in mass, standing power and speed alone, as far
    /// as steady driving goes; of others it proves nothing, nor of wheels that hardly turn.
    pub fn relate(self: &Arc<Self>, other: &Arc<Self>) {
        self.relatives().add(other);
        other.relatives().add(self);
    }

    /// What the field of a relative proves that proves most; `None` where there is none, or patience ends first.
    pub(crate) fn related_field(
        &self,
        key: &FieldKey,
        (start, goals): (Cell, &[(State, f64)]),
        objective: Objective,
        patience: &Patience,
    ) -> Option<Arc<GoalField>> {
        let table = self.table(objective);
        let start_state = State { cell: start, heading: Heading::new(0) };
        let others = self.relatives().all();
        let mut best: Option<(u32, Related<'_>, Arc<GoalField>)> = None;
        for other in &others {
            if patience.is_over() {
                return None;
            }
            let known = other.table_at_hand(objective).zip(other.fields().own(key, start));
            let Some((known, field)) = known else { continue };
            let Some(related) = Related::new((known, table), objective, goals) else { continue };
            let proven = related.units(&field, start_state);
            if best.as_ref().is_none_or(|(most, ..)| proven > *most) {
                best = Some((proven, related, field));
            }
        }
        let (_, related, field) = best?;
        related.field(&field, patience).map(Arc::new)
    }
}
