//! What was worked out of the last things that were asked about: friction shapes by row are the same for most robots that are tried.

use std::sync::{Arc, Mutex, PoisonError};

use model::{FrictionShape, Robot};

/// Friction shapes by row of the last robots.
pub(crate) type Shapes = Kept<Key, Vec<FrictionShape>>;

/// Everything that shapes of recorded wheel speeds depend on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    geometry: [f64; 7],
    /// Slip-angle scales of the surfaces.
    pub(crate) scales_rad: Vec<f64>,
}

impl Key {
    /// That of a robot on surfaces of given slip-angle scales.
    pub(crate) fn of(robot: &Robot, scales_rad: Vec<f64>) -> Self {
        let (forward_m, left_m) = (robot.center_of_mass.forward_m, robot.center_of_mass.left_m);
        let [slip, turning] = [robot.wheel_slip(), robot.turning_slip()];
        let geometry =
            [robot.wheelbase_m, robot.track_m, robot.slip_track_m, forward_m, left_m, slip, turning];
        Key { geometry, scales_rad }
    }
}

/// Answers that are kept: those about the robot at hand and what is tried beside it.
const MOST: usize = 4;

/// The last answers, with what they are about.
pub(crate) struct Kept<K, V> {
    answers: Mutex<Vec<(K, Arc<V>)>>,
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Kept { answers: Mutex::new(Vec::new()) }
    }
}

impl<K: PartialEq, V> Kept<K, V> {
    /// The answer about something; worked out where it is not kept.
    ///
    /// # Errors
    /// That of working it out.
    pub(crate) fn of<E>(&self, about: K, work_out: impl FnOnce(&K) -> Result<V, E>) -> Result<Arc<V>, E> {
        let find = || {
            let mut answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
            let place = answers.iter().position(|(other, _)| *other == about)?;
            answers[..=place].rotate_right(1);
            Some(Arc::clone(&answers[0].1))
        };
        if let Some(known) = find() {
            return Ok(known);
        }
        // Not under the lock: a thread that waits for others may take up work that asks for the same.
        let answer = Arc::new(work_out(&about)?);
        let mut answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        answers.insert(0, (about, Arc::clone(&answer)));
        answers.truncate(MOST);
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_last_is_not_worked_out_again_and_what_failed_is() {
        let kept: Kept<u32, u32> = Kept::default();
        let ask = |about: u32| {
            let mut is_new = false;
            let answer = kept.of(about, |about| {
                is_new = true;
                if *about == 99 { Err("no") } else { Ok(10 * about) }
            });
            (answer.map(|answer| *answer), is_new)
        };
        assert_eq!([ask(1), ask(1)], [(Ok(10), true), (Ok(10), false)]);
        assert_eq!([ask(99), ask(99)], [(Err("no"), true); 2]);
        (2..5).for_each(|about| assert!(ask(about).1));
        assert!(!ask(1).1, "asked a moment ago");
        (5..8).for_each(|about| assert!(ask(about).1));
        assert!(ask(2).1, "four others since");
    }
}
