//! The sensor with and without the named physics: what a study can run, and what it cannot express.

use std::fmt::Write;
use std::path::Path;

use crate::document::toml_string;
use crate::escape;
use crate::motion::temperature::Temperature;
use crate::physics::stiffness_drift;
use crate::sensor::{Sensor, SensorTerm, mechanics};
use crate::study::name_for;
use crate::units::key::Key;

use super::by_axis::{Drawn, three};
use super::verdict::Verdict;

/// A sine that the cost is stated under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration {
    /// Amplitude, m/s².
    pub amplitude_m_s2: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// The loop closed: a sensor in SI units before and after the diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Repair {
    /// The base model as fitted alone.
    pub before: Sensor,
    /// The sensor with the named physics, all fitted together.
    pub after: Sensor,
    /// Temperature that the repaired sensor follows; without points none.
    pub temperature: Temperature,
    /// Keys with a number for each axis, SI: with any, the study has six axes.
    pub by_axis: Vec<(&'static Key, [Drawn; 3])>,
    /// States whether the recording's units are those of an inertial sensor: a position error has
    /// no meaning for volts.
    pub is_inertial: bool,
    /// States how the recording's units became metres and m/s², in a sentence: "1 V of input is
    /// taken as 1 m/s²".
    pub relation: String,
    /// Named terms that the study does not hold; written as comments.
    pub not_expressible: Vec<String>,
    /// A vibration as strong as the recording's own excitation, so that the sensor is used where it
    /// was identified.
    pub vibration: Vibration,
    /// Drift that the omission costs, computed by the kind itself because no study expresses the
    /// term.
    pub own_cost: Vec<Cost>,
}

/// Rows of the cost table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Row {
    /// With the original model.
    Before,
    /// With the named physics.
    After,
    /// One effect alone, by a formula of its kind.
    Own,
}

/// Position error when the physics is left out of the sensor's model.
#[derive(Debug, Clone, PartialEq)]
pub struct Cost {
    /// Row of the table.
    pub row: Row,
    /// Effect that is left out, e.g. "cubic-stiffness".
    pub of: String,
    /// Under what: "5 m/s² at 3 Hz".
    pub under: String,
    /// Position error after 10 s, m.
    pub position_10_s_m: f64,
    /// Position error after 60 s, m.
    pub position_60_s_m: f64,
    /// Method of the computation, in a few words.
    pub basis: String,
}

/// Comments in repaired.toml are broken at this many characters.
const COMMENT_WIDTH: usize = 100;
/// A study lasts so long, s, without a temperature.
const USUAL_S: f64 = 60.0;
/// And at most so long with one, s; the document says how far the temperature goes on.
const LONGEST_S: f64 = 3600.0;

