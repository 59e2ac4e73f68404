//! Small steps: numbers of mean 0 and variance 1 that are not normal, for what is soon the sum of
//! many of them.
//!
//! A gaussian number takes no more than the upper 25 bits of its word (`elementary`). Of the seven
//! that are left over for each sample, three are the step of a walk, three that of the fastest
//! Gauss–Markov term, each one of eight numbers at equal distances, and the last ones of four
//! samples together, by how many of them are set, that of the term renewed once in four. Excess
//! kurtosis −1.24, −1.24 and −0.5: that of a walk after n steps is −1.24/n, that of bias
//! instability below 0.1.

use crate::numerics::elementary::Real;

/// 1/√((8² − 1)/12).
pub(crate) const EIGHTH: f64 = 0.436_435_780_471_984_8;

/// The step of a walk at a sample, in units of [`EIGHTH`].
#[inline(always)]
pub(super) fn walk<T: Real>(bits: u32, sample: u64) -> T {
    T::of_i32((bits >> (8 * (sample & 3)) & 7) as i32) - T::of(3.5)
}

/// That of the fastest Gauss–Markov term, in units of [`EIGHTH`].
#[inline(always)]
pub(super) fn fast<T: Real>(bits: u32, sample: u64) -> T {
    T::of_i32((bits >> (8 * (sample & 3) + 3) & 7) as i32) - T::of(3.5)
}

/// That of the term renewed once in four samples.
#[inline(always)]
pub(super) fn fourth<T: Real>(bits: u32) -> T {
    T::of_i32((((bits >> 6) & 0x0101_0101).wrapping_mul(0x0101_0101) >> 24) as i32) - T::of(2.0)
}

#[cfg(test)]
mod tests {
    use super::{EIGHTH, fast, fourth, walk};
    use crate::numerics::elementary::gaussian_pair;

    /// Over all bits there are: means 0, variances 1, and no step knows of another.
    #[test]
    fn small_steps_have_their_moments_and_no_gaussian_number_looks_at_them() {
        let unit = EIGHTH;
        let steps = |byte: u32| [unit * walk::<f64>(byte, 0), unit * fast::<f64>(byte, 0)];
        let mean = |of: &dyn Fn(u32) -> f64| (0..128).map(of).sum::<f64>() / 128.0;
        for (i, j, want) in [(0, 0, 1.0), (1, 1, 1.0), (0, 1, 0.0)] {
            assert!(
                (mean(&|b| steps(b)[i] * steps(b)[j]) - want).abs() < 1e-12 && mean(&|b| steps(b)[i]).abs() < 1e-12
            );
        }
        // The last bits of four samples.
        let fourths: Vec<f64> = (0..16_u32)
            .map(|k| fourth((0..4).map(|i| (k >> i & 1) << (6 + 8 * i)).sum::<u32>() | 0x3F3F_3F3F))
            .collect();
        let moment = |n: i32| fourths.iter().map(|v: &f64| v.powi(n)).sum::<f64>() / 16.0;
        assert_eq!((moment(1), moment(2), moment(4)), (0.0, 1.0, 2.5));
        assert!(fourths.contains(&-2.0) && fourths.contains(&2.0));
        // Samples have bytes of their own.
        assert_eq!((walk::<f64>(0x0000_0500, 1), fast::<f64>(0x0028_0000, 2)), (1.5, 1.5));
        assert_eq!((walk::<f64>(0x0000_0500, 0), fast::<f64>(0x0028_0000, 3)), (-3.5, -3.5));
        for word in (0..u32::MAX - 127).step_by(9_999_872) {
            let (low, high) = (word & !0x7F, word | 0x7F);
            assert_eq!(gaussian_pair::<f64, false>(low, low), gaussian_pair::<f64, false>(high, high));
            // Control: bit 9, the lowest of the radius, is looked at; the angle begins at bit 7.
            assert_ne!(gaussian_pair::<f64, false>(low, low), gaussian_pair::<f64, false>(low ^ 0x200, low ^ 0x200));
        }
    }
}
