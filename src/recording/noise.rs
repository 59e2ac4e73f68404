//! The noise of a static log in one pass over the file: Allan curve, coefficients and spectrum of every channel.
//!
//! Describes; what the coefficients leave out is named by `diagnosis`.

use std::path::Path;

use rayon::prelude::*;

use super::Request;
use super::health::Watch;
use super::stream::{self, Event, Streamed};
use super::unit::Unit;
use crate::error::{Error, Result};
use crate::numerics::allan::covariance::Covariance;
use crate::numerics::allan::fit::{self, Fit};
use crate::numerics::allan::law::FLICKER_FLOOR;
use crate::numerics::allan::{Accumulator, Point};
use crate::numerics::special::{chi_squared_above, chi_squared_quantile, discoveries};
use crate::numerics::spectrum::{Density, Welch};
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
    /// 95 % interval from χ² with `freedom` degrees.
    pub ci95: [f64; 2],
    /// Equivalent degrees of freedom for the fitted mixture of noises.
    pub freedom: f64,
}

/// A spectral line that stands out of its neighbourhood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency.
    pub frequency_hz: f64,
    /// Density over the median of its neighbourhood.
    pub excess: f64,
}

/// What is known of one channel, in the file's units.
#[derive(Debug)]
pub struct Channel {
    /// Heading.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Allan deviations by rising averaging time.
    pub curve: Vec<Deviation>,
    /// Fitted coefficients; `None` for a constant or very short channel.
    pub fit: Option<Fit>,
    /// Lowest Allan deviation whose degrees of freedom are at least ten.
    pub minimum: Option<Deviation>,
    /// One-sided density.
    pub density: Density,
    /// Density near half the rate over that between a tenth and a fifth of it: below one, a filter; above, aliases.
    pub roll_off: Option<f64>,
    /// Lines, strongest first, at most five.
    pub lines: Vec<Line>,
    /// Step its numbers are rounded to.
    pub step: Option<f64>,
}

impl Channel {
    /// B as datasheets state it: the lowest Allan deviation over 0.664, whatever the curve does around it.
    pub fn bias_stability(&self) -> Option<(f64, [f64; 2])> {
        self.minimum.map(|m| (m.value / FLICKER_FLOOR, m.ci95.map(|e| e / FLICKER_FLOOR)))
    }
}

/// What is known of a static log.
#[derive(Debug)]
pub struct Noise {
    /// The file.
    pub source: Streamed,
    /// Channels in the order asked for.
    pub channels: Vec<Channel>,
}

/// Analyses a file of any length in a few megabytes. `unit_of` gives the unit of each heading.
///
/// # Errors
/// As `stream::read`.
pub fn analyse(path: &Path, request: &Request, unit_of: impl Fn(&str) -> Unit + Sync) -> Result<Noise> {
    let names = stream::headings(path, request)?;
    let mut meters = names.iter().map(|n| Meter::new(n)).collect::<Option<Vec<Meter>>>().ok_or_else(|| {
        Error::new("could not analyse noise", "segments of the spectrum are too short", "report this as a defect")
    })?;
    let mut source = stream::read(path, request, |event| match event {
        Event::Sample(values) => meters.iter_mut().zip(values).for_each(|(m, v)| m.push(*v)),
        Event::Break => meters.iter_mut().for_each(Meter::interrupt),
    })?;
    source.findings.extend(meters.iter().flat_map(|m| m.watch.findings()));
    let channels = meters
        .into_par_iter()
        .zip(&names)
        .enumerate()
        .map(|(index, (meter, name))| meter.finish(name, unit_of(name), source.rate_hz, index as u64))
        .collect();
    Ok(Noise { source, channels })
}

/// Gathers one channel as it passes.
struct Meter {
    watch: Watch,
    allan: Accumulator,
    /// Long and short segments: a short log may not fill a long one.
    spectra: [Welch; 2],
}

impl Meter {
    fn new(name: &str) -> Option<Self> {
        let spectra = [Welch::new(SEGMENT)?, Welch::new(SEGMENT / 16)?];
        Some(Self { watch: Watch::new(name), allan: Accumulator::new(), spectra })
    }

