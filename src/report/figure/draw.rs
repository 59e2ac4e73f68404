//! From a `Chart` to SVG through plotters: title, legend in its own strip, axes, series.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Span;
use super::chart::{Chart, Mark, Series};
use super::raster::{Raster, colour};
use super::theme::{self, Ink};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failure = DrawingAreaErrorKind<std::io::Error>;

const FONT: &str = "system-ui, -apple-system, 'Segoe UI', sans-serif";
const TITLE_PX: i32 = 17;
const TEXT_PX: i32 = 14;
/// Opacity of bands, which may lie over each other, and of bars.
const BAND: f64 = 0.25;
const BARS: f64 = 0.35;

/// Pixel columns and rows of the plotting area.
type Frame = (std::ops::Range<i32>, std::ops::Range<i32>);

/// What one pass draws. Data is a layer of its own so that it can be clipped to the frame, which plotters does not do.
#[derive(Clone, Copy, PartialEq)]
enum Layer {
    Axes,
    Data,
}

/// The chart as SVG text. Drawing into a string fails only on a chart without area, which then stays blank.
pub(super) fn to_svg(chart: &Chart) -> String {
    let (axes, frame) = layer(chart, Layer::Axes);
    let (data, _) = layer(chart, Layer::Data);
    let inner = data.split_once('>').map_or("", |d| d.1).trim_end().trim_end_matches("</svg>");
    let raster = chart.raster.as_ref().map_or(String::new(), |r| picture(r, chart, &frame));
    let (left, top) = (frame.0.start, frame.1.start);
    let (width, height) = (frame.0.end - left, frame.1.end - top);
    let clipped = format!(
        "<svg x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" viewBox=\"{left} {top} {width} {height}\">\n{raster}{inner}</svg>\n</svg>\n"
    );
    theme::classify(&(axes.trim_end().trim_end_matches("</svg>").to_owned() + &clipped))
}

fn layer(chart: &Chart, layer: Layer) -> (String, Frame) {
    let size = (chart.size.0.max(160), chart.size.1.max(120));
    let mut svg = String::new();
    let frame = {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let frame = draw(chart, &area, layer).unwrap_or((0..0, 0..0));
        // Nothing to flush to but the string.
        let _ = area.present();
        frame
    };
    (svg, frame)
}

fn text(ink: Ink, px: i32, h: HPos, v: VPos) -> TextStyle<'static> {
    TextStyle { font: (FONT, px).into_font(), color: ink.rgb().to_backend_color(), pos: Pos::new(h, v) }
}

/// Mean advance of the usual sans-serif faces is close to 0.53 em.
fn text_width(words: &str, px: i32) -> i32 {
    (words.chars().count() as f64 * 0.54 * f64::from(px)) as i32
}

fn spans(chart: &Chart) -> (Span, Span) {
    let raster = chart.raster.iter();
    let xs = chart.series.iter().flat_map(|s| {
        s.points.iter().flat_map(move |p| {
            let half = if let Mark::Bars(width) = s.mark { width / 2.0 } else { 0.0 };
            [p.0 - half, p.0 + half]
        })
    });
    let ys = chart.series.iter().flat_map(|s| {
        let upper: &[f64] = match &s.mark {
            Mark::Band(u) | Mark::Whiskers(u) => u,
            Mark::Bars(_) => &[0.0],
            _ => &[],
        };
        s.points.iter().map(|p| p.1).chain(upper.iter().copied())
    });
    let x = chart.x.fitted(xs.chain(raster.clone().flat_map(|r| [r.x.0, r.x.1])));
    let mut y = chart.y.fitted(ys.chain(raster.flat_map(|r| [r.y.0, r.y.1])));
    if let (Some(r), None) = (&chart.raster, chart.y.range) {
        (y.low, y.high) = r.y;
    }
    let mut x = x;
    if let (Some(r), None) = (&chart.raster, chart.x.range) {
        (x.low, x.high) = r.x;
    }
    let bars = chart.series.iter().any(|s| matches!(s.mark, Mark::Bars(_)));
    if bars && chart.y.range.is_none() && y.scale == super::Scale::Linear && y.low < 0.0 {
        let lowest = chart.series.iter().flat_map(|s| &s.points).map(|p| p.1).fold(0.0, f64::min);
        y.low = if lowest < 0.0 { y.low } else { 0.0 };
    }
    (x, y)
}

