//! The verdict on a sensor at rest in words.

mod statement;

use super::listed::listed;
use proofmass_base::number::{duration, short};
use proofmass_diagnosis::rest::detail::{Departure, Detail, Hops, Knocked, Location, Mismatch, Spiky};
use proofmass_diagnosis::verdict::{Effect, Outcome, named};

pub(super) use statement::statements;

/// The verdict in a sentence; `place` says where the mismatch lives.
pub(crate) fn sentence(outcome: Outcome, effects: &[Effect], place: &str, detail: &Detail) -> String {
    match outcome {
        Outcome::Adequate => {
            "A constant and white noise describe every channel: nothing is missing that this recording could show."
                .into()
        }
        Outcome::Explained => format!("The model leaves out {}. With it, the residual is noise.", named(effects)),
        Outcome::Undecidable => {
            let (ties, sure) = parted(effects);
            let told = if ties.is_empty() {
                format!("The model leaves out {}, but the recording cannot confirm its form.", named(&sure))
            } else if sure.is_empty() {
                format!("The model leaves something out, but the recording cannot tell what: {ties}.")
            } else {
                format!(
                    "The model leaves out {}, and something else that the recording cannot identify: {ties}.",
                    named(&sure)
                )
            };
            let open = open(detail);
            if open.is_empty() { told } else { format!("{told} {open}") }
        }
        Outcome::Unexplained => {
            let of = |is: bool| -> String {
                let names = detail.channels.iter().filter(|c| c.fits == is).map(|c| c.name.as_str());
                names.collect::<Vec<_>>().join(", ")
            };
            let left_out = if effects.is_empty() {
                "The mismatch is real, and no candidate in the library explains it".to_owned()
            } else {
                let (ties, sure) = parted(effects);
                let all: Vec<String> = [named(&sure), ties].into_iter().filter(|part| !part.is_empty()).collect();
                format!(
                    "The model leaves out {}, and something else that no candidate in the library explains",
                    all.join("; ")
                )
            };
            let others = match of(true) {
                fine if fine.is_empty() => String::new(),
                fine => format!(" The residual of {fine} is noise."),
            };
            if detail.channels.len() == 1 {
                format!("{left_out}. {place}")
            } else {
                format!("{left_out} in {}. {place}{others}", of(false))
            }
        }
    }
}

/// Exponents that may not be a library law's.
fn open(detail: &Detail) -> String {
    detail.departures.iter().filter(|d| !d.refuted).map(departure).collect::<Vec<_>>().join(" ")
}

/// States what the fitted exponent of a channel's drift means for its laws.
fn departure(of: &Departure) -> String {
    let Departure { channel, ids, near, refuted, in_time, column, jump_s, exponent, ci95 } = of;
    let ids = ids.join(" and ");
    if let Some(at_s) = jump_s {
        return format!("{channel}: one jump of the bias, at {}, fits as well as {ids}.", duration(*at_s));
    }
    if let Some(column) = column {
        return match *refuted {
            true => format!("{channel}: it depends on `{column}` in a way that no law here states, not as {ids}."),
            false => format!("{channel}: a function of `{column}` that no law here states fits as well as {ids}."),
        };
    }
    let law = |value: f64| {
        let value = short(value);
        if *in_time { format!("with time as t^{value}") } else { format!("with a spectrum as f^−{value}") }
    };
    match (exponent, ci95) {
        (Some(value), Some([low, high])) => {
            let interval = format!("exponent {} to {}", short(*low), short(*high));
            if let (true, Some(near)) = (*refuted, near) {
                format!("{channel}: it drifts {} ({interval}): close to {near}, but the exponent differs.", law(*value))
            } else if *refuted {
                format!("{channel}: it drifts {} ({interval}), not as {ids}.", law(*value))
            } else {
                format!("{channel}: {} ({interval}) fits as well as {ids}.", law(*value))
            }
        }
        _ if *refuted => format!("{channel}: it drifts smoothly in time, but not as {ids}."),
        _ => format!("{channel}: a smooth course in time fits as well as {ids}."),
    }
}

/// Tied effects in words, and those that are sure.
fn parted(effects: &[Effect]) -> (String, Vec<Effect>) {
    let (ties, sure): (Vec<Effect>, Vec<Effect>) = effects.iter().cloned().partition(|e| !e.confusable_with.is_empty());
    let tie = |e: &Effect| format!("{} or {} in {}", e.id, e.confusable_with.join(" or "), e.channels.join(", "));
    (ties.iter().map(tie).collect::<Vec<_>>().join("; "), sure)
}

/// Says what would decide or confirm.
pub(crate) fn next_experiment(outcome: Outcome, detail: &Detail) -> &'static str {
    match outcome {
        _ if detail.temperature_unlogged => {
            "Log the temperature next to the sensor and name its column under environment: that confirms the cause and gives \
             the slopes."
        }
        Outcome::Adequate => {
            "Record longer: slow terms show only at averaging times that fit into the log several \
                              times."
        }
        Outcome::Explained => "Record again on another day: the same coefficients should come out.",
        Outcome::Undecidable => "Record four times as long: the candidates separate at longer averaging times.",
        Outcome::Unexplained if detail.has_environment => {
            "Record again on a quiet foundation and at another sampling rate: that separates vibration and aliasing from \
             what the sensor does by itself."
        }
        Outcome::Unexplained => {
            "Record again on a quiet foundation, at another sampling rate and with temperature logged: that \
             separates vibration, aliasing and environment."
        }
    }
}

