//! The noise of a reading, measured without any model: what "at the noise" is held against, so that
//! nothing that a fit absorbs can pass for noise.
//!
//! Two kinds of measure. What does not repeat, under an input that does or where nothing moves, is
//! noise of any colour, but also whatever else does not repeat (a drift, a chaotic response). What
//! differences of high order or the quietest part of the spectrum hold is white noise, but also the
//! rest of the motion there. Either errs upwards, so that the smaller is the better one; what
//! repeats is believed while both agree. Coloured noise is measured by what repeats alone.

use std::f64::consts::PI;
use std::ops::Range;

use realfft::num_complex::Complex64;

use crate::numerics::moments::{mean, mean_sd};
use crate::numerics::{fourier, order, spectrum};

use super::data::Data;
use super::input::Input;

/// Fewer samples than this are not looked at.
const FEWEST: usize = 128;
/// Highest order of differences.
const MOST_ORDER: usize = 16;
/// Blocks whose powers are compared, so that a knock does not speak for the rest.
const BLOCKS: usize = 32;
/// A block counts no more than this many times the middle one.
const LOUDEST: f64 = 4.0;
/// Bands of the spectrum, the quietest of which counts.
const BANDS: usize = 12;
/// Standard deviations by which the lowest of as many normal values lies below their mean (Tippett,
/// Biometrika 17, 1925).
const LOWEST: f64 = 1.629;
/// Shortest period that is looked for, in samples.
const SHORTEST: usize = 8;
/// Periods of the input that are tried for being exact repetitions.
const TRIED: usize = 48;
/// An input repeats whose root-mean-square change over a period is below this part of its size.
const REPEATS: f64 = 1e-3;
/// Longest still stretch that is looked at, in samples, and the shortest that shows anything.
const STILL: [usize; 2] = [256, 4096];
/// The quietest band is believed below this many times what differences show.
const AGREE: f64 = 0.85;
/// Factor over what differences show up to which the part that does not repeat is believed.
const BELIEVED: f64 = 3.0;

/// Source from which the noise was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum How {
    /// The input repeats: scatter of the reading at equal phases.
    Periods { count: usize, samples: usize },
    /// Scatter about a straight line where neither input nor reading moves.
    Still { samples: usize },
    /// Differences of this order.
    Differences { order: usize },
    /// The quietest part of the spectrum.
    Spectrum { from_hz: f64, to_hz: f64 },
    /// Readings in steps hide what is smaller.
    Rounding,
}

/// The noise and where it was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ReadingNoise {
    /// Standard deviation, unit of the reading.
    pub deviation: f64,
    pub how: How,
}

/// Readings on which the noise is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<'a> {
    pub reading: &'a [f64],
    /// Input; `None` for a ring-down.
    pub input: Option<&'a [f64]>,
    pub rate_hz: f64,
    /// Samples that are looked at.
    pub hull: [usize; 2],
}

impl<'a> Sample<'a> {
    /// All of a recording that is fitted.
    pub(crate) fn of(data: &'a Data) -> Self {
        Self {
            reading: &data.reading,
            input: data.input.as_ref().map(Input::samples),
            rate_hz: data.rate_hz,
            hull: [data.hull.start, data.hull.end],
        }
    }
}

/// The noise by the best measure at hand; `None` where there are too few samples.
pub(crate) fn reading_noise(s: &Sample<'_>) -> Option<ReadingNoise> {
    let range: Range<usize> = s.hull[0]..s.hull[1].min(s.reading.len());
    let y = s.reading.get(range.clone())?;
    if y.len() < FEWEST || !y.iter().all(|v| v.is_finite()) {
        return None;
    }
    let u = s.input.and_then(|u| u.get(range));
    // Where both agree, differences are the surer measure.
    let (by_differences, by_band) = (differences(y)?, quietest(y, s.rate_hz));
    let white = by_band.filter(|b| b.deviation < AGREE * by_differences.deviation).unwrap_or(by_differences);
    // Without an input nothing shows when the mass is still: the end of a decay may only seem so.
    let any_colour = u.and_then(|u| least([periods(u, y), still(Some(u), y)]));
    let best = any_colour.filter(|a| a.deviation <= BELIEVED * white.deviation).unwrap_or(white);
    let rounding = step(y) / 12f64.sqrt();
    Some(if best.deviation < rounding { ReadingNoise { deviation: rounding, how: How::Rounding } } else { best })
}

