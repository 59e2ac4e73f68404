//! Predicted, and what the sensor then did: windows of a recorded log as quantiles next to the
//! simulated band, and how many of them lie inside it.

use std::path::Path;

use crate::figure::{Axis, Chart, Figure, Ink, Mark, labelled};
use crate::html::Page;
use crate::table::Table;
use proofmass_base::escape::file_name;
use proofmass_base::number::{rounded, significant};
use proofmass_base::units::DEGREE;
use proofmass_numerics::numerics::special::exact_interval;
use proofmass_scenario::sensor::Sense;
use proofmass_simulate::drift::compare::{Comparison, Outcome};
use proofmass_simulate::drift::windows::{BANDS, Drifted, Windows};
use proofmass_study::Study;

/// Returns what the windows show, if the study asks for them and the log is there.
fn drifted(outcome: &Outcome) -> Option<(&Comparison, &[Drifted])> {
    match outcome {
        Outcome::Compared(comparison) if !comparison.windows.is_empty() => Some((comparison, &comparison.windows)),
        _ => None,
    }
}

/// The section, if there is anything to show.
pub(crate) fn section(page: &mut Page, study: &Study, outcome: &Outcome) {
    let Some((log, axes)) = drifted(outcome) else { return };
    page.section("Predicted and recorded drift");
    page.paragraph(&format!(
        "The recorded log {} ({} samples at {} Hz, SHA-256 {}…) is cut into windows that do not overlap. Each begins with a \
         still start of {} s, whose mean is subtracted; the rest is integrated: accelerometers twice, into position, gyros \
         once, into tilt. The bands are those of {} simulated sensors per axis, processed the same way. Nothing was \
         fitted to \
         these windows: the bands follow from the coefficients that the study gives for each axis. Where those were estimated \
         from the same log, agreement shows that its Allan deviation predicts its drift, not that other units drift \
         the same way.",
        Path::new(&log.file).file_name().map_or(log.file.clone().into(), |name| name.to_string_lossy()),
        log.samples,
        rounded(log.rate_hz, 6),
        &log.sha256[..log.sha256.len().min(12)],
        rounded(study.still_s(), 6),
        axes[0].members
    ));
    let figures: Vec<_> = axes
        .iter()
        .map(|a| (chart(a).draw().named(&format!("windows-{}", file_name(&a.column, 80))), caption(a)))
        .collect();
    page.figure_row(&figures.iter().map(|(f, c)| (f, c.as_str())).collect::<Vec<_>>());
    page.table(&table(axes, false));
    page.paragraph(
        "Fractions of the windows inside the central 50, 90 and 99 % of the simulated sensors, in brackets exact 95 % \
         intervals (Clopper and Pearson) for independent windows. Where an interval does not contain the percentage \
         of its column, the log departs from the model at that length.",
    );
    match axes.iter().flat_map(|a| &a.windows).any(|w| w.disturbed() > 0) {
        true => {
            page.paragraph("The same without the windows that contain a knock, a level jump or a filled gap:");
            page.table(&table(axes, true));
        }
        false => page.paragraph("No window contains a knock, a level jump or a filled gap."),
    }
}

/// One sentence per axis and length of window.
pub(crate) fn sentences(outcome: &Outcome) -> Vec<String> {
    let Some((_, axes)) = drifted(outcome) else { return Vec::new() };
    let sentence = |axis: &Drifted, w: &Windows| {
        let [_, hits, _] = w.inside(false);
        let (unit, factor) = unit(axis.sense);
        format!(
            "{}: {} of {} windows of {} s inside the predicted 90 % band; sd {} {unit} recorded, {} {unit} predicted{}.",
            axis.column,
            hits,
            w.recorded.len(),
            w.seconds,
            significant(w.sd_recorded(false) / factor, 2),
            significant(w.sd_predicted / factor, 2),
            match w.disturbed() {
                0 => String::new(),
                1 => "; 1 window is disturbed".into(),
                some => format!("; {some} windows are disturbed"),
            }
        )
    };
    axes.iter().flat_map(|axis| axis.windows.iter().map(move |w| sentence(axis, w))).collect()
}

