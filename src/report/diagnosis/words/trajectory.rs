//! The verdict on an IMU in motion, in plain words.

use proofmass_base::number::short;
use proofmass_diagnosis::model::Half;
use proofmass_diagnosis::trajectory::account::{Absurd, Account, Hidden, Manoeuvre, NamedEffect, Rest, Untold};
use proofmass_diagnosis::trajectory::candidate::{Measure, Term};
use proofmass_diagnosis::trajectory::detail::Detail;
use proofmass_diagnosis::verdict::Outcome;
use proofmass_scenario::sensor::Sense;

/// One or two sentences for the first screen.
pub(super) fn sentence(outcome: Outcome, detail: &Detail) -> String {
    let account = &detail.account;
    let names: Vec<&str> = account.named.iter().map(|n| n.phrase.as_str()).collect();
    let [before, after] = account.held_out.map(short);
    if !account.with_reference {
        return match names.is_empty() {
            true => {
                "Without a reference only limits and vibration can be judged, and the readings show neither.".into()
            }
            false => format!("Without a reference: the readings show {}.", names.join(", ")),
        };
    }
    if !account.absurd.is_empty() {
        let one = |a: &Absurd| {
            let [value, most] = [a.value, a.most].map(short);
            format!("{} of {value} {unit} where there is {most} {unit} at most ({})", a.what, a.source, unit = a.unit)
        };
        let all: Vec<String> = account.absurd.iter().map(one).collect();
        return format!("The fit failed, and nothing fitted is named: it needs {}.", all.join(", and "));
    }
    match outcome {
        Outcome::Adequate => {
            "Nothing is missing that this motion could show: IMU and reference agree within the noise \
                              of both."
                .into()
        }
        Outcome::Explained if !account.is_fitted && !account.louder.is_empty() => {
            let times = |(sensor, ratio): &(Sense, f64)| format!("{} {} times", sensor.name(), short(*ratio));
            format!(
                "The model left out {}. Nothing else is missing: the error on held-out parts of the recording stays \
                 {after} times the noise of the motion; only the stated noise was too small ({}).",
                names.join(", "),
                account.louder.iter().map(times).collect::<Vec<_>>().join(", ")
            )
        }
        Outcome::Explained if !account.is_fitted => format!(
            "The model left out {}. Apart from {} the base model holds: the error on held-out parts of the recording is \
             {after} times the noise.",
            names.join(", "),
            if names.len() == 1 { "it" } else { "them" }
        ),
        Outcome::Explained => format!(
            "The model left out {}. With {} the error on held-out parts of the recording falls from {before} to {after} \
             times the noise.",
            names.join(", "),
            if names.len() == 1 { "it" } else { "them" }
        ),
        Outcome::Unexplained if names.is_empty() => format!(
            "IMU and reference differ, and no candidate in the library explains it: {}.",
            rest(account, &format!("by {before} times the noise"))
        ),
        Outcome::Unexplained => format!(
            "The model left out {}, and something else: {}.",
            account.named.iter().map(or_its_rivals).collect::<Vec<_>>().join(", "),
            rest(account, &format!("the error on held-out parts is still {after} times the noise"))
        ),
        Outcome::Undecidable => {
            let tied = account.named.iter().filter(|n| !n.rivals.is_empty());
            let pairs: Vec<String> = tied.map(or_its_rivals).collect();
            match pairs.is_empty() {
                true => "This motion cannot decide whether anything is missing.".into(),
                false => format!("Something is missing, but this motion cannot tell what: {}.", pairs.join("; ")),
            }
        }
    }
}

/// Says by what a model is refused; `large` where by the size of what it leaves.
fn rest(account: &Account, large: &str) -> String {
    match account.rest {
        Rest::Large => large.to_owned(),
        Rest::Coloured(half) => {
            let of = match half {
                Half::Attitude => "attitude",
                Half::Position => "position",
            };
            format!("what is left of {of} is no white noise, for its neighbours go together")
        }
        Rest::Law => "what is left goes with a law that no candidate has, stated among the findings".to_owned(),
    }
}

/// Names an effect with what cannot be told from it.
fn or_its_rivals(named: &NamedEffect) -> String {
    match named.rivals.is_empty() {
        true => named.phrase.clone(),
        false => format!("{} (or {})", named.phrase, named.rivals.join(", ")),
    }
}