fn least<const N: usize>(all: [Option<ReadingNoise>; N]) -> Option<ReadingNoise> {
    all.into_iter().flatten().min_by(|a, b| a.deviation.total_cmp(&b.deviation))
}

/// Mean of the blocks' mean squares, a loud one counted no more than this many times the middle
/// one.
fn steady_power(values: &[f64]) -> f64 {
    let n = values.len();
    let blocks = BLOCKS.min(n / 8).max(1);
    let power = |b: usize| {
        let block = &values[n * b / blocks..n * (b + 1) / blocks];
        block.iter().map(|v| v * v).sum::<f64>() / block.len().max(1) as f64
    };
    let all: Vec<f64> = (0..blocks).map(power).collect();
    let limit = LOUDEST * order::median(all.clone()).unwrap_or(0.0);
    mean(&all.iter().map(|p| if limit > 0.0 { p.min(limit) } else { *p }).collect::<Vec<f64>>())
}

/// Measures the noise by differences: of white noise the m-th difference has C(2m, m) times the
/// variance.
fn differences(y: &[f64]) -> Option<ReadingNoise> {
    let mut d = y.to_vec();
    let (mut gain, mut best) = (1.0, None);
    for m in 1..=MOST_ORDER {
        d = d.windows(2).map(|w| w[1] - w[0]).collect();
        gain *= 2.0 * (2 * m - 1) as f64 / m as f64;
        let here = ReadingNoise { deviation: (steady_power(&d) / gain).sqrt(), how: How::Differences { order: m } };
        best = least([best, Some(here)]);
    }
    best
}

/// Measures the noise by the spectrum: the quietest of some bands, each by its middle bin.
fn quietest(y: &[f64], rate_hz: f64) -> Option<ReadingNoise> {
    let density = spectrum::welch(y, rate_hz, (y.len() / 8).clamp(64, 1024));
    let bins = density.density.len();
    // The median of χ² with 2k degrees of freedom is about 1 − 1/(9k) cubed of its mean.
    let bias = (1.0 - 1.0 / (9.0 * density.averages.max(1.0))).powi(3);
    let band = |b: usize| {
        let (from, to) = (bins * b / BANDS, bins * (b + 1) / BANDS);
        let middle = order::median(density.density.get(from..to)?.to_vec())?;
        Some(ReadingNoise {
            deviation: (middle / bias * 0.5 * rate_hz).sqrt(),
            how: How::Spectrum { from_hz: density.frequency_hz[from], to_hz: density.frequency_hz[to - 1] },
        })
    };
    let quietest = (0..BANDS).filter_map(band).min_by(|a, b| a.deviation.total_cmp(&b.deviation))?;
    // Of bands that are all alike the quietest lies low by chance: a middle bin scatters by √(π/2) of a mean.
    let scatter = (0.5 * PI * BANDS as f64 / (density.averages.max(1.0) * bins as f64)).sqrt();
    Some(ReadingNoise { deviation: quietest.deviation / (1.0 - LOWEST * scatter).sqrt(), ..quietest })
}

