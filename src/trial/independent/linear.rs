//! States what the best linear oscillator leaves of a recording: the oracle of how large an effect
//! is.
//!
//! For a given ω and ζ the reading is linear in gain, offset and initial state (variable
//! projection, Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973); the two others are found by
//! Gauss–Newton. Responses are exact for an input that is quadratic between three points a fine
//! step apart.

/// Input on a fine grid: `2·fine` values per row; `held` when constant over each row.
#[derive(Debug, Clone)]
pub struct Fine {
    /// Values at half steps, from the first row on.
    pub values: Vec<f64>,
    /// Integration steps per row.
    pub steps: usize,
    /// States whether the input is held between rows.
    pub held: bool,
}

type Matrix = [[f64; 5]; 5];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..5).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Propagator of (x, v, u, u′, u″) over h.
fn propagator(omega: f64, zeta: f64, h: f64) -> Matrix {
    let mut a = [[0.0; 5]; 5];
    a[0][1] = h;
    (a[1][0], a[1][1], a[1][2]) = (-omega * omega * h, -2.0 * zeta * omega * h, h);
    (a[2][3], a[3][4]) = (h, h);
    let size = a.iter().flatten().map(|v| v.abs()).fold(0.0, f64::max);
    let halvings = (size / 0.1).log2().ceil().max(0.0) as i32;
    a.iter_mut().flatten().for_each(|v| *v /= 2f64.powi(halvings));
    let identity: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let (mut sum, mut term) = (identity, identity);
    for n in 1..14 {
        term = product(&term, &a);
        term.iter_mut().flatten().for_each(|v| *v /= f64::from(n));
        for i in 0..5 {
            for j in 0..5 {
                sum[i][j] += term[i][j];
            }
        }
    }
    (0..halvings).fold(sum, |m, _| product(&m, &m))
}

/// Response from rest and the two free motions, at each row.
fn responses(omega: f64, zeta: f64, input: Option<&Fine>, rate_hz: f64, rows: usize) -> [Vec<f64>; 3] {
    let steps = input.map_or(1, |f| f.steps);
    let h = 1.0 / (rate_hz * steps as f64);
    let p = propagator(omega, zeta, h);
    let mut out = [Vec::with_capacity(rows), Vec::with_capacity(rows), Vec::with_capacity(rows)];
    let mut s = [[0.0, 0.0], [1.0, 0.0], [0.0, omega]];
    for row in 0..rows {
        for (out, s) in out.iter_mut().zip(&s) {
            out.push(s[0]);
        }
        for k in 0..steps {
            let drive = input.map_or([0.0; 3], |f| {
                if f.held {
                    return [f.values[row], 0.0, 0.0];
                }
                let at = 2 * (row * steps + k);
                let [a, b, c] = [f.values[at], f.values[at + 1], f.values[at + 2]];
                [a, (-3.0 * a + 4.0 * b - c) / h, 4.0 * (a - 2.0 * b + c) / (h * h)]
            });
            for (n, [x, v]) in s.iter_mut().enumerate() {
                let d = if n == 0 { drive } else { [0.0; 3] };
                let next = |r: &[f64; 5]| r[0] * *x + r[1] * *v + r[2] * d[0] + r[3] * d[1] + r[4] * d[2];
                (*x, *v) = (next(&p[0]), next(&p[1]));
            }
        }
    }
    out
}

/// Solves a small symmetric positive system in place; directions without power get zero.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    let scale: Vec<f64> = (0..n).map(|i| if a[i][i] > 0.0 { 1.0 / a[i][i].sqrt() } else { 0.0 }).collect();
    for i in 0..n {
        for j in 0..n {
            a[i][j] *= scale[i] * scale[j];
        }
        a[i][i] += 1e-12 + f64::from(u8::from(scale[i] == 0.0));
        b[i] *= scale[i];
    }
    for k in 0..n {
        let pivot = a[k].clone();
        for i in k + 1..n {
            let f = a[i][k] / pivot[k];
            a[i].iter_mut().zip(&pivot).skip(k).for_each(|(to, from)| *to -= f * from);
            b[i] -= f * b[k];
        }
    }
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - rest) / a[k][k];
    }
    b.iter().zip(&scale).map(|(b, s)| b * s).collect()
}

