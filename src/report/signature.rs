//! Draws what an engineer would see of a candidate: a picture for each whose law or closed form is in the
//! workspace.
//!
//! Laws come from `physics::signature`, which reads each off its own file; of a sensor at rest and of one that is
//! hand-rotated or flown the closed forms are put into the same axes here. What is one number has no picture.

mod attitude;
mod motion;
mod rest;

use proofmass_physics::candidate::{Candidate, Kind};
use proofmass_physics::signature::{self, Axis as Along, Curve, Picture};

use super::figure::{Axis, Chart, Figure, Ink, Mark};

/// Width and height of a picture, px: it keeps its size on a phone.
const SIZE: (u32, u32) = (360, 280);

/// Returns the picture of a candidate, if it has one.
pub fn figure(candidate: &Candidate) -> Option<Figure> {
    let own = match candidate.kind {
        Kind::Static => rest::picture(candidate.id),
        Kind::Tumble => attitude::picture(candidate),
        Kind::Trajectory => attitude::picture(candidate).or_else(|| motion::picture(candidate.id)),
        Kind::Driven | Kind::Response => None,
    };
    Some(drawn(candidate.id, own.or_else(|| signature::of(candidate))?))
}

/// The name of its file.
pub fn file(candidate: &Candidate) -> String {
    format!("{}-{}.svg", candidate.kind.name(), candidate.id)
}

fn drawn(title: &str, picture: Picture) -> Figure {
    let axis = |along: Along| if along.is_log { Axis::log(along.label) } else { Axis::linear(along.label) };
    let mut chart = Chart { size: SIZE, ..Chart::new(title, axis(picture.x), axis(picture.y)) };
    let mut inks = (0..).map(Ink::nth);
    for Curve { name, is_guide, points } in picture.curves {
        let (ink, mark) = match is_guide {
            true => (Ink::Soft, Mark::Dashed),
            false => (inks.next().unwrap_or(Ink::Blue), Mark::Line),
        };
        chart.add(name, ink, mark, points);
    }
    chart.draw()
}
