//! Tells a further mode from lines that the first mode makes: harmonics of a nonlinear motion, the two side lines of a
//! modulated one, or part of the first line itself. It keeps a pumped spring apart from such harmonics, too.

use std::f64::consts::TAU;

use crate::driven::base::{OMEGA, ZETA};
use crate::engine::kind::{Kind, Point};
use crate::physics::library::Term;
use crate::physics::ringing_mode::RingingMode;

use super::rows::Rows;
use super::system::System;

/// Order up to which a harmonic may be as large as a mode.
const HIGHEST: u32 = 9;

/// Part of the distance between aliases that the width of lines may be.
const CROWDED: f64 = 0.1;

/// A line of a free motion: its place and half its width at half its power, rad/s.
#[derive(Debug, Clone, Copy)]
struct Line {
    omega: f64,
    half: f64,
}

impl System {
    /// Distance of the aliases of a line where one segment in some is fitted, rad/s.
    fn aliases(&self) -> Option<f64> {
        let Rows { layout, of, data, .. } = &self.rows;
        let rows = layout.counts.len() as f64 / layout.segments.len() as f64 * *of as f64;
        (*of > 1).then(|| TAU / (rows * data.interval_s()))
    }

    /// Returns whether the first mode cannot be the cause of any further mode of a set, or of a pump of its spring.
    pub(super) fn stands_alone(&self, set: &[usize], point: &Point) -> bool {
        let places = |is: fn(&Term) -> bool| (0..set.len()).filter(move |place| is(&self.members[set[*place]].term));
        let is_mode = |t: &Term| matches!(t, Term::RingingMode(mode) if *mode != RingingMode::ANY);
        let mut modes = places(is_mode).peekable();
        let mut pumps = places(|t| matches!(t, Term::PumpedStiffness(_))).peekable();
        if modes.peek().is_none() && pumps.peek().is_none() {
            return true;
        }
        let values = self.shared_values(set, point);
        let own = |place: usize| self.coordinates(set, place).start;
        let line = |omega: f64, zeta: f64| Line { omega, half: zeta * omega };
        let [omega, zeta] = [OMEGA, ZETA].map(|place| self.own(place, &values));
        let first = line(omega, zeta);
        let modes: Vec<Line> = modes.map(own).map(|i| line(values[i], values[i + 1])).collect();
        let resolution = TAU / self.scales.duration_s;
        let is_own = |pump: f64| !is_harmonic(first, &line(pump, 0.0), resolution);
        let aliases = self.aliases();
        if modes.iter().any(|mode| aliases.is_some_and(|rate| is_alias(first, mode, resolution, rate))) {
            return false;
        }
        stand_alone(first, &modes, resolution) && pumps.map(own).all(|i| is_own(values[i]))
    }
}

/// Returns whether a line may stand for the first, or for one next to it, where lines have aliases that far apart: as far
/// as those are told from each other.
fn is_alias(first: Line, line: &Line, resolution: f64, rate: f64) -> bool {
    let (reach, apart) = (line.half + first.half + resolution, (line.omega - first.omega) / rate);
    reach < CROWDED * rate && (apart - apart.round()).abs() * rate < reach
}

/// Returns whether a line may be a harmonic of the first, or the first itself.
fn is_harmonic(first: Line, line: &Line, resolution: f64) -> bool {
    let reach = line.half + first.half + resolution;
    (1..=HIGHEST).any(|n| (line.omega - f64::from(n) * first.omega).abs() < reach)
}

/// Returns whether no mode lies on a harmonic of the first, on another one, or as far to one side of the first as another
/// one to the other, as far as lines of these widths in a recording of this resolution tell.
fn stand_alone(first: Line, modes: &[Line], resolution: f64) -> bool {
    let reach = |a: &Line, b: &Line| a.half + b.half + resolution;
    modes.iter().enumerate().all(|(i, mode)| {
        let beside = |other: &Line| {
            let is_mirrored = |sum: f64| (sum - 2.0 * first.omega).abs() < reach(mode, other) + first.half;
            (mode.omega - other.omega).abs() < reach(mode, other)
                || is_mirrored(mode.omega + other.omega)
                || is_mirrored((mode.omega - other.omega).abs())
        };
        !is_harmonic(first, mode, resolution) && !modes[..i].iter().any(beside)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_side_lines_and_parts_of_a_line_are_no_modes() {
        let line = |omega: f64| Line { omega, half: 0.004 * omega };
        let stand =
            |modes: &[f64]| stand_alone(line(1.0), &modes.iter().map(|m| line(*m)).collect::<Vec<Line>>(), 0.01);
        // A beam's (6.27 and 17.5 times the first), one that beats, one below.
        assert!(stand(&[6.27, 17.5]) && stand(&[1.03]) && stand(&[0.45]) && stand(&[0.6, 1.7]));
        assert!(!stand(&[2.0]) && !stand(&[3.01]) && !stand(&[1.01]), "harmonics, and the line itself");
        // x(1 + cos Ωt): lines at 1 ± Ω, or at Ω ± 1 where the pump is the faster.
        assert!(!stand(&[0.4, 1.6]) && !stand(&[0.3, 2.3]), "side lines");
        assert!(!stand(&[2.4, 2.42]), "one line");
    }
}
