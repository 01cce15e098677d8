//! A lower bound of the power of a steady motion from the grade along it and the largest roll.

use crate::{PowerKernel, Sides};

/// A lower bound of P √(1 + g²), in closed form:
///
/// ```text
/// P √(1 + g²) ≥ max over flows (a + b ν + c g + S) − d |g| + (1 − g²/2)(R ν² + C ν g + D g²) + P₀ (1 + (√2 − 1) g²)
/// S = f (s − t |g| + k f) where s > t |g|, and 0 elsewhere,   f = ν max(l + m ν, 0)
/// ```
///
/// P power drawn from the battery [W], g grade along the way [-], ν any number up to the cosine of roll [-], P₀ standing power [W].
/// The two flows are those of power forwards through both motors and backwards through both.
///
/// With the forces F of each side of [`PowerKernel`] and no force that side slopes add to them but the skid's, f σ N,
///
/// ```text
/// F √(1 + g²) = q ± f σ cos ρ,   q = ρ_i cos ρ + G_i g,   P_i √(1 + g²) ≥ k1 q² / √(1 + g²) + t q
/// ```
///
/// for each flow t of the side, without skid. 1/√(1 + g²) is at least 1 − g²/2, and √(1 + g²) at least 1 + (√2 − 1) g² up to 45°. What the skid
/// adds to both sides is a parabola in it (s, t, k). Where it rises, so much of the skid counts as the largest roll leaves (l, m). Where it
/// need not, what it may take off is convex in g and ν, and a chord from level ground to the steepest lies above (`a`, `d`). Where a steep descent brakes with the windings, less roll may take less power;
/// a tangent bounds by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerBound {
    /// By flow: a, b, c [W].
    pub flows_w: [[f64; 3]; 2],
    /// l, m: share of the skid that is left on the largest roll [-].
    pub skid_left: [f64; 2],
    /// By flow: s, t, what all of the skid takes beside its square [W].
    pub skid_w: [[f64; 2]; 2],
    /// k, what the square of all of it takes [W].
    pub skid_dissipated_w: f64,
    /// d [W].
    pub per_steepness_w: f64,
    /// R, C, D: what the windings take [W].
    pub dissipated_w: [f64; 3],
    /// P₀ [W].
    pub standing_w: f64,
}

/// Chord of √(1 + g²) over g² up to 45° [-].
pub const LENGTH_PER_SQUARED_GRADE: f64 = std::f64::consts::SQRT_2 - 1.0;

impl PowerBound {
    /// The bound at a grade along the way and a lower bound of the cosine of roll [W].
    pub fn at_w(&self, grade: f64, cos_roll: f64) -> f64 {
        let left = cos_roll * (self.skid_left[0] + self.skid_left[1] * cos_roll).max(0.0);
        let flow_w = [0, 1].map(|flow| {
            let ([level_w, per_cos_roll_w, per_grade_w], [skid_w, less_w]) =
                (self.flows_w[flow], self.skid_w[flow]);
            let per_left_w = skid_w - less_w * grade.abs();
            let skid_w =
                if per_left_w > 0.0 { left * (per_left_w + left * self.skid_dissipated_w) } else { 0.0 };
            level_w + per_cos_roll_w * cos_roll + per_grade_w * grade + skid_w
        });
        let [square, both, grades] = self.dissipated_w;
        let squared = grade * grade;
        let dissipated_w = square * cos_roll * cos_roll + both * cos_roll * grade + grades * squared;
        flow_w[0].max(flow_w[1]) - self.per_steepness_w * grade.abs()
            + (1.0 - squared / 2.0) * dissipated_w
            + self.standing_w * (1.0 + LENGTH_PER_SQUARED_GRADE * squared)
    }
}

/// Less than any force that counts: what rounding makes of the rolling resistance of a wheel that stands still [N].
const NO_FORCE_N: f64 = 1e-9;

/// What rounding makes of no skid resistance that is left, as a share of it [-].
const NO_SHARE: f64 = 1e-9;

/// A kernel seen along the way that it is driven.
struct Ahead {
    rolling_n: Sides<f64>,
    lifting_n: Sides<f64>,
    k1_w_per_n2: Sides<f64>,
    /// Power per force of each side, by flow.
    flows_mps: [Sides<f64>; 2],
    /// Skid of the right side, by its sign and its largest size.
    skid_sign: f64,
    most_skid_n: f64,
}

