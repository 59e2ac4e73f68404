//! Draws the data with plotters: elements become SVG in hundredths of a px. Its own SVG is in whole
//! ones, on which curves are stairs.
//!
//! Colours and widths of lines belong to the page, which knows the theme: each series has a class
//! instead.

use std::convert::Infallible;

use plotters::backend::DrawingBackend;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};

use super::frame::hundredths;
use super::simplify::simplified;

/// Units of a px.
pub(super) const UNITS: f64 = 100.0;
/// No point of a curve is moved by more than this, px.
const UNSEEN_PX: f64 = 0.04;

/// Result of drawing: never a failure, as it goes into memory.
type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// The shapes of one series.
pub(super) struct Canvas<'a> {
    /// Width and height, units.
    pub(super) size: (u32, u32),
    /// Class of a curve, and of an area.
    pub(super) classes: [String; 2],
    /// Curves one by one.
    pub(super) curves: &'a mut String,
    /// Collects one path: bars, whiskers or dots.
    pub(super) path: &'a mut String,
    /// Says whether curves are part of that.
    pub(super) joined: bool,
}

fn px((x, y): BackendCoord) -> (f64, f64) {
    (f64::from(x) / UNITS, f64::from(y) / UNITS)
}

fn at(place: BackendCoord) -> String {
    let (x, y) = px(place);
    format!("{} {}", hundredths(x), hundredths(y))
}

fn pairs(points: &[(f64, f64)]) -> String {
    let pair = |(x, y): &(f64, f64)| format!("{},{}", hundredths(*x), hundredths(*y));
    points.iter().map(pair).collect::<Vec<_>>().join(" ")
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, place: BackendCoord, _: BackendColor) -> Drawn {
        *self.path += &format!("M{}h0", at(place));
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, _: &S) -> Drawn {
        *self.path += &format!("M{}L{}", at(from), at(to));
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(&mut self, low: BackendCoord, high: BackendCoord, _: &S, _: bool) -> Drawn {
        let corners = [low, (high.0, low.1), high, (low.0, high.1)].map(at);
        *self.path += &format!("M{}Z", corners.join("L"));
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, _: &S) -> Drawn {
        let path: Vec<BackendCoord> = path.into_iter().collect();
        if self.joined {
            *self.path += &format!("M{}", path.into_iter().map(at).collect::<Vec<_>>().join("L"));
            return Ok(());
        }
        let points: Vec<(f64, f64)> = path.into_iter().map(px).collect();
        let points = pairs(&simplified(&points, UNSEEN_PX));
        *self.curves += &format!("<polyline class=\"{}\" points=\"{points}\"/>", self.classes[0]);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, _: u32, style: &S, _: bool) -> Drawn {
        self.draw_pixel(centre, style.color())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, edge: I, _: &S) -> Drawn {
        let points: Vec<(f64, f64)> = edge.into_iter().map(px).collect();
        // There along the lower edge and back along the upper one, each as a curve of its own.
        let (there, back) = points.split_at(points.len() / 2);
        let points = [simplified(there, UNSEEN_PX), simplified(back, UNSEEN_PX)].concat();
        *self.curves += &format!("<polygon class=\"{}\" points=\"{}\"/>", self.classes[1], pairs(&points));
        Ok(())
    }
}