/// The repaired sensor as a study: DIR/repaired.toml. What a study cannot run stands in comments,
/// so that nothing named is lost.
pub(super) fn study_document(repair: &Repair, verdict: &Verdict) -> String {
    let rate_hz = round_rate(verdict.recording.rate_hz);
    let mut text = preamble(verdict, &repair.relation, &repair.not_expressible);
    let drift_per_s = repair.after.proof_mass.map_or(0.0, |mass| mass.laws.of(&stiffness_drift::GIVEN[0].key));
    let recorded_s = verdict.recording.samples as f64 / verdict.recording.rate_hz;
    let duration_s = match drift_per_s == 0.0 {
        true => duration_s(&repair.temperature),
        false => {
            text +=
                "# The spring drifts: the study lasts no longer than the recording, beyond which no drift is known.\n";
            duration_s(&repair.temperature).min(recorded_s.floor().max(1.0))
        }
    };
    if let Some([end_s, _]) = repair.temperature.points.last().filter(|[end_s, _]| *end_s > LONGEST_S) {
        let _ = writeln!(text, "# [temperature] goes on to {end_s:?} s: duration_s may be as long.");
    }
    let _ = write!(
        text,
        "\nname = {}\nseed = 1\nmembers = 4096\nduration_s = {duration_s:?}\nstep_s = {:?}\n",
        toml_string(&name(verdict, "repaired")),
        1.0 / rate_hz
    );
    text += &section("sensor", &(lines(&sensor_keys(&repair.after, rate_hz)) + &law_lines(&repair.after)));
    for name in ["accelerometer", "gyro"] {
        let of_axes = repair.by_axis.iter().filter(|(key, _)| key.section() == name);
        let by_axis: String = of_axes.map(|(key, axes)| three(key, *axes)).collect();
        text += &section(name, &(lines(&term_keys(&repair.after, name)) + &by_axis));
    }
    if !repair.by_axis.is_empty() {
        text += "\n[trajectory]\nkind = \"rest\"\n";
    }
    text += &temperature_section(&repair.temperature);
    let v = &repair.vibration;
    let seen = v.frequency_hz > 0.0 && v.frequency_hz < 0.5 * rate_hz;
    if v.amplitude_m_s2 > 0.0 && seen && repair.after.proof_mass.is_some() {
        let _ = write!(
            text,
            "\n[excitation]\nkind = \"sine\"\namplitude_m_s2 = {:?}\nfrequency_hz = {:?}\n",
            v.amplitude_m_s2, v.frequency_hz
        );
    }
    let end_s = Some(duration_s).filter(|end_s| *end_s > USUAL_S);
    let usual = [1.0, 10.0, USUAL_S].into_iter().filter(|time_s| *time_s <= duration_s);
    let times_s: Vec<f64> = usual.chain(end_s).collect();
    text + &format!("\n[report]\ntimes_s = {times_s:?}\n")
}

/// Returns a time as long as the temperature is known, to a hundredth of a second: a whole number
/// of samples at every round rate. It stays beyond its last point, so that a minute is no loss.
fn duration_s(temperature: &Temperature) -> f64 {
    let end_s = temperature.points.last().map_or(USUAL_S, |[time_s, _]| (time_s * 100.0).round() / 100.0);
    end_s.clamp(USUAL_S, LONGEST_S)
}

/// Name of a sensor's study: its recording's, and what the sensor is.
pub(super) fn name(verdict: &Verdict, what: &str) -> String {
    let path = Path::new(&verdict.recording.file);
    format!("{}-{what}", name_for(&path.file_stem().unwrap_or_default().to_string_lossy()))
}

/// Returns what was found, as comments: the verdict, every named effect with its numbers, and what
/// a study cannot run.
pub(super) fn preamble(verdict: &Verdict, relation: &str, not_expressible: &[String]) -> String {
    let mut text = String::new();
    let mut comment = |line: &str| {
        let mut width = 0;
        for (n, word) in escape::line(line).split_whitespace().enumerate() {
            let length = word.chars().count() + 1;
            let (lead, start) = if n == 0 { ("# ", 2) } else { ("\n#   ", 4) };
            if n == 0 || width + length > COMMENT_WIDTH {
                let _ = write!(text, "{lead}{word}");
                width = start + length;
            } else {
                let _ = write!(text, " {word}");
                width += length;
            }
        }
        text.push('\n');
    };
    let path = Path::new(&verdict.recording.file);
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    comment(&format!("The sensor of {file} with the physics that its diagnosis named."));
    comment(&format!("Verdict: {}. {}", verdict.verdict.name(), verdict.sentence));
    comment(relation);
    for effect in &verdict.effects {
        comment(&format!("{}: {}", effect.id, effect.equation));
        for p in &effect.parameters {
            comment(&format!(
                "  {} = {:.4e} {} (95 %: {:.4e} to {:.4e})",
                p.name, p.value, p.unit, p.ci95[0], p.ci95[1]
            ));
        }
    }
    for term in not_expressible {
        comment(&format!("Not in this study: {term}"));
    }
    text
}

