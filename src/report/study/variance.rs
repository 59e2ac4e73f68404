//! The variance of a study's last position error, shared among its sources: on a terminal and on a
//! page.

use super::moment::moment;
use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::significant;
use proofmass_numerics::statistics::Estimate;
use proofmass_simulate::decision::variance::Variance;

/// Explains the three shares.
const MEANING: &str = "Alone: the part of the variance that would go if this source were known and all others were not. \
    With interactions: what would stay if all others were known. Shapley: between the two, every interaction in equal \
    parts among its sources; these add up to 100 %. Intervals are of 95 %, by bootstrap over the members; sampling may \
    carry a share below zero.";

/// The table with its sentences, for a terminal.
pub(super) fn terminal(variance: &Variance) -> String {
    let held: String = held(variance).iter().map(|words| format!("{words}\n")).collect();
    format!("{}\n{}{held}", sentence(variance), table(variance))
}

/// Adds it to the section of a page that says which error is to blame.
pub(crate) fn append(page: &mut Page, variance: &Variance) {
    page.subsection("Shared among the sources, with what they do together");
    page.paragraph(&sentence(variance));
    page.table(&table(variance));
    held(variance).iter().for_each(|words| page.paragraph(words));
    page.paragraph(MEANING);
}

fn sentence(variance: &Variance) -> String {
    let error = match variance.quantity {
        "position_error_m" => "position error",
        _ => "horizontal position error, north and east together,",
    };
    let alone: f64 = variance.sources.iter().map(|source| source.share.alone.value).sum();
    format!(
        "Variance of the {error} after {} (standard deviation {} m, {} members, on the CPU), shared among its sources: \
         alone they make {} % of it.",
        moment(variance.time_s),
        significant(variance.sd_m, 3),
        variance.members,
        percent(alone)
    )
}

/// Names what a source holds that is several.
fn held(variance: &Variance) -> Vec<String> {
    let several = variance.sources.iter().filter(|source| !source.holds.is_empty());
    let words = several.map(|source| {
        format!(
            "{}, whose random numbers have one seed, holds: {}.",
            capitalised(source.source),
            source.holds.join(", ")
        )
    });
    words.collect()
}

fn table(variance: &Variance) -> Table {
    let interval = "95 % interval";
    let mut table =
        Table::new(&["source", "alone / %", interval, "with interactions / %", interval, "Shapley / %", interval]);
    let cells = |estimate: Estimate| {
        let [low, high] = estimate.ci95.map(percent);
        [percent(estimate.value), format!("{low} to {high}")]
    };
    for source in &variance.sources {
        let share = source.share;
        let shares = [share.alone, share.total, share.shapley].into_iter().flat_map(cells);
        table.row(std::iter::once(source.source.to_owned()).chain(shares));
    }
    table
}

/// A share as a percentage, to the tenth that 16384 members settle to a few units.
fn percent(share: f64) -> String {
    let text = format!("{:.1}", 100.0 * share);
    // What rounds to nothing has no sign.
    if text == "-0.0" { "0.0".into() } else { text.replacen('-', "−", 1) }
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
