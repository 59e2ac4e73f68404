//! A chart in a page: title, legend and labels of the axes are the page's text, which wraps; the
//! plot fills the width.

use super::chart::Chart;
use super::frame::thousandths;
use super::legend::Legend;
use super::plot::Plot;
use proofmass_base::escape::html;

/// The chart as one element of well-formed XHTML.
pub(super) fn inline(chart: &Chart, legend: &Legend<'_>, plot: &Plot) -> String {
    let mut keys = String::new();
    for (n, entry) in legend.entries.iter().enumerate() {
        let behind = entry.behind.map_or(String::new(), |ink| format!("<b class=\"b-{}\"></b>", ink.class()));
        keys += &format!(
            "<span class=\"key\" data-group=\"{n}\"><i class=\"k-{} b-{}\">{behind}</i>{}</span> ",
            entry.kind,
            entry.ink.class(),
            html(entry.name)
        );
    }
    if !keys.is_empty() {
        keys = format!("<div class=\"legend\">{keys}</div>");
    }
    let bar = chart.raster.as_ref().and_then(|r| r.bar.as_ref());
    let bar = bar.map_or(String::new(), |(label, ..)| format!("<span>{}</span>", html(label)));
    let right = plot.right.as_ref().map_or(String::new(), |r| format!("<span class=\"right gap\">{}</span>", html(r)));
    // A plot of equal axes is as high as it is wide, whatever that is.
    let height = if chart.equal { String::new() } else { format!(" height=\"{}\"", thousandths(plot.size.1)) };
    format!(
        "<div class=\"fig\"><div class=\"head\"><p class=\"title\">{}</p></div>{keys}<div class=\"over\"><span>{}</span>{bar}\
         </div><div class=\"area\"><span class=\"gap\">{}</span><svg {}{height}>{}</svg>{right}</div><p class=\"under\">{}</p></div>",
        html(&chart.title),
        html(&chart.y.label),
        html(&plot.left),
        plot.attributes,
        plot.inner,
        html(&chart.x.label),
    )
}
