//! The page and the terminal text of a requirement: the value that keeps it, or the parts that do,
//! and the curve behind it.

use super::figure::{Axis, Chart, Figure, Ink, Mark, labelled};
use super::html::Page;
use super::table::Table;
use proofmass_base::number::{significant, with_uncertainty, worth};
use proofmass_simulate::decision::document::Found;
use proofmass_simulate::decision::parts::Judged;
use proofmass_simulate::decision::require::{Answer, Outcome, Value};
use proofmass_simulate::decision::statistic::{Limit, Statistic};
use proofmass_simulate::decision::watched::{self, Watched};
use proofmass_study::Study;

/// Name and unit of an error.
fn named(quantity: Watched) -> (&'static str, &'static str) {
    const ONE_AXIS: [(&str, &str); 4] =
        [("position error", "m"), ("velocity error", "m/s"), ("acceleration error", "m/s²"), ("tilt error", "rad")];
    const IN_MOTION: [(&str, &str); watched::IN_MOTION.len()] = [
        ("north position error", "m"),
        ("east position error", "m"),
        ("down position error", "m"),
        ("north velocity error", "m/s"),
        ("east velocity error", "m/s"),
        ("down velocity error", "m/s"),
        ("roll error", "rad"),
        ("pitch error", "rad"),
        ("heading error", "rad"),
        ("horizontal error", "m"),
        ("three-dimensional error", "m"),
    ];
    match quantity {
        Watched::OneAxis(place) => ONE_AXIS[place],
        Watched::InMotion(place) => IN_MOTION[place],
    }
}

/// "95 % percentile of the position error after 60 s".
pub(super) fn subject_of(statistic: Statistic, quantity: Watched, time_s: f64) -> String {
    let (quantity, _) = named(quantity);
    let what = match statistic {
        Statistic::Mean => format!("mean of the {quantity}"),
        Statistic::Sd => format!("standard deviation of the {quantity}"),
        Statistic::Quantile(p) => format!("{} % percentile of the {quantity}", significant(100.0 * p, 2)),
        Statistic::Absolute(p) => format!("{} % percentile of the absolute {quantity}", significant(100.0 * p, 2)),
        Statistic::Circular(p) => format!("{} % circular error probable", significant(100.0 * p, 2)),
    };
    format!("{what} after {time_s} s")
}

/// Unit of a quantity.
pub(super) fn unit_of(quantity: Watched) -> &'static str {
    named(quantity).1
}

fn subject(limit: &Limit) -> String {
    subject_of(limit.statistic, limit.quantity, limit.time_s)
}

fn unit(limit: &Limit) -> &'static str {
    unit_of(limit.quantity)
}

/// "gyro.bias_deg_h.sd = 4.02, 95 % interval 3.98 to 4.06".
fn value(of: &Value) -> String {
    match (of.value, of.ci95) {
        (Some(value), [Some(low), Some(high)]) => {
            let doubt = 0.5 * (high - low);
            let digits = |v: f64| worth(v, 0.2 * doubt);
            format!("{} = {}, 95 % interval {} to {}", of.key, digits(value), digits(low), digits(high))
        }
        (Some(value), _) => format!("{} = {}", of.key, significant(value, 3)),
        (None, _) => of.key.clone(),
    }
}

fn sentence(limit: &Limit, answer: &Answer) -> String {
    let (subject, bound) = (subject(limit), format!("{} {}", limit.below, unit(limit)));
    let values: Vec<String> = answer.vary.iter().map(value).collect();
    let values = values.join("; ");
    let keys: Vec<&str> = answer.vary.iter().map(|v| v.key.as_str()).collect();
    let keys = keys.join(" and ");
    let together = if answer.vary.len() > 1 { ", all scaled by one factor" } else { "" };
    let wide =
        if answer.settled { "" } else { " The interval is wider than requested: raise --members for a narrower one." };
    match answer.outcome {
        Outcome::Crosses { below: true } => {
            format!("The {subject} stays below {bound} up to {values}{together}.{wide}")
        }
        Outcome::Crosses { below: false } => {
            format!("The {subject} stays below {bound} from {values} upward{together}.{wide}")
        }
        Outcome::Always => format!("The {subject} stays below {bound} at every value tried, up to {values}{together}."),
        Outcome::Never => {
            let (at, [low, high]) = (answer.statistic.value, answer.statistic.ci95);
            format!(
                "No value of {keys} keeps the {subject} below {bound}: at the best one tried it is {} {}. The other errors \
                 of the study exceed the limit by themselves.",
                with_uncertainty(at, 0.25 * (high - low)),
                unit(limit)
            )
        }
    }
}

fn parts_sentence(limit: &Limit, parts: &[Judged]) -> String {
    let subject = subject(limit);
    let bound = format!("{} {}", limit.below, unit(limit));
    match parts.iter().filter(|part| part.meets).count() {
        0 => format!("None of the {} parts keeps the {subject} below {bound}.", parts.len()),
        count => {
            let price = parts[0].price.map_or(String::new(), |price| format!(", for {price}"));
            let first = &parts[0].name;
            format!("{count} of {} parts keep the {subject} below {bound}; first of them {first}{price}.", parts.len())
        }
    }
}

