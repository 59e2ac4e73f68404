//! Describes where values lie in a plot: both axes with their limits, and the plot's own
//! coordinates.

use super::axis::{Scale, Span};
use super::chart::{Chart, Mark};

/// Axes of a chart with their limits, over a plot of a nominal size in px. A page may stretch it.
pub(super) struct Frame {
    pub(super) x: Span,
    pub(super) y: Span,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Size that a chart needs besides the plot: labels of the axes, title and legend, px.
const BESIDE: (u32, u32) = (80, 110);

impl Frame {
    pub(super) fn of(chart: &Chart) -> Self {
        let (mut x, mut y) = spans(chart);
        let size = (chart.size.0.max(240) - BESIDE.0, chart.size.1.max(190) - BESIDE.1);
        let (width, mut height) = (f64::from(size.0), f64::from(size.1));
        if chart.equal {
            let half = 0.5 * (x.high - x.low).max(y.high - y.low);
            for span in [&mut x, &mut y] {
                let middle = 0.5 * (span.low + span.high);
                (span.low, span.high) = (middle - half, middle + half);
            }
            height = width;
        }
        Self { x, y, width, height }
    }

    /// Per cent of the width, from the left.
    pub(super) fn x_percent(&self, value: f64) -> f64 {
        100.0 * self.x.fraction(value)
    }

    /// Per cent of the height, from the top.
    pub(super) fn y_percent(&self, value: f64) -> f64 {
        100.0 * (1.0 - self.y.fraction(value))
    }

    /// px from the top left corner.
    pub(super) fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x_percent(x) * 0.01 * self.width, self.y_percent(y) * 0.01 * self.height)
    }

    /// Returns whether a point lies on both axes at all (a logarithmic one has no zero).
    pub(super) fn holds(&self, p: &(f64, f64)) -> bool {
        self.x.holds(p.0) && self.y.holds(p.1)
    }

    /// Returns whether a point lies within the frame.
    pub(super) fn shows(&self, p: &(f64, f64)) -> bool {
        (self.x.low..=self.x.high).contains(&p.0) && (self.y.low..=self.y.high).contains(&p.1)
    }
}

/// A number of px or per cent, to a thousandth.
pub(super) fn thousandths(value: f64) -> String {
    decimal(value, 3)
}

/// A number of px, to a hundredth.
pub(super) fn hundredths(value: f64) -> String {
    decimal(value, 2)
}

fn decimal(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
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
    let mut x = chart.x.fitted(xs.chain(raster.clone().flat_map(|r| [r.x.0, r.x.1])));
    let mut y = chart.y.fitted(ys.chain(raster.flat_map(|r| [r.y.0, r.y.1])));
    if let Some(r) = &chart.raster {
        if chart.x.range.is_none() {
            (x.low, x.high) = r.x;
        }
        if chart.y.range.is_none() {
            (y.low, y.high) = r.y;
        }
    }
    let bars = chart.series.iter().any(|s| matches!(s.mark, Mark::Bars(_)));
    if bars && chart.y.range.is_none() && y.scale == Scale::Linear && y.low < 0.0 {
        let lowest = chart.series.iter().flat_map(|s| &s.points).map(|p| p.1).fold(0.0, f64::min);
        y.low = if lowest < 0.0 { y.low } else { 0.0 };
    }
    (x, y)
}