    fn push(&mut self, value: f64) {
        self.watch.push(value);
        self.allan.push(value);
        self.spectra.iter_mut().for_each(|s| s.push(value));
    }

    fn interrupt(&mut self) {
        self.allan.interrupt();
        self.spectra.iter_mut().for_each(Welch::interrupt);
    }

    fn finish(self, name: &str, unit: Unit, rate_hz: f64, index: u64) -> Channel {
        let points = if self.watch.constant() { Vec::new() } else { self.allan.points(rate_hz) };
        let fit = fit::fit(&points, rate_hz, &mut Philox::new(0, index, Stream::Host));
        // Without a fit, white noise is as good a guess as any.
        let squares = fit.as_ref().map_or([0.0, 1.0, 0.0, 0.0, 0.0], Fit::squares);
        let curve: Vec<Deviation> = points.iter().map(|p| deviation(p, rate_hz, &squares)).collect();
        let sure = curve.iter().copied().filter(|d| d.freedom >= 10.0);
        let [long, short] = self.spectra.map(|s| s.density(rate_hz));
        let density = if long.averages >= 16.0 { long } else { short };
        Channel {
            name: name.into(),
            unit,
            minimum: sure.min_by(|a, b| a.value.total_cmp(&b.value)),
            curve,
            fit,
            roll_off: roll_off(&density, rate_hz),
            lines: lines(&density),
            density,
            step: self.watch.step(),
        }
    }
}

fn deviation(point: &Point, rate_hz: f64, squares: &[f64; 5]) -> Deviation {
    let freedom = Covariance::new(&[point.factor], &[point.samples], rate_hz).freedom(0, squares);
    let edge = |probability: f64| (point.variance * freedom / chi_squared_quantile(probability, freedom)).sqrt();
    Deviation { tau_s: point.tau_s, value: point.variance.sqrt(), ci95: [edge(0.975), edge(0.025)], freedom }
}

/// Mean density between two shares of the rate.
fn band(density: &Density, rate_hz: f64, from: f64, to: f64) -> f64 {
    let inside = |f: &f64| (from * rate_hz..to * rate_hz).contains(f);
    let values: Vec<f64> =
        density.frequency_hz.iter().zip(&density.density).filter(|(f, _)| inside(f)).map(|(_, d)| *d).collect();
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Told only where it is no accident: five standard errors and 15 %.
fn roll_off(density: &Density, rate_hz: f64) -> Option<f64> {
    let ratio = band(density, rate_hz, 0.4, 0.5) / band(density, rate_hz, 0.1, 0.2);
    let error = (2.0 / (0.1 * density.density.len() as f64 * 2.0 * density.averages)).sqrt();
    ((ratio - 1.0).abs() > 5.0 * error && (ratio - 1.0).abs() > 0.15).then_some(ratio)
}

/// Ordinates at more than three times the median of the forty-eight around them, after false-discovery control.
fn lines(density: &Density) -> Vec<Line> {
    const AROUND: usize = 24;
    let freedom = 2.0 * density.averages;
    let count = density.density.len();
    if count < 4 * AROUND || freedom <= 0.0 {
        return Vec::new();
    }
    let middle = chi_squared_quantile(0.5, freedom) / freedom;
    let excess: Vec<f64> = (0..count)
        .map(|i| {
            let from = i.saturating_sub(AROUND).min(count - 2 * AROUND - 1);
            let mut around = density.density[from..=from + 2 * AROUND].to_vec();
            density.density[i] * middle / *around.select_nth_unstable_by(AROUND, f64::total_cmp).1
        })
        .collect();
    let p_values: Vec<f64> = excess.iter().map(|e| chi_squared_above(e * freedom, freedom)).collect();
    let found = discoveries(&p_values, 1e-3);
    // The lowest bins belong to drift.
    let peak = |i: &usize| {
        *i >= AROUND
            && found[*i]
            && excess[*i] > 3.0
            && excess[*i] >= excess[*i - 1]
            && excess.get(*i + 1) <= Some(&excess[*i])
    };
    let mut lines: Vec<Line> =
        (0..count).filter(peak).map(|i| Line { frequency_hz: density.frequency_hz[i], excess: excess[i] }).collect();
    lines.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    lines.truncate(5);
    lines
}
