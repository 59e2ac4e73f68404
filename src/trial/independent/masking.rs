//! Masking: how well an effect at rest is seen next to the others of its recording, a known trend in
//! white noise and in random processes whose laws are known, by generalised least squares.
//!
//! All random processes of the generator are sums of first-order Markov parts. A Kalman filter
//! whose state are these parts makes their sum and the white noise white (Kailath, IEEE Trans.
//! Autom. Control 13 (1968) 646); what it makes of a trend is then weighed row by row, exactly.

use super::linear::left_by;
use super::sizing::coloured_evidence;
use super::still::{Process, Still, relaxations};

/// A first-order Markov part of a noise, in units of the white noise per sample.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Variance at the first row.
    start: f64,
    /// Correlation of neighbours.
    keep: f64,
    /// Variance that a row adds.
    fresh: f64,
}

impl Part {
    /// Of a stationary process.
    fn stationary(variance: f64, keep: f64) -> Self {
        Self { start: variance, keep, fresh: variance * (1.0 - keep * keep) }
    }
}

/// The parts of a random process at this weight; none of a known course.
fn parts(process: &Process, weight: f64, still: &Still) -> Vec<Part> {
    let dt = 1.0 / still.rate_hz;
    let variance = (process.size() * weight).powi(2);
    match *process {
        Process::Flicker { alpha, .. } => relaxations(still.rows, alpha)
            .map(|[tau, size]| Part::stationary(variance * size * size, (-1.0 / tau).exp()))
            .collect(),
        Process::Walk { .. } => vec![Part { start: variance * dt, keep: 1.0, fresh: variance * dt }],
        Process::GaussMarkov { tau, .. } => vec![Part::stationary(variance, (-dt / tau).exp())],
        // Two levels that switch at random have this covariance, though they are not Gaussian.
        Process::Popcorn { dwell, .. } => vec![Part::stationary(variance, (-2.0 * dt / dwell).exp())],
        _ => Vec::new(),
    }
}

/// Columns in which white noise of variance one and these parts become white noise of variance one.
fn whitened(columns: &[Vec<f64>], parts: &[Part]) -> Vec<Vec<f64>> {
    let order = parts.len();
    let mut covariance = vec![vec![0.0; order]; order];
    for (i, part) in parts.iter().enumerate() {
        covariance[i][i] = part.start;
    }
    let mut states = vec![vec![0.0; order]; columns.len()];
    let mut out: Vec<Vec<f64>> = columns.iter().map(|c| Vec::with_capacity(c.len())).collect();
    for row in 0..columns.first().map_or(0, Vec::len) {
        let gain: Vec<f64> = covariance.iter().map(|of| of.iter().sum()).collect();
        let variance = 1.0 + gain.iter().sum::<f64>();
        for ((column, state), out) in columns.iter().zip(&mut states).zip(&mut out) {
            let fresh = column[row] - state.iter().sum::<f64>();
            out.push(fresh / variance.sqrt());
            for ((state, gain), part) in state.iter_mut().zip(&gain).zip(parts) {
                *state = part.keep * (*state + gain * fresh / variance);
            }
        }
        for i in 0..order {
            for j in 0..order {
                let known = covariance[i][j] - gain[i] * gain[j] / variance;
                covariance[i][j] = parts[i].keep * parts[j].keep * known;
            }
            covariance[i][i] += parts[i].fresh;
        }
    }
    out
}

/// Squared signal-to-noise ratio of a matched filter for a course, whose level and other courses
/// are free.
fn seen(course: &[f64], others: &[Vec<f64>], parts: &[Part]) -> f64 {
    let own = std::iter::once(course.to_vec());
    let columns: Vec<Vec<f64>> =
        own.chain(std::iter::once(vec![1.0; course.len()])).chain(others.iter().cloned()).collect();
    let white = whitened(&columns, parts);
    let free: Vec<&[f64]> = white[1..].iter().map(Vec::as_slice).collect();
    left_by(&free, &white[0]).iter().map(|v| v * v).sum()
}