/// The picture of the accelerometers, or of the gyros where there are none, side by side; `None`
/// without windows.
pub fn picture(outcome: &Outcome) -> Option<Figure> {
    let (_, axes) = drifted(outcome)?;
    let of = |sense: Sense| axes.iter().filter(move |a| a.sense == sense);
    let sense = of(Sense::Accelerometer).next().map_or(Sense::Gyro, |a| a.sense);
    let charts: Vec<Figure> = of(sense).take(3).map(|a| chart(a).draw()).collect();
    Some(Figure::row(&charts))
}

/// Unit in which errors of a sensor are shown, and its size in SI units.
fn unit(sense: Sense) -> (&'static str, f64) {
    match sense {
        Sense::Accelerometer => ("m", 1.0),
        Sense::Gyro => ("°", DEGREE),
    }
}

fn quantity(sense: Sense) -> &'static str {
    match sense {
        Sense::Accelerometer => "position error",
        Sense::Gyro => "tilt error",
    }
}

fn caption(axis: &Drifted) -> String {
    let count = axis.windows.last().map_or(0, |w| w.recorded.len());
    format!(
        "{}: bands of the prediction, and the 5, 25, 50, 75 and 95 % quantiles of {count} recorded windows.",
        axis.column
    )
}

fn chart(axis: &Drifted) -> Chart {
    let (unit, factor) = unit(axis.sense);
    let band = |place: usize| -> Vec<f64> {
        std::iter::once(0.0).chain(axis.curve.iter().map(|p| p.predicted[place] / factor)).collect()
    };
    let times = || std::iter::once(0.0).chain(axis.curve.iter().map(|p| p.time_s));
    let low = |place: usize| -> Vec<(f64, f64)> { times().zip(band(place)).collect() };
    let recorded: Vec<(f64, f64)> = (0..5)
        .flat_map(|q| axis.curve.iter().skip(1).step_by(2).map(move |p| (p.time_s, p.recorded[q] / factor)))
        .collect();
    let mut chart = Chart::new(
        &axis.column,
        Axis::linear("time after the still start / s"),
        Axis::linear(&labelled(quantity(axis.sense), unit)),
    )
    .with("predicted, 5–95 %", Ink::Sky, Mark::Band(band(4)), low(0))
    .with("25–75 %", Ink::Blue, Mark::Band(band(3)), low(1))
    .with("recorded, 5 25 50 75 95 %", Ink::Red, Mark::Dots(3), recorded);
    chart.size = (400, 330);
    chart
}

/// Fractions inside the bands and standard deviations.
fn table(axes: &[Drifted], undisturbed: bool) -> Table {
    let mut headings = vec!["axis".to_owned(), "windows".into()];
    headings.extend(BANDS.iter().map(|b| format!("inside {:.0} %", 100.0 * b)));
    headings.extend(["sd recorded", "sd predicted"].map(str::to_owned));
    let mut table = Table { headings, rows: Vec::new() };
    for axis in axes {
        let (unit, factor) = unit(axis.sense);
        for w in axis.windows.iter().filter(|w| !undisturbed || w.disturbed() > 0) {
            let count = w.errors(undisturbed).len();
            let fraction = |hits: usize| {
                let [low, high] = exact_interval(hits as u64, count as u64, 0.95);
                let percent = |fraction: f64| format!("{:.1}", 100.0 * fraction);
                format!("{} % ({}–{})", percent(hits as f64 / count.max(1) as f64), percent(low), percent(high))
            };
            let sd = w.sd_recorded(undisturbed);
            let mut row = vec![axis.column.clone(), format!("{count} × {} s", rounded(w.seconds, 6))];
            row.extend(w.inside(undisturbed).map(fraction));
            row.push(format!("{} {unit}", significant(sd / factor, 3)));
            row.push(format!("{} {unit}", significant(w.sd_predicted / factor, 3)));
            table.row(row);
        }
    }
    table
}