/// Projects `y` off the columns by least squares; what is left.
pub(super) fn left_by(columns: &[&[f64]], y: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let a = columns.iter().map(|c| columns.iter().map(|d| dot(c, d)).collect()).collect();
    let weights = solve(a, columns.iter().map(|c| dot(c, y)).collect());
    let mut residual = y.to_vec();
    for (column, weight) in columns.iter().zip(weights) {
        residual.iter_mut().zip(*column).for_each(|(l, c)| *l -= weight * c);
    }
    residual
}

/// Residual of the best linear oscillator, and its ω and ζ.
pub(crate) fn refit(y: &[f64], input: Option<&Fine>, rate_hz: f64, start: [f64; 2]) -> (Vec<f64>, [f64; 2]) {
    let ones = vec![1.0; y.len()];
    let residual_of = |theta: [f64; 2]| {
        let [forced, x, v] = responses(theta[0].exp(), theta[1].exp(), input, rate_hz, y.len());
        let mut columns: Vec<&[f64]> = vec![&x, &v, &ones];
        if input.is_some() {
            columns.push(&forced);
        }
        left_by(&columns, y)
    };
    let power = |r: &[f64]| r.iter().map(|v| v * v).sum::<f64>();
    let mut theta = start.map(f64::ln);
    let mut residual = residual_of(theta);
    let mut best = power(&residual);
    let mut damping = 1e-3;
    for _ in 0..25 {
        // Steps well within the width of the resonance and far above rounding.
        let steps = [1e-5 * theta[1].exp().clamp(1e-3, 1.0) * 10.0, 1e-4];
        let slopes: Vec<Vec<f64>> = (0..2)
            .map(|i| {
                let mut there = theta;
                there[i] += steps[i];
                residual_of(there).iter().zip(&residual).map(|(a, b)| (a - b) / steps[i]).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut improved = false;
        for _ in 0..6 {
            let a: Vec<Vec<f64>> = (0..2)
                .map(|i| {
                    (0..2).map(|j| dot(&slopes[i], &slopes[j]) * if i == j { 1.0 + damping } else { 1.0 }).collect()
                })
                .collect();
            let change = solve(a, (0..2).map(|i| -dot(&slopes[i], &residual)).collect());
            let there =
                [theta[0] + change[0].clamp(-0.3, 0.3), (theta[1] + change[1].clamp(-1.0, 1.0)).clamp(-14.0, 3.0)];
            let trial = residual_of(there);
            let value = power(&trial);
            if value < best {
                improved = value < best * (1.0 - 1e-4);
                (theta, residual, best) = (there, trial, value);
                damping = (damping * 0.2f64).max(1e-9);
                break;
            }
            damping *= 8.0;
        }
        if !improved {
            break;
        }
    }
    (residual, theta.map(f64::exp))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    // Steady state of x″ + 2ζω₀x′ + ω₀²x = cos νt: amplitude 1/|ω₀² − ν² + 2iζω₀ν|.
    #[test]
    fn a_linear_response_is_its_transfer_function_and_leaves_nothing() {
        let (omega, zeta, rate, nu) = (TAU * 3.0, 0.04, 40.0, TAU * 2.0);
        let steps = 6;
        let values = (0..2 * steps * 3000 + 3).map(|k| (nu * k as f64 / (2.0 * steps as f64 * rate)).cos()).collect();
        let fine = Fine { values, steps, held: false };
        let [forced, ..] = responses(omega, zeta, Some(&fine), rate, 3000);
        let expected = 1.0 / ((omega * omega - nu * nu).powi(2) + (2.0 * zeta * omega * nu).powi(2)).sqrt();
        let rms = |r: &[f64]| (r.iter().map(|v| v * v).sum::<f64>() / r.len() as f64).sqrt();
        let found = rms(&forced[2000..]) * std::f64::consts::SQRT_2;
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        let y: Vec<f64> = forced.iter().map(|f| 3.0 * f / expected + 0.7).collect();
        let (left, [found, _]) = refit(&y, Some(&fine), rate, [1.02 * omega, 2.0 * zeta]);
        assert!(rms(&left) < 1e-5 && (found / omega - 1.0).abs() < 1e-5, "{} {found}", rms(&left));
        // Control: a harmonic is left in full.
        let bent: Vec<f64> = y.iter().map(|v| v + 0.01 * (v - 0.7).powi(2)).collect();
        assert!(rms(&refit(&bent, Some(&fine), rate, [omega, zeta]).0) > 1e-3);
    }
}
