//! One bifurcation diagram: the force swept up and down, and where the two ways differ.

use super::document::{Diagram, Document};
use proofmass_base::control::{Control, Progress};
use proofmass_base::error::Result;
use proofmass_base::parallel;
use proofmass_physics::dynamics::bifurcation::{Sweep, sweep};

/// A computed bifurcation diagram, with the force rising and falling.
#[derive(Debug, Clone)]
pub struct Bifurcation {
    /// Its section of map.toml.
    pub diagram: Diagram,
    /// (amplitude, strobed displacement) on the way up, N and m.
    pub up: Vec<(f64, f64)>,
    /// The same on the way down, in the order of the sweep.
    pub down: Vec<(f64, f64)>,
}

impl Bifurcation {
    /// Returns how far apart the means of two sweeps count as different, m: a twentieth of the
    /// range of all strobes.
    pub fn apart_m(&self) -> f64 {
        let strobes = self.up.iter().chain(&self.down).map(|p| p.1).filter(|x| x.is_finite());
        let (low, high) = strobes.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        0.05 * (high - low).max(0.0)
    }

    /// Amplitudes at which the way down stands elsewhere than the way up: hysteresis. In N, from
    /// the smallest; the means of all strobes are compared, against [`Bifurcation::apart_m`].
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

/// Sweeps up and down.
///
/// # Errors
/// Stopped.
pub(super) fn compute(document: &Document, d: &Diagram, control: &Control, progress: &Progress) -> Result<Bifurcation> {
    let up = Sweep {
        from_n: d.from_n,
        to_n: d.to_n,
        points: d.points,
        omega_rad_s: document.drive.omega_rad_s(),
        transient_periods: d.transient_periods,
        strobes: d.strobes,
        noise_n_rts: d.noise_n_rts,
        seed: document.seed,
    };
    let down = Sweep { from_n: d.to_n, to_n: d.from_n, seed: document.seed.wrapping_add(1), ..up };
    let oscillator = document.oscillator.into();
    let (up, down) = parallel::join(|| sweep(&oscillator, &up, control), || sweep(&oscillator, &down, control));
    progress.step();
    let swept = || Ok(Bifurcation { diagram: d.clone(), up: up?, down: down? });
    swept().map_err(|s: proofmass_base::control::Stopped| {
        s.during("could not finish the bifurcation diagram", "run it again")
    })
}
