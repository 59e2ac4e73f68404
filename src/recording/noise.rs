//! The noise of a static log in one pass over the file: Allan curve, coefficients and spectrum of
//! every channel, without stray readings and knocks, which are no noise and are reported.
//!
//! Describes; what the coefficients leave out is named by `diagnosis`.

use std::path::Path;

use super::finding;
use super::glitch::Glitch;
use super::health::Watch;
use super::request::Request;
use super::stream::{self, Streamed};
use super::undisturbed::{Undisturbed, Waiting};
use super::unit::Unit;
use crate::error::{Error, Result};
use crate::numerics::allan::covariance::Covariance;
use crate::numerics::allan::fit;
use crate::numerics::allan::fitted::Fit;
use crate::numerics::allan::law::FLICKER_FLOOR;
use crate::numerics::allan::{Accumulator, Point};
use crate::numerics::moments::mean;
use crate::numerics::order;
use crate::numerics::special::{chi_squared_quantile, chi_squared_survival, discoveries};
use crate::numerics::spectrum::{Density, Welch};
use crate::parallel;
use crate::rng::{Philox, Stream};

/// Samples per segment of the spectrum.
const SEGMENT: usize = 4096;

/// An Allan deviation with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan deviation, file units.
    pub value: f64,
    /// 95 % interval from χ² with `degrees_of_freedom` degrees of freedom.
    pub ci95: [f64; 2],
    /// Equivalent degrees of freedom for the fitted mixture of noises.
    pub degrees_of_freedom: f64,
}

/// A spectral line that stands out of its neighbourhood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Density over the median of its neighbourhood.
    pub excess: f64,
}

/// Holds what is known of one channel, in the file's units.
#[derive(Debug)]
pub struct Channel {
    /// Heading of the channel.
    pub name: String,
    /// Unit of its readings.
    pub unit: Unit,
    /// Allan deviations by rising averaging time.
    pub curve: Vec<Deviation>,
    /// Coefficients fitted to the curve less what `lines` contribute; `None` for a constant or very
    /// short channel.
    pub fit: Option<Fit>,
    /// Lowest Allan deviation whose degrees of freedom are at least ten.
    pub minimum: Option<Deviation>,
    /// One-sided power spectral density.
    pub density: Density,
    /// Density near half the rate over that between a tenth and a fifth of it: below one, a filter;
    /// above, aliases.
    pub roll_off: Option<f64>,
    /// Lines, strongest first, at most five.
    pub lines: Vec<Line>,
    /// Step its numbers are rounded to.
    pub step: Option<f64>,
    /// Mean of its readings.
    pub mean: f64,
}

impl Channel {
    /// The point nearest to an averaging time of 1 s, if one is within 5 %: the number that many
    /// tools print as N.
    pub fn at_one_second(&self) -> Option<Deviation> {
        let off = |d: &Deviation| d.tau_s.ln().abs();
        self.curve.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|d| off(d) < 0.05)
    }

    /// Returns whether the curve still falls at its end: neither flicker nor anything slower is
    /// supported, so its lowest point is only where the recording ends.
    pub fn still_falls(&self) -> bool {
        use crate::numerics::allan::law::Term::{Flicker, Ramp, Walk};
        self.fit.as_ref().is_some_and(|fit| {
            fit.good() && ![Flicker, Walk, Ramp].iter().any(|term| fit.coefficients[*term as usize].supported())
        })
    }

    /// B as datasheets state it: the lowest Allan deviation over 0.664, whatever the curve does
    /// around it.
    pub fn bias_stability(&self) -> Option<(f64, [f64; 2])> {
        self.minimum.map(|m| (m.value / FLICKER_FLOOR, m.ci95.map(|e| e / FLICKER_FLOOR)))
    }
}

/// Holds what is known of a static log.
#[derive(Debug)]
pub struct Noise {
    /// File that was read.
    pub source: Streamed,
    /// Channels in the order asked for.
    pub channels: Vec<Channel>,
}

