//! Sideways pull: what a side slope leaves of the resistance to turning.

use crate::{Real, skid::Skid};

/// How much of its skid resistance a turning robot feels while its tyres also hold it sideways.
///
/// Tyres that skid sideways against a turn push the front one way and the rear the other. On a side slope all of them together
/// must also push against gravity; the centre of turning moves along the robot until they do, one axle skids more and the
/// other less, and the moment against the turn falls. With the law of skid of this model, σ = tanh(α/α_s), and slip angles
/// that add,
///
/// ```text
/// σ(a + d) + σ(d − a) = 2 ρ,   σ(a + d) + σ(a − d) = 2 m f,   m = σ(a),   |ρ| ≤ 1
/// f = 1 − (√((1 − m²)² + 4 m² ρ²) − (1 − m²)) / 2 m²,   ρ = tan φ / μ_S
/// ```
///
/// m share of the full skid resistance that the turn alone calls up, ρ share that the sideways pull takes, f share that is left
/// of the moment, φ roll. A spin with m → 1, the paper's Coulomb skid, keeps 1 − |ρ|; a wide arc keeps 1 − ρ². In a bend tyres
/// also push inwards with m v ω, which enters with other accelerations ([`crate::Acceleration`]).
///
/// A high centre of mass takes a share ε of the load from the rear to the front axle, on a climb the other way; then the axles hold
///
/// ```text
/// (½ + ε) σ(a + d) + (½ − ε) σ(d − a) = ρ,   (½ + ε) σ(a + d) + (½ − ε) σ(a − d) = m f
/// ```
///
/// in a turn to the right, which is the law above at ρ − 2 ε m f, and at ρ + 2 ε m f in one to the left, but for a moment ρ ε that is
/// there straight on as well and for terms in ε². f stands on both sides, and is found in three steps; a search for the centre agrees to 0.01 of the moment.
///
/// A centre of mass off the middle has such an ε on level ground too (`level_share`), and there the law is exact but for slip angles
/// that add, since weight then pulls where the load lies. What is told of the pull is the share of the moment on level ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidewaysPull<T> {
    /// 1/μ_S: share taken per tan φ [-].
    per_tilt: T,
    /// ±2 m ε f0: share that is taken on level ground, f0 what that leaves [-].
    ahead: T,
    /// ±2 m ε f0: share taken per sin γ sin β and f/f0 where a climb shifts load between the axles [-].
    per_along: T,
    /// (1 − m²)² [-].
    slack_squared: T,
    /// 4 m² [-].
    called_up: T,
    /// 1/(2 m² f0) [-].
    per_called_up: T,
    /// (1 + (1 − m²)/(2 m²))/f0 [-].
    at_no_root: T,
}

/// f0: share of the skid moment that is left on level ground where the front axle carries ½ + ε of the load.
///
/// ```text
/// f0 = 1 − 2 C/(B + √(B² + 4 A C)),   A = m² (1 − 4 ε²),   B = 1 − m² + 8 m² ε²,   C = 4 m² ε²
/// ```
///
/// It solves the law of [`SidewaysPull`] at ρ = 2 ε m f0: 1 − 4 ε² m² and less for a wide arc, 1/(1 + 2|ε|) for Coulomb's spin. Against a
/// search for the centre of turning, arms come out the same to 1 % for α_s ≤ 0.3 rad and |ε| ≤ 0.2, whatever the arc.
#[inline(always)]
pub(crate) fn level_share(load_forward: f64, mobilized: f64) -> f64 {
    let (shift, called_up) = (4.0 * load_forward * load_forward, mobilized * mobilized);
    let (a, b, c) = (called_up * (1.0 - shift), 1.0 - called_up + 2.0 * called_up * shift, called_up * shift);
    let root = (b * b + 4.0 * a * c).sqrt();
    if c > 0.0 { 1.0 - 2.0 * c / (b + root) } else { 1.0 }
}

/// Least m²: below, f is 1 − ρ² to one part in ten thousand, and the difference of nearly equal numbers would be noise in
/// single precision.
const LEAST_CALLED_UP: f64 = 1e-4;

impl SidewaysPull<f64> {
    /// No pull, whatever the slope.
    pub(crate) const NONE: Self = SidewaysPull {
        per_tilt: 0.0,
        ahead: 0.0,
        per_along: 0.0,
        slack_squared: 1.0,
        called_up: 4.0 * LEAST_CALLED_UP,
        per_called_up: 0.0,
        at_no_root: 1.0,
    };