/// Says where the mismatch lives.
pub(crate) fn place(detail: &Detail) -> String {
    let location = &detail.location;
    let mut sentences: Vec<String> = Vec::new();
    for jump in &location.jumps {
        sentences.push(format!(
            "{}: the bias jumps, most strongly at {}; no noise or drift law in the library does that.",
            jump.channels.join(", "),
            duration(jump.time_s)
        ));
    }
    sentences.extend(detail.departures.iter().filter(|d| d.refuted).map(departure));
    sentences.extend(disturbed(location));
    sentences.extend(location.hops.iter().map(|h| hops(h, &detail.unit)));
    if !location.hops.is_empty() {
        sentences.push("A Gaussian drift such as `gauss-markov` may have that spectrum, but no levels.".into());
    }
    sentences.extend(location.mismatches.iter().map(|m| mismatch(m, location.described)));
    if !location.also.is_empty() {
        sentences.push(format!("Also in {}.", location.also.join(", ")));
    }
    if sentences.is_empty() {
        sentences.push("Nowhere in particular: no frequency band and no time interval stands out.".into());
    }
    sentences.join(" ")
}

/// Knocks and spikes, channel by channel.
fn disturbed(location: &Location) -> Vec<String> {
    let mut out = Vec::new();
    let mut knocks: &[Knocked] = &location.knocks;
    while let Some(first) = knocks.first() {
        let (own, others) = knocks.split_at(knocks.iter().take_while(|k| k.channel == first.channel).count());
        let largest = own.iter().max_by(|a, b| a.deviations.total_cmp(&b.deviations)).unwrap_or(first);
        out.push(format!(
            "{}: {} up to {} standard deviations, {}{}; left out of the fit.",
            first.channel,
            if own.len() == 1 { "a knock of".to_owned() } else { format!("{} knocks of", own.len()) },
            short(largest.deviations),
            during(largest.from_s, largest.to_s),
            if own.len() == 1 { "" } else { " the largest" }
        ));
        knocks = others;
    }
    out.extend(location.spikes.iter().map(|Spiky { channel, count }| {
        format!("{channel}: {count} single readings are outliers, beyond the tail of any noise model considered.")
    }));
    out
}

/// An interval of time in words, also where both ends are the same to as many digits.
fn during(from_s: f64, to_s: f64) -> String {
    let [from, to] = [from_s, to_s].map(duration);
    match from == to {
        true => format!("at {from}, for {}", duration(to_s - from_s)),
        false => format!("from {from} to {to}"),
    }
}

/// A channel that hops between levels.
fn hops(hops: &Hops, unit: &str) -> String {
    let dwells: Vec<String> = hops.dwell_s.iter().map(|d| duration(*d)).collect();
    let (levels, dwells) = match (&hops.levels[..], &dwells[..]) {
        ([_, distance], [low, high]) => (
            format!("between two levels {} {unit} apart", short(*distance)),
            format!("{low} at the lower and {high} at the higher level"),
        ),
        (levels, dwells) => (
            format!(
                "among levels {} {unit} above the lowest",
                listed(&levels[1..].iter().map(|l| short(*l)).collect::<Vec<_>>())
            ),
            format!("{} at them", listed(dwells)),
        ),
    };
    format!("{}: the bias hops {levels} (popcorn noise; {} hops, on average after {dwells}).", hops.channel, hops.count)
}

/// One channel's residual in a sentence.
fn mismatch(residual: &Mismatch, described: bool) -> String {
    let name = &residual.channel;
    let by = if described { "of white noise" } else { "that the best model explains" };
    if let Some(s) = residual.band_hz {
        // A law of drift or noise reaches over a decade at least.
        let narrow = s.to < 1.6 * s.from && s.excess > 1.3;
        return format!(
            "{name}: most between {} and {} Hz (averaging times {} to {}), with {} times the power {by}.{}",
            short(s.from),
            short(s.to),
            duration(0.37 / s.to),
            duration(0.37 / s.from),
            short(s.excess),
            if narrow { " Such a narrow band is usually vibration of the mounting surface." } else { "" }
        );
    }
    let fading = residual.fading.map(|[below_hz, fraction]| {
        format!(
            "below {} Hz it has only {} times the power of the best model: slow fluctuations are suppressed, as when \
            the sensor tracks and removes its own bias",
            short(below_hz),
            short(fraction)
        )
    });
    if let (Some(fading), true) = (&fading, residual.steady) {
        return format!("{name}: {fading}.");
    }
    let [low, high] = residual.power.map(short);
    let unsteady = match residual.time_s.as_slice() {
        [] if residual.creep.is_some() => format!(
            "{name}: its noise is not steady, its power {} by {} of its mean from end to end.",
            if residual.creep.is_some_and(|c| c > 0.0) { "grows" } else { "falls" },
            short(residual.creep.unwrap_or(0.0).abs())
        ),
        [] => format!("{name}: its noise is not steady, its power goes from {low} to {high} times that modelled."),
        [first, more @ ..] => format!(
            "{name}: its noise is not steady: {}{} it has up to {high} times the power modelled, at its quietest {low} \
             times{}.",
            during(first.from, first.to),
            match more.len() {
                0 => String::new(),
                1 => " and in one more interval".into(),
                n => format!(" and in {n} more intervals"),
            },
            if residual.only_there { "; outside that, the residual is noise" } else { "" }
        ),
    };
    unsteady + &fading.map(|f| format!(" Also, {f}.")).unwrap_or_default()
}
