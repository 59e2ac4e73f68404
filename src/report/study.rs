//! The page and the terminal text of a study: the answer in a sentence, envelopes, distributions,
//! who is to blame.

mod compared;
mod contribution;
mod distribution;
mod envelope;
pub mod further;
pub mod jcgm101;
pub(crate) mod moment;
mod risk;
pub(super) mod sensor;
mod variance;
mod windows;

use super::html::Page;
use super::table::Table;
use proofmass_base::number::{duration, significant, with_uncertainty, worth};
use proofmass_numerics::statistics::{Origin, Statistics, Summary, quantity};
use proofmass_scenario::navigation::power_law::EXPONENTS;
use proofmass_simulate::decision::further::Further;
use proofmass_simulate::drift::Drift;
use proofmass_simulate::drift::budget::Contribution;
use proofmass_simulate::drift::scope::SMALL_TILT_RAD;
use proofmass_study::Study;
use proofmass_study::alignment::Alignment;

pub use envelope::log_log as envelope_figure;
use moment::{moment, plain};
pub use windows::picture as windows_figure;

/// Share of the position variance from which on a source stands on the first screen.
const LEAST_SHARE: f64 = 0.02;
/// States what is simulated, and what is not.
const SCOPE: &str = "Scope: one axis, small tilt, flat non-rotating Earth, until the study is given a trajectory.";

/// Says from when on the tilt is too large for a study along one axis.
pub fn beyond_scope(drift: &Drift) -> Option<String> {
    let from_s = drift.small_tilt_ends_s()?;
    Some(format!(
        "From {} on the numbers are too large: one sensor in twenty or more is tilted to one side by more than {} degrees, where the \
         small-angle model of one axis errs by more than 1 %. Give the study a still start ([alignment] kind = \
         \"still\"), which removes a constant gyro bias, or six axes ([trajectory] kind = \"rest\").",
        moment(from_s),
        significant(SMALL_TILT_RAD.to_degrees(), 3)
    ))
}

/// The report page of `study`, with what else was asked.
pub fn page(study: &Study, drift: &Drift, further: &Further) -> Page {
    let mut page = Page::new(&format!("{}: how far it drifts", study.name), &lede(study, drift));
    if let Some(sentence) = beyond_scope(drift) {
        page.callout(&sentence);
    }
    let sources = largest_sources(drift);
    if !sources.rows.is_empty() {
        page.table(&sources);
    }
    page.paragraph(&format!("{} {SCOPE}", start(study)));
    page.section("How far it drifts");
    let (linear, log) =
        (envelope::linear(drift).draw().named("percentiles"), envelope::log_log(drift).draw().named("envelope"));
    page.figure_row(&[
        (&linear, "Position error over time. Half of all sensors lie on each side of the line; the bands hold the middle 90 and 98 of 100. Dashed: where the closed form puts the edges of the inner band."),
        (&log, "The standard deviation on logarithmic axes, over the closed form of all sources together. Thin dashes: pure t² and t³, the paper's guides."),
    ]);
    page.table(&drift_table(drift));
    if !drift.expected.left_out.is_empty() {
        page.paragraph(&format!("Not in the closed form: {}.", drift.expected.left_out.join("; ")));
    }
    further::drift(&mut page, further);
    page.section("How the errors are distributed");
    for (charts, words) in distribution::rows(drift) {
        page.paragraph(words);
        let drawn: Vec<_> = charts.iter().map(|c| c.draw()).collect();
        page.figure_row(&drawn.iter().map(|f| (f, "")).collect::<Vec<_>>());
    }
    page.section("Which error is to blame");
    page.paragraph(&blame(drift));
    let (contributions, alone) =
        (contribution::stacked(drift).draw().named("budget"), contribution::alone(drift).draw().named("budget-alone"));
    page.figure_row(&[
        (
            &contributions,
            "Fraction of the position variance due to each source. Which source is worth improving depends on \
                   how long one navigates without aiding.",
        ),
        (&alone, "Standard deviation of the position error from each source alone."),
    ]);
    page.paragraph(
        "Fraction of the position variance at the report times, and the standard deviation from each \
                    source alone at the last one:",
    );
    page.table(&budget_table(drift));
    further::blame(&mut page, further);
    page.section("How the envelope grows");
    page.paragraph(
        "Position variance fitted as a sum of squares of four powers of time, next to the closed forms of the \
         sources. Neighbouring powers resemble each other and bias instability is not a single power, so the fit \
         describes the envelope; the error budget above attributes it.",
    );
    page.table(&growth_table(study, drift));
    windows::section(&mut page, study, &drift.compared);
    compared::section(&mut page, &drift.compared);
    sensor::section(&mut page, study);
    page.paragraph(&format!("Excitation: {}.", study.excitation.words));
    note(&mut page, study);
    page.section("How this was made");
    page.table(&provenance(study, drift));
    page
}

