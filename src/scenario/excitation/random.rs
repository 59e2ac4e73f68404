//! Random vibration from a table of power spectral density, as in environmental test standards
//! (MIL-STD-810, DO-160).
//!
//! One seeded realisation, shared by all members: fixed line amplitudes from the table and random
//! phases, so that the realisation's own spectrum and Grms are the table's, and its values are
//! normal by the many lines. Beyond one period (`LONGEST` points) it repeats.

use std::f64::consts::TAU;

use rand::RngExt;
use realfft::num_complex::Complex;

use super::plan::{self, Plan};
use super::reader::{Kind, Reader};
use super::section::Form;
use super::waveform::Waveform;
use crate::error::Result;
use crate::numerics::fourier;
use crate::rng::{Philox, Stream};
use crate::units::STANDARD_GRAVITY_M_S2;

pub(crate) const KIND: Kind = Kind {
    name: "random",
    keys: &[("psd_g2_hz", Form::Pairs)],
    plan: |given| {
        let spectrum = table(given)?;
        let (Some(first), Some(last)) = (spectrum.points.first(), spectrum.points.last()) else {
            return Ok(super::rest::plan());
        };
        let words = format!("random vibration of {:.2} Grms from {} Hz to {} Hz", spectrum.grms(), first.0, last.0);
        let waveform = RandomVibration::new(&spectrum, given.run.duration_s, given.run.seed);
        Ok(Plan::shared(waveform, words, plan::Spectrum::Band(last.0)))
    },
};

/// The table of the section, checked.
fn table(given: &Reader<'_>) -> Result<Spectrum> {
    let points: Vec<(f64, f64)> = given.pairs("psd_g2_hz")?.iter().map(|p| (p[0], p[1])).collect();
    let spectrum = Spectrum { points };
    if !spectrum.is_sound() {
        return Err(given.refuse(
            "`excitation.psd_g2_hz` needs two points or more, frequencies increasing, all numbers above zero",
            "e.g. psd_g2_hz = [[20.0, 0.01], [2000.0, 0.01]] in Hz and g²/Hz",
        ));
    }
    Ok(spectrum)
}

/// Points per cycle of the highest line; cubic interpolation between them then errs by less than
/// 0.3 % there.
const OVERSAMPLING: f64 = 10.0;
/// Longest period kept, in points (32 MiB).
const LONGEST: usize = 1 << 22;

/// One-sided power spectral density over frequency, straight lines on log-log axes between its
/// points, zero outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// (frequency in Hz, density in g²/Hz), frequencies increasing, both positive, at least two
    /// points.
    pub points: Vec<(f64, f64)>,
}

impl Spectrum {
    /// Returns whether it has two points or more, increasing and positive.
    pub fn is_sound(&self) -> bool {
        let increasing = self.points.windows(2).all(|w| w[0].0 < w[1].0);
        let positive = self.points.iter().all(|(f, p)| *f > 0.0 && *p > 0.0 && f.is_finite() && p.is_finite());
        self.points.len() >= 2 && increasing && positive
    }

    /// Density at a frequency, g²/Hz.
    pub(crate) fn density_g2_hz(&self, frequency_hz: f64) -> f64 {
        let segment = self.points.windows(2).find(|w| frequency_hz >= w[0].0 && frequency_hz <= w[1].0);
        segment.map_or(0.0, |w| {
            let slope = (w[1].1 / w[0].1).ln() / (w[1].0 / w[0].0).ln();
            w[0].1 * (frequency_hz / w[0].0).powf(slope)
        })
    }

    /// Root of the area under the table, g.
    pub(crate) fn grms(&self) -> f64 {
        let area = |w: &[(f64, f64)]| {
            let ((f0, p0), (f1, p1)) = (w[0], w[1]);
            let slope = (p1 / p0).ln() / (f1 / f0).ln();
            // ∫ p0 (f/f0)^m df; at m = −1 the power law integrates to a logarithm.
            match (slope + 1.0).abs() < 1e-9 {
                true => p0 * f0 * (f1 / f0).ln(),
                false => (p1 * f1 - p0 * f0) / (slope + 1.0),
            }
        };
        self.points.windows(2).map(area).sum::<f64>().sqrt()
    }
}

/// A stationary vibration with a stated spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomVibration {
    samples_m_s2: Vec<f64>,
    rate_hz: f64,
}

