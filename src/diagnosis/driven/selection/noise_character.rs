//! Describes the noise that a model leaves: with heavy tails, louder at some times than at others,
//! louder where the motion is larger. None of that is a mismatch of the physics. Robust throughout,
//! so that a few bad readings do not speak for the rest.
//!
//! Squared errors are clipped at (3 MAD)², MAD being the median of their magnitudes (2.02 σ if they
//! are normal). A sum of clipped squares has the mean and the variance of χ² with degrees of
//! freedom of its own, which are measured.

use crate::detection::structure;
use crate::numerics::{order, special};
use crate::remainder::REAL;

use super::noise_scale::{MassMotion, local_scale};
use super::residual_structure::{MEMORY, correlation};

/// Stretches whose powers are compared, and the fewest samples in one.
const STRETCHES: usize = 64;
const LEAST_SAMPLES: usize = 8;
/// Squares are clipped at this many MAD, squared.
const CLIP: f64 = 3.0;
/// A reading this many normal standard deviations off is in the tails.
const TAIL: f64 = 3.5;
/// Tails are heavy, strengths different, from such a ratio on.
const HEAVY: f64 = 3.0;
const UNEVEN: f64 = 1.2;
/// Lags of its own past from which the errors of a loud stretch are predicted.
const OWN_LAGS: usize = 12;
/// Number of questions asked of noise: its tails, its change with time, its change with amplitude,
/// a loud stretch.
const QUESTIONS: f64 = 4.0;

/// Tails and unevenness of the noise, beyond its level.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoiseCharacter {
    /// Fraction of the readings that lie beyond 3.5 standard deviations of their middle, where that
    /// is far more than normal noise has.
    pub tails: Option<f64>,
    /// Strength in the last quarter of the time over that in the first, where it changes.
    pub growth: Option<f64>,
    /// Strength in the quarter of the samples with the largest amplitude over that with the
    /// smallest, where it changes.
    pub with_amplitude: Option<f64>,
    /// The loudest stretch, where it stands out and neither of the two changes accounts for it.
    pub stretch: Option<LoudStretch>,
    /// Its memory, where it has a short one.
    pub memory: Option<ReadoutMemory>,
}

/// Memory of readout noise over a few samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadoutMemory {
    /// Correlation of each reading's error with the one before.
    pub neighbour: f64,
    /// Standard deviation of the white noise that has the same density at low frequencies, over
    /// that of the noise.
    pub low_frequency: f64,
}

/// A stretch of samples that is louder than the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoudStretch {
    /// First sample of the stretch.
    pub from: usize,
    /// The one after its last.
    pub to: usize,
    /// Standard deviation over that of the other samples.
    pub ratio: f64,
}

/// Returns the character of the noise in these errors.
pub(crate) fn noise_character(errors: &[f64], motion: &MassMotion<'_>) -> NoiseCharacter {
    let n = errors.len();
    let Some(powers) = clipped(errors).filter(|_| n >= 16 * LEAST_SAMPLES) else { return NoiseCharacter::default() };
    let quarters = |order: &[usize]| [order[..n / 4].to_vec(), order[n - n / 4..].to_vec()];
    let in_time: Vec<usize> = (0..n).collect();
    let growth = strength_ratio(errors, &powers, quarters(&in_time));
    let with_amplitude = strength_ratio(errors, &powers, quarters(&order::ranked(&motion.amplitude())));
    let stretch = if growth.is_none() && with_amplitude.is_none() { loudest_stretch(errors) } else { None };
    // What is only uneven has no heavy tails.
    let scale = local_scale(errors, motion);
    let even: Vec<f64> = errors.iter().zip(&scale).map(|(e, s)| e / s).collect();
    NoiseCharacter { tails: tails(&even), growth, with_amplitude, stretch, memory: None }
}

/// Squares, clipped; `None` where the typical error is zero.
fn clipped(errors: &[f64]) -> Option<Vec<f64>> {
    let limit = (CLIP * order::median(errors.iter().map(|e| e.abs()).collect())?).powi(2);
    (limit > 0.0).then(|| errors.iter().map(|e| (e * e).min(limit)).collect())
}

/// Mean, variance and samples per independent one of clipped squares.
fn moments(errors: &[f64], powers: &[f64]) -> (f64, f64, f64) {
    let n = powers.len() as f64;
    let mean = powers.iter().sum::<f64>() / n;
    let variance = powers.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / n;
    let limit = powers.iter().copied().fold(0.0, f64::max).sqrt();
    let within: Vec<f64> = errors.iter().map(|e| e.clamp(-limit, limit)).collect();
    (mean, variance, correlation(&within, MEMORY))
}

