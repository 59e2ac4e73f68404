//! Measured speed as a table, a page, a summary in Markdown and figures.

use crate::prediction::{CARDS, reached};
use crate::published::PUBLISHED;
use crate::{FULL, NOISELESS, NORMAL, Row, work};
use proofmass_base::number::significant;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark};
use proofmass_report::html::Page;
use proofmass_report::table::Table;
use proofmass_simulate::backend::cpu::processor_name;

const LEAD: &str =
    "Units per second, fastest of repeated runs in one process. Compare rows within one run, not between runs.";

fn percent(fraction: f64) -> String {
    format!("{} %", significant(100.0 * fraction, 3))
}

fn millions(per_second: f64) -> String {
    significant(per_second / 1e6, 4)
}

/// Every measured rate as one table, fastest of repeated runs.
pub fn table(rows: &[Row]) -> Table {
    let headings = ["work", "where", "precision", "members", "million per s", "of", "instructions", "fraction of peak"];
    let mut table = Table::new(&headings);
    for r in rows {
        table.row([
            r.work.clone(),
            r.place.clone(),
            r.precision.clone(),
            r.members.to_string(),
            millions(r.per_second),
            r.unit.clone(),
            r.instructions.map_or_else(String::new, |n| significant(n, 3)),
            r.share_of_peak.map_or_else(String::new, percent),
        ]);
    }
    table
}

/// Published speeds next to the rows of the same work.
fn published(rows: &[Row]) -> Table {
    let mut table = Table::new(&["work", "by", "on", "million steps per s", "source"]);
    for p in &PUBLISHED {
        for r in rows.iter().filter(|r| r.work == p.work) {
            let place = if r.place == "cpu" { processor_name() } else { r.place.clone() };
            let here = [format!("proofmass, {}", r.precision), place, millions(r.per_second), "this run".to_owned()];
            table.row([p.work.to_owned()].into_iter().chain(here));
        }
        table.row([p.work, p.solver, p.machine, &millions(p.per_second()), p.source]);
    }
    table
}

/// Returns what the full path is predicted to reach on cards that are not here.
fn predicted() -> Table {
    let mut table =
        Table::new(&["card", "f32 lanes × boost clock", "TFLOP/s", "bound, million member-steps per s", "expected"]);
    for card in CARDS {
        let bound = card.bound_per_s();
        table.row([
            card.name.to_owned(),
            format!("{} × {} GHz", card.lanes, card.boost_ghz),
            significant(card.flops() / 1e12, 3),
            millions(bound),
            millions(reached() * bound),
        ]);
    }
    table
}

/// Words on how quiet the machine was; `others` is the share of it that other programs used.
pub fn busy(others: Option<f64>) -> String {
    match others {
        Some(fraction) if fraction < 0.06 => {
            format!("Other programs used {} of the processors during the run.", percent(fraction))
        }
        Some(fraction) => format!(
            "Other programs used {} of the processors during the run: these rates are too low, and even their ratios \
            are uncertain.",
            percent(fraction)
        ),
        None => "The load from other programs is unknown on this system.".to_owned(),
    }
}

/// Words on how instructions and bytes were counted.
fn counting(rows: &[Row]) -> String {
    let bytes = rows.iter().find(|r| r.work == FULL).and_then(|r| r.bytes.zip(r.instructions));
    let intensity = bytes.map_or_else(String::new, |(b, n)| {
        format!(
            " A member-step of the full path in f32 moves {} bytes to and from memory for {} instructions: it is \
            bound by arithmetic, far from the memory roofline.",
            significant(b, 2),
            significant(n, 3)
        )
    });
    format!(
        "Processor: {}, {} threads. A member-step is one integration step of one sensor. The fraction of peak counts \
        the instructions of a unit (fused multiply-adds, additions, shifts alike, in lanes of the row's precision; by \
        hand, in \
         src/benchmark/operations.rs) against the multiply-adds per second measured in the same run; other \
         instructions may run in parallel with multiply-adds, so it is not a strict bound.{intensity}",
        processor_name(),
        std::thread::available_parallelism().map_or(1, usize::from)
    )
}

fn prediction_words() -> String {
    format!(
        "A prediction, not a measurement: the card's lanes times its boost clock over the full path's counted \
        instructions, all slots used, and {} of that, which is what an NVIDIA H200 reached in runs of 100,000 steps. \
        Lanes and clocks are from published specification lists, not from the manufacturers' datasheets. On such a \
        card, `proofmass bench` adds its own rows to the table above.",
        percent(reached())
    )
}

fn places(rows: &[Row]) -> Vec<(&str, Ink)> {
    let mut places: Vec<&str> = rows.iter().map(|r| r.place.as_str()).collect();
    places.dedup();
    places.into_iter().zip([Ink::Blue, Ink::Orange]).collect()
}

