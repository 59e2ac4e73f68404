//! One map: every cell an orbit of its own from rest.

use std::ops::Range;

use super::document::{Document, Map, Quantity};
use proofmass_base::control::{Control, Progress};
use proofmass_base::error::Result;
use proofmass_kernel::orbit::{Plan, Point};
use proofmass_physics::dynamics::duffing::{Drive, Oscillator};
use proofmass_simulate::backend::orbits::{Device, explore_on};

/// Strobes recorded to recognise a period: up to half as many can be found.
const STROBES: u32 = 32;
/// Strobes agree, relative to their size, when they repeat: above rounding in f32, below any period
/// doubling drawn here.
const TOLERANCE: f32 = 2e-3;

/// A computed map; rows from the bottom up.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Its section of map.toml.
    pub map: Map,
    /// Largest Lyapunov exponent, 1/s; NaN where the orbit was lost.
    pub exponent_per_s: Vec<f64>,
    /// Period in periods of the force; zero where none up to 16 was found.
    pub period: Vec<u32>,
    /// Runge–Kutta steps per period, fewest and most.
    pub steps: (u32, u32),
}

impl Grid {
    /// Share of cells that are chaotic: a positive exponent and no period.
    pub fn chaotic_share(&self) -> f64 {
        let chaotic = self.exponent_per_s.iter().zip(&self.period).filter(|(e, p)| **e > 0.01 && **p == 0).count();
        chaotic as f64 / self.exponent_per_s.len().max(1) as f64
    }

    /// Cells whose orbit was lost: its numbers left their range, or a step was too long for it.
    pub fn lost(&self) -> usize {
        self.exponent_per_s.iter().filter(|e| !e.is_finite()).count()
    }

    /// The cell that holds a point, if it lies inside.
    pub fn cell(&self, x: f64, y: f64) -> Option<usize> {
        let part = |axis: &super::document::Range, v: f64| {
            let fraction = (v - axis.from) / (axis.to - axis.from);
            (0.0..1.0).contains(&fraction).then_some((fraction * f64::from(axis.points)) as usize)
        };
        Some(part(&self.map.y, y)? * self.map.x.points as usize + part(&self.map.x, x)?)
    }
}

fn set(oscillator: &mut Oscillator, drive: &mut Drive, quantity: Quantity, value: f64) {
    match quantity {
        Quantity::AmplitudeN => drive.amplitude_n = value,
        Quantity::OmegaRadS => drive.omega_rad_s = value,
        Quantity::FrequencyHz => drive.omega_rad_s = 2.0 * std::f64::consts::PI * value,
        Quantity::CubicNM3 => oscillator.cubic_n_m3 = value,
        Quantity::DampingKgS => oscillator.damping_kg_s = value,
        Quantity::StiffnessNM => oscillator.stiffness_n_m = value,
    }
}

/// Cells that a device is given in one go: few enough for a progress bar that moves, and enough to
/// fill a card.
fn at_once(device: Device<'_>) -> usize {
    match device {
        Device::Gpu(gpu) if gpu.adapter.hardware => 1 << 20,
        Device::Gpu(_) | Device::Cpu => 1 << 14,
    }
}

/// Computes rows of a map one by one; each takes the step its stiffest cell needs.
///
/// # Errors
/// When the device fails or Ctrl-C stops it.
pub fn compute(
    document: &Document,
    map: &Map,
    rows: Range<u32>,
    device: Device<'_>,
    control: &Control,
    progress: &Progress,
) -> Result<Grid> {
    let first = rows.start;
    let mut grid = Grid { map: map.clone(), exponent_per_s: vec![], period: vec![], steps: (u32::MAX, 0) };
    // Rows that need the same step are one job, so that a device is filled.
    let mut stepped: Vec<(u32, Vec<Point>)> = Vec::new();
    for y in rows {
        let mut steps = 0;
        let points = (0..map.x.points)
            .map(|x| {
                let mut oscillator: Oscillator = document.oscillator.into();
                let mut drive =
                    Drive { amplitude_n: document.drive.amplitude_n, omega_rad_s: document.drive.omega_rad_s() };
                set(&mut oscillator, &mut drive, map.x.quantity, map.x.at(x));
                set(&mut oscillator, &mut drive, map.y.quantity, map.y.at(y));
                steps = steps.max(oscillator.steps_per_period(drive.amplitude_n, drive.omega_rad_s));
                let noise_m_s2_rts = map.noise_n_rts / oscillator.mass_kg;
                Point { noise_m_s2_rts, ..Point::at_rest(&oscillator, &drive) }
            })
            .collect::<Vec<_>>();
        // Rounded up so that neighbouring rows share a step.
        stepped.push((steps.next_multiple_of(32), points));
    }
    // Members are numbered over the whole map: a row's noise does not depend on which rows are
    // computed.
    let mut done = u64::from(first) * u64::from(map.x.points);
    for group in stepped.chunk_by(|a, b| a.0 == b.0) {
        for part in group.chunks((at_once(device) / map.x.points as usize).max(1)) {
            let points: Vec<Point> = part.iter().flat_map(|r| r.1.iter().copied()).collect();
            let plan = Plan {
                seed: document.seed,
                first_member: done,
                steps_per_period: part[0].0,
                transient_periods: map.transient_periods,
                periods: map.periods,
                strobes: STROBES,
            };
            done += points.len() as u64;
            for orbit in explore_on(device, &points, &plan, control)? {
                grid.exponent_per_s.push(orbit.exponent_per_s);
                grid.period.push(orbit.period(TOLERANCE).unwrap_or(0));
            }
            grid.steps = (grid.steps.0.min(part[0].0), grid.steps.1.max(part[0].0));
            progress.add(part.len() as u64);
        }
    }
    Ok(grid)
}