/// Strength of the second set of samples over that of the first, where chance does not account for
/// the difference.
fn strength_ratio(errors: &[f64], powers: &[f64], [first, second]: [Vec<usize>; 2]) -> Option<f64> {
    let (_, variance, colour) = moments(errors, powers);
    let mean = |set: &[usize]| set.iter().map(|k| powers[*k]).sum::<f64>() / set.len() as f64;
    let deviation = (2.0 * variance * colour / first.len() as f64).sqrt();
    let z = (mean(&second) - mean(&first)) / deviation;
    let p_value = QUESTIONS * 2.0 * special::normal_cdf(-z.abs());
    let size = |set: &[usize]| order::median(set.iter().map(|k| errors[*k].abs()).collect());
    let ratio = size(&second)? / size(&first)?;
    (p_value < REAL && ratio.max(1.0 / ratio) > UNEVEN).then_some(ratio)
}

/// Fraction beyond `TAIL`, where it is far more than normal noise has.
fn tails(errors: &[f64]) -> Option<f64> {
    let middle = order::median(errors.iter().map(|e| e.abs()).collect())?;
    let sigma = middle / special::normal_quantile(0.75);
    let n = errors.len() as f64;
    let beyond = errors.iter().filter(|e| e.abs() > TAIL * sigma).count();
    let normal = 2.0 * special::normal_cdf(-TAIL);
    // Counts of rare events are Poisson: P(N ≥ k) with mean m is P(χ² with 2k degrees of freedom <
    // 2m).
    let p_value = 1.0 - special::chi_squared_survival(2.0 * normal * n, 2.0 * beyond as f64);
    (beyond > 0 && QUESTIONS * p_value < REAL && beyond as f64 > HEAVY * normal * n).then_some(beyond as f64 / n)
}

/// Sums of clipped squares over stretches, and their degrees of freedom.
fn stretch_powers(errors: &[f64]) -> Option<(Vec<f64>, usize, f64)> {
    let length = errors.len() / STRETCHES;
    let powers = clipped(errors).filter(|_| length >= LEAST_SAMPLES)?;
    let (mean, variance, colour) = moments(errors, &powers);
    let degrees_of_freedom = 2.0 * length as f64 * mean * mean / variance.max(1e-300) / colour;
    Some((powers.chunks_exact(length).map(|c| c.iter().sum()).collect(), length, degrees_of_freedom))
}

/// Probability, by chance alone, of a stretch as loud as the loudest: errors that stand out
/// somewhere are not even noise, however little of the whole they are.
fn loudest_by_chance(errors: &[f64]) -> f64 {
    let Some((powers, _, degrees_of_freedom)) = stretch_powers(errors) else { return 1.0 };
    let count = powers.len() as f64;
    let most = powers.iter().copied().fold(0.0, f64::max);
    let Some(middle) = order::median(powers) else { return 1.0 };
    // The median of χ² with k degrees of freedom lies at k(1 − 2/(9k))³ (Wilson & Hilferty 1931).
    let mean = middle / (1.0 - 2.0 / (9.0 * degrees_of_freedom)).powi(3);
    (special::chi_squared_survival(degrees_of_freedom * most / mean.max(1e-300), degrees_of_freedom) * count).min(1.0)
}

/// Probability, by chance alone, of a stretch as loud as the loudest whose errors are as
/// predictable from their past: even a loud stretch of noise is white, while a disturbance lets the
/// mass ring.
pub(crate) fn disturbance_by_chance(errors: &[f64]) -> f64 {
    let loud = loudest_by_chance(errors);
    if loud >= REAL {
        return loud;
    }
    let Some(LoudStretch { from, to, .. }) = loudest_stretch(errors) else { return 1.0 };
    let lags = ((to - from) / 8).min(OWN_LAGS);
    loud.max(structure(&errors[from..to], lags, &[]).own_p_value)
}