fn draw(chart: &Chart, area: &Area<'_>, layer: Layer) -> Result<Frame, Failure> {
    let (width, _) = area.dim_in_pixel();
    let (x, y) = spans(chart);
    let top = legend(chart, area, layer, 10 + TITLE_PX + 8, width as i32)?;
    let bar_width = if chart.raster.as_ref().is_some_and(|r| r.bar.is_some()) { 84 } else { 0 };
    let label_area = y.ticks().iter().map(|t| text_width(&y.tick_label(*t), TEXT_PX)).max().unwrap_or(20) + 34;
    let plot = area.clone().margin(top, 8, 4, 18 + bar_width);
    let mut context =
        ChartBuilder::on(&plot).x_label_area_size(46).y_label_area_size(label_area).build_cartesian_2d(x, y)?;
    let frame = context.plotting_area().get_pixel_range();
    if layer == Layer::Data {
        for series in &chart.series {
            draw_series(&mut context, series, &x, &y)?;
        }
        for note in &chart.notes {
            let style = text(Ink::Black, TEXT_PX, HPos::Left, VPos::Bottom);
            context.draw_series(std::iter::once(Text::new(note.text.clone(), note.at, style)))?;
        }
        return Ok(frame);
    }
    let title = text(Ink::Black, TITLE_PX, HPos::Left, VPos::Top);
    area.draw_text(&chart.title, &TextStyle { font: title.font.style(FontStyle::Bold), ..title }, (10, 8))?;
    let (label_x, label_y) = (|v: &f64| x.tick_label(*v), |v: &f64| y.tick_label(*v));
    let mut mesh = context.configure_mesh();
    mesh.axis_style(Ink::Soft.rgb().stroke_width(1))
        .bold_line_style(Ink::Grid.rgb().stroke_width(1))
        .light_line_style(TRANSPARENT)
        .label_style(text(Ink::Black, TEXT_PX, HPos::Left, VPos::Top))
        .axis_desc_style(text(Ink::Black, TEXT_PX, HPos::Left, VPos::Top))
        .x_labels(20)
        .y_labels(20)
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .x_label_formatter(&label_x)
        .y_label_formatter(&label_y);
    if chart.raster.is_some() {
        mesh.disable_mesh();
    }
    mesh.draw()?;
    if let Some((label, low, high)) = chart.raster.as_ref().and_then(|r| r.bar.as_ref()) {
        colour_bar(area, label, (*low, *high), &frame)?;
    }
    Ok(frame)
}

/// Draws the legend in rows above the plot (with the axes) and returns where the plot begins.
fn legend(chart: &Chart, area: &Area<'_>, layer: Layer, top: i32, width: i32) -> Result<i32, Failure> {
    let (mut column, mut row) = (12, top);
    let mut any = false;
    for series in chart.series.iter().filter(|s| !s.name.is_empty()) {
        let needs = 30 + text_width(&series.name, TEXT_PX) + 16;
        if any && column + needs > width {
            (column, row) = (12, row + TEXT_PX + 6);
        }
        any = true;
        let at = column;
        column += needs;
        if layer == Layer::Data {
            continue;
        }
        let column = at;
        let (middle, ink) = (row + TEXT_PX / 2, series.ink.rgb());
        let line = ink.stroke_width(2);
        match series.mark {
            Mark::Line => area.draw(&PathElement::new([(column, middle), (column + 22, middle)], line))?,
            Mark::Dashed => {
                for start in [0, 8, 16] {
                    area.draw(&PathElement::new([(column + start, middle), (column + start + 5, middle)], line))?;
                }
            }
            Mark::Dots(radius) => area.draw(&Circle::new((column + 11, middle), radius.max(2), ink.filled()))?,
            Mark::Whiskers(_) => {
                area.draw(&PathElement::new([(column + 11, row), (column + 11, row + TEXT_PX)], line))?
            }
            Mark::Band(_) | Mark::Bars(_) => {
                let swatch = [(column, row + 1), (column + 22, row + TEXT_PX - 1)];
                let strength = if matches!(series.mark, Mark::Band(_)) { BAND } else { BARS };
                // What shines through in the plot shines through in the legend.
                for behind in chart.series.iter().filter(|s| encloses(s, series)) {
                    area.draw(&Rectangle::new(swatch, behind.ink.rgb().mix(BAND).filled()))?;
                }
                area.draw(&Rectangle::new(swatch, ink.mix(strength).filled()))?;
            }
        }
        area.draw_text(&series.name, &text(Ink::Black, TEXT_PX, HPos::Left, VPos::Center), (column + 28, middle))?;
    }
    Ok(if any { row + TEXT_PX + 8 } else { top + 2 })
}

