//! The verdict on a driven recording, or a ring-down, in words.

mod experiment;

use super::listed::{holding, listed};
use proofmass_base::number::{short, with_uncertainty};
use proofmass_diagnosis::answer::Answer;
use proofmass_diagnosis::driven::intake::notes::Broken;
use proofmass_diagnosis::driven::verdict::detail::{Account, Detail};
use proofmass_diagnosis::verdict::{DependsOn, Effect, Estimate, Outcome, Role, WithUnnamed};

pub(super) use experiment::next_experiment;

/// One or two plain sentences.
pub(crate) fn sentence(answer: &Answer, detail: &Detail) -> String {
    let (account, effects, unit) = (&detail.account, &answer.effects, &detail.unit);
    if let Some(broken) = &account.broken {
        return format!("{} No candidate was tried.{}", apart(broken), doubts(&account.doubts));
    }
    let before = answer.fit.test.rmse_before;
    let fall = fall(answer, unit);
    let named: Vec<String> = effects
        .iter()
        .map(|e| {
            let p = telling(&e.parameters);
            let number = p.map_or(String::new(), |p| {
                let half = 0.5 * (p.ci95[1] - p.ci95[0]);
                let unit = p.unit.replace("^2", "²").replace("^3", "³");
                format!(" ({} = {} {unit})", p.name, with_uncertainty(p.value, half))
            });
            format!("{}{number}", e.id)
        })
        .collect();
    let sentence = match answer.outcome {
        Outcome::Explained | Outcome::Unexplained if answer.fit.test.share.is_some() && !effects.is_empty() => {
            shares(answer, &holding(effects, &named), unit)
        }
        Outcome::Unexplained if effects.is_empty() && answer.places.argument.is_some() => {
            let part = |a: &DependsOn| format!("{} % of it depends on {}", short(100.0 * a.share.value), a.name);
            format!(
                "The mismatch is real: the base model's error on held-out samples is {} {unit}, {}, and no law of the \
                 library fits it.",
                short(before),
                answer.places.argument.as_ref().map_or(String::new(), part)
            )
        }
        Outcome::Explained => format!("The model left out {}; with it, {fall}.", listed(&named)),
        Outcome::Undecidable if effects.is_empty() && account.runs_away => format!(
            "The base model follows none of this motion: restarted every second from the state that was read, it errs by \
             {} {unit}, more than the reading moves, so that nothing can be said of what it leaves out.",
            short(before)
        ),
        Outcome::Undecidable if effects.is_empty() => format!(
            "A faint structure remains in the residual ({} % of its variance is predictable), too weak in this \
             recording to be identified.",
            short(100.0 * account.predictable)
        ),
        Outcome::Undecidable if account.few_cycles.is_some() => format!(
            "Something is missing from the base model ({}), but {} cycles of the resonance are too few to tell \
             what: {fall}.",
            listed(&holding(effects, &named)),
            short(account.few_cycles.unwrap_or(0.0))
        ),
        Outcome::Undecidable if account.is_linear_class => format!(
            "Something is missing, and {} explains it equally well: {} cannot be told apart in this recording; with \
             the first, {fall}.",
            match account.lines_hz.as_slice() {
                [] => "every linear effect, far below a resonance that this recording does not show,".to_owned(),
                [one] => format!("every linear effect, under an input with one spectral line at {} Hz,", short(*one)),
                lines => format!("every linear effect, under an input with {} spectral lines,", lines.len()),
            },
            listed(&holding(effects, &named))
        ),
        Outcome::Undecidable => {
            let mut also: Vec<String> =
                effects.iter().filter(|e| !e.confusable_with.is_empty()).map(|e| e.id.clone()).collect();
            also.dedup();
            format!(
                "Something is missing, and this recording cannot distinguish {}; with {}, {fall}.",
                listed(&also),
                if also.len() > 2 { "any of them" } else { "either" }
            )
        }
        // Without a base model that could be repaired, few laws were asked for, and about one place
        // only.
        Outcome::Unexplained if named.is_empty() && answer.repair.is_none() => {
            "The mismatch is real: the recording follows no linear \
             oscillator, and no candidate that was tried explains it down to the noise."
                .to_owned()
        }
        Outcome::Unexplained if named.is_empty() && account.strays_elsewhere => format!(
            "The base model leaves only noise in what was fitted, but errs by {} times the noise ({} {unit}) in what \
             validates it: another sensor, unit or setting there, or a motion that shows more.",
            short(before / answer.fit.noise_floor.max(1e-300)),
            short(before)
        ),
        Outcome::Unexplained if named.is_empty() && !account.is_structured => format!(
            "The mismatch is real, and no candidate in the library explains it{}.",
            answer.fit.noise.as_ref().filter(|n| before > 1.2 * n.value).map_or(String::new(), |n| format!(
                ": the base model's error is {} {unit}, and the noise is {} {unit} (measured from {})",
                short(before),
                short(n.value),
                n.how
            ))
        ),
        Outcome::Unexplained if named.is_empty() => format!(
            "The mismatch is real, and no candidate in the library explains it: {} % of the residual variance is \
             predictable from its past, the input or the state.",
            short(100.0 * account.predictable)
        ),
        Outcome::Unexplained if effects.iter().any(departs) => {
            let laws = holding(effects, &named);
            let rest = if account.is_structured {
                format!(
                    "; {} % of the remaining residual variance is still predictable",
                    short(100.0 * account.predictable)
                )
            } else {
                String::new()
            };
            let forms: Vec<String> = effects.iter().filter(|e| departs(e)).filter_map(form).collect();
            format!("The model left out {}, but {}: with the stated form, {fall}{rest}.", listed(&laws), listed(&forms))
        }
        Outcome::Unexplained => format!(
            "The model left out {}, and something else: {fall}{}; {} % of the remaining residual variance is predictable.",
            listed(&holding(effects, &named)),
            remaining(answer),
            short(100.0 * account.predictable)
        ),
        Outcome::Adequate => format!(
            "Nothing is missing that this recording could show: the base model's residual of {} {unit} is {}, \
             and an effect worth {} % of its variance would have been detected.",
            short(before),
            account.neighbour.map_or("white".to_owned(), |c| format!(
                "noise, correlated between neighbouring readings ({}) and otherwise white",
                short(c)
            )),
            short(100.0 * account.detectable_r_squared)
        ),
    };
    sentence + &doubts(&account.doubts)
}

