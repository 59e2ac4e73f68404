//! Checks whether the numbers of a study make sense, each alone and together, before anything is
//! computed.

use super::file::File;
use super::mass_check;
use super::refusal::refuse;
use super::section::Section;
use super::tolerances::{Tolerances, keys};
use crate::error::Result;
use crate::kernel::job::Clock;
use crate::sensor::SensorTerm;
use crate::sensor::error_law::{ErrorLaw, Shape};
use crate::units::key::Sign;
use crate::units::number::Number;

/// Most integration steps of a run: at the 10⁹ per second of a good machine, a single member would
/// take 20 minutes.
const MOST_STEPS: f64 = 1e12;
/// Most integration steps between two readings.
const MOST_STEPS_PER_SAMPLE: f64 = 1e6;
/// Most members: what the counters of the kernels address.
const MOST_MEMBERS: u64 = u32::MAX as u64;

/// The numbers of one axis of a study by key, each checked for its sign and pairs that mean the
/// same refused.
pub(super) fn tolerances(name: &str, file: &File, axis: usize) -> Result<Tolerances> {
    let mut all = Tolerances::default();
    file.sensor.numbers.replace(Section::Sensor, axis, &mut all);
    for (section, numbers) in [(Section::Accelerometer, &file.accelerometer), (Section::Gyro, &file.gyro)] {
        numbers.iter().for_each(|numbers| numbers.replace(section, axis, &mut all));
    }
    mass_check::mechanics(name, &all)?;
    numbers(name, &all)?;
    below_half_the_rate(name, file, &all)?;
    Ok(all)
}

/// Checks that each number makes sense for its key, and that none is given twice.
pub(super) fn numbers(name: &str, all: &Tolerances) -> Result<()> {
    SensorTerm::ALL.into_iter().try_for_each(|term| given_once(name, all, term))?;
    SensorTerm::ALL.into_iter().filter(|term| !term.is_shape()).try_for_each(|term| given_whole(name, all, term))?;
    mass_check::one_delay(name, all)?;
    sizes(name, all)?;
    signs(name, all)
}

/// Refuses a term that is given by two of its keys.
fn given_once(name: &str, all: &Tolerances, term: SensorTerm) -> Result<()> {
    let mut given = term.row().keys.iter().filter(|key| all[key].is_some());
    let (Some(a), Some(b)) = (given.next(), given.next()) else { return Ok(()) };
    let hint = match [a, b].iter().any(|key| key.path.contains("noise_density")) {
        true => "keep one: a one-sided density n (datasheets) is a random walk N = n/√2 (IEEE 952)",
        false => "keep one: both are the same quantity, in other units",
    };
    let cause = format!("both `{}` and `{}` are given; they are two names of one {}", a.path, b.path, term.row().name);
    Err(refuse(name, cause, hint))
}

/// Refuses a term without its shape, and a shape without its term; a phase may be left out.
fn given_whole(name: &str, all: &Tolerances, term: SensorTerm) -> Result<()> {
    let strength = &term.row().keys[0];
    for shape in term.shapes() {
        let key = &shape.row().keys[0];
        let (has, lacks) = match (all[strength].is_some(), all[key].is_some()) {
            (true, false) if shape.law() != ErrorLaw::Shape(Shape::Phase) => (strength, key),
            (false, true) => (key, strength),
            _ => continue,
        };
        let cause = format!("`{}` is given without `{}`", has.path, lacks.path);
        return Err(refuse(name, cause, format!("add `{}`, or remove both", lacks.path)));
    }
    Ok(())
}

/// Refuses a sine that the readings would show at another frequency. A file that is no study need not
/// state a rate.
fn below_half_the_rate(name: &str, file: &File, all: &Tolerances) -> Result<()> {
    if file.duration_s.is_none() && file.step_s.is_none() && file.sensor.sample_rate_hz.is_none() {
        return Ok(());
    }
    let half_hz = 0.5 * rate_hz(name, file)?;
    for term in SensorTerm::ALL.into_iter().filter(|term| term.law() == ErrorLaw::Shape(Shape::Frequency)) {
        let key = &term.row().keys[0];
        let highest_hz = match all[key] {
            Some(Number::Fixed(value)) => value,
            Some(Number::Uniform { max, .. }) => max,
            Some(Number::Normal { mean, sd }) => mean + 2.0 * sd,
            None => continue,
        };
        if highest_hz >= half_hz {
            return Err(refuse(
                name,
                format!(
                    "`{}` reaches {highest_hz:?} Hz: need less than {half_hz:?} Hz, half the sampling rate",
                    key.path
                ),
                "raise `sensor.sample_rate_hz`, or give the frequency at which the readings show it",
            ));
        }
    }
    Ok(())
}

