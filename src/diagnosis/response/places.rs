//! Places from which a law may begin, wherever the model without it stands: for each ω₀, Γ and strength of a
//! grid the gain and the background that fit best are known at once.
//!
//! The force of the law is that of the motion that was read, less the background found so far; a few rounds
//! find that background. A spring that leans over by many widths is out of reach of a fit that begins at a
//! linear resonance.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::beginnings::{PLACES, WIDTHS, in_place};
use super::force::Oscillator;
use super::intake::Sweeps;
use super::predicted::{REACH, beside, readout, shapes};
use super::steady_state::Table;
use super::values::{Sizes, Values};

/// Steps that are looked at, at most.
const STEPS: usize = 128;
/// Widths by which the law moves the resonance or widens it, at the largest amplitude.
const MOVES: [f64; 7] = [0.3, 1.0, 2.0, 3.5, 5.5, 8.0, 12.0];
/// Rounds in which the background settles.
const ROUNDS: usize = 4;

type Phasor = Complex<f64>;

/// The chosen steps, with the background taken out.
struct Steps {
    chosen: Vec<usize>,
    /// Orthonormal shapes of the background.
    basis: Vec<Vec<f64>>,
    /// Reading without the background's shapes.
    rest: Vec<Phasor>,
}

impl Steps {
    fn new(reading: &[Phasor], shapes: &[Vec<f64>], chosen: Vec<usize>) -> Self {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for shape in shapes {
            let mut own: Vec<f64> = chosen.iter().map(|k| shape[*k]).collect();
            for known in &basis {
                let part: f64 = own.iter().zip(known).map(|(a, b)| a * b).sum();
                own.iter_mut().zip(known).for_each(|(a, b)| *a -= part * b);
            }
            let size = own.iter().map(|v| v * v).sum::<f64>().sqrt();
            if size > 1e-9 {
                own.iter_mut().for_each(|v| *v /= size);
                basis.push(own);
            }
        }
        let mut rest: Vec<Phasor> = chosen.iter().map(|k| reading[*k]).collect();
        for known in &basis {
            let part: Phasor = rest.iter().zip(known).map(|(y, b)| y * b).sum();
            rest.iter_mut().zip(known).for_each(|(y, b)| *y -= part * b);
        }
        Self { chosen, basis, rest }
    }

    /// Part of the power of the rest that a motion does not account for.
    fn left(&self, motion: &[Phasor]) -> f64 {
        let mut square: f64 = motion.iter().map(|m| m.norm_sqr()).sum();
        for known in &self.basis {
            square -= motion.iter().zip(known).map(|(m, b)| m * b).sum::<Phasor>().norm_sqr();
        }
        let common: Phasor = motion.iter().zip(&self.rest).map(|(m, y)| m.conj() * y).sum();
        let power: f64 = self.rest.iter().map(|y| y.norm_sqr()).sum();
        power - common.norm_sqr() / square.max(1e-300)
    }
}

/// Holds a model whose last law is to be placed, and the steps that it is held against.
struct Placing<'a> {
    sweeps: &'a Sweeps,
    values: &'a Values,
    steps: Steps,
    shapes: Vec<Vec<f64>>,
    /// Reading over displacement, and the reading without other modes.
    read: Vec<Phasor>,
    alone: Vec<Phasor>,
    /// Reading of a unit of displacement per force, times the drive.
    push: Vec<Phasor>,
    /// Force of the law, and of the others.
    tables: [Table; 2],
    band_rad_s: [f64; 2],
}

/// ω₀, Γ and a strength, with what they leave.
#[derive(Clone, Copy)]
struct Node {
    mass: Oscillator,
    strength: f64,
    left: f64,
}

impl<'a> Placing<'a> {
    fn new(sweeps: &'a Sweeps, sizes: &Sizes, values: &'a Values) -> Option<Self> {
        let all = 0..sweeps.len();
        let (law, others) = values.laws.split_last()?;
        let counted: Vec<usize> = all.clone().filter(|k| sweeps.counts[*k]).collect();
        let stride = counted.len().div_ceil(STEPS).max(1);
        let chosen: Vec<usize> = counted.into_iter().step_by(stride).collect();
        let shape: Vec<[f64; 4]> = all.clone().map(|k| shapes(sweeps, sizes, k)).collect();
        let shapes: Vec<Vec<f64>> =
            (0..values.background.len()).map(|i| shape.iter().map(|s| s[i]).collect()).collect();
        let read: Vec<Phasor> = all.clone().map(|k| readout(sweeps, sizes, values, k)).collect();
        let alone: Vec<Phasor> = all.map(|k| sweeps.reading[k] - read[k] * beside(sweeps, values, k)).collect();
        let turn = Phasor::from_polar(1.0, -values.angle_rad);
        let push = read.iter().zip(&sweeps.drive).map(|(r, d)| r * turn * d).collect();
        let steps = Steps::new(&alone, &shapes, chosen);
        let band_rad_s = sizes.band_hz.map(|f| TAU * f);
        let most = REACH * sizes.amplitude;
        let tables = [std::slice::from_ref(law), others].map(|laws| Table::rough(&values.mass, laws, most, band_rad_s));
        Some(Self { sweeps, values, steps, shapes, read, alone, push, tables, band_rad_s })
    }

