//! The best linear proof mass for an output: what a base model can hide, measured without the tool.
//!
//! ω₀ and ζ by Gauss–Newton; gain, offset and initial state, which enter linearly, by least squares
//! within each step.

use nalgebra::{DMatrix, DVector};

/// Input on half-steps and the output on samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window<'a> {
    /// `2·substeps·(samples − 1) + 1` values; empty for a ring-down.
    pub input: &'a [f64],
    /// Output, one value per sample.
    pub output: &'a [f64],
    /// Integration steps per sample.
    pub substeps: usize,
    pub rate_hz: f64,
}

/// A fitted base model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Natural frequency ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio ζ.
    pub zeta: f64,
    /// Output unit per input unit and s²; zero for a ring-down.
    pub gain: f64,
    /// Reading at rest, output unit.
    pub offset: f64,
    /// Displacement and velocity at the first sample.
    pub start: [f64; 2],
    /// Output minus model, sample by sample.
    pub residual: Vec<f64>,
}

impl Fit {
    /// Root mean square of the residual.
    pub fn rms(&self) -> f64 {
        (self.residual.iter().map(|r| r * r).sum::<f64>() / self.residual.len().max(1) as f64).sqrt()
    }
}

/// Responses to the input alone (unit gain) and to a unit initial displacement and velocity.
fn responses(w: &Window<'_>, omega: f64, zeta: f64) -> [Vec<f64>; 3] {
    let h = 1.0 / (w.rate_hz * w.substeps as f64);
    let (k, c) = (omega * omega, 2.0 * zeta * omega);
    // One classical Runge–Kutta step is a linear map of the state and of the input at its start,
    // middle and end.
    let step = |s: [f64; 2], u: [f64; 3]| {
        let d = |s: [f64; 2], u: f64| [s[1], u - c * s[1] - k * s[0]];
        let along = |g: [f64; 2], by: f64| [s[0] + by * g[0], s[1] + by * g[1]];
        let k1 = d(s, u[0]);
        let k2 = d(along(k1, h / 2.0), u[1]);
        let k3 = d(along(k2, h / 2.0), u[1]);
        let k4 = d(along(k3, h), u[2]);
        [0, 1].map(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    };
    // Over a whole sample: the map of the state, and the weight of each input value, found by unit
    // impulses.
    let whole = |s: [f64; 2], at: Option<usize>| {
        (0..w.substeps).fold(s, |s, j| step(s, [0, 1, 2].map(|i| if at == Some(2 * j + i) { 1.0 } else { 0.0 })))
    };
    let (from_x, from_v) = (whole([1.0, 0.0], None), whole([0.0, 1.0], None));
    let weights: Vec<[f64; 2]> = (0..=2 * w.substeps).map(|i| whole([0.0, 0.0], Some(i))).collect();
    let count = w.output.len();
    let free = |mut s: [f64; 2]| {
        let mut x = Vec::with_capacity(count);
        for _ in 0..count {
            x.push(s[0]);
            s = [0, 1].map(|i| from_x[i] * s[0] + from_v[i] * s[1]);
        }
        x
    };
    let mut forced = Vec::new();
    if !w.input.is_empty() {
        let mut s = [0.0; 2];
        for n in 0..count {
            forced.push(s[0]);
            if n + 1 < count {
                let u = &w.input[2 * w.substeps * n..=2 * w.substeps * (n + 1)];
                let pushed = u.iter().zip(&weights).fold([0.0; 2], |p, (u, g)| [p[0] + u * g[0], p[1] + u * g[1]]);
                s = [0, 1].map(|i| from_x[i] * s[0] + from_v[i] * s[1] + pushed[i]);
            }
        }
    }
    [forced, free([1.0, 0.0]), free([0.0, 1.0])]
}

/// Least squares by normal equations with columns scaled to one; None where they are singular.
fn solve(columns: &[&[f64]], target: &[f64]) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let norms: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt().max(f64::MIN_POSITIVE)).collect();
    let n = columns.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| {
        // A whisper of ridge keeps a fully decayed free response from making the system singular.
        dot(columns[i], columns[j]) / (norms[i] * norms[j]) + if i == j { 1e-12 } else { 0.0 }
    });
    let right = DVector::from_fn(n, |i, _| dot(columns[i], target) / norms[i]);
    let solution = matrix.cholesky()?.solve(&right);
    Some(solution.iter().zip(&norms).map(|(s, n)| s / n).collect())
}

/// Linear parameters for given ω₀ and ζ: gain (0 for a ring-down), offset, x₀, v₀.
fn linear(w: &Window<'_>, parts: &[Vec<f64>; 3]) -> Option<[f64; 4]> {
    let ones = vec![1.0; w.output.len()];
    let mut columns: Vec<&[f64]> = vec![&ones, &parts[1], &parts[2]];
    if !parts[0].is_empty() {
        columns.push(&parts[0]);
    }
    let c = solve(&columns, w.output)?;
    Some([c.get(3).copied().unwrap_or(0.0), c[0], c[1], c[2]])
}

