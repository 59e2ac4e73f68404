//! Free decays of many cycles: an effect too small to show within a few cycles shows in the phase of many; and
//! what goes with time is not told as a law of the amplitude, which goes with time too.
//!
//! Units are the first amplitude and 1/ω₀, so that every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::{Outcome, Verdict};

use super::decays::{Made, PER_CYCLE, diagnosed, ids};
use super::world::{check, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("long decay: a stop that no few cycles show is named with its numbers", stop),
        test("long decay: a drag that no piece of it shows is named by the whole, and none where there is none", drag),
        test("long decay: one that is knocked again and again is searched to its end", knocked),
        test("long decay: a spring that changes with time is not taken for a law of amplitude", course),
    ]
}

/// Diagnoses one row in `every` of a decay.
fn thinned(made: &Made<'_>, every: usize) -> Result<Verdict, Failed> {
    diagnosed(made.reading().into_iter().step_by(every).collect(), PER_CYCLE as f64 / TAU / every as f64)
}

/// Force of a stop on one side.
fn at_stop(x: f64, stiffness: f64, gap: f64) -> f64 {
    -stiffness * (x - gap).max(0.0)
}

// Beyond its gap the stop adds half a per cent to the spring: within four cycles the phase moves by a hundredth of
// a radian at most, which the common frequency takes up, and the noise is 0.004 of the amplitude.
fn stop() -> Result<(), Failed> {
    let (stiffness, gap) = (0.005, 0.4);
    let force = |_: f64, x: f64, _: f64| at_stop(x, stiffness, gap);
    let of = |force| Made { zeta: 4e-4, cycles: 1000, noise: 4e-3, seed: 4, force };
    let verdict = thinned(&of(&force), 5)?;
    let said = format!("{:?} {:?} {}", verdict.verdict, ids(&verdict), verdict.sentence);
    check(verdict.verdict == Outcome::Explained && ids(&verdict) == ["end-stop"], &said)?;
    for (p, planted) in verdict.effects[0].parameters.iter().zip([stiffness, gap]) {
        // Twice the 95 % interval: chance leaves it once in ten thousand.
        let (middle, half) = (0.5 * (p.ci95[0] + p.ci95[1]), 0.5 * (p.ci95[1] - p.ci95[0]));
        check((middle - planted).abs() < 2.0 * half, format!("{} {:?}: {planted}", p.name, p.ci95))?;
        check(half < 0.05 * planted, format!("{} {:?} says little", p.name, p.ci95))?;
    }
    let verdict = thinned(&of(&|_, _, _| 0.0), 5)?;
    check(verdict.verdict == Outcome::Adequate, format!("control: {}", verdict.sentence))
}

// The drag adds 0.6 of the damping at first: 4/3π of its c2, at an amplitude and a frequency of one. Within a few
// cycles of one amplitude that is more damping, no drag.
fn drag() -> Result<(), Failed> {
    let zeta = 0.009;
    let size = 0.6 * zeta * 3.0 * std::f64::consts::PI / 4.0;
    let drag = |_: f64, _: f64, v: f64| -size * v * v.abs();
    for seed in 1..4 {
        let of = |force| Made { zeta, cycles: 44, noise: 0.0135, seed, force };
        let verdict = thinned(&of(&drag), 1)?;
        let said = format!("{seed}: {:?} {:?} {}", verdict.verdict, ids(&verdict), verdict.sentence);
        check(ids(&verdict).contains(&"quadratic-damping"), said)?;
        let verdict = thinned(&of(&|_, _, _| 0.0), 1)?;
        check(verdict.verdict == Outcome::Adequate, format!("{seed}, control: {}", verdict.sentence))?;
    }
    Ok(())
}

// While the amplitude dies away the spring softens and stiffens by 0.8 %: a stop that is touched less and less
// follows that for a time. Control: a stop of that size is named as one.
fn course() -> Result<(), Failed> {
    let length = TAU * 150.0;
    let course = |t: f64, x: f64, _: f64| 0.016 * x * (TAU * 1.16 * t / length + 5.0).sin();
    let stop = |_: f64, x: f64, _: f64| at_stop(x, 0.02, 0.25);
    let of = |force| Made { zeta: 0.006, cycles: 150, noise: 4e-3, seed: 5, force };
    let verdict = thinned(&of(&course), 1)?;
    let said = format!("{:?} {:?} {}", verdict.verdict, ids(&verdict), verdict.sentence);
    check(verdict.verdict == Outcome::Unexplained && verdict.effects.is_empty(), &said)?;
    check(verdict.sentence.contains("depends on time"), said)?;
    let verdict = thinned(&of(&stop), 1)?;
    check(ids(&verdict) == ["end-stop"], format!("control: {:?} {}", ids(&verdict), verdict.sentence))
}

// Six decays, each of which the next knock ends: however long segments may be, there are six.
fn knocked() -> Result<(), Failed> {
    let decay = |seed| Made { zeta: 0.01, cycles: 60, noise: 4e-3, seed, force: &|_, _, _| 0.0 }.reading();
    // Each begins a twentieth lower, so that the first is the largest.
    let lower = |n: u64| decay(n).into_iter().map(move |y| y * 0.95f64.powi(n as i32));
    let verdict = diagnosed((0..6).flat_map(lower).collect(), PER_CYCLE as f64 / TAU)?;
    check(verdict.verdict == Outcome::Adequate, verdict.sentence.clone())?;
    let knocks = verdict.findings.iter().filter(|f| f.contains("excited again")).count();
    check(knocks == 5, format!("{knocks} knocks: {:?}", verdict.findings))
}
