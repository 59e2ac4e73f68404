//! Duffing orbits: lanes and oracle agree, exponents match analysis and print.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::gpu::Gpu;
use proofmass::backend::orbits::{Device, explore, explore_on};
use proofmass::control::Control;
use proofmass::dynamics::duffing::{Drive, Oscillator, PAPER, State};
use proofmass::dynamics::estimate::Estimate;
use proofmass::dynamics::lyapunov::{Span, spectrum};
use proofmass::kernel::orbit::{Plan, Point};

use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("dynamics: both exponents of the linear oscillator are -zeta omega", linear_exponents),
        test("dynamics: the lanes give -zeta omega too, in f32 and f64", linear_lanes),
        test("dynamics: Ueda's oscillator has its published exponents", ueda),
        test("dynamics: the two-well Duffing oscillator has its published exponents", two_wells),
        test("dynamics: exponents of a chaotic orbit sum to minus the damping", sum_of_exponents),
        test("dynamics: f32 and f64 lanes agree in distribution, and a wrong stiffness does not", precision),
        test("dynamics: periods are found, and chaos has none", periods),
        test("dynamics: a lane's orbit does not depend on its neighbours", lanes_are_independent),
        gpu_test("dynamics: GPU and CPU agree on regular orbits, and on chaos in distribution", devices_agree),
        test("dynamics: an orbit that leaves every bound is NaN, not poison", lost),
    ]
}

const PLAN: Plan =
    Plan { seed: 1, first_member: 0, steps_per_period: 200, transient_periods: 100, periods: 2000, strobes: 0 };

fn point(oscillator: &Oscillator, drive: &Drive, l: usize) -> Point {
    Point { x_m: 0.01 * l as f64, ..Point::at_rest(oscillator, drive) }
}

/// Exponents of 64 starts.
fn lanes(oscillator: &Oscillator, drive: &Drive, plan: &Plan, double: bool) -> Result<Vec<f64>, Failed> {
    let points: Vec<Point> = (0..64).map(|l| point(oscillator, drive, l)).collect();
    let orbits = if double {
        explore::<f64>(&points, plan, &Control::silent())
    } else {
        explore::<f32>(&points, plan, &Control::silent())
    }?;
    Ok(orbits.iter().map(|o| o.exponent_per_s).collect())
}

fn linear_exponents() -> Result<(), Failed> {
    let span = Span { steps_per_period: 200, transient_periods: 20, periods: 400 };
    let found = spectrum(&PAPER.linear(), &Drive { amplitude_n: 1.0, omega_rad_s: 1.5 }, State::default(), span);
    // Underdamped: both real parts are −ζω₀ = −D₀/2m; what is left is the turning of the tangent
    // ellipse over the span.
    near("first", found[0], -0.05, 2e-4)?;
    near("second", found[1], -0.05, 2e-4)?;
    near("sum", found[0] + found[1], -0.1, 1e-8)
}

fn linear_lanes() -> Result<(), Failed> {
    let drive = Drive { amplitude_n: 1.0, omega_rad_s: 1.5 };
    for double in [false, true] {
        for exponent in lanes(&PAPER.linear(), &drive, &Plan { periods: 400, ..PLAN }, double)? {
            near("exponent", exponent, -0.05, 2e-4)?;
        }
    }
    // Negative control: the cubic spring under a strong force is chaotic and must not pass for
    // linear.
    let chaotic = lanes(&PAPER, &Drive { amplitude_n: 70.8, omega_rad_s: 1.5 }, &Plan { periods: 400, ..PLAN }, false)?;
    check(near("exponent", chaotic[0], -0.05, 2e-4).is_err(), "a chaotic exponent passed for the linear one")
}

fn ueda() -> Result<(), Failed> {
    // x″ + 0.05 x′ + x³ = 7.5 cos t: λ₁ = 0.1034 (Sprott, Chaos and Time-Series Analysis, 2003,
    // list of chaotic systems; a recomputation at step 0.001,
    // sites.google.com/view/lyapunov-spectrum, prints 0.0999). Ueda, J. Stat. Phys. 20.
    let oscillator = Oscillator { mass_kg: 1.0, damping_kg_s: 0.05, stiffness_n_m: 0.0, cubic_n_m3: 1.0 };
    let found = Estimate::of_mean(&lanes(&oscillator, &Drive { amplitude_n: 7.5, omega_rad_s: 1.0 }, &PLAN, false)?);
    near("largest exponent", found.value, 0.1034, 0.002)
}

fn two_wells() -> Result<(), Failed> {
    // x″ + 0.15 x′ − x + x³ = 7 cos t: λ = 0.10542, −0.25542
    // (mathematica.stackexchange.com/questions/185364).
    let oscillator = Oscillator { mass_kg: 1.0, damping_kg_s: 0.15, stiffness_n_m: -1.0, cubic_n_m3: 1.0 };
    let found = Estimate::of_mean(&lanes(&oscillator, &Drive { amplitude_n: 7.0, omega_rad_s: 1.0 }, &PLAN, false)?);
    near("largest exponent", found.value, 0.1054, 0.005)
}

