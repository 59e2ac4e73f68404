//! The paper, figure by figure: what each one claims, computed and checked.
//!
//! One file per subject, in the paper's order. Each returns plain numbers for its figures and the checks that stand for
//! what the paper says of them; `report::paper` draws. Not for the tool's own answers about a user's sensor or recording.

pub mod array;
pub mod attractor;
pub mod check;
pub mod cubic;
pub mod envelope;
pub mod forcing;
pub mod fusion;
pub mod growth;
pub mod inertial;
pub mod linear;
pub mod moved;
pub mod parting;
pub mod pitch;
