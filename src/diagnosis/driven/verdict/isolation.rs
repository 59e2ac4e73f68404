//! Finds where the base model's error exceeds the noise: in time, in frequency, in amplitude; each
//! with its excess and a false discovery rate.

use std::ops::Range;

use crate::answer::Places;
use crate::driven::selection::residual_structure::correlation;
use crate::number::short;
use crate::numerics::{order, special, spectrum};
use crate::verdict::Stretch;

/// Share of the stretches named that may be chance (Benjamini & Hochberg 1995).
const FALSE_DISCOVERY: f64 = 0.05;
/// Lags over which errors of free simulation, which ring, are taken to be correlated.
const LAGS: usize = 400;
const TIMES: usize = 24;
const STATES: usize = 10;
const BANDS: usize = 16;
/// Excess below which a stretch is not worth naming.
const LEAST: f64 = 1.2;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Compared<'a> {
    /// Error of the base model, sample by sample.
    pub error: &'a [f64],
    /// Standard deviation of the noise of the reading, measured apart from every fit.
    pub noise: f64,
    /// Displacement that the model passes through.
    pub state: &'a [f64],
    pub rate_hz: f64,
    /// Unit of the reading.
    pub unit: &'a str,
}

/// Excess everywhere, neighbouring stretches joined; in words; and whether the error's power is
/// that of the noise.
pub(crate) fn locate(c: &Compared<'_>, from: usize) -> (Places, String, bool) {
    let n = c.error.len().min(c.state.len());
    if n < 64 {
        return (Places::default(), "too short to locate the mismatch".into(), false);
    }
    let power = |v: &[f64]| v.iter().map(|e| e * e).sum::<f64>() / v.len().max(1) as f64;
    let floor = c.noise.powi(2).max(1e-300);
    let mean = power(&c.error[..n]) / floor;
    let second = |k: usize| (from + k) as f64 / c.rate_hz;
    let times: Vec<(Range<f64>, f64, f64)> = (0..TIMES)
        .map(|i| (n * i / TIMES, n * (i + 1) / TIMES))
        .map(|(a, b)| (second(a)..second(b), power(&c.error[a..b]) / floor, independent(&c.error[a..b])))
        .collect();
    let order = order::ranked(&c.state[..n]);
    let states: Vec<(Range<f64>, f64, f64)> = (0..STATES)
        .map(|i| &order[n * i / STATES..n * (i + 1) / STATES])
        .map(|part| {
            let sum: f64 = part.iter().map(|k| c.error[*k].powi(2)).sum::<f64>() / part.len() as f64;
            let ends = c.state[part[0]]..c.state[part[part.len() - 1]];
            (ends, sum / floor, part.len() as f64 / correlation(c.error, LAGS))
        })
        .collect();
    let segment = (n / 8).clamp(64, 4096);
    let before = spectrum::welch(&c.error[..n], c.rate_hz, segment);
    let bins = before.density.len();
    // One-sided density of white noise.
    let flat = 2.0 * floor / c.rate_hz;
    let bands: Vec<(Range<f64>, f64, f64)> = (0..BANDS)
        .map(|i| (bins * i / BANDS, (bins * (i + 1) / BANDS).max(bins * i / BANDS + 1).min(bins)))
        .filter(|(a, b)| a < b)
        .map(|(a, b)| {
            let sum: f64 = before.density[a..b].iter().sum::<f64>() / (b - a) as f64;
            let ends = before.frequency_hz[a]..before.frequency_hz[b - 1];
            (ends, sum / flat.max(1e-300), before.averages * (b - a) as f64 * 2.0)
        })
        .collect();
    let (time_s, frequency_hz, state) = (named(&times), named(&bands), named(&states));
    let summary = if mean < LEAST {
        "the base model's residual is at the noise level everywhere".to_owned()
    } else {
        summary(mean, &frequency_hz, &state, &time_s, c.unit)
    };
    (Places { time_s, frequency_hz, state, ..Places::default() }, summary, mean < LEAST)
}

fn summary(mean: f64, frequency: &[Stretch], state: &[Stretch], time: &[Stretch], unit: &str) -> String {
    let most = |all: &[Stretch]| all.iter().copied().max_by(|a, b| a.excess.total_cmp(&b.excess));
    let mut words = format!("the base model's residual has {} times the power of the noise", short(mean));
    if let Some(f) = most(frequency) {
        words += &format!(", most between {} and {} Hz", short(f.from), short(f.to));
    }
    if let Some(s) = most(state) {
        words += &format!(", at displacements from {} to {} {unit}", short(s.from), short(s.to));
    }
    if let Some(t) = most(time) {
        words += &format!(", strongest from {} to {} s", short(t.from), short(t.to));
    }
    words
}

fn independent(values: &[f64]) -> f64 {
    (values.len() as f64 / correlation(values, LAGS)).max(2.0)
}

/// Stretches above the noise after false-discovery control, neighbours of like excess joined.
fn named(all: &[(Range<f64>, f64, f64)]) -> Vec<Stretch> {
    let p: Vec<f64> = all
        .iter()
        .map(|(_, excess, degrees_of_freedom)| {
            special::chi_squared_survival(excess * degrees_of_freedom, *degrees_of_freedom)
        })
        .collect();
    let found = special::discoveries(&p, FALSE_DISCOVERY);
    let mut out: Vec<Stretch> = Vec::new();
    let mut open = false;
    for ((range, excess, _), found) in all.iter().zip(found) {
        if !found || *excess < LEAST || !excess.is_finite() {
            open = false;
            continue;
        }
        match out.last_mut() {
            Some(last) if open && (excess / last.excess).ln().abs() < 0.5 => {
                let (a, b) = (last.to - last.from, range.end - range.start);
                last.excess = (last.excess * a + excess * b) / (a + b).max(1e-300);
                last.to = range.end;
            }
            _ => out.push(Stretch { from: range.start, to: range.end, excess: *excess }),
        }
        open = true;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_number_in_words_has_a_minus_sign_and_no_hyphen() {
        let stretch = |from: f64, to: f64| [Stretch { from, to, excess: 9.0 }];
        let said = summary(9.0, &stretch(1.0, 2.0), &stretch(-0.25, -1.5e-7), &stretch(-3.0, 4.0), "V");
        assert!(said.contains("from −0.250 to −1.50×10⁻⁷ V") && said.contains("from −3.00 to 4.00 s"), "{said}");
        assert!(!said.contains('-'), "{said}");
    }
}
