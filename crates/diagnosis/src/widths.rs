//! How sure the numbers of mechanisms are.

use crate::series::Applied;

/// 97.5 % quantile of the normal distribution.
const NORMAL_975: f64 = 1.959_964;
/// One sigma of what the form of a mechanism leaves open of its size, as a share, where the model misses something itself: in concealed
/// cases of worlds with forms of their own, on seeds that none is scored on, what resists rolling and is told to 5 % by noise was off by
/// 0.11, root mean square, and all else by less.
const SIZE_SIGMA: f64 = 0.10;
/// The same of how far ahead of the middle a centre of mass lies \[m\]: a robot that begins to turn takes a second or two until it turns where
/// its tyres push to both sides alike, and the model has it there at once. In the same cases, 1.5 to 2.1 cm came out up to 0.7 cm short.
const AHEAD_SIGMA_M: f64 = 0.004;

/// Half the width of the 95 % interval of one number of a mechanism, by the standard error that noise leaves; `is_told` where the model misses
/// hardly anything.
pub(crate) fn half_width(applied: &Applied, parameter: usize, sigma: f64, is_told: bool) -> f64 {
    if is_told {
        return NORMAL_975 * sigma;
    }
    let is_ahead = applied.mechanism.name() == "center_of_mass" && parameter == 0;
    let of_form = if is_ahead { AHEAD_SIGMA_M } else { 0.0 };
    NORMAL_975 * sigma.hypot(SIZE_SIGMA * applied.values[parameter]).hypot(of_form)
}

#[cfg(test)]
mod tests {
    use model::mechanism;

    use super::*;
    use crate::span::Span;

    #[test]
    fn where_the_model_is_right_noise_alone_counts_and_else_a_tenth_of_the_size_too() {
        let mechanism = mechanism::by_name("payload").unwrap();
        let payload = Applied { mechanism, values: vec![30.0], span: Span::ALL };
        assert!((half_width(&payload, 0, 1.0, true) - 1.96).abs() < 1e-3);
        // 4 kg of noise and 3 kg of form are 5 kg.
        assert!((half_width(&payload, 0, 4.0, false) - 1.96 * 5.0).abs() < 1e-2);
    }
}
