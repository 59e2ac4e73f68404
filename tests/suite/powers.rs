//! Laws with exponents in a study: a spring with memory, a spring and a damping by one power.
//!
//! Expected: the spring with memory by its closed form under a slow loading, z = (1 − e^(−(β +
//! γ)x))/(β + γ) (Wen 1976, A = n = 1), and by its equation written down here and integrated finely;
//! a power by the stated law of the same exponent.

use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::kernel::job::Waveform;

use super::own_states::{FORCE, OMEGA, ZETA, error, mass, with};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("powers: a spring with memory follows its closed form and its equation", memory),
        test("powers: a spring and a damping by a power are the stated laws where it is theirs", powers),
    ]
}

/// A force that grows evenly, m/s³.
#[derive(Debug)]
struct Ramp(f64);

impl Waveform for Ramp {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        self.0 * time_s
    }
}

fn memory() -> Result<(), Failed> {
    let (k, beta, gamma) = (100.0, 20.0, 10.0);
    let hysteretic = mass("hysteresis", [k, beta, gamma])?;
    let own = OMEGA * OMEGA;
    let ramp = 0.1;
    for seconds in [20.0, 40.0] {
        let force = ramp * seconds;
        let x = (force + error(hysteretic, Arc::new(Ramp(ramp)), 1e-3, seconds)?) / own;
        let sum = beta + gamma;
        let z = (1.0 - (-sum * x).exp()) / sum;
        // The damper holds back by the speed at which both springs give way.
        let speed = ramp / (own + k * (-sum * x).exp());
        let balance = own * x + k * z + 2.0 * ZETA * OMEGA * speed;
        near(&format!("balance after {seconds} s"), balance, force, 2e-4)?;
        check((own * x + k * x - force).abs() > 0.05, "a spring without a bend holds it too (control)")?;
    }
    // Loops under a sine, by the equation itself.
    let loops = |beta: f64, n: f64| {
        let (h, steps) = (2e-5, 100_000);
        let slope = |t: f64, [x, v, z]: [f64; 3]| {
            let pull = FORCE.specific_force_m_s2(t) - own * x - 2.0 * ZETA * OMEGA * v - k * z;
            [v, pull, v - (beta * v.abs() * z + gamma * v * z.abs()) * (beta * z.abs()).powf(n - 1.0)]
        };
        let add = |s: [f64; 3], d: [f64; 3], by: f64| std::array::from_fn(|i| s[i] + by * d[i]);
        let begin = [FORCE.offset_m_s2 / own, 0.0, 0.0];
        let end = (0..steps).fold(begin, |s, n| {
            let t = f64::from(n) * h;
            let d1 = slope(t, s);
            let d2 = slope(t + 0.5 * h, add(s, d1, 0.5 * h));
            let d3 = slope(t + 0.5 * h, add(s, d2, 0.5 * h));
            let d4 = slope(t + h, add(s, d3, h));
            std::array::from_fn(|i| s[i] + h / 6.0 * (d1[i] + 2.0 * d2[i] + 2.0 * d3[i] + d4[i]))
        });
        own * end[0] - FORCE.specific_force_m_s2(2.0)
    };
    let got = error(hysteretic, Arc::new(FORCE), 1e-3, 2.0)?;
    near("reading error in a loop", got, loops(beta, 1.0), 1e-5)?;
    check((got - loops(0.8 * beta, 1.0)).abs() > 1e-4, "a fifth less memory moves alike (control)")?;
    let sharp = error(mass("hysteresis", [k, beta, gamma, 2.5])?, Arc::new(FORCE), 1e-3, 2.0)?;
    near("reading error in a sharper loop", sharp, loops(beta, 2.5), 1e-5)?;
    check((sharp - got).abs() > 1e-4, "a sharper loop moves alike (control)")
}

/// Of the third power a spring is the cubic one, of the second a damping the quadratic one; by any
/// other they are other laws.
fn powers() -> Result<(), Failed> {
    let moved = |law: &str, p: &[f64]| -> Result<f64, Failed> {
        error(with(mass::<0>(law, [])?, law, p)?, Arc::new(FORCE), 1e-3, 2.0)
    };
    let at: f64 = 0.003;
    for (power, plain, n, strength) in [
        ("power-law-stiffness", "cubic-stiffness", 3.0, 2e7 * at * at),
        ("power-law-damping", "quadratic-damping", 2.0, 300.0 * at),
    ] {
        let known = moved(plain, &[strength * at.powf(1.0 - n)])?;
        near(power, moved(power, &[strength, at, n])?, known, 1e-9)?;
        check((moved(power, &[strength, at, n - 0.2])? - known).abs() > 1e-4, format!("{power}: alike (control)"))?;
        check((moved(power, &[0.0, at, n])? - known).abs() > 1e-3, format!("{power}: nothing to see"))?;
    }
    Ok(())
}
