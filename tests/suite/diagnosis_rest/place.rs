//! The means at rest: intervals that hold the bias under noise that does not average out, and the
//! Earth as a reference for three of them.

use libtest_mimic::Failed;
use proofmass::diagnosis::model::{Static, StaticColumns};
use proofmass::diagnosis::verdict::{Estimate, Verdict};
use proofmass::recording::{Column, Recording};
use proofmass::rng::{Philox, Stream};
use rayon::prelude::*;

use super::plant::{fractional, white};
use super::{check, diagnose, judged};

const COUNT: usize = 1500;

fn mean_of(verdict: &Verdict) -> Result<&Estimate, Failed> {
    verdict.base.first().filter(|e| e.name == "mean of c0").ok_or_else(|| "no mean".into())
}

/// The bias that noise was added to lies in its interval under white noise, 1/f noise and a walk
/// that began with the recording.
pub(super) fn intervals() -> Result<(), Failed> {
    const SEEDS: u64 = 200;
    const BIAS: f64 = 7.0;
    // Noise of an exponent beside white noise of unit size, by its own size per sample: the walk
    // rises out of the white noise at 1/160 of the sampling rate, 1/f noise at 1/25.
    for (exponent, size) in [(0.0, 1.0), (1.0, 0.5), (2.0, 0.04)] {
        let seen: Vec<[bool; 2]> = (0..SEEDS)
            .into_par_iter()
            .map(|seed| {
                let mut rng = Philox::new(81, seed, Stream::Host);
                let slow = fractional(COUNT, exponent, &mut rng);
                let values: Vec<f64> =
                    white(COUNT, &mut rng).iter().zip(&slow).map(|(w, s)| BIAS + w + size * s).collect();
                let verdict = judged(vec![values], None)?;
                let mean = mean_of(&verdict)?;
                let told = verdict.findings.iter().any(|f| f.contains("`: mean "));
                Ok([mean.ci95[0] <= BIAS && BIAS <= mean.ci95[1], told])
            })
            .collect::<Result<_, Failed>>()?;
        let held = seen.iter().filter(|s| s[0]).count();
        // 93 to 97 % of 200, more and less two standard errors of a count at 95 %.
        check((180..=199).contains(&held), format!("exponent {exponent}: {held} of {SEEDS} intervals hold the bias"))?;
        let told = seen.iter().filter(|s| s[1]).count();
        let as_it_should = if exponent > 0.0 { told >= 180 } else { told <= 2 };
        check(as_it_should, format!("exponent {exponent}: {told} of {SEEDS} tell the mean from the bias"))?;
    }
    Ok(())
}

/// Latitude, °, and height, m.
type Place = (Option<f64>, Option<f64>);

/// Three channels that read this vector with white noise, at a place or none.
fn at(vector: [f64; 3], unit: &str, (latitude_deg, height_m): Place) -> Result<Verdict, Failed> {
    let names = ["x", "y", "z"].map(str::to_owned);
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut rng = Philox::new(82, 0, Stream::Host);
    // The mean of 1500 samples is known to 3 in a million.
    let mut channel =
        |mean: f64| -> Vec<f64> { white(COUNT, &mut rng).iter().map(|w| mean + 1e-4 * length * w).collect() };
    let columns = names.iter().zip(vector).map(|(name, mean)| Column { name: name.clone(), values: channel(mean) });
    let recording =
        Recording { path: "planted.csv".into(), rate_hz: 50.0, columns: columns.collect(), ..Recording::default() };
    let model = Static {
        force_rate: false,
        topic: None,
        rate_hz: Some(50.0),
        rows: Vec::new(),
        unit: unit.into(),
        latitude_deg,
        height_m,
        columns: StaticColumns { time: None, channels: names.to_vec(), environment: Vec::new() },
        noise: None,
        split: Default::default(),
    };
    Ok(diagnose(&recording, &model)?.verdict)
}

/// What is said of gravity or the Earth's rate at height 0, and nothing named for it.
fn said(vector: [f64; 3], unit: &str, latitude_deg: Option<f64>) -> Result<Option<String>, Failed> {
    said_at(vector, unit, (latitude_deg, latitude_deg.map(|_| 0.0)))
}

/// The same at a place.
fn said_at(vector: [f64; 3], unit: &str, place: Place) -> Result<Option<String>, Failed> {
    let verdict = at(vector, unit, place)?;
    check(verdict.effects.is_empty(), "one pose names nothing")?;
    let of_earth = |f: &String| f.starts_with("`local-gravity`") || f.starts_with("`earth-rate`");
    Ok(verdict.findings.into_iter().find(of_earth))
}

/// Gravity at 45° is 9.80620 m/s², at 60° 9.81918 (Moritz, GRS 80, Journal of Geodesy 74, 2000);
/// the Earth turns at 7.292115e-5 rad/s (IERS), 15.0411 °/h.
pub(super) fn references() -> Result<(), Failed> {
    let along = |length: f64| [0.48 * length, 0.6 * length, 0.64 * length];
    let expect = |found: Option<String>, words: &[&str]| {
        let found = found.ok_or("nothing is said")?;
        check(words.iter().all(|w| found.contains(w)), format!("{words:?} in: {found}"))
    };
    expect(said(along(9.80620), "m/s2", Some(45.0))?, &["`local-gravity`", "9.80620", "they agree"])?;
    expect(said(along(1.0), "g", Some(45.532))?, &["`local-gravity`", "they agree"])?;
    // A wrong latitude is seen, and a scale error of the same size is not told from it.
    let there = said(along(9.80620), "m/s2", Some(60.0))?;
    expect(there, &["less", "1320 ppm", "gravity at 45", "look alike in one pose, so none is named"])?;
    // Control: a scale error beyond the Earth's range is no gravity of any place.
    let scaled = said(along(9.80620 * 1.01), "m/s2", Some(45.0))?;
    expect(scaled, &["more", "10000 ppm", "no latitude at this height has such gravity"])?;
    expect(said(along(15.041_067), "deg/h", Some(45.0))?, &["`earth-rate`", "15.0411", "they agree"])?;
    expect(said(along(7.292_115e-5), "rad/s", Some(45.0))?, &["`earth-rate`", "they agree"])?;
    expect(said(along(10.0), "deg/h", Some(45.0))?, &["5.04 deg/h less", "biases of 5.04 to 25.0 deg/h"])?;
    // Controls: nothing without a place, of an unknown unit, or of gravity in a gyro's unit.
    for (unit, latitude_deg) in [("m/s2", None), ("counts", Some(45.0))] {
        check(said(along(9.80620), unit, latitude_deg)?.is_none(), format!("{unit}, {latitude_deg:?}"))?;
    }
    check(at(along(9.8), "m/s2", (Some(95.0), None)).is_err(), "a latitude beyond the pole")?;
    // Without a height it is said that none was given, and which was taken; with one it is not.
    let assumed = said_at(along(9.80620), "m/s2", (Some(45.0), None))?;
    expect(assumed, &["9.80620", "they agree", "0 m, assumed because height_m is not given"])?;
    for height_m in [0.0, 1000.0] {
        let stated = said_at(along(9.80620), "m/s2", (Some(45.0), Some(height_m)))?.unwrap_or_default();
        check(!stated.contains("assumed") && stated.contains("local-gravity"), stated)?;
    }
    Ok(())
}
