//! Checks whether the numbers of a proof mass, and of what reads it, go together.

use super::refusal::refuse;
use super::tolerances::Tolerances;
use crate::error::Result;
use crate::excitation::Waveform;
use crate::excitation::plan::Variation;
use crate::motion::temperature::Temperature;
use crate::number::short;
use crate::physics::coefficients::laws;
use crate::physics::{hysteresis, stiffness_drift, warm_stiffness};
use crate::sensor::{ProofMass, SensorTerm, mechanics};
use crate::units::key::Key;
use crate::units::number::Number;

/// Refuses a delay that differs between members: it is one of the force that all of them share.
pub(super) fn one_delay(name: &str, all: &Tolerances) -> Result<()> {
    let key = &SensorTerm::ReadoutDelay.row().keys[0];
    match all[key] {
        None | Some(Number::Fixed(_)) => Ok(()),
        Some(_) => Err(refuse(
            name,
            format!("`{}` is drawn per member: a study runs one delay for all of them", key.path),
            format!("give one number, and sweep it for others, e.g. [sweep] {} = \"0.001:0.01:4\"", key.path),
        )),
    }
}

/// Refuses a delay next to a sine that is drawn per member.
pub(super) fn delayed_force(name: &str, all: &Tolerances, variation: Variation) -> Result<()> {
    let key = &SensorTerm::ReadoutDelay.row().keys[0];
    if variation != Variation::Sine || all[key].is_none_or(|n| n.is_zero()) {
        return Ok(());
    }
    Err(refuse(
        name,
        format!("`{}` cannot be combined with a sine that is drawn per member", key.path),
        "give the sine's amplitude, frequency and phase as one number each",
    ))
}

/// Which number of a law is given, and which are not, where a law is given in part.
fn in_part(all: &Tolerances) -> Option<(&'static Key, String)> {
    laws().iter().find_map(|law| {
        let keys = || law.given().iter().map(|given| &given.key);
        let has = keys().find(|key| all[key].is_some())?;
        let lacks: Vec<String> =
            keys().filter(|key| all[key].is_none() && key.absent == 0.0).map(|key| format!("`{}`", key.path)).collect();
        (!lacks.is_empty()).then(|| (has, lacks.join(" and ")))
    })
}

/// Refuses numbers of a proof mass that do not determine it, or determine it twice.
pub(super) fn mechanics(name: &str, all: &Tolerances) -> Result<()> {
    let given = |key: &&Key| all[key].is_some();
    let first = |keys: &'static [Key]| keys.iter().find(given);
    let (modal, further, physical) = (first(mechanics::MODAL), first(mechanics::further()), first(mechanics::PHYSICAL));
    if let (Some(a), Some(b)) = (modal, physical) {
        return Err(refuse(
            name,
            format!("`{}` and `{}` describe the proof mass in two ways", a.path, b.path),
            "give either resonance, damping ratio and cubic stiffness, or mass, damping, stiffness and cubic stiffness",
        ));
    }
    if let Some((has, lacks)) = in_part(all) {
        let cause = format!("`{}` is given without {lacks}", has.path);
        return Err(refuse(name, cause, format!("add {lacks}, or remove `{}`", has.path)));
    }
    let missing = match (modal.or(further), physical) {
        (_, Some(p)) => [&mechanics::MASS, &mechanics::STIFFNESS].into_iter().find(|m| !given(m)).map(|m| (p, m)),
        (Some(p), None) if !given(&&mechanics::RESONANCE) => Some((p, &mechanics::RESONANCE)),
        _ => None,
    };
    match missing {
        Some((has, lacks)) => Err(refuse(
            name,
            format!("`{}` is given without `{}`", has.path, lacks.path),
            format!("add `{}`, or leave the mechanics out for an ideal proof mass", lacks.path),
        )),
        None => Ok(()),
    }
}

/// Motion of proof masses, as far as the length of their steps hangs on it.
pub(super) struct Moved<'a> {
    pub stiffest: Option<&'a ProofMass>,
    pub waveform: &'a dyn Waveform,
    /// Largest factor of the waveform.
    pub gain: f64,
    /// Amplitude of a sine that each member draws, at most, m/s².
    pub own_sine_m_s2: f64,
    pub duration_s: f64,
    /// One substep.
    pub substep_s: f64,
}

