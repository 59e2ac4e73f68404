//! Pictures of a sensor at rest: Allan deviations from the closed forms of IEEE 952, and what the laws of a
//! reading show in time.

use proofmass_numerics::numerics::allan::law::Term;
use proofmass_physics::candidate::{Candidate, Kind};
use proofmass_physics::signature::{self, Picture};
use proofmass_scenario::navigation::slow;

/// Memory of a fluctuating bias, in samples.
const MEMORY: f64 = 100.0;

/// Returns the picture of a candidate of this kind that is no law of a proof mass by the same name.
pub(super) fn picture(id: &str) -> Option<Picture> {
    let allan = |term: Term| Some(signature::next_to_white(|samples| term.variance(samples)));
    match id {
        "white-noise" => allan(Term::White),
        "flicker-noise" => allan(Term::Flicker),
        "random-walk" => allan(Term::Walk),
        "rate-ramp" => allan(Term::Ramp),
        "gauss-markov" => Some(signature::next_to_white(markov)),
        "quantisation-noise" => Some(signature::staircase()),
        "temperature-sensitivity" => Some(super::attitude::over_temperature()),
        "sinusoid" => of_a_law("periodic-disturbance"),
        _ => None,
    }
}

/// Allan variance of a process with a memory, from the mean square of its integral over one and two averaging times.
fn markov(samples: f64) -> f64 {
    let integral = |samples: f64| slow::markov(MEMORY, 1, samples);
    (4.0 * integral(samples) - integral(2.0 * samples)) / (2.0 * samples * samples)
}

/// The picture of a law of the reading.
fn of_a_law(id: &str) -> Option<Picture> {
    let law = proofmass_physics::library::CANDIDATES.iter().find(|law| law.id == id)?;
    signature::of(&Candidate { kind: Kind::Driven, ..*law })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bias_with_a_memory_has_its_hump_where_its_candidate_says() {
        let taus = || (0..2000).map(|i| MEMORY * 10f64.powf(f64::from(i) / 1000.0 - 1.0));
        let hump = taus().max_by(|a, b| markov(*a).total_cmp(&markov(*b)));
        assert!((hump.unwrap_or(0.0) / MEMORY - 1.89).abs() < 0.01, "{hump:?}");
    }
}
