//! The question that a file asks: a verdict's open one, or what a model and a law leave to be shown.

use std::f64::consts::TAU;
use std::path::Path;

use serde::Deserialize;

use crate::candidate::Kind;
use crate::document::{parse_json, read_text};
use crate::driven::base::{BASE, GAIN, OFFSET, OMEGA, ZETA};
use crate::error::{Error, Result, nearest};
use crate::model::{self, Model, Output};
use crate::physics::law::Role;
use crate::physics::library::Term;

use super::limits::Limits;
use super::question::{Interval, Known, Purpose, Question, Sensor, Strength};

/// The part of a verdict that is needed.
#[derive(Debug, Deserialize)]
struct Verdict {
    schema: String,
    kind: Kind,
    verdict: String,
    recording: Recorded,
    #[serde(default)]
    base: Vec<Number>,
    effects: Vec<Effect>,
    fit: Fit,
    #[serde(default)]
    detectable: Vec<Detectable>,
}

#[derive(Debug, Deserialize)]
struct Recorded {
    samples: usize,
    rate_hz: f64,
}

#[derive(Debug, Deserialize)]
struct Number {
    name: String,
    value: f64,
    unit: String,
    ci95: [f64; 2],
}

#[derive(Debug, Deserialize)]
struct Effect {
    id: String,
    parameters: Vec<Number>,
    confusable_with: Vec<String>,
    #[serde(default)]
    base: Vec<Number>,
}

#[derive(Debug, Deserialize)]
struct Fit {
    noise_floor: f64,
    noise: Option<Noise>,
}

#[derive(Debug, Deserialize)]
struct Noise {
    value: f64,
}

#[derive(Debug, Deserialize)]
struct Detectable {
    id: String,
    parameter: String,
    strength: Option<f64>,
    unit: String,
}

/// Words for refusals of one file.
struct Refusal<'a>(&'a str);

impl Refusal<'_> {
    fn because(&self, cause: impl Into<String>, hint: impl Into<String>) -> Error {
        Error::new(format!("could not plan from {}", self.0), cause, hint)
    }

    fn of_kind(&self, kind: Kind) -> Error {
        let cause = format!("it is of kind = \"{}\", and experiments are planned for a driven proof mass", kind.name());
        let hint = match kind {
            Kind::Tumble => "`proofmass check` says which poses and turns a calibration still needs",
            Kind::Static => "a sensor at rest needs time alone: its intervals shrink as the square root of it",
            _ => "the verdict's next_experiment says in words what to record",
        };
        self.because(cause, hint)
    }
}

/// Reads the question from a verdict.json or a model.toml; `show` is "LAW=STRENGTH".
///
/// # Errors
/// A file that cannot be read; one of another kind; one that leaves nothing to plan for.
pub fn read(path: &Path, show: Option<&str>, limits: &Limits) -> Result<Question> {
    let name = path.display().to_string();
    if path.extension().is_some_and(|e| e == "toml") {
        // What shall be shown first: a model is long.
        show.map(shown).transpose()?;
        return of_model(&name, model::read(path)?, show, limits);
    }
    of_verdict(&name, &read_text(path)?, show)
}

/// The question of a model, which must say what shall be shown; `name` stands in messages.
///
/// # Errors
/// As [`read`].
pub fn of_model(name: &str, model: Model, show: Option<&str>, limits: &Limits) -> Result<Question> {
    let refusal = Refusal(name);
    let show = show.map(shown).transpose()?;
    let sensor = modelled(model, limits, &refusal)?;
    let Some((known, strength)) = show else {
        return Err(refusal.because("a model leaves no question open", "say what to show: --show cubic-stiffness=1%"));
    };
    Ok(Question { sensor, common: Vec::new(), rivals: vec![known], purpose: Purpose::Show(strength) })
}

