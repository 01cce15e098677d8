//! Costs in sixteen bits: eleven of fraction, five of exponent, always rounded up.
//!
//! Costs below 2048 units are whole units. Above, a cost is stored as (2048 + m) · 2^e, as floats are, so rounding adds at
//! most 1/2048 of it, everywhere on the range. No motion costs less than one unit, so costs rise strictly along any path:
//! a walk along them always gets nearer to its end, and no circle is free.

/// The code of a motion that cannot be driven.
pub(crate) const FORBIDDEN: u16 = u16::MAX;
/// Largest relative rounding of a cost above 2048 units.
pub(crate) const LARGEST_ROUNDING: f64 = 1.0 / 2048.0;
/// Largest relative error of a cost in single precision, its cancellation with lifting work apart.
pub(crate) const SINGLE_PRECISION: f64 = 1e-4;
/// Smallest code of a motion that can be driven.
const SMALLEST: i32 = 1;
/// Units of the motion that sets the scale: fine enough that a unit is nothing beside any motion, coarse enough that
/// 65 000 such motions fit 32 bits.
pub(crate) const UNITS_OF_REFERENCE: f64 = 65_536.0;

const FRACTION_BITS: u32 = 11;
const IMPLICIT: u32 = 1 << FRACTION_BITS;
/// Bits of an f32's fraction that are dropped.
const DROPPED_BITS: u32 = 23 - FRACTION_BITS;
/// From here to twice as much, an f32's fraction counts the whole numbers.
const ALL_FRACTION: f32 = (1 << 23) as f32;
/// What an f32's exponent has more than the code's, which is 1 from 2048 units on.
const EXPONENT_BIAS: i32 = (126 + FRACTION_BITS as i32) << FRACTION_BITS;
/// Largest exponent of a code.
const LARGEST_EXPONENT: u16 = 20;
/// Largest code, of just less than [`ENDLESS`].
const LARGEST: i32 = ((LARGEST_EXPONENT as i32 + 1) << FRACTION_BITS) - 2;
/// What [`decode_lanes`] makes of [`FORBIDDEN`]: more than any other code, and twice as much still fits 32 bits.
pub(crate) const ENDLESS: u32 = (2 * IMPLICIT - 1) << (LARGEST_EXPONENT - 1);

/// Encodes a cost in units, at least one; infinity and beyond the range is forbidden.
#[inline(always)]
pub(crate) fn encode(units: f32) -> u16 {
    // The exponent and upper fraction of an f32, rounded up, are the code itself, less its bias.
    let bits = units.to_bits() as i32;
    let large = ((bits + ((1 << DROPPED_BITS) - 1)) >> DROPPED_BITS) - EXPONENT_BIAS;
    let is_small = units < IMPLICIT as f32;
    // Adding 2^23 leaves no bits for fractions. A cast to an integer would have to ask lane by lane whether it fits.
    let near = (units + ALL_FRACTION) - ALL_FRACTION;
    let up = if near < units { near + 1.0 } else { near };
    let small = (up + ALL_FRACTION).to_bits() as i32 - ALL_FRACTION.to_bits() as i32;
    let code = if is_small { small } else { large };
    if code > LARGEST { FORBIDDEN } else { code.max(SMALLEST) as u16 }
}

/// The cost in units; meaningless for [`FORBIDDEN`].
#[inline(always)]
pub(crate) fn decode(code: u16) -> u32 {
    let code = u32::from(code);
    let exponent = code >> FRACTION_BITS;
    let normal = u32::from(exponent != 0);
    ((code & (IMPLICIT - 1)) | (normal << FRACTION_BITS)) << (exponent - normal)
}

/// The costs in units of codes side by side; [`ENDLESS`] for [`FORBIDDEN`].
#[inline(always)]
pub(crate) fn decode_lanes<const N: usize>(codes: &[u16; N]) -> [u32; N] {
    let (mut fractions, mut shifts, mut costs) = ([0u16; N], [0u16; N], [0u32; N]);
    for x in 0..N {
        // An exponent of 1 shifts by nothing, as 0 does, but has the implicit bit.
        let shift = (codes[x] >> FRACTION_BITS).saturating_sub(1);
        fractions[x] = codes[x].wrapping_sub(shift << FRACTION_BITS);
        shifts[x] = shift.min(LARGEST_EXPONENT - 1);
    }
    for x in 0..N {
        costs[x] = u32::from(fractions[x]) << shifts[x];
    }
    costs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_cost_is_rounded_up_by_at_most_a_two_thousandth(units in 2048.0f32..2e9) {
            let stored = f64::from(decode(encode(units)));
            let units = f64::from(units);
            prop_assert!(stored >= units && stored <= units * (1.0 + LARGEST_ROUNDING) + 1e-6, "{stored} for {units}");
        }

        #[test]
        fn order_is_kept(a in 0.0f32..2e9, b in 0.0f32..2e9) {
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            prop_assert!(encode(low) <= encode(high));
        }
    }

    #[test]
    fn codes_side_by_side_are_decoded_as_alone_and_none_costs_as_much_as_a_forbidden_motion() {
        for code in 0..=LARGEST as u16 {
            let costs = decode_lanes(&[code; 4]);
            assert_eq!(costs, [decode(code); 4]);
            assert!(costs[0] < ENDLESS);
        }
        assert_eq!(decode_lanes(&[FORBIDDEN; 4]), [ENDLESS; 4]);
    }

    #[test]
    fn small_costs_are_whole_units_but_never_none_and_endless_ones_are_forbidden() {
        assert_eq!(decode(encode(0.0)), 1);
        assert_eq!(encode(f32::NAN), FORBIDDEN);
        assert_eq!(decode(encode(0.3)), 1);
        assert_eq!(decode(encode(2047.5)), 2048);
        assert_eq!(decode(encode(2048.0)), 2048);
        assert_eq!(decode(encode(2049.0)), 2049);
        assert_eq!(decode(encode(4097.0)), 4098);
        assert_eq!(encode(f32::INFINITY), FORBIDDEN);
        assert_eq!(encode(1e12), FORBIDDEN);
    }
}
