//! Rubber on the ground: one wheel as a brush of bristles.

/// Longitudinal grip per load, above which a wheel spins.
const GRIP: f64 = 1.0;
/// Slope of the longitudinal force per load and slip where the tyre hardly slips; lugged tyres on firm ground.
const SLIP_STIFFNESS: f64 = 60.0;
/// Lateral stiffness over the file's slip-angle scale: with it the brush rises as fast over small angles as tests of
/// skid-steered robots do on average.
const LATERAL_STIFFNESS: f64 = 1.18;
/// Lateral grip over the file's skid coefficient: what driving force takes from it in a spin is so made up for.
const LATERAL_GRIP: f64 = 1.03;
/// Lengths over which bristles settle while the wheel rolls [m].
const RELAXATION_M: [f64; 2] = [0.15, 0.007];
/// Share of the sliding speed that renews bristles of a wheel that does not roll.
const SCRUBBING: f64 = 0.3;
/// Damping of bristles that hold [N s/m per N of load].
const DAMPING_S_PER_M: f64 = 0.8;

/// The law of one wheel on one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Brush {
    grip: [f64; 2],
    /// Share of full grip per deflection, before it saturates [1/m].
    per_m: [f64; 2],
    relaxation_m: [f64; 2],
}

/// Force of one wheel on the robot and the deflection of its bristles a step later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Along and across the wheel [N].
    pub(crate) force_n: [f64; 2],
    /// Along and across [m].
    pub(crate) deflection_m: [f64; 2],
}

impl Brush {
    /// The law of a surface; `compliance` is slip per force and load that comes on top of the tyre's own.
    pub(crate) fn new(
        mu_skid: f64,
        slip_angle_scale_rad: f64,
        slip_track_ratio: f64,
        compliance: f64,
    ) -> Self {
        /// A Coulomb skid has no slope to speak of; this is steeper than any tyre.
        const STEEPEST_RAD: f64 = 0.03;
        let lateral = LATERAL_STIFFNESS / slip_angle_scale_rad.max(STEEPEST_RAD);
        let stiffness = 1.0 / (1.0 / firm_stiffness(mu_skid, slip_track_ratio) + compliance);
        let relaxation_m = [RELAXATION_M[0], RELAXATION_M[1]];
        Brush {
            grip: [GRIP, LATERAL_GRIP * mu_skid],
            per_m: [stiffness / GRIP / (3.0 * relaxation_m[0]), lateral / (3.0 * relaxation_m[1])],
            relaxation_m,
        }
    }

    /// Advances bristles by a step in which the patch slides.
    ///
    /// ```text
    /// de/dt = s − (|u| + c |s|) e / L,   F = N μ (1 − (1 − ρ)³) σ/ρ,   σ = k e,   ρ = |σ| ≤ 1
    /// ```
    ///
    /// e deflection, s sliding velocity of the tread along and across [m/s], u rim speed, N load. The force is that of a
    /// brush with parabolic pressure (Pacejka, Tire and Vehicle Dynamics, ch. 3); rolling and scrubbing renew it.
    #[inline]
    pub(crate) fn advance(
        &self,
        load_n: f64,
        before_m: [f64; 2],
        slide_mps: [f64; 2],
        rim_mps: f64,
        step_s: f64,
    ) -> Contact {
        let renewal =
            rim_mps.abs() + SCRUBBING * (slide_mps[0] * slide_mps[0] + slide_mps[1] * slide_mps[1]).sqrt();
        let next = |i: usize| {
            (before_m[i] + step_s * slide_mps[i]) / (1.0 + step_s * renewal / self.relaxation_m[i])
        };
        let deflection_m = [next(0), next(1)];
        let strain = [self.per_m[0] * deflection_m[0], self.per_m[1] * deflection_m[1]];
        let rho = (strain[0] * strain[0] + strain[1] * strain[1]).sqrt();
        let hold = (1.0 - rho).max(0.0);
        // (1 − (1 − ρ)³)/ρ tends to 3.
        let gain = if rho > 1e-9 { (1.0 - hold * hold * hold) / rho } else { 3.0 };
        let force = |i: usize| {
            let rate_mps = (deflection_m[i] - before_m[i]) / step_s;
            load_n * (self.grip[i] * gain * strain[i] + DAMPING_S_PER_M * hold * rate_mps)
        };
        Contact { force_n: [force(0), force(1)], deflection_m }
    }
}

