//! Figures: a description of a chart, drawn to SVG in one uniform style, its data by plotters.
//!
//! A figure says what is plotted (`Chart`); this module decides how it looks: ticks, legend above
//! the data, colours that follow the reader's light or dark setting. The same plot stands in a
//! page, where it fills the width it is given, and in a file of its own. Not for computing what is
//! plotted.

pub mod axis;
mod canvas;
mod chart;
mod frame;
mod inline;
mod legend;
mod marks;
mod name;
mod numbers;
mod plot;
pub mod raster;
mod sheet;
mod simplify;
pub mod theme;
mod tick;

use legend::Legend;
use plot::Plot;
use proofmass_base::escape::xml;

pub use axis::{Axis, Scale, labelled};
pub use chart::{Chart, Mark, Note, Series};
pub use numbers::Numbers;
pub use raster::Raster;
pub use theme::Ink;

impl Chart {
    /// Draws the chart to SVG.
    pub fn draw(&self) -> Figure {
        let legend = Legend::of(self);
        let plot = Plot::of(self, &legend);
        Figure {
            numbers: numbers::behind(self),
            inline: inline::inline(self, &legend, &plot),
            svg: xml(&sheet::sheet(self, &legend, &plot)).into_owned(),
        }
    }
}

/// A chart drawn to SVG, with the numbers behind it.
#[derive(Debug, Clone)]
pub struct Figure {
    /// One element of a page.
    inline: String,
    /// An `<svg>` element without its style.
    svg: String,
    numbers: Vec<Numbers>,
}

impl Figure {
    /// A drawing that is not a chart, e.g. a block diagram; its colours are the theme's classes
    /// (`f-ink`, `s-c1`, …).
    pub fn from_svg(svg: String) -> Self {
        let svg = xml(&svg).into_owned();
        Self { inline: format!("<div class=\"drawing\">{svg}</div>"), svg, numbers: Vec::new() }
    }

    /// The same figure, its numbers under this name; without, they have that of the chart's title.
    pub fn named(mut self, name: &str) -> Self {
        // Further tables of one chart go on from the name of the first; charts side by side keep
        // theirs.
        let first = self.numbers.first().map(|part| part.name.clone()).unwrap_or_default();
        for part in &mut self.numbers {
            part.name = match part.name.strip_prefix(&first) {
                Some(rest) => format!("{name}{rest}"),
                None => format!("{name}-{}", part.name),
            };
        }
        self
    }

    /// The numbers behind it.
    pub fn numbers(&self) -> &[Numbers] {
        &self.numbers
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
        let row = Self::from_svg(format!(
            "<svg width=\"{left}\" height=\"{height}\" viewBox=\"0 0 {left} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\">\n{inner}</svg>\n"
        ));
        Self { numbers: figures.iter().flat_map(|figure| figure.numbers.clone()).collect(), ..row }
    }

    /// The figure as one element of a page that carries the theme's style.
    pub fn inline(&self) -> &str {
        &self.inline
    }

    /// SVG to stand alone as a file, with its style inside.
    pub fn file_svg(&self) -> String {
        self.svg.replacen(
            '>',
            &format!("><style>{}svg{{background:var(--paper)}}svg svg{{background:none}}</style>", theme::css()),
            1,
        )
    }
}