fn combine(parts: &[Vec<f64>; 3], c: [f64; 4]) -> Vec<f64> {
    (0..parts[1].len())
        .map(|n| c[0] * parts[0].get(n).unwrap_or(&0.0) + c[1] + c[2] * parts[1][n] + c[3] * parts[2][n])
        .collect()
}

/// Refines ω₀ and ζ from a start that is near; None when nothing fits at all (not finite,
/// singular).
pub(super) fn refine(w: &Window<'_>, mut omega: f64, mut zeta: f64, rounds: usize) -> Option<Fit> {
    let evaluate = |omega: f64, zeta: f64| {
        let parts = responses(w, omega, zeta);
        let c = linear(w, &parts)?;
        let residual: Vec<f64> = combine(&parts, c).iter().zip(w.output).map(|(m, y)| y - m).collect();
        let fit = Fit { omega_rad_s: omega, zeta, gain: c[0], offset: c[1], start: [c[2], c[3]], residual };
        fit.rms().is_finite().then_some((fit, parts))
    };
    let (mut best, mut parts) = evaluate(omega, zeta)?;
    for _ in 0..rounds {
        let c = [best.gain, best.offset, best.start[0], best.start[1]];
        let model = combine(&parts, c);
        let slope = |o: f64, z: f64, by: f64| -> Vec<f64> {
            combine(&responses(w, o, z), c).iter().zip(&model).map(|(a, b)| (a - b) / by).collect()
        };
        let by = 1e-5;
        let (to_omega, to_zeta) = (slope(omega * (1.0 + by), zeta, by), slope(omega, zeta * (1.0 + by), by));
        let ones = vec![1.0; w.output.len()];
        let mut columns: Vec<&[f64]> = vec![&to_omega, &to_zeta, &ones, &parts[1], &parts[2]];
        if !parts[0].is_empty() {
            columns.push(&parts[0]);
        }
        let step = solve(&columns, &best.residual)?;
        let mut step_scale = 1.0;
        let before = best.rms();
        loop {
            let o = omega * (step_scale * step[0]).clamp(-0.5, 0.5).exp();
            let z = zeta * (step_scale * step[1]).clamp(-1.0, 1.0).exp();
            match evaluate(o, z) {
                Some((fit, next)) if fit.rms() <= before => {
                    (omega, zeta, best, parts) = (o, z, fit, next);
                    break;
                }
                _ if step_scale < 0.05 => return Some(best),
                _ => step_scale *= 0.4,
            }
        }
        if best.rms() > before * (1.0 - 1e-4) {
            break;
        }
    }
    Some(best)
}

/// Fits without a start: the best of a grid over resonance and damping is refined.
pub(crate) fn search(w: &Window<'_>, hint: Option<[f64; 2]>) -> Option<Fit> {
    let nyquist = std::f64::consts::PI * w.rate_hz;
    let mut starts: Vec<[f64; 2]> = hint.into_iter().collect();
    for k in 0..40 {
        let omega = nyquist * 0.004 * 200f64.powf(f64::from(k) / 39.0);
        starts.extend([0.003, 0.03, 0.3].map(|zeta| [omega, zeta]));
    }
    let mut fits: Vec<Fit> = starts.into_iter().filter_map(|[omega, zeta]| refine(w, omega, zeta, 0)).collect();
    fits.sort_by(|a, b| a.rms().total_cmp(&b.rms()));
    fits.truncate(4);
    let refined = fits.into_iter().filter_map(|f| refine(w, f.omega_rad_s, f.zeta, 40));
    refined.min_by(|a, b| a.rms().total_cmp(&b.rms()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_recording_is_fitted_to_nothing_and_its_numbers_come_back() {
        let (samples, substeps, rate_hz) = (2000, 4, 50.0);
        let h = 1.0 / (rate_hz * substeps as f64);
        let input: Vec<f64> = (0..=2 * substeps * (samples - 1))
            .map(|k| {
                let t = k as f64 * h / 2.0;
                (5.0 * t).sin() + (11.0 * t).cos()
            })
            .collect();
        let blank = vec![0.0; samples];
        let window = |output| Window { input: &input, output, substeps, rate_hz };
        let parts = responses(&window(&blank), 8.0, 0.07);
        let output = combine(&parts, [40.0, 0.3, 1.0, -2.0]);
        for fit in [refine(&window(&output), 8.6, 0.1, 20), search(&window(&output), None)] {
            let fit = fit.expect("fits");
            assert!(fit.rms() < 1e-6, "{}", fit.rms());
            assert!((fit.omega_rad_s - 8.0).abs() < 1e-5 && (fit.zeta - 0.07).abs() < 1e-6);
            assert!((fit.gain - 40.0).abs() < 1e-4 && (fit.offset - 0.3).abs() < 1e-5);
        }
    }
}
