//! Noise in motion beyond the static figure, with its lines: spectra of the readings where no body
//! moves any more.

use nalgebra::Vector3;

use crate::numerics::order;
use crate::numerics::special::chi_squared_survival;
use crate::numerics::spectrum::welch;

/// Below this no spectrum of readings is taken for vibration, Hz: bodies move.
const MOVES_HZ: f64 = 10.0;
/// Spectral density over that of the static figure from which the difference is one.
const BEYOND: f64 = 4.0;
/// Density of a line over the median of its neighbours, and number of neighbours on each side.
const LINE: (f64, usize) = (12.0, 12);
/// Lines that are told.
const MOST: usize = 3;
/// Samples of a segment.
const SEGMENT: usize = 512;

/// Vibration of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Vibration {
    /// Root of the mean density above 10 Hz, one-sided, unit/√Hz.
    pub density: f64,
    /// 95 % interval of the size.
    pub ci95: [f64; 2],
    /// The static figure, where one is stated, unit/√Hz.
    pub stated: Option<f64>,
    /// From one frequency of the spectrum to the next, Hz.
    pub step_hz: f64,
    /// Lines: frequency, Hz, and amplitude, unit.
    pub lines: Vec<(f64, f64)>,
    /// Chance that noise of the static figure, or without lines, shows as much.
    pub p_value: f64,
}

/// Spectrum of a sensor: mean of its axes, as (Hz, unit²/Hz).
pub fn spectrum(readings: &[Vector3<f64>], rate_hz: f64) -> (Vec<(f64, f64)>, f64) {
    let segment = SEGMENT.min(readings.len());
    let axes: Vec<_> =
        (0..3).map(|i| welch(&readings.iter().map(|r| r[i]).collect::<Vec<f64>>(), rate_hz, segment)).collect();
    let mean = |k: usize| axes.iter().map(|a| a.density[k]).sum::<f64>() / 3.0;
    (axes[0].frequency_hz.iter().enumerate().map(|(k, hz)| (*hz, mean(k))).collect(), axes[0].averages)
}

/// Returns what the readings show beyond a stated density, or as lines; none where neither.
pub fn vibration(readings: &[Vector3<f64>], rate_hz: f64, stated: Option<f64>) -> Option<Vibration> {
    let (spectrum, averages) = spectrum(readings, rate_hz);
    let above: Vec<(f64, f64)> =
        spectrum.into_iter().filter(|(hz, _)| *hz > MOVES_HZ && *hz < 0.48 * rate_hz).collect();
    if above.len() < 4 * LINE.1 {
        return None;
    }
    let mean = above.iter().map(|l| l.1).sum::<f64>() / above.len() as f64;
    let (lines, highest) = lines(&above);
    let louder = stated.is_some_and(|density| mean > BEYOND * density * density);
    let half = 1.96 / (3.0 * averages * above.len() as f64).sqrt();
    let density = mean.sqrt();
    // Sums of squares of as many normal numbers as the averages of three axes hold.
    let normal = 6.0 * averages;
    let level = stated.map_or(1.0, |stated| {
        let many = normal * above.len() as f64;
        chi_squared_survival(many * mean / (stated * stated).max(f64::MIN_POSITIVE), many)
    });
    let line = above.len() as f64 * chi_squared_survival(normal * highest, normal);
    let p_value = (2.0 * level.min(line)).clamp(f64::MIN_POSITIVE, 1.0);
    (louder || !lines.is_empty()).then(|| Vibration {
        density,
        ci95: [density * (1.0 - 0.5 * half), density * (1.0 + 0.5 * half)],
        stated,
        step_hz: above[1].0 - above[0].0,
        lines,
        p_value,
    })
}

/// Narrow peaks, strongest first, and the highest line over the median of its neighbours.
fn lines(spectrum: &[(f64, f64)]) -> (Vec<(f64, f64)>, f64) {
    let step_hz = spectrum[1].0 - spectrum[0].0;
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut highest: f64 = 0.0;
    for k in LINE.1..spectrum.len() - LINE.1 {
        let near = &spectrum[k - LINE.1..=k + LINE.1];
        let usual = order::median(near.iter().map(|l| l.1).collect()).unwrap_or_default();
        highest = highest.max(spectrum[k].1 / usual.max(f64::MIN_POSITIVE));
        let is_top = spectrum[k].1 >= spectrum[k - 1].1 && spectrum[k].1 >= spectrum[k + 1].1;
        if is_top && spectrum[k].1 > LINE.0 * usual {
            let power: f64 = spectrum[k - 2..=k + 2].iter().map(|l| (l.1 - usual).max(0.0) * step_hz).sum();
            // Of the three axes together.
            found.push((spectrum[k].0, (6.0 * power).sqrt()));
        }
    }
    order::sort_by_key(&mut found, |l| -l.1);
    found.truncate(MOST);
    (found, highest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    fn readings(density: f64, line: f64) -> Vec<Vector3<f64>> {
        let mut random = Philox::new(4, 0, Stream::Host);
        // One-sided n over half the rate: σ = n √(f/2).
        let deviation = density * 10.0;
        (0..8000)
            .map(|k| {
                let swing = line * (f64::from(k) / 200.0 * 47.0 * std::f64::consts::TAU).sin();
                Vector3::new(swing, 0.0, 0.0) + Vector3::from_fn(|_, _| deviation * random.normal())
            })
            .collect()
    }

    #[test]
    fn louder_noise_and_lines_are_seen_and_the_static_figure_alone_is_none() {
        assert_eq!(vibration(&readings(1e-3, 0.0), 200.0, Some(1e-3)), None);
        let louder = vibration(&readings(3e-3, 0.0), 200.0, Some(1e-3)).expect("louder");
        assert!((louder.density / 3e-3 - 1.0).abs() < 0.03 && louder.lines.is_empty(), "{louder:?}");
        let line = vibration(&readings(1e-3, 0.02), 200.0, None).expect("a line");
        let (hz, amplitude) = line.lines[0];
        assert!((hz - 47.0).abs() < 0.5 && (amplitude / 0.02 - 1.0).abs() < 0.15, "{line:?}");
    }
}
