//! Sensors at rest: each planted effect is found alone, nothing is found where nothing is, foreign
//! physics gets no name.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::model::{Noise, Static, StaticColumns};
use proofmass::diagnosis::rest;
use proofmass::diagnosis::verdict::{Effect, Outcome, Verdict};
use proofmass::recording::{Column, Recording};
use proofmass::report::diagnosis::{Diagnosis, worded};
use proofmass::rng::{Philox, Stream};
use rand::RngExt as _;
use rayon::prelude::*;

use super::world::{check, data_test, test};

use plant::{PLANTED, Plant, relaxation, sized, smoothed, walk, white};

mod frozen;
mod level;
mod near;
mod place;
pub mod plant;
mod recordings;
mod together;
mod watched;

fn diagnose(recording: &Recording, model: &Static) -> proofmass::error::Result<Diagnosis> {
    rest::diagnose(recording, model, &Control::silent()).map(worded)
}

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("static: silence on 600 recordings of white noise alone", nulls),
        test("static: every planted effect is found alone, with intervals that cover", planted),
        test("static: a filter in the sensor is a finding, not an effect, and hides none", band_limit),
        test("static: the same pole twice is a filter, and no memory of the bias", near::filters),
        test("static: a moving average of white noise is a filter, and no drift", near::averages),
        test("static: powers of time have no cause in common, what settles in two speeds is no walk", near::courses),
        test("static: a density near 1/f has one name, with its exponent", near::exponents),
        test("static: a pickup whose frequency wanders is no rounding", near::wandering_pickup),
        test("static: intervals of the means hold the bias, whatever the noise", place::intervals),
        test("static: gravity and the Earth's rate are references, and name nothing", place::references),
        test("static: what one channel cannot describe leaves the names of another alone", channel_by_channel),
        test("static: rounding coarser than the noise is named alone, wherever the value lies", coarse),
        test("static: noise as real sensors have it is adequate and said", noisy),
        test(
            "static: a level that departs from the promise for a while, or in a band, is no white-noise",
            level::passing,
        ),
        test("static: a walk beside a knock keeps its name, and the knock is told", knocked),
        test("static: physics outside the library is unexplained and gets no name", foreign),
        test("static: a bias that jumps, in one channel or in all, is not called drift", jumps),
        test("static: popcorn noise is told from a Gauss–Markov process of the same spectrum", popcorn),
        test("static: rows in which a reading hangs are left out, said, and named as nothing", frozen::rows),
        test("static: popcorn about a temperature, a ramp or a warm-up is told", together::hops_about_a_course),
        test("static: a course with a memory, and two courses, keep their names", together::courses_and_memories),
        test(
            "static: lag and play are one temperature, and a bend without a law is no noise",
            together::forms_of_a_temperature,
        ),
        test("static: long work says what it does, as many steps as there are channels", watched::told),
        data_test(
            "static: the ADIS16405's vibration is located, not named, and its roll-off is a finding",
            recordings::adis,
        ),
        data_test("static: the Sense HAT's accelerometer follows a common cause, its gyro none", recordings::sense_hat),
    ]
}

pub const RATE_HZ: f64 = 50.0;

/// Channels `c0`, `c1` … of a sensor at rest, with their model.
pub fn asked(channels: Vec<Vec<f64>>, density: Option<f64>) -> (Recording, Static) {
    let names: Vec<String> = (0..channels.len()).map(|i| format!("c{i}")).collect();
    let columns = names.iter().cloned().zip(channels).map(|(name, values)| Column { name, values }).collect();
    let recording = Recording { path: "planted.csv".into(), rate_hz: RATE_HZ, columns, ..Recording::default() };
    let noise = density.map(|density| Noise { density, bias_instability: 0.0, random_walk: 0.0 });
    let model = Static {
        force_rate: false,
        topic: None,
        rate_hz: Some(RATE_HZ),
        rows: Vec::new(),
        unit: "g".into(),
        latitude_deg: None,
        height_m: None,
        columns: StaticColumns { time: None, channels: names, environment: Vec::new() },
        noise,
        split: Default::default(),
    };
    (recording, model)
}

fn judged(channels: Vec<Vec<f64>>, density: Option<f64>) -> Result<Verdict, Failed> {
    let (recording, model) = asked(channels, density);
    Ok(diagnose(&recording, &model)?.verdict)
}

