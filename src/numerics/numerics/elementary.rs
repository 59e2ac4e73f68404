//! Logarithm, sine and cosine by own polynomials, the same on every machine, for f32 and f64; twins
//! of `shaders/shared/elementary.wgsl`. They exist because WGSL promises sin and cos only to 2⁻¹¹
//! and because a library call in the middle of a vectorised loop undoes the loop.
//!
//! Not for general arguments: a logarithm of a 23-bit uniform number and the sine of a fixed-point
//! phase are all an ensemble needs. Coefficients: minimax fits (Lawson iteration) in f32, series in
//! f64; the tests measure the errors.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number a kernel may be written in: f32 (the twin of the shader) or f64 (the
/// oracle).
pub trait Real:
    Copy
    + Default
    + Debug
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// "f32" or "f64".
    const NAME: &str;
    /// Rounds from f64.
    fn of(value: f64) -> Self;
    /// Converts to f64, exactly.
    fn f64(self) -> f64;
    /// self·b + c with one rounding.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// √self.
    fn sqrt(self) -> Self;
    /// |self|.
    fn abs(self) -> Self;
    /// The smaller.
    fn min(self, other: Self) -> Self;
    /// The larger.
    fn max(self, other: Self) -> Self;
    /// To the nearest integer, ties to even.
    fn round(self) -> Self;
    /// From a whole number below 2²⁴, exact.
    fn of_i32(value: i32) -> Self;
    /// A whole number below 2³¹ in magnitude.
    fn to_i32(self) -> i32;
    /// Returns whether the magnitude is above `bound` or is no number at all. Decided on bits, as
    /// the shader must.
    fn beyond(self, bound: f32) -> bool;
    /// With the sign changed if bit 31 of `word` is set.
    fn flip(self, word: u32) -> Self;
    /// ln(m · 2ᵉ) for m in [√½, √2).
    fn ln_parts<const FMA: bool>(mantissa: f32, exponent: i32) -> Self;
    /// sin and cos of `x` in [−π/4, π/4].
    fn sin_cos_small<const FMA: bool>(x: Self) -> (Self, Self);
}

/// a·b + c, fused where the instruction exists (`FMA`). Never a library call.
#[inline(always)]
pub fn fma<T: Real, const FMA: bool>(a: T, b: T, c: T) -> T {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// The polynomial with these coefficients, the constant one first.
#[inline(always)]
pub(super) fn horner<T: Real, const FMA: bool, const N: usize>(x: T, coefficients: [f64; N]) -> T {
    let mut sum = T::of(coefficients[N - 1]);
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        sum = fma::<T, FMA>(sum, x, T::of(coefficients[i]));
    }
    sum
}

/// The sign of an f32, and of a quarter-turned cosine.
const SIGN: u32 = 0x8000_0000;

macro_rules! real {
    ($t:ident) => {
        const NAME: &str = stringify!($t);
        #[inline(always)]
        fn of(value: f64) -> Self {
            value as $t
        }
        #[inline(always)]
        fn f64(self) -> f64 {
            self as f64
        }
        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            <$t>::mul_add(self, b, c)
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            <$t>::sqrt(self)
        }
        #[inline(always)]
        fn abs(self) -> Self {
            <$t>::abs(self)
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            if self < other { self } else { other }
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            if self > other { self } else { other }
        }
        #[inline(always)]
        fn of_i32(value: i32) -> Self {
            value as $t
        }
    };
}

impl Real for f32 {
    real!(f32);

