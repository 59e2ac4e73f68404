//! States what one recording could have revealed: on the terminal and as a page.

use crate::like::{Power, Revealed, Tried};
use proofmass_base::number::significant;
use proofmass_diagnosis as diagnosis;
use proofmass_numerics::numerics::order;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark};
use proofmass_report::html::Page;
use proofmass_report::table::Table;

/// The answer in a sentence.
fn sentence(power: &Power) -> String {
    let named: Vec<f64> = power.effects.iter().filter_map(|e| e.named_from).collect();
    let least = named.iter().copied().fold(f64::INFINITY, f64::min);
    let most = named.iter().copied().fold(0.0, f64::max);
    let sizes = if named.is_empty() {
        String::new()
    } else if least == most {
        format!(", from {} × the noise upward", significant(least, 2))
    } else {
        format!(", from {} to {} × the noise on", significant(least, 2), significant(most, 2))
    };
    format!(
        "Of {} effects planted into copies of this recording, {} would have been named{sizes}; {} of {} copies with nothing \
         planted raised an alarm.",
        power.effects.len(),
        named.len(),
        power.alarms,
        power.nulls
    )
}

fn made_of(power: &Power) -> String {
    format!(
        "{}: {} rows at {} Hz; {}. Sizes are the rms that the best refit of the base model leaves, over the rms noise.",
        power.file,
        power.samples,
        significant(power.rate_hz, 5),
        power.base
    )
}

/// "beta = 2.1e5 1/(y²·s²)" of the copy at a size.
fn strength(power: &Power, effect: &Revealed, size: Option<f64>) -> String {
    let at = |tried: &&Tried| Some(tried.effect_over_noise) == size;
    let Some((name, value)) = effect.tried.iter().find(at).and_then(|t| t.strength) else { return String::new() };
    let mut library = diagnosis::library().filter(|c| c.kind.name() == power.kind && c.id == effect.id);
    let unit = library.next().and_then(|c| c.parameters.iter().find(|p| p.name == name)).map_or("", |p| p.unit);
    format!("{name} = {} {unit}", significant(value.abs(), 2)).trim_end().to_owned()
}

fn effects(power: &Power) -> Table {
    let headings = [
        "effect",
        "detected from (× noise)",
        "named from (× noise)",
        "that is",
        "smaller: confused with or indistinguishable from",
    ];
    let mut table = Table::new(&headings);
    for effect in &power.effects {
        let sizes = || effect.tried.iter().map(|t| t.effect_over_noise);
        let (least, largest) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
        let words = |from: Option<f64>| match from {
            Some(size) if size == least => format!("≤ {}", significant(size, 2)),
            Some(size) => significant(size, 2),
            None => format!("> {}", significant(largest, 2)),
        };
        table.row([
            effect.id.clone(),
            words(effect.noticed_from),
            words(effect.named_from),
            strength(power, effect, effect.named_from.or(effect.noticed_from)),
            effect.taken_for.join(", "),
        ]);
    }
    table
}

fn pairs(power: &Power) -> String {
    let pairs: Vec<String> = power.inseparable.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    if pairs.is_empty() {
        "At the largest size no two effects were confused.".to_owned()
    } else {
        format!("Not told apart even at the largest size: {}.", pairs.join("; "))
    }
}

/// The same on a terminal.
pub fn terminal(power: &Power) -> String {
    format!("{}\n{}\n\n{}\n{}\n", sentence(power), made_of(power), effects(power), pairs(power))
}

/// Every copy as a dot: what was said of it.
fn ladder(power: &Power) -> Figure {
    let (least, most) = (0.03, 100.0);
    let mut rows: Vec<&Revealed> = power.effects.iter().collect();
    let from = |e: &Revealed| e.named_from.or(e.noticed_from.map(|s| 10.0 * s)).unwrap_or(f64::INFINITY);
    order::sort_by_key(&mut rows, |e| -from(e));
    let x = Axis::log("size of the effect / noise (rms)").within(least, most);
    let names = rows.iter().enumerate().map(|(n, effect)| (n as f64 + 1.0, effect.id.clone())).collect();
    let y = Axis::linear("").named(names).within(0.0, rows.len() as f64 + 1.0);
    let mut chart = Chart::new("What the diagnosis would have said", x, y);
    let mut dots: [Vec<(f64, f64)>; 4] = Default::default();
    for (n, effect) in rows.iter().enumerate() {
        let rank = n as f64 + 1.0;
        for tried in &effect.tried {
            let way = match (tried.noticed, tried.named, tried.said.starts_with("explained")) {
                (false, ..) => 0,
                (_, true, _) => 2,
                (_, false, true) => 3,
                _ => 1,
            };
            dots[way].push((tried.effect_over_noise.clamp(least, most), rank));
        }
    }
    let ways = [
        ("silent", Ink::Soft, 2),
        ("detected, not named", Ink::Sky, 4),
        ("named, or indistinguishable from one other", Ink::Blue, 5),
        ("false name", Ink::Red, 5),
    ];
    for ((name, ink, radius), points) in ways.into_iter().zip(dots) {
        if !points.is_empty() {
            chart.add(name, ink, Mark::Dots(radius), points);
        }
    }
    chart.size = (560, 140 + 18 * rows.len() as u32);
    chart.draw()
}

/// The same as a page.
pub fn page(power: &Power) -> Page {
    let mut page = Page::new("What this recording could reveal", &sentence(power));
    page.paragraph(&made_of(power));
    page.figure(&ladder(power), "One dot per copy. Effects named at the smallest size are at the top.");
    page.paragraph(&pairs(power));
    page.section("Detectable size");
    page.paragraph(
        "y and u stand for the units of output and input. A smaller effect of that kind may be present undetected.",
    );
    page.table(&effects(power));
    page.section("Every copy");
    let mut every = Table::new(&["planted", "× noise", "said"]);
    for effect in &power.effects {
        for tried in &effect.tried {
            every.row([effect.id.clone(), significant(tried.effect_over_noise, 2), tried.said.clone()]);
        }
    }
    page.table(&every);
    page
}