/// The question of a verdict.json; `name` stands in messages.
///
/// # Errors
/// As [`read`].
pub fn of_verdict(name: &str, text: &str, show: Option<&str>) -> Result<Question> {
    let refusal = Refusal(name);
    let show = show.map(shown).transpose()?;
    let verdict: Verdict = parse_json(name, text)?;
    if !verdict.schema.starts_with("proofmass.verdict/") {
        let cause = format!("its schema is \"{}\"", verdict.schema);
        return Err(refusal.because(cause, "give the verdict.json that `proofmass diagnose --out DIR` writes"));
    }
    if verdict.kind != Kind::Driven {
        return Err(refusal.of_kind(verdict.kind));
    }
    let sensor = diagnosed(&verdict, &refusal)?;
    match show {
        Some((known, strength)) => {
            Ok(Question { sensor, common: Vec::new(), rivals: vec![known], purpose: Purpose::Show(strength) })
        }
        None => asked(&verdict, sensor, &refusal),
    }
}

fn modelled(model: Model, limits: &Limits, refusal: &Refusal<'_>) -> Result<Sensor> {
    let model = match model {
        Model::Driven(model) => model,
        Model::Static(_) => return Err(refusal.of_kind(Kind::Static)),
        Model::Tumble(_) => return Err(refusal.of_kind(Kind::Tumble)),
        Model::Trajectory(_) => return Err(refusal.of_kind(Kind::Trajectory)),
        Model::Response(_) => return Err(refusal.of_kind(Kind::Response)),
    };
    if model.output_is != Output::Displacement {
        return Err(
            refusal.because("it reads a velocity or an acceleration", "experiments are planned for a displacement")
        );
    }
    let (Some(hz), Some(zeta)) = (model.start.resonance_hz, model.start.damping_ratio) else {
        let hint = "give both under [start], or plan from a verdict, which has measured them";
        return Err(refusal.because("it does not say resonance_hz and damping_ratio", hint));
    };
    let Some(given) = limits.sensor else {
        let hint = "add [sensor] noise = …, the standard deviation of a reading at rest, or plan from a verdict";
        return Err(refusal.because("neither it nor the limits say how much noise a reading has", hint));
    };
    if !(hz > 0.0 && hz < 0.5 * limits.rate_hz && zeta > 0.0 && zeta.is_finite()) {
        let cause = format!("resonance_hz = {hz}, damping_ratio = {zeta} at a sampling rate of {} Hz", limits.rate_hz);
        return Err(refusal.because(cause, "need a resonance between zero and half the rate, and damping above zero"));
    }
    let mut base = vec![0.0; BASE];
    (base[OMEGA], base[ZETA]) = (TAU * hz, zeta);
    base[GAIN] = given.static_gain * base[OMEGA].powi(2);
    Ok(Sensor { base, noise: given.noise })
}

fn diagnosed(verdict: &Verdict, refusal: &Refusal<'_>) -> Result<Sensor> {
    sensor(verdict, &verdict.base).ok_or_else(|| {
        let hint = "diagnose a recording with an input and a resonance first";
        refusal.because("its recording had no input that moves a resonance", hint)
    })
}

/// The sensor of these numbers; `None` where they are not of a driven resonance.
fn sensor(verdict: &Verdict, numbers: &[Number]) -> Option<Sensor> {
    let number = |name: &str| numbers.iter().find(|n| n.name == name).map(|n| n.value);
    let mut base = vec![0.0; BASE];
    (base[GAIN], base[OMEGA], base[ZETA]) = (number("gain")?, number("omega0")?, number("zeta")?);
    base[OFFSET] = number("offset").unwrap_or(0.0);
    Some(Sensor { base, noise: verdict.fit.noise.as_ref().map_or(verdict.fit.noise_floor, |n| n.value) })
}

