//! A picture as data: axes and curves.

/// One line of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Words for a legend; empty for none.
    pub name: &'static str,
    /// Says whether it is what would be there without the law.
    pub is_guide: bool,
    /// Points, in order.
    pub points: Vec<(f64, f64)>,
}

/// An axis of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axis {
    /// Quantity and what it is measured by.
    pub label: &'static str,
    /// Says whether it is logarithmic.
    pub is_log: bool,
}

impl Axis {
    /// An axis with even spacing.
    pub const fn linear(label: &'static str) -> Self {
        Self { label, is_log: false }
    }

    /// A logarithmic axis.
    pub const fn log(label: &'static str) -> Self {
        Self { label, is_log: true }
    }
}

/// Curves over common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Curves, back to front.
    pub curves: Vec<Curve>,
}

/// Number of points of a curve that has no corner known beforehand.
pub(super) const POINTS: usize = 401;

/// Divides the second numbers by the largest of their sizes; leaves them where all are zero.
pub fn over_largest(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let most = points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
    points.into_iter().map(|(x, y)| (x, if most > 0.0 { y / most } else { y })).collect()
}
