//! A readout that clips: the reading stays at a rail while the mass moves on.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role, StartGrid};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// A reading clipped at a lower and an upper rail.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutSaturation;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "readout-saturation",
    kind: Kind::Driven,
    statement: "The readout clips: the reading stays at a rail while the mass moves on.",
    equation: "y = min(max(x, low), high)",
    parameters: &[
        Parameter { name: "low", unit: "y", range: (-10.0, 0.0) },
        Parameter { name: "high", unit: "y", range: (0.0, 10.0) },
    ],
    acts: "readout",
    signature: "flat tops in the reading; the motion afterwards is as if nothing had happened",
    confusable_with: &["end-stop", "readout-nonlinearity", "cubic-stiffness"],
    reference: "IEEE 1293, input range and clipping",
};

impl Law for ReadoutSaturation {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Rails)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output); 2]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let (low, high) = s.output_range;
        let far = 100.0 * s.output;
        [0.9999, 0.97, 0.88, 0.7]
            .into_iter()
            .flat_map(|r| {
                let [inner_low, inner_high] = [low, high].map(|end| s.centre + r * (end - s.centre));
                [vec![inner_low, inner_high], vec![low - far, inner_high], vec![inner_low, high + far]]
            })
            .collect()
    }
    fn has_corner(&self) -> bool {
        true
    }
    /// Rails from just inside the extremes to halfway, on either side or both.
    fn start_grid(&self, s: &Scales) -> Option<StartGrid> {
        let (c, far) = (s.centre, 100.0 * s.output);
        let (low, high) = (s.output_range.0 - c, s.output_range.1 - c);
        let levels = [0.9999, 0.995, 0.985, 0.97, 0.94, 0.9, 0.86, 0.81, 0.75, 0.68, 0.6, 0.5];
        let rails = |r: f64| [vec![c + r * low, c + r * high], vec![c - far, c + r * high], vec![c + r * low, c + far]];
        Some(StartGrid::Points(levels.into_iter().flat_map(rails).collect()))
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        y.max(p[0]).min(p[1])
    }
}
