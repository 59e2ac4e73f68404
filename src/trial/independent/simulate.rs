//! An oscillator integrated row by row in continuous time: inputs held or not, sampling instants of
//! their own.

use super::draw::Draw;
use super::integrate::{STATES, Tolerance};
use super::law::Law;
use super::motion::{glide, motion};
use super::oscillator::Oscillator;
use super::readout::Readout;

/// Fine steps per row over which white force is held.
fn fine(o: &Oscillator) -> usize {
    ((16.0 * o.omega / (std::f64::consts::TAU * o.rate_hz)).ceil() as usize).max(1)
}

/// Result of an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Continuous input at each row.
    pub input: Vec<f64>,
    /// Output of the readout's analogue part at each row.
    pub signal: Vec<f64>,
}

/// Integrates the first `rows` rows. None when the motion runs away.
pub fn run(o: &Oscillator, rows: usize) -> Option<Run> {
    let dt = 1.0 / o.rate_hz;
    let delay = o.readout.iter().map(Readout::delay_s).sum::<f64>();
    let before = o.before.max((delay * o.rate_hz).ceil() as usize + 1);
    let margin = 4.0 * dt + o.input_lag_s.abs() + o.slip.map_or(0.0, |s| s[1] * dt);
    let span = [-(before as f64) * dt - margin, rows as f64 * dt + margin];
    let mut motion = motion(o, span);
    let mut state = [0.0; STATES];
    (state[0], state[1]) = (o.start[0], o.start[1]);
    let fine = if motion.laws.iter().any(|(l, _)| matches!(l, Law::WhiteForce { .. })) { fine(o) } else { 1 };
    let mut draw = Draw::new(o.seed, 0, 11);
    let mut telegraph = Draw::new(o.seed, 0, 12);
    let mut clock = Draw::new(o.seed, 0, 13);
    let tolerance =
        Tolerance { relative: 1e-9, sizes: std::array::from_fn(|n| if n == 1 { 0.1 * o.omega } else { 0.1 }) };
    let (mut sign, mut until) = (1.0, span[0]);
    let instants: Vec<f64> = (0..rows).map(|n| instant(o, n, &mut clock) - delay).collect();
    let mut next = 0;
    let mut signal = Vec::with_capacity(rows);
    let mut h = 0.05 / o.omega;
    // The motion begins with the recording, or `before` rows earlier from the same start.
    let first = -(before as f64) * dt;
    motion.release(first, &state);
    let last = instants.iter().fold(0.0f64, |a, b| a.max(*b));
    let mut cell = 0usize;
    while next < rows {
        let (from, to) = (first + cell as f64 * dt / fine as f64, first + (cell + 1) as f64 * dt / fine as f64);
        cell += 1;
        if from > last + 2.0 * dt {
            return None;
        }
        let moving = from >= -(o.before as f64 + 0.5) * dt;
        if o.held {
            // The cell's own row: held from its instant on.
            let row = ((from + 1e-9 * dt) / dt).floor();
            motion.held_value = motion.wave.at(row * dt) + o.constant;
        }
        motion.force = 0.0;
        for (law, _) in &motion.laws {
            match **law {
                Law::WhiteForce { size } => motion.force += draw.normal() * (size * o.rate_hz * fine as f64).sqrt(),
                Law::Telegraph { size, dwell } => {
                    if from >= until {
                        sign = -sign;
                        until = from + dwell * telegraph.exponential();
                    }
                    motion.force += sign * size * o.omega * o.omega;
                }
                _ => {}
            }
        }
        let mut t = from;
        loop {
            let stop = instants.get(next).copied().filter(|i| *i < to).unwrap_or(to).max(t);
            if moving && stop > t && !glide(&mut motion, [t, stop], &mut state, &mut h, &tolerance) {
                return None;
            }
            t = stop;
            if t >= to {
                break;
            }
            signal.push(motion.read_filtered(&state));
            next += 1;
        }
    }
    let input = (0..rows).map(|n| motion.wave.at(n as f64 * dt - o.input_lag_s) + o.constant).collect();
    Some(Run { input, signal })
}

