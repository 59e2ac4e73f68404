//! What a model leaves: is it more than noise, and does it remember the pose before?

use super::fit::Fit;
use super::group::{GROUPS, Group};
use crate::detection::structure;
use crate::numerics::order;
use crate::numerics::special::f_survival;
use crate::remainder::{Remainder, Size, Test, WHITE};

/// Degrees of freedom behind the measured noise: its own uncertainty is about ±13 % in standard
/// deviation.
const NOISE_FREEDOM: f64 = 60.0;
/// A residual of this many times the noise variance is material: less is within what a noise model
/// can promise.
const MATERIAL: f64 = 1.6;
/// Residuals at rest: one of gravity, three of the gyro.
const STILL_RESIDUALS: usize = 4;
/// Tests of one model: each group against its noise, each residual at rest against the pose before.
const TESTS: f64 = (GROUPS.len() + STILL_RESIDUALS) as f64;

/// Holds what is left after repair.
#[derive(Debug, Clone)]
pub(crate) struct Residual {
    /// All tests, in the vocabulary of every kind.
    pub remainder: Remainder,
    /// Residuals above their noise, with their variance over that of the noise, worst first.
    pub above: Vec<(Group, f64)>,
}

impl Residual {
    pub(super) fn of(fit: &Fit) -> Self {
        let mut tests: Vec<Test> = Vec::new();
        let mut above: Vec<(Group, f64)> = Vec::new();
        for group in GROUPS.into_iter().filter(|g| fit.rows.chi_square(*g).1 > 0) {
            let (ratio, n) = (fit.reduced(group), fit.rows.chi_square(group).1 as f64);
            let degrees_of_freedom = (n - fit.leverage(group)).max(1.0);
            let p_value = TESTS * f_survival(ratio, degrees_of_freedom, NOISE_FREEDOM);
            let test = Test { p_value, size: Size::of(ratio, MATERIAL, MATERIAL) };
            if test.found() == Size::Material {
                above.push((group, ratio));
            }
            tests.push(test);
        }
        order::sort_by_key(&mut above, |a| -a.1);
        // Per pose one row of gravity, then three of the gyro at rest, where there is one.
        let at_rest: Vec<usize> = (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] != Group::Turn).collect();
        let channels = if fit.rows.group.contains(&Group::Still) { STILL_RESIDUALS } else { 1 };
        for channel in 0..channels {
            let values: Vec<f64> =
                at_rest.chunks_exact(channels).map(|rows| fit.rows.residual[rows[channel]]).collect();
            // Noise of a pose has a 1/f part, which the next pose remembers: that is not white, and
            // no mismatch.
            tests.push(Test { p_value: TESTS * memory(&values), size: Size::Negligible });
        }
        let remainder = Remainder::of(tests);
        // What poses remember has no size of its own here: its probability alone says whether they
        // are white.
        Self { remainder: Remainder { white: remainder.p_value >= WHITE, ..remainder }, above }
    }
}

/// Probability of so strong a correlation between neighbouring poses by chance.
fn memory(values: &[f64]) -> f64 {
    structure(values, 1, &[]).own_p_value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_wave_is_remembered_and_an_alternation_too_but_not_chance() {
        let wave: Vec<f64> = (0..40).map(|k| (f64::from(k) * 0.2).sin()).collect();
        let chance: Vec<f64> = (0..40).map(|k| (f64::from(k * k) * 1.7).sin()).collect();
        assert!(memory(&wave) < 1e-4);
        assert!(memory(&chance) > 0.01, "{}", memory(&chance));
    }
}
