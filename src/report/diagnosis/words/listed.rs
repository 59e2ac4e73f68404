//! Names in a sentence.

use proofmass_diagnosis::verdict::Effect;

/// Joins them: "a, b and c".
pub(super) fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., tail] => format!("{} and {tail}", head.join(", ")),
    }
}

/// Effects with their numbers, indistinguishable ones once: "a or b"; a mode may be there more than once.
pub(super) fn holding(effects: &[Effect], named: &[String]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut said: Vec<&str> = Vec::new();
    for (effect, words) in effects.iter().zip(named) {
        if said.contains(&effect.id.as_str()) {
            continue;
        }
        said.extend(effect.confusable_with.iter().map(String::as_str));
        let tied = std::iter::once(&effect.id).chain(&effect.confusable_with).cloned().collect::<Vec<_>>();
        out.push(if effect.confusable_with.is_empty() { words.clone() } else { tied.join(" or ") });
    }
    out
}
