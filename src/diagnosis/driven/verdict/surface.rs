//! Shows where the missing force lies in the plane of displacement and velocity: the
//! restoring-force surface of a model's residual (Masri & Caughey, J. Appl. Mech. 46, 1979), with a
//! false-discovery rate.
//!
//! The error of free simulation is turned into the force that would have caused it, (d²/dt² + 2ζω₀
//! d/dt + ω₀²)e, within a band around the resonance: beyond it readout noise is all that such a
//! derivative shows. A spring that is missing bends the surface along the displacement, a damper
//! along the velocity, friction steps where the velocity changes sign. Not for fitting.

use std::f64::consts::{PI, TAU};

use realfft::num_complex::Complex64;

use crate::numerics::{fourier, order, special};
use crate::verdict::StateCell;

/// Cells along either axis: as many as leave this many samples to one, between the fewest and the
/// most worth drawing.
const SAMPLES: f64 = 80.0;
const FEWEST: usize = 8;
const MOST: usize = 16;
/// Share of the cells named that may be chance (Benjamini & Hochberg 1995; neighbours know of each
/// other, which it bears).
const FALSE_DISCOVERY: f64 = 0.05;
/// Fewest visits of a cell that show anything of it.
const VISITS: usize = 6;
/// The band ends at this many times the resonance: a cubic spring acts at three times what moves
/// it.
const BAND: f64 = 4.0;
/// Share of the samples beyond each edge of the surface.
const TAIL: f64 = 0.01;

/// A free simulation and its error, from which the surface is made.
#[derive(Debug, Clone, Copy)]
pub struct FreeRun<'a> {
    /// Error of free simulation, sample by sample.
    pub error: &'a [f64],
    /// Displacement that the model passes through.
    pub x: &'a [f64],
    /// Velocity at each sample, output unit per second.
    pub v: &'a [f64],
    /// ω₀ of the model.
    pub omega_rad_s: f64,
    /// ζ of the model.
    pub zeta: f64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
}

/// A cell of displacement and velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Mean of the missing force over ω₀², in the unit of the displacement; NaN where the state
    /// seldom is.
    pub force: f64,
    /// Standard error of the force, from the scatter between visits.
    pub error: f64,
    /// Number of samples in the cell.
    pub samples: usize,
    /// States whether noise alone is unlikely to make it.
    pub found: bool,
}

/// The surface: rows of equal velocity from the lowest up, cells of a row by displacement.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Cells along either axis.
    pub side: usize,
    /// Lowest and highest displacement, output unit.
    pub x: (f64, f64),
    /// Lowest and highest velocity, output unit per second.
    pub v: (f64, f64),
    /// Cells row by row, rows of equal velocity from the lowest up.
    pub cells: Vec<Cell>,
}

impl Surface {
    /// Displacements from, to and velocities from, to of one cell.
    pub fn place(&self, index: usize) -> [f64; 4] {
        let edge = |(from, to): (f64, f64), i: usize| from + (to - from) * i as f64 / self.side as f64;
        let (column, row) = (index % self.side, index / self.side);
        [edge(self.x, column), edge(self.x, column + 1), edge(self.v, row), edge(self.v, row + 1)]
    }

    /// Number of cells that are more than noise, and of those that could be judged.
    pub fn found(&self) -> (usize, usize) {
        (self.cells.iter().filter(|c| c.found).count(), self.cells.iter().filter(|c| c.force.is_finite()).count())
    }

    /// The cells that are more than noise, strongest first.
    pub fn strongest(&self, most: usize) -> Vec<StateCell> {
        let mut all: Vec<StateCell> = (0..self.cells.len())
            .filter(|i| self.cells[*i].found)
            .map(|i| {
                let ([a, b, c, d], cell) = (self.place(i), &self.cells[i]);
                StateCell {
                    displacement: [a, b],
                    velocity: [c, d],
                    force: cell.force,
                    excess: cell.force.abs() / cell.error,
                }
            })
            .collect();
        order::sort_by_key(&mut all, |c| -c.excess);
        all.truncate(most);
        all
    }