/// The question that a verdict leaves open.
fn asked(verdict: &Verdict, of_first: Sensor, refusal: &Refusal<'_>) -> Result<Question> {
    let mut known: Vec<(Known, &Effect)> = Vec::new();
    for effect in &verdict.effects {
        let law = Term::all().into_iter().find(|t| t.id() == effect.id);
        if let Some(term) = law.filter(|t| t.noise().is_none() && t.role() != Role::Lattice) {
            known.push((
                Known { sensor: sensor(verdict, &effect.base), ..with_values(term, &effect.parameters) },
                effect,
            ));
        }
    }
    let is_tied = |(_, effect): &(Known, &Effect)| !effect.confusable_with.is_empty();
    match verdict.verdict.as_str() {
        "undecidable" if known.iter().any(is_tied) => {
            let (tied, common): (Vec<_>, Vec<_>) = known.into_iter().partition(is_tied);
            // Of several ties the first is asked; the others' own laws are taken as they are.
            let first = tied[0].1;
            let is_rival = |e: &Effect| e.id == first.id || first.confusable_with.contains(&e.id);
            let (rivals, others): (Vec<_>, Vec<_>) = tied.into_iter().partition(|(_, e)| is_rival(e));
            let mut seen: Vec<&str> = Vec::new();
            let own = others.into_iter().filter(|(_, e)| {
                let is_new = !e.confusable_with.iter().any(|id| seen.contains(&id.as_str()));
                seen.push(&e.id);
                is_new
            });
            let common = common.into_iter().chain(own).map(|(k, _)| k).collect();
            let rivals = rivals.into_iter().map(|(k, _)| k).collect();
            Ok(Question { sensor: of_first, common, rivals, purpose: Purpose::Decide })
        }
        "explained" if !known.is_empty() => {
            let (rival, effect) = known.remove(0);
            let number = &effect.parameters[0];
            let purpose = Purpose::Narrow(Interval {
                parameter: number.name.clone(),
                unit: number.unit.clone(),
                half_width: 0.5 * (number.ci95[1] - number.ci95[0]),
                seconds: verdict.recording.samples as f64 / verdict.recording.rate_hz,
            });
            Ok(Question {
                sensor: of_first,
                common: known.into_iter().map(|(k, _)| k).collect(),
                rivals: vec![rival],
                purpose,
            })
        }
        other => {
            let could =
                |d: &Detectable| Some(format!("{} from {} = {:.3e} {}", d.id, d.parameter, d.strength?, d.unit));
            let could: Vec<String> = verdict.detectable.iter().filter_map(could).collect();
            let limits =
                if could.is_empty() { String::new() } else { format!("; it could have shown {}", could.join(", ")) };
            Err(refusal.because(
                format!("its verdict, \"{other}\", has no law that an input could tell from another{limits}"),
                "say what the next recording shall show: --show LAW=STRENGTH, as --show cubic-stiffness=1%",
            ))
        }
    }
}

/// Distance of the outer two of three equally weighted values from the middle one, in standard deviations, that
/// gives them the variance of a normal law: √1.5.
const APART: f64 = 1.224_744_871_391_589;

fn with_values(term: Term, numbers: &[Number]) -> Known {
    let parameters = term.candidate().parameters;
    let found = |name: &str| numbers.iter().find(|n| n.name == name);
    let set = |value: &dyn Fn(usize, &Number) -> f64| {
        let named = parameters.iter().enumerate().map(|(j, p)| found(p.name).map_or(0.0, |n| value(j, n)));
        let mut values: Vec<f64> = named.collect();
        values.resize(term.values(), 0.0);
        values
    };
    // Each parameter takes both ends once, and neighbouring parameters do not move together.
    let ends = [[1.0, -1.0, 1.0, -1.0], [-1.0, 1.0, 1.0, -1.0]];
    let likely = ends.map(|end| set(&|j, n| n.away(APART * end[j % end.len()]))).to_vec();
    Known { term, values: set(&|_, n| n.value), likely, sensor: None }
}