/// The next round rate (1, 2 or 5 times a power of ten, at least 100 Hz), so that a minute is a
/// whole number of samples.
pub(super) fn round_rate(rate_hz: f64) -> f64 {
    let rate_hz = rate_hz.clamp(100.0, 1e6);
    let power = 10f64.powf(rate_hz.log10().floor());
    let digit = [1.0, 2.0, 5.0].into_iter().find(|d| d * power >= rate_hz * (1.0 - 1e-9)).unwrap_or(10.0);
    (digit * power).round()
}

/// A section with these lines; nothing without any.
fn section(name: &str, lines: &str) -> String {
    if lines.is_empty() { String::new() } else { format!("\n[{name}]\n{lines}") }
}

/// A line for each key that says something.
fn lines(keys: &[(&str, f64)]) -> String {
    let used = keys.iter().filter(|(_, v)| *v != 0.0 && v.is_finite());
    used.map(|(key, value)| format!("{key} = {value:?}\n")).collect()
}

/// `[temperature]`, to a ten-thousandth of its range; empty without points.
fn temperature_section(temperature: &Temperature) -> String {
    let Temperature { points, reference_deg_c, .. } = temperature;
    let [low, high] = points.iter().fold([f64::MAX, f64::MIN], |[l, h], [_, deg_c]| [l.min(*deg_c), h.max(*deg_c)]);
    if points.is_empty() {
        return String::new();
    }
    let digits = (4.0 - (high - low).max(1e-9).log10().floor()).max(1.0) as usize;
    let lines: String = points.iter().map(|[time_s, deg_c]| format!("  [{time_s:?}, {deg_c:.digits$}],\n")).collect();
    let late = if temperature.lag_s() > 0.0 { format!("lag_s = {:?}\n", temperature.lag_s()) } else { String::new() };
    format!("\n[temperature]\nprofile_s_deg_c = [\n{lines}]\nreference_deg_c = {reference_deg_c:.digits$}\n{late}")
}

fn sensor_keys(sensor: &Sensor, rate_hz: f64) -> Vec<(&'static str, f64)> {
    let mut keys = vec![("sample_rate_hz", rate_hz)];
    keys.extend(term_keys(sensor, "sensor"));
    if let Some(mass) = &sensor.proof_mass {
        keys.extend([
            ("resonance_hz", mass.natural_frequency_rad_s / (2.0 * std::f64::consts::PI)),
            ("damping_ratio", mass.damping_ratio),
        ]);
        let noise = &mechanics::FORCE_NOISE;
        keys.push((noise.key(), mass.force_noise_m_s_rts / noise.factor));
    }
    keys
}

/// A line for each number of the laws that the proof mass follows: a study takes none without its
/// others, also where one is zero.
fn law_lines(sensor: &Sensor) -> String {
    let Some(mass) = &sensor.proof_mass else { return String::new() };
    let keys = mass.laws.acting().flat_map(|law| law.given()).map(|given| &given.key);
    let values = keys.map(|key| (key, mass.laws.of(key) / key.factor)).filter(|(_, value)| value.is_finite());
    values.map(|(key, value)| format!("{} = {value:?}\n", key.key())).collect()
}

