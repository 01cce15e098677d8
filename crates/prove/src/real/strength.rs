//! How strong a change is for a detector that knows the robot, the change and its onset.

use std::iter::once;

use model::Robot;
use recording::Recording;

use crate::{
    Error,
    real::{
        Act,
        force::imitated,
        reading::{Reading, SideAverages},
    },
};

/// Noise of the one-second averages of each side's power, told by quick differences, so that what a model misses slowly is no part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    sides: [SideNoise; 2],
}

/// Noise of one side: σ² = floor² + (gain · P)², neighbours correlated by ρ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SideNoise {
    floor_w: f64,
    gain: f64,
    correlation: f64,
}

/// Ratio of sigma to the median absolute value of a normal distribution.
const SIGMA_PER_MEDIAN: f64 = 1.4826;
/// Correlations beyond which differences tell no level.
const MOST_CORRELATION: f64 = 0.9;
/// The floor is no lower than this share of the noise over all, so that standstill does not decide everything.
const LEAST_FLOOR: f64 = 0.2;
/// Noise of a side without any: a current's last digit, 0.01 A, is worth about so much power on a Husky [W].
const LEAST_NOISE_W: f64 = 0.1;

impl Noise {
    /// The noise of recorded drives about what a robot needs.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn of(robot: &Robot, recording: &Recording) -> Result<Self, Error> {
        let reading = Reading::new(robot, recording)?;
        let follows = follows(&reading);
        let sides = reading.averages_w(robot);
        Ok(Noise { sides: sides.each_ref().map(|side| SideNoise::of(side, &follows)) })
    }

    /// Strength of an act on drives as a robot itself would have recorded them.
    ///
    /// ```text
    /// z = √ Σ (e_t − ρ e_{t−1})² / (1 − ρ²),   e_t = ΔP_t / σ_t
    /// ```
    ///
    /// over the one-second averages of both sides. ΔP is the power that the changed currents stand for less the power needed at the
    /// changed speeds and slopes. A detector that knows the change sees it at z standard deviations.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn strength(&self, robot: &Robot, drives: &Recording, act: &Act) -> Result<Strength, Error> {
        let ideal = imitated(robot, drives)?;
        let reading = Reading::new(robot, &act.put_into(robot, &ideal)?)?;
        let (follows, sides) = (follows(&reading), reading.averages_w(robot));
        let squares = self.sides.iter().zip(&sides).map(|(noise, side)| noise.norm_squared(side, &follows));
        Ok(Strength { z: squares.sum::<f64>().sqrt(), power_change: power_change(&sides) })
    }

    /// The act at the size at which it has a strength, or at the largest that it can have; and how strong it is there.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn sized(
        &self,
        robot: &Robot,
        drives: &Recording,
        act: Act,
        z: f64,
    ) -> Result<(Act, Strength), Error> {
        /// Steps of the search; strength is nearly in proportion to size, so that two are enough for most.
        const STEPS: usize = 6;
        /// Close enough to the strength asked for.
        const NEAR: f64 = 0.02;
        /// Part of the largest size that the search begins at.
        const FIRST: f64 = 0.1;
        let most = act.change.most(robot);
        let mut act = Act { size: FIRST * most, ..act };
        let mut found = self.strength(robot, drives, &act)?;
        for _ in 0..STEPS {
            let factor = z / found.z.max(f64::MIN_POSITIVE);
            if (factor - 1.0).abs() < NEAR || factor > 1.0 && act.size >= most {
                break;
            }
            act.size = (act.size * factor).min(most);
            found = self.strength(robot, drives, &act)?;
        }
        Ok((act, found))
    }
}

/// How strong a change is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// In standard deviations of the ideal detector.
    pub z: f64,
    /// Root mean square change of power while it acts, over mean power.
    pub power_change: f64,
}

