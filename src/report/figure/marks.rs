//! The data of a chart as SVG: one group per series, in the plot's own coordinates to a hundredth of a px.

use super::chart::{Mark, Series};
use super::frame::{Frame, hundredths};
use super::simplify::simplified;

/// No point of a curve is moved by more than this, px.
const UNSEEN_PX: f64 = 0.04;

/// Points as "x,y x,y".
fn pairs(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let pair = |(x, y): (f64, f64)| format!("{},{}", hundredths(x), hundredths(y));
    points.into_iter().map(pair).collect::<Vec<_>>().join(" ")
}

/// "x y" for a path.
fn at((x, y): (f64, f64)) -> String {
    format!("{} {}", hundredths(x), hundredths(y))
}

/// What a reader's script needs to know of a mark, and the class of its legend entry.
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
    let ink = series.ink.class();
    let runs = || series.points.split(|p| !frame.holds(p)).filter(|run| !run.is_empty());
    match &series.mark {
        Mark::Line | Mark::Dashed => {
            let class = kind(&series.mark);
            let line = |run: &[(f64, f64)]| {
                let placed: Vec<(f64, f64)> = run.iter().map(|p| frame.place(*p)).collect();
                format!("<polyline class=\"s-{ink} {class}\" points=\"{}\"/>", pairs(simplified(&placed, UNSEEN_PX)))
            };
            runs().map(line).collect()
        }
        Mark::Dots(radius) => {
            let inside = series.points.iter().filter(|p| frame.holds(p) && frame.shows(p));
            let dots: String = inside.map(|p| format!("M{}h0", at(frame.place(*p)))).collect();
            format!("<path class=\"s-{ink} dots\" stroke-width=\"{}\" d=\"{dots}\"/>", 2 * radius)
        }
        Mark::Band(upper) => {
            let both = series.points.iter().zip(upper).filter(|(p, u)| frame.holds(p) && frame.y.holds(**u));
            let (low, high): (Vec<_>, Vec<_>) = both.map(|(p, u)| (frame.place(*p), frame.place((p.0, *u)))).unzip();
            let mut edge = simplified(&low, UNSEEN_PX);
            edge.extend(simplified(&high, UNSEEN_PX).into_iter().rev());
            format!("<polygon class=\"f-{ink} band\" points=\"{}\"/>", pairs(edge))
        }
        Mark::Bars(width) => {
            let floor = if frame.y.low > 0.0 { frame.y.low } else { 0.0 };
            let bar = |p: &(f64, f64)| {
                let (left, right) = (p.0 - width / 2.0, p.0 + width / 2.0);
                let corners = [(left, floor), (left, p.1), (right, p.1), (right, floor)].map(|c| at(frame.place(c)));
                format!("M{}Z", corners.join("L"))
            };
            let bars: String = series.points.iter().filter(|p| frame.holds(p)).map(bar).collect();
            format!("<path class=\"f-{ink} bars\" d=\"{bars}\"/>")
        }
        Mark::Whiskers(upper) => {
            let both = series.points.iter().zip(upper).filter(|(p, u)| frame.holds(p) && frame.y.holds(**u));
            let whisker =
                |(p, u): (&(f64, f64), &f64)| format!("M{}L{}", at(frame.place(*p)), at(frame.place((p.0, *u))));
            format!("<path class=\"s-{ink} line\" d=\"{}\"/>", both.map(whisker).collect::<String>())
        }
    }
}