fn nulls() -> Result<(), Failed> {
    let alarms: Vec<String> = (0..600u64)
        .into_par_iter()
        .filter_map(|seed| {
            let mut rng = Philox::new(1, seed, Stream::Host);
            let count = 500 + 3 * (seed as usize % 500);
            match judged(vec![white(count, &mut rng), white(count, &mut rng)], None) {
                Ok(v) if v.verdict == Outcome::Adequate => None,
                Ok(v) => Some(format!("{seed}: {}", v.sentence)),
                Err(e) => Some(e.message().unwrap_or_default().to_owned()),
            }
        })
        .collect();
    // One per cent, plus two and a half standard errors of a count of six.
    check(alarms.len() <= 12, format!("{} alarms in 600: {:?}", alarms.len(), alarms))
}

fn planted() -> Result<(), Failed> {
    const REPLICAS: u64 = 20;
    const COUNT: usize = 6000;
    let named = |v: &Verdict, id: &str| {
        !v.effects.is_empty()
            && v.effects.iter().all(|e| e.id == id || e.confusable_with.iter().any(|c| c == id))
            && matches!(v.verdict, Outcome::Explained | Outcome::Undecidable)
    };
    let (mut right, mut failures) = (0, Vec::new());
    for (id, size, plant) in PLANTED {
        let verdicts: Vec<(u64, Verdict)> = (0..REPLICAS)
            .into_par_iter()
            .filter_map(|seed| {
                let mut rng = Philox::new(2, seed, Stream::Host);
                let effect = sized(plant(COUNT, &mut rng), size);
                let noise = white(COUNT, &mut rng);
                let values = noise.iter().zip(effect).map(|(n, e)| 1e-3 * (n + e)).collect();
                Some((seed, judged(vec![values, white(COUNT, &mut rng)], None).ok()?))
            })
            .collect();
        for (seed, verdict) in verdicts {
            let found = named(&verdict, id);
            right += usize::from(found);
            if !found {
                failures.push(format!("{id} {seed}: {:?} {}", verdict.verdict, verdict.sentence));
            }
        }
    }
    let total = PLANTED.len() * REPLICAS as usize;
    check(right as f64 >= 0.9 * total as f64, format!("{right} of {total} named right\n{}", failures.join("\n")))?;
    levels()
}

/// Rounding and a level other than promised.
fn levels() -> Result<(), Failed> {
    let mut rng = Philox::new(3, 0, Stream::Host);
    let rounded: Vec<f64> = white(6000, &mut rng).iter().map(|v| (v / 1.5).round() * 1.5).collect();
    let verdict = judged(vec![rounded], None)?;
    check(verdict.effects.iter().map(|e| e.id.as_str()).eq(["quantisation-noise"]), verdict.sentence.clone())?;
    check(verdict.effects[0].parameters[0].value == 1.5, format!("{:?}", verdict.effects[0].parameters))?;
    let density = (2.0 / RATE_HZ).sqrt();
    let as_promised = judged(vec![white(6000, &mut rng)], Some(density))?;
    check(as_promised.verdict == Outcome::Adequate, as_promised.sentence)?;
    let (mut covered, mut others) = (0, 0);
    for seed in 0..60 {
        let louder = white(3000, &mut Philox::new(5, seed, Stream::Host)).iter().map(|v| v * 1.3).collect();
        let verdict = judged(vec![louder], Some(density))?;
        let Some(effect) = verdict.effects.iter().find(|e| e.id == "white-noise") else {
            return Err(format!("{seed}: {}", verdict.sentence).into());
        };
        others += verdict.effects.len() - 1;
        let [low, high] = effect.parameters[0].ci95;
        covered += usize::from((low..=high).contains(&(1.3 * density)));
    }
    // The false-alarm rate is half a per cent: three in sixty happen once in four hundred runs of
    // other seeds.
    check(others <= 2, format!("{others} effects beside the level"))?;
    // 95 % of 60, less two and a half standard errors.
    check(covered >= 53, format!("{covered} of 60 intervals cover the level"))
}

