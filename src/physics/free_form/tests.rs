//! Free forms against the stated laws that they contain, and against closed forms.

use super::*;
use crate::cubic_stiffness::CubicStiffness;
use crate::quadratic_damping::QuadraticDamping;
use crate::stiffness_drift::StiffnessDrift;
use crate::test_problem::Mass;

fn form(law: Freed, size: f64) -> FreeForm {
    FreeForm { law, size, extent: Extent::Wide }
}

#[test]
fn with_nothing_free_it_is_the_stated_law() {
    let mass = Mass { omega: 2.0, zeta: 0.05, gain: 1.0 };
    let push = |t: f64| (1.3 * t).sin();
    let moved = |law: &dyn Fn() -> [f64; 2]| law();
    let cubic = moved(&|| mass.moved(&CubicStiffness, &[0.8], [0.5, 0.0], 6.0, 4000, push));
    let free = |p: [f64; 4]| mass.moved(&form(Freed::CubicSpring, 1.7), &p, [0.5, 0.0], 6.0, 4000, push).map(f64::abs);
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0].abs()).abs() < 1e-9 && (a[1] - b[1].abs()).abs() < 1e-9;
    assert!(near(free([0.8, 0.0, 0.0, 0.0]), cubic));
    assert!(!near(free([0.8, 0.1, 0.0, 0.0]), cubic), "another exponent is another law");
    let drag = mass.moved(&QuadraticDamping, &[0.8], [0.5, 0.0], 6.0, 4000, push);
    let free = mass.moved(&form(Freed::Drag, 0.3), &[0.8, 0.0, 0.0, 0.0], [0.5, 0.0], 6.0, 4000, push);
    assert!((free[0] - drag[0]).abs() < 1e-9 && (free[1] - drag[1]).abs() < 1e-9);
    let drift = mass.moved(&StiffnessDrift::default(), &[0.1], [0.5, 0.0], 6.0, 4000, push);
    let free = |p: [f64; 4]| mass.moved(&form(Freed::Drift, 3.0), &p, [0.5, 0.0], 6.0, 4000, push);
    let same = free([0.1, 0.0, 0.0, 0.0]);
    assert!((same[0] - drift[0]).abs() < 1e-9 && (same[1] - drift[1]).abs() < 1e-9);
    assert!((free([0.1, 0.5, 0.0, 0.0])[0] - drift[0]).abs() > 1e-3, "another power of time is another law");
}

// With s = t/3: 0.2 t s^(2/3)·(1 + 0.3 (s − 0.7) + 0.1 (s − 0.7)²) at t = 6 is 1.2·2^(2/3)·1.559.
#[test]
fn a_drift_follows_another_power_of_time_and_bends() {
    let drift = form(Freed::Drift, 3.0);
    let at = drift.curve::<f64, false>(&[0.2, 2.0 / 3.0, 0.06, 0.02], 6.0);
    assert!((at - 1.2 * 2f64.powf(2.0 / 3.0) * 1.559).abs() < 1e-12, "{at}");
    assert!(drift.curve::<f64, false>(&[0.2, -0.5, 0.06, 0.02], 0.0).abs() < 1e-12, "it begins at nothing");
}

// Without a spring v′ = −c v|v|^(p−1) is solved by v^(1−p) = v₀^(1−p) + (p − 1) c t.
#[test]
fn an_exponent_slows_a_free_mass_as_the_integral_says() {
    let (c, p, v0, t) = (0.7, 1.6f64, 3.0f64, 2.0);
    let [_, v] = Mass::default().moved(&form(Freed::Drag, 1.0), &[c, p - 2.0, 0.0, 0.0], [0.0, v0], t, 4000, |_| 0.0);
    let expected = (v0.powf(1.0 - p) + (p - 1.0) * c * t).powf(1.0 / (1.0 - p));
    assert!((v - expected).abs() < 1e-9, "{v} {expected}");
}

// Hertz: a force as depth to the power of 1.5.
#[test]
fn a_stop_with_half_a_power_more_is_that_of_hertz() {
    let stop = form(Freed::Stop(Side::Both), 1.0);
    let at = |x: f64| stop.curve::<f64, false>(&[3.0, 0.4, 0.5, 0.1], x);
    assert!((at(0.65) - 3.0 * 0.25f64.powf(1.5)).abs() < 1e-12);
    assert!((at(-0.75) + 3.0 * 0.25f64.powf(1.5)).abs() < 1e-12, "its other gap is wider");
    assert_eq!([at(0.4), at(-0.5)], [0.0, 0.0]);
}

// x − 0.3 clip(x/0.3) is a reading that stays where it is within ±0.3; with a rounded bend it is
// 1 − 0.3/0.3 = 0 in slope at zero alone, and further out both are 0.3 less.
#[test]
fn a_readout_may_have_a_dead_zone_with_corners_or_a_rounded_one() {
    let corners = form(Freed::Readout, 1.0);
    let rounded = FreeForm { extent: Extent::Narrow, ..corners };
    let reading = |f: &FreeForm, p: [f64; 4], x: f64| {
        let mut values = [0.0; MOST_VALUES];
        values[..4].copy_from_slice(&p);
        f.reading(&Instant::default(), &values, &[0.0; MOST_STAGED], x)
    };
    let dead = [0.0, 0.0, 0.3, 0.3];
    for x in [-0.2, 0.0, 0.29] {
        assert!(reading(&corners, dead, x).abs() < 1e-15);
    }
    assert!((reading(&rounded, dead, 0.2) - (0.2 - 0.3 * (2f64 / 3.0).tanh())).abs() < 1e-12);
    for f in [corners, rounded] {
        assert!((reading(&f, dead, 9.0) - 8.7).abs() < 1e-12 && (reading(&f, dead, -9.0) + 8.7).abs() < 1e-12);
        assert!((reading(&f, [0.1, 0.02, 0.0, 0.3], 2.0) - (2.0 + 0.4 + 0.16)).abs() < 1e-12, "the stated form");
        assert_eq!(f.force::<f64, false>(&Instant::default(), &[1.0; MOST_VALUES], &[0.0; MOST_STAGED], 0.5), 0.5);
    }
}
