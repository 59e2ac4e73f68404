//! `local-gravity`: gravity is not what the model states. In the library to be said, never to be
//! fitted: see `statement`.

use crate::candidate::{Candidate, Kind, Parameter};

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "local-gravity",
    kind: Kind::Tumble,
    statement: "Gravity where it was recorded is not what the model states; no pose can separate this from the common \
    scale.",
    equation: "|f| = g (1 + δ)",
    parameters: &[Parameter { name: "delta", unit: "1", range: (-0.006, 0.006) }],
    acts: "reference",
    signature: "none in the poses: the common scale absorbs it one for one",
    confusable_with: &["scale-factor"],
    reference: "WGS 84: 9.780 m/s² at the equator to 9.832 m/s² at the poles",
};
