//! The answer, the next best, and what is in the way, a sentence a line.

use super::words::{experiment, limit, percent, rivals};
use proofmass_base::number::short;
use proofmass_diagnosis::plan::confirm::Confirmed;
use proofmass_diagnosis::plan::question::Purpose;
use proofmass_diagnosis::plan::search::{Binding, Planned, Proposal};

/// All of them, the answer first.
pub(super) fn all(planned: &Planned, wish: f64, confirmed: &[Confirmed]) -> Vec<String> {
    let mut out = vec![answer(planned, wish)];
    out.extend(confirmed.first().map(|c| told("recorded and diagnosed", c)));
    out.extend(
        planned
            .best
            .get(1)
            .map(|next| format!("next best: {}; {}", experiment(&next.experiment), gives(planned, next))),
    );
    out.extend(confirmed.get(1).map(|c| told("next best, recorded and diagnosed", c)));
    out.extend(
        planned.broadband.as_ref().map(|b| format!("for comparison: {}, would do as well", experiment(&b.experiment))),
    );
    if let Purpose::Narrow(interval) = &planned.question.purpose {
        out.push(format!(
            "going on as before: {} s more halve the interval of {}, as it shrinks with the square root of the length",
            short(3.0 * interval.seconds),
            interval.parameter
        ));
    }
    out
}

/// The answer in a sentence or two.
pub(super) fn answer(planned: &Planned, wish: f64) -> String {
    let Some(best) = planned.best.first() else { return "No experiment can be simulated.".into() };
    let (what, gives) = (experiment(&best.experiment), gives(planned, best));
    match &planned.binding {
        None => format!("Play {what}: {gives}."),
        Some(binding) => {
            let wanted = match planned.question.purpose {
                Purpose::Narrow(_) => "halves the interval".to_owned(),
                Purpose::Decide | Purpose::Show(_) => format!("reaches {}", percent(wish)),
            };
            format!("No experiment within these limits {wanted}. The best is {what}: {gives}. {}", in_the_way(binding))
        }
    }
}

/// Says what an experiment gives.
fn gives(planned: &Planned, proposal: &Proposal) -> String {
    let rivals = rivals(planned);
    let probability = percent(proposal.probability);
    match (&planned.question.purpose, proposal.half_width) {
        (Purpose::Narrow(interval), Some(half)) => format!(
            "the 95 % interval of {} of {} is then ± {} {} by itself (now ± {})",
            interval.parameter,
            rivals.join(", "),
            short(half),
            interval.unit,
            short(interval.half_width)
        ),
        (Purpose::Decide, _) if rivals.len() > 1 => format!(
            "whether {} is true, or none of them, `diagnose` then says so with a probability of {probability}{}",
            rivals.join(" or "),
            least(&rivals, proposal)
        ),
        _ => {
            let known = planned.question.rivals.first();
            let law = known.map(|k| {
                let parameter = k.term.candidate().parameters[0].name;
                format!("{} with {parameter} = {}", k.term.id(), short(k.values[0]))
            });
            format!("`diagnose` then names {} with a probability of {probability}", law.unwrap_or_default())
        }
    }
}

/// The rival that is decided for least, where that is less than what is stated by a twentieth or more.
fn least(rivals: &[&str], proposal: &Proposal) -> String {
    let least = rivals.iter().zip(&proposal.each).min_by(|a, b| a.1.total_cmp(b.1));
    let far = least.filter(|(_, p)| **p < proposal.probability - 0.05);
    far.map_or(String::new(), |(id, p)| format!(", least where {id} is true: {}", percent(*p)))
}

/// The limit in the way.
fn in_the_way(binding: &Binding) -> String {
    let doubled: Vec<String> =
        binding.doubled.iter().map(|(l, p)| format!("twice the {} gives {}", limit(*l), percent(*p))).collect();
    let what = limit(binding.limit);
    let much = match binding.factor {
        Some(factor) => format!("The {what} is in the way: {} times as much would do", short(factor)),
        None => format!("The {what} is most in the way, and even 64 times as much would not do"),
    };
    format!("{much} ({}).", doubled.join(", "))
}

fn told(what: &str, c: &Confirmed) -> String {
    format!("{what}: {} of {} decided rightly, {} wrongly, the others left open", c.right, c.of, c.wrong)
}
