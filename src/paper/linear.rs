//! Figures 13 to 15: a linear accelerometer under a rectangle of acceleration, exactly and by
//! integrators.
//!
//! Not noisy: everything here is an error of the mechanics alone.

use super::check::{Check, Exhibit};
use proofmass_numerics::numerics::moments::mean;
use proofmass_physics::dynamics::duffing::{Oscillator, PAPER, State};
use proofmass_physics::dynamics::estimate::slope;
use proofmass_physics::dynamics::linear::{
    MassResponse, Rectangle, exact_hold, hold_step, printed_roots, rectangle_response, residual_n, roots,
};

/// One metre per second squared for half a minute. The paper prints neither; only ratios matter in
/// a linear equation.
pub(crate) const RECTANGLE: Rectangle = Rectangle { force_n: 1.0, start_s: 1.0, length_s: 30.0 };
/// States how far the figures reach.
pub(crate) const END_S: f64 = 60.0;

/// Curves and checks of figures 13 to 15.
#[derive(Debug, Clone)]
pub struct Linear {
    /// The exact response at every `0.02` s: time and motion.
    pub exact: Vec<(f64, MassResponse)>,
    /// The same by Runge–Kutta with coarse steps.
    pub runge_kutta: Vec<(f64, f64)>,
    /// Holds what eq. 5 leaves over when put into eq. 4: (time, as printed, with the right roots),
    /// N.
    pub residuals: Vec<(f64, f64, f64)>,
    /// (time constant D₀/k in s, final displacement error in m).
    pub error_by_time_constant: Vec<(f64, f64)>,
    /// Figures 13, 14, 15.
    pub exhibits: [Exhibit; 3],
}

/// The reading a proof mass gives, and its integrals, scaled to acceleration: k/m times
/// displacement.
pub fn reading(oscillator: &Oscillator, motion: &MassResponse) -> (f64, f64, f64) {
    let scale = oscillator.stiffness_n_m / oscillator.mass_kg;
    (scale * motion.x_m, scale * motion.integral_m_s, scale * motion.double_integral_m_s2)
}

/// x at the end of a run of Runge–Kutta steps; edges of the rectangle fall on steps.
fn runge_kutta(oscillator: &Oscillator, step_s: f64, end_s: f64) -> Vec<(f64, f64)> {
    let mut state = State::default();
    let steps = (end_s / step_s).round() as u32;
    let mut path = vec![(0.0, 0.0)];
    for step in 0..steps {
        let force = RECTANGLE.at_n((f64::from(step) + 0.5) * step_s);
        state = oscillator.step(state, step_s, [force; 3]);
        path.push((f64::from(step + 1) * step_s, state.x_m));
    }
    path
}

/// Computes all three figures.
pub fn compute() -> Linear {
    let oscillator = PAPER.linear();
    let exact: Vec<(f64, MassResponse)> = (0..=(END_S / 0.02) as u32)
        .map(|i| f64::from(i) * 0.02)
        .map(|t| (t, rectangle_response(&oscillator, RECTANGLE, t)))
        .collect();
    let residuals: Vec<(f64, f64, f64)> = (0..=800)
        .map(|i| f64::from(i) * 0.05)
        .map(|t| {
            let residual = |r| residual_n(&oscillator, r, RECTANGLE.force_n, t);
            (t, residual(printed_roots(&oscillator)), residual(roots(&oscillator)))
        })
        .collect();
    // Long after the rectangle, when the ringing has died: the displacement error that stays.
    let error_by_time_constant: Vec<(f64, f64)> = (1..=16)
        .map(|i| {
            let oscillator = Oscillator { damping_kg_s: 0.1 * f64::from(i), ..oscillator };
            let late = END_S + 400.0;
            let (_, _, distance) = reading(&oscillator, &rectangle_response(&oscillator, RECTANGLE, late));
            (oscillator.damping_kg_s / oscillator.stiffness_n_m, distance - RECTANGLE.ideal(late).2)
        })
        .collect();
    let exhibits = [
        Exhibit::simulated(
            13,
            "A linear accelerometer under a rectangle of acceleration",
            figure_13_checks(&oscillator, &residuals),
        ),
        Exhibit::simulated(14, "The edges enlarged: overshoot and lag", figure_14_checks(&oscillator)),
        Exhibit::simulated(
            15,
            "The distance error of a perfect linear sensor",
            figure_15_checks(&exact, &error_by_time_constant),
        ),
    ];
    Linear { runge_kutta: runge_kutta(&oscillator, 0.25, END_S), exact, residuals, error_by_time_constant, exhibits }
}

