//! What a robot does second by second. What is missing has the same size whatever it does; what models miss has not.

use nalgebra::DVector;

use crate::average::Average;

/// What a robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Regime {
    /// Straight on, at a speed that hardly changes.
    Cruise,
    /// Straight on, gaining or losing speed.
    Gain,
    /// Turning.
    Turn,
}

/// Difference of rim speeds from which a robot turns [m/s], and acceleration from which it gains speed [m/s²]: several times what
/// holding a course and a speed takes.
const TURN_MPS: f64 = 0.05;
const GAIN_MPS2: f64 = 0.05;
/// Most of it: what is strong is not in proportion to its size, and differs between regimes for that.
const MOST: f64 = 5.0;
/// Rows that a regime needs to have a say.
const LEAST_ROWS: usize = 60;

/// Pitch from which a robot climbs or descends [rad].
const SLOPE_RAD: f64 = 0.02;

impl Regime {
    /// How many there are.
    pub(crate) const COUNT: usize = 3;
    /// How many there are where climbs and descents are apart.
    pub(crate) const COUNT_ON_SLOPES: usize = 3 * Regime::COUNT;

    /// Number of what the robot did during an average, climbs and descents apart.
    pub(crate) fn on_slope(average: &Average) -> usize {
        let slope = [average.input.pitch_rad > SLOPE_RAD, average.input.pitch_rad < -SLOPE_RAD];
        let of_slope = slope.iter().position(|is_it| *is_it).map_or(0, |which| which + 1);
        of_slope * Regime::COUNT + Regime::of(average) as usize
    }

    /// What the robot did during an average.
    pub(crate) fn of(average: &Average) -> Self {
        if average.input.difference_mps.abs() > TURN_MPS {
            Regime::Turn
        } else if average.input.accel_mps2.abs() > GAIN_MPS2 {
            Regime::Gain
        } else {
            Regime::Cruise
        }
    }
}

/// How far the size of what is explained scatters from regime to regime: its square over what chance makes of it, as blocks show
/// that; 1 where they agree (Birge, Phys. Rev. 40, 1932). Rows have the numbers of their blocks and regimes.
pub(crate) fn discord(
    (block, blocks): (&[usize], usize),
    (regime, regimes): (&[usize], usize),
    explained: &DVector<f64>,
    left: &DVector<f64>,
) -> f64 {
    let of_regime = |which: usize| {
        let mut scores = vec![0.0; blocks];
        let (mut square, mut count) = (0.0, 0);
        for i in (0..block.len()).filter(|i| regime[*i] == which) {
            scores[block[i]] += explained[i] * left[i];
            square += explained[i] * explained[i];
            count += 1;
        }
        // How far its size is from that of all, times the square, and how far chance would bring it.
        let off: f64 = scores.iter().sum();
        let chance = scores.iter().map(|score| score * score).sum::<f64>().max(square);
        (count >= LEAST_ROWS && square > 0.0).then(|| off * off / chance)
    };
    let told: Vec<f64> = (0..regimes).filter_map(of_regime).collect();
    (told.iter().sum::<f64>() / (told.len() as f64 - 1.0).max(1.0)).clamp(1.0, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two regimes over 40 blocks, in which something is so many times as large as in the mean.
    fn seen(in_turns: f64) -> f64 {
        let block: Vec<usize> = (0..800).map(|i| i / 20).collect();
        let regime: Vec<usize> = (0..800).map(|i| usize::from(i % 20 >= 10)).collect();
        let noise = |i: usize| 3.0_f64.sqrt() * if (i / 2 + i).is_multiple_of(2) { 1.0 } else { -1.0 };
        let explained = DVector::from_element(800, 0.5);
        let left = DVector::from_fn(800, |i, _| {
            let own = if i % 20 < 10 { 2.0 - in_turns } else { in_turns };
            0.5 * (own - 1.0) + noise(i)
        });
        discord((&block, 40), (&regime, 2), &explained, &left)
    }

    #[test]
    fn what_is_as_large_in_every_regime_agrees_and_what_is_not_does_not() {
        assert!(seen(1.0) < 1.5, "{}", seen(1.0));
        assert_eq!(seen(2.0), MOST);
    }
}