    /// The pull on a motion that skids so.
    #[inline(always)]
    pub(crate) fn new(mu_skid: f64, skid: &Skid) -> Self {
        let per_tilt = if mu_skid > 0.0 { 1.0 / mu_skid } else { 0.0 };
        let squared = (skid.mobilized * skid.mobilized).max(LEAST_CALLED_UP);
        let (slack, per_called_up) = (1.0 - squared, 0.5 / squared);
        SidewaysPull {
            per_tilt,
            slack_squared: slack * slack,
            called_up: 4.0 * squared,
            per_called_up: per_called_up / skid.level_share,
            at_no_root: (1.0 + slack * per_called_up) / skid.level_share,
            ..SidewaysPull::NONE
        }
    }

    /// The same where the front axle carries so much more than half of the load, on level ground and per sin γ sin β.
    #[inline(always)]
    pub(crate) fn shifted(self, [load_forward, load_forward_per_along]: [f64; 2], skid: &Skid) -> Self {
        let per_load = 2.0 * skid.mobilized * skid.level_share * skid.arm_m.signum();
        SidewaysPull { ahead: per_load * load_forward, per_along: per_load * load_forward_per_along, ..self }
    }

    /// How far along the robot sideways pull moves the centre of turning, over half the wheelbase, where tyres push to the left forwards [-].
    ///
    /// ```text
    /// d/a = atanh t / atanh m,   t = 2 ρ / (1 − m² + √((1 − m²)² + 4 m² ρ²)),   t = σ(d)
    /// ```
    ///
    /// from the first of the two equations above, with slip angles in proportion to the distance from the centre of turning. Against a search
    /// for that centre it comes out the same to a fifth of itself, and where the inner wheels hardly turn to a third.
    pub(crate) fn drift(&self, tilt: f64) -> f64 {
        /// Shares beyond which tyres slide freely, and slip angles have no end.
        const HELD: f64 = 0.99;
        let share = (self.per_tilt * tilt).clamp(-1.0, 1.0);
        let mobilized = self.called_up.sqrt() / 2.0;
        let root = (share * share).mul_add(self.called_up, self.slack_squared).sqrt();
        let drifting = 2.0 * share / (self.slack_squared.sqrt() + root).max(f64::MIN_POSITIVE);
        // atanh x = ln((1 + x)/(1 − x))/2: as exact as a ratio of them has to be, in half of the library's time.
        let twice_atanh = |x: f64| ((1.0 + x) / (1.0 - x)).ln();
        twice_atanh(drifting.clamp(-HELD, HELD)) / twice_atanh(mobilized.min(HELD))
    }

    /// The least and the most that a pull leaves of the skid resistance [-].
    pub(crate) fn range_left(&self) -> [f64; 2] {
        [self.left_beside(1.0), self.left_beside(0.0)]
    }

    /// A tangent below what is left of the skid resistance [-]: its value on level ground and its slope in tan² φ.
    ///
    /// With ρ² for the share that is taken, f = A − B √(4 m² ρ² + (1 − m²)²) is convex in ρ² up to 1 and not negative there. `None` where load
    /// shifts between the axles.
    pub(crate) fn tangent_below(&self) -> Option<[f64; 2]> {
        /// Where it touches, ρ²: between level ground and slopes that leave half.
        const TAKEN: f64 = 0.1;
        let root = TAKEN.mul_add(self.called_up, self.slack_squared).sqrt();
        let slope = -self.per_called_up * self.called_up / (2.0 * root);
        let level = self.at_no_root - self.per_called_up * root - slope * TAKEN;
        let is_unshifted = self.ahead == 0.0 && self.per_along == 0.0;
        is_unshifted.then_some([level, slope * self.per_tilt * self.per_tilt])
    }

    /// The same in single precision.
    pub(crate) fn single(&self) -> SidewaysPull<f32> {
        SidewaysPull {
            per_tilt: self.per_tilt as f32,
            ahead: self.ahead as f32,
            per_along: self.per_along as f32,
            slack_squared: self.slack_squared as f32,
            called_up: self.called_up as f32,
            per_called_up: self.per_called_up as f32,
            at_no_root: self.at_no_root as f32,
        }
    }
}

impl<T: Real> SidewaysPull<T> {
    /// f/f0: share of the skid resistance on level ground that is left where the ground rises so much per metre to the left and the weight
    /// pulls back by so much of itself; 0 to 1 where the load is even, up to 1/f0 where a pull relieves the heavier axle.
    #[inline(always)]
    pub fn left_of_skid(&self, tilt: T, along: T) -> T {
        let share = self.per_tilt * tilt;
        let left = self.left_beside(share + self.ahead);
        // Hardly any robot has it.
        if self.per_along == T::ZERO && self.ahead == T::ZERO {
            left
        } else {
            let shifted = self.per_along.mul_add(along, self.ahead);
            let left = self.left_beside(shifted.mul_add(left, share));
            self.left_beside(shifted.mul_add(left, share))
        }
    }