    /// Impedance of the law, and of the others, at the motion that a background leaves of the reading.
    fn forces(&self, background: &[Phasor]) -> Vec<[Phasor; 2]> {
        let (mass, others) = (&self.values.mass, &self.values.laws[..self.values.laws.len() - 1]);
        let of = |k: &usize| -> [Phasor; 2] {
            let omega = TAU * self.sweeps.frequency_hz[*k];
            let back: Phasor = background.iter().zip(&self.shapes).map(|(b, s)| b * s[*k]).sum();
            let a = ((self.alone[*k] - back) / self.read[*k]).norm();
            let time_s = self.sweeps.time_s.as_ref().map_or(0.0, |t| t[*k]);
            let bare = Phasor::new(mass.omega_rad_s.powi(2) - omega * omega, omega * mass.damping_per_s);
            let linear: Phasor = others.iter().filter(|l| l.is_linear()).map(|l| l.linear(mass, omega, time_s)).sum();
            let [own, rest] = [0, 1].map(|i| self.tables[i].along(mass, omega, Phasor::from(0.0)).at(a).0 - bare);
            [own, rest - linear]
        };
        self.steps.chosen.iter().map(of).collect()
    }

    /// Motion of a step for a unit of gain.
    fn motion(&self, k: usize, [own, rest]: [Phasor; 2], mass: &Oscillator, strength: f64) -> Phasor {
        let omega = TAU * self.sweeps.frequency_hz[k];
        let bare = Phasor::new(mass.omega_rad_s.powi(2) - omega * omega, omega * mass.damping_per_s);
        self.push[k] / (bare + rest + own * strength)
    }

    /// The node of the grid that leaves least.
    fn least(&self, forces: &[[Phasor; 2]]) -> Option<Node> {
        let most = forces.iter().map(|f| f[0].norm()).fold(0.0, f64::max);
        let [low, high] = self.band_rad_s;
        let mut motion = vec![Phasor::from(0.0); self.steps.chosen.len()];
        let mut best: Option<Node> = None;
        for omega_rad_s in (0..PLACES).map(|i| low + (high - low) * (i as f64 + 0.5) / PLACES as f64) {
            for damping_per_s in WIDTHS.map(|width| width * (high - low)) {
                let mass = Oscillator { omega_rad_s, damping_per_s };
                let moves = MOVES.into_iter().map(|widths| widths * damping_per_s).filter(|m| *m < high - low);
                let strengths = moves.flat_map(|m| [1.0, -1.0].map(|sign| sign * 2.0 * omega_rad_s * m / most));
                // A law that does not act on the mass stays as it is.
                let as_it_is = (most == 0.0).then_some(1.0);
                for strength in strengths.filter(|_| most > 0.0).chain(as_it_is) {
                    for ((m, k), force) in motion.iter_mut().zip(&self.steps.chosen).zip(forces) {
                        *m = self.motion(*k, *force, &mass, strength);
                    }
                    let left = self.steps.left(&motion);
                    if best.is_none_or(|b| left < b.left) {
                        best = Some(Node { mass, strength, left });
                    }
                }
            }
        }
        best.filter(|b| b.left.is_finite())
    }

    /// The model at a node, with the gain and the background that fit best.
    fn model(&self, forces: &[[Phasor; 2]], node: Node) -> Option<Values> {
        let place = |k: usize| self.steps.chosen.binary_search(&k).ok();
        let mut some = self.sweeps.clone();
        some.counts = (0..some.len()).map(|k| place(k).is_some()).collect();
        some.reading.clone_from(&self.alone);
        let motion =
            |k: usize| place(k).map_or(Phasor::from(0.0), |i| self.motion(k, forces[i], &node.mass, node.strength));
        let (gain, background, _) = in_place(&some, &self.shapes, motion)?;
        let mut model = Values {
            mass: node.mass,
            gain: gain.norm(),
            angle_rad: gain.arg(),
            settling: 0.0,
            background,
            laws: self.values.laws.clone(),
        };
        model.laws.last_mut()?.values[0] *= node.strength;
        (model.gain.is_finite() && model.gain > 0.0).then_some(model)
    }
}

/// The best model of the grid for the last law of a model, whose form stays as it is.
pub(super) fn place(sweeps: &Sweeps, sizes: &Sizes, values: &Values) -> Option<Values> {
    let placing = Placing::new(sweeps, sizes, values)?;
    let mut background = vec![Phasor::from(0.0); values.background.len()];
    let mut found: Option<(f64, Values)> = None;
    for _ in 0..ROUNDS {
        let forces = placing.forces(&background);
        let node = placing.least(&forces)?;
        let model = placing.model(&forces, node)?;
        background.clone_from(&model.background);
        match &found {
            Some(known) if known.0 <= node.left => break,
            _ => found = Some((node.left, model)),
        }
    }
    found.map(|f| f.1)
}
