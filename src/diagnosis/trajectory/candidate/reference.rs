//! `reference-noise`: the reference itself errs.

use crate::candidate::{Candidate, Kind, Parameter};

/// Library entry of `reference-noise`.
pub const REFERENCE_NOISE: Candidate = Candidate {
    id: "reference-noise",
    kind: Kind::Trajectory,
    statement: "The reference errs by more than the sensor does over short times.",
    equation: "R_reference = exp(n) R, p_reference = p + m",
    parameters: &[
        Parameter { name: "attitude", unit: "mrad", range: (0.0, 1e6) },
        Parameter { name: "position", unit: "mm", range: (0.0, 1e6) },
    ],
    acts: "reference",
    signature: "a residual that does not grow with time as noise of the sensor does",
    confusable_with: &["vibration"],
    reference: "Geneva & Huang, vicon2gt: derivations and analysis, RPNG-2020-VICON2GT",
};
