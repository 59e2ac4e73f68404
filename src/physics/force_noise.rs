//! White noise that enters as a force, so that the resonance shapes it.
//!
//! It changes no simulation but what the next sample is expected to be, given the ones before.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Noise, Role};
use super::scales::{Coordinate, Scales};

/// White force noise on the mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ForceNoise;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "force-noise",
    kind: Kind::Driven,
    statement: "Noise enters as a force before the proof mass, which colours it like the resonator itself.",
    equation: "x″ + 2ζω₀x′ + ω₀²x = g·u + w, w white",
    parameters: &[Parameter { name: "rms_displacement", unit: "y", range: (0.0, 1.0) }],
    acts: "noise in the equation of motion",
    signature: "the residual rings at the resonance; its next sample follows from the ones before",
    confusable_with: &["bias-random-walk"],
    reference: "Gabrielson, Mechanical-thermal noise in micromachined sensors, IEEE T-ED 40 (1993); Ljung, System Identification, 1999, ch. 4",
};

impl Law for ForceNoise {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Noise(Noise::Force)
    }
    fn coordinates(&self, _: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Log(1e-3, 1e3)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        [0.1, 0.3, 1.0, 3.0, 10.0, 100.0].map(|r| vec![r]).to_vec()
    }
}
