//! The map of the Duffing equation: largest Lyapunov exponent and period over two of its parameters, and bifurcation
//! diagrams along the force.
//!
//! A map is a document (`map.toml`), so that a sensor designer can put their own proof mass in place of the paper's. Not
//! for real sensors' noise budgets: that is `study`.

pub mod document;
pub mod grid;

use crate::backend::orbits::Device;
use crate::control::{Control, Stopped};
use crate::dynamics::bifurcation::{Sweep, sweep};
use crate::error::Result;
use crate::parallel;
use document::{Diagram, Document};
use grid::Grid;

/// A computed document.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// What was asked.
    pub document: Document,
    /// One per `[[map]]`.
    pub grids: Vec<Grid>,
    /// One per `[[bifurcation]]`.
    pub diagrams: Vec<Bifurcation>,
}

/// One bifurcation diagram.
#[derive(Debug, Clone)]
pub struct Bifurcation {
    /// What was asked.
    pub diagram: Diagram,
    /// (amplitude, strobed displacement) on the way up, N and m.
    pub up: Vec<(f64, f64)>,
    /// The same on the way down, in the order of the sweep.
    pub down: Vec<(f64, f64)>,
}

impl Bifurcation {
    /// How far apart the means of two sweeps count as different, m: a twentieth of the range of all strobes.
    pub fn apart_m(&self) -> f64 {
        let strobes = self.up.iter().chain(&self.down).map(|p| p.1).filter(|x| x.is_finite());
        let (low, high) = strobes.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        0.05 * (high - low).max(0.0)
    }

    /// Amplitudes at which the way down stands elsewhere than the way up: hysteresis. In N, from the smallest; the means of
    /// all strobes are compared, against [`Bifurcation::apart_m`].
    pub fn hysteresis_n(&self) -> Vec<f64> {
        let tolerance_m = self.apart_m();
        let strobes = self.diagram.strobes as usize;
        let means = |cloud: &[(f64, f64)]| -> Vec<(f64, f64)> {
            cloud.chunks(strobes).map(|c| (c[0].0, c.iter().map(|p| p.1).sum::<f64>() / c.len() as f64)).collect()
        };
        let (up, mut down) = (means(&self.up), means(&self.down));
        down.reverse();
        up.iter().zip(&down).filter(|(u, d)| (u.1 - d.1).abs() > tolerance_m).map(|(u, _)| u.0).collect()
    }
}

/// Computes everything a document asks for.
///
/// # Errors
/// When the device fails or Ctrl-C stops it.
pub fn compute(document: Document, device: Device<'_>, control: &Control) -> Result<Atlas> {
    let rows: u64 = document.map.iter().map(|m| u64::from(m.y.points)).sum();
    let progress = control.stage("mapping", rows + document.bifurcation.len() as u64);
    let mut grids = Vec::new();
    for map in &document.map {
        grids.push(grid::compute(&document, map, device, control, &progress)?);
    }
    let diagrams: Result<Vec<Bifurcation>, Stopped> = parallel::map(&document.bifurcation, |d| {
        let omega_rad_s = document.drive.omega_rad_s();
        let up = Sweep {
            from_n: d.from_n,
            to_n: d.to_n,
            points: d.points,
            omega_rad_s,
            transient_periods: d.transient_periods,
            strobes: d.strobes,
            noise_n_rts: d.noise_n_rts,
            seed: document.seed,
        };
        let down = Sweep { from_n: d.to_n, to_n: d.from_n, seed: document.seed.wrapping_add(1), ..up };
        let oscillator = document.oscillator.into();
        let (up, down) = parallel::join(|| sweep(&oscillator, &up, control), || sweep(&oscillator, &down, control));
        progress.step();
        Ok(Bifurcation { diagram: d.clone(), up: up?, down: down? })
    })
    .into_iter()
    .collect();
    let diagrams = diagrams.map_err(|s| s.during("could not finish the bifurcation diagram", "run it again"))?;
    Ok(Atlas { grids, diagrams, document })
}
