//! The data of a chart as SVG: one group per series, drawn by plotters in the plot's own
//! coordinates.

use plotters::prelude::*;

use super::axis::Span;
use super::canvas::{Canvas, UNITS};
use super::chart::{Mark, Series};
use super::frame::Frame;

/// Returns what a reader's script needs to know of a mark, and the class of its legend entry.
pub(super) fn kind(mark: &Mark) -> &'static str {
    match mark {
        Mark::Line => "line",
        Mark::Dashed => "dashed",
        Mark::Dots(_) => "dots",
        Mark::Band(_) => "band",
        Mark::Bars(_) => "bars",
        Mark::Whiskers(_) => "whiskers",
    }
}

/// The shapes of one series.
pub(super) fn shapes(series: &Series, frame: &Frame) -> String {
    let (ink, kind) = (series.ink.class(), kind(&series.mark));
    let (mut curves, mut path) = (String::new(), String::new());
    let canvas = Canvas {
        size: ((UNITS * frame.width) as u32, (UNITS * frame.height) as u32),
        classes: [format!("s-{ink} {kind}"), format!("f-{ink} {kind}")],
        curves: &mut curves,
        path: &mut path,
        joined: matches!(series.mark, Mark::Whiskers(_)),
    };
    // Nothing is drawn on a plot without area.
    let _ = draw(series, frame, canvas);
    match series.mark {
        Mark::Dots(radius) => {
            curves += &format!("<path class=\"s-{ink} dots\" stroke-width=\"{}\" d=\"{path}\"/>", 2 * radius);
        }
        Mark::Bars(_) => curves += &format!("<path class=\"f-{ink} bars\" d=\"{path}\"/>"),
        Mark::Whiskers(_) => curves += &format!("<path class=\"s-{ink} line\" d=\"{path}\"/>"),
        _ => {}
    }
    curves
}

type Failure = DrawingAreaErrorKind<std::convert::Infallible>;

fn draw(series: &Series, frame: &Frame, canvas: Canvas<'_>) -> Result<(), Failure> {
    let area = canvas.into_drawing_area();
    let (x, y): (Span, Span) = (frame.x, frame.y);
    let mut context = ChartBuilder::on(&area).build_cartesian_2d(x, y)?;
    let (line, fill) = (BLACK.stroke_width(1), BLACK.filled());
    let pairs = |upper: &[f64]| -> Vec<((f64, f64), f64)> {
        let both = series.points.iter().copied().zip(upper.iter().copied());
        both.filter(|(p, u)| frame.holds(p) && frame.y.holds(*u)).collect()
    };
    match &series.mark {
        Mark::Line | Mark::Dashed => {
            for run in series.points.split(|p| !frame.holds(p)).filter(|run| !run.is_empty()) {
                context.draw_series(LineSeries::new(run.iter().copied(), line))?;
            }
        }
        Mark::Dots(_) => {
            let inside = series.points.iter().filter(|p| frame.holds(p) && frame.shows(p));
            context.draw_series(inside.map(|p| Circle::new(*p, 1, fill)))?;
        }
        Mark::Band(upper) => {
            let pairs = pairs(upper);
            let edge = pairs.iter().map(|(p, _)| *p).chain(pairs.iter().rev().map(|(p, u)| (p.0, *u)));
            context.draw_series(std::iter::once(Polygon::new(edge.collect::<Vec<_>>(), fill)))?;
        }
        Mark::Bars(width) => {
            let floor = if frame.y.low > 0.0 { frame.y.low } else { 0.0 };
            let bars = series.points.iter().filter(|p| frame.holds(p));
            context.draw_series(
                bars.map(|p| Rectangle::new([(p.0 - width / 2.0, floor), (p.0 + width / 2.0, p.1)], fill)),
            )?;
        }
        Mark::Whiskers(upper) => {
            let pairs = pairs(upper);
            context.draw_series(pairs.into_iter().map(|(p, u)| PathElement::new([p, (p.0, u)], line)))?;
        }
    }
    Ok(())
}
