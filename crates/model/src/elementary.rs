//! Elementary functions without branches or calls, so that loops over many moments compute several of them side by side.
//!
//! The library's own are calls, which no loop can be widened around. These are as exact as any part of a share has to be: within
//! 4·10⁻¹⁶ of the largest value in their range, by Taylor's series about the nearest of a few places.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, LOG2_E, SQRT_2};

/// Adding this rounds to a whole number, which then stands in the lowest bits: 1.5 · 2⁵².
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// ln 2 to 32 bits, so that small whole multiples are exact.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
/// ln 2 beyond that.
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// π/2 to 33 bits, so that small whole multiples are exact.
const FRAC_PI_2_HIGH: f64 = f64::from_bits(0x3ff9_21fb_5440_0000);
/// π/2 beyond that.
const FRAC_PI_2_LOW: f64 = 6.077_100_506_506_192e-11;

/// tan π/16 and tan 3π/16: between them π/8 is the nearest of 0, π/8 and π/4.
const NEAREST_EIGHTH: [f64; 2] = [0.198_912_367_379_658, 0.668_178_637_919_298_9];

/// Bits of the exponent's bias and its place.
const EXPONENT_BIAS: u64 = 1023;
const EXPONENT_PLACE: u32 = 52;
/// tanh x is 1 to the last bit from 2 x = 40 on.
const TWICE_SATURATED: f64 = 40.0;

/// eˣ for |x| ≤ 700.
#[inline(always)]
fn exp(x: f64) -> f64 {
    // 0.35¹⁴/14! is 5·10⁻¹⁸.
    const SERIES: [f64; 14] = inverse_factorials(0, 1, 1.0);
    let rounded = x * LOG2_E + ROUNDING;
    let doublings = rounded - ROUNDING;
    let rest = x - doublings * LN_2_HIGH - doublings * LN_2_LOW;
    let power_of_two = f64::from_bits(rounded.to_bits().wrapping_add(EXPONENT_BIAS) << EXPONENT_PLACE);
    polynomial(rest, SERIES) * power_of_two
}

/// tanh x for x ≥ 0, infinity included; near 0 to 2·10⁻¹⁶, not to as much of itself.
#[inline(always)]
pub(crate) fn tanh_of_positive(x: f64) -> f64 {
    // Written so that a NaN stays one. Wider loops compute both; a single moment takes the shorter way.
    if 2.0 * x > TWICE_SATURATED { 1.0 } else { 1.0 - 2.0 / (1.0 + exp(2.0 * x)) }
}

/// tanh x; near 0 to 2·10⁻¹⁶, not to as much of itself.
#[inline(always)]
pub(crate) fn tanh(x: f64) -> f64 {
    tanh_of_positive(x.abs()).copysign(x)
}

/// sin x and cos x for |x| ≤ 10⁵.
#[inline(always)]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    // (π/4)¹⁹/19! and (π/4)¹⁸/18! are below 3·10⁻¹⁸.
    const SINE: [f64; 9] = inverse_factorials(1, 2, -1.0);
    const COSINE: [f64; 9] = inverse_factorials(0, 2, -1.0);
    let rounded = x * FRAC_2_PI + ROUNDING;
    let quarters = rounded - ROUNDING;
    let rest = x - quarters * FRAC_PI_2_HIGH - quarters * FRAC_PI_2_LOW;
    let squared = rest * rest;
    let (sin, cos) = (rest * polynomial(squared, SINE), polynomial(squared, COSINE));
    let quadrant = rounded.to_bits();
    let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let signed = |value: f64, second_bit: u64| f64::from_bits(value.to_bits() ^ ((second_bit & 2) << 62));
    (signed(sin, quadrant), signed(cos, quadrant.wrapping_add(1)))
}

/// Angle of a vector whose components are not negative, 0 to π/2; NaN where both are 0.
#[inline(always)]
pub(crate) fn first_quadrant_angle(y: f64, x: f64) -> f64 {
    // (tan π/16)²³/23 is 3·10⁻¹⁸.
    const SERIES: [f64; 11] = alternating_odd_inverses();
    let (low, high) = (y.min(x), y.max(x));
    let [first, second] = NEAREST_EIGHTH;
    let (tangent, about) = if low > second * high {
        (1.0, FRAC_PI_4)
    } else if low > first * high {
        (SQRT_2 - 1.0, FRAC_PI_8)
    } else {
        (0.0, 0.0)
    };
    let rest = (low - tangent * high) / (high + tangent * low);
    let angle = about + rest * polynomial(rest * rest, SERIES);
    if y > x { FRAC_PI_2 - angle } else { angle }
}

/// Σ cᵢ xⁱ, even and odd powers for themselves: half as many steps have to wait for one another.
#[inline(always)]
fn polynomial<const TERMS: usize>(x: f64, coefficients: [f64; TERMS]) -> f64 {
    let squared = x * x;
    let (mut even, mut odd) = (0.0, 0.0);
    for i in (0..TERMS).rev() {
        let sum = if i % 2 == 0 { &mut even } else { &mut odd };
        *sum = *sum * squared + coefficients[i];
    }
    even + x * odd
}

/// 1/first!, sign/(first + step)!, 1/(first + 2 step)!, ...
const fn inverse_factorials<const TERMS: usize>(first: u32, step: u32, sign: f64) -> [f64; TERMS] {
    let mut series = [1.0; TERMS];
    let (mut factorial, mut reached, mut term) = (1.0, 0, 0);
    while term < TERMS {
        let last = first + step * term as u32;
        while reached < last {
            reached += 1;
            factorial *= reached as f64;
        }
        series[term] = if term % 2 == 0 { 1.0 / factorial } else { sign / factorial };
        term += 1;
    }
    series
}

/// 1, −1/3, 1/5, ...
const fn alternating_odd_inverses<const TERMS: usize>() -> [f64; TERMS] {
    let mut series = [1.0; TERMS];
    let mut term = 0;
    while term < TERMS {
        let inverse = 1.0 / (2 * term + 1) as f64;
        series[term] = if term % 2 == 0 { inverse } else { -inverse };
        term += 1;
    }
    series
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn all_agree_with_the_library(x in -40.0f64..40.0, angle in -30.0f64..30.0, y in 0.0f64..3.0, z in 0.0f64..3.0) {
            prop_assert!((exp(x) / x.exp() - 1.0).abs() < 6e-16, "exp {x}");
            prop_assert!((tanh(x) - x.tanh()).abs() < 3e-16, "tanh {x}");
            let small = x / 40.0;
            prop_assert!((tanh(small) - small.tanh()).abs() < 3e-16, "tanh {small}");
            let (sin, cos) = sin_cos(angle);
            prop_assert!((sin - angle.sin()).abs() < 2.5e-16 && (cos - angle.cos()).abs() < 2.5e-16, "sin cos {angle}");
            prop_assert!((first_quadrant_angle(y, z) - y.atan2(z)).abs() < 5e-16, "atan2 {y} {z}");
            let near = 1e-9 * y;
            prop_assert!((first_quadrant_angle(near, z) / near.atan2(z) - 1.0).abs() < 5e-16, "atan2 {near} {z}");
        }
    }

    #[test]
    fn ends_of_the_ranges_are_exact() {
        assert_eq!(tanh(0.0), 0.0);
        assert_eq!([tanh_of_positive(20.0), tanh_of_positive(f64::INFINITY), tanh(-1e300)], [1.0, 1.0, -1.0]);
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!([first_quadrant_angle(0.0, 2.0), first_quadrant_angle(2.0, 0.0)], [0.0, FRAC_PI_2]);
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan() && tanh(f64::NAN).is_nan());
    }
}