    // Adding and taking away 1.5 · 2²³ rounds to even without an instruction that the baseline
    // lacks.
    #[inline(always)]
    fn round(self) -> Self {
        const SHIFT: f32 = 12_582_912.0;
        let rounded = (self + SHIFT) - SHIFT;
        if f32::abs(self) < 4_194_304.0 { rounded } else { self }
    }

    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }

    #[inline(always)]
    fn beyond(self, bound: f32) -> bool {
        self.to_bits() & 0x7FFF_FFFF > bound.to_bits()
    }

    #[inline(always)]
    fn flip(self, word: u32) -> Self {
        f32::from_bits(self.to_bits() ^ word & SIGN)
    }

    #[inline(always)]
    fn ln_parts<const FMA: bool>(mantissa: f32, exponent: i32) -> f32 {
        const Q: [f64; 8] = [
            -0.499_999_82,
            0.333_339_3,
            -0.250_025_8,
            0.199_635_33,
            -0.165_518_57,
            0.148_831_95,
            -0.144_263_85,
            0.089_803_39,
        ];
        let x = mantissa - 1.0;
        let series = fma::<f32, FMA>(x * x, horner::<f32, FMA, 8>(x, Q), x);
        fma::<f32, FMA>(exponent as f32, std::f32::consts::LN_2, series)
    }

    #[inline(always)]
    fn sin_cos_small<const FMA: bool>(x: f32) -> (f32, f32) {
        const SIN: [f64; 3] = [-0.166_666_55, 0.008_332_178, -0.000_195_173];
        const COS: [f64; 3] = [0.041_666_646, -0.001_388_736_8, 0.000_024_438_45];
        let z = x * x;
        let sin = fma::<f32, FMA>(x * z, horner::<f32, FMA, 3>(z, SIN), x);
        let cos = fma::<f32, FMA>(z * z, horner::<f32, FMA, 3>(z, COS), fma::<f32, FMA>(z, -0.5, 1.0));
        (sin, cos)
    }
}

impl Real for f64 {
    real!(f64);

    #[inline(always)]
    fn round(self) -> Self {
        const SHIFT: f64 = 6_755_399_441_055_744.0;
        let rounded = (self + SHIFT) - SHIFT;
        if f64::abs(self) < 2_251_799_813_685_248.0 { rounded } else { self }
    }

    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }

    #[inline(always)]
    fn beyond(self, bound: f32) -> bool {
        self.to_bits() & 0x7FFF_FFFF_FFFF_FFFF > (bound as f64).to_bits()
    }

    #[inline(always)]
    fn flip(self, word: u32) -> Self {
        f64::from_bits(self.to_bits() ^ u64::from(word & SIGN) << 32)
    }

    #[inline(always)]
    fn ln_parts<const FMA: bool>(mantissa: f32, exponent: i32) -> f64 {
        fma::<f64, FMA>(exponent as f64, std::f64::consts::LN_2, ln_mantissa::<FMA>(mantissa as f64))
    }

    #[inline(always)]
    fn sin_cos_small<const FMA: bool>(x: f64) -> (f64, f64) {
        const SIN: [f64; 7] = [
            -1.0 / 6.0,
            1.0 / 120.0,
            -1.0 / 5_040.0,
            1.0 / 362_880.0,
            -1.0 / 39_916_800.0,
            1.0 / 6_227_020_800.0,
            -1.0 / 1_307_674_368_000.0,
        ];
        const COS: [f64; 7] = [
            1.0 / 24.0,
            -1.0 / 720.0,
            1.0 / 40_320.0,
            -1.0 / 3_628_800.0,
            1.0 / 479_001_600.0,
            -1.0 / 87_178_291_200.0,
            1.0 / 20_922_789_888_000.0,
        ];
        let z = x * x;
        let sin = fma::<f64, FMA>(x * z, horner::<f64, FMA, 7>(z, SIN), x);
        let cos = fma::<f64, FMA>(z * z, horner::<f64, FMA, 7>(z, COS), fma::<f64, FMA>(z, -0.5, 1.0));
        (sin, cos)
    }
}

