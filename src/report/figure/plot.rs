//! The plot as SVG: grid, data, labels of ticks, words.
//!
//! Its size is the page's to choose: labels stand at per cents of it and keep their size, the data
//! is a picture in coordinates of its own that stretches with it. What a reader's script must know
//! stands in `data-` attributes.

use super::axis::{Axis, Scale, Span};
use super::chart::{Chart, Note};
use super::frame::{Frame, thousandths};
use super::legend::Legend;
use super::marks::{kind, shapes};
use super::raster::{self, Raster};
use super::tick::{ADVANCE_PX, NARROW_PX, horizontal};
use proofmass_base::escape::html;

/// From the plot to a colour bar, and on to its numbers, px.
pub(super) const BAR_PX: (u32, u32) = (14, 34);

/// A plot and what stands around it.
pub(super) struct Plot {
    /// Attributes of the `<svg>` element.
    pub(super) attributes: String,
    pub(super) inner: String,
    /// The longest label left of it.
    pub(super) left: String,
    /// The longest label of its colour bar, if it has one.
    pub(super) right: Option<String>,
    pub(super) size: (f64, f64),
}

impl Plot {
    pub(super) fn of(chart: &Chart, legend: &Legend<'_>) -> Self {
        let frame = Frame::of(chart);
        let mut inner = String::new();
        let left = rows(chart, &frame);
        let columns = horizontal(&frame.x);
        // A picture covers the plot: lines would only show through its gaps.
        if chart.raster.is_none() {
            inner += "<g class=\"grid\">";
            for tick in &columns {
                let x = thousandths(frame.x_percent(tick.value));
                inner += &format!("<line x1=\"{x}%\" x2=\"{x}%\" y1=\"0\" y2=\"100%\"/>");
            }
            for (value, _) in &left {
                let y = thousandths(frame.y_percent(*value));
                inner += &format!("<line x1=\"0\" x2=\"100%\" y1=\"{y}%\" y2=\"{y}%\"/>");
            }
            inner += "</g>";
        }
        inner += &format!(
            "<svg class=\"data\" width=\"100%\" height=\"100%\" viewBox=\"0 0 {} {}\" preserveAspectRatio=\"none\">",
            thousandths(frame.width),
            thousandths(frame.height)
        );
        if let Some(raster) = &chart.raster {
            inner += &picture(raster, &frame);
        }
        for (series, group) in chart.series.iter().zip(legend.groups(chart)) {
            let name = group.map_or("", |g| legend.entries[g].name);
            let group = group.map_or(String::new(), |g| format!(" data-group=\"{g}\""));
            inner += &format!(
                "<g data-kind=\"{}\" data-name=\"{}\"{group}>{}</g>",
                kind(&series.mark),
                html(name),
                shapes(series, &frame)
            );
        }
        inner += "</svg><rect class=\"frame\" width=\"100%\" height=\"100%\"/><g class=\"ticks\">";
        for tick in columns.iter().filter(|t| t.wide || t.narrow) {
            let class = match (tick.wide, tick.narrow) {
                (true, false) => "x wide",
                (false, _) => "x narrow",
                _ => "x",
            };
            let x = thousandths(frame.x_percent(tick.value));
            inner += &format!("<text class=\"{class}\" x=\"{x}%\" y=\"100%\" dy=\"17\">{}</text>", html(&tick.label));
        }
        let class = if chart.y.names.is_empty() { "y" } else { "y name" };
        for (value, label) in &left {
            let y = thousandths(frame.y_percent(*value));
            inner += &format!("<text class=\"{class}\" x=\"-7\" y=\"{y}%\" dy=\".35em\">{}</text>", html(label));
        }
        inner += "</g>";
        chart.notes.iter().for_each(|note| inner += &words(note, &frame));
        let mut right = None;
        if let Some((_, low, high)) = chart.raster.as_ref().and_then(|r| r.bar.as_ref()) {
            let span = Span { scale: Scale::Linear, low: *low, high: *high };
            inner += &colour_bar(&span);
            right = Some(longest(span.ticks().iter().map(|t| span.tick_label(*t))));
        }
        let axes = axis("x", &chart.x, &frame.x) + &axis("y", &chart.y, &frame.y);
        let said = format!("{}: {} over {}", chart.title, chart.y.label, chart.x.label);
        let equal = if chart.equal { " equal" } else { "" };
        Self {
            attributes: format!("class=\"plot{equal}\" role=\"img\" aria-label=\"{}\"{axes}", html(&said)),
            inner,
            left: longest(left.into_iter().map(|(_, label)| label)),
            right,
            size: (frame.width, frame.height),
        }
    }
}

