//! Shows what an engineer would see of a law, from the law itself: a force over what it depends on, its loop
//! under one sine, the response to an input, the reading over time or over the true value.
//!
//! The role of a law, and what its force or reading depends on, decide which picture it gets: a new law needs
//! no line here. All pictures use one mass with a quality factor of ten and show shapes only: sizes are divided
//! by the largest, times and frequencies by those of the recording and of the resonance. Not for drawing.

mod acting;
mod cycle;
mod linear;
mod noise;
mod picture;
mod resonance;

use super::candidate::{Candidate, Kind};
use super::law::{Place, Role};
use super::library::Term;
use acting::{Acting, Argument, At};

use picture::POINTS;

pub use noise::next_to_white;
pub use picture::{Axis, Curve, Picture, over_largest};

/// Returns what shows of a candidate whose law is in the library.
pub fn of(candidate: &Candidate) -> Option<Picture> {
    let term = Term::all().into_iter().find(|term| term.id() == candidate.id)?;
    let acting = Acting::new(term);
    match candidate.kind {
        Kind::Response => resonance::at_three_drives(&acting).or_else(|| on_a_mass(&acting)),
        Kind::Trajectory => without_a_mass(&acting),
        Kind::Driven | Kind::Static | Kind::Tumble => on_a_mass(&acting),
    }
}

/// Shows a law on a proof mass or behind it.
fn on_a_mass(acting: &Acting) -> Option<Picture> {
    match acting.term.role() {
        Role::Noise(which) => return noise::of(which),
        Role::Lattice => return Some(staircase()),
        Role::InputDelay => return linear::late(acting, 1.0),
        Role::InputLead => return linear::late(acting, -1.0),
        Role::Filter(_) => return linear::of_prescribed(acting),
        _ => {}
    }
    if let Some(picture) = linear::of(acting) {
        return Some(picture);
    }
    if acting.term.role() == Role::Readout(Place::Bias) {
        return Some(over_time(acting));
    }
    if !acting.term.role().acts_on_mass() {
        return Some(true_and_read(acting));
    }
    match acting.argument() {
        Some(argument) => Some(over(acting, argument)),
        None => cycle::of(acting),
    }
}

/// Shows a readout whose true value is known from elsewhere.
fn without_a_mass(acting: &Acting) -> Option<Picture> {
    match acting.term.role() {
        Role::Filter(_) => linear::of_prescribed(acting),
        Role::Readout(_) => Some(true_and_read(acting)),
        _ => None,
    }
}

/// Values from −1 to 1, zero among them.
fn both_ways() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|i| 2.0 * i as f64 / (POINTS - 1) as f64 - 1.0)
}

/// The line of what is in proportion.
fn proportion(name: &'static str) -> Curve {
    Curve { name, is_guide: true, points: vec![(-1.0, -1.0), (1.0, 1.0)] }
}

/// A force over the one thing that it depends on.
fn over(acting: &Acting, argument: Argument) -> Picture {
    let (x, y, sign) = match argument {
        Argument::Displacement => ("displacement / largest", "extra force back / largest", -1.0),
        Argument::Velocity => ("velocity / largest", "extra force against the motion / largest", -1.0),
        Argument::Input => ("input / largest", "extra driving force / largest", 1.0),
    };
    let most = acting::LARGEST;
    let points = both_ways().map(|part| (part, sign * acting.force(&At::only(argument, part * most), &[0.0; 3]).0));
    let law = Curve { name: "", is_guide: false, points: over_largest(points.collect()) };
    Picture { x: Axis::linear(x), y: Axis::linear(y), curves: vec![proportion("in proportion"), law] }
}

/// The reading over the true value.
fn true_and_read(acting: &Acting) -> Picture {
    let most = acting::LARGEST;
    let read = |part: f64| acting.reading(&At::default(), &[0.0; 3], part * most) / most;
    reading_over_true(both_ways().map(|part| (part, read(part))).collect())
}

fn reading_over_true(points: Vec<(f64, f64)>) -> Picture {
    let law = Curve { name: "read", is_guide: false, points };
    let (x, y) = (Axis::linear("true value / largest"), Axis::linear("reading / largest true value"));
    Picture { x, y, curves: vec![proportion("true"), law] }
}

/// Steps in the picture of a reading that is rounded, over the largest value.
const STEPS: f64 = 4.0;

/// The values of a reading that is rounded to the nearest of a lattice.
pub fn staircase() -> Picture {
    reading_over_true(both_ways().map(|part| (part, (STEPS * part).round() / STEPS)).collect())
}

/// An offset of the reading while it is recorded.
fn over_time(acting: &Acting) -> Picture {
    let length_s = acting.scales.duration_s;
    let at = |part: f64| acting.reading(&At { time_s: part * length_s, ..At::default() }, &[0.0; 3], 0.0);
    let points = (0..POINTS).map(|i| i as f64 / (POINTS - 1) as f64).map(|part| (part, at(part)));
    let law = Curve { name: "", is_guide: false, points: over_largest(points.collect()) };
    let (x, y) = (Axis::linear("time / length of the recording"), Axis::linear("extra reading / largest"));
    let none = Curve { name: "", is_guide: true, points: vec![(0.0, 0.0), (1.0, 0.0)] };
    Picture { x, y, curves: vec![none, law] }
}

#[cfg(test)]
mod tests;
