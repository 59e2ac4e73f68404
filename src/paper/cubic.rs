//! Figure 16: the same rectangle on a proof mass with a cubic spring (eq. 6).
//!
//! There is no closed form; Runge–Kutta is held against itself at half the step and against the
//! equilibrium it must reach.

use super::check::{Check, Exhibit};
use super::linear::{END_S, RECTANGLE};
use proofmass_physics::dynamics::duffing::{Drive, Oscillator, PAPER, State};
use proofmass_physics::dynamics::linear::{MassResponse, Rectangle, rectangle_response};

/// Curves and checks of figure 16.
#[derive(Debug, Clone)]
pub struct Cubic {
    /// Time and motion of the cubic proof mass.
    pub cubic: Vec<(f64, MassResponse)>,
    /// Time and motion of the linear one.
    pub linear: Vec<(f64, MassResponse)>,
    /// Figure 16 with its checks.
    pub exhibit: Exhibit,
}

/// Time and motion at every step; the integrals are Simpson's, of the order of Runge–Kutta itself.
/// Edges of the rectangle fall on steps; a periodic force may act besides.
pub(super) fn respond(
    oscillator: &Oscillator,
    (rectangle, drive): (Rectangle, Option<&Drive>),
    step_s: f64,
    end_s: f64,
) -> Vec<(f64, MassResponse)> {
    let mut motion = MassResponse::default();
    let mut path = vec![(0.0, motion)];
    for step in 0..(end_s / step_s).round() as u32 {
        let held = rectangle.at_n((f64::from(step) + 0.5) * step_s);
        let force = |part: f64| held + drive.map_or(0.0, |d| d.at_n((f64::from(step) + part) * step_s));
        let state = State { x_m: motion.x_m, v_m_s: motion.v_m_s };
        let middle = oscillator.step(state, 0.5 * step_s, [0.0, 0.25, 0.5].map(force));
        let end = oscillator.step(middle, 0.5 * step_s, [0.5, 0.75, 1.0].map(force));
        let (a, b, c) = (state.x_m, middle.x_m, end.x_m);
        motion = MassResponse {
            x_m: end.x_m,
            v_m_s: end.v_m_s,
            integral_m_s: motion.integral_m_s + step_s / 6.0 * (a + 4.0 * b + c),
            // ∫₀ʰ∫₀ˢ x with x the parabola through a, b, c.
            double_integral_m_s2: motion.double_integral_m_s2
                + step_s * motion.integral_m_s
                + step_s * step_s * (a / 6.0 + b / 3.0),
        };
        path.push((f64::from(step + 1) * step_s, motion));
    }
    path
}

/// Computes the figure.
pub fn compute() -> Cubic {
    let cubic = respond(&PAPER, (RECTANGLE, None), 0.02, END_S);
    let linear = cubic.iter().map(|(t, _)| (*t, rectangle_response(&PAPER.linear(), RECTANGLE, *t))).collect();
    let exhibit = Exhibit::simulated(16, "The same rectangle on a cubic spring", checks());
    Cubic { cubic, linear, exhibit }
}

fn last(path: &[(f64, MassResponse)]) -> MassResponse {
    path.last().map_or(MassResponse::default(), |p| p.1)
}

fn checks() -> Vec<Check> {
    let end = |h: f64| last(&respond(&PAPER, (RECTANGLE, None), h, END_S)).x_m;
    let (coarse, fine, finest) = (end(0.2), end(0.1), end(0.0125));
    let long = Rectangle { length_s: 400.0, ..RECTANGLE };
    let held = last(&respond(&PAPER, (long, None), 0.05, 400.0)).x_m;
    // Small ε: the departure from the exact linear solution is proportional to it.
    let departure = |cubic_n_m3: f64| {
        let slightly = Oscillator { cubic_n_m3, ..PAPER };
        let exact = rectangle_response(&PAPER.linear(), RECTANGLE, 30.0);
        last(&respond(&slightly, (RECTANGLE, None), 0.02, 30.0)).integral_m_s - exact.integral_m_s
    };
    vec![
        Check::near(
            "Runge–Kutta: order of convergence of the displacement, steps of 0.2 s and 0.1 s",
            "classic Runge–Kutta is of order 4; reference at 0.0125 s",
            4.0,
            ((coarse - finest) / (fine - finest)).abs().log2(),
            0.2,
        ),
        Check::near(
            "deflection under a lasting force of 1 N / m",
            "the real root of kx + εx³ = F₀, by Newton's method",
            PAPER.equilibrium_m(1.0),
            held,
            1e-6,
        ),
        Check::near(
            "speed departure from the linear sensor: ratio between ε = 0.002 and ε = 0.001",
            "first-order perturbation: proportional to ε as ε tends to nothing, where eq. 6 becomes eq. 4",
            2.0,
            departure(0.002) / departure(0.001),
            0.02,
        ),
    ]
}
