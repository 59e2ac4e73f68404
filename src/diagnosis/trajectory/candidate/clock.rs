//! `time-offset` and `clock-drift`: IMU and reference do not share a clock.

use super::term::{Measure, Term, Unit};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::trajectory::parameters::{DRIFT, OFFSET};

/// Library entry of `time-offset`.
pub const TIME_OFFSET: Candidate = Candidate {
    id: "time-offset",
    kind: Kind::Trajectory,
    statement: "The stamps of the IMU and those of the reference differ by a constant.",
    equation: "t_IMU = t + τ",
    parameters: &[Parameter { name: "offset", unit: "s", range: (-10.0, 10.0) }],
    acts: "clock",
    signature: "attitude errors proportional to the rate, along it",
    confusable_with: &["clock-drift", "lever-arm", "readout-lowpass"],
    reference: "Furgale, Rehder & Siegwart, IROS 2013",
};

pub(super) const CLOCK_DRIFT: Candidate = Candidate {
    id: "clock-drift",
    kind: Kind::Trajectory,
    statement: "The clock of the IMU runs faster or slower than that of the reference.",
    equation: "t_IMU = t + d (t − t_middle)",
    parameters: &[Parameter { name: "drift", unit: "ppm", range: (-1e4, 1e4) }],
    acts: "clock",
    signature: "a time offset that grows through the recording",
    confusable_with: &["time-offset"],
    reference: "Furgale, Rehder & Siegwart, IROS 2013",
};

/// `time-offset` as the fit takes it.
pub const CLOCK: Term = Term {
    candidate: &TIME_OFFSET,
    sensor: None,
    parameters: OFFSET..OFFSET + 1,
    names: &["offset"],
    unit: Unit { name: "s", per_si: 1.0 },
    measure: Measure::Plain,
    smallest: 1e-4,
    per_tilt: 0.0,
    needs: None,
};

pub(super) const TERMS: &[Term] = &[
    CLOCK,
    Term {
        candidate: &CLOCK_DRIFT,
        sensor: None,
        parameters: DRIFT..DRIFT + 1,
        names: &["drift"],
        unit: Unit { name: "ppm", per_si: 1e6 },
        measure: Measure::Plain,
        smallest: 2e-6,
        per_tilt: 0.0,
        needs: None,
    },
];