/// Says on the page what has no effect.
pub(super) fn note(page: &mut Page, study: &Study) {
    if let Some(words) = without_effect(study) {
        page.paragraph(&format!("Note: {words}."));
    }
}

/// Returns what a study gives that changes nothing; `None` where all of it does.
pub fn without_effect(study: &Study) -> Option<&'static str> {
    study.temperature_is_idle().then_some("[temperature] has no effect: no temperature coefficient is set")
}

/// The answer in two sentences.
pub(crate) fn lede(study: &Study, drift: &Drift) -> String {
    let (Some(last), Some(time_s)) =
        (drift.at_report(quantity::POSITION).last().copied(), drift.report_times_s().pop())
    else {
        return String::new();
    };
    let after = format!("After {} without aiding, the position that a sensor like this one gives is", moment(time_s));
    let (mean, sd, contributions) = (last.mean, last.sd, &drift.budget.contributions);
    let (of_mean, of_sd) = doubts(sd, last.count);
    let count = match drift.statistics.failed {
        0 => study.members.to_string(),
        lost => format!("{} (of {}: {lost} diverged)", study.members - lost, study.members),
    };
    if sd == 0.0 && mean != 0.0 {
        return format!("{after} wrong by {} m, the same for all {count} simulated ones.", significant(mean, 3));
    }
    // Where all members share the error, its mean and not its spread is the answer.
    if mean.abs() > sd {
        let alone = |contribution: &Contribution| contribution.mean_m.last().map_or(0.0, |m| m.abs());
        let largest_source = contributions.iter().max_by(|a, b| alone(a).total_cmp(&alone(b)));
        let largest_source =
            largest_source.map_or(String::new(), |s| format!(" Most of it is due to the {}.", s.source.name()));
        return format!(
            "{after} wrong by {} m on average ({} m standard deviation over {} simulated ones).{largest_source}",
            worth(mean, of_mean),
            worth(sd, of_sd),
            count
        );
    }
    if sd == 0.0 {
        return format!("{after} exact: the study contains no error.");
    }
    let k = drift.budget.time_s.len().saturating_sub(1);
    let largest_source = contributions.first().map_or(String::new(), |contribution| {
        let percent = significant(100.0 * drift.budget.fraction(contribution, k), 2);
        format!(" The {} accounts for {percent} % of that variance.", contribution.source.name())
    });
    format!(
        "{after} wrong by {} m (standard deviation over {} simulated ones); nine in ten lie between {} m and {} m.{largest_source}",
        worth(sd, of_sd),
        count,
        worth(last.percentiles[1], PERCENTILE_DOUBT[1] * of_mean),
        worth(last.percentiles[3], PERCENTILE_DOUBT[3] * of_mean),
    )
}

/// Standard errors of the 1, 5, 50, 95 and 99 % percentiles of a normal sample over that of its
/// mean: √(p(1 − p))/φ(z).
const PERCENTILE_DOUBT: [f64; 5] = [3.73, 2.11, 1.25, 2.11, 3.73];

/// Standard errors of a mean and of a standard deviation.
fn doubts(sd: f64, count: u64) -> (f64, f64) {
    let n = count.max(2) as f64;
    (sd / n.sqrt(), sd / (2.0 * n).sqrt())
}

fn mean_and_doubt(mean: f64, doubt: f64) -> String {
    if doubt > 0.0 { with_uncertainty(mean, doubt) } else { significant(mean, 3) }
}

