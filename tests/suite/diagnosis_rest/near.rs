//! Drift and filters near the library's, at rest.

use proofmass::diagnosis::verdict::{Effect, Outcome, Verdict};
use proofmass::rng::{Philox, Stream};
use rayon::prelude::*;

use libtest_mimic::Failed;

use super::plant::{fractional, relaxation, sized, walk, white};
use super::{check, judged};

const COUNT: usize = 6000;

/// Two channels that drift along the same power of time need no cause in common, and what settles
/// in two speeds is no walk. Two channels that follow the same walk have one cause, and one that
/// walks alone has a walk (controls).
pub(super) fn courses() -> Result<(), Failed> {
    let wrong = |seed: u64| -> Vec<String> {
        let mut rng = Philox::new(41, seed, Stream::Host);
        let mut drifting = |course: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let noise = white(COUNT, &mut rng);
            noise.iter().enumerate().map(|(n, e)| e + course(n as f64 / COUNT as f64)).collect()
        };
        let powers = vec![drifting(&|t| 5.0 * t.powf(1.5)), drifting(&|t| -7.0 * t.powf(1.5))];
        let speeds = vec![drifting(&|t| 6.0 * (-t / 0.05).exp() + 5.0 * (-t / 0.5).exp())];
        // Three that settle alike may share no more than the moment at which they were switched on.
        let settling = |t: f64| 6.0 * (-t / 0.05).exp() + 5.0 * (-t / 0.5).exp();
        let alike = [1.0, -0.7, 1.4].map(|by| drifting(&|t| by * settling(t))).to_vec();
        let sure = judged(alike, None).is_ok_and(|v| v.verdict == Outcome::Explained);
        let sure = sure.then(|| format!("{seed}: a cause in common is sure"));
        let names = |channels: Vec<Vec<f64>>, banned: &str| {
            let Ok(v) = judged(channels, None) else { return Some("no verdict".to_owned()) };
            v.effects.iter().any(|e| e.id == banned).then(|| format!("{seed}: {}", v.sentence))
        };
        let all = [names(powers, "temperature-sensitivity"), names(speeds, "random-walk"), sure];
        all.into_iter().flatten().collect()
    };
    let all: Vec<String> = (0..20).into_par_iter().flat_map(wrong).collect();
    // One in a hundred is the aim; of 60, more than 3 come once in 300.
    check(all.len() <= 3, format!("{} of 60: {all:?}", all.len()))?;
    let shared = |seed: u64| {
        let mut rng = Philox::new(42, seed, Stream::Host);
        let course = walk(COUNT, &mut rng);
        let size = course.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        let mut channel = |by: f64| {
            let noise = white(COUNT, &mut rng);
            noise.iter().zip(&course).map(|(e, c)| e + by * c / size).collect::<Vec<f64>>()
        };
        let channels = vec![channel(8.0), channel(-11.0)];
        judged(channels, None).is_ok_and(|v| v.effects.iter().any(|e| e.id == "temperature-sensitivity"))
    };
    let found = (0..20).into_par_iter().filter(|s| shared(*s)).count();
    check(found >= 16, format!("a common cause found in {found} of 20"))?;
    let alone = |seed: u64| {
        let mut rng = Philox::new(44, seed, Stream::Host);
        let course = sized(walk(COUNT, &mut rng), 2.0);
        let values = white(COUNT, &mut rng).iter().zip(course).map(|(e, c)| e + c).collect();
        judged(vec![values], None).is_ok_and(|v| v.effects.iter().any(|e| e.id == "random-walk"))
    };
    let found = (0..20).into_par_iter().filter(|s| alone(*s)).count();
    check(found >= 16, format!("a walk found in {found} of 20"))
}

/// The intervals of the exponent that a verdict states: beside its one name, or in its sentence where
/// the recording cannot tell the exponent from the law's; else the exponents of the laws named.
enum Exponents {
    Interval([f64; 2]),
    OfLaws(Vec<f64>),
}

fn exponents_of(verdict: &Verdict, effect: &Effect) -> Option<Exponents> {
    if let Some(stated) = effect.parameters.iter().find(|p| p.name == "exponent") {
        return Some(Exponents::Interval(stated.ci95));
    }
    if let Some((_, told)) = verdict.sentence.split_once("(exponent ") {
        let (low, high) = told.split_once(')')?.0.split_once(" to ")?;
        return Some(Exponents::Interval([low.parse().ok()?, high.parse().ok()?]));
    }
    let of = |id: &String| if id == "random-walk" { 2.0 } else { 1.0 };
    Some(Exponents::OfLaws(std::iter::once(&effect.id).chain(&effect.confusable_with).map(of).collect()))
}

