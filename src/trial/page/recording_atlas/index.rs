//! The index of an atlas: one line a recording, with the verdict and the page that has the rest.

use super::origin;
use crate::recording_atlas::survey::Surveyed;
use proofmass_base::number::duration;
use proofmass_diagnosis::candidate::Kind;
use proofmass_report::table::Table;

/// Returns the index; `command` is what made it.
pub fn page(found: &[Surveyed], command: &str) -> String {
    let mut table = Table::new(&["page", "recording", "kind", "rows, length", "verdict", "named", "licence"]);
    for surveyed in found {
        let set = &surveyed.set;
        for (question, answered) in surveyed.questions() {
            let size = answered.verdict.as_ref().map_or("–".to_owned(), |verdict| {
                let info = &verdict.recording;
                match verdict.kind {
                    Kind::Response => format!("{} steps", info.rows),
                    _ => format!("{}, {}", info.rows, duration(info.rows as f64 / info.rate_hz)),
                }
            });
            let kind = answered.verdict.as_ref().map_or("–", |verdict| verdict.kind.name());
            let named: Vec<String> = answered.said.groups.iter().map(|group| group.join(" or ")).collect();
            table.row([
                format!("[{}]({}.md)", set.title, set.id),
                question.name.clone(),
                kind.to_owned(),
                size,
                answered.said.outcome.name().to_owned(),
                if named.is_empty() { "–".to_owned() } else { named.join(", ") },
                set.licence.clone(),
            ]);
        }
    }
    format!(
        "# Atlas of recordings\n\nWhat proofmass finds of recordings that others have measured and published: one line a \
         recording, one page a set with source, numbers, intervals and the verdict in the tool's own words. What is known of \
         them from elsewhere stands in [the proof](../proof/summary.md), not here.\n\n\
         [Is there a random walk in real MEMS gyros?](random-walk.md) has every axis that lay still.\n\n{}\n{}",
        table.to_markdown(),
        origin(command)
    )
}
