//! Resonances from which a fit may begin: for each ω₀ and Γ of a grid the gain and the background that fit
//! best are known at once, so that no background, however strong, hides where the resonance is.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use crate::numerics::order;

use super::intake::Sweeps;

/// Places of a resonance over the band.
pub(super) const PLACES: usize = 32;
/// Widths of a resonance, in that of the band.
pub(super) const WIDTHS: [f64; 6] = [0.005, 0.015, 0.04, 0.1, 0.25, 0.6];
/// Beginnings that are followed.
const FOLLOWED: usize = 3;

/// A resonance with its gain and background.
#[derive(Debug, Clone)]
pub(super) struct Beginning {
    /// ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Γ, 1/s.
    pub damping_per_s: f64,
    /// Reading of a unit of displacement for a unit of drive per ω₀Γ, with its angle.
    pub gain: Complex<f64>,
    /// Background.
    pub background: Vec<Complex<f64>>,
    left: f64,
}

/// The best beginnings; `shapes` are those of the background of each step, `sweeps` the steps.
pub(super) fn beginnings(sweeps: &Sweeps, shapes: &[Vec<f64>]) -> Vec<Beginning> {
    let [low, high] = sweeps.span_hz().map(|f| TAU * f);
    let one = |omega: f64, damping: f64| beginning(sweeps, shapes, [omega, damping]);
    let place = |i: usize| low + (high - low) * (i as f64 + 0.5) / PLACES as f64;
    // The best place of each width.
    let of_width = |part: &f64| {
        let all = (0..PLACES).filter_map(|i| one(place(i), part * (high - low)));
        all.min_by(|a, b| a.left.total_cmp(&b.left))
    };
    let mut all: Vec<Beginning> = WIDTHS.iter().filter_map(of_width).collect();
    order::sort_by_key(&mut all, |b| b.left);
    all.truncate(FOLLOWED);
    all
}

fn beginning(sweeps: &Sweeps, shapes: &[Vec<f64>], [omega_rad_s, damping_per_s]: [f64; 2]) -> Option<Beginning> {
    let over = |k: usize| {
        let omega = TAU * sweeps.frequency_hz[k];
        let readout = Complex::new(0.0, omega / omega_rad_s).powi(sweeps.derivatives);
        let stiffness = Complex::new(omega_rad_s * omega_rad_s - omega * omega, omega * damping_per_s);
        readout * (sweeps.drive[k] * omega_rad_s * damping_per_s) / stiffness
    };
    let (gain, background, left) = in_place(sweeps, shapes, over)?;
    Some(Beginning { omega_rad_s, damping_per_s, gain, background, left })
}

/// Gain and background of a known motion per gain, and the sum of squares that they leave.
pub(super) fn in_place(
    sweeps: &Sweeps,
    shapes: &[Vec<f64>],
    motion: impl Fn(usize) -> Complex<f64>,
) -> Option<(Complex<f64>, Vec<Complex<f64>>, f64)> {
    let columns = 1 + shapes.len();
    let mut sizes = vec![0.0f64; columns];
    let rows: Vec<(usize, DVector<Complex<f64>>)> = (0..sweeps.len())
        .filter(|k| sweeps.counts[*k])
        .map(|k| {
            let shapes = shapes.iter().map(|shape| Complex::from(shape[k]));
            (k, DVector::from_iterator(columns, std::iter::once(motion(k)).chain(shapes)))
        })
        .collect();
    for (_, row) in &rows {
        sizes.iter_mut().zip(row.iter()).for_each(|(size, z)| *size = size.max(z.norm()));
    }
    let (mut normal, mut right, mut power) = (DMatrix::zeros(columns, columns), DVector::zeros(columns), 0.0);
    for (k, row) in rows {
        let row = DVector::from_iterator(columns, row.iter().zip(&sizes).map(|(z, size)| z / size.max(1e-300)));
        let conjugate = row.conjugate();
        normal += &conjugate * row.transpose();
        right += conjugate * sweeps.reading[k];
        power += sweeps.reading[k].norm_sqr();
    }
    let solved = normal.lu().solve(&right)?;
    let left = power - solved.dotc(&right).re;
    let of = |i: usize| solved[i] / sizes[i].max(1e-300);
    left.is_finite().then(|| (of(0), (1..columns).map(of).collect(), left))
}