/// Stiffness that makes a spin turn as the file's slip track says, where that is wider than the track.
fn firm_stiffness(mu_skid: f64, slip_track_ratio: f64) -> f64 {
    let slip = 1.0 - 1.0 / slip_track_ratio;
    // In a spin every wheel drives with about the skid coefficient per load.
    if slip > 0.0 { (mu_skid / slip).min(SLIP_STIFFNESS) } else { SLIP_STIFFNESS }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Force per load of a wheel that has rolled far at a slip angle.
    fn steady(slip_angle_rad: f64) -> f64 {
        let brush = Brush::new(0.29, 0.30, 1.0, 0.0);
        let mut contact = Contact { force_n: [0.0; 2], deflection_m: [0.0; 2] };
        for _ in 0..20_000 {
            let slide = [0.0, slip_angle_rad.sin() * 0.5];
            contact = brush.advance(200.0, contact.deflection_m, slide, slip_angle_rad.cos() * 0.5, 1e-3);
        }
        contact.force_n[1] / 200.0
    }

    #[test]
    fn lateral_force_rises_like_that_of_tests_and_saturates() {
        for angle in [0.05f64, 0.1, 0.2, 0.3, 0.5, 0.8, 1.5] {
            let measured = 0.29 * (angle / 0.30).tanh();
            assert!(
                (steady(angle) - measured).abs() < 0.03 * 0.29 + 0.04 * measured,
                "{angle}: {}",
                steady(angle)
            );
        }
    }

    #[test]
    fn a_wheel_at_rest_holds_against_a_small_push_and_comes_back() {
        let brush = Brush::new(0.29, 0.30, 1.0, 0.0);
        let pushed = brush.advance(200.0, [0.0; 2], [0.001, 0.001], 0.0, 1e-3);
        let later = (0..1000).fold(pushed, |c, _| brush.advance(200.0, c.deflection_m, [0.0; 2], 0.0, 1e-3));
        assert_eq!(later.deflection_m, pushed.deflection_m, "nothing slides, nothing is renewed");
        assert!(later.force_n[1] > 0.0);
    }

    #[test]
    fn the_force_never_exceeds_the_grip() {
        let brush = Brush::new(0.29, 0.30, 1.0, 0.0);
        for (x, y) in [(5.0, 0.0), (0.0, 5.0), (3.0, -4.0)] {
            let mut contact = Contact { force_n: [0.0; 2], deflection_m: [0.0; 2] };
            for _ in 0..2000 {
                contact = brush.advance(100.0, contact.deflection_m, [x, y], 0.0, 1e-3);
            }
            let share = (contact.force_n[0] / 100.0).hypot(contact.force_n[1] / (100.0 * 0.2987));
            assert!((0.9..=1.001).contains(&share), "{share}");
        }
    }

    proptest! {
        #[test]
        fn a_wheel_that_slides_on_and_on_only_loses(
            along in -1.0f64..1.0, across in -1.0f64..1.0, rim in -1.0f64..1.0, compliance in 0.0f64..1.0,
        ) {
            let brush = Brush::new(0.29, 0.30, 1.0, compliance);
            let mut contact = Contact { force_n: [0.0; 2], deflection_m: [0.0; 2] };
            for _ in 0..3000 {
                contact = brush.advance(200.0, contact.deflection_m, [along, across], rim, 1e-3);
            }
            let lost_w = contact.force_n[0] * along + contact.force_n[1] * across;
            prop_assert!(lost_w >= -1e-9, "{}", lost_w);
        }
    }
}