/// Whether a band lies wholly within another one.
fn encloses(outer: &Series, inner: &Series) -> bool {
    let (Mark::Band(outer_top), Mark::Band(inner_top)) = (&outer.mark, &inner.mark) else { return false };
    let inside = |n: usize| outer.points[n].1 <= inner.points[n].1 && inner_top[n] <= outer_top[n];
    outer != inner && outer_top.len() == inner_top.len() && (0..inner_top.len()).all(inside)
}

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Span, Span>>;

fn draw_series(context: &mut Context<'_, '_>, series: &Series, x: &Span, y: &Span) -> Result<(), Failure> {
    let ink = series.ink.rgb();
    let drawable = |p: &(f64, f64)| x.holds(p.0) && y.holds(p.1);
    let runs = || series.points.split(move |p| !drawable(p)).filter(|run| !run.is_empty());
    match &series.mark {
        Mark::Line => {
            for run in runs() {
                context.draw_series(LineSeries::new(run.iter().copied(), ink.stroke_width(2)))?;
            }
        }
        Mark::Dashed => {
            for run in runs() {
                context.draw_series(DashedLineSeries::new(run.iter().copied(), 7, 5, ink.stroke_width(2)))?;
            }
        }
        Mark::Dots(radius) => {
            let inside = series.points.iter().filter(|p| drawable(p) && within(x, p.0) && within(y, p.1));
            context.draw_series(inside.map(|p| Circle::new(*p, *radius, ink.filled())))?;
        }
        Mark::Band(upper) => {
            let pairs: Vec<_> = series.points.iter().zip(upper).filter(|(p, u)| drawable(p) && y.holds(**u)).collect();
            let edge = pairs.iter().map(|(p, _)| **p).chain(pairs.iter().rev().map(|(p, u)| (p.0, **u)));
            context.draw_series(std::iter::once(Polygon::new(edge.collect::<Vec<_>>(), ink.mix(BAND).filled())))?;
        }
        Mark::Bars(bar_width) => {
            let floor = if y.low > 0.0 { y.low } else { 0.0 };
            let bars = series.points.iter().filter(|p| drawable(p));
            context.draw_series(bars.map(|p| {
                Rectangle::new([(p.0 - bar_width / 2.0, floor), (p.0 + bar_width / 2.0, p.1)], ink.mix(BARS).filled())
            }))?;
        }
        Mark::Whiskers(upper) => {
            let pairs = series.points.iter().zip(upper).filter(|(p, u)| drawable(p) && y.holds(**u));
            context.draw_series(pairs.map(|(p, u)| PathElement::new([*p, (p.0, *u)], ink.stroke_width(2))))?;
        }
    }
    Ok(())
}

fn within(span: &Span, value: f64) -> bool {
    (span.low..=span.high).contains(&value)
}

fn picture(raster: &Raster, chart: &Chart, frame: &Frame) -> String {
    let (x, y) = spans(chart);
    let (limit_x, limit_y) = ((frame.0.start, frame.0.end), (frame.1.end, frame.1.start));
    let (left, right) = (x.map(&raster.x.0, limit_x), x.map(&raster.x.1, limit_x));
    let (bottom, top) = (y.map(&raster.y.0, limit_y), y.map(&raster.y.1, limit_y));
    // A heat map keeps its cells; a cloud is resampled smoothly.
    let rendering = if raster.bar.is_some() { "pixelated" } else { "auto" };
    format!(
        "<image x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:{rendering}\" href=\"{}\"/>",
        right - left,
        bottom - top,
        raster.data_uri()
    )
}

fn colour_bar(area: &Area<'_>, label: &str, limits: (f64, f64), frame: &Frame) -> Result<(), Failure> {
    let (left, top, bottom) = (frame.0.end + 14, frame.1.start, frame.1.end);
    let height = (bottom - top).max(1);
    for k in 0..64 {
        let [r, g, b, _] = colour(1.0 - f64::from(k) / 63.0);
        // Each reaches to the bottom, over the ones before: edge to edge, the paper would shine through the seams.
        area.draw(&Rectangle::new([(left, top + k * height / 64), (left + 12, bottom)], RGBColor(r, g, b).filled()))?;
    }
    let span = Span { scale: super::Scale::Linear, low: limits.0, high: limits.1, marked: true };
    for tick in span.ticks() {
        let at = span.map(&tick, (bottom, top));
        area.draw_text(&span.tick_label(tick), &text(Ink::Black, 12, HPos::Left, VPos::Center), (left + 16, at))?;
    }
    let style = text(Ink::Black, 12, HPos::Center, VPos::Bottom).transform(FontTransform::Rotate90);
    area.draw_text(label, &style, (left + 52, (top + bottom) / 2))?;
    Ok(())
}
