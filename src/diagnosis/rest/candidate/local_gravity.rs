//! `local-gravity`: the length of the specific force at rest is not gravity's at the place. In the
//! library to be said, never to be fitted: see `statement`.

use crate::candidate::{Candidate, Kind, Parameter};

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "local-gravity",
    kind: Kind::Static,
    statement: "Gravity where it was recorded is not what the accelerometer reads; in one pose neither the place nor \
    biases nor scale factors can be told from each other.",
    equation: "|f| = g(latitude, height)",
    parameters: &[Parameter { name: "difference", unit: "m/s^2", range: (-0.05, 0.05) }],
    acts: "reference",
    signature: "the vector of the three means is longer or shorter than gravity at latitude_deg, height_m",
    confusable_with: &[],
    reference: "WGS 84: 9.780 m/s² at the equator to 9.832 m/s² at the poles",
};