/// ln m for m in [√½, √2): 2 artanh((m − 1)/(m + 1)), whose series ends below 1e-17.
#[inline(always)]
pub(super) fn ln_mantissa<const FMA: bool>(m: f64) -> f64 {
    const ODD: [f64; 10] =
        [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0, 2.0 / 11.0, 2.0 / 13.0, 2.0 / 15.0, 2.0 / 17.0, 2.0 / 19.0];
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let fourth = square * square;
    let eighth = fourth * fourth;
    let sums = halved::<FMA, 10, 5>(square, ODD);
    let sums = halved::<FMA, 5, 3>(fourth, sums);
    let [low, high] = halved::<FMA, 3, 2>(eighth, sums);
    s * fma::<f64, FMA>(eighth * eighth, high, low)
}

/// Sums of neighbouring coefficients, the second of each pair times x: a step of Estrin's scheme.
#[inline(always)]
pub(super) fn halved<const FMA: bool, const N: usize, const M: usize>(x: f64, coefficients: [f64; N]) -> [f64; M] {
    let mut sums = [0.0; M];
    let mut i = 0;
    while i < M {
        let even = coefficients[2 * i];
        sums[i] = if 2 * i + 1 < N { fma::<f64, FMA>(x, coefficients[2 * i + 1], even) } else { even };
        i += 1;
    }
    sums
}

/// ln u for the uniform number u = (2k + 1)·2⁻²⁴ made of the upper 23 bits k of a random word:
/// never 0, never 1.
#[inline(always)]
fn ln_uniform<T: Real, const FMA: bool>(word: u32) -> T {
    // 2²⁴u: exact in f32, so f32 and f64 take the logarithm of the same number.
    let scaled = (word >> 8 | 1) as i32 as f32;
    // Split u = m·2ᵉ around √½, so that m − 1 is small where ln u is small.
    const ROOT_HALF: u32 = 0x3F35_04F3;
    let above = scaled.to_bits().wrapping_sub(ROOT_HALF + (24 << 23));
    let mantissa = f32::from_bits((above & 0x007F_FFFF) + ROOT_HALF);
    let exponent = (above as i32) >> 23;
    T::ln_parts::<FMA>(mantissa, exponent)
}

/// sin and cos of 2π·`turns`/2³², the phase in fixed-point turns: its wrap-around is the circle's.
#[inline(always)]
pub fn sin_cos_turns<T: Real, const FMA: bool>(turns: u32) -> (T, T) {
    // The quadrant, around whose middle the rest lies, is in the two highest bits.
    let quadrant = turns.wrapping_add(0x2000_0000);
    let rest = turns.wrapping_sub(quadrant & 0xC000_0000) as i32;
    // 23 bits survive: the conversion is exact in f32, and f32 and f64 see the same angle.
    let x = T::of_i32(rest >> 7) * T::of(std::f64::consts::TAU / 33_554_432.0);
    let (s, c) = T::sin_cos_small::<FMA>(x);
    turn_by_quarters(s, c, quadrant)
}

/// sin and cos of x, |x| below some thousands.
#[inline(always)]
pub fn sin_cos<T: Real, const FMA: bool>(x: T) -> (T, T) {
    // π/2 in two parts; the first has few enough bits that its multiples are exact.
    const HIGH: f64 = 1.570_312_5;
    let quarters = (x * T::of(std::f64::consts::FRAC_2_PI)).round();
    let rest = fma::<T, FMA>(-quarters, T::of(HIGH), x);
    let rest = fma::<T, FMA>(-quarters, T::of(std::f64::consts::FRAC_PI_2 - HIGH), rest);
    let (s, c) = T::sin_cos_small::<FMA>(rest);
    turn_by_quarters(s, c, (quarters.to_i32() as u32) << 30)
}

/// The sine and cosine of an angle that many quarters further on: the two highest bits of
/// `quarters`.
#[inline(always)]
fn turn_by_quarters<T: Real>(s: T, c: T, quarters: u32) -> (T, T) {
    const QUARTER: u32 = 1 << 30;
    let swapped = quarters & QUARTER != 0;
    let (sin, cos) = if swapped { (c, s) } else { (s, c) };
    (sin.flip(quarters), cos.flip(quarters.wrapping_add(QUARTER)))
}

