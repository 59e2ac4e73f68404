//! Says in a few sentences whether a kind of sensor has a random walk, the plain answer first.

use super::numbers::coefficient;
use crate::recording_atlas::measured::Quantity;
use crate::recording_atlas::recipe::Temperature;
use crate::recording_atlas::walk::{Answer, Doubt, Line};
use proofmass_base::number::duration;

/// Returns the answer of all axes of a quantity.
pub(super) fn sentences(lines: &[Line], quantity: Quantity) -> String {
    let of = |is: fn(&Answer) -> bool| -> Vec<&Line> {
        lines.iter().filter(|l| l.quantity == quantity && is(&l.answer)).collect()
    };
    let shown = of(|a| *a == Answer::Shown);
    let perhaps = of(|a| matches!(a, Answer::Perhaps(_)));
    let none = of(|a| *a == Answer::NoneSeen);
    let mut words = vec![plain(&shown, &perhaps, &none, name(quantity))];
    if !perhaps.is_empty() {
        words.push(format!("Perhaps: {}.", with_reasons(&perhaps)));
    }
    if !none.is_empty() {
        words.push(format!("No walk as strong is in {}.", places(&none)));
    }
    let short = of(|a| *a == Answer::CannotTell);
    if !short.is_empty() {
        let longest_s = short.iter().map(|l| l.length_s).fold(0.0, f64::max);
        let more = if short.len() < of(|_| true).len() { "more " } else { "" };
        words.push(format!(
            "{} {more}{} cannot tell: their logs, of {} at most, would not have shown a walk as strong as those of others.",
            short.len(),
            axes(short.len()),
            duration(longest_s)
        ));
    }
    let removed = of(|a| *a == Answer::BiasRemoved);
    if !removed.is_empty() {
        words.push(format!(
            "Nor can {}, however long the log: the mean is zero to within its own stability, so the bias was taken off \
             before it was logged, and a walk may have gone with it.",
            places(&removed)
        ));
    }
    words.join(" ")
}

/// The first sentence, and what it rests on.
fn plain(shown: &[&Line], perhaps: &[&Line], none: &[&Line], name: &str) -> String {
    let able = shown.len() + perhaps.len() + none.len();
    if able == 0 {
        return format!("**These logs cannot tell whether {name}s have a random walk.**");
    }
    let counted = |some: usize| format!("{some} of the {able} {name} {} whose logs can tell", axes(able));
    if shown.is_empty() {
        return match perhaps.len() {
            0 => format!("**No: none of the {able} {name} {} whose logs can tell has a random walk.**", axes(able)),
            some => format!("**Perhaps, in {}; for sure in none.**", counted(some)),
        };
    }
    let each = shown.iter().map(|l| format!("`{}` of {} has K = {}", l.axis, l.recording, coefficient(&l.walk)));
    let mut words = format!(
        "**Yes, in {}:** {}, and nothing else that is known to the tool describes its drift as well.",
        counted(shown.len()),
        each.collect::<Vec<_>>().join("; ")
    );
    let unlogged: Vec<&Line> = shown.iter().copied().filter(|l| l.temperature == Temperature::NotLogged).collect();
    if !unlogged.is_empty() {
        words += &format!(" No temperature was logged with {}, so a wandering one is not excluded.", places(&unlogged));
    }
    words
}

pub(super) fn name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Gyro => "gyro",
        Quantity::Accelerometer => "accelerometer",
    }
}

fn axes(count: usize) -> &'static str {
    if count == 1 { "axis" } else { "axes" }
}

/// Axes by recording: "`gx`, `gy` of ADIS16405; `gz` of Sense HAT".
fn places(lines: &[&Line]) -> String {
    grouped(lines, |_| String::new())
}

/// The same with the reason of the doubt behind each.
fn with_reasons(lines: &[&Line]) -> String {
    grouped(lines, |line| doubt(&line.answer).map(|words| format!(" ({words})")).unwrap_or_default())
}

fn grouped(lines: &[&Line], behind: impl Fn(&Line) -> String) -> String {
    let mut groups: Vec<(&str, String, Vec<String>)> = Vec::new();
    for line in lines {
        let (recording, words, axis) = (line.recording.as_str(), behind(line), format!("`{}`", line.axis));
        match groups.iter_mut().find(|(r, w, _)| *r == recording && *w == words) {
            Some((_, _, axes)) => axes.push(axis),
            None => groups.push((recording, words, vec![axis])),
        }
    }
    let said = groups.iter().map(|(recording, words, axes)| format!("{} of {recording}{words}", axes.join(", ")));
    said.collect::<Vec<_>>().join("; ")
}

/// Reason why a walk is not sure, in a few words.
pub(super) fn doubt(answer: &Answer) -> Option<String> {
    let Answer::Perhaps(doubt) = answer else { return None };
    Some(match doubt {
        Doubt::Tie(rivals) => format!("{} as well", rivals.join(" or ")),
        Doubt::CurveAlone => "the curve rises so, `diagnose` names no walk".into(),
        Doubt::DiagnosisAlone => "`diagnose` names it, the curve does without".into(),
        Doubt::Temperature => "or temperature, which this sensor follows".into(),
    })
}