fn band_limit() -> Result<(), Failed> {
    let filtered = |v: &Verdict| v.findings.iter().any(|f| f.contains("filter"));
    let (mut named_alone, mut others) = (0, Vec::new());
    for seed in 0..10 {
        let mut rng = Philox::new(6, seed, Stream::Host);
        let alone = judged(vec![smoothed(&white(6001, &mut rng))], None)?;
        check(alone.verdict == Outcome::Adequate && filtered(&alone), format!("{seed}: {}", alone.sentence))?;
        let drift = sized(walk(6001, &mut rng), 2.0);
        let with_walk: Vec<f64> = white(6001, &mut rng).iter().zip(drift).map(|(n, w)| n + w).collect();
        let both = judged(vec![smoothed(&with_walk)], None)?;
        let ids: Vec<&str> = both.effects.iter().map(|e| e.id.as_str()).collect();
        named_alone += usize::from(ids == ["random-walk"]);
        if ids != ["random-walk"] {
            others.push(format!("{seed}: {}", both.sentence));
        }
        let walk = |e: &Effect| e.id == "random-walk" || e.confusable_with.iter().any(|c| c == "random-walk");
        check(both.effects.iter().any(walk) && filtered(&both), format!("{seed}: {}", both.sentence))?;
        let open = judged(vec![white(6000, &mut rng)], None)?;
        check(!filtered(&open), format!("{seed}: a filter where there is none"))?;
    }
    // 95 % of ten, less one and a half standard errors.
    check(named_alone >= 8, format!("{named_alone} of 10 walks named alone\n{}", others.join("\n")))
}

fn channel_by_channel() -> Result<(), Failed> {
    let (mut right, mut others) = (0, Vec::new());
    for seed in 0..10 {
        let mut rng = Philox::new(7, seed, Stream::Host);
        let drift = sized(walk(6000, &mut rng), 2.0);
        let drifting = white(6000, &mut rng).iter().zip(drift).map(|(n, w)| n + w).collect();
        // Foreign: noise of nine times the power, at once, in the last third.
        let swelling =
            white(6000, &mut rng).iter().enumerate().map(|(i, v)| if i > 4000 { 3.0 * v } else { *v }).collect();
        let verdict = judged(vec![drifting, swelling], None)?;
        let named = verdict.effects.iter().map(|e| (e.id.as_str(), e.channels[0].as_str()));
        let is_right = verdict.verdict == Outcome::Unexplained
            && named.eq([("random-walk", "c0")])
            && verdict.location.summary.contains("c1: its noise is not steady");
        right += usize::from(is_right);
        if !is_right {
            others.push(format!("{seed}: {} {}", verdict.sentence, verdict.location.summary));
        }
    }
    // 95 % of ten, less one and a half standard errors.
    check(right >= 8, format!("{right} of 10\n{}", others.join("\n")))
}

fn coarse() -> Result<(), Failed> {
    let density = (2.0 / RATE_HZ).sqrt();
    let (mut right, mut silent) = (0, 0);
    for seed in 0..40u64 {
        let mut rng = Philox::new(8, seed, Stream::Host);
        let place = 3.0 * seed as f64 / 40.0;
        let round = |v: f64| ((v + place) / 3.0).round() * 3.0;
        let as_promised = judged(vec![white(4000, &mut rng).into_iter().map(round).collect()], Some(density))?;
        right += usize::from(as_promised.effects.iter().map(|e| e.id.as_str()).eq(["quantisation-noise"]));
        // Negative control: noise of 1.4 times the promise before the same rounding has both names.
        let louder = judged(vec![white(4000, &mut rng).into_iter().map(|v| round(1.4 * v)).collect()], Some(density))?;
        silent += usize::from(!louder.effects.iter().any(|e| e.id == "white-noise"));
    }
    check(right >= 38, format!("{right} of 40 named alone"))?;
    check(silent <= 2, format!("a level wrong by 40 % is missed in {silent} of 40"))
}