/// Measures the noise by repetition: the scatter of the reading at equal phases of an input that
/// repeats, its first third left out.
fn periods(u: &[f64], y: &[f64]) -> Option<ReadingNoise> {
    let period = period(u)?;
    let skipped = y.len() / 3;
    let count = (y.len() - skipped) / period;
    if count < 2 {
        return None;
    }
    let from = y.len() - count * period;
    let mut sum = 0.0;
    for phase in 0..period {
        let column: Vec<f64> = (0..count).map(|p| y[from + p * period + phase]).collect();
        let (_, deviation) = mean_sd(&column);
        sum += deviation * deviation * count as f64;
    }
    let variance = sum / ((count - 1) * period) as f64;
    Some(ReadingNoise { deviation: variance.sqrt(), how: How::Periods { count, samples: period } })
}

/// Samples after which a sequence repeats exactly; `None` where it does not, or only once.
fn period(u: &[f64]) -> Option<usize> {
    let n = u.len();
    let (centre, size) = mean_sd(u);
    if size <= 1e-12 * centre.abs() || size == 0.0 {
        return None;
    }
    let length = (2 * n).next_power_of_two();
    let (forward, inverse) = (fourier::forward(length), fourier::inverse(length));
    let mut padded: Vec<f64> = u.iter().map(|v| (v - centre) / size).collect();
    padded.resize(length, 0.0);
    let mut bins = forward.make_output_vec();
    forward.process(&mut padded, &mut bins).ok()?;
    bins.iter_mut().for_each(|b| *b = Complex64::new(b.norm_sqr(), 0.0));
    let mut product = inverse.make_output_vec();
    inverse.process(&mut bins, &mut product).ok()?;
    let alike = |lag: usize| product[lag] / length as f64 / (n - lag) as f64;
    let most = n / 3;
    let is_peak = |lag: &usize| alike(*lag) > 0.98 && alike(*lag) >= alike(lag - 1) && alike(*lag) >= alike(lag + 1);
    let repeats = |lag: &usize| {
        let sum: f64 = u[*lag..].iter().zip(u).map(|(a, b)| (a - b).powi(2)).sum();
        (sum / (n - lag) as f64).sqrt() < REPEATS * size
    };
    (SHORTEST..most).filter(is_peak).take(TRIED).find(repeats)
}

/// Measures the noise by stillness: the scatter about a straight line in the quietest stretch in
/// which the input does not change.
fn still(u: Option<&[f64]>, y: &[f64]) -> Option<ReadingNoise> {
    let n = y.len();
    let length = (n / 8).min(STILL[1]);
    if length < STILL[0] {
        return None;
    }
    let size = u.map_or(0.0, |u| mean_sd(u).1);
    let rests = |from: usize| u.is_none_or(|u| u[from..from + length].windows(2).all(|w| w[0] == w[1]) && size > 0.0);
    let scatter = |from: usize| {
        let part = &y[from..from + length];
        let middle = 0.5 * (length - 1) as f64;
        let centre = mean(part);
        let (mut along, mut own) = (0.0, 0.0);
        for (k, v) in part.iter().enumerate() {
            along += (k as f64 - middle) * (v - centre);
            own += (k as f64 - middle).powi(2);
        }
        let slope = along / own;
        let sum: f64 = part.iter().enumerate().map(|(k, v)| (v - centre - slope * (k as f64 - middle)).powi(2)).sum();
        (sum / (length - 2) as f64).sqrt()
    };
    let stretches = (0..=(n - length)).step_by((length / 2).max(1)).filter(|from| rests(*from));
    let deviation = stretches.map(scatter).min_by(f64::total_cmp)?;
    Some(ReadingNoise { deviation, how: How::Still { samples: length } })
}

