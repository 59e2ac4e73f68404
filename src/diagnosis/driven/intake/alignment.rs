//! Checks that input and output belong together as they stand: by how many samples one lags the
//! other, and whether the two columns look exchanged.
//!
//! Every linear oscillator of a grid is compared with the recording at every lag at once, by one
//! Fourier transform each. Not for delays below a sample or for any number in the verdict: the fit
//! has its own delay (`lag`).

use std::f64::consts::TAU;
use std::ops::Range;

use realfft::num_complex::Complex64;

use crate::numerics::moments::mean_sd;
use crate::numerics::{fourier, order, spectrum};
use crate::parallel;

/// Longest stretch that is looked at.
const LOOKED_AT: usize = 8192;
/// Fewest samples that show anything of a lag.
const FEWEST: usize = 256;
const ZETAS: [f64; 4] = [0.01, 0.05, 0.2, 0.8];
/// Ratio of neighbouring natural frequencies tried.
const RATIO: f64 = 1.06;
/// Number of samples from which on a lag is one of the recording and not of the sensor.
const LATE: isize = 10;
/// The same for a lead, the other way, which is then one of the recording and not of the chain that
/// measures the input.
const EARLY: isize = -LATE;
/// Part of the cause's power that must lie well below half the rate of what is compared.
const BAND: f64 = 0.99;
/// Rows kept per cycle of the highest frequency within that band.
const PER_CYCLE: f64 = 8.0;

/// The lag at which one column follows best from the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Alignment {
    /// Samples by which the effect comes late; negative where it comes before its cause.
    pub lag: isize,
    /// Fraction of the effect's power that no linear oscillator of the grid explains at that lag.
    pub residual: f64,
    /// Residual without any lag.
    pub residual_unshifted: f64,
    /// Share explained at a lag where nothing belongs together, by chance: exceeded at one lag in
    /// twenty.
    pub chance: f64,
}

impl Alignment {
    /// Returns whether the lag explains more than the columns as they stand, by far.
    pub(crate) fn is_clear(&self) -> bool {
        self.lag != 0 && self.residual < 0.5 * self.residual_unshifted
    }

    /// Returns whether the two have nothing to do with each other: what little is explained would
    /// be at any other lag too.
    pub(crate) fn is_chance(&self) -> bool {
        self.residual > 0.7 && 1.0 - self.residual < 2.0 * self.chance
    }

    /// Returns whether the columns are out of step by more than a late readout explains.
    pub(crate) fn is_misaligned(&self) -> bool {
        self.is_clear() && (self.lag >= LATE || self.lag <= EARLY)
    }
}

/// Returns whether the "output" looks like the cause of the "input": far better explained that way
/// round, and nearly whole.
pub(crate) fn exchanged(forward: &Alignment, backward: &Alignment) -> bool {
    backward.residual < 0.1 && backward.residual < 0.2 * forward.residual
}

/// The best lag of `effect` behind `cause` within `among`, on its loudest stretch; `None` where
/// there is too little to see.
pub(crate) fn align(cause: &[f64], effect: &[f64], among: &Range<usize>) -> Option<Alignment> {
    let stride = stride(&cause[among.clone()]);
    if stride > 1 {
        let thin = |values: &[f64]| -> Vec<f64> {
            values[among.clone()].chunks_exact(stride).map(|c| c.iter().sum::<f64>() / stride as f64).collect()
        };
        let (cause, effect) = (thin(cause), thin(effect));
        let found = aligned(&cause, &effect, &(0..cause.len()))?;
        return Some(Alignment { lag: found.lag * stride as isize, ..found });
    }
    aligned(cause, effect, among)
}

