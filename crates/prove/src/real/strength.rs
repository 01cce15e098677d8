//! How strong a change is for a detector that knows the robot, the change and its onset.

use std::iter::once;

use model::Robot;
use recording::Recording;

use crate::{
    Error,
    real::{
        Act,
        force::imitated,
        reading::{METERS, MeterAverages, Reading},
    },
};

/// Noise of the one-second averages of each side's current and of the yaw rate, told by quick differences, so that what a model misses slowly is
/// no part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    meters: [MeterNoise; METERS],
}

/// Noise of one meter: σ² = floor² + (gain · I)², I what is needed; neighbours correlated by ρ.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MeterNoise {
    floor: f64,
    gain: f64,
    correlation: f64,
}

/// Ratio of sigma to the median absolute value of a normal distribution.
const SIGMA_PER_MEDIAN: f64 = 1.4826;
/// Largest correlation of neighbours; what lasts longer is no noise.
const MOST_CORRELATION: f64 = 0.8;
/// The floor is no lower than this share of the noise over all, so that standstill does not decide everything.
const LEAST_FLOOR: f64 = 0.2;
/// Noise of a meter without any: the last digits of a current \[A\] and of a yaw rate \[rad/s\].
const LEAST_NOISE: [f64; METERS] = [0.01, 0.01, 1e-4];

