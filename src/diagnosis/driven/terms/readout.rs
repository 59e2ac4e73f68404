//! What the readout does to the displacement: it clips, it rounds, it bends.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Cloud, Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// Rails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation;

/// What the library says of it.
pub const SATURATION: Candidate = Candidate {
    id: "readout-saturation",
    kind: Kind::Driven,
    statement: "The readout clips: the reading stays at a rail while the mass moves on.",
    equation: "y = min(max(x, low), high)",
    parameters: &[
        Parameter { name: "low", unit: "y", range: (-10.0, 0.0) },
        Parameter { name: "high", unit: "y", range: (0.0, 10.0) },
    ],
    acts: "readout",
    signature: "flat tops in the reading; the motion afterwards is as if nothing had happened",
    confusable_with: &["end-stop", "readout-nonlinearity", "cubic-stiffness"],
    reference: "IEEE 1293, input range and clipping",
};

impl Physics for Saturation {
    fn words(&self) -> &'static Candidate {
        &SATURATION
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output); 2]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let (low, high) = s.output_range;
        let far = 100.0 * s.output;
        [0.9999, 0.97, 0.88, 0.7]
            .into_iter()
            .flat_map(|r| {
                let [inner_low, inner_high] = [low, high].map(|end| s.centre + r * (end - s.centre));
                [vec![inner_low, inner_high], vec![low - far, inner_high], vec![inner_low, high + far]]
            })
            .collect()
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            y[l] = y[l].max(p[0][l]).min(p[1][l]);
        }
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn reads(&self) -> Option<u8> {
        Some(9)
    }
    /// Rails from just inside the extremes to halfway, on either side or both.
    fn cloud(&self, s: &Scales) -> Option<Cloud> {
        let (c, far) = (s.centre, 100.0 * s.output);
        let (low, high) = (s.output_range.0 - c, s.output_range.1 - c);
        let levels = [0.9999, 0.995, 0.985, 0.97, 0.94, 0.9, 0.86, 0.81, 0.75, 0.68, 0.6, 0.5];
        let rails = |r: f64| [vec![c + r * low, c + r * high], vec![c - far, c + r * high], vec![c + r * low, c + far]];
        Some(Cloud::Points(levels.into_iter().flat_map(rails).collect()))
    }
}

/// Rounding to a step. No simulation is changed; it is judged by the likelihood of the values themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantisation;

/// What the library says of it.
pub const QUANTISATION: Candidate = Candidate {
    id: "readout-quantisation",
    kind: Kind::Driven,
    statement: "The reading is rounded to steps that are coarse beside the noise.",
    equation: "y = step · round(x / step)",
    parameters: &[Parameter { name: "step", unit: "y", range: (0.0, 1.0) }],
    acts: "readout",
    signature: "readings fall on few, evenly spaced values; the residual is spread evenly over one step",
    confusable_with: &[],
    reference: "Widrow & Kollár, Quantization Noise, 2008; IEEE 952, annex C",
};

impl Physics for Quantisation {
    fn words(&self) -> &'static Candidate {
        &QUANTISATION
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(s.residual)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
}

/// x + k₂x² + k₃x³ at the readout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial;

/// What the library says of it.
pub const POLYNOMIAL: Candidate = Candidate {
    id: "readout-nonlinearity",
    kind: Kind::Driven,
    statement: "The readout bends: reading and displacement are not proportional.",
    equation: "y = x + k₂x² + k₃x³",
    parameters: &[
        Parameter { name: "k2", unit: "1/y", range: (-1.0, 1.0) },
        Parameter { name: "k3", unit: "1/y^2", range: (-1.0, 1.0) },
    ],
    acts: "readout",
    signature: "harmonics that the resonance does not filter; the resonance does not move with amplitude",
    confusable_with: &["cubic-stiffness", "quadratic-stiffness", "readout-saturation"],
    reference: "IEEE 1293, nonlinearity coefficients K₂ and K₃",
};

impl Physics for Polynomial {
    fn words(&self) -> &'static Candidate {
        &POLYNOMIAL
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / s.output), Coordinate::Linear(0.1 / s.output.powi(2))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            let x = y[l];
            y[l] += x * x * (p[0][l] + p[1][l] * x);
        }
    }
    fn reads(&self) -> Option<u8> {
        Some(2)
    }
}