impl RandomVibration {
    /// A realisation for a run of `length_s`.
    pub fn new(spectrum: &Spectrum, length_s: f64, seed: u64) -> Self {
        let highest_hz = spectrum.points.last().map_or(1.0, |p| p.0);
        let lowest_hz = spectrum.points.first().map_or(1.0, |p| p.0);
        let rate_hz = OVERSAMPLING * highest_hz;
        // At least forty periods of the lowest line, so that short runs still hold enough lines.
        let points = (length_s.max(40.0 / lowest_hz) * rate_hz).ceil().min(LONGEST as f64) as usize;
        let points = points.next_power_of_two();
        let spacing_hz = rate_hz / points as f64;
        let mut rng = Philox::new(seed, 0, Stream::Excitation);
        let line = |k: usize| {
            let phase_rad = TAU * rng.random::<f64>();
            let density = spectrum.density_g2_hz(k as f64 * spacing_hz);
            // A line of amplitude A carries A²/2 = density × spacing; realfft's inverse sums both
            // halves unscaled.
            Complex::from_polar(0.5 * STANDARD_GRAVITY_M_S2 * (2.0 * density * spacing_hz).sqrt(), phase_rad)
        };
        let mut lines: Vec<Complex<f64>> = (0..=points / 2).map(line).collect();
        // A real signal has real ends; the table is zero there.
        lines[0] = Complex::ZERO;
        lines[points / 2] = Complex::ZERO;
        let mut samples_m_s2 = vec![0.0; points];
        // Fails only on wrong lengths or complex ends, both excluded above.
        let _ = fourier::inverse(points).process(&mut lines, &mut samples_m_s2);
        Self { samples_m_s2, rate_hz }
    }
}

impl Waveform for RandomVibration {
    fn before_m_s2(&self) -> f64 {
        0.0
    }

    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let points = self.samples_m_s2.len();
        let place = time_s * self.rate_hz;
        let before = place.floor();
        let u = place - before;
        let start = (before as i64).rem_euclid(points as i64) as usize;
        let at = |offset: usize| self.samples_m_s2[(start + points + offset - 1) % points];
        // Four-point Lagrange cubic.
        let (a, b, c, d) = (at(0), at(1), at(2), at(3));
        b + u * (c - a / 3.0 - b / 2.0 - d / 6.0 + u * (a / 2.0 - b + c / 2.0 + u * ((b - c) / 2.0 + (d - a) / 6.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::spectrum;

    // NAVMAT P-9492: 20 Hz 0.01, 80–350 Hz 0.04, 2000 Hz 0.007 g²/Hz; published as 6.06 Grms.
    fn navmat() -> Spectrum {
        Spectrum { points: vec![(20.0, 0.01), (80.0, 0.04), (350.0, 0.04), (2000.0, 0.007)] }
    }

    #[test]
    fn the_area_of_a_published_profile_is_its_published_grms() {
        assert!((navmat().grms() - 6.06).abs() < 0.03, "{}", navmat().grms());
        let pink = Spectrum { points: vec![(10.0, 0.1), (100.0, 0.01)] };
        assert!((pink.grms().powi(2) - 10f64.ln()).abs() < 1e-9);
    }

    #[test]
    fn the_realisation_has_the_tables_grms_and_spectrum() {
        let table = navmat();
        let vibration = RandomVibration::new(&table, 4.0, 3);
        let (rate_hz, n) = (16_384.0, 65_536);
        let g: Vec<f64> =
            (0..n).map(|k| vibration.specific_force_m_s2(k as f64 / rate_hz) / STANDARD_GRAVITY_M_S2).collect();
        let rms = (g.iter().map(|v| v * v).sum::<f64>() / n as f64).sqrt();
        assert!((rms / table.grms() - 1.0).abs() < 0.03, "{rms}");
        // Welch: Hann window, half overlap, 2048 points (8 Hz bins), 63 segments: 14 % scatter per
        // bin, less in bands.
        let welch = spectrum::welch(&g, rate_hz, 2048);
        for band in [(48.0, 80.0), (100.0, 300.0), (400.0, 800.0), (1000.0, 1900.0)] {
            let bins = welch.frequency_hz.iter().zip(&welch.density).filter(|(f, _)| (band.0..band.1).contains(*f));
            let (got, want, count) =
                bins.fold((0.0, 0.0, 0), |(g, w, c), (f, density)| (g + density, w + table.density_g2_hz(*f), c + 1));
            let scatter = 0.14 / f64::from(count).sqrt();
            assert!((got / want - 1.0f64).abs() < 4.0 * scatter + 0.01, "{band:?}: {got} {want}");
        }
        let above = welch.frequency_hz.iter().zip(&welch.density).filter(|(f, _)| **f >= 2160.0);
        let outside = above.map(|(_, density)| *density).fold(0.0, f64::max);
        assert!(outside < 1e-3 * 0.007, "above the table: {outside}");
    }
}
