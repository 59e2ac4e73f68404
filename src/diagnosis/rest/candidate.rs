//! What the model of a sensor at rest may leave out.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

/// A size: positive.
const fn parameter(name: &'static str, unit: &'static str) -> Parameter {
    Parameter { name, unit, range: (0.0, f64::MAX) }
}

/// Of either sign.
const fn signed(name: &'static str, unit: &'static str) -> Parameter {
    Parameter { name, unit, range: (f64::MIN, f64::MAX) }
}

const IEEE: &str = "IEEE Std 952-1997 (R2008), annex C";

/// The library of this kind.
pub const CANDIDATES: &[Candidate] = &[
    Candidate {
        id: "white-noise",
        kind: Kind::Static,
        statement: "The white noise is not at the level that the datasheet promises.",
        equation: "S(f) = n²",
        parameters: &[parameter("density", "y/√Hz")],
        acts: "readout",
        signature: "The Allan curve lies beside the promised one by one factor at short times.",
        confusable_with: &["quantisation-noise"],
        reference: IEEE,
    },
    Candidate {
        id: "quantisation-noise",
        kind: Kind::Static,
        statement: "The reading is rounded to a step as coarse as its noise.",
        equation: "y = q·round(x/q)",
        parameters: &[parameter("step", "y")],
        acts: "readout",
        signature: "All values lie on a grid; rounding adds q²/12 to the variance.",
        confusable_with: &["white-noise"],
        reference: "Widrow & Kollár, Quantization Noise, Cambridge 2008",
    },
    Candidate {
        id: "flicker-noise",
        kind: Kind::Static,
        statement: "The bias flickers: its noise density rises as 1/f towards low frequencies.",
        equation: "S(f) = B²/(πf)",
        parameters: &[parameter("B", "y")],
        acts: "readout",
        signature: "The Allan deviation has a floor at 0.664 B.",
        confusable_with: &["gauss-markov", "random-walk"],
        reference: IEEE,
    },
    Candidate {
        id: "random-walk",
        kind: Kind::Static,
        statement: "The bias wanders as a random walk.",
        equation: "db = K dW",
        parameters: &[parameter("K", "y/√s")],
        acts: "readout",
        signature: "The Allan deviation rises as √τ; the density as 1/f².",
        confusable_with: &["flicker-noise", "temperature-sensitivity", "rate-ramp"],
        reference: IEEE,
    },
    Candidate {
        id: "rate-ramp",
        kind: Kind::Static,
        statement: "The bias drifts along a straight line.",
        equation: "b(t) = R t",
        parameters: &[signed("rate", "y/s")],
        acts: "readout",
        signature: "The Allan deviation rises as τ.",
        confusable_with: &["warm-up", "random-walk"],
        reference: IEEE,
    },
    Candidate {
        id: "gauss-markov",
        kind: Kind::Static,
        statement: "The bias fluctuates with a memory of finite length.",
        equation: "db = −b/T dt + σ√(2/T) dW",
        parameters: &[parameter("sigma", "y"), parameter("T", "s")],
        acts: "readout",
        signature: "The Allan deviation has a hump at 1.89 T.",
        confusable_with: &["flicker-noise", "random-walk"],
        reference: IEEE,
    },
    Candidate {
        id: "sinusoid",
        kind: Kind::Static,
        statement: "A sine is picked up: vibration, mains or a switching supply.",
        equation: "b(t) = A sin(2πft + φ)",
        parameters: &[parameter("amplitude", "y"), parameter("frequency", "Hz")],
        acts: "readout",
        signature: "A single line in the spectrum; ripples in the Allan curve.",
        confusable_with: &[],
        reference: IEEE,
    },
    Candidate {
        id: "warm-up",
        kind: Kind::Static,
        statement: "The bias settles exponentially after switching on.",
        equation: "b(t) = A e^(−t/T)",
        parameters: &[signed("amplitude", "y"), parameter("T", "s")],
        acts: "readout",
        signature: "A drift that is fast at first and dies out.",
        confusable_with: &["rate-ramp"],
        reference: "Titterton & Weston, Strapdown Inertial Navigation Technology, 2nd ed., IET 2004",
    },
    Candidate {
        id: "temperature-sensitivity",
        kind: Kind::Static,
        statement: "The bias follows temperature, or another slow cause that channels share.",
        equation: "b = s (θ − θ̄)",
        parameters: &[signed("slope", "y per unit of the environment")],
        acts: "readout",
        signature: "Channels drift together; the drift follows an environment column.",
        confusable_with: &["random-walk"],
        reference: "Titterton & Weston, Strapdown Inertial Navigation Technology, 2nd ed., IET 2004",
    },
];

/// The entry with this id; ids in this folder are its own, so it is always there.
pub(super) fn entry(id: &str) -> &'static Candidate {
    CANDIDATES.iter().find(|c| c.id == id).unwrap_or(&CANDIDATES[0])
}
