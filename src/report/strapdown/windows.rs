//! Predicted, and what the sensor then did in flight: the windows of a recorded flight as dots
//! next to the bands of the study's sensor, and the fractions inside them.

use crate::figure::{Axis, Chart, Figure, Ink, Mark, labelled};
use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::{rounded, significant};
use proofmass_base::units::{DEGREE, DEGREE_PER_HOUR_PER_ROOT_HOUR, DEGREE_PER_ROOT_HOUR, MICRO_G};
use proofmass_numerics::numerics::special::normal_quantile;
use proofmass_simulate::strapdown::windows::document::{AXES, TOGETHER};
use proofmass_simulate::strapdown::windows::inflation::{FEWEST, Inflation, Whose};
use proofmass_simulate::strapdown::windows::length::Length;
use proofmass_simulate::strapdown::windows::score::{self, BANDS};
use proofmass_simulate::strapdown::windows::{Compared, Sensor};
use proofmass_study::Study;

/// Names the nine errors as they are shown: name, unit, and its size in SI units.
const SHOWN: [(&str, &str, f64); 9] = [
    ("north", "m", 1.0),
    ("east", "m", 1.0),
    ("down", "m", 1.0),
    ("velocity north", "m/s", 1.0),
    ("velocity east", "m/s", 1.0),
    ("velocity down", "m/s", 1.0),
    ("roll", "°", DEGREE),
    ("pitch", "°", DEGREE),
    ("heading", "°", DEGREE),
];
const _: () = assert!(SHOWN.len() == AXES.len());

/// The section of the page.
pub(crate) fn section(page: &mut Page, compared: &Compared) {
    page.section("Predicted and recorded flight");
    page.paragraph(&format!(
        "The recorded IMU ({} s with the reference, SHA-256 {}…) is dead-reckoned in windows that do not overlap. Each \
         begins with the reference's position, velocity and attitude; biases estimated from other readings are subtracted. \
         The band is that of the study's sensor in the same window, by the linear error model, and includes the uncertainty \
         of the subtracted biases. Nothing in it was fitted to these windows.",
        rounded(compared.seconds, 4),
        &compared.sha256[..compared.sha256.len().min(12)],
    ));
    for group in 0..3 {
        let figures: Vec<(Figure, String)> = (3 * group..3 * group + 3)
            .map(|place| {
                let name = SHOWN[place].0;
                let figure = chart(compared, place).draw().named(&format!("windows-{}", name.replace(' ', "-")));
                let caption = match place % 3 {
                    0 => format!(
                        "Error of {} at the end of each window (dots) next to the 50 and 90 % bands that the study's sensor \
                         predicts.",
                        ["position", "velocity", "attitude"][group]
                    ),
                    _ => format!("The same, {name}."),
                };
                (figure, caption)
            })
            .collect();
        page.figure_row(&figures.iter().map(|(figure, caption)| (figure, caption.as_str())).collect::<Vec<_>>());
    }
    page.table(&table(compared));
    page.paragraph(
        "Fractions of the windows inside the central 50, 90 and 99 % of the prediction, in brackets exact 95 % intervals \
         (Clopper and Pearson). The last column is the mean normalised squared error: 1 where errors are as large as \
         predicted, and then, in 95 of 100 cases, within the range in brackets.",
    );
    page.table(&joint(compared));
    if let Some(inflation) = &compared.inflation {
        page.paragraph(&format!(
            "The inflation that this motion justifies: the size of each error source with which {} windows of {} s are \
             consistent, all estimated together by maximum likelihood, with 95 % intervals of the profile likelihood. \
             inflated.toml is the stated sensor with these figures, for a study or `proofmass export`.",
            inflation.windows, compared.lengths[0].seconds,
        ));
        if let Some(said) = of_which_flight(inflation.whose) {
            page.paragraph(&said);
        }
        page.table(&inflated(compared, inflation));
    }
    page.list(&compared.findings);
}