/// Refuses values that make no sense for their key.
pub(super) fn signs(name: &str, all: &Tolerances) -> Result<()> {
    for row in keys() {
        let (Some(number), true) = (all[row], row.sign != Sign::Any) else { continue };
        let strict = row.sign == Sign::Positive;
        let below = |value: f64| value < 0.0 || strict && value == 0.0;
        let need = if strict { "more than zero" } else { "zero or more" };
        let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
        let (cause, hint) = match number {
            Number::Fixed(value) if below(value) => {
                (format!("`{}` = {value}{unit}: need {need}", row.path), "check the sign".to_owned())
            }
            Number::Uniform { min, .. } if below(min) => {
                (format!("`{}` is drawn from {min}{unit} upward: need {need}", row.path), "raise min".to_owned())
            }
            Number::Normal { mean, sd } if below(mean) || mean < 2.0 * sd => (
                format!(
                    "`{}` is drawn with mean {mean} and sd {sd}{unit}: more than 2 % of the members would fall below \
                     zero, and it must be {need}",
                    row.path
                ),
                "use { min = …, max = … }, or an sd of at most half the mean".to_owned(),
            ),
            _ => continue,
        };
        return Err(refuse(name, cause, hint));
    }
    Ok(())
}

/// Largest number in any unit: beyond it the members' arithmetic in 32 bits ends. A cubic spring of
/// nanometres needs 1e30.
const LARGEST: f64 = 1e33;
/// Size below which a number is no zero but a slip, and divisions by it end the arithmetic.
const SMALLEST: f64 = 1e-25;

/// Returns whether a positive number is of a size that a study takes.
pub fn is_plausible(value: f64) -> bool {
    (SMALLEST..=LARGEST).contains(&value)
}

/// Refuses numbers that no sensor has.
fn sizes(name: &str, all: &Tolerances) -> Result<()> {
    for row in keys() {
        let Some(number) = all[row] else { continue };
        let ends = match number {
            Number::Fixed(value) => [value, value],
            Number::Normal { mean, sd } => [mean, sd],
            Number::Uniform { min, max } => [min, max],
        };
        let small = |v: f64| row.sign == Sign::Positive && v > 0.0 && v < SMALLEST;
        if let Some(value) = ends.into_iter().find(|v| v.abs() > LARGEST) {
            return Err(refuse(
                name,
                format!("`{}` = {value:?} {}: implausible for any sensor", row.path, row.unit),
                "check the exponent and the unit that the key ends with",
            ));
        }
        if small(ends[0]) && !matches!(number, Number::Normal { .. }) {
            return Err(refuse(
                name,
                format!("`{}` = {:?} {}: too small for any sensor", row.path, ends[0], row.unit),
                "check the exponent and the unit that the key ends with",
            ));
        }
    }
    Ok(())
}

/// Members, from the file or the default.
pub(super) fn members(name: &str, file: &File) -> Result<u64> {
    match file.members.unwrap_or(16_384) {
        0 => Err(refuse(
            name,
            "`members` = 0: an ensemble needs at least one",
            "16384 gives percentiles to a few per cent",
        )),
        1 => Err(refuse(name, "`members` = 1: one sensor has no spread", "16384 gives percentiles to a few per cent")),
        many if many > MOST_MEMBERS => Err(refuse(
            name,
            format!("`members` = {many}: at most {MOST_MEMBERS} can be addressed"),
            "a million members already give the 1 % percentile to half a per cent",
        )),
        members => Ok(members),
    }
}

/// Readings per second where neither a rate nor a step is given.
const USUAL_RATE_HZ: f64 = 100.0;

/// A number that is more than zero, if it is given.
fn positive(name: &str, key: &str, value: Option<f64>, unit: &str) -> Result<Option<f64>> {
    match value {
        Some(v) if !(v > 0.0 && v.is_finite()) => {
            Err(refuse(name, format!("`{key}` = {v:?} {unit}: need more than zero"), "give a positive number"))
        }
        v => Ok(v),
    }
}

/// Readings per second, of a file that need not be a whole study.
pub(super) fn rate_hz(name: &str, file: &File) -> Result<f64> {
    let step_s = positive(name, "step_s", file.step_s, "s")?;
    let rate_hz = positive(name, "sensor.sample_rate_hz", file.sensor.sample_rate_hz, "Hz")?;
    Ok(rate_hz.or(step_s.map(|s| 1.0 / s)).unwrap_or(USUAL_RATE_HZ))
}

