//! Gain of one model over another on samples that were not fitted, with its uncertainty by blocks.

use super::fit::Fitted;
use super::kind::Layout;
use super::levels::{AT_NOISE, BENT, FEWEST_BLOCKS, LEAST_SHARE, NAME, TIE};

/// Held-out error that one model removes from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gain {
    /// Sum of squares removed.
    pub removed: f64,
    /// The same over its standard error.
    pub errors: f64,
    /// The same over the standard error that white noise gives it: two models whose predictions
    /// differ by Δ differ in their sums of squares by 2 σ √ΣΔ² from chance alone (Vuong,
    /// Econometrica 57, 1989).
    pub apart: f64,
    /// The same if all that the larger model leaves is white noise.
    pub apart_at_most: f64,
    /// Part of the excess error of the model without, that over the noise.
    pub share: f64,
    /// States whether enough blocks differ for their scatter to say anything.
    pub is_known: bool,
    /// States whether the larger model leaves no more than the noise, so that what white noise gives holds.
    pub is_white: bool,
}

impl Gain {
    /// Returns whether the laws that the larger model adds earn a name: by scatter between blocks, or, where no
    /// more than the noise is left, by what white noise gives.
    pub(crate) fn holds(&self) -> bool {
        self.deviations() >= NAME && self.share >= LEAST_SHARE
    }

    /// Standard errors that tell for the larger model.
    pub(crate) fn deviations(&self) -> f64 {
        if self.is_white { self.errors.max(self.apart) } else { self.errors }
    }

    /// Returns whether a number that the smaller model holds fast is another one: of two models of which one holds
    /// the other, the sums of squares differ by χ² where the smaller one is true (Wilks, Ann. Math. Statist. 9, 1938),
    /// so that twice the standard errors count that tell unlike models apart.
    pub(crate) fn frees(&self) -> bool {
        self.nested() >= NAME
    }

    /// Returns whether it may be another one.
    pub(crate) fn may_free(&self) -> bool {
        self.nested() >= BENT
    }

    fn nested(&self) -> f64 {
        if self.is_white { 2.0 * self.apart } else { 0.0 }
    }

    /// Returns whether the search may go on from the larger model: what it adds holds, or shows in few blocks, as a mode
    /// that decays early does, and would hold if the rest were white noise. A name still needs [`Gain::holds`].
    pub(crate) fn may_hold(&self) -> bool {
        self.holds() || (!self.is_known && self.apart_at_most >= NAME && self.share >= LEAST_SHARE)
    }

    /// Returns whether chance accounts for the difference: the smaller model is as good. White
    /// noise tells even where too few blocks differ for their scatter to.
    pub(crate) fn is_chance(&self) -> bool {
        self.removed <= 0.0 || self.apart < TIE || (self.is_known && self.errors < TIE)
    }

    /// 95 % interval of the share; by what white noise gives where too few blocks differ for their scatter to.
    pub(crate) fn ci95(&self) -> [f64; 2] {
        let errors = if self.is_known { self.errors } else { self.apart };
        let half = 1.96 * (self.share / errors).abs();
        [(self.share - half).max(-1.0), (self.share + half).min(1.0)]
    }
}

