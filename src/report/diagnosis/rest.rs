//! Figures of a diagnosis: a sensor at rest, its noise and its drift.

use proofmass_base::escape::file_name;
use proofmass_diagnosis::rest::{ChannelDetail, Detail};
use proofmass_numerics::numerics::order;

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark, labelled};

/// So many characters of a heading stand in the names of its figures' files.
const HEADING: usize = 80;

/// Its figures; one of them is the opening: the channel in which most was named.
pub(crate) fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    let Some(opening) = (0..detail.channels.len()).rev().max_by_key(|i| detail.channels[*i].named.len()) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    for (index, channel) in detail.channels.iter().enumerate() {
        let part = if index == opening { Part::Opening } else { Part::Improvement };
        out.push(allan(channel, &detail.unit, part));
        out.push(density(channel, &detail.unit));
        out.push(trace(channel, &detail.unit));
    }
    order::sort_by_key(&mut out, |e| f64::from(e.part as u8));
    out
}

fn series(rows: &[[f64; 4]], column: usize) -> Vec<(f64, f64)> {
    rows.iter().map(|r| (r[0], r[column])).collect()
}

fn named(channel: &ChannelDetail) -> String {
    if channel.named.is_empty() { "nothing named".into() } else { channel.named.join(", ") }
}

fn allan(channel: &ChannelDetail, unit: &str, part: Part) -> Exhibit {
    let chart = Chart::new(
        &format!("Allan deviation of {}", channel.name),
        Axis::log("averaging time τ / s"),
        Axis::log(&labelled("Allan deviation", unit)),
    )
    .with("base model", Ink::Soft, Mark::Dashed, series(&channel.allan, 2))
    .with("repaired model", Ink::Red, Mark::Line, series(&channel.allan, 3))
    .with("recorded", Ink::Blue, Mark::Dots(3), series(&channel.allan, 1));
    Exhibit {
        part,
        name: format!("allan-{}", file_name(&channel.name, HEADING)),
        figure: chart.draw(),
        caption: format!(
            "Dots: recorded. Dashed: a constant and white noise. Line: the repaired model ({}). The missing physics \
             shows where dots and dashed line separate.",
            named(channel)
        ),
    }
}

fn density(channel: &ChannelDetail, unit: &str) -> Exhibit {
    let chart = Chart::new(
        &format!("Noise density of {}", channel.name),
        Axis::log("frequency / Hz"),
        Axis::log(&labelled("one-sided density", &format!("{unit}/√Hz"))),
    )
    .with("recorded", Ink::Blue, Mark::Line, series(&channel.density, 1))
    .with("base model", Ink::Soft, Mark::Dashed, series(&channel.density, 2))
    .with("repaired model, without its curves", Ink::Red, Mark::Line, series(&channel.density, 3));
    Exhibit {
        part: Part::Isolation,
        name: format!("density-{}", file_name(&channel.name, HEADING)),
        figure: chart.draw(),
        caption:
            "Recorded spectrum against both models. Curves in time (ramp, warm-up, sine, environment) are not part of \
                  the model's spectrum: where they act the recording lies above."
                .into(),
    }
}

fn trace(channel: &ChannelDetail, unit: &str) -> Exhibit {
    // Hours read better than tens of thousands of seconds.
    let last = channel.trace.last().map_or(0.0, |t| t[0]);
    let (label, factor) = if last > 2.0 * 3600.0 { ("time / h", 1.0 / 3600.0) } else { ("time / s", 1.0) };
    let points = |column: usize| channel.trace.iter().map(|t| (t[0] * factor, t[column])).collect();
    let mut chart = Chart::new(
        &format!("{} over time", channel.name),
        Axis::linear(label),
        Axis::linear(&labelled("reading minus its mean", unit)),
    )
    .with("recorded, block means", Ink::Blue, Mark::Dots(2), points(1));
    let has_curve = channel.trace.iter().any(|t| t[2] != 0.0);
    if has_curve {
        chart.add("repaired model's curve", Ink::Red, Mark::Line, points(2));
    }
    Exhibit {
        part: Part::Improvement,
        name: format!("trace-{}", file_name(&channel.name, HEADING)),
        figure: chart.draw(),
        caption: if has_curve {
            "Block means of the reading, and what the repaired model predicts of them.".into()
        } else {
            "Block means of the reading. The repaired model adds noise only, so it has no curve to draw here.".into()
        },
    }
}