/// Evidence of the n-th process in all channels: of a course next to all others, of a random
/// process next to the courses and white noise.
pub(super) fn evidence(still: &Still, n: usize) -> f64 {
    let others = || (0..still.processes.len()).filter(|k| *k != n);
    let of = |channel: usize| {
        let own = still.effect(n, channel);
        let courses: Vec<Vec<f64>> =
            others().filter(|k| !still.processes[*k].0.is_random()).map(|k| still.effect(k, channel)).collect();
        if still.processes[n].0.is_random() {
            let ones = vec![1.0; own.len()];
            let free: Vec<&[f64]> = std::iter::once(&ones[..]).chain(courses.iter().map(Vec::as_slice)).collect();
            return coloured_evidence(&left_by(&free, &own), 1.0);
        }
        let weighted = |k: usize| parts(&still.processes[k].0, still.processes[k].1[channel], still);
        seen(&own, &courses, &others().flat_map(weighted).collect::<Vec<Part>>())
    };
    (0..still.sigma.len()).map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::independent::draw::Draw;
    use crate::independent::still::flicker;
    use crate::independent::truth::SEEN;

    const ROWS: usize = 8000;

    fn flicker_parts(size: f64) -> Vec<Part> {
        relaxations(ROWS, 1.0).map(|[tau, own]| Part::stationary((size * own).powi(2), (-1.0 / tau).exp())).collect()
    }

    fn rise(by: f64) -> Vec<f64> {
        (0..ROWS).map(|n| by * n as f64 / ROWS as f64).collect()
    }

    // Lag one to lag a hundred of what is left of flicker and white noise is white.
    #[test]
    fn known_noise_becomes_white_of_variance_one() {
        let mut draw = Draw::new(3, 0, 0);
        let noise: Vec<f64> = flicker(ROWS, 1.0, &mut draw).into_iter().map(|v| 2.0 * v + draw.normal()).collect();
        let of = |values: &[f64], lag: usize| {
            let products = values.iter().zip(&values[lag..]).map(|(a, b)| a * b);
            products.sum::<f64>() / (values.len() - lag) as f64
        };
        let white = &whitened(std::slice::from_ref(&noise), &flicker_parts(2.0))[0];
        // Four standard errors, √(2/n) of a variance and 1/√n of a correlation.
        let error = 1.0 / (ROWS as f64).sqrt();
        assert!((of(white, 0) - 1.0).abs() < 4.0 * 2f64.sqrt() * error, "{}", of(white, 0));
        assert!([1, 3, 10, 100].iter().all(|lag| of(white, *lag).abs() < 4.0 * error));
        assert!(of(&noise, 100) > 40.0 * error, "it was not before: control");
    }

    // In white noise a rise by R has the evidence R²·n/12. In flicker of size B the cosine
    // coefficients of a rise, R√(2n)·2/(πk)² at odd k, stand against variances B²n/(πk) each:
    // 8/π³ (1 + 1/3³ + …) (R/B)² = 0.27 (R/B)², whatever the number of rows.
    #[test]
    fn a_rise_hides_beside_flicker_and_shows_in_white_noise() {
        let alone = seen(&rise(1.0), &[], &[]);
        assert!((alone / (ROWS as f64 / 12.0) - 1.0).abs() < 0.01 && alone > SEEN, "in white noise: control");
        let beside = seen(&rise(1.0), &[], &flicker_parts(0.4));
        // The lowest cosines of a finite log are correlated under 1/f: the sum is of the order.
        assert!((0.5..2.0).contains(&(beside / (0.27 / 0.16))), "{beside}");
        assert!(seen(&rise(20.0), &[], &flicker_parts(0.4)) > SEEN, "a rise by much shows beside it as well");
    }

    #[test]
    fn of_two_courses_only_what_the_other_does_not_take_up_is_seen() {
        let same = seen(&rise(1.0), &[rise(-3.0)], &[]);
        assert!(same < 1e-6, "{same}");
        let bend: Vec<f64> = rise(1.0).iter().map(|v| v * v).collect();
        // A line absorbs 15/16 of a parabola on [0, 1]: of 4/45 in variance 1/180 is left.
        let left = seen(&bend, &[rise(1.0)], &[]) / ROWS as f64;
        assert!((left * 180.0 - 1.0).abs() < 0.01, "{left}");
    }
}