/// A density as f^−α has one name with the interval of its exponent, and no second name for what the
/// nearest law leaves.
pub(super) fn exponents() -> Result<(), Failed> {
    const SEEDS: u64 = 40;
    // Whether there is one name, and the exponents that it may have.
    let named = |seed: u64, exponent: f64, id: &str| -> Option<Exponents> {
        let mut rng = Philox::new(46, seed, Stream::Host);
        let drift = sized(fractional(COUNT, exponent, &mut rng), 3.0);
        let values = white(COUNT, &mut rng).iter().zip(drift).map(|(e, d)| e + d).collect();
        let verdict = judged(vec![values], None).ok()?;
        let [one] = &verdict.effects[..] else { return None };
        let is_named = one.id == id || one.confusable_with.iter().any(|c| c == id);
        if is_named { exponents_of(&verdict, one) } else { None }
    };
    let (mut failures, mut all, mut right) = (Vec::new(), 0, 0);
    for (exponent, id) in [
        (0.7, "flicker-noise"),
        (0.8, "flicker-noise"),
        (1.3, "flicker-noise"),
        (1.7, "random-walk"),
        (2.0, "random-walk"),
    ] {
        let found: Vec<Exponents> = (0..SEEDS).into_par_iter().filter_map(|s| named(s, exponent, id)).collect();
        // Of those that state an interval, or name a law whose exponent is whole as the planted one.
        let whole = exponent == 2.0;
        let hold = |asked: f64| -> Vec<bool> {
            let one = |e: &Exponents| match e {
                Exponents::Interval([low, high]) => Some(*low <= asked && asked <= *high),
                Exponents::OfLaws(laws) => whole.then(|| laws.contains(&asked)),
            };
            found.iter().filter_map(one).collect()
        };
        let (stated, held) = (hold(exponent).len(), hold(exponent).iter().filter(|h| **h).count());
        let steeper = hold(exponent + 0.5).iter().filter(|h| **h).count();
        (all, right) = (all + stated, right + held);
        // 95 % of 40 less three standard errors; a law a tenth of its exponent off may be taken for
        // whole. Control: an exponent half a unit steeper is in none of them.
        if stated < 30 || 40 * held < 34 * stated || steeper > 0 {
            let told = format!("{held} of {stated} hold it, {steeper} a steeper one, {} named", found.len());
            failures.push(format!("f^−{exponent}: {told}"));
        }
    }
    check(failures.is_empty(), failures.join("\n"))?;
    // An interval is stated where the whole exponent is rejected, which keeps estimates that err away
    // from it: 159 of 179 hold, and fewer than 85 % come once in twenty at that rate.
    check(20 * right >= 17 * all, format!("{right} of {all} intervals hold the exponent"))?;
    let wrong =
        |s: &u64| matches!(named(*s, 2.0, "flicker-noise"), Some(Exponents::OfLaws(laws)) if !laws.contains(&2.0));
    let wrong = (0..20).into_par_iter().filter(wrong).count();
    check(wrong <= 4, format!("a walk taken for flicker in {wrong} of 20"))
}

/// A pickup whose frequency wanders is no rounding; the rounding of an integral that is then
/// differenced is (control).
pub(super) fn wandering_pickup() -> Result<(), Failed> {
    let said = |seed: u64, pickup: bool| {
        let mut rng = Philox::new(47, seed, Stream::Host);
        let noise = white(3 * COUNT, &mut rng);
        let values: Vec<f64> = if pickup {
            let course = |n: f64| (0.9 * n * (1.0 + 0.001 * n / COUNT as f64)).sin();
            noise.iter().enumerate().map(|(n, e)| e + 0.3 * course(n as f64)).collect()
        } else {
            let (mut sum, mut before, step) = (0.0, 0.0, 2.0);
            let mut rounded = |e: f64| {
                sum += e;
                let now = step * f64::round(sum / step);
                std::mem::replace(&mut before, now) - now
            };
            noise.into_iter().map(|e| -rounded(0.3 * e)).collect()
        };
        judged(vec![values], None)
    };
    let rounds = |seed: u64, pickup: bool| {
        said(seed, pickup).is_ok_and(|v| v.effects.iter().any(|e| e.id == "quantisation-noise"))
    };
    let honest = (0..20).into_par_iter().filter(|s| said(*s, true).is_ok_and(|v| v.verdict == Outcome::Unexplained));
    let honest = honest.count();
    check(honest >= 19, format!("{honest} of 20 wandering pickups unexplained"))?;
    let wrong = (0..20).into_par_iter().filter(|s| rounds(*s, true)).count();
    check(wrong == 0, format!("{wrong} of 20 wandering pickups called rounding"))?;
    let found = (0..20).into_par_iter().filter(|s| rounds(*s, false)).count();
    check(found >= 18, format!("{found} of 20 rounded integrals found"))
}

