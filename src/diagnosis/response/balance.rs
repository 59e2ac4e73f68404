//! States where a set of laws may begin: forces balance at the motion that was read.
//!
//! With Z = ω₀² − ω² + iωΓ + Σ s·N of laws of strength s, Z·X = g·D is linear in ω₀², Γ and all strengths,
//! whatever the base model alone was fitted to; a background adds smooth terms. Errors of the reading are
//! multiplied by |Z|, by which each step is weighed.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

use super::beginnings::in_place;
use super::force::{Law, Oscillator};
use super::intake::Sweeps;
use super::predicted::{REACH, beside, readout, shapes};
use super::steady_state::Table;
use super::values::{Sizes, Values};

/// Least Γ, in that of the base model, where the balance has none.
const LEAST_DAMPING: f64 = 0.1;

/// The model of these laws at which forces balance best; forms of laws stay as they are.
pub(super) fn balanced(sweeps: &Sweeps, sizes: &Sizes, values: &Values) -> Option<Values> {
    let band = sizes.band_hz.map(|f| TAU * f);
    let backgrounds = values.background.len();
    let acting: Vec<usize> = (0..values.laws.len()).filter(|i| values.laws[*i].acts()).collect();
    let tables: Vec<Table> = acting
        .iter()
        .map(|i| Table::rough(&values.mass, std::slice::from_ref(&values.laws[*i]), REACH * sizes.amplitude, band))
        .collect();
    let shapes: Vec<[f64; 4]> = (0..sweeps.len()).map(|k| shapes(sweeps, sizes, k)).collect();
    let motion = |k: usize| {
        let background: Complex<f64> = values.background.iter().zip(shapes[k]).map(|(b, s)| b * s).sum();
        let read = readout(sweeps, sizes, values, k);
        [(sweeps.reading[k] - background) / read - beside(sweeps, values, k), sweeps.reading[k] / read]
    };
    let by_law = |k: usize, amplitude: f64| -> Vec<Complex<f64>> {
        let (omega, time_s) = (TAU * sweeps.frequency_hz[k], sweeps.time_s.as_ref().map_or(0.0, |t| t[k]));
        let one = |(i, table): (&usize, &Table)| {
            let law: &Law = &values.laws[*i];
            if law.is_linear() {
                return -law.linear(&values.mass, omega, time_s);
            }
            let along = table.along(&values.mass, omega, Complex::from(0.0));
            along.at(amplitude).0 - along.at(0.0).0
        };
        acting.iter().zip(&tables).map(one).collect()
    };
    let own = 2 + acting.len();
    let smooth = backgrounds + 2;
    let columns = own + 2 * smooth;
    let (mut normal, mut right) = (DMatrix::<f64>::zeros(columns, columns), DVector::<f64>::zeros(columns));
    let centre = sizes.laws.omega_rad_s;
    for k in (0..sweeps.len()).filter(|k| sweeps.counts[*k]) {
        let omega = TAU * sweeps.frequency_hz[k];
        let [moved, x] = motion(k);
        let x = x - beside(sweeps, values, k);
        let weight = moved.norm() / sweeps.drive[k];
        let mut row = vec![x * (sizes.damping_per_s * centre), x * Complex::new(0.0, omega * sizes.damping_per_s)];
        row.extend(by_law(k, moved.norm()).into_iter().map(|n| x * n));
        let [one, along, drive, _] = shapes[k];
        let bent = [one * along * along, drive * along * along];
        for shape in shapes[k][..backgrounds].iter().chain(&bent) {
            let unit = sizes.amplitude * centre * sizes.damping_per_s * shape;
            row.extend([Complex::from(unit), Complex::new(0.0, unit)]);
        }
        let target = x * (omega * omega - centre * centre);
        for part in [|z: Complex<f64>| z.re, |z: Complex<f64>| z.im] {
            let row = DVector::from_iterator(columns, row.iter().map(|z| weight * part(*z)));
            right += &row * (weight * part(target));
            normal += &row * row.transpose();
        }
    }
    let least = 1e-12 * (0..columns).map(|i| normal[(i, i)]).fold(0.0, f64::max);
    (0..columns).for_each(|i| normal[(i, i)] += least.max(1e-300));
    let solved = normal.cholesky()?.solve(&right);
    let square = centre * centre + solved[0] * centre * sizes.damping_per_s;
    let mass = Oscillator {
        omega_rad_s: (square > 0.0).then(|| square.sqrt())?,
        damping_per_s: solved[1].max(LEAST_DAMPING) * sizes.damping_per_s,
    };
    let mut found = Values { mass, settling: 0.0, ..values.clone() };
    for (j, place) in acting.iter().enumerate() {
        found.laws[*place].values[0] *= solved[2 + j];
    }
    let over = |k: usize| {
        let omega = TAU * sweeps.frequency_hz[k];
        let bare = Complex::new(mass.omega_rad_s.powi(2) - omega * omega, omega * mass.damping_per_s);
        let laws: Complex<f64> =
            by_law(k, motion(k)[0].norm()).iter().enumerate().map(|(j, n)| n * solved[2 + j]).sum();
        let turned = readout(sweeps, sizes, values, k) * Complex::from_polar(1.0, -values.angle_rad);
        turned * sweeps.drive[k] / (bare + laws)
    };
    let linear: Vec<Vec<f64>> = (0..backgrounds).map(|i| shapes.iter().map(|shape| shape[i]).collect()).collect();
    let (gain, background, _) = in_place(sweeps, &linear, over)?;
    (found.gain, found.angle_rad, found.background) = (gain.norm(), gain.arg(), background);
    found.gain.is_finite().then_some(found)
}
