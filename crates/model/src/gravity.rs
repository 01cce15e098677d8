//! Weight on a slope.

use crate::elementary::sin_cos;

/// Standard acceleration of free fall [m/s²] (CGPM 1901).
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

/// How the robot stands: pitch positive nose-up, roll positive left side up [rad].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Positive when climbing.
    pub pitch_rad: f64,
    /// Positive when the left side is up.
    pub roll_rad: f64,
}

/// How the ground carries the weight of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade<T> {
    /// cos γ of eq. 5: share of the weight that presses on the ground.
    pub normal: T,
    /// sin γ sin β of eq. 4: share of the weight that pulls back along the heading.
    pub along: T,
    /// Rise per metre towards the left side, tan(roll): what pulls to the right over what presses on the ground.
    pub tilt: T,
}

impl Grade<f64> {
    /// Level ground.
    pub const LEVEL: Grade<f64> = Grade { normal: 1.0, along: 0.0, tilt: 0.0 };
}

impl Attitude {
    /// Level ground.
    pub const LEVEL: Attitude = Attitude { pitch_rad: 0.0, roll_rad: 0.0 };

    /// sin γ sin β of eq. 4: the share of the weight that pulls back along the heading.
    pub fn weight_along(self) -> f64 {
        self.pitch_rad.sin()
    }

    /// cos γ of eq. 5: the share of the weight that presses on the ground.
    pub fn weight_normal(self) -> f64 {
        self.pitch_rad.cos() * self.roll_rad.cos()
    }

    /// How the ground carries the weight.
    #[inline(always)]
    pub fn grade(self) -> Grade<f64> {
        let ((along, cos_pitch), (sin_roll, cos_roll)) = (sin_cos(self.pitch_rad), sin_cos(self.roll_rad));
        Grade { normal: cos_pitch * cos_roll, along, tilt: sin_roll / cos_roll }
    }

    /// The attitude on a plane of inclination γ, heading at angle β from the contour line (Fig. 1).
    ///
    /// ```text
    /// sin(pitch) = sin γ sin β,   cos γ = cos(pitch) cos(roll)
    /// ```
    pub fn on_plane(inclination_rad: f64, heading_from_contour_rad: f64) -> Self {
        let pitch_rad = (inclination_rad.sin() * heading_from_contour_rad.sin()).asin();
        let roll_rad = (inclination_rad.cos() / pitch_rad.cos()).min(1.0).acos();
        Attitude { pitch_rad, roll_rad }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn a_plane_splits_the_weight_as_eqs_4_and_5_say() {
        let (gamma, beta) = (0.3f64, 0.7f64);
        let attitude = Attitude::on_plane(gamma, beta);
        assert_relative_eq!(attitude.weight_along(), gamma.sin() * beta.sin(), epsilon = 1e-12);
        assert_relative_eq!(attitude.weight_normal(), gamma.cos(), epsilon = 1e-12);
    }
}