/// One sentence per sensor and length of window.
pub(crate) fn sentences(compared: &Compared) -> Vec<String> {
    let mut all = Vec::new();
    for length in &compared.lengths {
        let errors = length.errors();
        let rms = |first: usize, unit: f64| {
            let axes = (first..first + 3).map(|p| score::axis(&errors, &length.expected[0], p).rms_recorded / unit);
            axes.map(|v| significant(v, 2)).collect::<Vec<_>>().join("/")
        };
        all.push(format!(
            "{} window{} of {} s: at the end the recorded IMU errs by {} m north/east/down and {}° roll/pitch/heading (rms).",
            length.windows.len(),
            if length.windows.len() == 1 { "" } else { "s" },
            length.seconds,
            rms(0, 1.0),
            rms(6, DEGREE),
        ));
        for (sensor, expected) in compared.sensors.iter().zip(&length.expected) {
            let axes: Vec<_> = (0..9).map(|place| score::axis(&errors, expected, place)).collect();
            let sd = |first: usize, unit: f64| {
                let each = axes[first..first + 3].iter().map(|a| significant(a.sd_predicted / unit, 2));
                each.collect::<Vec<_>>().join("/")
            };
            let inside: usize = axes.iter().map(|a| a.inside[1]).sum();
            let position = score::together(&errors, expected, 0..9);
            all.push(format!(
                "  {}: predicts {} m and {}°; {:.0} % of the errors lie inside its 90 % bands; normalised error squared {} \
                 (1 expected, {}–{} by chance).",
                words(sensor),
                sd(0, 1.0),
                sd(6, DEGREE),
                100.0 * inside as f64 / (9 * length.windows.len()) as f64,
                significant(position.mean, 2),
                significant(position.interval[0], 2),
                significant(position.interval[1], 2),
            ));
        }
    }
    if let Some(inflation) = &compared.inflation {
        all.push(format!("{} windows would be consistent with:", inflation.windows));
        for row in inflated(compared, inflation).rows {
            let factor =
                if row[4].is_empty() { String::new() } else { format!(", {} × the stated {}", row[4], row[3]) };
            all.push(format!("  {}: {} ({}){factor}", row[0], row[1], row[2]));
        }
        all.extend(of_which_flight(inflation.whose));
    }
    all
}

/// Which flight the coefficients are of, where not all are of the one that is compared.
fn of_which_flight(whose: Whose) -> Option<String> {
    match whose {
        Whose::Own => None,
        Whose::OwnReference { windows } => Some(format!(
            "Those windows are of other flights. The attitude error of the reference is not the sensor's and may differ \
             from flight to flight: it is estimated from {windows} windows of this one, with the other figures as they \
             stand, and for each band from the windows that do not overlap it, if at least {FEWEST} are left."
        )),
        Whose::Others => Some(
            "Those windows are of other flights, and so is the attitude error of the reference: this flight has too few \
             windows to tell how far its own reference errs."
                .into(),
        ),
    }
}

/// The causes as a table.
fn inflated(compared: &Compared, inflation: &Inflation) -> Table {
    let mut table = Table::new(&["cause", "justified", "95 %", "stated", "factor"]);
    for (place, (name, unit, size)) in CAUSES.into_iter().enumerate() {
        let shown = |value: f64| if value.is_finite() { significant(value / size, 2) } else { "∞".into() };
        let (value, stated, [low, high]) =
            (inflation.coefficients[place], compared.stated[place], inflation.interval[place]);
        table.row([
            name.to_owned(),
            format!("{} {unit}", shown(value)),
            format!("{}–{}", shown(low), shown(high)),
            format!("{} {unit}", shown(stated)),
            if stated > 0.0 { significant(value / stated, 2) } else { String::new() },
        ]);
    }
    table
}

/// Names the causes, with the unit that they are shown in and its size in SI units.
const CAUSES: [(&str, &str, f64); 5] = [
    ("attitude of the reference", "°", DEGREE),
    ("gyro, white noise", "°/√h", DEGREE_PER_ROOT_HOUR),
    ("gyro, random walk", "°/h/√h", DEGREE_PER_HOUR_PER_ROOT_HOUR),
    ("accelerometer, white noise", "m/s/√h", 1.0 / 60.0),
    ("accelerometer, random walk", "µg/√s", MICRO_G),
];

/// The stated sensor with the justified figures, as a file that a study and `export` take; none
/// where nothing was fitted.
pub(super) fn inflated_toml(study: &Study, compared: &Compared) -> Option<String> {
    let inflation = compared.inflation.as_ref()?;
    let line = |place: usize, key: &str| {
        let (_, unit, size) = CAUSES[place];
        let of = |value: f64| if value.is_finite() { significant(value / size, 3) } else { "inf".into() };
        let [low, high] = inflation.interval[place].map(of);
        format!("{key} = {:e} # {unit}; 95 %: {low} to {high}\n", inflation.coefficients[place] / size)
    };
    let of = match inflation.whose {
        Whose::OwnReference { windows } => format!(", from {windows} windows of this flight"),
        Whose::Own | Whose::Others => String::new(),
    };
    Some(format!(
        "# {}: what {} windows of {} s justify, by maximum likelihood; the stated figures of the same causes are replaced.\n\
         # Attitude of the reference{of}: {}° (95 %: {} to {}).\n\
         [sensor]\nsample_rate_hz = {:?}\n\n[gyro]\n{}{}\n[accelerometer]\n{}{}",
        study.name,
        inflation.windows,
        compared.lengths[0].seconds,
        significant(inflation.coefficients[0] / DEGREE, 3),
        significant(inflation.interval[0][0] / DEGREE, 3),
        significant(inflation.interval[0][1] / DEGREE, 3),
        1.0 / study.sample_s(),
        line(1, "angle_random_walk_deg_rth"),
        line(2, "rate_random_walk_deg_h_rth"),
        line(3, "velocity_random_walk_m_s_rth"),
        line(4, "acceleration_random_walk_ug_rts"),
    ))
}

