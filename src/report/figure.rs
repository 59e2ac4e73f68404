//! Figures: a description of a chart, drawn to SVG by plotters in one uniform style.
//!
//! A figure says what is plotted (`Chart`); this module decides how it looks: ticks, legend above the data, colours that
//! follow the reader's light or dark setting. Not for computing what is plotted.

pub mod axis;
mod chart;
mod draw;
pub mod raster;
pub mod theme;

use crate::escape::xml;

pub use axis::{Axis, Scale, labelled};
pub use chart::{Chart, Mark, Note, Series};
pub use raster::Raster;
pub use theme::Ink;

impl Chart {
    /// Draws it.
    pub fn draw(&self) -> Figure {
        Figure::from_svg(draw::to_svg(self))
    }
}

/// A drawn figure.
#[derive(Debug, Clone)]
pub struct Figure {
    svg: String,
}

impl Figure {
    /// A drawing that is not a chart, e.g. a block diagram; its colours are the theme's classes (`f-ink`, `s-c1`, …).
    pub fn from_svg(svg: String) -> Self {
        Self { svg: xml(&svg).into_owned() }
    }

    /// SVG to stand inside a page that carries the theme's style.
    pub fn inline_svg(&self) -> &str {
        &self.svg
    }

    /// SVG to stand alone as a file, with its style inside.
    pub fn file_svg(&self) -> String {
        self.svg.replacen('>', &format!("><style>{}svg{{background:var(--paper)}}</style>", theme::css()), 1)
    }
}