/// Both columns within `among` as they are looked at: thinned, and no more than the stretch on which
/// the effect is loudest.
pub(super) fn looked_at(cause: &[f64], effect: &[f64], among: &Range<usize>) -> [Vec<f64>; 2] {
    let stride = stride(&cause[among.clone()]);
    let [mut cause, mut effect] = [cause, effect].map(|values| -> Vec<f64> {
        values[among.clone()].chunks_exact(stride).map(|c| c.iter().sum::<f64>() / stride as f64).collect()
    });
    let length = effect.len().min(LOOKED_AT);
    let windows = (0..=8).map(|i| (effect.len() - length) * i / 8);
    let loudness = |a: usize| mean_sd(&effect[a..a + length]).1;
    let from = windows.max_by(|a, b| loudness(*a).total_cmp(&loudness(*b))).unwrap_or(0);
    for values in [&mut cause, &mut effect] {
        values.truncate(from + length);
        values.drain(..from);
    }
    [cause, effect]
}

/// Rows that are taken together so that those compared cover as many cycles of the cause as they
/// can: an oversampled recording shows little of its band in the rows that are looked at.
fn stride(cause: &[f64]) -> usize {
    let most = cause.len() / LOOKED_AT;
    if most < 2 {
        return 1;
    }
    let density = spectrum::periodogram(cause, 1.0);
    let whole: f64 = density.density.iter().sum();
    let mut sum = 0.0;
    let edge = density.frequency_hz.iter().zip(&density.density).find(|(_, d)| {
        sum += **d;
        sum >= BAND * whole
    });
    edge.map_or(1, |(f, _)| ((1.0 / (PER_CYCLE * f.max(1e-12))) as usize).clamp(1, most))
}

/// The same, row by row as they stand.
fn aligned(cause: &[f64], effect: &[f64], among: &Range<usize>) -> Option<Alignment> {
    let length = among.len().min(LOOKED_AT) / 64 * 64;
    if length < FEWEST {
        return None;
    }
    let windows = (0..=8).map(|i| among.start + (among.len() - length) * i / 8);
    let loudness = |a: usize| mean_sd(&effect[a..a + length]).1;
    let from = windows.max_by(|a, b| loudness(*a).total_cmp(&loudness(*b)))?;
    let coarse = look(&cause[from..from + length], &effect[from..from + length], length as isize / 4)?;
    if !coarse.is_clear() {
        return Some(Alignment { lag: 0, residual: coarse.residual_unshifted, ..coarse });
    }
    // Again without the samples that have no partner.
    let rest = length - coarse.lag.unsigned_abs();
    let (late, early) = (coarse.lag.max(0) as usize, (-coarse.lag).max(0) as usize);
    let fine = look(&cause[from + early..][..rest], &effect[from + late..][..rest], 3)?;
    // Where the rows that have a partner are no better explained than all were without a shift, it
    // was chance.
    if fine.residual >= coarse.residual_unshifted {
        return Some(Alignment { lag: 0, residual: coarse.residual_unshifted, ..coarse });
    }
    Some(Alignment { lag: coarse.lag + fine.lag, residual: fine.residual, ..coarse })
}

/// Both columns in frequency, without mean and of unit size.
struct Pair {
    cause: Vec<Complex64>,
    effect: Vec<Complex64>,
    samples: usize,
    /// Power of the effect.
    total: f64,
}

/// An oscillator: natural frequency in rad per sample, damping ratio.
type Place = [f64; 2];

impl Pair {
    fn new(cause: &[f64], effect: &[f64]) -> Option<Self> {
        let samples = cause.len();
        let plan = fourier::forward(samples);
        let transform = |values: &[f64]| -> Option<Vec<Complex64>> {
            let (mean, deviation) = mean_sd(values);
            let mut scaled: Vec<f64> = values.iter().map(|v| (v - mean) / deviation.max(1e-300)).collect();
            let mut bins = plan.make_output_vec();
            plan.process(&mut scaled, &mut bins).ok()?;
            bins[0] = Complex64::default();
            Some(bins)
        };
        let (cause, effect) = (transform(cause)?, transform(effect)?);
        let total = effect.iter().map(Complex64::norm_sqr).sum::<f64>().max(1e-300);
        Some(Self { cause, effect, samples, total })
    }

    /// Returns the oscillator's answer to the cause, bin by bin.
    fn answers(&self, [omega, zeta]: Place) -> impl Iterator<Item = Complex64> {
        let step = TAU / self.samples as f64;
        self.cause.iter().enumerate().map(move |(i, u)| {
            let w = step * i as f64;
            Complex64::new(omega * omega - w * w, 2.0 * zeta * omega * w).inv() * u
        })
    }

