//! A chart as data: axes, series, words, a picture behind them. How it looks is decided where it is
//! drawn (`draw`).

use super::axis::Axis;
use super::raster::Raster;
use super::theme::Ink;

/// Form in which the points of a series are drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dashed line: guides, laws, closed forms.
    Dashed,
    /// Dots of this radius in px.
    Dots(u32),
    /// The area between `points` (lower edge) and these upper values.
    Band(Vec<f64>),
    /// Bars from zero (or the axis' low end); x are the bars' centres, this is their width.
    Bars(f64),
    /// Vertical bars from `points` (lower end) to these upper values: confidence intervals.
    Whiskers(Vec<f64>),
}

/// A named set of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Colour, by role.
    pub ink: Ink,
    /// Says how the points are drawn: line, dots, band, bars.
    pub mark: Mark,
    /// (x, y) in axis units. Points that are not finite, or not positive on a log axis, break the
    /// line.
    pub points: Vec<(f64, f64)>,
}

/// Words at a point of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Position in axis units.
    pub at: (f64, f64),
    /// Text of the note.
    pub text: String,
    /// Says whether the point is the text's middle; otherwise the text stands next to it.
    pub middle: bool,
    /// Says whether there is room for it on a phone.
    pub narrow: bool,
}

/// A chart with two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Short title above the plot.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Series in drawing order, back to front.
    pub series: Vec<Series>,
    /// Words in the plot.
    pub notes: Vec<Note>,
    /// Picture behind the series: a heat map or a cloud.
    pub raster: Option<Raster>,
    /// Width and height in px, with title and labels.
    pub size: (u32, u32),
    /// Says whether a unit is as long on both axes (linear ones).
    pub equal: bool,
}

impl Chart {
    /// An empty chart of the usual size.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        let (series, notes) = (Vec::new(), Vec::new());
        Self { title: title.into(), x, y, series, notes, raster: None, size: (560, 390), equal: false }
    }

    /// Adds a series and returns the chart.
    pub fn with(mut self, name: &str, ink: Ink, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        self.add(name, ink, mark, points);
        self
    }

    /// Adds a named series of (x, y) points.
    pub fn add(&mut self, name: &str, ink: Ink, mark: Mark, points: Vec<(f64, f64)>) {
        self.series.push(Series { name: name.into(), ink, mark, points });
    }

    /// Adds words centred on a point; `narrow` tells whether a phone has room for them.
    pub fn label(&mut self, at: (f64, f64), text: &str, narrow: bool) {
        self.notes.push(Note { at, text: text.into(), middle: true, narrow });
    }

    /// Adds words next to a point.
    pub fn note(&mut self, at: (f64, f64), text: &str) {
        self.notes.push(Note { at, text: text.into(), middle: false, narrow: true });
    }
}