/// Says where the mismatch lives.
pub(super) fn place(detail: &Detail) -> String {
    let rms =
        |series: &[(f64, f64)]| (series.iter().map(|p| p.1 * p.1).sum::<f64>() / series.len().max(1) as f64).sqrt();
    if !detail.account.with_reference {
        return "only in the readings: no reference was given".into();
    }
    let mut parts = Vec::new();
    for (what, series, unit, per) in
        [("attitude", &detail.attitude, "mrad/s", 1e3), ("position", &detail.position, "mm/s²", 1e3)]
    {
        if !series.before.is_empty() {
            let [before, after] = [&series.before, &series.after].map(|s| short(rms(s) * per));
            parts.push(match before == after {
                true => format!("{what}: {before} {unit} rms"),
                false => format!("{what}: {before} {unit} rms with the base model, {after} {unit} as repaired"),
            });
        }
    }
    parts.join("; ")
}

/// Lists what the motion could not determine, in sentences.
pub(super) fn findings(account: &Account) -> Vec<String> {
    let one = |h: &Hidden| {
        let known = match h.term.measure {
            Measure::Plain => "is known only to ±",
            Measure::Time => "may be as long as ",
        };
        // No number that is wider than all there is.
        if h.half_width >= h.term.largest() * h.term.unit.per_si {
            let some = h.elements.join(", ");
            let subject = if some.is_empty() { subject(h.term) } else { format!("{some} of {}", subject(h.term)) };
            return format!("this motion says nothing of {subject}; {} would", manoeuvre(h.manoeuvre));
        }
        format!(
            "this motion does not determine {}: it {known}{} {}; {} would determine it",
            subject(h.term),
            short(h.half_width),
            h.term.unit.name,
            manoeuvre(h.manoeuvre)
        )
    };
    account.hidden.iter().map(one).chain(untold(account)).collect()
}

/// Names what is not known: of a bias that is a candidate its wander, for the bias itself is in the base model.
fn subject(term: &Term) -> String {
    match (term.id(), term.sensor) {
        ("gyro-bias" | "accelerometer-bias", Some(sensor)) => format!("how the {}'s bias wanders", sensor.name()),
        _ => term.phrase(),
    }
}

/// States what a reference with one half of a pose cannot show.
fn untold(account: &Account) -> Option<String> {
    let Untold { half, terms } = account.untold.as_ref()?;
    let names: Vec<String> = terms.iter().map(|t| t.phrase()).collect();
    let alone = match half {
        Half::Position => "attitude",
        Half::Attitude => "position",
    };
    Some(format!("a reference of {alone} alone says nothing about {}; {} would", names.join(" or "), whole(*half)))
}

/// A reference that also has what another lacks.
fn whole(lacking: Half) -> &'static str {
    match lacking {
        Half::Position => "a reference that also has positions",
        Half::Attitude => "a reference that also has attitudes",
    }
}

fn manoeuvre(manoeuvre: Manoeuvre) -> &'static str {
    match manoeuvre {
        Manoeuvre::TurnEveryAxis => "turns about every axis, back and forth",
        Manoeuvre::SixPositions => "holding each of the six faces up for a few seconds",
        Manoeuvre::FigureEight => "figures of eight with quick turns",
        Manoeuvre::Longer => "a longer recording",
    }
}

/// Says what would decide or confirm.
pub(super) fn next_experiment(outcome: Outcome, account: &Account) -> String {
    if !account.with_reference {
        return "Record a reference of the motion with it (motion capture, GNSS/INS, another IMU), and name it under \
                [reference]."
            .into();
    }
    if !account.absurd.is_empty() {
        return "Check that readings and reference are of one run, in the units and axes that their headings say, and \
                use rows in which both work."
            .into();
    }
    let hidden = account.hidden.first().map(|h| manoeuvre(h.manoeuvre));
    match (outcome, hidden, &account.untold) {
        (Outcome::Undecidable, Some(way), _) => {
            format!("Record {way}: it separates the candidates that are indistinguishable here.")
        }
        (Outcome::Unexplained, ..) => {
            "Record the same motion again with another reference: an error that remains belongs to the sensor.".into()
        }
        (_, Some(way), _) => format!("Record {way}: it would determine what this motion does not."),
        (_, None, Some(Untold { half, .. })) => {
            let (example, alone) = match half {
                Half::Position => ("motion capture or GNSS", "attitude"),
                Half::Attitude => ("motion capture", "position"),
            };
            format!("Use {}, e.g. {example}: it would determine what {alone} alone does not.", whole(*half))
        }
        (Outcome::Explained, None, None) => {
            "Diagnose another flight of the same sensor: errors of the sensor itself should repeat.".into()
        }
        _ => "None is needed for what this motion can show.".into(),
    }
}