/// Speed by size of the ensemble.
pub fn sizes(rows: &[Row]) -> Figure {
    let mut chart =
        Chart::new("Speed by size of the ensemble", Axis::log("members"), Axis::log("million member-steps per s"));
    for (place, ink) in places(rows) {
        let sized = rows.iter().filter(|r| r.work == work::SIZED && r.place == place);
        let points: Vec<(f64, f64)> = sized.map(|r| (r.members as f64, r.per_second / 1e6)).collect();
        chart.add(place, ink, Mark::Line, points.clone());
        chart.add("", ink, Mark::Dots(3), points);
    }
    chart.draw()
}

/// Time by length of the run, next to proportionality.
pub fn lengths(rows: &[Row]) -> Figure {
    let scaled: Vec<&Row> = rows.iter().filter(|r| r.work.starts_with(work::SCALED)).collect();
    let units = |r: &Row| r.per_second * r.seconds;
    let points: Vec<(f64, f64)> = scaled.iter().map(|r| (units(r), r.seconds)).collect();
    let mut chart = Chart::new("Time by length of the run", Axis::log("member-steps"), Axis::log("seconds"));
    // The law goes through the longest run, the least disturbed.
    if let Some(last) = scaled.last() {
        let law = points.iter().map(|p| (p.0, p.0 / last.per_second)).collect();
        chart.add("proportional to the longest", Ink::Soft, Mark::Dashed, law);
    }
    chart.add("8192 members", Ink::Blue, Mark::Dots(4), points);
    chart.draw()
}

/// Returns how far the cost per member-step strays over three decades of length: least and greatest
/// against the longest run.
fn linearity(rows: &[Row]) -> Option<String> {
    let scaled: Vec<f64> = rows.iter().filter(|r| r.work.starts_with(work::SCALED)).map(|r| r.per_second).collect();
    let longest = scaled.last()?;
    let (least, greatest) = scaled.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
    Some(format!(
        "Over {} decades of length the cost per member-step is {} to {} of that of the longest run.",
        scaled.len() - 1,
        percent(longest / greatest),
        percent(longest / least)
    ))
}

/// Returns how much longer the full path takes than its dynamics and its numbers, each alone.
fn parts(rows: &[Row]) -> Option<String> {
    let seconds = |work: &str, precision: &str| {
        let row = rows.iter().find(|r| r.work == work && r.precision == precision && r.place == "cpu")?;
        Some(1.0 / row.per_second)
    };
    let of = |precision: &str| {
        let ratio = seconds(FULL, precision)? / (seconds(NOISELESS, precision)? + seconds(NORMAL, precision)?);
        Some(format!("{} in {precision}", percent(ratio)))
    };
    let both: Vec<String> = ["f32", "f64"].into_iter().filter_map(of).collect();
    (!both.is_empty()).then(|| {
        format!("Time of the full path over that of its dynamics and its random numbers alone: {}.", both.join(", "))
    })
}

const SIZES_WORDS: &str = "The full path (Runge-Kutta 4, force noise, two integrations) from one sensor to millions, \
including parameter draws and statistics. Sixty-four members share a group of lanes, so fewer cost the same. Above 8192 \
members a run has 512 steps instead of 4096, so that parameter draws weigh eight times as much: on a GPU they are then \
most of the time.";

/// The page: what was measured and on what.
pub fn page(rows: &[Row], others: Option<f64>) -> Page {
    let mut page = Page::new("How fast proofmass is on this machine", LEAD);
    page.section("Measurements");
    page.paragraph(&busy(others));
    page.paragraph(&counting(rows));
    page.table(&table(rows));
    page.paragraph(&parts(rows).unwrap_or_default());
    page.section("Small and large ensembles, short and long runs");
    page.figure(&sizes(rows), SIZES_WORDS);
    page.figure(&lengths(rows), &linearity(rows).unwrap_or_default());
    page.section("Compared with published results");
    page.table(&published(rows));
    page.section("Predicted for other GPUs");
    page.paragraph(&prediction_words());
    page.table(&predicted());
    page
}

/// The measured rates in Markdown.
pub fn summary(rows: &[Row], others: Option<f64>) -> String {
    [
        "# How fast proofmass is".to_owned(),
        format!("Generated by `proofmass bench --out`. {LEAD}"),
        busy(others),
        counting(rows),
        table(rows).to_markdown(),
        parts(rows).unwrap_or_default(),
        linearity(rows).unwrap_or_default(),
        "## Compared with published results".to_owned(),
        published(rows).to_markdown(),
        "## Predicted for other GPUs".to_owned(),
        prediction_words(),
        predicted().to_markdown(),
    ]
    .join("\n\n")
    .replace("\n\n\n", "\n\n")
}
