//! Exponential, logarithm and hyperbolic tangent without a branch or a call, so that a loop over
//! lanes that needs them compiles to vector instructions; the same on every machine.
//!
//! Not for the noise of ensembles, which takes the logarithm of 23-bit numbers (`elementary`), and
//! not for arguments beyond those stated.

use std::f64::consts::{LN_2, LOG2_E};

use super::elementary::{horner, ln_mantissa};

/// Adding and taking away 1.5 · 2⁵² rounds to the nearest integer, which then stands in the lowest
/// bits.
const SHIFT: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts; the upper one has few enough bits that its multiples by whole numbers below
/// 2²⁰ are exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// eˣ; beyond ±700 that of ±700.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    // 1/k!: the series ends below 5e-18 for |x| ≤ ln 2 / 2.
    const SERIES: [f64; 14] = [
        1.0,
        1.0,
        0.5,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 720.0,
        1.0 / 5_040.0,
        1.0 / 40_320.0,
        1.0 / 362_880.0,
        1.0 / 3_628_800.0,
        1.0 / 39_916_800.0,
        1.0 / 479_001_600.0,
        1.0 / 6_227_020_800.0,
    ];
    // In this order what is no number stays that.
    let x = if x > 700.0 { 700.0 } else { x };
    let x = if x < -700.0 { -700.0 } else { x };
    let shifted = x * LOG2_E + SHIFT;
    let whole = shifted - SHIFT;
    let rest = (x - whole * LN_2_HIGH) - whole * LN_2_LOW;
    // Times 2ⁿ: n added to the exponent.
    f64::from_bits(horner::<f64, false, 14>(rest, SERIES).to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// ln x of a positive, normal x.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    // x = m·2ᵉ with m in [√½, √2).
    const ROOT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;
    const MANTISSA: u64 = (1 << 52) - 1;
    // An integer below 2⁵² behind the exponent of 2⁵² is that number more than 2⁵².
    const WHOLE: u64 = 0x4330_0000_0000_0000;
    const OFFSET: u64 = 1024;
    let above = x.to_bits().wrapping_sub(ROOT_HALF);
    let mantissa = f64::from_bits((above & MANTISSA).wrapping_add(ROOT_HALF));
    let raised = above.wrapping_add(OFFSET << 52) >> 52;
    let exponent = f64::from_bits(raised | WHOLE) - (4_503_599_627_370_496.0 + OFFSET as f64);
    exponent * LN_2 + ln_mantissa::<false>(mantissa)
}

/// tanh x, within 4e-16.
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let fading = exp(-2.0 * x.abs());
    ((1.0 - fading) / (1.0 + fading)).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(arguments: impl Iterator<Item = f64>, error: impl Fn(f64) -> f64) -> f64 {
        arguments.map(|x| error(x).abs()).fold(0.0, f64::max)
    }

    // Next to the standard library's, which are within one unit in the last place (2.2e-16). Added
    // to it, rounding of the last sum: two units; of ln also that of its argument, which exp has
    // rounded: three.
    #[test]
    fn they_are_those_of_the_standard_library_to_some_units_in_the_last_place() {
        let around = || (-70_000..70_000).map(|i| f64::from(i) * 0.009_999);
        let found = worst(around(), |x| exp(x) / x.exp() - 1.0);
        assert!(found < 4e-16, "{found:e}");
        let found = worst(around(), |x| (ln(x.exp()) - x) / x.abs().max(0.5));
        assert!(found < 6e-16, "{found:e}");
        let found = worst((1..40_000).map(|i| f64::from(i) * 5e-5), |x| (ln(x) - x.ln()) / x.ln().abs().max(0.5));
        assert!(found < 4e-16, "{found:e}");
        let found = worst(around().map(|x| x * 0.01), |x| tanh(x) - x.tanh());
        assert!(found < 4e-16, "{found:e}");
        // Control: of f32 they would not be.
        assert!(worst(around().map(|x| x * 0.01), |x| f64::from((x as f32).exp()) / x.exp() - 1.0) > 1e-9);
    }

    #[test]
    fn at_the_ends_of_their_range_they_stay_numbers() {
        assert_eq!([exp(0.0), ln(1.0), tanh(0.0)], [1.0, 0.0, 0.0]);
        assert_eq!([exp(1e9), exp(-1e9)], [exp(700.0), exp(-700.0)]);
        assert_eq!([tanh(1e9), tanh(-1e9)], [1.0, -1.0]);
        assert!(exp(f64::NAN).is_nan() && tanh(f64::NAN).is_nan());
    }
}