impl PowerKernel<f64> {
    /// The bound on slopes up to a grade along the way and down to a cosine of roll; backwards, the grade is that along the way, not the
    /// robot's.
    ///
    /// `None` for motions that it does not hold for: with forces beside rolling, skid and weight, on grades beyond 45°, or where
    /// power is not convex in the grade, which a bound of several steps together needs:
    ///
    /// ```text
    /// 2 − μ² − 6 μ |g| − (1 − 2 μ²) g² ≥ 0,   μ = ρ_i / G_i
    /// ```
    pub fn lower_bound(&self, backwards: bool, steepest: f64, least_cos_roll: f64) -> Option<PowerBound> {
        let is_plain = self.added_n == Sides::both(0.0)
            && self.shifting_n == Sides::both(0.0)
            && self.steepening == 0.0
            && self.leaning_n == 0.0
            && self.standing_w >= 0.0
            && (0.0..=1.0).contains(&steepest)
            && (0.0..=1.0).contains(&least_cos_roll);
        let ahead = Ahead::of(self, backwards).filter(|ahead| is_plain && ahead.is_convex(steepest))?;
        let Ahead { rolling_n, lifting_n, k1_w_per_n2: k1, flows_mps, .. } = &ahead;
        let longest = (1.0 + steepest * steepest).sqrt();
        // How much less power falls with less roll where it falls at all.
        let steepest_n =
            rolling_n.zip(*lifting_n).map(|(rolling, lifting)| least_cos_roll * rolling - lifting * steepest);
        let falling_w = rolling_n
            .zip(flows_mps[1])
            .zip(steepest_n.zip(*k1))
            .map(|((rolling, flow_mps), (force_n, k1))| rolling * (-flow_mps - 2.0 * k1 * force_n).max(0.0));
        let falling_w = falling_w.sum();
        let mut per_steepness_w = 0.0f64;
        let flows_w = flows_mps.map(|flow_mps| {
            let level_w = ahead.taken_off_w(flow_mps, [0.0, 0.0], least_cos_roll) * longest;
            let steep_w = ahead.taken_off_w(flow_mps, [-steepest, steepest], least_cos_roll) * longest;
            if steepest > 0.0 {
                per_steepness_w = per_steepness_w.max((steep_w - level_w) / steepest);
            }
            let of = |n: &Sides<f64>| flow_mps.zip(*n).map(|(flow_mps, n)| flow_mps * n).sum();
            [-level_w - falling_w, of(rolling_n) + falling_w, of(lifting_n)]
        });
        let skid_w = flows_mps.map(|flow_mps| {
            let skid_n = self.skid_n.abs();
            let level_mps = ahead.least_per_skid_mps(flow_mps, [0.0, 0.0], least_cos_roll);
            let steep_mps = ahead.least_per_skid_mps(flow_mps, [-steepest, steepest], least_cos_roll);
            let less_mps = if steepest > 0.0 { (level_mps - steep_mps).max(0.0) / steepest } else { 0.0 };
            [skid_n * level_mps, skid_n * less_mps]
        });
        let square = |a: &Sides<f64>, b: &Sides<f64>| k1.zip(a.zip(*b)).map(|(k1, (a, b))| k1 * a * b).sum();
        Some(PowerBound {
            flows_w,
            skid_left: self.skid_left(least_cos_roll),
            skid_w,
            skid_dissipated_w: k1.sum() * self.skid_n * self.skid_n / longest,
            per_steepness_w,
            dissipated_w: [
                square(rolling_n, rolling_n),
                2.0 * square(rolling_n, lifting_n),
                square(lifting_n, lifting_n),
            ],
            standing_w: self.standing_w,
        })
    }

    /// l and m: with the tangent below what is left of the skid in tan² φ = 1/cos² ρ − 1, and a chord of that over the cosines allowed.
    fn skid_left(&self, least_cos_roll: f64) -> [f64; 2] {
        let Some([level, per_squared]) = self.pull.tangent_below() else { return [0.0, 0.0] };
        if least_cos_roll == 1.0 {
            return [level, 0.0];
        }
        // (1/c² − 1)/(1 − c) = (1 + c)/c²
        let chord = (1.0 + least_cos_roll) / (least_cos_roll * least_cos_roll);
        let per_cos_roll = -per_squared * chord;
        if per_cos_roll.is_finite() { [level - per_cos_roll, per_cos_roll] } else { [0.0, 0.0] }
    }
}

