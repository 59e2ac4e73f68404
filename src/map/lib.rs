//! The map of the Duffing equation: largest Lyapunov exponent and period over two of its
//! parameters, and bifurcation diagrams along the force.
//!
//! A map is a document (`map.toml`), so that a sensor designer can put their own proof mass in
//! place of the paper's. Not for real sensors' noise budgets: that is `study`.

#![warn(unreachable_pub)]

mod atlas;
mod diagram;
pub mod divided;
pub mod document;
pub mod grid;
pub mod page;

pub use atlas::Atlas;
pub(crate) use diagram::Bifurcation;
use document::Document;
use proofmass_base::control::Control;
use proofmass_base::error::Result;
use proofmass_base::parallel;
use proofmass_simulate::backend::orbits::Device;

/// Computes everything a document asks for.
///
/// # Errors
/// When the device fails or Ctrl-C stops it.
pub fn compute(document: Document, device: Device<'_>, control: &Control) -> Result<Atlas> {
    let rows: u64 = document.map.iter().map(|m| u64::from(m.y.points)).sum();
    let progress = control.stage("mapping", rows + document.bifurcation.len() as u64);
    let mut grids = Vec::new();
    for map in &document.map {
        grids.push(grid::compute(&document, map, 0..map.y.points, device, control, &progress)?);
    }
    let diagrams: Result<Vec<Bifurcation>> =
        parallel::map(&document.bifurcation, |d| diagram::compute(&document, d, control, &progress))
            .into_iter()
            .collect();
    Ok(Atlas { grids, diagrams: diagrams?, document })
}