    /// Names what the missing force follows, as far as the surface shows it.
    pub fn words(&self) -> Option<&'static str> {
        if self.found().0 < 4 {
            return None;
        }
        let known = || (0..self.cells.len()).filter(|i| self.cells[*i].force.is_finite());
        let power = |group: &dyn Fn(usize) -> usize| -> f64 {
            let mut sums = vec![(0.0, 0.0); self.cells.len()];
            for i in known() {
                let (cell, sum) = (&self.cells[i], &mut sums[group(i)]);
                *sum = (sum.0 + cell.samples as f64 * cell.force, sum.1 + cell.samples as f64);
            }
            sums.iter().filter(|s| s.1 > 0.0).map(|s| s.0 * s.0 / s.1).sum()
        };
        let all = power(&|i| i).max(1e-300);
        let (by_x, by_v) = (power(&|i| i % self.side) / all, power(&|i| i / self.side) / all);
        Some(match (by_x > 0.5, by_v > 0.5) {
            (true, false) => "as a force it follows the displacement, like a spring",
            (false, true) => "as a force it follows the velocity, like a damper",
            _ => "as a force it follows displacement and velocity together",
        })
    }
}

/// The surface of what a model leaves; empty where there is too little motion.
pub(crate) fn surface(m: &FreeRun<'_>) -> Surface {
    let n = m.error.len().min(m.x.len()).min(m.v.len());
    // The ends of a stretch ring in the transform.
    let edge = (3.0 * m.rate_hz * TAU / m.omega_rad_s).ceil() as usize;
    if n < 10 * FEWEST * FEWEST || n < 8 * edge || !m.error.iter().chain(m.x).chain(m.v).all(|v| v.is_finite()) {
        return Surface::default();
    }
    let Some(force) = force(m, n) else { return Surface::default() };
    let rows = edge..n - edge;
    let limits = |values: &[f64]| {
        let mut sorted = values[rows.clone()].to_vec();
        order::sort(&mut sorted);
        let tail = (TAIL * sorted.len() as f64) as usize;
        (sorted[tail], sorted[sorted.len() - 1 - tail])
    };
    let (x, v) = (limits(m.x), limits(m.v));
    if x.1 <= x.0 || v.1 <= v.0 {
        return Surface::default();
    }
    let side = ((n as f64 / SAMPLES).sqrt() as usize).clamp(FEWEST, MOST);
    let index = |value: f64, (from, to): (f64, f64)| {
        let at = (value - from) / (to - from) * side as f64;
        (at >= 0.0 && at < side as f64).then_some(at as usize)
    };
    // Samples of one visit know of each other: a visit counts once.
    let mut visits: Vec<Vec<(f64, usize)>> = vec![Vec::new(); side * side];
    let mut here = None;
    for k in rows {
        let cell = index(m.x[k], x).zip(index(m.v[k], v)).map(|(i, j)| j * side + i);
        if let Some(cell) = cell {
            match visits[cell].last_mut().filter(|_| here == Some(cell)) {
                Some(visit) => *visit = (visit.0 + force[k], visit.1 + 1),
                None => visits[cell].push((force[k], 1)),
            }
        }
        here = cell;
    }
    let mut cells: Vec<Cell> = visits.iter().map(|visits| judged(visits)).collect();
    let p: Vec<f64> = cells
        .iter()
        .zip(&visits)
        .map(|(c, visits)| {
            let degrees_of_freedom = visits.len() as f64 - 1.0;
            if c.force.is_finite() && c.error > 0.0 {
                special::f_survival((c.force / c.error).powi(2), 1.0, degrees_of_freedom)
            } else {
                f64::NAN
            }
        })
        .collect();
    let tested: Vec<usize> = (0..p.len()).filter(|i| p[*i].is_finite()).collect();
    let values: Vec<f64> = tested.iter().map(|i| p[*i]).collect();
    for (i, found) in tested.into_iter().zip(special::discoveries(&values, FALSE_DISCOVERY)) {
        cells[i].found = found;
    }
    Surface { side, x, v, cells }
}

/// Mean over all samples of a cell, and its error from the scatter between visits.
fn judged(visits: &[(f64, usize)]) -> Cell {
    let samples: usize = visits.iter().map(|v| v.1).sum();
    if visits.len() < VISITS {
        return Cell { force: f64::NAN, error: f64::NAN, samples, found: false };
    }
    let count = samples as f64;
    let force = visits.iter().map(|v| v.0).sum::<f64>() / count;
    let scatter: f64 = visits.iter().map(|v| (v.0 - force * v.1 as f64).powi(2)).sum();
    let small = visits.len() as f64 / (visits.len() as f64 - 1.0);
    Cell { force, error: (small * scatter).sqrt() / count, samples, found: false }
}

