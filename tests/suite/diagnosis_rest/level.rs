//! A white level other than the promised one is named only where it holds throughout.

use libtest_mimic::Failed;
use proofmass::diagnosis::verdict::Outcome;
use proofmass::rng::{Philox, Stream};

use super::plant::white;
use super::{RATE_HZ, judged};
use crate::suite::world::check;

/// Samples of each case.
const SAMPLES: usize = 10_000;

/// One-sided density of white noise of unit variance per sample.
fn promise() -> f64 {
    (2.0 / RATE_HZ).sqrt()
}

/// Unit noise in one channel; in the other the same, changed sample by sample: (sample, fraction of
/// the log, noise).
fn told(seed: u64, change: impl Fn(usize, f64, f64) -> f64) -> Result<(Outcome, Vec<String>), Failed> {
    let mut rng = Philox::new(71, seed, Stream::Host);
    let (still, noise) = (white(SAMPLES, &mut rng), white(SAMPLES, &mut rng));
    let changed = noise.iter().enumerate().map(|(n, v)| change(n, n as f64 / SAMPLES as f64, *v)).collect();
    let verdict = judged(vec![still, changed], Some(promise()))?;
    Ok((verdict.verdict, verdict.effects.into_iter().map(|e| e.id).collect()))
}

/// Noise that grows from the promised level, spikes and a hum that sweeps through the band are no
/// white noise. The control is noise of one and a half times the promised level throughout.
pub(super) fn passing() -> Result<(), Failed> {
    let phase = |u: f64| std::f64::consts::TAU * SAMPLES as f64 * (0.02 * u + 0.01 * u * u);
    for seed in 0..10 {
        let cases = [
            ("grows", told(seed, |_, u, v| v * (1.0 + 2.0 * u))?),
            ("spikes", told(seed, |n, _, v| if n % 311 == 7 { v + 25.0 } else { v })?),
            ("sweeps", told(seed, |_, u, v| v + 0.9 * phase(u).sin())?),
        ];
        for (name, (outcome, named)) in cases {
            check(outcome == Outcome::Unexplained, format!("{seed}, noise that {name}: {outcome:?}"))?;
            check(named.iter().all(|id| id != "white-noise"), format!("{seed}, noise that {name}: {named:?}"))?;
        }
        let (outcome, named) = told(seed, |_, _, v| 1.5 * v)?;
        check(outcome == Outcome::Explained && named == ["white-noise"], format!("{seed}: {outcome:?} {named:?}"))?;
    }
    Ok(())
}