impl Ahead {
    /// `None` where a side does not resist, does not lift, or draws less for more force.
    fn of(kernel: &PowerKernel<f64>, backwards: bool) -> Option<Self> {
        let way = if backwards { -1.0 } else { 1.0 };
        let along = |sides: Sides<f64>| sides.map(|x| way * x);
        let flows_mps = match backwards {
            false => [kernel.forwards_mps, kernel.backwards_mps],
            true => [along(kernel.backwards_mps), along(kernel.forwards_mps)],
        };
        let rolling_n = along(kernel.rolling_n);
        let (lifting_n, k1_w_per_n2) = (kernel.lifting_n, kernel.k1_w_per_n2);
        let [least, most] = kernel.pull.range_left();
        let each = |sides: Sides<f64>, holds: fn(f64) -> bool| holds(sides.left) && holds(sides.right);
        let is_usual = each(rolling_n, |n| n >= -NO_FORCE_N)
            && each(lifting_n, |n| n > 0.0)
            && each(k1_w_per_n2, |k1| k1 >= 0.0)
            && each(flows_mps[0].zip(flows_mps[1]).map(|(high, low)| high - low), |more| more >= 0.0)
            && least > -NO_SHARE;
        let (skid_sign, most_skid_n) = ((way * kernel.skid_n).signum(), kernel.skid_n.abs() * most);
        is_usual.then_some(Ahead { rolling_n, lifting_n, k1_w_per_n2, flows_mps, skid_sign, most_skid_n })
    }

    fn is_convex(&self, steepest: f64) -> bool {
        let is_convex = |friction: f64| {
            let squared = friction * friction;
            let most = steepest * steepest * (1.0 - 2.0 * squared).max(0.0);
            2.0 - squared - 6.0 * friction * steepest - most >= 0.0
        };
        let friction = self.rolling_n.zip(self.lifting_n).map(|(rolling, lifting)| rolling / lifting);
        is_convex(friction.left) && is_convex(friction.right)
    }

    /// The most that any skid takes off the power of both sides on grades and rolls at the ends of their ranges [W].
    ///
    /// It is the greatest of linear functions of the force, hence convex: nowhere between is it more than a chord.
    fn taken_off_w(&self, flow_mps: Sides<f64>, grades: [f64; 2], least_cos_roll: f64) -> f64 {
        let k1 = self.k1_w_per_n2.sum();
        let of = |per_n: f64| {
            let best_n = if k1 > 0.0 { -per_n / (2.0 * k1) } else { f64::INFINITY };
            let skid_n = best_n.min(self.most_skid_n);
            if per_n < 0.0 { -skid_n * (k1 * skid_n + per_n) } else { 0.0 }
        };
        self.per_skid_mps(flow_mps, grades, least_cos_roll).map(of).fold(0.0, f64::max)
    }

    /// The least power of both sides per force of a small skid at the same ends [W/N]. It is linear in the force.
    fn least_per_skid_mps(&self, flow_mps: Sides<f64>, grades: [f64; 2], least_cos_roll: f64) -> f64 {
        self.per_skid_mps(flow_mps, grades, least_cos_roll).fold(f64::INFINITY, f64::min)
    }

