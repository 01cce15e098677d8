//! Lower bounds of power on every slope up to a steepness: what a search may assume of ground that it has not looked at.

use crate::{Grade, PowerKernel, Sides};

/// A line in the grade below which the power of a motion does not fall.
///
/// On every slope with |g| ≤ steepest and |s| ≤ steepest,
///
/// ```text
/// P √(1 + g²) ≥ level_w + per_grade_w · g
/// ```
///
/// P power drawn from the battery [W], g grade along the heading [-], s grade across it [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportingLine {
    /// Its value on level ground [W].
    pub level_w: f64,
    /// Its slope [W].
    pub per_grade_w: f64,
}

impl PowerKernel<f64> {
    /// Power that each side draws for one newton more, on ground that rises along the heading only [W/N].
    pub fn marginal_w_per_n(&self, grade: f64) -> Sides<f64> {
        let normal = 1.0 / (1.0 + grade * grade).sqrt();
        let force_n = self.forces_n(Grade { normal, along: grade * normal, tilt: 0.0 });
        let ways = self.forwards_mps.zip(self.backwards_mps);
        force_n.zip(self.k1_w_per_n2).zip(ways).map(|((force, k1), (forwards, backwards))| {
            2.0 * k1 * force + if force >= 0.0 { forwards } else { backwards }
        })
    }

    /// The slope of a supporting line with given marginal powers [W].
    pub fn supported_w_per_grade(&self, marginal_w_per_n: Sides<f64>) -> f64 {
        let per_side = marginal_w_per_n.zip(self.lifting_n).map(|(t, lifting)| t * lifting);
        per_side.sum()
    }

    /// The supporting line with given marginal powers t; `None` where a side's power falls without end below its tangent.
    ///
    /// The power of a side is a parabola of its force with a kink at 0, so that for any t
    ///
    /// ```text
    /// k1 F² + w F ≥ t F − K      K = max over F ≥ 0 and F < 0 of t F − (k1 F² + w F)
    /// ```
    ///
    /// w forwards or backwards. The forces are those of [`PowerKernel`]; each of their terms, times t and √(1 + g²), is replaced by
    /// the least that it comes to within the range of slopes, and the term in g alone is kept. The floor of the bus only adds.
    pub fn supporting_line(&self, marginal_w_per_n: Sides<f64>, steepest: f64) -> Option<SupportingLine> {
        let t = marginal_w_per_n;
        let ways = self.forwards_mps.zip(self.backwards_mps);
        let offsets_w = t.zip(self.k1_w_per_n2).zip(ways).map(|((t, k1), (forwards, backwards))| {
            let beyond = (t - forwards).max(0.0).max(backwards - t);
            if beyond == 0.0 { 0.0 } else { beyond * beyond / (4.0 * k1) }
        });
        let offset_w = offsets_w.sum();
        if !offset_w.is_finite() {
            return None;
        }
        // Cosine and length of the steepest pitch or roll, and sine of the steepest slope.
        let length = (1.0 + steepest * steepest).sqrt();
        let cos = 1.0 / length;
        let sin = (1.0 - cos.powi(4)).max(0.0).sqrt();
        let least = |coefficient: f64, [low, high]: [f64; 2]| (coefficient * low).min(coefficient * high);
        let weighed = |force_n: Sides<f64>| t.zip(force_n).map(|(t, f)| t * f).sum();
        let (rolling_w, turned) = (weighed(self.rolling_n), t.right - t.left);
        let [left, most] = self.pull.range_left(steepest);
        let level_w = least(rolling_w, [cos, 1.0]) + least(rolling_w * self.steepening, [0.0, sin])
            - weighed(self.shifting_n).abs() * steepest
            + least(self.skid_n * turned, [left.min(cos * left), most])
            - (self.leaning_n * turned).abs() * steepest * steepest
            + least(weighed(self.added_n) - offset_w + self.standing_w, [1.0, length]);
        Some(SupportingLine { level_w, per_grade_w: self.supported_w_per_grade(t) })
    }
}