    /// Fraction of the effect explained at every lag up to `most`, from −most on.
    fn all_r_squared(&self, place: Place, most: isize) -> Option<Vec<f64>> {
        let n = self.samples;
        let plan = fourier::inverse(n);
        let mut own = 0.0;
        let mut bins: Vec<Complex64> = self
            .answers(place)
            .zip(&self.effect)
            .map(|(answer, y)| {
                own += answer.norm_sqr();
                answer.conj() * y
            })
            .collect();
        if let Some(last) = bins.last_mut().filter(|_| n.is_multiple_of(2)) {
            last.im = 0.0;
        }
        let mut product = plan.make_output_vec();
        plan.process(&mut bins, &mut product).ok()?;
        let at = |lag: isize| (0.5 * product[lag.rem_euclid(n as isize) as usize]).powi(2) / own / self.total;
        Some((-most..=most).map(at).collect())
    }

    /// Fraction of the effect explained at one lag.
    fn r_squared(&self, place: Place, lag: isize) -> f64 {
        let turn = Complex64::from_polar(1.0, TAU * lag as f64 / self.samples as f64);
        let (mut own, mut product, mut phase) = (0.0, 0.0, Complex64::new(1.0, 0.0));
        for (answer, y) in self.answers(place).zip(&self.effect) {
            own += answer.norm_sqr();
            product += (answer.conj() * y * phase).re;
            phase *= turn;
        }
        product * product / own / self.total
    }

    /// R² explained at one lag by the best oscillator near `place`.
    fn polished(&self, mut place: Place, lag: isize) -> f64 {
        let mut best = self.r_squared(place, lag);
        let mut steps = [RATIO.sqrt(), 2.0];
        for _ in 0..12 {
            let mut moved = false;
            for axis in 0..2 {
                for step in [steps[axis], 1.0 / steps[axis]] {
                    let mut there = place;
                    there[axis] *= step;
                    let r_squared = self.r_squared(there, lag);
                    if r_squared > best {
                        (best, place, moved) = (r_squared, there, true);
                    }
                }
            }
            if !moved {
                steps = steps.map(f64::sqrt);
            }
        }
        best
    }
}