/// Gain of `with` over `without`, where noise of this variance leaves the rest.
///
/// Where both models err by noise alone and by the difference Δ of their predictions, a block's
/// gain is ΣΔ² in the mean: the ratio of the two is one number for all blocks, and its scatter
/// between them is the uncertainty, whatever the colour of the noise and wherever in the recording
/// the models differ.
pub(crate) fn gain(layout: &Layout, without: &Fitted, with: &Fitted, noise: f64) -> Gain {
    let blocks: Vec<[f64; 2]> = layout
        .blocks
        .iter()
        .map(|rows| {
            let pairs = without.held_out[rows.clone()].iter().zip(&with.held_out[rows.clone()]);
            pairs.fold([0.0; 2], |[gain, size], (a, b)| [gain + a * a - b * b, size + (a - b).powi(2)])
        })
        .collect();
    let [removed, size] = blocks.iter().fold([0.0; 2], |[g, s], [gain, size]| [g + gain, s + size]);
    let squared: f64 = blocks.iter().map(|[_, s]| s * s).sum();
    let effective = size * size / squared.max(1e-300);
    let ratio = removed / size.max(1e-300);
    let scatter: f64 = blocks.iter().map(|[g, s]| (g - ratio * s).powi(2)).sum();
    let few = if effective > FEWEST_BLOCKS { effective / (effective - 1.0) } else { f64::INFINITY };
    let error = (scatter * few).sqrt();
    let errors = if error > 0.0 && removed.is_finite() { removed / error } else { 0.0 };
    let excess = without.error - noise * layout.rows() as f64;
    // What is removed of a model that is at the noise is all that there was.
    let share = if removed > 0.0 { (removed / excess.max(removed)).min(1.0) } else { removed / excess.max(-removed) };
    let apart_in = |variance: f64| removed / (2.0 * (variance * size).sqrt()).max(1e-300);
    let (apart, apart_at_most) = (apart_in(noise), apart_in(with.variance.max(noise)));
    let share = if share.is_finite() { share } else { 0.0 };
    let is_white = with.variance < (1.0 + AT_NOISE) * noise;
    Gain { removed, errors, apart, apart_at_most, share, is_known: few.is_finite(), is_white }
}

#[cfg(test)]
mod tests {
    use super::super::kind::{Linearised, Point};
    use super::*;
    use crate::rng::{Philox, Stream};

    fn fitted(held_out: Vec<f64>) -> Fitted {
        Fitted {
            set: Vec::new(),
            point: Point { shared: Vec::new(), starts: Vec::new() },
            model: Linearised { residual: Vec::new(), shared: Vec::new(), starts: Vec::new() },
            error: held_out.iter().map(|e| e * e).sum(),
            held_out,
            deviations: Vec::new(),
            variance: 1.0,
            at_bound: Vec::new(),
            is_impossible: false,
        }
    }

    // Noise of unit size and a part of the motion that decays: the share that is removed is that of
    // the part, and where nothing but chance is removed it is not five of its standard errors.
    #[test]
    fn a_part_that_decays_is_found_and_chance_is_not() {
        let rows = 2000;
        let layout = Layout::new(std::iter::once(0..rows).collect(), 40, vec![true; rows]);
        let part = |k: usize| (0.7 * k as f64).sin() * (-(k as f64) / 300.0).exp();
        let mut worst: f64 = 0.0;
        for seed in 0..100 {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let noise: Vec<f64> = (0..rows).map(|_| rng.normal()).collect();
            let with = fitted(noise.clone());
            let lacks = |size: f64| fitted(noise.iter().enumerate().map(|(k, e)| e + size * part(k)).collect());
            let found = gain(&layout, &lacks(2.0), &with, 1.0);
            // ½ · 4 · 150 rows: 300, over its standard error of 2√300.
            assert!(found.errors > 3.0 && found.removed > 150.0, "{seed}: {found:?}");
            let by_chance = fitted(noise.iter().enumerate().map(|(k, e)| e + 0.05 * part(k)).collect());
            worst = worst.max(gain(&layout, &with, &by_chance, 1.0).errors);
        }
        assert!(worst < 4.0, "{worst}");
    }

    // A rail that few readings reach: with each of the 40 rows of one block 20 off, Σ Δ² = 400 · 40 = 16 000 in
    // unit noise, whose standard error is 2√16 000 = 253: a share of 1 ± 1.96 · 253/16 000 = ± 0.031.
    #[test]
    fn what_shows_in_one_block_alone_has_the_interval_that_white_noise_gives() {
        let rows = 2000;
        let layout = Layout::new(std::iter::once(0..rows).collect(), 40, vec![true; rows]);
        let block = layout.blocks[3].clone();
        let mut rng = Philox::new(1, 0, Stream::Host);
        let noise: Vec<f64> = (0..rows).map(|_| rng.normal()).collect();
        let railed = noise.iter().enumerate().map(|(k, e)| if block.contains(&k) { e + 20.0 } else { *e }).collect();
        let found = gain(&layout, &fitted(railed), &fitted(noise), 1.0);
        let [low, high] = found.ci95();
        assert!(!found.is_known && (low - 0.969).abs() < 0.002 && high == 1.0, "{found:?}: {low} to {high}");
    }
}