/// The loudest stretch, joined with the loud ones next to it.
fn loudest_stretch(errors: &[f64]) -> Option<LoudStretch> {
    let (powers, length, degrees_of_freedom) = stretch_powers(errors)?;
    if QUESTIONS * loudest_by_chance(errors) >= REAL {
        return None;
    }
    let middle = order::median(powers.clone())?;
    let limit = special::chi_squared_quantile(1.0 - REAL / powers.len() as f64, degrees_of_freedom)
        / degrees_of_freedom
        * middle;
    let loud = |i: usize| powers.get(i).is_some_and(|p| *p > limit);
    let most = (0..powers.len()).max_by(|a, b| powers[*a].total_cmp(&powers[*b]))?;
    let from = (0..most).rev().take_while(|i| loud(*i)).last().unwrap_or(most);
    let to = (most + 1..powers.len()).take_while(|i| loud(*i)).last().unwrap_or(most) + 1;
    let size = |values: &mut dyn Iterator<Item = &f64>| order::median(values.map(|e| e.abs()).collect());
    let (from, to) = (from * length, to * length);
    let ratio = size(&mut errors[from..to].iter())? / size(&mut errors[..from].iter().chain(&errors[to..]))?;
    (ratio > UNEVEN).then_some(LoudStretch { from, to, ratio })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 6400;

    /// Student's t with this many degrees of freedom, from normal numbers.
    fn student(rng: &mut Philox, degrees_of_freedom: usize) -> f64 {
        let chi: f64 = (0..degrees_of_freedom).map(|_| rng.normal().powi(2)).sum();
        rng.normal() / (chi / degrees_of_freedom as f64).sqrt()
    }

    fn laplace(rng: &mut Philox) -> f64 {
        // The difference of two exponentials, each half a χ² with two degrees of freedom.
        let half = |rng: &mut Philox| 0.5 * (rng.normal().powi(2) + rng.normal().powi(2));
        half(rng) - half(rng)
    }

    fn rows(seed: u64, draw: impl Fn(&mut Philox, usize) -> f64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        (0..ROWS).map(|k| draw(&mut rng, k)).collect()
    }

    fn motion() -> (Vec<f64>, Vec<f64>) {
        let wave = |k: usize| (0.3 * k as f64).sin() * (1.0 + 0.8 * (0.011 * k as f64).sin());
        ((0..ROWS).map(wave).collect(), (0..ROWS).map(|k| wave(k + 5)).collect())
    }

    fn character(errors: &[f64]) -> NoiseCharacter {
        let (x, v) = motion();
        noise_character(errors, &MassMotion { x: &x, v: &v, omega_rad_s: 1.0 })
    }

    // At the level of the diagnosis (REAL over two questions) 200 trials of each law give 0.4
    // alarms on average if the probability is right: more than 4 come once in 10,000.
    #[test]
    fn no_stretch_of_even_noise_is_loud_whatever_its_tails_and_a_doubled_one_is() {
        let alarms = |draw: &dyn Fn(&mut Philox, usize) -> f64| {
            (0..200).filter(|s| loudest_by_chance(&rows(*s, draw)) < REAL / 2.0).count()
        };
        let doubled = |k: usize| if (3000..3200).contains(&k) { 2.0 } else { 1.0 };
        assert!(alarms(&|r, _| r.normal()) <= 4, "normal");
        assert!(alarms(&|r, _| laplace(r)) <= 4, "Laplace");
        assert!(alarms(&|r, _| student(r, 5)) <= 4, "t, 5 degrees of freedom");
        assert!(alarms(&|r, _| student(r, 3)) <= 4, "t, 3 degrees of freedom");
        let found = alarms(&|r, k| doubled(k) * r.normal());
        assert!(found >= 190, "{found} of 200 stretches of doubled noise");
    }

    #[test]
    fn a_loud_stretch_is_a_disturbance_where_the_mass_rings_and_noise_where_it_is_white() {
        let ring =
            |k: usize| if k < 3000 { 0.0 } else { 6.0 * (-(k as f64 - 3000.0) / 60.0).exp() * (0.4 * k as f64).sin() };
        let found = |draw: &dyn Fn(&mut Philox, usize) -> f64| {
            (0..50).filter(|s| disturbance_by_chance(&rows(*s, draw)) < REAL / 300.0).count()
        };
        assert_eq!(found(&|r, k| r.normal() + ring(k)), 50);
        assert_eq!(found(&|r, k| if (3000..3200).contains(&k) { 3.0 * r.normal() } else { r.normal() }), 0);
        assert_eq!(found(&|r, _| student(r, 3)), 0);
    }

    #[test]
    fn each_kind_of_noise_is_recognised_and_plain_noise_is_none_of_them() {
        let (x, v) = motion();
        let amplitude = MassMotion { x: &x, v: &v, omega_rad_s: 1.0 }.amplitude();
        for seed in 0..20 {
            let plain = character(&rows(seed, |r, _| r.normal()));
            assert_eq!(plain, NoiseCharacter::default(), "seed {seed}");
            let t3 = character(&rows(seed, |r, _| student(r, 3)));
            assert!(t3.tails.is_some() && t3.growth.is_none() && t3.with_amplitude.is_none(), "seed {seed}: {t3:?}");
            let grows = character(&rows(seed, |r, k| (1.0 + k as f64 / ROWS as f64) * r.normal()));
            // Medians of the quarters' strengths: (1 + 7/8)/(1 + 1/8) = 1.67, of 1600 samples ±4 %.
            assert!(grows.growth.is_some_and(|g| (1.47..1.87).contains(&g)), "seed {seed}: {grows:?}");
            let louder = character(&rows(seed, |r, k| (0.3 + amplitude[k]) * r.normal()));
            assert!(louder.with_amplitude.is_some_and(|a| a > 1.5), "seed {seed}: {louder:?}");
            assert!(louder.growth.is_none() && louder.tails.is_none(), "seed {seed}: {louder:?}");
            let burst = character(&rows(seed, |r, k| if (3000..3300).contains(&k) { 2.5 } else { 1.0 } * r.normal()));
            let found = burst.stretch.map_or([0, 0], |s| [s.from, s.to]);
            assert!((2900..3100).contains(&found[0]) && (3200..3400).contains(&found[1]), "seed {seed}: {burst:?}");
        }
    }
}