/// Analyses a file of any length in a few megabytes, and a megabyte per channel. `unit_of` gives the unit of each heading.
///
/// # Errors
/// As `stream::read`.
pub fn analyse(path: &Path, request: &Request, unit_of: impl Fn(&str) -> Unit + Sync) -> Result<Noise> {
    let (names, _) = stream::headings(path, request)?;
    let mut meters = names.iter().map(|n| Meter::new(n)).collect::<Option<Vec<Meter>>>().ok_or_else(|| {
        Error::new("could not analyse noise", "segments of the spectrum are too short", "report this as a defect")
    })?;
    let mut waiting = Waiting::default();
    let mut source = stream::read(path, request, |block| {
        waiting.add(block);
        meters.iter_mut().zip(&block.columns).for_each(|(meter, values)| meter.undisturbed.add(values));
        measure(&mut meters, &mut waiting, block.broken_off);
        if block.broken_off {
            meters.iter_mut().for_each(Meter::interrupt);
        }
    })?;
    measure(&mut meters, &mut waiting, true);
    source.findings.extend(meters.iter().flat_map(|m| m.watch.findings()));
    finding::settle(&mut source.findings);
    finding::drawn(&mut source.findings);
    source.findings.extend(meters.iter().zip(&names).flat_map(|(m, name)| m.undisturbed.findings(name)));
    source.findings.extend(meters.iter().zip(&names).filter_map(|(m, name)| m.glitch.finding(name)));
    let channels = parallel::map_indices(meters.len(), |i| {
        meters[i].finish(&names[i], unit_of(&names[i]), source.rate_hz, i as u64)
    });
    Ok(Noise { source, channels })
}

/// Measures the samples that wait as far as a piece is whole; at an end all of them.
fn measure(meters: &mut [Meter], waiting: &mut Waiting, is_end: bool) {
    while let Some(rows) = waiting.piece(is_end) {
        parallel::for_each_mut(meters, |_, meter| {
            // Rounding and rails are those of the readings, whatever is left out of them.
            for (value, row) in meter.undisturbed.waiting(&rows).iter().zip(&rows) {
                match row {
                    Some(_) => meter.watch.push(*value),
                    None => meter.watch.skip(),
                }
            }
            meter.undisturbed.piece(&rows).into_iter().for_each(|v| meter.push(v));
        });
    }
}

/// Describes the noise of values in memory without a stray reading, as [`analyse`] does that of a file; `None` where the
/// segments of the spectrum are too short. `index` tells its random numbers from other channels'.
pub fn describe(name: &str, unit: Unit, (values, rate_hz): (&[f64], f64), index: u64) -> Option<Channel> {
    let mut meter = Meter::new(name)?;
    values.iter().for_each(|v| {
        meter.watch.push(*v);
        meter.push(*v);
    });
    Some(meter.finish(name, unit, rate_hz, index))
}

/// A mean about the first value, so that an offset costs no digits.
#[derive(Debug, Default)]
struct Mean {
    first: Option<f64>,
    beyond: f64,
    count: u64,
}

impl Mean {
    fn push(&mut self, value: f64) {
        self.beyond += value - *self.first.get_or_insert(value);
        self.count += 1;
    }

    /// 0 of no values.
    fn value(&self) -> f64 {
        self.first.unwrap_or(0.0) + self.beyond / self.count.max(1) as f64
    }
}

/// Gathers one channel as it passes.
struct Meter {
    undisturbed: Undisturbed,
    watch: Watch,
    glitch: Glitch,
    allan: Accumulator,
    mean: Mean,
    /// Long and short segments: a short log may not fill a long one.
    spectra: [Welch; 2],
}

impl Meter {
    fn new(name: &str) -> Option<Self> {
        let spectra = [Welch::new(SEGMENT)?, Welch::new(SEGMENT / 16)?];
        Some(Self {
            undisturbed: Undisturbed::default(),
            watch: Watch::new(name),
            glitch: Glitch::default(),
            allan: Accumulator::new(),
            mean: Mean::default(),
            spectra,
        })
    }

    fn push(&mut self, value: f64) {
        self.glitch.push(value);
        self.allan.push(value);
        self.mean.push(value);
        self.spectra.iter_mut().for_each(|s| s.push(value));
    }

    fn interrupt(&mut self) {
        self.glitch.interrupt();
        self.allan.interrupt();
        self.spectra.iter_mut().for_each(Welch::interrupt);
    }

    fn finish(&self, name: &str, unit: Unit, rate_hz: f64, index: u64) -> Channel {
        let points = if self.watch.constant() { Vec::new() } else { self.allan.points(rate_hz) };
        let [long, short] = self.spectra.each_ref().map(|s| s.density(rate_hz));
        let density = if long.averages >= 16.0 { long } else { short };
        let (lines, line_power) = lines(&density);
        let quiet: Vec<Point> = points.iter().map(|p| without_lines(p, &line_power, rate_hz)).collect();
        let tails = self.glitch.tails();
        let fit = fit::fit(&quiet, rate_hz, tails, &mut Philox::new(0, index, Stream::Host));
        // Without a fit, white noise is as good a guess as any.
        let squares = fit.as_ref().map_or([0.0, 1.0, 0.0, 0.0, 0.0], Fit::squares);
        let curve: Vec<Deviation> = points.iter().map(|p| deviation(p, rate_hz, tails, &squares)).collect();
        let sure = curve.iter().copied().filter(|d| d.degrees_of_freedom >= 10.0);
        Channel {
            name: name.into(),
            unit,
            minimum: sure.min_by(|a, b| a.value.total_cmp(&b.value)),
            curve,
            fit,
            roll_off: roll_off(&density, rate_hz),
            lines,
            density,
            step: self.watch.step(),
            mean: self.mean.value(),
        }
    }
}

