//! What a robot does second by second. What is missing has the same size whatever it does; what models miss has not.

use nalgebra::DVector;

use crate::series::Average;

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

impl Regime {
    const ALL: [Regime; 3] = [Regime::Cruise, Regime::Gain, Regime::Turn];

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

/// How far the size of what is explained, of rows by block and regime, scatters from regime to regime: its square over what chance
/// makes of it, as blocks show that; 1 where they agree (Birge, Phys. Rev. 40, 1932).
pub(crate) fn discord(
    rows: &(impl Iterator<Item = (usize, Regime)> + Clone),
    explained: &DVector<f64>,
    left: &DVector<f64>,
    blocks: usize,
) -> f64 {
    let of_regime = |regime: Regime| {
        let mut scores = vec![0.0; blocks];
        let (mut square, mut count) = (0.0, 0);
        for (i, (block, _)) in rows.clone().enumerate().filter(|(_, (_, own))| *own == regime) {
            scores[block] += explained[i] * left[i];
            square += explained[i] * explained[i];
            count += 1;
        }
        // How far its size is from that of all, times the square, and how far chance would bring it.
        let off: f64 = scores.iter().sum();
        let chance = scores.iter().map(|score| score * score).sum::<f64>().max(square);
        (count >= LEAST_ROWS && square > 0.0).then(|| off * off / chance)
    };
    let told: Vec<f64> = Regime::ALL.into_iter().filter_map(of_regime).collect();
    (told.iter().sum::<f64>() / (told.len() as f64 - 1.0).max(1.0)).clamp(1.0, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two regimes over 40 blocks, in which something is so many times as large as in the mean.
    fn seen(in_turns: f64) -> f64 {
        let rows = (0..800).map(|i| (i / 20, if i % 20 < 10 { Regime::Cruise } else { Regime::Turn }));
        let noise = |i: usize| 3.0_f64.sqrt() * if (i / 2 + i).is_multiple_of(2) { 1.0 } else { -1.0 };
        let explained = DVector::from_element(800, 0.5);
        let left = DVector::from_fn(800, |i, _| {
            let own = if i % 20 < 10 { 2.0 - in_turns } else { in_turns };
            0.5 * (own - 1.0) + noise(i)
        });
        discord(&rows, &explained, &left, 40)
    }

    #[test]
    fn what_is_as_large_in_every_regime_agrees_and_what_is_not_does_not() {
        assert!(seen(1.0) < 1.5, "{}", seen(1.0));
        assert_eq!(seen(2.0), MOST);
    }
}
