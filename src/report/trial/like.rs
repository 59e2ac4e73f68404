//! What one recording could have revealed: on the terminal and as a page.

use crate::report::html::Page;
use crate::report::number::significant;
use crate::report::table::Table;
use crate::trial::like::Power;

/// What a user's own recording could reveal.
pub fn words(power: &Power) -> (String, Table) {
    let sentence = format!(
        "{}: {} rows at {} Hz; {}. Effects were planted into copies of it, sizes as visible rms over noise rms. Of {} \
         copies with nothing planted, {} raised an alarm.",
        power.file,
        power.samples,
        significant(power.rate_hz, 5),
        power.base,
        power.nulls,
        power.alarms
    );
    let mut table = Table::new(&["effect", "noticed from (× noise)", "named from (× noise)", "taken for or tied with"]);
    for effect in &power.effects {
        let largest = effect.tried.iter().map(|t| t.effect_over_noise).fold(0.0, f64::max);
        let words = |from: Option<f64>| match from {
            Some(size) => significant(size, 2),
            None => format!("> {}", significant(largest, 2)),
        };
        let taken = effect.taken_for.join(", ");
        table.row([effect.id.clone(), words(effect.noticed_from), words(effect.named_from), taken]);
    }
    (sentence, table)
}

/// The same on a terminal.
pub fn terminal(found: &Power) -> String {
    let (sentence, table) = words(found);
    let pairs: Vec<String> = found.inseparable.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    let last = if pairs.is_empty() {
        "At the largest size no two effects were confused.".to_owned()
    } else {
        format!("Not told apart at the largest size: {}.", pairs.join("; "))
    };
    format!("{sentence}\n\n{table}\n{last}\n")
}

/// The same as a page.
pub fn page(found: &Power) -> String {
    let (sentence, table) = words(found);
    let mut page = Page::new("What this recording could reveal", &sentence);
    page.table(&table);
    page.paragraph(terminal(found).lines().last().unwrap_or_default());
    page.section("Every copy");
    let mut every = Table::new(&["planted", "× noise", "said"]);
    for effect in &found.effects {
        for tried in &effect.tried {
            every.row([effect.id.clone(), significant(tried.effect_over_noise, 2), tried.said.clone()]);
        }
    }
    page.table(&every);
    page.finish()
}
