//! States what the sections of all figures share: their heading, their checks, and curves thinned
//! to what a page can show.

use crate::check::{Check, Exhibit};
use proofmass_base::number::{significant, worth};
use proofmass_report::html::Page;
use proofmass_report::table::Table;

/// At most `most` points of a curve, evenly taken, the last kept.
pub(crate) fn thin(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(most.max(2)).max(1);
    let mut out: Vec<_> = points.iter().copied().step_by(every).collect();
    if let (Some(last), Some(kept)) = (points.last(), out.last())
        && last != kept
    {
        out.push(*last);
    }
    out
}

/// Heading of a figure's section.
pub(crate) fn head(page: &mut Page, exhibit: &Exhibit) {
    page.section(&format!("Figure {}. {}", exhibit.figure, exhibit.title));
    page.prefix(format!("figure-{:02}-", exhibit.figure));
}

/// The checks of a figure: what is expected, what came out, and whether they agree.
pub(crate) fn checks(page: &mut Page, exhibit: &Exhibit) {
    let mut table = Table::new(&["check", "holds", "computed", "expected", "why"]);
    for c in &exhibit.checks {
        let (got, expected) = shown(c);
        table.row([c.name.clone(), if c.holds { "✓" } else { "✗" }.into(), got, expected, c.because.clone()]);
    }
    page.table(&table);
}

/// The numbers of a check: computed, and expected with the distance allowed.
fn shown(c: &Check) -> (String, String) {
    if c.range {
        let ends = [c.expected - c.tolerance, c.expected + c.tolerance].map(|v| significant(v, 3));
        return (significant(c.got, 3), ends.join(" to "));
    }
    // One digit more than the tolerance has, so that a near miss can be seen.
    let shown = |v| worth(v, 0.1 * c.tolerance);
    (shown(c.got), format!("{} ± {}", shown(c.expected), significant(c.tolerance, 2)))
}
