//! How much of the full skid resistance a tyre feels at a slip angle.

/// The peaked slip law.
///
/// ```text
/// σ(α) = sin(C atan(α / α_s))
/// ```
///
/// α slip angle, α_s its scale \[rad\], C shape \[-\]. For C of 1 to 1.3 it is close to the tanh(α/α_s) of the robot file; above
/// 1.5 it peaks at α = α_s tan(π/2C) and falls beyond, as tyres do on ice. The form is H. B. Pacejka's Magic Formula
/// (*Tire and Vehicle Dynamics*, 3rd ed. 2012, eq. 4.49) with D = 1 and E = 0.
pub fn peaked(slip_angle_rad: f64, scale_rad: f64, shape: f64) -> f64 {
    (shape * (slip_angle_rad / scale_rad).atan()).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_above_one_and_a_half_peaks_at_one_and_falls_beyond() {
        let peak_rad = 0.05 * (std::f64::consts::FRAC_PI_2 / 1.7).tan();
        assert!((peaked(peak_rad, 0.05, 1.7) - 1.0).abs() < 1e-12);
        assert!(peaked(1.5, 0.05, 1.7) < 0.6);
    }
}
