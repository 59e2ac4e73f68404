//! Turns values into coordinates and back, and says which of a law's are its strength.

use std::ops::Range;

use crate::physics::free_form::Freed;
use crate::physics::library::Term;
use crate::physics::pumped_stiffness::PumpedStiffness;
use crate::physics::ringing_mode::RingingMode;
use crate::physics::scales::Coordinate;

/// Returns which of a law's parameters are its strength.
pub(super) fn strengths(term: &Term) -> Range<usize> {
    match term {
        Term::ReadoutSaturation(_) => 0..0,
        Term::RingingMode(_) => RingingMode::SIZES,
        Term::PumpedStiffness(_) => PumpedStiffness::SIZES,
        Term::ReadoutNonlinearity(_) | Term::PeriodicDisturbance(_) => 0..2,
        Term::FreeForm(form) if form.law == Freed::Readout => 0..3,
        _ => 0..1,
    }
}

/// Those of these coordinates that are a law's strength.
pub(super) fn strong(term: &Term, coordinates: Range<usize>) -> Range<usize> {
    let own = strengths(term);
    coordinates.start + own.start..(coordinates.start + own.end).min(coordinates.end)
}

/// The value at a coordinate.
pub(in crate::driven) fn value(coordinate: Coordinate, z: f64) -> f64 {
    match coordinate {
        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => z * scale,
        Coordinate::Log(..) => z.exp(),
        Coordinate::Held => z,
    }
}

/// The coordinate of a value.
pub(in crate::driven) fn z(coordinate: Coordinate, value: f64) -> f64 {
    match coordinate {
        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => value / scale,
        Coordinate::Log(low, high) => value.clamp(low, high).ln(),
        Coordinate::Held => value,
    }
}