/// The error terms of one section, by the key that each is written with.
fn term_keys(sensor: &Sensor, section: &str) -> Vec<(&'static str, f64)> {
    let rows = SensorTerm::ALL.into_iter().filter_map(|term| Some((term, term.row().keys.first()?)));
    rows.filter(|(_, key)| key.section() == section)
        .map(|(term, key)| (key.key(), sensor.error(term) / key.factor))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::hysteresis;
    use crate::sensor::ProofMass;
    use crate::units::{DENSITY_TO_RANDOM_WALK, MICRO_G};

    #[test]
    fn rates_become_round_ones_that_are_no_lower() {
        assert_eq!([610.35, 100.0, 0.1, 1000.0, 2001.0].map(round_rate), [1000.0, 100.0, 100.0, 1000.0, 5000.0]);
    }

    #[test]
    fn a_law_is_written_whole_and_one_that_does_not_act_not_at_all() {
        let [strength, beta, gamma] = [0, 1, 2].map(|i: usize| &hysteresis::GIVEN[i].key);
        let mass = ProofMass { natural_frequency_rad_s: 100.0, damping_ratio: 0.1, ..ProofMass::default() };
        let of = |mass: ProofMass| Sensor { proof_mass: Some(mass), ..Sensor::default() };
        assert_eq!(law_lines(&of(mass.with(beta, 2.0))), "");
        let bent = of(mass.with(strength, 3.0).with(beta, 2.0));
        let text = format!(
            "members = 2\nduration_s = 1.0\n{}",
            section("sensor", &(lines(&sensor_keys(&bent, 100.0)) + &law_lines(&bent)))
        );
        assert!(text.contains("hysteresis_gamma_per_m = 0.0"), "{text}");
        let study = crate::study::parse("repaired", &text, Path::new("")).expect("it is a study");
        let drawn = study.member(0).sensor.proof_mass.expect("it has a mass");
        assert_eq!([strength, beta, gamma].map(|key| drawn.laws.of(key)), [3.0, 2.0, 0.0]);
    }

    #[test]
    fn slow_laws_are_written_so_that_a_study_draws_them_again() {
        let mut sensor = Sensor::default();
        let a = &mut sensor.accelerometer;
        (a.markov_m_s2, a.markov_time_s) = (1e-3, 60.0);
        (a.warm_up_m_s2, a.warm_up_time_s) = (-2e-3, 20.0);
        (a.sinusoid_m_s2, a.sinusoid_frequency_rad_s) = (3e-3, 0.5);
        let mut text = "members = 2\nduration_s = 1.0\n".to_owned();
        text += &section("accelerometer", &lines(&term_keys(&sensor, "accelerometer")));
        let study = crate::study::parse("repaired", &text, Path::new("")).expect("it is a study");
        let drawn = [0, 1].map(|member| study.member(member).sensor.accelerometer);
        for term in SensorTerm::ALL.into_iter().filter(|t| *t != SensorTerm::AccelerometerSinusoidPhase) {
            let (got, want) = (term.of(&drawn[0], &sensor.gyro), sensor.error(term));
            assert!(got == want || (got / want - 1.0).abs() < 1e-12, "{term:?}: {got} {want}");
        }
        // The phase is the recording's own: each member draws one.
        assert_ne!(drawn[0].sinusoid_phase_rad, drawn[1].sinusoid_phase_rad);
    }

    #[test]
    fn a_study_lasts_as_long_as_its_temperature_is_known() {
        let until = |end_s: f64| Temperature::new(vec![[0.0, 20.0], [end_s, 25.0]], 20.0);
        let known = [20.0, 200.004, 1e5].map(|end_s| duration_s(&until(end_s)));
        assert_eq!(known, [USUAL_S, 200.0, LONGEST_S]);
        assert_eq!(duration_s(&Temperature::default()), USUAL_S);
    }

    #[test]
    fn a_section_is_written_once_with_its_lines_and_not_without_any() {
        assert_eq!(section("gyro", &lines(&[("a", 0.0), ("b", f64::NAN)])), "");
        assert_eq!(section("gyro", &(lines(&[("a", 2.0)]) + "b = [1, 2]\n")), "\n[gyro]\na = 2.0\nb = [1, 2]\n");
    }

    #[test]
    fn densities_are_written_as_one_sided() {
        let mut sensor = Sensor::default();
        sensor.accelerometer.velocity_random_walk_m_s_rts = 60.0 * MICRO_G * DENSITY_TO_RANDOM_WALK;
        let keys = term_keys(&sensor, "accelerometer");
        let density = keys.iter().find(|k| k.0 == "noise_density_ug_rthz").map(|k| k.1);
        assert!(density.is_some_and(|d| (d - 60.0).abs() < 1e-9), "{keys:?}");
    }
}