fn sum_of_exponents() -> Result<(), Failed> {
    let span = Span { steps_per_period: 400, transient_periods: 50, periods: 500 };
    let drive = Drive { amplitude_n: 70.8, omega_rad_s: 1.5 };
    let [first, second] = spectrum(&PAPER, &drive, State::default(), span);
    // The flow's divergence is −D₀/m everywhere.
    near("sum", first + second, -0.1, 1e-5)
}

fn precision() -> Result<(), Failed> {
    let drive = Drive { amplitude_n: 70.8, omega_rad_s: 1.5 };
    let mean = |o: &Oscillator, double| lanes(o, &drive, &PLAN, double).map(|v| Estimate::of_mean(&v));
    let (single, double) = (mean(&PAPER, false)?, mean(&PAPER, true)?);
    let apart = |a: Estimate, b: Estimate| (a.value - b.value).abs() / a.standard_error.hypot(b.standard_error);
    // Orbits part within seconds, so only distributions can agree: four standard errors are passed
    // by chance once in 16,000.
    check(apart(single, double) < 4.0, format!("f32 {single:?} and f64 {double:?} differ"))?;
    let wrong = mean(&Oscillator { cubic_n_m3: 0.2, ..PAPER }, false)?;
    check(apart(wrong, double) > 4.0, "a wrong stiffness passed")
}

fn periods() -> Result<(), Failed> {
    let plan = Plan { strobes: 32, periods: 200, transient_periods: 400, ..PLAN };
    let period = |force: f64| -> Result<Option<u32>, Failed> {
        let drive = Drive { amplitude_n: force, omega_rad_s: 1.5 };
        Ok(explore::<f32>(&[point(&PAPER, &drive, 0)], &plan, &Control::silent())?[0].period(1e-3))
    };
    check(period(1.0)? == Some(1), "a weak force drives a period-1 orbit")?;
    check(period(70.8)?.is_none(), "chaos has no period")
}

fn lanes_are_independent() -> Result<(), Failed> {
    let plan = Plan { strobes: 4, periods: 4, transient_periods: 4, ..PLAN };
    let drive = Drive { amplitude_n: 70.8, omega_rad_s: 1.5 };
    let points: Vec<Point> = (0..100).map(|l| Point { noise_m_s2_rts: 0.1, ..point(&PAPER, &drive, l) }).collect();
    let together = explore::<f32>(&points, &plan, &Control::silent())?;
    let tail = explore::<f32>(&points[64..], &Plan { first_member: 64, ..plan }, &Control::silent())?;
    check(together[64..] == tail[..], "splitting a job changed its orbits")?;
    check(together[0].strobes != together[1].strobes, "neighbours share their noise")
}

fn devices_agree() -> Result<(), Failed> {
    let gpu = Gpu::open()?;
    let plan = Plan { steps_per_period: 128, transient_periods: 40, periods: 150, strobes: 4, ..PLAN };
    let both = |force: f64, cubic: f64, noise: f64| -> Result<[Vec<f64>; 2], Failed> {
        let oscillator = Oscillator { cubic_n_m3: cubic, ..PAPER };
        let drive = Drive { amplitude_n: force, omega_rad_s: 1.5 };
        let points: Vec<Point> = (0..128)
            .map(|l| Point { noise_m_s2_rts: noise, x_m: 0.05 * l as f64, ..point(&oscillator, &drive, l) })
            .collect();
        let exponents = |device| -> Result<Vec<f64>, Failed> {
            Ok(explore_on(device, &points, &plan, &Control::silent())?.iter().map(|o| o.exponent_per_s).collect())
        };
        Ok([exponents(Device::Cpu)?, exponents(Device::Gpu(&gpu))?])
    };
    // Linear, with noise: the tangent does not feel the orbit, so that both differ by rounding
    // alone: 150 sums of logarithms, each off by a few ulp of the tangent, over 600 s.
    let [cpu, device] = both(1.0, 0.0, 0.5)?;
    for (a, b) in cpu.iter().zip(&device) {
        near("linear exponent", *b, *a, 2e-5)?;
    }
    // Chaotic: 128 orbits, four joint standard errors; a weaker spring must fail.
    let [cpu, device] = both(66.75, 0.3, 0.0)?;
    let [_, wrong] = both(66.75, 0.2, 0.0)?;
    let apart = |a: &[f64], b: &[f64]| {
        let (a, b) = (Estimate::of_mean(a), Estimate::of_mean(b));
        (a.value - b.value).abs() / a.standard_error.hypot(b.standard_error)
    };
    check(apart(&cpu, &device) < 4.0, format!("{} joint standard errors apart", apart(&cpu, &device)))?;
    check(apart(&cpu, &wrong) > 4.0, "a wrong stiffness passed")
}

fn lost() -> Result<(), Failed> {
    // One step per period is far too long for a stiff spring: the orbit explodes.
    let drive = Drive { amplitude_n: 1e5, omega_rad_s: 1.0 };
    let orbits =
        explore::<f32>(&[point(&PAPER, &drive, 0)], &Plan { steps_per_period: 1, ..PLAN }, &Control::silent())?;
    check(orbits[0].exponent_per_s.is_nan(), "a lost orbit has an exponent")
}
