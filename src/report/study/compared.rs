//! Simulation next to a recording: Allan deviation axis by axis, and where the two leave each
//! other.

use crate::figure::{Axis, Chart, Ink, Mark, labelled};
use crate::html::Page;
use proofmass_base::escape::file_name;
use proofmass_base::number::{duration, significant};
use proofmass_base::units::{DEGREE_PER_HOUR, MICRO_G};
use proofmass_scenario::sensor::Sense;
use proofmass_simulate::drift::compare::{Departure, Likeness, Outcome};

/// The section, if the study asks for it.
pub(crate) fn section(page: &mut Page, outcome: &Outcome) {
    let (axes, findings) = match outcome {
        Outcome::NotAsked => return,
        Outcome::Absent(file) => {
            page.section("Beside the recording");
            page.callout(&format!("The log {file} is not on this machine, so nothing is compared here."));
            return;
        }
        Outcome::Compared(comparison) => (&comparison.axes, &comparison.findings),
    };
    page.section("Beside the recording");
    page.paragraph(
        "Allan deviation of the recorded log over that of simulated sensors of this study lying still for as long: the \
         band holds the middle 90 of 100 simulated sensors at each averaging time, so that one time in ten lies outside by \
         chance, and its neighbours with it. Where the coefficients were estimated from the same log, agreement shows that \
         simulation and estimation are consistent; a departure by more than the band is wide is noise, or physics, that the \
         study leaves out.",
    );
    page.list(&axes.iter().map(sentence).collect::<Vec<_>>());
    let figures: Vec<_> = axes
        .iter()
        .map(|a| (chart(a).draw().named(&format!("allan-{}", file_name(&a.column, 80))), caption(a)))
        .collect();
    page.figure_row(&figures.iter().map(|(f, c)| (f, c.as_str())).collect::<Vec<_>>());
    if !findings.is_empty() {
        page.subsection("Found while reading the log");
        page.list(findings);
    }
}

/// Reports the comparison, one sentence per axis; empty where nothing was compared.
pub(crate) fn sentences(outcome: &Outcome) -> Vec<String> {
    match outcome {
        Outcome::Compared(comparison) => comparison.axes.iter().map(sentence).collect(),
        Outcome::Absent(file) => vec![format!("the log {file} is not on this machine: nothing compared")],
        Outcome::NotAsked => Vec::new(),
    }
}

fn sentence(axis: &Likeness) -> String {
    let departures = axis.departures();
    if departures.is_empty() {
        let to_s = axis.tau_s.last().copied().unwrap_or_default();
        return format!(
            "{}: the log lies within the simulated band at all averaging times: the model is good for integrations of up \
             to {}.",
            axis.column,
            duration(to_s)
        );
    }
    let inside = (0..axis.tau_s.len())
        .filter(|k| (axis.simulated[0][*k]..=axis.simulated[2][*k]).contains(&axis.recorded[*k]))
        .count();
    let phrase = |d: &Departure| {
        let side = if d.ratio > 1.0 { "above" } else { "below" };
        let percent = 100.0 * (d.ratio - 1.0).abs();
        format!(
            "{side} the band from {} to {} (at most {} % off the median)",
            duration(d.from_s),
            duration(d.to_s),
            significant(percent, 2)
        )
    };
    format!(
        "{}: {}. It lies within the band at {inside} of {} averaging times; {}.",
        axis.column,
        judgement(axis),
        axis.tau_s.len(),
        departures.iter().map(phrase).collect::<Vec<_>>().join("; ")
    )
}

/// Says for how long an integration the model is good.
fn judgement(axis: &Likeness) -> String {
    let trusted: Vec<String> =
        axis.trusted().iter().map(|[from, to]| format!("{} to {}", duration(*from), duration(*to))).collect();
    let worst = axis.departures().into_iter().map(|d| d.ratio).max_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
    let beyond = worst.map_or(String::new(), |ratio| {
        format!("; elsewhere its noise is up to {} times the simulated", significant(ratio, 2))
    });
    match trusted.is_empty() {
        true => {
            format!("the model is not good for an integration of any length{}", beyond.replacen("elsewhere ", "", 1))
        }
        false => format!("the model is good for integrations of {}{beyond}", trusted.join(" and of ")),
    }
}

fn caption(axis: &Likeness) -> String {
    format!("{}: {} at rest, recorded and simulated.", axis.column, axis.sense.name())
}

fn chart(axis: &Likeness) -> Chart {
    let (unit, factor) = match axis.sense {
        Sense::Accelerometer => ("µg", MICRO_G),
        Sense::Gyro => ("°/h", DEGREE_PER_HOUR),
    };
    let points =
        |values: &[f64]| -> Vec<(f64, f64)> { axis.tau_s.iter().zip(values).map(|(t, v)| (*t, v / factor)).collect() };
    let top = points(&axis.simulated[2]).iter().map(|p| p.1).collect();
    let mut chart =
        Chart::new(&axis.column, Axis::log("averaging time / s"), Axis::log(&labelled("Allan deviation", unit)))
            .with("simulated, 5–95 %", Ink::Blue, Mark::Band(top), points(&axis.simulated[0]))
            .with("median", Ink::Blue, Mark::Line, points(&axis.simulated[1]))
            .with("recorded", Ink::Red, Mark::Dots(3), points(&axis.recorded));
    chart.size = (480, 360);
    chart
}