fn figure_13_checks(oscillator: &Oscillator, residuals: &[(f64, f64, f64)]) -> Vec<Check> {
    let at_end = rectangle_response(oscillator, RECTANGLE, END_S);
    let map = exact_hold(oscillator, 0.1);
    let held = (0..(END_S / 0.1).round() as u32)
        .fold(MassResponse::default(), |m, i| hold_step(&map, m, RECTANGLE.at_n((f64::from(i) + 0.5) * 0.1)));
    let error = |h: f64| runge_kutta(oscillator, h, END_S).last().map_or(f64::NAN, |p| p.1) - at_end.x_m;
    let largest = |pick: fn(&(f64, f64, f64)) -> f64| residuals.iter().map(pick).fold(0.0, |a: f64, b| a.max(b.abs()));
    vec![
        Check::near(
            "exact-hold map: difference of the distance from the closed form at 60 s / m",
            "two derivations of one solution: matrix exponential and characteristic roots; rounding over 600 steps",
            0.0,
            held.double_integral_m_s2 - at_end.double_integral_m_s2,
            1e-8,
        ),
        Check::near(
            "Runge–Kutta: order of convergence from steps of 0.1 s and 0.05 s",
            "classic Runge–Kutta is of order 4 while the force is constant within every step",
            4.0,
            (error(0.1) / error(0.05)).abs().log2(),
            0.15,
        ),
        Check::near(
            "eq. 5 with the roots (−D₀ ± √(D₀² − 4km))/2m: largest residual in eq. 4 / N",
            "a solution leaves nothing; rounding",
            0.0,
            largest(|r| r.2),
            1e-12,
        ),
        Check::near(
            "eq. 5 as printed: largest residual in eq. 4 / N",
            "with m = 1 the printed exponents are ±i√k: an undamped swing, which leaves D₀x′, at most D₀F₀/√k",
            oscillator.damping_kg_s * RECTANGLE.force_n / oscillator.stiffness_n_m.sqrt(),
            largest(|r| r.1),
            1e-4,
        ),
    ]
}

fn figure_14_checks(oscillator: &Oscillator) -> Vec<Check> {
    let zeta = oscillator.damping_kg_s / (2.0 * (oscillator.stiffness_n_m * oscillator.mass_kg).sqrt());
    let peak = runge_kutta(oscillator, 0.01, 8.0).iter().map(|p| p.1).fold(0.0, f64::max);
    // Mean lag of the speed while the rectangle lasts, over the second half, where whole swings
    // average out.
    let lag: Vec<f64> = (0..1000)
        .map(|i| {
            let t = RECTANGLE.start_s + 200.0 + 0.02 * std::f64::consts::PI * f64::from(i);
            let long = Rectangle { length_s: 400.0, ..RECTANGLE };
            reading(oscillator, &rectangle_response(oscillator, long, t)).1 - long.ideal(t).1
        })
        .collect();
    let lag = mean(&lag);
    vec![
        Check::near(
            "first peak of the reading over the step",
            "1 + exp(−πζ/√(1 − ζ²)), the overshoot of a second-order system, with ζ = D₀/(2√(km)) = 0.05",
            1.0 + (-std::f64::consts::PI * zeta / (1.0 - zeta * zeta).sqrt()).exp(),
            peak,
            1e-4,
        ),
        Check::near(
            "speed error while the force lasts / (m/s)",
            "−(D₀/k)·a: the sensor's transfer function is 1 − (D₀/k)s + … at low frequency, a pure delay of D₀/k",
            -oscillator.damping_kg_s / oscillator.stiffness_n_m * RECTANGLE.force_n,
            lag,
            1e-3,
        ),
    ]
}

fn figure_15_checks(exact: &[(f64, MassResponse)], by_time_constant: &[(f64, f64)]) -> Vec<Check> {
    let oscillator = PAPER.linear();
    let end = RECTANGLE.start_s + RECTANGLE.length_s;
    // Over the last four swings before the edge, which a straight line averages out.
    let window: Vec<(f64, f64)> = exact
        .iter()
        .filter(|(t, _)| *t > end - 8.0 * std::f64::consts::PI && *t <= end)
        .map(|(t, m)| (*t, reading(&oscillator, m).2 - RECTANGLE.ideal(*t).2))
        .collect();
    let speed = slope(&window).value;
    vec![
        Check::near(
            "final distance error per second of time constant / (m/s)",
            "−a·T for a rectangle a of length T: the delay D₀/k times the speed reached (final-value theorem)",
            -RECTANGLE.force_n * RECTANGLE.length_s,
            slope(by_time_constant).value,
            0.01,
        ),
        Check::near(
            "final distance error at the paper's D₀ = 0.1, k = 1 / m",
            "−(D₀/k)·a·T = −3 m: the paper's \"several metres after several dozen seconds\"",
            -3.0,
            by_time_constant.first().map_or(f64::NAN, |p| p.1),
            0.01,
        ),
        Check::near(
            "distance error per second while the force lasts / (m/s)",
            "−(D₀/k)·a, the lag of the speed, summed up; what the decaying swings add over four of them is below 0.02 m/s",
            -oscillator.damping_kg_s / oscillator.stiffness_n_m * RECTANGLE.force_n,
            speed,
            0.02,
        ),
    ]
}
