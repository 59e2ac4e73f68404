//! A chart as a file of its own: the plot with title, legend and labels of the axes around it, all
//! SVG.

use super::chart::Chart;
use super::frame::thousandths;
use super::legend::{Entry, Legend};
use super::plot::{BAR_PX, Plot};
use proofmass_base::escape::html;

/// Mean advance of the usual sans-serif faces at 12 and 13 px.
fn text_width(words: &str) -> f64 {
    7.0 * words.chars().count() as f64
}

/// The chart as an `<svg>` element without its style.
pub(super) fn sheet(chart: &Chart, legend: &Legend<'_>, plot: &Plot) -> String {
    let (width, height) = plot.size;
    let bar = chart.raster.as_ref().and_then(|r| r.bar.as_ref());
    let right = plot.right.as_ref().map_or(24.0, |r| f64::from(BAR_PX.1) + text_width(r) + 8.0);
    let left = text_width(&plot.left) + 16.0;
    let total = left + width + right;
    let (mut keys, mut column, mut row) = (String::new(), 0.0, 42.0);
    for (n, entry) in legend.entries.iter().enumerate() {
        let needs = 30.0 + text_width(entry.name) + 14.0;
        if n > 0 && column + needs > total - 20.0 {
            (column, row) = (0.0, row + 20.0);
        }
        keys += &key(entry, (10.0 + column, row));
        column += needs;
    }
    let over = if legend.entries.is_empty() { 44.0 } else { row + 24.0 };
    let top = over + 10.0;
    let [left, top_px, under, width, height] = [left, top, top + height + 38.0, width, height].map(thousandths);
    let bar = bar.map_or(String::new(), |(label, ..)| {
        format!("<text class=\"end\" x=\"{}\" y=\"{over}\">{}</text>", thousandths(total - 8.0), html(label))
    });
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\">\n\
         <text class=\"title\" x=\"10\" y=\"24\">{}</text>{keys}<text x=\"10\" y=\"{over}\">{}</text>{bar}\n\
         <svg x=\"{left}\" y=\"{top_px}\" width=\"{width}\" height=\"{height}\" overflow=\"visible\" {}>{}</svg>\n\
         <text x=\"{left}\" y=\"{under}\">{}</text>\n</svg>\n",
        html(&chart.title),
        html(&chart.y.label),
        plot.attributes,
        plot.inner,
        html(&chart.x.label),
        w = thousandths(total.ceil()),
        h = thousandths((top + plot.size.1 + 48.0).ceil()),
    )
}

/// An entry of the legend at a place.
fn key(entry: &Entry<'_>, (x, y): (f64, f64)) -> String {
    let ink = entry.ink.class();
    let (end, middle, low) = (x + 22.0, x + 11.0, y + 5.0);
    let swatch = match entry.kind {
        "line" | "dashed" => {
            format!("<polyline class=\"s-{ink} {}\" points=\"{x},{y} {end},{y}\"/>", entry.kind)
        }
        "dots" => format!("<circle class=\"f-{ink}\" cx=\"{middle}\" cy=\"{y}\" r=\"4\"/>"),
        "whiskers" => format!("<path class=\"s-{ink} line\" d=\"M{middle} {}L{middle} {low}\"/>", y - 5.0),
        kind => {
            let place = format!("x=\"{x}\" y=\"{}\" width=\"22\" height=\"10\"", y - 5.0);
            let behind =
                entry.behind.map_or(String::new(), |b| format!("<rect class=\"f-{} band\" {place}/>", b.class()));
            format!("{behind}<rect class=\"f-{ink} {kind}\" {place}/>")
        }
    };
    format!("{swatch}<text x=\"{}\" y=\"{y}\" dy=\".35em\">{}</text>", x + 28.0, html(entry.name))
}
