//! The page and the terminal text of a sweep: the curve or the map, and where the limit is just
//! met.

use super::figure::{Axis, Chart, Figure, Ink, Mark, Raster, labelled};
use super::html::Page;
use super::require::{subject_of, unit_of};
use super::table::Table;
use proofmass_base::number::{significant, with_uncertainty, worth};
use proofmass_numerics::statistics::{Summary, quantity};
use proofmass_simulate::decision::sweep::{Crossing, Plan, Point, Sweep};
use proofmass_simulate::decision::watched::Watched;
use proofmass_study::{self as study, Study};

const CURVE: &str = "curve.svg";
const TIMES: &str = "times.svg";
const MAP: &str = "map.svg";

/// Names of the figures' files.
pub fn file_names(plan: &Plan) -> Vec<&'static str> {
    if plan.axes.len() > 1 { vec![MAP] } else { vec![CURVE, TIMES] }
}

/// The figures with their captions, in the order of their names.
pub fn figures(sweep: &Sweep) -> Vec<(Figure, String)> {
    match &sweep.plan.axes[..] {
        [_] => vec![curve(sweep), over_times(sweep)],
        [x, y, ..] => vec![map(sweep, x, y)],
        [] => Vec::new(),
    }
}

/// Names what is followed, with its unit.
fn label(sweep: &Sweep) -> String {
    let followed = &sweep.followed;
    labelled(&format!("{} at {} s", followed.statistic.name(), followed.time_s), unit_of(followed.quantity))
}

fn spaced(axis: &study::Axis) -> Axis {
    if axis.log { Axis::log(&axis.key) } else { Axis::linear(&axis.key) }
}

/// A vertical axis: logarithmic where every value has a logarithm and they differ by more than a
/// factor of five.
fn vertical(label: &str, values: &[f64]) -> Axis {
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(*v), h.max(*v)));
    if low > 0.0 && high > 5.0 * low { Axis::log(label) } else { Axis::linear(label) }
}

fn curve(sweep: &Sweep) -> (Figure, String) {
    let axis = &sweep.plan.axes[0];
    let points =
        |pick: fn(&Point) -> f64| -> Vec<(f64, f64)> { sweep.points.iter().map(|p| (p.values[0], pick(p))).collect() };
    let mut heights: Vec<f64> = sweep.points.iter().map(|p| p.statistic.value).collect();
    heights.extend(sweep.plan.limit.iter().map(|limit| limit.below));
    let mut chart = Chart::new("Over the value", spaced(axis), vertical(&label(sweep), &heights));
    if let Some(limit) = &sweep.plan.limit {
        chart.add("limit", Ink::Red, Mark::Dashed, vec![(axis.from, limit.below), (axis.to, limit.below)]);
    }
    let upper = sweep.points.iter().map(|p| p.statistic.ci95[1]).collect();
    chart.add("95 % interval", Ink::Blue, Mark::Band(upper), points(|p| p.statistic.ci95[0]));
    chart.add("simulated", Ink::Blue, Mark::Line, points(|p| p.statistic.value));
    chart.add("", Ink::Blue, Mark::Dots(3), points(|p| p.statistic.value));
    if let Some(limit) = &sweep.plan.limit {
        let marks = sweep.crossings.iter().map(|c| (c.crossed.value, limit.below)).collect();
        chart.add("crossing", Ink::Black, Mark::Dots(5), marks);
    }
    let followed = &sweep.followed;
    let words = format!(
        "The {} over {}, with its 95 % interval. All points share the same {} members and random numbers.",
        subject_of(followed.statistic, followed.quantity, followed.time_s),
        axis.key,
        sweep.members
    );
    (chart.draw(), words)
}