impl SideNoise {
    fn of(side: &SideAverages, follows: &[bool]) -> Self {
        let differences = |lag: usize| -> Vec<(f64, f64)> {
            let is_joined = |i: &usize| (i + 1 - lag..=*i).all(|j| follows[j]);
            let from = (lag..follows.len()).filter(is_joined);
            from.map(|i| (side.needed_w[i].abs(), (side.difference_w[i] - side.difference_w[i - lag]).abs()))
                .filter(|(_, difference_w)| difference_w.is_finite())
                .collect()
        };
        let quick = differences(1);
        let sigma = |pairs: &[(f64, f64)]| SIGMA_PER_MEDIAN * median(pairs.iter().map(|pair| pair.1));
        let [one_w, two_w] = [sigma(&quick), sigma(&differences(2))];
        // Var(1 s) = 2 σ² (1 − ρ), Var(2 s) = 2 σ² (1 − ρ²): their ratio is 1 + ρ.
        let correlation = ((two_w / one_w.max(f64::MIN_POSITIVE)).powi(2) - 1.0).clamp(0.0, MOST_CORRELATION);
        let level_w = |difference_w: f64| difference_w / (2.0 * (1.0 - correlation)).sqrt();
        let whole_w = level_w(one_w).max(LEAST_NOISE_W);
        let mut by_power = quick;
        by_power.sort_by(|a, b| a.0.total_cmp(&b.0));
        let third = by_power.len() / 3;
        let end = |pairs: &[(f64, f64)]| {
            [median(pairs.iter().map(|pair| pair.0)), level_w(sigma(pairs))].map(|value| value * value)
        };
        let (low, high) = (end(&by_power[..third]), end(&by_power[by_power.len() - third..]));
        let gain = if high[0] > low[0] { ((high[1] - low[1]) / (high[0] - low[0])).max(0.0) } else { 0.0 };
        if gain == 0.0 {
            return SideNoise { floor_w: whole_w, gain, correlation };
        }
        let floor_w = (low[1] - gain * low[0]).max((LEAST_FLOOR * whole_w).powi(2)).sqrt();
        SideNoise { floor_w, gain: gain.sqrt(), correlation }
    }

    /// Squared length of a change of power in standard deviations.
    fn norm_squared(&self, side: &SideAverages, follows: &[bool]) -> f64 {
        let sigma_w = |needed_w: f64| self.floor_w.hypot(self.gain * needed_w);
        let scaled = side
            .difference_w
            .iter()
            .zip(&side.needed_w)
            .map(|(change_w, needed_w)| change_w / sigma_w(*needed_w));
        let scaled: Vec<f64> = scaled.map(|e| if e.is_finite() { e } else { 0.0 }).collect();
        let before = once(0.0).chain(scaled.iter().copied());
        let rho = self.correlation;
        let innovations =
            scaled.iter().zip(before).zip(follows).map(|((now, before), follows)| match follows {
                true => (now - rho * before).powi(2) / (1.0 - rho * rho),
                false => now * now,
            });
        innovations.sum()
    }
}

/// Whether each average follows the one before it by a second in the same run.
fn follows(reading: &Reading) -> Vec<bool> {
    let averages = &reading.drives.averages;
    let of = |i: usize| {
        let before = i.checked_sub(1).map(|before| &averages[before]);
        before.is_some_and(|before| before.run == averages[i].run && averages[i].t_s - before.t_s < 1.5)
    };
    (0..averages.len()).map(of).collect()
}

/// Root mean square change of the power of both sides where there is any, over their mean.
fn power_change(sides: &[SideAverages; 2]) -> f64 {
    let sums = |of: fn(&SideAverages) -> &[f64]| -> Vec<f64> {
        of(&sides[0]).iter().zip(of(&sides[1])).map(|(left, right)| left + right).collect()
    };
    let (changes_w, needed_w) = (sums(|side| &side.difference_w), sums(|side| &side.needed_w));
    let acting: Vec<f64> = changes_w.into_iter().filter(|change_w| change_w.abs() > 1e-9).collect();
    let square = acting.iter().map(|change_w| change_w * change_w).sum::<f64>() / acting.len().max(1) as f64;
    let mean_w = needed_w.iter().map(|w| w.abs()).sum::<f64>() / needed_w.len().max(1) as f64;
    square.sqrt() / mean_w.max(f64::MIN_POSITIVE)
}