/// Two independent standard normal numbers of two random words (Box and Muller 1958). |g| ≤ 5.77:
/// the largest of 2²³ equally likely radii.
#[inline(always)]
pub fn gaussian_pair<T: Real, const FMA: bool>(radius: u32, angle: u32) -> (T, T) {
    // Never of a negative number: `logarithms_are_negative` looks at all of them.
    let r = (T::of(-2.0) * ln_uniform::<T, FMA>(radius)).sqrt();
    let (sin, cos) = sin_cos_turns::<T, FMA>(angle);
    (r * cos, r * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst<T: Real, const FMA: bool>() -> (f64, f64) {
        let (mut log, mut circle) = (0.0_f64, 0.0_f64);
        for i in 0..200_000_u32 {
            let word = i.wrapping_mul(0x9E37_79B9) ^ (i >> 3);
            let u = f64::from(word >> 8 | 1) / 16_777_216.0;
            log = log.max((ln_uniform::<T, FMA>(word).f64() / u.ln() - 1.0).abs());
            let angle = f64::from(word & !0x7F) / 4_294_967_296.0 * std::f64::consts::TAU;
            let (s, c) = sin_cos_turns::<T, FMA>(word);
            circle = circle.max((s.f64() - angle.sin()).abs()).max((c.f64() - angle.cos()).abs());
        }
        (log, circle)
    }

    #[test]
    fn polynomials_are_as_good_as_the_format() {
        for (log, circle) in [worst::<f32, true>(), worst::<f32, false>()] {
            assert!(log < 2.5e-7 && circle < 1.5e-7, "{log:e} {circle:e}");
        }
        for (log, circle) in [worst::<f64, true>(), worst::<f64, false>()] {
            assert!(log < 1e-14 && circle < 1e-15, "{log:e} {circle:e}");
        }
    }

    #[test]
    fn logarithms_are_negative() {
        for k in 0..1_u32 << 23 {
            let word = k << 9;
            assert!(ln_uniform::<f32, true>(word) < 0.0 && ln_uniform::<f32, false>(word) < 0.0, "{word}");
            assert!(ln_uniform::<f64, true>(word) < 0.0 && ln_uniform::<f64, false>(word) < 0.0, "{word}");
        }
    }

    #[test]
    fn angles_of_many_turns_keep_their_sine() {
        for i in 0..20_000 {
            let x = f64::from(i) * 0.01 - 100.0;
            let (s, c) = sin_cos::<f64, false>(x);
            assert!((s - x.sin()).abs() < 1e-13 && (c - x.cos()).abs() < 1e-13, "{x}");
            let x = x as f32;
            let (s, c) = sin_cos::<f32, false>(x);
            assert!((f64::from(s) - f64::from(x).sin()).abs() < 3e-7, "{x}");
            assert!((f64::from(c) - f64::from(x).cos()).abs() < 3e-7, "{x}");
        }
    }

    #[test]
    fn extremes_of_the_uniform_number_give_finite_normals() {
        for word in [0, 1, 255, 256, u32::MAX, u32::MAX - 255] {
            let (a, b) = gaussian_pair::<f32, false>(word, word);
            assert!(a.is_finite() && b.is_finite() && a.hypot(b) <= 5.77);
        }
    }

    #[test]
    fn rounding_is_to_even_and_leaves_large_numbers_alone() {
        assert_eq!([0.5_f32, 1.5, -2.5, 2.4, 1e9].map(Real::round), [0.0, 2.0, -2.0, 2.0, 1e9]);
        assert_eq!([0.5_f64, 1.5, -2.5, 2.4, 1e17].map(Real::round), [0.0, 2.0, -2.0, 2.0, 1e17]);
        assert!(f32::NAN.beyond(1.0) && f64::INFINITY.beyond(1.0) && !0.5_f32.beyond(1.0) && (-2.0_f64).beyond(1.0));
    }
}