/// The best lag up to `most` samples, by circular convolution.
fn look(cause: &[f64], effect: &[f64], most: isize) -> Option<Alignment> {
    let n = cause.len();
    let pair = Pair::new(cause, effect)?;
    // In radians per sample; down to a few periods in the stretch.
    let slowest = 4.0 * TAU / n as f64;
    let count = ((3.0 / slowest).ln() / RATIO.ln()).ceil().max(1.0) as usize;
    let places: Vec<Place> =
        (0..count).flat_map(|i| ZETAS.map(|zeta| [slowest * RATIO.powi(i as i32), zeta])).collect();
    let all_r_squared: Vec<Vec<f64>> = parallel::filter_map(&places, |place| pair.all_r_squared(*place, most));
    if all_r_squared.len() < places.len() {
        return None;
    }
    let lags = 2 * most as usize + 1;
    let best: Vec<f64> = (0..lags).map(|i| all_r_squared.iter().map(|s| s[i]).fold(0.0, f64::max)).collect();
    let at_rest = best[most as usize];
    let highest = best.iter().copied().fold(at_rest, f64::max);
    // A periodic input fits again a period later: the nearest summit that is nearly as high.
    let is_peak = |i: usize| (i == 0 || best[i] >= best[i - 1]) && (i + 1 == lags || best[i] >= best[i + 1]);
    let index = (0..lags)
        .filter(|i| is_peak(*i) && best[*i] >= highest - 0.02 * (highest - at_rest))
        .min_by_key(|i| i.abs_diff(most as usize))?;
    let residual_at = |index: usize| {
        let place = places.iter().zip(&all_r_squared).max_by(|a, b| a.1[index].total_cmp(&b.1[index])).map(|(p, _)| *p);
        place.map_or(1.0, |p| (1.0 - pair.polished(p, index as isize - most)).max(0.0))
    };
    let mut sorted = best.clone();
    order::sort(&mut sorted);
    Some(Alignment {
        lag: index as isize - most,
        residual: residual_at(index),
        residual_unshifted: residual_at(most as usize),
        chance: sorted[lags - 1 - lags / 20],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use rand_distr::{Distribution, StandardNormal};

    /// White force and the answer of an oscillator at 0.3 rad per sample, ζ = 0.1, by its own
    /// recurrence.
    fn pair(n: usize) -> (Vec<f64>, Vec<f64>) {
        let u: Vec<f64> = StandardNormal.sample_iter(Philox::new(5, 0, Stream::Host)).take(n).collect();
        let (omega, zeta) = (0.3f64, 0.1);
        let (a, b) =
            (2.0 * (-zeta * omega).exp() * (omega * (1.0 - zeta * zeta).sqrt()).cos(), (-2.0 * zeta * omega).exp());
        let mut y = vec![0.0; n];
        for k in 2..n {
            y[k] = a * y[k - 1] - b * y[k - 2] + u[k - 1];
        }
        (u, y)
    }

    #[test]
    fn a_lag_is_found_with_its_sign_and_none_where_there_is_none() {
        let (u, y) = pair(5000);
        let whole = 0..3000;
        let found = |u: &[f64], y: &[f64]| align(u, y, &whole).filter(Alignment::is_clear).map_or(0, |a| a.lag);
        assert_eq!(found(&u, &y), 0);
        for lag in [12isize, 150, 400] {
            let (late, early) = (found(&u[lag as usize..], &y), found(&u, &y[lag as usize..]));
            assert!((late - lag).abs() <= 2 && (early + lag).abs() <= 2, "{lag}: {late}, {early}");
        }
    }

    #[test]
    fn an_oversampled_recording_is_looked_at_over_its_band() {
        let (u, y) = pair(3000);
        // Straight lines between the samples: 20 rows each, of which 8192 would hold a seventh of
        // the recording.
        let dense = |values: &[f64]| -> Vec<f64> {
            let between = |w: &[f64]| (0..20).map(|i| w[0] + (w[1] - w[0]) * f64::from(i) / 20.0).collect::<Vec<_>>();
            values.windows(2).flat_map(between).collect()
        };
        let smooth = |values: &[f64]| -> Vec<f64> { values.windows(8).map(|w| w.iter().sum::<f64>() / 8.0).collect() };
        let (u, y) = (dense(&smooth(&u)), dense(&smooth(&y)));
        assert!(stride(&u) > 3 && stride(&u[..6000]) == 1, "{}", stride(&u));
        let found = |u: &[f64], y: &[f64]| align(u, y, &(0..50_000)).filter(Alignment::is_clear).map_or(0, |a| a.lag);
        let lag = found(&u[900..], &y);
        assert!((lag - 900).abs() <= 60, "{lag}");
        assert!(found(&u, &y).abs() <= 60);
    }

    #[test]
    fn exchanged_columns_are_told_from_right_ones() {
        let (u, y) = pair(3000);
        let looks = |u: &[f64], y: &[f64]| {
            let (forward, backward) = (align(u, y, &(0..3000)), align(y, u, &(0..3000)));
            forward.zip(backward).is_some_and(|(f, b)| exchanged(&f, &b))
        };
        assert!(looks(&y, &u) && !looks(&u, &y));
    }

    #[test]
    fn strangers_are_told_from_a_pair_drowned_in_noise() {
        let (u, y) = pair(3000);
        let other: Vec<f64> = StandardNormal.sample_iter(Philox::new(6, 0, Stream::Host)).take(3000).collect();
        let stranger = |u: &[f64], y: &[f64]| align(u, y, &(0..3000)).is_some_and(|a| a.is_chance());
        let size = mean_sd(&y).1;
        let drowned: Vec<f64> = y.iter().zip(&other).map(|(y, e)| y + 3.0 * size * e).collect();
        assert!(stranger(&other, &y) && !stranger(&u, &y) && !stranger(&u, &drowned));
    }
}