/// Discrete time: duration, step and sampling rate that fit each other, and report times that fall
/// on samples.
pub(super) fn clock(name: &str, file: &File) -> Result<Clock> {
    let positive = |key: &str, value: Option<f64>, unit: &str| positive(name, key, value, unit);
    let Some(duration_s) = positive("duration_s", file.duration_s, "s")? else {
        return Err(refuse(name, "`duration_s` is missing", "say how long the run is, e.g. duration_s = 60.0"));
    };
    let step = positive("step_s", file.step_s, "s")?;
    let rate = positive("sensor.sample_rate_hz", file.sensor.sample_rate_hz, "Hz")?;
    let (step_s, steps_per_sample) = match (step, rate) {
        (Some(step_s), Some(rate_hz)) => (step_s, whole(name, "sample period", "step_s", 1.0 / rate_hz, step_s)?),
        (Some(step_s), None) => (step_s, 1.0),
        (None, rate_hz) => (1.0 / rate_hz.unwrap_or(USUAL_RATE_HZ), 1.0),
    };
    if steps_per_sample > MOST_STEPS_PER_SAMPLE {
        return Err(refuse(
            name,
            format!("a sample takes {steps_per_sample:.0e} steps of {step_s:?} s: at most {MOST_STEPS_PER_SAMPLE:.0e}"),
            "lengthen `step_s`: the linear map is exact at any step, and other integrators sub-step by themselves",
        ));
    }
    if step_s > duration_s {
        return Err(refuse(
            name,
            format!("the step of {step_s:?} s is longer than the run of {duration_s:?} s"),
            "shorten `step_s` or lengthen `duration_s`",
        ));
    }
    let steps = duration_s / step_s;
    if steps > MOST_STEPS {
        return Err(refuse(
            name,
            format!("{duration_s:?} s in steps of {step_s:?} s are {steps:.1e} steps"),
            format!("keep it below {MOST_STEPS:.0e}: a longer step does, the linear map is exact at any step"),
        ));
    }
    let sample_s = step_s * steps_per_sample;
    let samples = whole(name, "duration_s", "sample period", duration_s, sample_s)? as u64;
    let report_samples = report_samples(name, file, duration_s, sample_s, samples)?;
    Ok(Clock { step_s, steps_per_sample: steps_per_sample as u32, samples, report_samples, still_samples: 0 })
}

/// Returns how often `part_s` fits into `whole_s`, which must be a whole number.
pub(super) fn whole(name: &str, whole_name: &str, part_name: &str, whole_s: f64, part_s: f64) -> Result<f64> {
    let ratio = whole_s / part_s;
    let nearest = ratio.round();
    if nearest < 1.0 || (ratio - nearest).abs() > 1e-6 * nearest.max(1.0) || nearest > f64::from(u32::MAX) * 4096.0 {
        return Err(refuse(
            name,
            format!("the {whole_name} of {whole_s:?} s is {} times the {part_name} of {part_s:?} s", times(ratio)),
            match nearest {
                n if n > f64::from(u32::MAX) * 4096.0 => "lengthen `step_s` or raise `sensor.sample_rate_hz`".into(),
                n => format!("it must be a whole multiple, e.g. {:?} s", (n.max(1.0) * part_s * 1e9).round() / 1e9),
            },
        ));
    }
    Ok(nearest)
}

fn times(ratio: f64) -> String {
    if (1e-3..1e6).contains(&ratio) { format!("{ratio:.4}") } else { format!("{ratio:.1e}") }
}

fn report_samples(name: &str, file: &File, duration_s: f64, sample_s: f64, samples: u64) -> Result<Vec<u64>> {
    let Some(times_s) = &file.report.times_s else {
        let mut places: Vec<u64> =
            [0.1, 0.2, 0.5, 1.0].iter().map(|part| ((samples as f64 * part).round() as u64).max(1)).collect();
        places.dedup();
        return Ok(places);
    };
    if times_s.is_empty() || times_s.len() > 64 {
        return Err(refuse(
            name,
            format!("`report.times_s` has {} times: need 1 to 64", times_s.len()),
            "the curves are drawn at many more times anyway; these are the rows of the table",
        ));
    }
    let mut places = Vec::new();
    for time_s in times_s {
        if !(*time_s > 0.0 && *time_s <= duration_s * (1.0 + 1e-9)) {
            return Err(refuse(
                name,
                format!("`report.times_s` holds {time_s:?} s, outside the run of {duration_s:?} s"),
                "keep report times above zero and within `duration_s`",
            ));
        }
        places.push(whole(name, "report time", "sample period", *time_s, sample_s)? as u64);
    }
    if places.windows(2).any(|w| w[0] >= w[1]) {
        return Err(refuse(name, "`report.times_s` does not increase", "sort the times and drop repeated ones"));
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::parse_toml;

    /// A sine at 50 Hz and one of which members reach it are refused at 100 readings per second, a
    /// slower one and the same in a file that states no rate are not.
    #[test]
    fn a_sine_lies_below_half_the_sampling_rate() {
        let refused = |rate: &str, section: &str, frequency: &str, amplitude: &str| {
            let text = format!("{rate}\n[{section}]\nsinusoid_{amplitude} = 1.0\nsinusoid_hz = {frequency}\n");
            let file: File = parse_toml("s.toml", &text).expect("a file");
            tolerances("s.toml", &file, 0).err().map(|error| error.to_string())
        };
        for (section, amplitude) in [("accelerometer", "mg"), ("gyro", "deg_h")] {
            for frequency in ["50.0", "{ min = 1.0, max = 50.0 }", "{ mean = 45.0, sd = 3.0 }"] {
                let said = refused("duration_s = 10.0", section, frequency, amplitude).expect("refused");
                assert!(said.contains(&format!("{section}.sinusoid_hz")) && said.contains("half"), "{said}");
                assert_eq!(refused("step_s = 0.005", section, frequency, amplitude), None);
                assert_eq!(refused("", section, frequency, amplitude), None);
            }
            assert_eq!(refused("duration_s = 10.0", section, "49.0", amplitude), None);
        }
    }
}
