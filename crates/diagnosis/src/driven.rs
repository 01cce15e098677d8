//! What terms outside the list are made of in each average: what a force or a moment at the rims costs beyond the motors.

use model::Robot;

use crate::average::{Average, Input};

/// Difference of rim speeds over which a moment against turning turns round with the turn, as a share of the highest speed: wheels that
/// hardly turn against each other slide hardly.
const TURNS_ROUND: f64 = 0.05;

/// What terms are made of in each average.
#[derive(Clone, Copy)]
pub(crate) struct Driven<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) averages: &'a [Average],
    /// What the model says \[W\].
    pub(crate) predicted_w: &'a [f64],
    /// What one newton that holds the wheels of the left and of the right side back costs.
    pub(crate) rims_w_per_n: &'a [Vec<f64>; 2],
}

impl Driven<'_> {
    /// What a force on both sides that holds the wheels back costs in one average, for each newton of one side.
    pub(crate) fn held_back_w_per_n(&self, i: usize, is_both: bool) -> f64 {
        let [left, right] = self.rims_w_per_n;
        match self.averages[i].channel {
            // Half of it at each side.
            _ if is_both => (left[i] + right[i]) / 2.0,
            0 => left[i],
            _ => right[i],
        }
    }

    /// What a moment costs that holds back the side that runs ahead and drives on the other, by how much the robot turns at all.
    pub(crate) fn turned_w_per_n(&self, i: usize, is_both: bool) -> f64 {
        let [left, right] = self.rims_w_per_n;
        let average = &self.averages[i];
        let Input { difference_mps, speed_mps, .. } = average.input;
        let turn = (difference_mps / (TURNS_ROUND * self.robot.max_wheel_speed_mps)).tanh();
        let [of_left, of_right] = match average.channel {
            _ if is_both => [speed_mps - difference_mps / 2.0, speed_mps + difference_mps / 2.0],
            _ => [average.input.rim_mps; 2],
        };
        match average.channel {
            _ if is_both => turn * (right[i] * of_right.signum() - left[i] * of_left.signum()),
            0 => -turn * left[i] * of_left.signum(),
            _ => turn * right[i] * of_right.signum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a force and a moment on a robot that turns so much cost by left and right meters and by one for both, where 1 N at a rim
    /// that is driven costs so much, and at one that is dragged along so little, of what it does there.
    fn cost(difference_mps: f64, (driven, dragged): (f64, f64)) -> [[f64; 3]; 2] {
        let robot = model::builtin::husky_a200();
        let rims_mps = [0.5 - 0.5 * difference_mps, 0.5 + 0.5 * difference_mps];
        let ahead = usize::from(difference_mps > 0.0);
        let of_rim = |side: usize| if side == ahead { driven } else { dragged } * rims_mps[side].abs();
        let average = |channel: usize, rim_mps: f64| {
            let input = Input { speed_mps: 0.5, rim_mps, difference_mps, ..Input::default() };
            Average { channel, run: 0, suspect: true, t_s: 0.0, input }
        };
        let sides = [average(0, rims_mps[0]), average(1, rims_mps[1])];
        let whole = [average(0, 0.5)];
        let apart = [vec![of_rim(0), 0.0], vec![0.0, of_rim(1)]];
        let together = [vec![of_rim(0)], vec![of_rim(1)]];
        let predicted_w = &[100.0; 2];
        let apart = Driven { robot: &robot, averages: &sides, predicted_w, rims_w_per_n: &apart };
        let together = Driven { robot: &robot, averages: &whole, predicted_w, rims_w_per_n: &together };
        let of = |one: &dyn Fn(&Driven<'_>, usize, bool) -> f64| {
            [one(&apart, 0, false), one(&apart, 1, false), one(&together, 0, true)]
        };
        [of(&|d, i, both| d.held_back_w_per_n(i, both)), of(&|d, i, both| d.turned_w_per_n(i, both))]
    }

    #[test]
    fn a_moment_takes_of_the_outer_side_what_it_gives_the_inner_one_and_the_difference_of_their_speeds_in_all()
     {
        for difference_mps in [0.4, -0.4] {
            let [_, [left, right, both]] = cost(difference_mps, (1.0, 1.0));
            assert!((left + right - 0.4).abs() < 1e-3, "{left} {right}");
            assert!(left * right < 0.0, "the inner side is driven on: {left} {right}");
            assert!((both - left - right).abs() < 1e-9, "one meter for both shows their sum");
        }
        let [_, straight] = cost(0.0, (1.0, 1.0));
        assert_eq!(straight, [0.0; 3]);
        let [_, [left, right, _]] = cost(1.6, (1.0, 1.0));
        assert!(left > 0.0 && right > 0.0, "turning about a point between them both sides are held back");
    }

    #[test]
    fn a_force_costs_less_at_a_rim_that_is_dragged_along_than_at_one_that_is_driven() {
        let [[left, right, both], _] = cost(0.4, (1.25, 0.5));
        assert!((left - 0.5 * 0.3).abs() < 1e-12 && (right - 1.25 * 0.7).abs() < 1e-12, "{left} {right}");
        assert!((both - (left + right) / 2.0).abs() < 1e-12, "half of it at each side");
        let [_, [left, right, _]] = cost(0.4, (1.25, 0.5));
        assert!((right / left + 1.25 * 0.7 / (0.5 * 0.3)).abs() < 1e-9, "{left} {right}");
    }
}