fn longest(labels: impl Iterator<Item = String>) -> String {
    labels.max_by_key(|l| l.chars().count()).unwrap_or_default()
}

/// Ticks of the vertical axis, or the entries of its list.
fn rows(chart: &Chart, frame: &Frame) -> Vec<(f64, String)> {
    if !chart.y.names.is_empty() {
        return chart.y.names.clone();
    }
    frame.y.ticks().into_iter().map(|v| (v, frame.y.tick_label(v))).collect()
}

/// Quantity, unit, scale and limits of an axis as attributes.
fn axis(which: &str, axis: &Axis, span: &Span) -> String {
    let (quantity, unit) = axis.label.rsplit_once(" / ").unwrap_or((&axis.label, ""));
    let unit = unit.strip_prefix('(').and_then(|u| u.strip_suffix(')')).unwrap_or(unit);
    let scale = if span.scale == Scale::Log { "log" } else { "linear" };
    let list = if axis.names.is_empty() { String::new() } else { format!(" data-{which}-list=\"\"") };
    format!(
        " data-{which}=\"{}\" data-{which}-unit=\"{}\" data-{which}-scale=\"{scale}\" data-{which}-from=\"{:e}\" \
         data-{which}-to=\"{:e}\"{list}",
        html(quantity),
        html(unit),
        span.low,
        span.high
    )
}

/// Words in the plot. Those at a point turn to the left where there is no room on the right.
fn words(note: &Note, frame: &Frame) -> String {
    let (x, y) = (frame.x_percent(note.at.0), frame.y_percent(note.at.1));
    let (anchor, drop) = match note.middle {
        true => ("middle", " dy=\".35em\""),
        false if x + 100.0 * ADVANCE_PX * note.text.chars().count() as f64 / NARROW_PX > 100.0 => ("end", ""),
        false => ("start", ""),
    };
    let class = if note.narrow { "note" } else { "note wide" };
    format!(
        "<text class=\"{class}\" x=\"{}%\" y=\"{}%\"{drop} text-anchor=\"{anchor}\">{}</text>",
        thousandths(x),
        thousandths(y),
        html(&note.text)
    )
}

fn picture(raster: &Raster, frame: &Frame) -> String {
    let (left, top) = frame.place((raster.x.0, raster.y.1));
    let (right, bottom) = frame.place((raster.x.1, raster.y.0));
    let [x, y, width, height] = [left, top, right - left, bottom - top].map(thousandths);
    let place = format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\"");
    match raster.bar {
        // A heat map keeps its cells.
        Some(_) => format!("<image class=\"cells\" {place} href=\"{}\"/>", raster.data_uri()),
        // A cloud is a stencil for the ink of the theme.
        None => {
            let (id, uri) = raster.stencil();
            format!(
                "<mask id=\"{id}\" maskUnits=\"userSpaceOnUse\" x=\"{x}\" y=\"{y}\" width=\"{width}\" \
                 height=\"{height}\"><image {place} href=\"{uri}\"/></mask><rect class=\"f-{}\" x=\"{x}\" y=\"{y}\" \
                 width=\"{width}\" height=\"{height}\" mask=\"url(#{id})\"/>",
                super::Ink::Blue.class()
            )
        }
    }
}

fn colour_bar(span: &Span) -> String {
    let (left, words) = BAR_PX;
    let mut bar = format!(
        "<svg class=\"bar\" x=\"100%\" overflow=\"visible\" data-from=\"{:e}\" data-to=\"{:e}\"><image x=\"{left}\" width=\"12\" \
         height=\"100%\" preserveAspectRatio=\"none\" href=\"{}\"/>",
        span.low,
        span.high,
        raster::ramp_uri()
    );
    for tick in span.ticks() {
        let y = thousandths(100.0 * (1.0 - span.fraction(tick)));
        bar += &format!("<text x=\"{words}\" y=\"{y}%\" dy=\".35em\">{}</text>", html(&span.tick_label(tick)));
    }
    bar + "</svg>"
}
