//! The paper, figure by figure: what each one claims, computed and checked.
//!
//! One file per subject, in the paper's order. Each returns plain numbers for its figures and the
//! checks that stand for what the paper says of them; `report::paper` draws. Not for the tool's own
//! answers about a user's sensor or recording.

#![warn(unreachable_pub)]

pub mod array;
pub mod attractor;
pub mod beliefs;
pub mod bifurcation;
pub mod check;
pub mod cubic;
pub mod envelope;
pub mod forcing;
pub mod fusion;
pub mod growth;
pub mod inertial;
pub mod linear;
pub mod moved;
pub mod page;
pub mod parting;
pub mod pitch;

use std::path::Path;

use check::Exhibit;
use proofmass_base::control::{Control, Stopped};
use proofmass_base::document::parse_toml;
use proofmass_base::error::Result;
use proofmass_map::Atlas;
use proofmass_simulate::backend::orbits::Device;

/// Every figure of the paper, computed, with its checks.
#[derive(Debug, Clone)]
pub struct Paper {
    /// Figure 1: an array of accelerometers.
    pub array: array::Array,
    /// Figures 2 to 4.
    pub growth: growth::Growth,
    /// Figures 5 to 10.
    pub pitch: pitch::Pitch,
    /// Figures 11 and 12.
    pub fusion: fusion::Fusion,
    /// Figures 13 to 15.
    pub linear: linear::Linear,
    /// Figure 16: the cubic spring.
    pub cubic: cubic::Cubic,
    /// Figures 17 to 19.
    pub attractor: attractor::Attractor,
    /// Figure 20 as the paper draws it.
    pub bifurcation: bifurcation::Bifurcation,
    /// Figure 20: the effect of noise.
    pub parting: parting::Parting,
    /// The maps and bifurcation diagrams around the paper's point.
    pub atlas: Option<Atlas>,
}

/// The committed map of the paper's equation.
const MAP: &str = include_str!("map.toml");

impl Paper {
    /// Figures 1 to 20 in order.
    pub fn exhibits(&self) -> Vec<&Exhibit> {
        let mut all = vec![&self.array.exhibit];
        all.extend(&self.growth.exhibits);
        all.extend(&self.pitch.exhibits);
        all.extend(&self.fusion.exhibits);
        all.extend(&self.linear.exhibits);
        all.push(&self.cubic.exhibit);
        all.extend(&self.attractor.exhibits);
        all.push(&self.parting.exhibit);
        all
    }
}

/// Computes all figures; those of a real IMU from the recordings in `data` where it holds them,
/// else simulated. `maps` asks for the two-dimensional maps too, which no check needs.
///
/// # Errors
/// A recording that cannot be used; Ctrl-C.
pub fn compute(data: Option<&Path>, maps: bool, device: Device<'_>, control: &Control) -> Result<Paper> {
    let stopped = |s: Stopped| s.during("could not finish the paper", "run it again; it takes about a minute");
    let progress = control.stage("twenty figures", 8);
    let step = || {
        progress.step();
        control.go_on().map_err(stopped)
    };
    let array = array::compute();
    step()?;
    let growth = growth::compute();
    step()?;
    let imu = match data.filter(|folder| folder.join("xsens_mti").is_dir()) {
        Some(folder) => inertial::recorded(folder, control)?,
        None => inertial::simulated(),
    };
    let pitch = pitch::compute(&imu);
    step()?;
    let fusion = fusion::compute(moved::compute(&imu, &pitch));
    step()?;
    let (linear, cubic) = (linear::compute(), cubic::compute());
    step()?;
    let attractor = attractor::compute(control).map_err(stopped)?;
    step()?;
    let bifurcation = bifurcation::compute(&attractor.drive);
    let mut parting = parting::compute(&attractor.drive, attractor.exponent);
    parting.exhibit.checks.splice(0..0, bifurcation.checks.iter().cloned());
    step()?;
    drop(progress);
    let atlas = match maps {
        true => {
            let mut document: proofmass_map::document::Document = parse_toml("reports/map/map.toml", MAP)?;
            document.drive.amplitude_n = attractor.drive.amplitude_n;
            Some(proofmass_map::compute(document, device, control)?)
        }
        false => None,
    };
    Ok(Paper { array, growth, pitch, fusion, linear, cubic, attractor, bifurcation, parting, atlas })
}

#[cfg(test)]
mod tests {
    // A package holds its own folder alone.
    #[test]
    fn the_map_is_the_one_under_reports() {
        assert_eq!(super::MAP, include_str!("../../reports/map/map.toml"));
    }
}
