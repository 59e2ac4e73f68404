//! `earth-rate`: the gyro at rest feels the Earth turn. In the library to be said, never to be
//! fitted: see `statement`.

use crate::candidate::{Candidate, Kind, Parameter};

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "earth-rate",
    kind: Kind::Static,
    statement: "The means of the gyro hold the Earth's rotation, 15.04 °/h; in one pose it cannot be told from \
    biases.",
    equation: "|w| = Ω",
    parameters: &[Parameter { name: "difference", unit: "°/h", range: (-1e6, 1e6) }],
    acts: "reference",
    signature: "the vector of the three means is as long as the Earth's rate",
    confusable_with: &[],
    reference: "IERS: 7.292115e-5 rad/s",
};
