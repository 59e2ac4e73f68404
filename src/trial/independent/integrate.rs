//! Dormand–Prince 5(4), adaptive (J. Comput. Appl. Math. 6, 1980; coefficients as in Hairer,
//! Nørsett & Wanner, *Solving Ordinary Differential Equations I*, table II.5.2), and the events of
//! dry friction located within its steps.

/// Largest number of states.
pub(crate) const STATES: usize = 16;
/// Values of the states.
pub type State = [f64; STATES];

pub(crate) trait System {
    fn states(&self) -> usize;
    fn rates(&self, t: f64, state: &State) -> State;
}

/// Error bounds of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    /// Relative to each state.
    pub relative: f64,
    /// Size of each state below which errors are absolute.
    pub sizes: State,
}

const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const C: [f64; 6] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// One step of length h: the new state and its error over the tolerance.
pub(crate) fn step(system: &impl System, t: f64, state: &State, h: f64, tolerance: &Tolerance) -> (State, f64) {
    let n = system.states();
    let mut k = [[0.0; STATES]; 7];
    k[0] = system.rates(t, state);
    let mut next = *state;
    for stage in 0..6 {
        next = *state;
        for (earlier, weight) in A[stage].iter().enumerate().take(stage + 1) {
            if *weight != 0.0 {
                for i in 0..n {
                    next[i] += h * weight * k[earlier][i];
                }
            }
        }
        k[stage + 1] = system.rates(t + C[stage] * h, &next);
    }
    let mut worst: f64 = 0.0;
    for i in 0..n {
        let error: f64 = h * (0..7).map(|s| E[s] * k[s][i]).sum::<f64>();
        let size = tolerance.sizes[i].max(state[i].abs().max(next[i].abs()));
        worst = worst.max(error.abs() / (tolerance.relative * size).max(f64::MIN_POSITIVE));
    }
    (next, worst)
}

/// Steps of one call at most: what needs more between two rows is too stiff for an explicit method,
/// and is not simulated.
pub(crate) const MOST_STEPS: usize = 2000;

/// Advances from one time to another by accepted steps; `h` is the step to try first and carries
/// over. `false` when the motion runs away or is too stiff.
pub(crate) fn advance(
    system: &impl System,
    span: [f64; 2],
    state: &mut State,
    h: &mut f64,
    tolerance: &Tolerance,
    mut accepted: impl FnMut(f64, &State),
) -> bool {
    let [mut t, end] = span;
    let least = 1e-12 * (end - t).abs().max(1e-300);
    let mut steps = 0;
    while end - t > least {
        steps += 1;
        if steps > MOST_STEPS {
            return false;
        }
        let length = h.min(end - t);
        let (next, error) = step(system, t, state, length, tolerance);
        if !error.is_finite() || next.iter().any(|v| v.abs() > 1e9) {
            if length < 1e-6 * (span[1] - span[0]) {
                return false;
            }
            *h = 0.1 * length;
            continue;
        }
        let factor = (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 4.0);
        if error <= 1.0 || length <= 1e3 * least {
            t += length;
            *state = next;
            accepted(t, state);
            // A last short step says nothing about the next one's length.
            if length >= *h || factor < 1.0 {
                *h = length * factor;
            }
        } else {
            *h = length * factor;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Duffing(f64);

    impl System for Duffing {
        fn states(&self) -> usize {
            2
        }
        fn rates(&self, _: f64, s: &State) -> State {
            let mut rates = [0.0; STATES];
            (rates[0], rates[1]) = (s[1], -s[0] - self.0 * s[0].powi(3));
            rates
        }
    }

    fn run(beta: f64, seconds: f64, relative: f64) -> State {
        let mut state = [0.0; STATES];
        state[0] = 1.0;
        let (mut h, tolerance) = (0.1, Tolerance { relative, sizes: [1.0; STATES] });
        for n in 0..seconds as usize {
            let span = [n as f64, n as f64 + 1.0];
            assert!(advance(&Duffing(beta), span, &mut state, &mut h, &tolerance, |_, _| {}));
        }
        state
    }

    // Without damping, energy v²/2 + x²/2 + βx⁴/4 stays; linear motion is cos t.
    #[test]
    fn energy_stays_and_linear_motion_is_a_cosine() {
        let energy = |s: &State| 0.5 * s[1] * s[1] + 0.5 * s[0] * s[0] + 0.25 * 0.7 * s[0].powi(4);
        let fine = run(0.7, 300.0, 1e-10);
        assert!((energy(&fine) - 0.675).abs() < 1e-7, "{}", energy(&fine));
        let linear = run(0.0, 100.0, 1e-10);
        assert!((linear[0] - 100f64.cos()).abs() < 1e-7 && (linear[1] + 100f64.sin()).abs() < 1e-7);
        // Control: a coarse tolerance is seen to lose energy.
        assert!((energy(&run(0.7, 300.0, 1e-3)) - 0.675).abs() > 1e-4);
    }
}
