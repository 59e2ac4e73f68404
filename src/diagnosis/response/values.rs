//! A model of sweeps in its own units, and the sizes by which its coordinates are measured.

use nalgebra::Complex;

use crate::physics::scales::Scales;

use super::force::{Law, Oscillator};

/// Sizes that coordinates are measured by.
#[derive(Debug, Clone)]
pub(super) struct Sizes {
    /// Of the laws.
    pub laws: Scales,
    /// Γ of the resonance, 1/s.
    pub damping_per_s: f64,
    /// Largest reading.
    pub reading: f64,
    /// Largest displacement.
    pub amplitude: f64,
    /// Largest drive.
    pub drive: f64,
    /// Lowest and highest frequency, Hz.
    pub band_hz: [f64; 2],
}

/// A model in its own units.
#[derive(Debug, Clone)]
pub(super) struct Values {
    /// ω₀ and Γ.
    pub mass: Oscillator,
    /// Acceleration per unit of drive.
    pub gain: f64,
    /// Angle of the reading against the motion, rad.
    pub angle_rad: f64,
    /// Part of a reading that the step before holds.
    pub settling: f64,
    /// Background: constant, in proportion to distance in frequency; the same two per unit of drive
    /// where drives differ.
    pub background: Vec<Complex<f64>>,
    /// Laws in the order of the set.
    pub laws: Vec<Law>,
}