    /// f/f0 where the sideways pull takes a share ρ.
    #[inline(always)]
    fn left_beside(&self, share: T) -> T {
        let one = T::from_f64(1.0);
        let squared = share * share;
        let taken = if squared < one { squared } else { one };
        let root = taken.mul_add(self.called_up, self.slack_squared).sqrt();
        root.mul_add(-self.per_called_up, self.at_no_root)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;
    use crate::{Robot, builtin, skid};

    /// A turn to the left of a robot whose front axle carries ½ + `load_forward`.
    fn turn(mobilized: f64, load_forward: f64) -> Skid {
        Skid { arm_m: 1.0, mobilized, level_share: level_share(load_forward, mobilized) }
    }

    fn pull(mobilized: f64) -> SidewaysPull<f64> {
        SidewaysPull::new(0.3, &turn(mobilized, 0.0))
    }

    /// Moments against a turn on the spot with and without a sideways force per load, by moving the centre of turning
    /// along the robot until the four tyres hold it, with a share of the load shifted to the front; about a place that the
    /// share also moves (`carried`) or that stays in the middle. Bisection knows nothing of the closed form.
    fn spin_by_search(
        robot: &Robot,
        scale_rad: f64,
        mu_skid: f64,
        [wanted, ahead]: [f64; 2],
        carried: bool,
    ) -> (f64, f64) {
        let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
        let about_m = if carried { ahead * robot.wheelbase_m } else { 0.0 };
        let tyres = |centre_m: f64| {
            let (mut force, mut moment_m) = (0.0, 0.0);
            for (x_m, y_m) in [(half_a, half_b), (half_a, -half_b), (-half_a, half_b), (-half_a, -half_b)] {
                let across = x_m - centre_m;
                let load = (0.5 + ahead * x_m.signum()) / 2.0;
                let skid = mu_skid * load * ((across / y_m.abs()).atan() / scale_rad).tanh();
                force -= skid;
                moment_m += (x_m - about_m) * skid;
            }
            (force, moment_m)
        };
        let held = |wanted: f64| {
            let (mut low, mut high) = (-20.0, 20.0);
            for _ in 0..100 {
                let middle = (low + high) / 2.0;
                if tyres(middle).0 < wanted { low = middle } else { high = middle }
            }
            tyres(low).1
        };
        (held(wanted), held(0.0))
    }

    #[test]
    fn a_spin_with_a_mass_off_the_middle_keeps_on_a_side_slope_what_a_search_keeps() {
        let robot = builtin::husky_a200();
        let (mu_skid, scale_rad) = (0.3, 0.30);
        let mobilized = skid::mobilized_arm_m(&robot, 0.0, 1.0, |a| (a / scale_rad).tanh()) / 0.27;
        for ahead in [0.05, -0.1, 0.15] {
            for tilt in [0.0, 0.02, -0.02, 0.06, -0.06, 0.12, -0.12] {
                let (held_m, level_m) = spin_by_search(&robot, scale_rad, mu_skid, [tilt, ahead], true);
                let turn = turn(mobilized, ahead);
                let share =
                    SidewaysPull::new(mu_skid, &turn).shifted([ahead, 0.0], &turn).left_of_skid(tilt, 0.0);
                let expected = held_m / level_m;
                assert!((share - expected).abs() < 0.03, "{tilt}, {ahead}: {share} for {expected}");
            }
        }
    }

    #[test]
    fn a_spin_on_a_side_slope_keeps_what_a_search_for_its_centre_of_turning_keeps() {
        let robot = builtin::husky_a200();
        let (mu_skid, scale_rad) = (0.3, 0.30);
        let mobilized = skid::mobilized_arm_m(&robot, 0.0, 1.0, |a| (a / scale_rad).tanh()) / 0.27;
        for tilt in [0.0, 0.02, 0.05, 0.1, 0.2, 0.28] {
            let (held_m, free_m) = spin_by_search(&robot, scale_rad, mu_skid, [tilt, 0.0], false);
            let share = pull(mobilized).left_of_skid(tilt, 0.0);
            assert!((share - held_m / free_m).abs() < 0.02, "{tilt}: {share} for {}", held_m / free_m);
        }
    }

    #[test]
    fn a_spin_on_a_climb_that_leans_keeps_with_a_high_mass_what_a_search_keeps() {
        let robot = builtin::husky_a200();
        let (mu_skid, scale_rad) = (0.3, 0.30);
        let mobilized = skid::mobilized_arm_m(&robot, 0.0, 1.0, |a| (a / scale_rad).tanh()) / 0.27;
        for (tilt, ahead) in [(0.0, 0.03), (0.05, 0.03), (0.05, -0.03), (-0.1, 0.02), (0.15, -0.04)] {
            let (held_m, _) = spin_by_search(&robot, scale_rad, mu_skid, [tilt, ahead], false);
            let (_, free_m) = spin_by_search(&robot, scale_rad, mu_skid, [0.0, 0.0], false);
            // What turns it straight on as well, (F_r − F_l) b/2 of `load_transfer`.
            let straight_m = -tilt * ahead * robot.wheelbase_m;
            // To the left; the climb is 1.
            let share = pull(mobilized).shifted([0.0, ahead], &turn(mobilized, 0.0)).left_of_skid(tilt, 1.0);
            let expected = (held_m - straight_m) / free_m;
            assert!((share - expected).abs() < 0.01, "{tilt}, {ahead}: {share} for {expected}");
            // Nearly all that the shift does is described.
            let unshifted = pull(mobilized).left_of_skid(tilt, 1.0);
            let (off, off_without) = ((share - expected).abs(), (unshifted - expected).abs());
            assert!(tilt == 0.0 || off < 0.15 * off_without, "{tilt}, {ahead}: {off} of {off_without}");
        }
    }

    /// How far ahead the centre of turning lies over half the wheelbase, by moving it until the four tyres push to the left by a share of
    /// the load, in a turn to the left of a radius; wheels roll as fast as they would about the middle.
    fn drift_by_search(robot: &Robot, scale_rad: f64, radius_m: f64, wanted: f64) -> f64 {
        let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
        let pushed = |ahead_m: f64| -> f64 {
            let corners = [(half_a, half_b), (half_a, -half_b), (-half_a, half_b), (-half_a, -half_b)];
            let tyre = |(x_m, y_m): (f64, f64)| {
                -(((x_m - ahead_m) / (radius_m - y_m).abs()).atan() / scale_rad).tanh()
            };
            corners.into_iter().map(tyre).sum::<f64>() / 4.0
        };
        let (mut low, mut high) = (0.0, 20.0);
        for _ in 0..100 {
            let middle = (low + high) / 2.0;
            if pushed(middle) < wanted { low = middle } else { high = middle }
        }
        low / half_a
    }

    #[test]
    fn tyres_that_hold_a_robot_on_its_circle_drift_as_far_as_a_search_says() {
        let robot = builtin::husky_a200();
        let (mu_skid, scale_rad) = (0.3, 0.30);
        for (radius_m, close) in [(0.3, 0.33), (0.8, 0.2), (1.5, 0.05), (3.0, 0.03), (8.0, 0.03)] {
            let law = |angle: f64| (angle / scale_rad).tanh();
            let mobilized = skid::mobilized_arm_m(&robot, radius_m, 1.0, law)
                / skid::mobilized_arm_m(&robot, 0.0, 1.0, |_| 1.0);
            for share in [0.05, 0.2, 0.4, 0.6] {
                let drift = pull(mobilized).drift(share * mu_skid);
                assert_relative_eq!(drift, -pull(mobilized).drift(-share * mu_skid), epsilon = 1e-12);
                let searched = drift_by_search(&robot, scale_rad, radius_m, share);
                assert!(
                    (drift / searched - 1.0).abs() < close,
                    "{radius_m} m, {share}: {drift} for {searched}"
                );
            }
        }
        // Coulomb's tyres let it go up to half a wheelbase, and where nothing skids nothing drifts.
        assert!(pull(1.0).drift(0.29) <= 1.0 && SidewaysPull::NONE.drift(0.3) == 0.0);
    }

    #[test]
    fn coulomb_skid_keeps_what_the_pull_does_not_take() {
        assert_relative_eq!(pull(1.0).left_of_skid(0.15, 0.0), 0.5, epsilon = 1e-5);
        // On a steeper slope than it can hold it slides down, and nothing is left.
        assert_relative_eq!(pull(1.0).left_of_skid(-0.4, 0.0), 0.0, epsilon = 1e-5);
        assert_relative_eq!(pull(1e-4).left_of_skid(0.15, 0.0), 0.75, epsilon = 1e-4);
    }

    proptest! {
        #[test]
        fn what_is_left_lies_between_nothing_and_all_and_single_precision_agrees(
            m in 0.0f64..=1.0, tilt in -1.0f64..1.0,
        ) {
            let pull = pull(m);
            let left = pull.left_of_skid(tilt, 0.0);
            prop_assert_eq!(left, pull.left_of_skid(-tilt, 0.0));
            prop_assert!((-1e-12..=1.0 + 1e-12).contains(&left), "{}", left);
            let single = f64::from(pull.single().left_of_skid(tilt as f32, 0.0));
            prop_assert!((left - single).abs() < 2e-3, "{} for {}", single, left);
        }
    }
}