/// The same pole twice on the chip is a finding, and beside it no memory of the bias is named.
pub(super) fn filters() -> Result<(), Failed> {
    let quiet = |seed: u64| {
        let mut rng = Philox::new(43, seed, Stream::Host);
        let pole = 0.3 + 0.02 * seed as f64;
        let (mut first, mut second) = (0.0, 0.0);
        let mut filtered = |e: f64| {
            first += (1.0 - pole) * (e - first);
            second += (1.0 - pole) * (first - second);
            second
        };
        let values: Vec<f64> = white(4 * COUNT, &mut rng).into_iter().map(&mut filtered).collect();
        let said = judged(vec![values], None);
        said.is_ok_and(|v| v.verdict == Outcome::Adequate && v.findings.iter().any(|f| f.contains("filter")))
    };
    let silent = (0..20).into_par_iter().filter(|s| quiet(*s)).count();
    check(silent >= 19, format!("{silent} of 20 adequate with a filter found"))?;
    // Control: a long memory behind the same filter keeps its name.
    let remembers = |seed: u64| {
        let mut rng = Philox::new(45, seed, Stream::Host);
        let (mut first, mut second) = (0.0, 0.0);
        let mut filtered = |e: f64| {
            first += 0.6 * (e - first);
            second += 0.6 * (first - second);
            second
        };
        let noise: Vec<f64> = white(4 * COUNT, &mut rng).into_iter().map(&mut filtered).collect();
        let slow = sized(relaxation(4 * COUNT, 300.0, &mut rng), 1.0);
        let values = noise.iter().zip(slow).map(|(e, s)| e + s).collect();
        judged(vec![values], None).is_ok_and(|v| v.effects.iter().any(|e| e.id == "gauss-markov"))
    };
    let found = (0..20).into_par_iter().filter(|s| remembers(*s)).count();
    check(found >= 16, format!("a long memory behind a filter found in {found} of 20"))
}

/// White noise behind a moving average of 5, 8 or 16 readings is a finding and no drift: what the
/// two ends of the log leak into the zeros of the filter is no evidence of one. A walk beneath the
/// average keeps its name (control).
pub(super) fn averages() -> Result<(), Failed> {
    const READINGS: [usize; 3] = [5, 8, 16];
    const SEEDS: u64 = 16;
    let averaged = |readings: usize, rng: &mut Philox| -> Vec<f64> {
        let noise = white(COUNT + readings - 1, rng);
        let size = (readings as f64).sqrt();
        noise.windows(readings).map(|w| w.iter().sum::<f64>() / size).collect()
    };
    let cases: Vec<(usize, u64)> = READINGS.iter().flat_map(|m| (0..SEEDS).map(|s| (*m, s))).collect();
    let alarm = |(readings, seed): &(usize, u64)| -> Option<String> {
        let mut rng = Philox::new(48, *seed, Stream::Host);
        let verdict = match judged(vec![averaged(*readings, &mut rng), averaged(*readings, &mut rng)], None) {
            Ok(verdict) => verdict,
            Err(error) => return Some(format!("{readings} readings, {seed}: {error:?}")),
        };
        let is_right = verdict.verdict == Outcome::Adequate && verdict.findings.iter().any(|f| f.contains("filter"));
        (!is_right).then(|| format!("{readings} readings, {seed}: {}", verdict.sentence))
    };
    let alarms: Vec<String> = cases.par_iter().filter_map(alarm).collect();
    // One in a hundred is the aim; of 48, more than 3 come less than once in 500.
    check(alarms.len() <= 3, format!("{} of {}: {alarms:?}", alarms.len(), cases.len()))?;
    let walks = |(readings, seed): &&(usize, u64)| -> bool {
        let mut rng = Philox::new(49, *seed, Stream::Host);
        let drift = sized(walk(COUNT, &mut rng), 1.0);
        let values = averaged(*readings, &mut rng).iter().zip(drift).map(|(n, d)| n + d).collect();
        let is_walk = |e: &Effect| e.id == "random-walk" || e.confusable_with.iter().any(|c| c == "random-walk");
        judged(vec![values], None).is_ok_and(|v| v.effects.iter().any(is_walk))
    };
    let found = cases.par_iter().filter(walks).count();
    // 95 %, less two and a half standard errors.
    check(found >= 42, format!("a walk found in {found} of {}", cases.len()))
}