/// The median; 0 of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    crate::rate::median(values).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::real::{
        Change, Onset,
        change::tests::{act, robot},
        ground::tests::drives,
    };

    fn noise() -> Noise {
        Noise { sides: [SideNoise { floor_w: 5.0, gain: 0.0, correlation: 0.0 }; 2] }
    }

    #[test]
    fn strength_is_in_proportion_to_size_and_grows_with_the_square_root_of_time() {
        let drives = drives(&[1200], 0.02);
        let z = |change, size| noise().strength(&robot(), &drives, &act(change, size)).unwrap().z;
        for change in [Change::Drag, Change::Payload, Change::PitchBias] {
            let size = 1e-3 * change.most(&robot());
            let ratio = z(change, 2.0 * size) / z(change, size);
            assert!((ratio - 2.0).abs() < 0.02, "{change:?}: {ratio}");
        }
        let late = Act { onset: Onset { run: 0, t_s: 90.0 }, ..act(Change::Drag, 5.0) };
        let ratio = z(Change::Drag, 5.0) / noise().strength(&robot(), &drives, &late).unwrap().z;
        assert!((ratio - 2.0).abs() < 0.02, "120 s over 30 s: {ratio}");
    }

    #[test]
    fn an_idle_drag_has_the_strength_of_the_power_that_it_takes() {
        // Straight on the level, 90 · 9.80665 · 0.063 / 2 = 27.80 N a side; 10 N more at 0.5 m/s:
        // 0.0023 (37.80² − 27.80²) + 1.7158 · 0.5 · 10 = 10.09 W in noise of 5 W, for 60 s.
        let drives = drives(&[600], 0.0);
        let found = noise().strength(&robot(), &drives, &act(Change::Drag, 10.0)).unwrap();
        let force_n = 90.0 * 9.80665 * 0.063 / 2.0;
        let more_w = 0.0023 * ((force_n + 10.0_f64).powi(2) - force_n.powi(2)) + 1.7158 * 0.5 * 10.0;
        assert!((found.z - more_w / 5.0 * 60.0_f64.sqrt()).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn an_act_gets_the_strength_that_is_asked_for_or_its_largest_size() {
        let drives = drives(&[1200], 0.02);
        for change in [Change::Payload, Change::Gain, Change::WheelScale, Change::Tow] {
            let (sized, found) = noise().sized(&robot(), &drives, act(change, 0.0), 16.0).unwrap();
            assert!((found.z / 16.0 - 1.0).abs() < 0.03, "{change:?}: {found:?}");
            assert!(sized.size < change.most(&robot()));
        }
        let (sized, found) = noise().sized(&robot(), &drives, act(Change::Payload, 0.0), 1e6).unwrap();
        assert!(sized.size == robot().mass_kg && found.z < 1e6, "{found:?}");
    }

    #[test]
    fn noise_is_told_by_differences_whatever_drifts_beneath_it() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let (mut level, mut difference_w) = (0.0, Vec::new());
        for i in 0..4000 {
            level = 0.5 * level + 0.75_f64.sqrt() * normal();
            difference_w.push(3.0 * level + 40.0 * (f64::from(i) / 2000.0).sin());
        }
        let side = SideAverages { needed_w: vec![50.0; difference_w.len()], difference_w };
        let follows: Vec<bool> = (0..4000).map(|i| i > 0).collect();
        let found = SideNoise::of(&side, &follows);
        assert!((found.floor_w / 3.0 - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.correlation - 0.5).abs() < 0.1, "{found:?}");
    }
}