/// Refuses steps in which a mass moves so far that its spring with memory is no longer followed:
/// n(β + |γ|), or β + |γ| where n is below one, times the way of a substep must stay where Runge–Kutta is stable. The way is that of a
/// well damped mass at its resonance, for the largest force that is seen. Members that go farther
/// all the same leave their range and are reported as failed.
pub(super) fn followed_memory(name: &str, moved: &Moved<'_>) -> Result<()> {
    /// Below 2.78, where the decay of e^(−x) turns into growth.
    const MOST: f64 = 2.5;
    /// Instants at which the force is looked at.
    const LOOKS: u32 = 4096;
    let [strength, beta, gamma, exponent] = [0, 1, 2, 3].map(|place: usize| &hysteresis::GIVEN[place].key);
    let Some(mass) = moved.stiffest.filter(|mass| mass.laws.of(strength) != 0.0) else { return Ok(()) };
    // Apart by the golden section, so that no sine has its zeros at all of them.
    let at = |n: u32| {
        let part = (f64::from(n) * 0.618_033_988_749_894_9).fract();
        moved.waveform.specific_force_m_s2(moved.duration_s * part).abs()
    };
    let shared_m_s2 = (0..=LOOKS).map(at).fold(moved.waveform.standing_m_s2().abs(), f64::max);
    let force_m_s2 = moved.gain * shared_m_s2 + moved.own_sine_m_s2;
    // The memory's own rate where it is full: n times that of n = 1.
    let per_m = mass.laws.of(exponent).max(1.0) * (mass.laws.of(beta).abs() + mass.laws.of(gamma).abs());
    let speed_m_s = force_m_s2 / mass.natural_frequency_rad_s;
    let longest_s = MOST / (per_m * speed_m_s);
    if moved.substep_s <= longest_s {
        return Ok(());
    }
    Err(refuse(
        name,
        format!(
            "the spring with memory forgets within {} s at {} m/s², and a step has {} s",
            short(1.0 / (per_m * speed_m_s)),
            short(force_m_s2),
            short(moved.substep_s)
        ),
        format!("need steps of at most {} s, or smaller `{}` and `{}`", short(longest_s), beta.path, gamma.path),
    ))
}

/// Refuses a spring of which nothing is left at some time of a run of so long, its still start
/// included, of which the temperature's times are not counted.
pub(super) fn lasting_spring(name: &str, all: &Tolerances, run: &Lasting<'_>) -> Result<()> {
    let Lasting { still_s, duration_s, temperature } = *run;
    let [drift, warm] = [stiffness_drift::GIVEN, warm_stiffness::GIVEN].map(|given| &given[0].key);
    let [(drift_per_s, _), (per_k, _)] = [drift, warm].map(|key| all.moments(key));
    let left = |time_s: f64| 1.0 + drift_per_s * (still_s + time_s) + per_k * temperature.above_reference_k(time_s);
    // Between two points both go along straight lines, but for a lag.
    let points = temperature.points.iter().map(|[time_s, _]| *time_s).filter(|time_s| *time_s < duration_s);
    let Some(gone_s) =
        [-still_s, 0.0].into_iter().chain(points).chain([duration_s]).find(|time_s| left(*time_s) <= 0.0)
    else {
        return Ok(());
    };
    let deg_c = temperature.reference_deg_c + temperature.above_reference_k(gone_s);
    let by = |key: &Key, value: f64| format!("`{}` = {}", key.path, short(value));
    let (cause, hint) = match (drift_per_s != 0.0, per_k != 0.0) {
        (true, true) => (
            format!(
                "{} and {} leave no spring after {} s at {} °C",
                by(drift, drift_per_s),
                by(warm, per_k),
                short(gone_s),
                short(deg_c)
            ),
            "make one of them smaller, or the study shorter".to_owned(),
        ),
        (true, false) => (
            format!("{} leaves no spring after {} s", by(drift, drift_per_s), short(-1.0 / drift_per_s)),
            format!(
                "need more than {} per s for {} s, or a shorter study",
                short(-1.0 / (still_s + duration_s)),
                short(still_s + duration_s)
            ),
        ),
        _ => {
            let warmer_k = temperature.above_reference_k(gone_s);
            let side = if warmer_k > 0.0 { "more" } else { "less" };
            (
                format!("{} leaves no spring at {} °C", by(warm, per_k), short(deg_c)),
                format!("need {side} than {} per K", short(-1.0 / warmer_k)),
            )
        }
    };
    Err(refuse(name, cause, hint))
}

/// Time that a spring must last, and its temperature meanwhile.
pub(super) struct Lasting<'a> {
    /// Length of the still start, s.
    pub still_s: f64,
    /// And of what follows, s.
    pub duration_s: f64,
    pub temperature: &'a Temperature,
}