impl Number {
    /// The value this many standard deviations away: in its logarithm if the interval does not cross zero, with the
    /// far end alone giving the spread if the near end is zero.
    fn away(&self, deviations: f64) -> f64 {
        let [low, high] = self.ci95;
        let [near, far] = if self.value < 0.0 { [high, low] } else { [low, high] };
        let of_one_sign =
            if near * self.value > 0.0 { (far / near).ln() / 3.92 } else { (far / self.value).ln() / 1.96 };
        if near * self.value >= 0.0 && of_one_sign.is_finite() {
            return self.value * (of_one_sign * deviations).exp();
        }
        self.value + (high - low) / 3.92 * deviations
    }
}

/// "cubic-stiffness=1%" as a law and its strength; the values follow once the motion is known.
fn shown(text: &str) -> Result<(Known, Strength)> {
    let refuse = |cause: String, hint: String| Error::new(format!("could not use --show {text}"), cause, hint);
    let (id, strength) = text.split_once('=').unwrap_or((text, ""));
    let laws: Vec<Term> =
        Term::all().into_iter().filter(|t| t.noise().is_none() && t.role() != Role::Lattice).collect();
    let Some(term) = laws.iter().copied().find(|t| t.id() == id) else {
        let near = nearest(id, laws.iter().map(|t| t.id()))
            .map_or("see `proofmass candidates`".to_owned(), |n| format!("did you mean {n}?"));
        return Err(refuse(format!("no law of motion or of the readout is called \"{id}\""), near));
    };
    let (number, is_share) = strength.strip_suffix('%').map_or((strength, false), |n| (n, true));
    let Some(number) = number.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v != 0.0) else {
        let parameter = term.candidate().parameters[0];
        let hint =
            format!("{id}=1% of the spring's force, or {id}=NUMBER for {} in {}", parameter.name, parameter.unit);
        return Err(refuse(format!("need a strength other than zero, got \"{strength}\""), hint));
    };
    if is_share && !(term.role().acts_on_mass() && term.states() == 0) {
        let parameter = term.candidate().parameters[0];
        let hint = format!("state its {} in {}: --show {id}=NUMBER", parameter.name, parameter.unit);
        return Err(refuse(format!("{id} is no force that is a part of the spring's"), hint));
    }
    let strength = if is_share { Strength::Share(0.01 * number) } else { Strength::Value(number) };
    Ok((Known { term, values: vec![0.0; term.values()], likely: Vec::new(), sensor: None }, strength))
}

#[cfg(test)]
mod tests {
    use super::*;

    // Of the best value and both others: the mean is the value and the variance that of the interval, in the
    // logarithm where it is of one sign. Control: at one standard deviation it would be two thirds of it.
    #[test]
    fn values_that_are_likely_have_the_variance_of_the_interval() {
        let number = |value, ci95| Number { name: "k".into(), value, unit: String::new(), ci95 };
        let variance = |of: &dyn Fn(f64) -> f64| [-APART, 0.0, APART].map(|d| of(d).powi(2)).iter().sum::<f64>() / 3.0;
        let plain = number(1.0, [1.0 - 1.96 * 2.0, 1.0 + 1.96 * 2.0]);
        assert!((variance(&|d| plain.away(d) - 1.0) - 4.0).abs() < 1e-12);
        let signed = number(-3.0, [-3.0 * 1.96f64.exp(), -3.0 * (-1.96f64).exp()]);
        assert!((variance(&|d| (signed.away(d) / -3.0).ln()) - 1.0).abs() < 1e-12);
        assert!((variance(&|d| (signed.away(d / APART) / -3.0).ln()) - 2.0 / 3.0).abs() < 1e-12);
        // One that ends at zero is known by its other end.
        let ended = number(0.5, [0.0, 0.5 * 1.96f64.exp()]);
        assert!((variance(&|d| (ended.away(d) / 0.5).ln()) - 1.0).abs() < 1e-12);
    }
}
