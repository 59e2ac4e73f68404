//! States what the model of a sensor at rest may leave out; one file per candidate, with all that
//! is particular to it.
//!
//! A new candidate is a file here, a variant of `Cause` and its lines in `CANDIDATES`, `OFFERED`
//! and `row`.

mod band_limit;
mod earth_rate;
mod flicker_noise;
mod gauss_markov;
mod local_gravity;
mod quantisation_noise;
mod random_walk;
mod rate_ramp;
mod row;
mod sinusoid;
mod temperature_sensitivity;
mod warm_up;
mod white_noise;

pub(super) use gauss_markov::{MEMORIES, is_filter, memories};
pub(super) use row::{MOST_LAWS, Offer, Placed, Row};

use super::cause::Cause;
use crate::candidate::Candidate;
use row::JUMP;

/// States what one pose cannot tell from biases and scale factors: in the library to be said, never
/// to be fitted (`earth`).
pub(super) const LOCAL_GRAVITY: Candidate = local_gravity::CANDIDATE;
pub(super) const EARTH_RATE: Candidate = earth_rate::CANDIDATE;

/// The library of this kind.
pub const CANDIDATES: &[Candidate] = &[
    white_noise::CANDIDATE,
    quantisation_noise::CANDIDATE,
    flicker_noise::CANDIDATE,
    random_walk::CANDIDATE,
    rate_ramp::CANDIDATE,
    gauss_markov::CANDIDATE,
    sinusoid::CANDIDATE,
    warm_up::CANDIDATE,
    temperature_sensitivity::CANDIDATE,
    LOCAL_GRAVITY,
    EARTH_RATE,
];

/// States what each channel's selection offers, in this order. White noise is in every model; its
/// level is judged apart (`effects::of_level`).
pub(super) const OFFERED: [Cause; 9] = [
    Cause::QuantisationNoise,
    Cause::FlickerNoise,
    Cause::RandomWalk,
    Cause::GaussMarkov,
    Cause::BandLimit,
    Cause::RateRamp,
    Cause::WarmUp,
    Cause::Sinusoid,
    Cause::TemperatureSensitivity,
];

/// Returns what there is to know of a cause.
pub(super) fn row(cause: Cause) -> &'static Row {
    match cause {
        Cause::WhiteNoise => &white_noise::ROW,
        Cause::QuantisationNoise => &quantisation_noise::ROW,
        Cause::FlickerNoise => &flicker_noise::ROW,
        Cause::RandomWalk => &random_walk::ROW,
        Cause::RateRamp => &rate_ramp::ROW,
        Cause::GaussMarkov => &gauss_markov::ROW,
        Cause::Sinusoid => &sinusoid::ROW,
        Cause::WarmUp => &warm_up::ROW,
        Cause::TemperatureSensitivity => &temperature_sensitivity::ROW,
        Cause::BandLimit => &band_limit::ROW,
        Cause::Jump => &JUMP,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_offered_is_in_the_library_or_no_physics_and_no_entry_is_left_over() {
        let mut entries: Vec<&str> = OFFERED.iter().filter_map(|c| row(*c).entry).map(|e| e.id).collect();
        assert_eq!(entries.len(), OFFERED.len() - 1, "the band limit alone is no physics left out");
        entries.extend(row(Cause::WhiteNoise).entry.map(|e| e.id));
        entries.extend([LOCAL_GRAVITY.id, EARTH_RATE.id]);
        assert!(CANDIDATES.iter().all(|c| entries.contains(&c.id)) && entries.len() == CANDIDATES.len(), "{entries:?}");
    }
}
