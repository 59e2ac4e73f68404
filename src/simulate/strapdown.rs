//! Six axes along a trajectory: how far a strapdown navigator drifts, in which direction, and which
//! error is to blame.
//!
//! Study in motion × backend → sums → envelopes, with the linear covariance next to each. Not for
//! one axis at rest on a flat Earth: that is `drift`.

pub mod aiding;
pub mod answer;
pub mod backends;
pub mod covariance;
pub mod divided;
pub mod document;
mod family;
mod gains;
mod held;
pub mod kept;
pub mod left_out;
mod linear;
pub mod outages;
pub mod own_error;
pub mod position;
pub mod run;
pub mod share;
mod spreads;
mod totals;
pub mod windows;
