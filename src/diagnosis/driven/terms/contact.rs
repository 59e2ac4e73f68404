//! A stop that the mass runs into.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Cloud, Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// Which side has a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Both, at the same distance.
    Both,
    /// Positive displacement.
    Upper,
    /// Negative displacement.
    Lower,
}

impl Side {
    /// How far the reading gets on this side.
    fn reach(self, s: &Scales) -> f64 {
        let (below, above) = (s.centre - s.output_range.0, s.output_range.1 - s.centre);
        match self {
            Side::Both => above.max(below),
            Side::Upper => above,
            Side::Lower => below,
        }
    }
}

/// Elastic contact beyond a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop(pub Side);

/// What the library says of it.
pub const END_STOP: Candidate = Candidate {
    id: "end-stop",
    kind: Kind::Driven,
    statement: "Beyond a gap the mass runs into a stop, on one side or both.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_c (x − gap)₊ = g·u (mirrored for the other side)",
    parameters: &[
        Parameter { name: "k_c", unit: "1/s^2", range: (0.3, 1000.0) },
        Parameter { name: "gap", unit: "y", range: (0.0, 5.0) },
    ],
    acts: "equation of motion",
    signature: "residual only near and just after the largest displacements; the tops of the reading are flattened",
    confusable_with: &["readout-saturation", "cubic-stiffness", "quadratic-stiffness"],
    reference: "Shaw & Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90 (1983)",
};

impl Physics for EndStop {
    fn words(&self) -> &'static Candidate {
        &END_STOP
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let spring = s.omega_rad_s.powi(2);
        // Softer than this is a bend in the spring, not a stop.
        vec![Coordinate::Log(0.3 * spring, 1e3 * spring), Coordinate::Log(0.3 * s.output, 10.0 * s.output)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let reach = self.0.reach(s);
        let spring = s.omega_rad_s.powi(2);
        [0.55, 0.7, 0.8, 0.88, 0.95]
            .into_iter()
            .flat_map(|r| [1.0, 10.0].map(|k| vec![k * spring, r * reach.max(0.5 * s.output)]))
            .collect()
    }
    /// Harder and further away, softer and nearer: the same energy goes into it where the mass gets furthest.
    fn elsewhere(&self, p: &[f64], s: &Scales) -> Vec<Vec<f64>> {
        let reach = self.0.reach(s);
        let depth = (reach - p[1]).max(0.0);
        [0.25, 4.0, 16.0].map(|harder| vec![harder * p[0], reach - depth / f64::sqrt(harder)]).to_vec()
    }
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        (p[0].max(0.0) + s.omega_rad_s.powi(2)).sqrt().min(7.0 * s.omega_rad_s)
    }
    fn has_corner(&self) -> bool {
        true
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        // Sides as factors, slices opened: a branch or a bounds check in the loop keeps it from becoming vector code.
        let (stop, gap) = (&p[0], &p[1]);
        let [upper, lower] = [Side::Lower, Side::Upper].map(|other| if self.0 == other { 0.0 } else { 1.0 });
        for l in 0..LANES {
            let (above, below) = ((at.x[l] - gap[l]).max(0.0), (-at.x[l] - gap[l]).max(0.0));
            acceleration[l] -= stop[l] * (upper * above - lower * below);
        }
    }
    fn moves(&self) -> bool {
        true
    }
    /// Gaps from where the mass often is to where it hardly ever gets; stops from a bend to a wall.
    fn cloud(&self, s: &Scales) -> Option<Cloud> {
        let (spring, reach) = (s.omega_rad_s.powi(2), self.0.reach(s).max(0.5 * s.output));
        let gaps = [0.3, 0.4, 0.5, 0.58, 0.66, 0.73, 0.79, 0.84, 0.88, 0.92, 0.95, 0.975, 0.99];
        let stops = [0.6, 2.0, 6.0, 18.0];
        Some(Cloud::Points(gaps.iter().flat_map(|g| stops.map(|k| vec![k * spring, g * reach])).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // ½ k (reach − gap)² is the same in every valley.
    #[test]
    fn other_valleys_take_up_the_same_energy() {
        let scales = Scales {
            output: 1.0,
            output_range: (-1.5, 2.0),
            velocity: 1.0,
            input: 1.0,
            omega_rad_s: 3.0,
            zeta: 0.1,
            gain: 1.0,
            interval_s: 0.1,
            duration_s: 100.0,
            residual: 0.1,
            lines_hz: Vec::new(),
            environment: Vec::new(),
            centre: 0.0,
            fineness: 1.0,
            lag_samples: 0.0,
        };
        let energy = |p: &[f64], reach: f64| p[0] * (reach - p[1]).powi(2);
        for (side, reach) in [(Side::Both, 2.0), (Side::Upper, 2.0), (Side::Lower, 1.5)] {
            let here = [40.0, 1.2];
            for p in EndStop(side).elsewhere(&here, &scales) {
                assert!((energy(&p, reach) / energy(&here, reach) - 1.0).abs() < 1e-12, "{side:?} {p:?}");
            }
        }
    }
}