fn lede(limit: &Limit, found: &Found) -> String {
    let answer = found.answer.as_ref().map(|answer| sentence(limit, answer));
    let parts = found.parts.as_ref().map(|(parts, _)| parts_sentence(limit, parts));
    answer.into_iter().chain(parts).collect::<Vec<String>>().join(" ")
}

fn parts_table(limit: &Limit, parts: &[Judged]) -> Table {
    let statistic = format!("{} / {}", limit.statistic.name(), unit(limit));
    let mut table = Table::new(&["part", "price", &statistic, "meets it"]);
    for part in parts {
        let [low, high] = part.statistic.ci95;
        let verdict = match (part.meets, part.sure) {
            (true, true) => "yes",
            (false, true) => "no",
            (true, false) => "yes, within the interval of the limit",
            (false, false) => "no, within the interval of the limit",
        };
        table.row([
            part.name.clone(),
            part.price.map_or("–".into(), |price| price.to_string()),
            with_uncertainty(part.statistic.value, 0.25 * (high - low)),
            verdict.to_owned(),
        ]);
    }
    table
}

/// Says of each part which errors of the study it leaves at zero.
fn unstated(parts: &[Judged]) -> Vec<String> {
    let of_part = |part: &Judged| {
        let names = part.unstated.join(", ");
        format!("{} states no {names}: what the study has of it is not simulated with this part.", part.name)
    };
    parts.iter().filter(|part| !part.unstated.is_empty()).map(of_part).collect()
}

fn members(found: &Found) -> u64 {
    found.answer.as_ref().map_or(0, |a| a.members) + found.parts.as_ref().map_or(0, |(_, members)| *members)
}

/// The answer for a terminal.
pub fn terminal(limit: &Limit, found: &Found) -> String {
    let table = found.parts.as_ref().map_or(String::new(), |(parts, _)| {
        let unstated: String = unstated(parts).iter().map(|sentence| format!("{sentence}\n")).collect();
        format!("{}{unstated}\n", parts_table(limit, parts))
    });
    format!("{}\n\n{table}members:    {} simulated in total\n", lede(limit, found), members(found))
}

/// The statistic over the value, with the limit and the crossing.
pub fn figure(limit: &Limit, found: &Found) -> Option<Figure> {
    let answer = found.answer.as_ref()?;
    let one = answer.vary.first()?;
    // Values were tried as factors; the axis is the first key's own.
    let scale = one.value.zip(answer.at).map_or(1.0, |(value, factor)| value / factor);
    let points: Vec<(f64, f64)> = answer.tried.iter().map(|(factor, y)| (factor * scale, *y)).collect();
    let (positive, log) = (points.iter().all(|p| p.0 > 0.0), points.iter().all(|p| p.1 > 0.0) && limit.below > 0.0);
    let x = if answer.vary.len() > 1 { format!("{}, the others in proportion", one.key) } else { one.key.clone() };
    let label = labelled(&format!("{} at {} s", limit.statistic.name(), limit.time_s), unit(limit));
    let mut chart = Chart::new(
        "Over the value",
        if positive { Axis::log(&x) } else { Axis::linear(&x) },
        if log { Axis::log(&label) } else { Axis::linear(&label) },
    );
    let ends: Vec<(f64, f64)> = points.first().into_iter().chain(points.last()).map(|p| (p.0, limit.below)).collect();
    chart.add("limit", Ink::Red, Mark::Dashed, ends);
    chart.add("simulated", Ink::Blue, Mark::Line, points.clone());
    chart.add("", Ink::Blue, Mark::Dots(3), points);
    if let (Some(value), Outcome::Crosses { .. }) = (one.value, answer.outcome) {
        chart.add("crossing", Ink::Black, Mark::Dots(5), vec![(value, limit.below)]);
    }
    Some(chart.draw())
}

/// The report page of `require`.
pub fn page(study: &Study, limit: &Limit, found: &Found) -> Page {
    let mut page = Page::new(&format!("{}: what it takes", study.name), &lede(limit, found));
    page.paragraph(&format!("Requirement: {limit}."));
    if let (Some(answer), Some(figure)) = (&found.answer, figure(limit, found)) {
        page.section("The value");
        page.figure(&figure, "Every value tried, all with the same members and random numbers.");
        let mut table = Table::new(&["key", "value", "95 % from", "to"]);
        for v in &answer.vary {
            let number = |n: Option<f64>| n.map_or("–".into(), |n| significant(n, 4));
            table.row([v.key.clone(), number(v.value), number(v.ci95[0]), number(v.ci95[1])]);
        }
        page.table(&table);
    }
    if let Some((parts, _)) = &found.parts {
        page.section("The parts");
        page.table(&parts_table(limit, parts));
        page.paragraph(
            "Parts that meet the limit by price, the others by how far they miss it; ± is one standard error.",
        );
        page.list(&unstated(parts));
    }
    page.section("How this was made");
    page.paragraph(&format!(
        "{} member simulations in total, seed {}, proofmass {}. Intervals of percentiles are from ranks, \
        distribution-free.",
        members(found),
        study.seed,
        env!("CARGO_PKG_VERSION")
    ));
    page
}