/// Why input and output do not belong together as they stand, in a sentence.
fn apart(broken: &Broken) -> String {
    match broken {
        Broken::Exchanged { input, output } => format!(
            "The columns look swapped: {input} responds to {output} as an oscillator responds to a force, not the \
             other way round."
        ),
        Broken::Rescaled { input, output, row, factor } => format!(
            "The size of {output} relative to {input} changes by a factor of about {} near row {row}, as where a \
             column changes its unit or range.",
            short(*factor)
        ),
    }
}

/// States what the named laws remove of the base model's error together, and what remains, where
/// models were judged by free simulation.
fn shares(answer: &Answer, laws: &[String], unit: &str) -> String {
    let (test, floor) = (&answer.fit.test, answer.fit.noise_floor);
    let share = test.share.map_or(f64::NAN, |s| 100.0 * s.value);
    let after = test.rmse_after.unwrap_or(test.rmse_before);
    let verb = if laws.len() == 1 { "removes" } else { "remove" };
    let rest = if answer.outcome == Outcome::Explained {
        // What has no name is stated apart: the share is that of the names.
        let further = bettered(answer).map_or(String::new(), |repaired| {
            let terms = repaired.terms.join(", ");
            format!("; corrections that are not named ({terms}) bring it to {} {unit}", short(repaired.test_rmse))
        });
        format!("{further}; what remains is noise")
    } else {
        let depends = answer.places.argument.as_ref().map_or(String::new(), |a| {
            format!(" and depends on {} ({} % of it)", a.name, short(100.0 * a.share.value))
        });
        format!("; what remains is {} times the noise{depends}", short(after / floor.max(1e-300)))
    };
    let judged = match answer.fit.recordings.iter().filter(|r| r.role == Role::Test).count() {
        0 => "held-out error",
        1 => "error on the validation recording",
        _ => "error on the validation recordings",
    };
    let forms: Vec<String> = answer.effects.iter().filter(|e| departs(e)).filter_map(form).collect();
    let forms = if forms.is_empty() { String::new() } else { format!("; {}", listed(&forms)) };
    format!(
        "{} {verb} {share:.1} % of the base model's {judged} ({} → {} {unit}){rest}{forms}.",
        listed(laws),
        short(test.rmse_before),
        short(after)
    )
}

/// The errors with what has no name, where it lowers that on held-out samples.
fn bettered(answer: &Answer) -> Option<&WithUnnamed> {
    let after = answer.fit.test.rmse_after?;
    answer.fit.with_unnamed.as_ref().filter(|repaired| repaired.test_rmse < 0.995 * after)
}

/// The parameter that is quoted: the first that is known to better than half its size, as the first
/// of two rails may lie anywhere beyond the motion.
fn telling(parameters: &[Estimate]) -> Option<&Estimate> {
    let known = |p: &&Estimate| 0.5 * (p.ci95[1] - p.ci95[0]) < 0.5 * p.value.abs();
    parameters.iter().find(known).or(parameters.first())
}

/// Returns whether unseen samples tell an effect's law from its stated form.
fn departs(effect: &Effect) -> bool {
    effect.form.as_ref().is_some_and(|f| f.departs)
}