/// Draws how far the study drifts over the value, a line per report time: the standard deviation of
/// position, along a trajectory the circle that holds half of the members.
fn over_times(sweep: &Sweep) -> (Figure, String) {
    let axis = &sweep.plan.axes[0];
    let radius = sweep.quantities.iter().position(|q| *q == Watched::HORIZONTAL);
    let drift = |at: &[Summary]| match radius {
        Some(place) => at.get(place).map(|s| s.percentiles[2]),
        None => at.get(quantity::POSITION).map(|s| s.sd),
    };
    let of = |k: usize| -> Vec<(f64, f64)> {
        sweep.points.iter().filter_map(|p| Some((p.values[0], drift(p.at.get(k)?)?))).collect()
    };
    let (label, words) = match radius {
        Some(_) => (
            "horizontal error, CEP50 / m",
            "Radius of the circle about the truth that holds half of the members, at each report time.",
        ),
        None => ("position error, sd / m", "Standard deviation of the position error at each report time."),
    };
    let heights: Vec<f64> = (0..sweep.time_s.len()).flat_map(of).map(|p| p.1).collect();
    let mut chart = Chart::new("At every report time", spaced(axis), vertical(label, &heights));
    for (k, time_s) in sweep.time_s.iter().enumerate() {
        chart.add(&format!("{time_s} s"), Ink::nth(k), Mark::Line, of(k));
    }
    (chart.draw(), words.into())
}

/// The ends of the cells of a map, half a step beyond the values.
fn edges(axis: &study::Axis) -> (f64, f64) {
    let half = 0.5 / (axis.points - 1) as f64;
    match axis.log {
        true => (axis.from * (axis.from / axis.to).powf(half), axis.to * (axis.to / axis.from).powf(half)),
        false => (axis.from - half * (axis.to - axis.from), axis.to + half * (axis.to - axis.from)),
    }
}

fn map(sweep: &Sweep, x: &study::Axis, y: &study::Axis) -> (Figure, String) {
    let values: Vec<f64> = sweep.points.iter().map(|p| p.statistic.value).collect();
    let finite = values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let by_log = low > 0.0 && high > 5.0 * low;
    let shown = |v: f64| if by_log { v.log10() } else { v };
    let heights: Vec<f64> = values.iter().map(|v| shown(*v)).collect();
    let bar = if by_log { format!("log₁₀ of {}", label(sweep)) } else { label(sweep) };
    let ((x0, x1), (y0, y1)) = (edges(x), edges(y));
    let mut chart = Chart::new("Over both values", spaced(x).within(x0, x1), spaced(y).within(y0, y1));
    let limits = if high > low { (shown(low), shown(high)) } else { (shown(low) - 1.0, shown(low) + 1.0) };
    chart.raster = Some(Raster::heat_map(&heights, x.points, (x0, x1), (y0, y1), limits, &bar));
    let line: Vec<(f64, f64)> = sweep.crossings.iter().filter_map(|c| Some((c.crossed.value, c.other?))).collect();
    if let (Some(limit), false) = (&sweep.plan.limit, line.is_empty()) {
        chart.add(&limit.to_string(), Ink::Red, Mark::Line, line.clone());
        chart.add("", Ink::Red, Mark::Dots(3), line);
    }
    let followed = &sweep.followed;
    let subject = subject_of(followed.statistic, followed.quantity, followed.time_s);
    let line = if sweep.crossings.is_empty() { "" } else { "; on the line, the limit is just met" };
    let members = sweep.members;
    let words = format!("The {subject}. All cells share the same {members} members and random numbers{line}.");
    (chart.draw(), words)
}

/// "4.02, 95 % interval 3.98 to 4.06".
fn crossing(of: &Crossing) -> String {
    match of.crossed.ci95 {
        [Some(low), Some(high)] => {
            let digits = |v: f64| worth(v, 0.1 * (high - low));
            format!("{}, 95 % interval {} to {}", digits(of.crossed.value), digits(low), digits(high))
        }
        _ => significant(of.crossed.value, 3),
    }
}