/// The smallest difference between two readings: the step in which they come, if they come in
/// steps.
fn step(y: &[f64]) -> f64 {
    let mut sorted = y.to_vec();
    order::sort(&mut sorted);
    let gaps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > 0.0);
    gaps.min_by(f64::total_cmp).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        (0..n).map(|_| rng.normal()).collect()
    }

    fn of(u: Option<&[f64]>, y: &[f64]) -> ReadingNoise {
        reading_noise(&Sample { reading: y, input: u, rate_hz: 100.0, hull: [0, y.len()] }).expect("long enough")
    }

    /// A motion of period 40 samples with harmonics, a thousand times the noise.
    fn motion(k: usize) -> f64 {
        let phase = std::f64::consts::TAU * k as f64 / 40.0;
        1000.0 * phase.sin() + 200.0 * (3.0 * phase + 0.4).sin() + 50.0 * (5.0 * phase).cos()
    }

    // White noise of unit size: every way must find 1 within 8 % (five standard errors of the least
    // sure one).
    #[test]
    fn each_way_finds_the_noise_below_a_motion_a_thousand_times_as_large() {
        let e = noise(6000, 1);
        let u: Vec<f64> = (0..6000).map(|k| (std::f64::consts::TAU * k as f64 / 40.0).cos()).collect();
        let y: Vec<f64> = e.iter().enumerate().map(|(k, e)| motion(k) + e).collect();
        let ways = [periods(&u, &y), differences(&y), quietest(&y, 100.0)];
        for way in ways.into_iter().flatten() {
            assert!((way.deviation - 1.0).abs() < 0.08, "{way:?}");
        }
        assert!(matches!(of(Some(&u), &y).how, How::Periods { samples: 40, .. }));
        let rest: Vec<f64> = (0..6000).map(|k| if k < 3000 { e[k] } else { y[k] }).collect();
        let pulsed: Vec<f64> = (0..6000).map(|k| if k < 3000 { 0.0 } else { u[k] * (k as f64).sqrt() }).collect();
        let found = still(Some(&pulsed), &rest).expect("half of it is still");
        assert!((found.deviation - 1.0).abs() < 0.15, "{found:?}");
    }

    // The negative control: what a model would leave unexplained, a drift of the motion's size, is
    // not noise.
    #[test]
    fn what_does_not_repeat_because_it_drifts_is_not_taken_for_noise() {
        let e = noise(6000, 2);
        let u: Vec<f64> = (0..6000).map(|k| (std::f64::consts::TAU * k as f64 / 40.0).cos()).collect();
        let y: Vec<f64> = e.iter().enumerate().map(|(k, e)| motion(k) * (1.0 + 1e-4 * k as f64) + e).collect();
        assert!(periods(&u, &y).is_some_and(|p| p.deviation > 30.0), "the control has no force");
        assert!((of(Some(&u), &y).deviation - 1.0).abs() < 0.08, "{:?}", of(Some(&u), &y));
    }

    // White noise of unit size: over many recordings the quietest band shows 1 in the mean, but for what the
    // expansion about many averages leaves out, 1 %. Without the correction it is 5 % low at 9000 samples.
    #[test]
    fn the_quietest_of_bands_that_are_alike_is_no_quieter() {
        for n in [2000, 9000, 20_000] {
            let all = |seed| quietest(&noise(n, seed), 100.0).map_or(0.0, |q| q.deviation);
            let middle = mean(&(0..200).map(all).collect::<Vec<f64>>());
            assert!((middle - 1.0).abs() < 0.02, "{n}: {middle}");
        }
    }

    // A step of 4 and noise of 0.01 below it: rounding leaves 4/√12.
    #[test]
    fn readings_in_steps_are_no_surer_than_a_step() {
        let e = noise(4000, 3);
        let y: Vec<f64> = (0..4000).map(|k| ((0.05 * motion(k / 8) + 0.01 * e[k]) / 4.0).round() * 4.0).collect();
        assert!(of(None, &y).deviation >= 0.999 * 4.0 / 12f64.sqrt());
    }

    #[test]
    fn a_period_is_exact_or_none() {
        let n = 3000;
        let exact: Vec<f64> = (0..n).map(|k| motion(k % 40)).collect();
        assert_eq!(period(&exact), Some(40));
        assert_eq!(period(&noise(n, 4)), None);
        assert_eq!(period(&vec![1.0; n]), None);
    }
}
