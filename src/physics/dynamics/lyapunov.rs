//! Both Lyapunov exponents of the forced Duffing oscillator, in f64, one orbit at a time: the
//! oracle of the lanes.
//!
//! Two tangent vectors are carried along and made orthogonal again once per forcing period
//! (Benettin et al., Meccanica 15, 1980; Wolf et al., Physica D 16, 1985). The third exponent of
//! the forced system, along time, is zero. Not for maps.

use super::duffing::{Drive, Oscillator, State};

/// Transient and averaging time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Runge–Kutta steps per forcing period.
    pub steps_per_period: u32,
    /// Periods before counting; the tangent vectors turn into their directions during them.
    pub transient_periods: u32,
    /// Number of periods in the average.
    pub periods: u32,
}

/// The exponents λ₁ ≥ λ₂, 1/s. Their sum is −D₀/m for every orbit (the divergence of the flow),
/// whatever the force.
pub fn spectrum(oscillator: &Oscillator, drive: &Drive, start: State, span: Span) -> [f64; 2] {
    let table = drive.table_n(span.steps_per_period);
    let h = drive.period_s() / f64::from(span.steps_per_period);
    let mut state = start;
    let mut tangents = [[1.0, 0.0], [0.0, 1.0]];
    let mut sums = [0.0; 2];
    for period in 0..span.transient_periods + span.periods {
        for j in 0..span.steps_per_period as usize {
            let force = [table[2 * j], table[2 * j + 1], table[2 * j + 2]];
            (state, tangents) = step(oscillator, state, tangents, h, force);
        }
        let [first, second] = tangents;
        let length = first[0].hypot(first[1]);
        let unit = [first[0] / length, first[1] / length];
        let along = second[0] * unit[0] + second[1] * unit[1];
        let rest = [second[0] - along * unit[0], second[1] - along * unit[1]];
        let width = rest[0].hypot(rest[1]);
        tangents = [unit, [rest[0] / width, rest[1] / width]];
        if period >= span.transient_periods {
            sums[0] += length.ln();
            sums[1] += width.ln();
        }
    }
    sums.map(|s| s / (f64::from(span.periods) * drive.period_s()))
}

type Tangents = [[f64; 2]; 2];

/// One Runge–Kutta step of the orbit and both tangent vectors.
fn step(oscillator: &Oscillator, state: State, tangents: Tangents, h: f64, force: [f64; 3]) -> (State, Tangents) {
    // Six numbers, one slope function: the tangents follow the derivative of equation 6 along the
    // orbit.
    let slope = |y: [f64; 6], f: f64| {
        let [x, v, a, b, c, d] = y;
        let acceleration = oscillator.acceleration_m_s2(State { x_m: x, v_m_s: v }, f);
        let spring = oscillator.tangent_stiffness_n_m(x);
        let bend = |x: f64, v: f64| -(spring * x + oscillator.damping_kg_s * v) / oscillator.mass_kg;
        [v, acceleration, b, bend(a, b), d, bend(c, d)]
    };
    let ahead = |y: [f64; 6], k: [f64; 6], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let [[a, b], [c, d]] = tangents;
    let y = [state.x_m, state.v_m_s, a, b, c, d];
    let k1 = slope(y, force[0]);
    let k2 = slope(ahead(y, k1, 0.5 * h), force[1]);
    let k3 = slope(ahead(y, k2, 0.5 * h), force[1]);
    let k4 = slope(ahead(y, k3, h), force[2]);
    let [x, v, a, b, c, d]: [f64; 6] =
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    (State { x_m: x, v_m_s: v }, [[a, b], [c, d]])
}

/// Kaplan–Yorke dimension of the strobed attractor: 1 + λ₁/|λ₂| while the exponents sum below zero.
pub fn kaplan_yorke_dimension(exponents: [f64; 2]) -> f64 {
    let [first, second] = exponents;
    if first <= 0.0 {
        0.0
    } else if first + second >= 0.0 {
        2.0
    } else {
        1.0 + first / second.abs()
    }
}