fn foreign() -> Result<(), Failed> {
    // A step, bursts, a telegraph of two levels, a chirp, single spikes.
    const FOREIGN: [(&str, f64, Plant); 5] = [
        ("step", 2.0, |n, _| (0..n).map(|i| if i > 6 * n / 10 { 1.0 } else { 0.0 }).collect()),
        ("burst", 1.0, |n, rng| {
            white(n, rng).iter().enumerate().map(|(i, v)| if i / 200 % 9 == 4 { *v } else { 0.0 }).collect()
        }),
        ("telegraph", 2.0, |n, _| (0..n).map(|i| if i * i / 700_000 % 2 == 0 { 1.0 } else { -1.0 }).collect()),
        ("chirp", 1.0, |n, _| (0..n).map(|i| (0.2 * i as f64 + 4e-5 * (i * i) as f64).sin()).collect()),
        ("spikes", 0.7, |n, _| (0..n).map(|i| if i % 311 == 7 { 1.0 } else { 0.0 }).collect()),
    ];
    let mut wrong = Vec::new();
    for (name, size, plant) in FOREIGN {
        for seed in 0..5 {
            let mut rng = Philox::new(4, seed, Stream::Host);
            let effect = sized(plant(6000, &mut rng), size);
            let values = white(6000, &mut rng).iter().zip(effect).map(|(n, e)| n + e).collect();
            let verdict = judged(vec![values], None)?;
            if verdict.verdict != Outcome::Unexplained || !verdict.effects.is_empty() {
                wrong.push(format!("{name} {seed}: {:?} {}", verdict.verdict, verdict.sentence));
            }
        }
    }
    check(wrong.len() <= 3, format!("{} of 25 not unexplained\n{}", wrong.len(), wrong.join("\n")))
}

/// Noise as real sensors have it, with nothing else in it: heavy tails, a level that swells, bad
/// readings.
fn noisy() -> Result<(), Failed> {
    const COUNT: usize = 6000;
    // Student's t with so many degrees of freedom.
    let tailed = |degrees: u32, rng: &mut Philox| -> Vec<f64> {
        let one = |rng: &mut Philox| {
            let squares = (0..degrees).map(|_| rng.normal().powi(2)).sum::<f64>();
            rng.normal() / (squares / f64::from(degrees)).sqrt()
        };
        (0..COUNT).map(|_| one(rng)).collect()
    };
    let mut wrong = Vec::new();
    for seed in 0..20u64 {
        let mut rng = Philox::new(11, seed, Stream::Host);
        let swell: Vec<f64> =
            white(COUNT, &mut rng).iter().enumerate().map(|(i, v)| v * (1.0 + i as f64 / COUNT as f64)).collect();
        let mut stray = white(COUNT, &mut rng);
        stray[37 + 290 * seed as usize] = 1e4;
        let row = format!("row {}", 38 + 290 * seed);
        for (name, values, said) in [
            ("three degrees of freedom", tailed(3, &mut rng), "heavier tails"),
            ("five degrees of freedom", tailed(5, &mut rng), ""),
            ("a level that swells", swell, "uneven"),
            ("a bad reading", stray, row.as_str()),
        ] {
            let verdict = judged(vec![values], None)?;
            let is_said = said.is_empty() || verdict.findings.iter().any(|f| f.contains(said));
            if verdict.verdict != Outcome::Adequate || !verdict.effects.is_empty() || !is_said {
                wrong.push(format!("{name} {seed}: {:?} {} {:?}", verdict.verdict, verdict.sentence, verdict.findings));
            }
        }
    }
    // The false-alarm rate is half a per cent: three in eighty come by chance once in a hundred.
    check(wrong.len() <= 3, format!("{} of 80\n{}", wrong.len(), wrong.join("\n")))
}

/// A walk beside a knock, and as a control the knock alone: neither hides the other, and neither is
/// taken for the other.
fn knocked() -> Result<(), Failed> {
    const COUNT: usize = 10_000;
    let (mut right, mut others) = (0, Vec::new());
    for seed in 0..20u64 {
        let mut rng = Philox::new(12, seed, Stream::Host);
        let place = 2000 + 300 * seed as usize;
        let knock = |n: usize| match n.checked_sub(place) {
            Some(k) if k < 60 => 40.0 * (-(k as f64) / 15.0).exp() * (k as f64).cos(),
            _ => 0.0,
        };
        let alone: Vec<f64> = white(COUNT, &mut rng).iter().enumerate().map(|(n, v)| v + knock(n)).collect();
        let drift = sized(walk(COUNT, &mut rng), 2.0);
        let both: Vec<f64> =
            white(COUNT, &mut rng).iter().zip(drift).enumerate().map(|(n, (v, d))| v + d + knock(n)).collect();
        let (alone, both) = (judged(vec![alone], None)?, judged(vec![both], None)?);
        let told = |v: &Verdict| v.verdict == Outcome::Unexplained && v.sentence.contains("knock");
        // A walk seen through a knock may also be a slow Gauss–Markov process: the two are then
        // told as tied.
        let walk = |e: &Effect| e.id == "random-walk" || e.confusable_with.iter().any(|c| c == "random-walk");
        let walks = !both.effects.is_empty() && both.effects.iter().all(walk);
        let is_right = told(&alone) && alone.effects.is_empty() && told(&both) && walks;
        right += usize::from(is_right);
        if !is_right {
            others.push(format!("{seed}: alone: {} both: {}", alone.sentence, both.sentence));
        }
    }
    check(right >= 18, format!("{right} of 20\n{}", others.join("\n")))
}