fn lede(sweep: &Sweep) -> String {
    let followed = &sweep.followed;
    let subject = subject_of(followed.statistic, followed.quantity, followed.time_s);
    let unit = unit_of(followed.quantity);
    let key = sweep.plan.axes.first().map_or("", |axis| axis.key.as_str());
    let number = |point: &Point| {
        let [low, high] = point.statistic.ci95;
        worth(point.statistic.value, 0.25 * (high - low))
    };
    let range = match (sweep.points.first(), sweep.points.last()) {
        (Some(first), Some(last)) => format!("goes from {} {unit} to {} {unit}", number(first), number(last)),
        _ => String::new(),
    };
    let along = sweep.plan.axes.iter().map(|a| format!("{} from {} to {}", a.key, a.from, a.to));
    let along = along.collect::<Vec<String>>().join(" and ");
    let open = format!("Over {along}, the {subject} {range}.");
    let Some(limit) = &sweep.plan.limit else { return open };
    match &sweep.crossings[..] {
        [] if sweep.points.iter().all(|p| p.statistic.value < limit.below) => {
            format!("{open} It stays below {} {unit} throughout.", limit.below)
        }
        [] => format!("{open} It never falls below {} {unit}.", limit.below),
        [one] if one.other.is_none() => {
            let side = if one.crossed.below { "up to" } else { "from" };
            format!("{open} It stays below {} {unit} {side} {key} = {}.", limit.below, crossing(one))
        }
        several => format!("{open} It crosses {} {unit} at {} values of {key}.", limit.below, several.len()),
    }
}

fn table(sweep: &Sweep) -> Table {
    let mut headings: Vec<String> = sweep.plan.axes.iter().map(|axis| axis.key.clone()).collect();
    headings.push(format!("{} ± σ", label(sweep)));
    let mut table = Table { headings, rows: Vec::new() };
    for point in &sweep.points {
        let [low, high] = point.statistic.ci95;
        let values = point.values.iter().map(|v| significant(*v, 4));
        table.row(values.chain([with_uncertainty(point.statistic.value, 0.25 * (high - low))]));
    }
    table
}

fn crossings(sweep: &Sweep) -> Table {
    let mut headings: Vec<String> = sweep.plan.axes.iter().skip(1).map(|axis| axis.key.clone()).collect();
    headings.extend(sweep.plan.axes.first().map(|axis| format!("{} at the limit", axis.key)));
    headings.extend(["95 % from".to_owned(), "to".to_owned(), "met".to_owned()]);
    let mut table = Table { headings, rows: Vec::new() };
    let number = |n: Option<f64>| n.map_or("–".into(), |n| significant(n, 4));
    for c in &sweep.crossings {
        let other = c.other.map(|v| significant(v, 4));
        let side = if c.crossed.below { "below" } else { "above" };
        let ends = c.crossed.ci95.map(number);
        table.row(other.into_iter().chain([number(Some(c.crossed.value))]).chain(ends).chain([side.to_owned()]));
    }
    table
}

/// Every point as a row of numbers.
pub fn csv(sweep: &Sweep) -> String {
    let keys: String = sweep.plan.axes.iter().map(|axis| format!("{},", axis.key)).collect();
    let mut text = format!("{keys}{},ci95_low,ci95_high\n", sweep.followed.statistic.name());
    for point in &sweep.points {
        let values: String = point.values.iter().map(|v| format!("{v},")).collect();
        let [low, high] = point.statistic.ci95;
        text += &format!("{values}{},{low},{high}\n", point.statistic.value);
    }
    text
}

/// The answer for a terminal.
pub fn terminal(sweep: &Sweep) -> String {
    let met = if sweep.crossings.is_empty() { String::new() } else { format!("\n{}", crossings(sweep)) };
    format!("{}\n\n{}{met}", lede(sweep), table(sweep))
}

/// The report page of a sweep.
pub fn page(study: &Study, sweep: &Sweep) -> Page {
    let mut page = Page::new(&format!("{}: what it depends on", study.name), &lede(sweep));
    let figures = figures(sweep);
    page.figure_row(&figures.iter().map(|(figure, words)| (figure, words.as_str())).collect::<Vec<_>>());
    if !sweep.crossings.is_empty() {
        page.section("Where the limit is just met");
        page.table(&crossings(sweep));
        page.paragraph(
            "Between the two neighbouring values the crossing is found as `require` finds it, with more members than the \
             points have; its interval is where the statistic, 1.96 standard errors higher or lower, crosses the limit.",
        );
    }
    page.section("The numbers");
    page.table(&table(sweep));
    page.section("How this was made");
    page.paragraph(&format!(
        "{} members at each of {} points, seed {}, proofmass {}. ± is one standard error.",
        sweep.members,
        sweep.points.len(),
        study.seed,
        env!("CARGO_PKG_VERSION")
    ));
    page
}