/// Names a sensor.
fn words(sensor: &Sensor) -> String {
    match sensor {
        Sensor::Stated => "stated sensor".into(),
        Sensor::Tenfold => "tenfold noise".into(),
        Sensor::File(name) => name.clone(),
        Sensor::Inflated => "inflated".into(),
    }
}

/// One error: dots of the recorded windows over their length, on the bands of the stated sensor.
fn chart(compared: &Compared, place: usize) -> Chart {
    let (name, unit, size) = SHOWN[place];
    let mut chart = Chart::new(name, Axis::linear("length of the window / s"), Axis::linear(&labelled("error", unit)));
    for (fraction, name, ink) in [(BANDS[1], "predicted, 90 %", Ink::Sky), (BANDS[0], "50 %", Ink::Blue)] {
        let most = normal_quantile(0.5 + 0.5 * fraction);
        let edge =
            |length: &Length| most * score::axis(&length.errors(), &length.expected[0], place).sd_predicted / size;
        let edges: Vec<(f64, f64)> = compared.lengths.iter().map(|l| (l.seconds, edge(l))).collect();
        let with_zero = || std::iter::once((0.0, 0.0)).chain(edges.iter().copied());
        let upper = with_zero().map(|(_, e)| e).collect();
        chart.add(name, ink, Mark::Band(upper), with_zero().map(|(t, e)| (t, -e)).collect());
    }
    let dots = compared.lengths.iter().flat_map(|l| l.windows.iter().map(|w| (l.seconds, w.error[place] / size)));
    chart.add("recorded", Ink::Red, Mark::Dots(3), dots.collect());
    chart
}

/// Fractions inside the bands, axis by axis.
fn table(compared: &Compared) -> Table {
    let mut headings = vec!["sensor".to_owned(), "windows".into(), "error".into()];
    headings.extend(BANDS.iter().map(|b| format!("inside {:.0} %", 100.0 * b)));
    headings.extend(["rms recorded", "sd predicted", "normalised error squared"].map(str::to_owned));
    let mut table = Table { headings, rows: Vec::new() };
    for length in &compared.lengths {
        let errors = length.errors();
        for (sensor, expected) in compared.sensors.iter().zip(&length.expected) {
            for (place, (name, unit, size)) in SHOWN.into_iter().enumerate() {
                let axis = score::axis(&errors, expected, place);
                let percent = |fraction: f64| format!("{:.0}", 100.0 * fraction);
                let fraction = |k: usize| {
                    let [low, high] = axis.interval[k].map(percent);
                    format!("{} % ({low}–{high})", percent(axis.inside[k] as f64 / axis.windows.max(1) as f64))
                };
                let mut row = vec![words(sensor), format!("{} × {} s", axis.windows, length.seconds), name.into()];
                row.extend((0..3).map(fraction));
                row.extend(
                    [axis.rms_recorded, axis.sd_predicted].map(|v| format!("{} {unit}", significant(v / size, 2))),
                );
                row.push(squared(&axis.nees));
                table.row(row);
            }
        }
    }
    table
}

fn squared(nees: &score::Nees) -> String {
    let [low, high] = nees.interval.map(|v| significant(v, 2));
    format!("{} ({low}–{high})", significant(nees.mean, 2))
}

/// Normalised errors squared of several axes together.
fn joint(compared: &Compared) -> Table {
    let mut headings = vec!["sensor".to_owned(), "windows".into()];
    headings.extend(TOGETHER.iter().map(|(name, _)| format!("{name}, squared")));
    let mut table = Table { headings, rows: Vec::new() };
    for length in &compared.lengths {
        let errors = length.errors();
        for (sensor, expected) in compared.sensors.iter().zip(&length.expected) {
            let mut row = vec![words(sensor), format!("{} × {} s", length.windows.len(), length.seconds)];
            row.extend(TOGETHER.iter().map(|(_, places)| squared(&score::together(&errors, expected, places.clone()))));
            table.row(row);
        }
    }
    table
}