    /// Power of both sides per force of a small skid at the ends of the ranges of grade, roll and pitch [W/N].
    fn per_skid_mps(
        &self,
        flow_mps: Sides<f64>,
        grades: [f64; 2],
        least_cos_roll: f64,
    ) -> impl Iterator<Item = f64> + '_ {
        let steepest = grades[1].abs();
        let shortest = 1.0 / (1.0 + steepest * steepest).sqrt();
        let ends = grades.into_iter().flat_map(move |grade| {
            [least_cos_roll, 1.0]
                .into_iter()
                .flat_map(move |cos_roll| [shortest, 1.0].map(move |cos_pitch| (grade, cos_roll, cos_pitch)))
        });
        ends.map(move |(grade, cos_roll, cos_pitch)| {
            let normal_n = self.rolling_n.zip(self.lifting_n);
            let force_n =
                normal_n.map(|(rolling, lifting)| cos_pitch * (cos_roll * rolling + lifting * grade));
            let marginal_mps = flow_mps
                .zip(self.k1_w_per_n2.zip(force_n))
                .map(|(flow, (k1, force))| flow + 2.0 * k1 * force);
            self.skid_sign * (marginal_mps.right - marginal_mps.left)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Grade, Manoeuvre, Motion, PowerModel, builtin};

    proptest! {
        #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

        #[test]
        fn no_slope_takes_less_than_the_bound(
            which in 0usize..64, speed in 0.05f64..=1.0, curvature in -2.0f64..2.0, backwards in any::<bool>(),
            regeneration in 0.0f64..=1.0, mu_roll in 0.0f64..0.3, mu_skid in 0.05f64..1.2, hotel_w in 0.0f64..200.0,
            k1 in [0.0f64..3.0, 0.0f64..3.0], limits in [0.05f64..1.0, 0.05f64..1.0],
            grade in -1.0f64..=1.0, side_grade in -1.0f64..=1.0, less in 0.0f64..=1.0,
        ) {
            let all = builtin::all();
            let mut robot = all[which % all.len()].clone();
            robot.motors.regeneration = regeneration;
            robot.motors.left.k1_w_per_n2 *= k1[0];
            robot.motors.right.k1_w_per_n2 *= k1[1];
            robot.hotel_power_w = hotel_w;
            let mut surface = robot.surfaces.values().next().cloned().unwrap();
            (surface.mu_roll, surface.mu_skid) = (mu_roll, mu_skid);
            let way = if backwards { -1.0 } else { 1.0 };
            let speed_mps = way * speed * robot.max_wheel_speed_mps;
            let motion = Motion::of_body(&robot, speed_mps, speed_mps * curvature / robot.slip_track_m);
            let manoeuvre =
                Manoeuvre::new(PowerModel::ForceBalance, &robot, &surface, motion, Sides::both(20.0));
            let kernel = manoeuvre.kernel();
            let [steepest, most_roll] = limits;
            let least_cos_roll = 1.0 / (1.0 + most_roll * most_roll).sqrt();
            let bound = kernel.lower_bound(backwards, steepest, least_cos_roll);
            prop_assert!(bound.is_some() || mu_roll > 0.1);
            let Some(bound) = bound else { return Ok(()) };
            let (grade, side_grade) = (grade * steepest, side_grade * most_roll);
            let [cos_pitch, cos_roll] = [grade, side_grade].map(|grade| 1.0 / (1.0 + grade * grade).sqrt());
            let ground = Grade {
                normal: cos_pitch * cos_roll,
                along: way * grade * cos_pitch,
                tilt: way * side_grade,
            };
            let taken_w = kernel.bus_w(kernel.side_w(kernel.forces_n(ground)), ground.along) / cos_pitch;
            let known_cos_roll = least_cos_roll + less * (cos_roll - least_cos_roll);
            let bound_w = bound.at_w(grade, known_cos_roll);
            prop_assert!(bound_w <= taken_w + 1e-9 * (taken_w.abs() + 1000.0), "{bound_w} W above {taken_w} W");
        }
    }

    #[test]
    fn a_wide_turn_on_a_gentle_slope_keeps_nearly_all_of_its_skid() {
        let robot = builtin::husky_a200();
        let motion = Motion::of_body(&robot, 0.5, 0.2);
        let marble = &robot.surfaces["marble"];
        let manoeuvre = Manoeuvre::new(PowerModel::ForceBalance, &robot, marble, motion, Sides::both(20.0));
        let kernel = manoeuvre.kernel();
        let cos_roll = 1.0 / (1.0 + 0.05f64 * 0.05).sqrt();
        let ground = Grade { normal: cos_roll, along: 0.0, tilt: 0.05 };
        let taken_w = kernel.bus_w(kernel.side_w(kernel.forces_n(ground)), 0.0);
        let bound_w = kernel.lower_bound(false, 0.5, 0.9).unwrap().at_w(0.0, cos_roll);
        let free = PowerKernel { skid_n: 0.0, ..*kernel };
        let without_w = free.bus_w(free.side_w(free.forces_n(ground)), 0.0);
        assert!(bound_w > without_w + 0.5 * (taken_w - without_w), "{without_w}, {bound_w}, {taken_w} W");
    }

    #[test]
    fn on_level_ground_straight_on_nothing_is_given_away() {
        let robot = builtin::husky_a200();
        let manoeuvre = Manoeuvre::new(
            PowerModel::ForceBalance,
            &robot,
            &robot.surfaces["marble"],
            Motion::of_body(&robot, 1.0, 0.0),
            Sides::both(20.0),
        );
        let kernel = manoeuvre.kernel();
        let level = Grade { normal: 1.0, along: 0.0, tilt: 0.0 };
        let taken_w = kernel.bus_w(kernel.side_w(kernel.forces_n(level)), 0.0);
        let bound_w = kernel.lower_bound(false, 0.5, 0.9).unwrap().at_w(0.0, 1.0);
        approx::assert_relative_eq!(bound_w, taken_w, max_relative = 1e-12);
    }
}