/// The force over ω₀² that an error of the displacement stands for, within the band.
fn force(m: &FreeRun<'_>, n: usize) -> Option<Vec<f64>> {
    let (forward, inverse) = (fourier::forward(n), fourier::inverse(n));
    let mut values = m.error[..n].to_vec();
    let mut bins = forward.make_output_vec();
    forward.process(&mut values, &mut bins).ok()?;
    let last = bins.len() - 1;
    for (i, bin) in bins.iter_mut().enumerate() {
        // Frequency over resonance.
        let r = TAU * i as f64 / n as f64 * m.rate_hz / m.omega_rad_s;
        // Whole up to the band, gone at half as much again.
        let window = (0.5 + 0.5 * (2.0 * PI * (r / BAND - 1.0).clamp(0.0, 0.5)).cos()) / n as f64;
        *bin *= Complex64::new(1.0 - r * r, 2.0 * m.zeta * r) * window;
        if i == 0 || (i == last && n.is_multiple_of(2)) {
            bin.im = 0.0;
        }
    }
    inverse.process(&mut bins, &mut values).ok()?;
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use rand_distr::{Distribution, StandardNormal};

    const OMEGA: f64 = 0.2;
    const ZETA: f64 = 0.05;

    /// Displacement and velocity of an oscillator under random force, with a spring `cubic`·x³ or
    /// without; unit rate, by the semi-implicit method in 20 steps.
    fn motion(cubic: f64, friction: f64) -> (Vec<f64>, Vec<f64>) {
        let noise: Vec<f64> = StandardNormal.sample_iter(Philox::new(3, 0, Stream::Host)).take(12_000).collect();
        let (mut x, mut v) = (0.0f64, 0.0f64);
        let mut smooth = 0.0;
        let step = |u: &f64| {
            smooth += 0.5 * (u - smooth);
            for _ in 0..20 {
                let a = smooth * 0.01
                    - 2.0 * ZETA * OMEGA * v
                    - OMEGA * OMEGA * (x + cubic * x.powi(3) + friction * v.signum());
                v += a / 20.0;
                x += v / 20.0;
            }
            (x, v)
        };
        noise.iter().map(step).unzip()
    }

    fn seen(error: &[f64], x: &[f64], v: &[f64]) -> Surface {
        surface(&FreeRun { error, x, v, omega_rad_s: OMEGA, zeta: ZETA, rate_hz: 1.0 })
    }

    #[test]
    fn the_surface_of_a_missing_spring_follows_the_displacement_and_noise_leaves_none() {
        let (x, v) = motion(0.0, 0.0);
        let (bent, _) = motion(0.2, 0.0);
        let noise: Vec<f64> = StandardNormal.sample_iter(Philox::new(4, 0, Stream::Host)).take(x.len()).collect();
        let size = 0.01 * (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
        let error: Vec<f64> = bent.iter().zip(&x).zip(&noise).map(|((b, x), e)| b - x + size * e).collect();
        let s = seen(&error, &bent, &v);
        let (found, judged) = s.found();
        assert!(found > 10 && judged > 60, "{found} of {judged}");
        // The missing force is −0.2·x³ of the true displacement (over ω₀²), whatever the velocity.
        let worst = (0..s.cells.len()).filter(|i| s.cells[*i].found).map(|i| {
            let x = 0.5 * (s.place(i)[0] + s.place(i)[1]);
            (s.cells[i].force + 0.2 * x.powi(3)).abs() / (0.2 * s.x.1.powi(3))
        });
        assert!(worst.fold(0.0, f64::max) < 0.5);
        let none: Vec<f64> = noise.iter().map(|e| size * e).collect();
        assert!(seen(&none, &x, &v).found().0 <= 1, "{:?}", seen(&none, &x, &v).found());
    }

    #[test]
    fn the_surface_of_friction_steps_with_the_velocity() {
        let (x, _) = motion(0.0, 0.0);
        let (rubbed, v) = motion(0.0, 0.05);
        let error: Vec<f64> = rubbed.iter().zip(&x).map(|(b, x)| b - x).collect();
        let s = seen(&error, &rubbed, &v);
        let mean = |row: usize| {
            let cells = s.cells[row * s.side..(row + 1) * s.side].iter().filter(|c| c.force.is_finite());
            let (sum, count) = cells.fold((0.0, 0.0), |(a, n), c| (a + c.force, n + 1.0));
            sum / count
        };
        assert!(
            mean(s.side / 2 + 2) < 0.0 && mean(s.side / 2 - 3) > 0.0,
            "{} {}",
            mean(s.side / 2 + 2),
            mean(s.side / 2 - 3)
        );
    }
}
