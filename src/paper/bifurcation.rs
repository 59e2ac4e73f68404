//! Figure 20 as the paper draws it: the rectangle of figure 13 on the cubic proof mass while the
//! force of figure 17 makes its motion chaotic.
//!
//! The paper does not say how the rectangle and the periodic force come together. Here they add: a
//! vehicle accelerates for half a minute and vibrates all the while. What noise makes of it is
//! `parting`.

use super::check::Check;
use super::cubic::respond;
use super::linear::{END_S, RECTANGLE, reading};
use proofmass_physics::dynamics::duffing::{Drive, PAPER};
use proofmass_physics::dynamics::linear::MassResponse;

/// Step of integration: 800 per period of the force.
const STEP_S: f64 = 0.005;

/// The response and its checks.
#[derive(Debug, Clone)]
pub struct Bifurcation {
    /// Time and motion of the proof mass, every 20 ms.
    pub path: Vec<(f64, MassResponse)>,
    /// The periodic force of figure 17.
    pub drive: Drive,
    /// Checks of the response.
    pub checks: Vec<Check>,
}

impl Bifurcation {
    /// Reading, speed and distance of an ideal sensor.
    pub fn ideal(&self, time_s: f64) -> (f64, f64, f64) {
        let (a, b) = (RECTANGLE.ideal(time_s), self.drive.ideal(time_s));
        (a.0 + b.0, a.1 + b.1, a.2 + b.2)
    }
}

/// Computes it for the drive that figure 17 found.
pub fn compute(drive: &Drive) -> Bifurcation {
    let path = respond(&PAPER, (RECTANGLE, Some(drive)), STEP_S, END_S);
    let mut found = Bifurcation { path: Vec::new(), drive: *drive, checks: Vec::new() };
    found.checks = checks(&found, &path);
    found.path = path.into_iter().step_by(4).collect();
    found
}

fn checks(figure: &Bifurcation, path: &[(f64, MassResponse)]) -> Vec<Check> {
    // Simpson's rule over pairs of steps.
    let cubes: f64 = path
        .windows(3)
        .step_by(2)
        .map(|w| STEP_S / 3.0 * (w[0].1.x_m.powi(3) + 4.0 * w[1].1.x_m.powi(3) + w[2].1.x_m.powi(3)))
        .sum();
    let end = path.last().map_or(MassResponse::default(), |p| p.1);
    let impulse = figure.ideal(END_S).1;
    let momentum = PAPER.mass_kg * end.v_m_s
        + PAPER.damping_kg_s * end.x_m
        + PAPER.stiffness_n_m * end.integral_m_s
        + PAPER.cubic_n_m3 * cubes;
    let error = |(t, m): &(f64, MassResponse)| reading(&PAPER, m).2 - figure.ideal(*t).2;
    let huge = path.iter().find(|p| error(p).abs() > 3.0).map_or(f64::NAN, |p| p.0);
    vec![
        Check::near(
            "rectangle in the chaotic regime: momentum after 60 s less the impulse of the force / (N s)",
            "0: eq. 6 integrated over time, mv + D₀x + k∫x dt + ε∫x³ dt = ∫F dt, holds for any motion, chaotic or not; \
             Runge–Kutta with steps of 5 ms",
            0.0,
            momentum - impulse,
            1e-3,
        ),
        Check::between(
            "rectangle in the chaotic regime: time until the distance is wrong by 3 m / s",
            "the paper's error that \"becomes huge after a few seconds\": sooner than in ten, while the linear sensor of \
             figure 15 takes the whole half minute",
            0.0,
            10.0,
            huge,
        ),
    ]
}
