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

    /// Figures side by side as one; each keeps its own size.
    pub fn row(figures: &[Figure]) -> Self {
        let size = |figure: &Figure, key: &str| -> f64 {
            let value = figure.svg.split_once(&format!(" {key}=\"")).and_then(|(_, rest)| rest.split_once('"'));
            value.and_then(|(number, _)| number.parse().ok()).unwrap_or(0.0)
        };
        let (mut left, mut height, mut inner) = (0.0, 0.0f64, String::new());
        for figure in figures {
            inner += &figure.svg.replacen("<svg ", &format!("<svg x=\"{left}\" "), 1);
            left += size(figure, "width");
            height = height.max(size(figure, "height"));
        }
        Self {
            svg: format!(
                "<svg width=\"{left}\" height=\"{height}\" viewBox=\"0 0 {left} {height}\" \
                 xmlns=\"http://www.w3.org/2000/svg\">\n{inner}</svg>\n"
            ),
        }
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