/// Sizes and percentiles of the position error, with the closed form. Every number to the digit
/// that this many members settle.
fn drift_table(drift: &Drift) -> Table {
    let mut table = Table::new(&[
        "time / s",
        "sd / m",
        "closed form / m",
        "ratio",
        "mean ± σ / m",
        "1 % / m",
        "5 % / m",
        "50 % / m",
        "95 % / m",
        "99 % / m",
    ]);
    let expected = drift.expected.total(quantity::POSITION);
    for k in &drift.report {
        let at: &Summary = &drift.statistics.at[*k][quantity::POSITION];
        let theory_m = expected[*k].variance.sqrt();
        let (of_mean, of_sd) = doubts(at.sd, at.count);
        let mut row = vec![plain(drift.statistics.time_s[*k]), worth(at.sd, of_sd), worth(theory_m, of_sd)];
        row.push(if theory_m > 0.0 { worth(at.sd / theory_m, of_sd / theory_m) } else { "–".into() });
        row.push(mean_and_doubt(at.mean, of_mean));
        row.extend(at.percentiles.iter().zip(PERCENTILE_DOUBT).map(|(p, doubt)| worth(*p, doubt * of_mean)));
        table.row(row);
    }
    table
}

/// Standard deviation of position that each source makes, and its fraction of the variance, at the
/// report times.
pub(crate) fn budget_table(drift: &Drift) -> Table {
    let times: Vec<String> = drift.report_times_s().iter().map(|t| format!("{} s", plain(*t))).collect();
    let mut headings = vec!["source".to_owned()];
    headings.extend(times.clone());
    headings.extend(times.last().iter().flat_map(|t| [format!("sd at {t} / m"), format!("mean ± σ at {t} / m")]));
    let mut table = Table { headings, rows: Vec::new() };
    for contribution in &drift.budget.contributions {
        let mut row = vec![contribution.source.name().to_owned()];
        row.extend(drift.report.iter().map(|k| percent(drift.budget.fraction(contribution, *k))));
        if let Some(k) = drift.report.last() {
            let sd = contribution.variance_m2[*k].sqrt();
            let (of_mean, of_sd) = doubts(sd, drift.budget.members);
            row.extend([worth(sd, of_sd), mean_and_doubt(contribution.mean_m[*k], of_mean)]);
        }
        table.row(row);
    }
    table
}

/// The largest sources of the position variance at the last report time, for the first screen.
fn largest_sources(drift: &Drift) -> Table {
    let times = drift.report_times_s();
    let mut headings = vec!["share of the position variance".to_owned()];
    headings.extend(times.iter().map(|t| format!("after {}", moment(*t))));
    let mut table = Table { headings, rows: Vec::new() };
    let Some(last) = drift.report.last() else { return table };
    let share = |contribution: &Contribution, k: usize| drift.budget.fraction(contribution, k);
    let mut largest: Vec<&Contribution> = drift.budget.contributions.iter().collect();
    largest.retain(|c| drift.report.iter().any(|k| share(c, *k) >= LEAST_SHARE));
    largest.sort_by(|a, b| share(b, *last).total_cmp(&share(a, *last)));
    for contribution in largest {
        let name = std::iter::once(contribution.source.name().to_owned());
        table.row(name.chain(drift.report.iter().map(|k| percent(share(contribution, *k)))));
    }
    table
}

/// A fraction as a percentage; what is there and too small for a digit is said to be.
pub(crate) fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 0.1 => format!("{p:.1} %"),
        p if p > 0.0 => "< 0.1 %".into(),
        _ => "0".into(),
    }
}

fn growth_table(study: &Study, drift: &Drift) -> Table {
    let [accelerometer, gyro] = match study.alignment {
        Alignment::Ideal => ["accelerometer bias", "gyro bias"],
        Alignment::Still { .. } => ["accelerometer bias left by the still start", "gyro bias left by the still start"],
    };
    let owners = ["velocity random walk", accelerometer, "angle and acceleration random walk", gyro];
    let mut table = Table::new(&["power of t", "belongs to", "fitted / (m/sᵖ)", "closed form / (m/sᵖ)"]);
    for (k, owner) in owners.iter().enumerate() {
        table.row([
            format!("{}", EXPONENTS[k]),
            (*owner).to_owned(),
            significant(drift.growth.fitted[k], 3),
            significant(drift.growth.expected[k], 3),
        ]);
    }
    table
}