/// Faint foreign drift that has the spectrum of a walk, of a louder level or of a common cause.
fn jumps() -> Result<(), Failed> {
    const COUNT: usize = 10_000;
    let once = |at: usize, size: f64| -> Vec<f64> { (0..COUNT).map(|i| if i > at { size } else { 0.0 }).collect() };
    let plus = |drift: &[f64], rng: &mut Philox| -> Vec<f64> {
        white(COUNT, rng).iter().zip(drift).map(|(n, d)| n + d).collect()
    };
    let (mut honest, mut wrong) = (0, Vec::new());
    for seed in 0..8u64 {
        let mut rng = Philox::new(9, seed, Stream::Host);
        let jump = once(2500 + 600 * seed as usize, 1.4);
        let growing: Vec<f64> =
            white(COUNT, &mut rng).iter().enumerate().map(|(i, v)| v * (1.0 + i as f64 / COUNT as f64)).collect();
        for (name, channels, density) in [
            ("one jump", vec![plus(&jump, &mut rng), white(COUNT, &mut rng)], None),
            ("a jump of all", (0..3).map(|_| plus(&jump, &mut rng)).collect(), None),
            ("growing noise", vec![growing], Some((2.0 / RATE_HZ).sqrt())),
        ] {
            let verdict = judged(channels, density)?;
            // Noise that begins at the promised level and grows to twice that is no other level:
            // the mismatch has no name.
            let grows = name == "growing noise";
            let said = !grows || verdict.location.summary.contains("its noise is not steady");
            let names = verdict.effects.iter().all(|e| !grows && e.id == "white-noise");
            let fine = said && verdict.verdict == Outcome::Unexplained && names;
            honest += usize::from(fine);
            if !fine {
                wrong.push(format!("{name} {seed}: {:?} {}", verdict.verdict, verdict.sentence));
            }
        }
    }
    check(honest >= 22, format!("{honest} of 24 right\n{}", wrong.join("\n")))
}

/// Hops between two levels, and as a control a Gaussian process of the same strength and
/// correlation.
fn popcorn() -> Result<(), Failed> {
    const COUNT: usize = 10_000;
    let cases: Vec<(u64, f64, f64)> =
        (0..24u64).map(|k| (k, [0.5, 1.0, 3.0][k as usize % 3], 100.0 * (1 + k % 12) as f64)).collect();
    let right = |gaussian: bool, (seed, size, dwell): (u64, f64, f64)| {
        let mut rng = Philox::new(10, seed, Stream::Host);
        let mut level = 1.0;
        let mut hop = |rng: &mut Philox| {
            level *= if rng.random::<f64>() < 1.0 / dwell { -1.0 } else { 1.0 };
            level
        };
        let drift: Vec<f64> = match gaussian {
            true => relaxation(COUNT, dwell / 2.0, &mut rng),
            false => (0..COUNT).map(|_| hop(&mut rng)).collect(),
        };
        let values = white(COUNT, &mut rng).iter().zip(drift).map(|(n, d)| n + size * d).collect();
        let Ok(verdict) = judged(vec![values], None) else { return false };
        let two_levels = verdict.sentence.contains("two levels") || verdict.sentence.contains("jumps");
        match gaussian {
            true => verdict.verdict != Outcome::Unexplained,
            false => verdict.verdict == Outcome::Unexplained && verdict.effects.is_empty() && two_levels,
        }
    };
    let judge = |gaussian: bool| cases.par_iter().filter(|case| right(gaussian, **case)).count();
    let (found, alarms) = (judge(false), cases.len() - judge(true));
    // Each would be found nearly always (the power simulated beside the unit tests is 20 of 20 from
    // half the noise on).
    check(found >= 23, format!("{found} of 24 unexplained and without a name"))?;
    // Verdicts on true drift are wrong in 1 % or so: three of 24 come by chance once in 400.
    check(alarms <= 2, format!("{alarms} of 24 Gaussian processes unexplained"))
}