/// When a row of the reading is taken. Only the reading loses rows: a logger that lost samples of
/// one stream.
fn instant(o: &Oscillator, row: usize, clock: &mut Draw) -> f64 {
    let jitter = if o.jitter > 0.0 { (o.jitter * clock.normal()).clamp(-0.45, 0.45) } else { 0.0 };
    let lost = o.slip.map_or(0.0, |[part, lost]| if row as f64 >= part * o.rows as f64 { lost } else { 0.0 });
    (row as f64 + jitter + lost) / o.rate_hz
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::independent::wave::Shape;

    fn bare(omega: f64, zeta: f64, input: Shape, start: [f64; 2], rows: usize) -> Oscillator {
        Oscillator {
            seed: 1,
            rate_hz: 50.0,
            rows,
            omega,
            zeta,
            gain: 1.0,
            start,
            before: 0,
            input,
            held: false,
            constant: 0.0,
            hidden: 0.0,
            laws: Vec::new(),
            readout: Vec::new(),
            environment: None,
            input_lag_s: 0.0,
            input_noise: 0.0,
            jitter: 0.0,
            slip: None,
        }
    }

    fn signal(o: &Oscillator) -> Vec<f64> {
        run(o, o.rows).expect("stays bounded").signal
    }

    // x(t) = e^(−ζω₀t) cos ω_d t + … for a ring-down from x = 1, v = 0; ω_d = ω₀√(1 − ζ²).
    #[test]
    fn a_ring_down_is_its_closed_form() {
        let (omega, zeta) = (TAU * 1.7, 0.03);
        let y = signal(&bare(omega, zeta, Shape::None, [1.0, 0.0], 1000));
        let damped = omega * (1.0f64 - zeta * zeta).sqrt();
        let exact = |t: f64| {
            (-zeta * omega * t).exp() * ((damped * t).cos() + zeta / (1.0 - zeta * zeta).sqrt() * (damped * t).sin())
        };
        let worst = |f: &dyn Fn(f64) -> f64| {
            y.iter().enumerate().map(|(n, y)| (y - f(n as f64 / 50.0)).abs()).fold(0.0, f64::max)
        };
        assert!(worst(&exact) < 1e-7, "{}", worst(&exact));
        assert!(worst(&|t| exact(1.001 * t)) > 1e-3, "another frequency is seen: control");
    }

    // Steady state: amplitude g/|ω₀² − ν² + 2iζω₀ν|; a delay and a pole turn its phase by ντ and
    // arctan ντ.
    #[test]
    fn driven_motion_has_its_transfer_function_and_its_readout_its_phase() {
        let (omega, zeta, nu) = (TAU * 2.0, 0.1, TAU * 1.0);
        let mut o = bare(omega, zeta, Shape::Sines { lines: vec![[1.0, 1.0, 0.0]] }, [0.0; 2], 4000);
        let part = |y: &[f64], phase: f64| {
            let sum: f64 = (2000..4000).map(|n| y[n] * (nu * n as f64 / 50.0 + phase).sin()).sum();
            sum / 1000.0
        };
        let complex = |y: &[f64]| [part(y, 0.0), part(y, 0.25 * TAU)];
        let [re, im] = complex(&signal(&o));
        let expected = 1.0 / ((omega * omega - nu * nu).powi(2) + (2.0 * zeta * omega * nu).powi(2)).sqrt();
        assert!((re.hypot(im) / expected - 1.0).abs() < 1e-5);
        for (stage, turn) in
            [(Readout::Delay { tau: 0.033 }, nu * 0.033), (Readout::Poles { taus: vec![0.05] }, (nu * 0.05).atan())]
        {
            o.readout = vec![stage];
            let [a, b] = complex(&signal(&o));
            let lag = im.atan2(re) - b.atan2(a);
            assert!((lag - turn).abs() < 1e-4, "{lag} {turn}");
        }
    }

    // Without viscous damping dry friction f takes 4f/ω₀² of amplitude per cycle, and the mass
    // sticks where ω₀²|x| < f.
    #[test]
    fn dry_friction_takes_its_amplitude_per_cycle_and_then_holds() {
        let omega = TAU * 0.5;
        let mut o = bare(omega, 0.0, Shape::None, [1.0, 0.0], 1500);
        let f = 0.04 * omega * omega;
        o.laws = vec![Law::Friction { size: f, lean: 0.0 }];
        let y = signal(&o);
        for cycle in 1..5 {
            let expected = 1.0 - 0.16 * cycle as f64;
            assert!((y[100 * cycle] - expected).abs() < 1e-6, "{} {expected}", y[100 * cycle]);
        }
        let rest = y[1400];
        assert!(y[1000..].iter().all(|y| *y == rest) && omega * omega * rest.abs() <= f);
        o.laws.clear();
        assert!((signal(&o)[400] - 1.0).abs() < 1e-6, "nothing is lost without friction: control");
    }

    // Hysteresis with n = 1 slides at |z| = 1/(b + g).
    #[test]
    fn a_yielding_spring_yields_at_its_bound() {
        let law = Law::BoucWen { size: 1.0, b: 2.0, g: 0.5, n: 1.0 };
        let mut rates = [0.0];
        law.inner(0.0, 1.0, &[0.4], 1.0, &mut rates);
        assert!(rates[0].abs() < 1e-12);
        law.inner(0.0, 1.0, &[0.0], 1.0, &mut rates);
        assert_eq!(rates[0], 1.0);
    }

    // White force of two-sided intensity q gives the displacement a variance q/(4ζω₀³).
    #[test]
    fn white_force_moves_the_mass_by_its_variance() {
        let (omega, zeta) = (TAU * 3.0, 0.1);
        let mut o = bare(omega, zeta, Shape::None, [0.0; 2], 40_000);
        o.laws = vec![Law::WhiteForce { size: 4.0 * zeta * omega.powi(3) }];
        let y = signal(&o);
        let variance = y[500..].iter().map(|y| y * y).sum::<f64>() / (y.len() - 500) as f64;
        assert!((variance - 1.0).abs() < 0.1, "{variance}");
    }
}