/// Which source rules when.
fn blame(drift: &Drift) -> String {
    let ruler = |k: usize| {
        let contributions = &drift.budget.contributions;
        contributions
            .iter()
            .max_by(|a, b| a.variance_m2[k].total_cmp(&b.variance_m2[k]))
            .map_or("nothing", |s| s.source.name())
    };
    let mut phrases: Vec<String> = Vec::new();
    let mut before = "";
    for (k, time_s) in drift.budget.time_s.iter().enumerate() {
        if ruler(k) != before {
            before = ruler(k);
            phrases.push(match phrases.is_empty() {
                true => format!("to {before}"),
                false => format!("from {} on to {before}", duration(*time_s)),
            });
        }
    }
    format!(
        "The largest fraction of the position variance is due {}. Computed with {} members and common random \
         numbers, each source alone; rounding and saturation, which have no meaning alone, by switching them off.",
        phrases.join(", "),
        drift.budget.members
    )
}

/// Says how the run begins, in a sentence.
fn start(study: &Study) -> String {
    match study.alignment {
        Alignment::Ideal => "Ideal start: level, with the biases as given.".into(),
        Alignment::Still { .. } => format!(
            "Still start of {} s: the mean gyro error is taken as its bias and subtracted; the mean accelerometer \
             error is taken as tilt, so that the initial tilt is wrong by −mean/g. Times count from its end.",
            plain(study.still_s())
        ),
    }
}

/// Lists what it ran on, for whoever wants to repeat it.
pub(crate) fn provenance(study: &Study, drift: &Drift) -> Table {
    let (statistics, machine) = (&drift.statistics, &drift.statistics.machine);
    let mut table = Table::new(&["what", "value"]);
    let rate = statistics.member_steps as f64 / statistics.seconds.max(1e-9);
    for (what, value) in [
        ("version", format!("proofmass {}", env!("CARGO_PKG_VERSION"))),
        ("seed", study.seed.to_string()),
        ("members", format!("{} ({} failed and left out)", statistics.members, statistics.failed)),
        ("run", format!("{} s in steps of {} s", study.duration_s(), study.clock.step_s)),
        ("backend", format!("{}: {}", machine.kind, machine.name)),
        ("driver", machine.driver.clone()),
        ("members by backend", origins(statistics)),
        ("precision", machine.precision.clone()),
        ("fused multiply-add", machine.fused_multiply_add.clone()),
        ("integrator", format!("{} ({})", machine.integrator, drift.choice.because)),
        (
            "time",
            format!(
                "{} for {} million member-steps",
                duration(statistics.seconds),
                significant(statistics.member_steps as f64 / 1e6, 3)
            ),
        ),
        ("speed", format!("{} million member-steps/s", significant(rate / 1e6, 3))),
    ] {
        if !value.is_empty() {
            table.row([what.to_owned(), value]);
        }
    }
    table
}

/// Which members were integrated where, and why, when it was not all of them in one place as asked;
/// else nothing.
fn origins(statistics: &Statistics) -> String {
    let sentence = |origin: &Origin| {
        let Origin { members, machine, reason } = origin;
        let because = reason.as_ref().map_or(String::new(), |reason| format!(" ({reason})"));
        format!("{} to {}: {}, {}{because}", members.start, members.end - 1, machine.kind, machine.name)
    };
    match &statistics.origins[..] {
        [only] if only.reason.is_none() => String::new(),
        origins => origins.iter().map(sentence).collect::<Vec<String>>().join("; "),
    }
}

/// Writes the answer for a terminal.
pub fn terminal(study: &Study, drift: &Drift) -> String {
    let beyond = beyond_scope(drift).map_or(String::new(), |sentence| format!("\n\n{sentence}"));
    let machine = &drift.statistics.machine;
    let sentences = windows::sentences(&drift.compared).into_iter().chain(compared::sentences(&drift.compared));
    let compared: String = sentences.map(|s| format!("{s}\n")).collect();
    let compared = if compared.is_empty() { compared } else { format!("next to the recording\n{compared}\n") };
    let origins = origins(&drift.statistics);
    let origins = if origins.is_empty() { origins } else { format!("members:    {origins}\n") };
    format!(
        "{}{beyond}\n\nposition error\n{}\nerror budget: fraction of the position variance\n{}\n{compared}integrator: {} \
        ({})\nbackend:    {} ({}, {}), {} for {} million member-steps\n{origins}",
        lede(study, drift),
        drift_table(drift),
        budget_table(drift),
        machine.integrator,
        drift.choice.because,
        machine.name,
        machine.kind,
        machine.precision,
        duration(drift.statistics.seconds),
        significant(drift.statistics.member_steps as f64 / 1e6, 3),
    )
}