fn deviation(point: &Point, rate_hz: f64, tails: f64, squares: &[f64; 5]) -> Deviation {
    let covariance = Covariance::new(&[point.factor], &[point.samples], rate_hz).with_tails(tails);
    let degrees_of_freedom = covariance.degrees_of_freedom(0, squares);
    let edge = |probability: f64| {
        (point.variance * degrees_of_freedom / chi_squared_quantile(probability, degrees_of_freedom)).sqrt()
    };
    Deviation { tau_s: point.tau_s, value: point.variance.sqrt(), ci95: [edge(0.975), edge(0.025)], degrees_of_freedom }
}

/// Mean density between two shares of the rate.
fn band(density: &Density, rate_hz: f64, from: f64, to: f64) -> f64 {
    let inside = |f: &f64| (from * rate_hz..to * rate_hz).contains(f);
    let values: Vec<f64> =
        density.frequency_hz.iter().zip(&density.density).filter(|(f, _)| inside(f)).map(|(_, d)| *d).collect();
    mean(&values)
}

/// Told only where it is no accident: five standard errors and 15 %.
fn roll_off(density: &Density, rate_hz: f64) -> Option<f64> {
    let ratio = band(density, rate_hz, 0.4, 0.5) / band(density, rate_hz, 0.1, 0.2);
    let error = (2.0 / (0.1 * density.density.len() as f64 * 2.0 * density.averages)).sqrt();
    ((ratio - 1.0).abs() > 5.0 * error && (ratio - 1.0).abs() > 0.15).then_some(ratio)
}

/// Ordinates at more than three times the median of their neighbourhood (half a frequency to either
/// side, six to twenty-four bins), after false-discovery control; and all power in lines, unit² at
/// each frequency.
fn lines(density: &Density) -> (Vec<Line>, Vec<(f64, f64)>) {
    let degrees_of_freedom = 2.0 * density.averages;
    let count = density.density.len();
    if count < 100 || degrees_of_freedom <= 0.0 {
        return (Vec::new(), Vec::new());
    }
    let middle = chi_squared_quantile(0.5, degrees_of_freedom) / degrees_of_freedom;
    let excess: Vec<f64> = (0..count)
        .map(|i| {
            let half = (i / 2).clamp(6, 24);
            let from = i.saturating_sub(half).min(count - 2 * half - 1);
            let mut around = density.density[from..=from + 2 * half].to_vec();
            density.density[i] * middle / *around.select_nth_unstable_by(half, f64::total_cmp).1
        })
        .collect();
    let p_values: Vec<f64> =
        excess.iter().map(|e| chi_squared_survival(e * degrees_of_freedom, degrees_of_freedom)).collect();
    let found = discoveries(&p_values, 1e-3);
    // The lowest bins belong to drift; one line may be several bins wide.
    let peak = |i: &usize| {
        let near = &excess[i.saturating_sub(4)..(i + 5).min(count)];
        *i >= 8 && found[*i] && excess[*i] > 3.0 && near.iter().all(|e| *e <= excess[*i])
    };
    let mut lines: Vec<Line> =
        (0..count).filter(peak).map(|i| Line { frequency_hz: density.frequency_hz[i], excess: excess[i] }).collect();
    order::sort_by_key(&mut lines, |l| -l.excess);
    let width_hz = density.frequency_hz[0];
    let beyond = |i: usize| density.density[i] * (1.0 - 1.0 / excess[i]) * width_hz;
    let near = |f: f64| lines.iter().any(|l| (l.frequency_hz - f).abs() < 4.5 * width_hz);
    let power = (0..count).filter(|i| found[*i] && excess[*i] > 1.5 && near(density.frequency_hz[*i]));
    let power = power.map(|i| (density.frequency_hz[i], beyond(i))).collect();
    lines.truncate(5);
    (lines, power)
}

/// A point less what lines contribute: a sine of power P adds 2P sin⁴(πfτ)/(m sin(πfτ₀))² to the
/// Allan variance, which at long times looks like quantisation. At least a tenth of the point is
/// left.
fn without_lines(point: &Point, power: &[(f64, f64)], rate_hz: f64) -> Point {
    let m = point.factor as f64;
    let of = |(f, power): &(f64, f64)| {
        let phase = std::f64::consts::PI * f / rate_hz;
        2.0 * power * (phase * m).sin().powi(4) / (m * phase.sin()).powi(2)
    };
    let lines: f64 = power.iter().map(of).sum();
    Point { variance: (point.variance - lines).max(0.1 * point.variance), ..*point }
}
