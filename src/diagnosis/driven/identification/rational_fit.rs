//! Resonance, damping and gain by linear least squares on the spectra of input and output: a place
//! to begin that needs no grid, however narrow the resonance is.
//!
//! Over a finite record (ω₀² − ω² + 2jζω₀ω) Y = (g + jω g₁) U + t₀ + jω t₁, where the last two are
//! what the mass brings from before the record and takes beyond it (Pintelon & Schoukens, System
//! Identification: A Frequency Domain Approach, 2nd ed., §6.3), and g₁ is what an input that is held
//! between its samples, or comes late, turns the phase by. It is linear in ω₀², 2ζω₀ and the
//! others; each pass divides by the denominator of the one before, so that errors count as those of
//! the output (Sanathanan & Koerner, IEEE Trans. Autom. Control 8, 1963). Not the fit itself
//! (`fit`).

use std::f64::consts::TAU;

use realfft::num_complex::Complex64;

use crate::numerics::fourier;
use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean;

/// Passes; each is as good as the denominator of the one before.
const PASSES: usize = 12;
/// Part of half the sampling rate beyond which samples are no longer the continuous response.
const BAND: f64 = 0.9;
/// A damping that comes out negative begins here.
const LEAST_ZETA: f64 = 1e-4;

/// A resonance with its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rational {
    pub(super) gain: f64,
    pub(super) omega_rad_s: f64,
    pub(super) zeta: f64,
}

/// The resonance through which `y` follows `u`; `None` where the passes lead to none. `from` is
/// where they begin.
pub(super) fn rational_fit(u: &[f64], y: &[f64], rate_hz: f64, from: Rational) -> Option<Rational> {
    let n = u.len().min(y.len());
    let plan = fourier::forward(n);
    let transform = |values: &[f64]| {
        let middle = mean(&values[..n]);
        let mut values: Vec<f64> = values[..n].iter().map(|v| v - middle).collect();
        let mut bins = plan.make_output_vec();
        plan.process(&mut values, &mut bins).ok().map(|()| bins)
    };
    let (u, y) = (transform(u)?, transform(y)?);
    let step = TAU * rate_hz / n as f64;
    let used = 1..(BAND * u.len() as f64) as usize;
    let mut found = from;
    for _ in 0..PASSES {
        let mut residual = Vec::with_capacity(2 * used.len());
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| Vec::with_capacity(2 * used.len()));
        for k in used.clone() {
            let jw = Complex64::new(0.0, step * k as f64);
            let weight = (jw * jw + found.omega_rad_s * (2.0 * found.zeta * jw + found.omega_rad_s)).inv();
            let push = |to: &mut Vec<f64>, value: Complex64| {
                let value = value * weight;
                to.extend([value.re, value.im]);
            };
            push(&mut residual, jw * jw * y[k]);
            let terms = [y[k], jw * y[k], -u[k], Complex64::new(-1.0, 0.0), -jw, -jw * u[k]];
            columns.iter_mut().zip(terms).for_each(|(column, term)| push(column, term));
        }
        let step = Linear { residual, columns: columns.to_vec() }.normal().step(0.0);
        let omega_rad_s = step[0].sqrt();
        if !(omega_rad_s > 0.0 && omega_rad_s.is_finite() && step[2].is_finite()) {
            return None;
        }
        found = Rational { gain: step[2], omega_rad_s, zeta: (0.5 * step[1] / omega_rad_s).max(LEAST_ZETA) };
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// Steady and free motion under ten sines, from rest: closed form.
    fn motion(omega: f64, zeta: f64, t: f64) -> [f64; 2] {
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let (mut u, mut steady, mut x, mut v) = (0.0, 0.0, 0.0, 0.0);
        for k in 0..10 {
            let (w, phase) = (TAU * (2.3 + 1.9 * f64::from(k)), f64::from(k * k));
            let (re, im) = (omega * omega - w * w, 2.0 * zeta * omega * w);
            let (size, late) = (omega * omega / re.hypot(im), im.atan2(re));
            u += (w * t + phase).sin();
            steady += size * (w * t + phase - late).sin();
            x -= size * (phase - late).sin();
            v -= size * w * (phase - late).cos();
        }
        let free = x * (damped * t).cos() + (v + zeta * omega * x) / damped * (damped * t).sin();
        [u, steady + (-zeta * omega * t).exp() * free]
    }

    #[test]
    fn a_resonance_narrower_than_the_lines_are_apart_is_found_from_far_away() {
        let (rate_hz, rows) = (100.0, 8000);
        let mut rng = Philox::new(5, 0, Stream::Host);
        for (omega, zeta, late) in
            [(TAU * 10.5, 3e-4, 0.0), (TAU * 7.0, 0.02, 0.0), (TAU * 12.0, 0.4, 0.0), (TAU * 10.5, 3e-4, 0.5)]
        {
            // Both from the same motion, the reading late by a part of a sample.
            let (u, y): (Vec<f64>, Vec<f64>) = (0..rows)
                .map(|k| (1.0 + f64::from(k)) / rate_hz)
                .map(|t| (motion(omega, zeta, t)[0], motion(omega, zeta, t - late / rate_hz)[1] + 0.01 * rng.normal()))
                .unzip();
            let from = Rational { gain: 1.0, omega_rad_s: 0.6 * omega, zeta: 0.1 };
            let found = rational_fit(&u, &y, rate_hz, from).expect("a resonance");
            // A width of the resonance, 2ζω₀, off is a place to begin; a hundredth for a broad one.
            let off = (found.omega_rad_s / omega - 1.0).abs();
            assert!(off < (2.0 * zeta).min(0.01), "{omega} {zeta}: {found:?}");
            assert!((found.zeta / zeta).ln().abs() < 0.7, "{omega} {zeta}: {found:?}");
            assert!((found.gain / (omega * omega) - 1.0).abs() < 0.05, "{omega} {zeta}: {found:?}");
            // Control: what has nothing to do with the input has no gain from it.
            let noise: Vec<f64> = (0..rows).map(|_| rng.normal()).collect();
            let none = rational_fit(&u, &noise, rate_hz, from);
            assert!(none.is_none_or(|f| f.gain.abs() < 0.05 * f.omega_rad_s.powi(2)), "{none:?}");
        }
    }
}