/// Says how far an effect's law departs from its stated form, as a clause.
pub(crate) fn form(effect: &Effect) -> Option<String> {
    let form = effect.form.as_ref()?;
    let percent = |v: f64| short(100.0 * v);
    let stated = form.stated.replace("^2", "²").replace("^3", "³");
    Some(if form.departs {
        format!(
            "the form of {} departs from {stated} by {} % (95 % interval {} to {} %)",
            effect.id,
            percent(form.departure),
            percent(form.ci95[0]),
            percent(form.ci95[1])
        )
    } else {
        format!(
            "the form of {} is {stated}: a free curve differs from it by at most {} % (95 %)",
            effect.id,
            percent(form.ci95[1])
        )
    })
}

/// States what the named effects do to the error on held-out samples.
fn fall(answer: &Answer, unit: &str) -> String {
    let before = answer.fit.test.rmse_before;
    // What has no name is stated apart: the fall is that of the names.
    let further = bettered(answer).map_or(String::new(), |repaired| {
        format!(
            " (to {} with corrections that are not named: {})",
            short(repaired.test_rmse),
            repaired.terms.join(", ")
        )
    });
    match answer.fit.test.rmse_after {
        Some(after) if after < 0.995 * before => {
            format!("the error on held-out samples goes from {} to {} {unit}", short(before), short(after)) + &further
        }
        Some(after) if after <= 1.05 * before => {
            format!("the error of free simulation on held-out samples stays at {} {unit}", short(after))
        }
        Some(after) => {
            format!("the error on held-out samples grows from {} to {} {unit}", short(before), short(after))
        }
        None => format!("the base model's error on held-out samples is {} {unit}", short(before)),
    }
}

/// States the part of the error that the names remove, and how far what remains is above the noise.
fn remaining(answer: &Answer) -> String {
    let (test, floor) = (&answer.fit.test, answer.fit.noise_floor);
    match test.rmse_after {
        Some(after) if after < 0.995 * test.rmse_before && floor > 0.0 => format!(
            ", {} % less and still {} times the noise",
            short(100.0 * (1.0 - after / test.rmse_before)),
            short(after / floor)
        ),
        _ => String::new(),
    }
}

/// Says where the mismatch lives; not that the error is at the noise where a mismatch is.
pub(crate) fn place(answer: &Answer, account: &Account) -> String {
    if account.at_noise && answer.outcome == Outcome::Unexplained {
        return "the base model's error has the power of the noise; what is missing shows only in its structure".into();
    }
    account.place.clone()
}

/// States what else a reader of the verdict must know of the recording, as a sentence.
fn doubts(clauses: &[String]) -> String {
    if clauses.is_empty() { String::new() } else { format!(" Note: {}.", clauses.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_diagnosis::verdict::{Evidence, Form};
    use proofmass_physics::free_form::Freed;

    #[test]
    fn effects_that_are_tied_are_said_once_with_an_or() {
        let effect = |id: &str, confusable_with: &[&str]| Effect {
            id: id.into(),
            statement: String::new(),
            equation: String::new(),
            parameters: Vec::new(),
            channels: Vec::new(),
            form: None,
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            base: Vec::new(),
            confusable_with: confusable_with.iter().map(|id| (*id).to_owned()).collect(),
        };
        let effects = [effect("a", &[]), effect("b", &["c"]), effect("c", &["b"])];
        let named = ["a (x = 1)", "b (y = 2)", "c (z = 3)"].map(str::to_owned);
        assert_eq!(holding(&effects, &named), ["a (x = 1)", "b or c"]);
        // Without ties all stand with their numbers.
        let apart = [effect("a", &[]), effect("b", &[]), effect("c", &[])];
        assert_eq!(holding(&apart, &named), named);
    }

    #[test]
    fn a_form_that_departs_is_said_with_its_interval_and_one_that_holds_with_its_limit() {
        let form = |departs: bool, low: f64| Form {
            law: Freed::CubicSpring,
            stated: "x^3".into(),
            departure: 0.123,
            ci95: [low, 0.15],
            curve: Vec::new(),
            stated_curve: Vec::new(),
            departs,
        };
        let effect = |form: Form| Effect {
            id: "cubic-stiffness".into(),
            statement: String::new(),
            equation: String::new(),
            parameters: Vec::new(),
            channels: Vec::new(),
            form: Some(form),
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            base: Vec::new(),
            confusable_with: Vec::new(),
        };
        assert_eq!(
            super::form(&effect(form(true, 0.1))).as_deref(),
            Some("the form of cubic-stiffness departs from x³ by 12.3 % (95 % interval 10.0 to 15.0 %)")
        );
        let holds = super::form(&effect(form(false, 0.0)));
        assert_eq!(
            holds.as_deref(),
            Some("the form of cubic-stiffness is x³: a free curve differs from it by at most 15.0 % (95 %)")
        );
    }
}
