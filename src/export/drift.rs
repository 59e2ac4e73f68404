//! Replaces a slowly moving bias in tools that know one process for it: a random walk, or a
//! first-order Gauss–Markov process; and how far its Allan deviation is from that of the sensor.

use super::imu::Errors;
use proofmass_base::number::short;

/// The process that a tool has for a moving bias.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// None: white noise alone.
    None,
    Walk,
    /// First-order Gauss–Markov; with a long correlation time, a random walk.
    GaussMarkov,
}

/// The bias process written for a sensor, and what is to be said of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Process {
    /// Strength of the white noise that drives it, unit/√s: the random walk K at times short
    /// against the correlation time.
    pub drive: f64,
    /// Correlation time, s; [`WALK_S`] for a random walk.
    pub correlation_s: f64,
    /// Holds what it stands for and by how much it is off; empty where it is exact.
    pub remark: String,
}

/// Correlation time that makes a Gauss–Markov process a random walk: at 1000 s its Allan deviation
/// is 0.04 % low.
pub(super) const WALK_S: f64 = 1e6;
/// Averaging time at which a substitute for bias instability agrees with it, s.
const AGREES_S: f64 = 100.0;
/// Allan deviation of bias instability over B: √(2 ln 2/π).
const FLAT: f64 = 0.664_28;
/// Averaging time of a Gauss–Markov process' largest Allan deviation over its correlation time, and
/// that deviation over drive × √(correlation time) (IEEE 952, annex C).
const PEAK: (f64, f64) = (1.892, 0.4365);

/// The nearest to the sensor's random walk and bias instability.
pub(super) fn process(errors: &Errors, form: Form) -> Process {
    let (walk, floor) = (errors.walk.mean, FLAT * errors.flicker.mean);
    let (drive, correlation_s) = match form {
        Form::None => (0.0, WALK_S),
        // Next to a walk, bias instability has no place.
        _ if walk > 0.0 || floor == 0.0 => (walk, WALK_S),
        Form::Walk => (floor * (3.0 / AGREES_S).sqrt(), WALK_S),
        Form::GaussMarkov => {
            let correlation_s = AGREES_S / PEAK.0;
            (floor / (PEAK.1 * correlation_s.sqrt()), correlation_s)
        }
    };
    let exact = floor == 0.0 && drive == walk;
    let mut process = Process { drive, correlation_s, remark: String::new() };
    if !exact {
        process.remark = remark(errors, &process, form);
    }
    process
}

fn remark(errors: &Errors, process: &Process, form: Form) -> String {
    let (white, walk, floor) = (errors.white.mean, errors.walk.mean, FLAT * errors.flicker.mean);
    let off: Vec<String> = [1.0, 10.0, 100.0, 1000.0]
        .into_iter()
        .map(|tau_s: f64| {
            let sensor = white * white / tau_s + floor * floor + walk * walk * tau_s / 3.0;
            let written = white * white / tau_s + gauss_markov(process, tau_s);
            // Adding zero takes the sign of a negative one.
            let percent = (100.0 * ((written / sensor).sqrt() - 1.0)).round() + 0.0;
            format!("{percent:+} % at {tau_s} s")
        })
        .collect();
    let lost = match (walk > 0.0, errors.flicker.mean > 0.0) {
        (true, true) if form == Form::None => {
            let b = short(errors.flicker.mean);
            format!("bias instability B = {b} {} and the random walk are not represented", errors.unit)
        }
        (true, false) => "the random walk is not represented".to_owned(),
        _ => format!("bias instability B = {} {} is not represented", short(errors.flicker.mean), errors.unit),
    };
    let instead = match form {
        Form::None => "nothing replaces it",
        _ if walk > 0.0 => "only the random walk is kept",
        Form::Walk => "a random walk with the same Allan deviation at 100 s replaces it",
        Form::GaussMarkov => "a Gauss–Markov process with its largest Allan deviation, at 100 s, replaces it",
    };
    format!("{lost}; {instead}. Error of the Allan deviation: {}", off.join(", "))
}

/// Allan variance of the process (IEEE 952, annex C).
fn gauss_markov(process: &Process, tau_s: f64) -> f64 {
    let (drive, correlation_s) = (process.drive, process.correlation_s);
    let x = tau_s / correlation_s;
    if x < 1e-3 {
        return drive * drive * tau_s / 3.0;
    }
    let bracket = 1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x);
    (drive * correlation_s).powi(2) / tau_s * bracket
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imu::Value;

    #[test]
    fn a_substitute_agrees_with_bias_instability_where_it_says() {
        let errors = Errors { flicker: Value { mean: 2.0, sd: 0.0 }, ..Errors::default() };
        for form in [Form::Walk, Form::GaussMarkov] {
            let process = process(&errors, form);
            let at = |tau_s: f64| gauss_markov(&process, tau_s).sqrt() / (FLAT * 2.0);
            assert!((at(100.0) - 1.0).abs() < 2e-3, "{form:?}: {}", at(100.0));
            assert!(at(1.0) < 0.5 && process.remark.contains("+0 % at 100 s"), "{}", process.remark);
        }
    }

    #[test]
    fn a_walk_is_exact_and_a_missing_one_is_said() {
        let errors = Errors { walk: Value { mean: 1.0, sd: 0.0 }, ..Errors::default() };
        let walk = process(&errors, Form::GaussMarkov);
        assert_eq!((walk.drive, walk.remark.as_str()), (1.0, ""));
        assert!((gauss_markov(&walk, 1000.0) / (1000.0 / 3.0) - 1.0).abs() < 2e-3);
        assert!(process(&errors, Form::None).remark.contains("-100 % at 1 s"));
    }
}