impl Noise {
    /// The noise of recorded drives about what a robot needs.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn of(robot: &Robot, recording: &Recording) -> Result<Self, Error> {
        let reading = Reading::new(robot, recording)?;
        let follows = follows(&reading);
        let meters = reading.averages(robot);
        Ok(Noise { meters: std::array::from_fn(|i| MeterNoise::of(&meters[i], LEAST_NOISE[i], &follows)) })
    }

    /// Strength of an act on drives as a robot itself would have recorded them.
    ///
    /// ```text
    /// z = √ Σ (e_t − ρ e_{t−1})² / (1 − ρ²),   e_t = ΔI_t / σ_t
    /// ```
    ///
    /// over the one-second averages of both sides and of the yaw rate. ΔI is the changed current less the one needed at the changed speeds and
    /// slopes: power of which an ampere counts as what it stands for on average, as the diagnosis takes it. A detector that knows the
    /// change sees it at z standard deviations.
    ///
    /// # Errors
    /// A robot that does not say what an ampere stands for.
    pub fn strength(&self, robot: &Robot, drives: &Recording, act: &Act) -> Result<Strength, Error> {
        let ideal = imitated(robot, drives)?;
        let reading = Reading::new(robot, &act.put_into(robot, &ideal)?)?;
        let (follows, meters) = (follows(&reading), reading.averages(robot));
        let squares =
            self.meters.iter().zip(&meters).map(|(noise, meter)| noise.norm_squared(meter, &follows));
        let recorded_w = Reading::new(robot, drives)?.powers_w(robot);
        let power_change = power_change(&reading.powers_w(robot), &recorded_w);
        Ok(Strength { z: squares.sum::<f64>().sqrt(), power_change })
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

impl MeterNoise {
    fn of(meter: &MeterAverages, least: f64, follows: &[bool]) -> Self {
        let differences = |lag: usize| -> Vec<(f64, f64)> {
            let is_joined = |i: &usize| (i + 1 - lag..=*i).all(|j| follows[j]);
            let from = (lag..follows.len()).filter(is_joined);
            from.map(|i| (meter.needed[i].abs(), (meter.difference[i] - meter.difference[i - lag]).abs()))
                .filter(|(_, difference)| difference.is_finite())
                .collect()
        };
        let quick = differences(1);
        let sigma = |pairs: &[(f64, f64)]| SIGMA_PER_MEDIAN * median(pairs.iter().map(|pair| pair.1));
        let [one, two] = [sigma(&quick), sigma(&differences(2))];
        // Var(1 s) = 2 σ² (1 − ρ), Var(2 s) = 2 σ² (1 − ρ²): their ratio is 1 + ρ.
        let correlation = ((two / one.max(f64::MIN_POSITIVE)).powi(2) - 1.0).clamp(0.0, MOST_CORRELATION);
        let level = |difference: f64| difference / (2.0 * (1.0 - correlation)).sqrt();
        let whole = level(one).max(least);
        let mut by_power = quick;
        by_power.sort_by(|a, b| a.0.total_cmp(&b.0));
        let third = by_power.len() / 3;
        let end = |pairs: &[(f64, f64)]| {
            [median(pairs.iter().map(|pair| pair.0)), level(sigma(pairs))].map(|value| value * value)
        };
        let (low, high) = (end(&by_power[..third]), end(&by_power[by_power.len() - third..]));
        let gain = if high[0] > low[0] { ((high[1] - low[1]) / (high[0] - low[0])).max(0.0) } else { 0.0 };
        if gain == 0.0 {
            return MeterNoise { floor: whole, gain, correlation };
        }
        let floor = (low[1] - gain * low[0]).max((LEAST_FLOOR * whole).powi(2)).sqrt();
        MeterNoise { floor, gain: gain.sqrt(), correlation }
    }

    /// Squared length of a change of power in standard deviations.
    fn norm_squared(&self, meter: &MeterAverages, follows: &[bool]) -> f64 {
        let sigma = |needed: f64| self.floor.hypot(self.gain * needed);
        let scaled =
            meter.difference.iter().zip(&meter.needed).map(|(change, needed)| change / sigma(*needed));
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

/// Root mean square change of the power of both sides where there is any, over the mean of what was recorded without it.
fn power_change(changed_w: &[[f64; 2]], recorded_w: &[[f64; 2]]) -> f64 {
    let changes_w = changed_w.iter().map(|[recorded_w, needed_w]| recorded_w - needed_w);
    let acting: Vec<f64> = changes_w.filter(|change_w| change_w.abs() > 1e-9).collect();
    let square = acting.iter().map(|change_w| change_w * change_w).sum::<f64>() / acting.len().max(1) as f64;
    let sum_w: f64 = recorded_w.iter().map(|[recorded_w, _]| recorded_w).sum();
    square.sqrt() / (sum_w / recorded_w.len().max(1) as f64).max(f64::MIN_POSITIVE)
}

/// The median; 0 of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    crate::rate::median(values).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use recording::Channel;

    use super::*;
    use crate::real::{
        Change, Onset,
        change::tests::{act, robot},
        ground::tests::drives,
    };

    fn noise() -> Noise {
        Noise { meters: [0.5, 0.5, 0.02].map(|floor| MeterNoise { floor, gain: 0.0, correlation: 0.0 }) }
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
    fn a_drag_has_the_strength_of_the_current_that_it_takes() {
        // 15 N are half an ampere at 30 N to the ampere: one standard deviation of a second, for 60 s.
        let drives = drives(&[600], 0.0);
        let found = noise().strength(&robot(), &drives, &act(Change::Drag, 15.0)).unwrap();
        assert!((found.z - 60.0_f64.sqrt()).abs() < 0.01, "{found:?}");
        // Recorded are 4 A, 120 N a side at 0.5 m/s: 2 · (0.00195 · 120² + 1.7441 · 0.5 · 120) = 265 W. On the level 27.80 N are needed, and
        // 15 N more take 0.0023 (42.80² − 27.80²) + 1.7158 · 0.5 · 15 = 15.3 W.
        let needed_n = 90.0 * 9.80665 * 0.063 / 2.0;
        let more_w = 0.0023 * ((needed_n + 15.0_f64).powi(2) - needed_n.powi(2)) + 1.7158 * 0.5 * 15.0;
        let recorded_w = 0.0039 * 120.0_f64.powi(2) + (1.7158 + 1.7723) * 0.5 * 120.0;
        assert!((found.power_change / (more_w / recorded_w) - 1.0).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn an_act_gets_the_strength_that_is_asked_for_or_its_largest_size() {
        let drives = drives(&[1200], 0.02);
        for change in [Change::Payload, Change::Gain, Change::Tow] {
            let (sized, found) = noise().sized(&robot(), &drives, act(change, 0.0), 16.0).unwrap();
            assert!((found.z / 16.0 - 1.0).abs() < 0.03, "{change:?}: {found:?}");
            assert!(sized.size < change.most(&robot()));
        }
        let (sized, found) = noise().sized(&robot(), &drives, act(Change::Payload, 0.0), 1e6).unwrap();
        assert!(sized.size == robot().mass_kg && found.z < 1e6, "{found:?}");
    }

    #[test]
    fn wheels_that_are_off_show_in_how_they_turn_the_robot_and_in_no_power_of_currents() {
        let straight = drives(&[600], 0.0);
        let strength =
            |drives: &Recording| noise().strength(&robot(), drives, &act(Change::WheelScale, 0.05)).unwrap();
        assert!(strength(&straight).z < 1e-6);
        // Half a turn in a minute: 0.1 m/s over a track of 0.54 m, of which a twentieth is 0.0093 rad/s in noise of 0.02.
        let mut turning = straight.clone();
        turning.channels.insert(Channel::RightSpeed, vec![0.6; 600]);
        turning.channels.insert(Channel::YawRate, vec![0.1 / 0.54; 600]);
        let expected = 0.05 * 0.1 / 0.54 / 0.02 * 60.0_f64.sqrt();
        let found = strength(&turning);
        assert!((found.z / expected - 1.0).abs() < 0.02 && found.power_change < 1e-3, "{found:?} {expected}");
    }

    #[test]
    fn noise_is_told_by_differences_whatever_drifts_beneath_it() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let (mut state, mut difference) = (0.0, Vec::new());
        for i in 0..4000 {
            state = 0.5 * state + 0.75_f64.sqrt() * normal();
            difference.push(3.0 * state + 40.0 * (f64::from(i) / 2000.0).sin());
        }
        let meter = MeterAverages { needed: vec![50.0; difference.len()], difference };
        let follows: Vec<bool> = (0..4000).map(|i| i > 0).collect();
        let found = MeterNoise::of(&meter, 0.1, &follows);
        assert!((found.floor / 3.0 - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.correlation - 0.5).abs() < 0.1, "{found:?}");
    }
}
