//! Allan curves and their coefficients: what is put in comes out, with intervals that cover as
//! often as they claim.

use libtest_mimic::{Failed, Trial};
use proofmass::numerics::allan::law::Term;
use proofmass::numerics::allan::{self, fitted::Fit};
use proofmass::recording::finding::{Finding, sentences};
use proofmass::recording::unit::{Quantity, Unit};
use proofmass::recording::{Request, noise};
use proofmass::rng::{Philox, Stream};
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("allan: white noise, flicker and walk come back, covered as claimed", || {
            round_trip("N, B, K", [0.0, 0.1, 0.02, 0.003, 0.0])
        }),
        test("allan: quantisation, white noise and a ramp come back, covered as claimed", || {
            round_trip("Q, N, R", [0.02, 0.1, 0.0, 0.0, 2e-4])
        }),
        test(
            "allan: behind an averaging filter, or with heavy tails, N is covered, by intervals less than 1.5 times too narrow",
            spoiled,
        ),
        test("allan: a white log has reached no floor and says so, one with flicker has", floor),
        test("allan: a stray reading and a knock are left out and said; noise, its tails and a step stay", strays),
        data_test("allan: the stray reading of the third Xsens axis does not inflate its noise", fleet),
        test("allan: the command writes JSON, a page and a sensor for a study, or one sentence why not", command),
        data_test("allan: the ADIS16405 has the coefficients known of it", adis16405),
    ]
}

const RATE_HZ: f64 = 10.0;

/// A signal of the five terms, made from their definitions (not from the fit's laws). Flicker is a
/// sum of Gauss–Markov processes three apart in correlation time: density Σ 4σ²τ/(1 + (2πfτ)²) →
/// σ²/(f ln 3), so σ² = B² ln 3/π.
fn signal(count: usize, [q, n, b, k, r]: [f64; 5], rng: &mut impl Rng) -> Vec<f64> {
    let step_s = 1.0 / RATE_HZ;
    let mut normal = || rng.sample::<f64, _>(StandardNormal);
    let mut markov: Vec<(f64, f64, f64)> = (0..14)
        .map(|i| {
            let memory = (-step_s / (0.5 * step_s * 3f64.powi(i))).exp();
            let sigma = b * (3f64.ln() / std::f64::consts::PI).sqrt();
            (memory, sigma, sigma * normal())
        })
        .collect();
    let (mut walk, mut corner) = (0.0, q * normal());
    (0..count)
        .map(|i| {
            let before = corner;
            corner = q * normal();
            walk += k * step_s.sqrt() * normal();
            for (memory, sigma, state) in &mut markov {
                *state = *memory * *state + *sigma * (1.0 - *memory * *memory).sqrt() * normal();
            }
            let flicker: f64 = markov.iter().map(|m| m.2).sum();
            (corner - before) / step_s + n * RATE_HZ.sqrt() * normal() + flicker + walk + r * i as f64 * step_s
        })
        .collect()
}

fn round_trip(name: &str, truth: [f64; 5]) -> Result<(), Failed> {
    const REPLICAS: u64 = 160;
    let fits: Vec<Fit> = (0..REPLICAS)
        .into_par_iter()
        .filter_map(|replica| {
            let mut rng = Philox::new(11, replica, Stream::Host);
            let values = signal(32_768, truth, &mut rng);
            allan::fit::fit(&allan::curve(&values, RATE_HZ), RATE_HZ, 0.0, &mut rng)
        })
        .collect();
    check(fits.len() as u64 == REPLICAS, "every replica can be fitted")?;
    let good = fits.iter().filter(|f| f.good()).count() as f64 / REPLICAS as f64;
    check(good >= 0.95, format!("{name}: only {good} of the fits are called good"))?;
    for (p, want) in truth.into_iter().enumerate() {
        let inside = |f: &&Fit| (f.coefficients[p].ci95[0]..=f.coefficients[p].ci95[1]).contains(&want);
        let covered = fits.iter().filter(inside).count() as f64 / REPLICAS as f64;
        let symbol = allan::law::TERMS[p].symbol();
        // Two and a half standard errors of a share of 95 % below it; an estimate at the wall of
        // zero covers more often.
        check(covered >= 0.907, format!("{name}: {symbol} is covered in {covered} of the replicas"))?;
        let narrow = |f: &&Fit| {
            let c = f.coefficients[p];
            (c.value - 0.4 * (c.value - c.ci95[0])..=c.value + 0.4 * (c.ci95[1] - c.value)).contains(&want)
        };
        let narrow = fits.iter().filter(narrow).count() as f64 / REPLICAS as f64;
        check(
            want == 0.0 || narrow < 0.8,
            format!("{name}: {symbol} is covered in {narrow} even by 0.4 of the interval"),
        )?;
    }
    Ok(())
}

/// White noise of N = 1 unit·√s as a chip that averages 2 to 8 samples gives it, and with the tails of Student's
/// t of three degrees of freedom (scaled to variance one): N is that of the sensor. An interval of 95 % that is 1.5
/// times too narrow would hold it in 81 % (1.96/1.5 standard deviations): that is the floor. Control: of heavy tails
/// without a variance of their own, intervals are 2.3 times too narrow or more (60 %).
fn spoiled() -> Result<(), Failed> {
    const REPLICAS: u64 = 80;
    const SAMPLES: usize = 12_000;
    const FLOOR: f64 = 0.81;
    let noise = |replica: u64, taps: usize, has_tails: bool| -> Vec<f64> {
        let mut rng = Philox::new(14, replica, Stream::Host);
        let mut normal = || rng.sample::<f64, _>(StandardNormal);
        let mut draw = || match has_tails {
            // Student's t has variance three.
            true => normal() / [normal(), normal(), normal()].iter().map(|x| x * x).sum::<f64>().sqrt(),
            false => normal(),
        };
        let values: Vec<f64> = (0..SAMPLES + taps).map(|_| draw()).collect();
        values.windows(taps).map(|w| w.iter().sum::<f64>() / taps as f64).collect()
    };
    let held = |taps: usize, has_tails: bool, is_told: bool| -> Result<f64, Failed> {
        let of = |replica: u64| -> Option<bool> {
            let values = noise(replica, taps, has_tails);
            let n = match is_told {
                true => noise::describe("x", Unit::unknown(), (&values, 1.0), replica)?.fit?.coefficients[1],
                false => {
                    let mut rng = Philox::new(0, replica, Stream::Host);
                    allan::fit::fit(&allan::curve(&values, 1.0), 1.0, 0.0, &mut rng)?.coefficients[1]
                }
            };
            Some(n.ci95[0] <= 1.0 && 1.0 <= n.ci95[1])
        };
        let held: Vec<bool> = (0..REPLICAS).into_par_iter().filter_map(of).collect();
        check(held.len() as u64 == REPLICAS, "every replica can be fitted")?;
        Ok(held.iter().filter(|h| **h).count() as f64 / REPLICAS as f64)
    };
    // How many octaves the filter bends is itself estimated, and of an infinite kurtosis a log shows a part: that
    // costs some of the 95 %.
    for taps in [2, 8] {
        let share = held(taps, false, true)?;
        check(share >= FLOOR, format!("{taps} taps: N is covered in {share} of the replicas"))?;
    }
    let share = held(1, true, true)?;
    check(share >= FLOOR, format!("heavy tails: N is covered in {share} of the replicas"))?;
    let share = held(1, true, false)?;
    check(share < 0.6, format!("without the tails' own variance N is covered in {share} of the replicas"))
}

/// 20,000 samples of white noise, and as control with flicker that rules from 30 s on: at σ = N/√τ
/// and 0.664 B the two are equal at (0.1/(0.664·0.03))² = 25 s.
fn floor() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log.csv");
    let answer = |b: f64| -> Result<String, Failed> {
        let mut rng = Philox::new(13, 0, Stream::Host);
        let values = signal(20_000, [0.0, 0.1, b, 0.0, 0.0], &mut rng);
        let rows: String = values.iter().map(|v| format!("{v}\n")).collect();
        std::fs::write(&log, format!("x\n{rows}"))?;
        let output = program().arg("allan").arg(&log).args(["--rate-hz", "10", "--json"]).output()?;
        let document: serde_json::Value = serde_json::from_slice(&output.stdout)?;
        Ok(document["answer"].as_str().unwrap_or_default().to_owned())
    };
    let white = answer(0.0)?;
    check(white.contains("where the curve still falls: no floor was reached"), white)?;
    let flicker = answer(0.03)?;
    check(flicker.contains("lowest Allan deviation") && !flicker.contains("still falls"), flicker)
}

/// 20,000 samples of white noise of one unit per sample in three columns. Left as they are, nothing is said and every
/// point of the curve has the bits of that of the values themselves; so too with a step of 15, and with the tails of
/// Student's t of five degrees of freedom.
fn strays() -> Result<(), Failed> {
    const SAMPLES: usize = 20_000;
    const ROW: usize = 7001;
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log.csv");
    let request = Request { rate_hz: Some(RATE_HZ), ..Request::default() };
    let draw = |member: u64| {
        let mut rng = Philox::new(15, member, Stream::Host);
        (0..SAMPLES).map(|_| rng.sample::<f64, _>(StandardNormal)).collect::<Vec<f64>>()
    };
    let analyse = |columns: [&[f64]; 3]| -> Result<noise::Noise, Failed> {
        let rows: String = (0..SAMPLES).map(|k| columns.map(|c| c[k].to_string()).join(",") + "\n").collect();
        std::fs::write(&log, format!("x,y,z\n{rows}"))?;
        Ok(noise::analyse(&log, &request, |_| Unit::unknown())?)
    };
    let bits = |channel: &noise::Channel| channel.curve.iter().map(|d| d.value.to_bits()).collect::<Vec<_>>();
    let own =
        |values: &[f64]| allan::curve(values, RATE_HZ).iter().map(|p| p.variance.sqrt().to_bits()).collect::<Vec<_>>();
    let clean = draw(0);
    let mut step = draw(1);
    step[SAMPLES / 3..].iter_mut().for_each(|v| *v += 15.0);
    let squares: Vec<Vec<f64>> = (2..7).map(draw).collect();
    let tailed: Vec<f64> = draw(7)
        .iter()
        .enumerate()
        .map(|(k, v)| v / (squares.iter().map(|s| s[k] * s[k]).sum::<f64>() / 5.0).sqrt())
        .collect();
    let kept = analyse([&clean, &step, &tailed])?;
    for (channel, values) in kept.channels.iter().zip([&clean, &step, &tailed]) {
        check(bits(channel) == own(values), format!("{}: another curve", channel.name))?;
    }
    let is_left_out = |f: &Finding| matches!(f, Finding::StraysLeftOut { .. } | Finding::KnocksLeftOut { .. });
    check(!kept.source.findings.iter().any(is_left_out), sentences(&kept.source.findings).join("; "))?;
    // One reading of a thousand standard deviations adds 10⁶/20,000 = 50 to a variance of one; without it the level
    // in one of 20,000 places takes less than one part in a thousand.
    let mut stray = clean.clone();
    stray[ROW] = 1000.0;
    let mut knocked = clean.clone();
    (0..40).for_each(|k| knocked[ROW + k] += 60.0 * (-(k as f64) / 10.0).exp() * (k as f64).cos());
    let noise = analyse([&clean, &stray, &knocked])?;
    let first = |n: usize, of: &noise::Noise| of.channels[n].curve[0].value;
    for n in [1, 2] {
        let ratio = first(n, &noise) / first(0, &noise);
        check((ratio - 1.0).abs() < 0.01, format!("{} times the noise without a disturbance", ratio))?;
    }
    check(own(&stray)[0] > (5.0f64).to_bits(), "control: a stray reading as noise would not show")?;
    check(bits(&noise.channels[0]) == own(&clean), "a neighbouring channel changes")?;
    let said = sentences(&noise.source.findings).join("; ");
    check(noise.source.findings.iter().filter(|f| is_left_out(f)).count() == 2, said.clone())?;
    check(said.contains("`y`: 1 reading was left out of the noise as stray (1000.00 in row 7001)"), said.clone())?;
    check(said.contains("`z`: 1 knock of "), said)?;
    let output = program().arg("allan").arg(&log).args(["--rate-hz", "10", "--json"]).output()?;
    let document: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let recording = &document["recording"];
    check(recording["rows"] == SAMPLES && recording["samples"] == SAMPLES, recording.to_string())?;
    let of = |kind: &str| recording["left_out"].as_array().into_iter().flatten().find(|l| l["kind"] == kind);
    let stray = of("stray").ok_or("no stray reading in the document")?;
    check(stray["column"] == "y" && stray["readings"] == 1 && stray["first"][0]["row"] == ROW, stray.to_string())?;
    let knock = of("knock").ok_or("no knock in the document")?;
    check(knock["column"] == "z" && knock["knocks"] == 1, knock.to_string())
}

/// Row 12,999 of the first Xsens has half of every reading, before a row without any. Within the parts of one type, N
/// of the same axis differs by less than a third from its median of the other four units.
fn fleet(folder: &std::path::Path) -> Result<(), Failed> {
    let of = |unit: usize| -> Result<(f64, String), Failed> {
        let path = folder.join(format!("fleet/unit_{unit}.csv"));
        let noise = noise::analyse(&path, &Request::default(), |_| Unit::unknown())?;
        let channel = noise.channels.iter().find(|c| c.name == "fz_m_s2").ok_or("fz")?;
        let white = channel.fit.as_ref().ok_or("a fit")?.coefficients[Term::White as usize].value;
        Ok((white, sentences(&noise.source.findings).join("; ")))
    };
    let mut others = (2..=5).map(|unit| Ok(of(unit)?.0)).collect::<Result<Vec<f64>, Failed>>()?;
    others.sort_by(f64::total_cmp);
    let (first, said) = of(1)?;
    let ratio = first / (0.5 * (others[1] + others[2]));
    check((0.75..1.33).contains(&ratio), format!("N of fz is {ratio} times that of the other units"))?;
    check(said.contains("`fz_m_s2`: 1 reading was left out of the noise as stray (4.96778 in row 12999)"), said)
}

fn command() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log.csv");
    let mut rng = Philox::new(12, 0, Stream::Host);
    let values = signal(20_000, [0.0, 0.1, 0.0, 0.0, 0.0], &mut rng);
    let rows: String = values.iter().enumerate().map(|(i, v)| format!("{},{v},1.0\n", i as f64 / RATE_HZ)).collect();
    std::fs::write(&log, format!("t_s,ax,dead\n{rows}"))?;
    let run = |arguments: &[&str]| program().arg("allan").arg(&log).args(arguments).output();
    let out = folder.path().join("noise");
    let out = out.to_string_lossy();
    let good = run(&["--json", "--time", "t_s", "--accelerometer", "ax", "--columns", "dead", "--out", &out])?;
    check(good.status.success(), String::from_utf8_lossy(&good.stderr))?;
    let document: serde_json::Value = serde_json::from_slice(&good.stdout)?;
    check(document["schema"] == "proofmass.allan/1", document["schema"].to_string())?;
    check(document["recording"]["samples"] == 20_000, document["recording"].to_string())?;
    check(document["findings"].to_string().contains("dead channel"), document["findings"].to_string())?;
    let channels = document["channels"].as_array().ok_or("channels")?;
    let ax = channels.iter().find(|c| c["name"] == "ax").ok_or("ax")?;
    let answer = document["answer"].as_str().unwrap_or_default();
    check(answer.starts_with("Accelerometer: N = "), answer)?;
    let dead = channels.iter().find(|c| c["name"] == "dead").ok_or("dead")?;
    check(dead["mean"] == 1.0, format!("the mean of a constant 1: {}", dead["mean"]))?;
    for term in ax["terms"].as_array().into_iter().flatten() {
        let says = term["value"].is_number() == (term["supported"] == true);
        check(says, format!("a value of a term that is not supported, or none of one that is: {term}"))?;
    }
    let interval = |n: usize| ax["terms"][1]["ci95"][n].as_f64().unwrap_or(f64::NAN) / 60.0;
    check(interval(0) < 0.1 && 0.1 < interval(1), format!("N of 0.1 m/s/√s: {}", ax["terms"][1]))?;
    let sensor = std::fs::read_to_string(folder.path().join("noise/sensor.toml"))?;
    let sensor: toml::Value = toml::from_str(&sensor)?;
    let written = sensor["accelerometer"]["velocity_random_walk_m_s_rth"].as_float().unwrap_or(f64::NAN);
    check((written / 6.0 - 1.0).abs() < 0.05, format!("sensor.toml has {written} m/s/√h, 6 went in"))?;
    check(std::fs::read_to_string(folder.path().join("noise/report.html"))?.contains("<svg"), "no figure")?;
    // From the log to its simulation without writing a line: study.toml runs and lays the log
    // beside itself.
    let study = folder.path().join("noise/study.toml");
    let simulated = program().arg("study").arg(&study).arg("--out").arg(folder.path().join("run")).output()?;
    check(simulated.status.success(), String::from_utf8_lossy(&simulated.stderr))?;
    let said = String::from_utf8_lossy(&simulated.stdout).into_owned();
    // With the still start that the log allows, its windows are compared as well.
    let compared = ["next to the recording", "windows of 10 s inside", "ax: "];
    check(compared.iter().all(|words| said.contains(words)), said)?;
    for (arguments, said) in [
        (&["--rate-hz", "0"][..], "rate"),
        (&["--time", "dead"], "repeat the first one"),
        (&["--rate-hz", "10", "--columns", "ay"], "did you mean `ax`?"),
        (&["--rate-hz", "10", "--accelerometer", "ax", "--accelerometer-scale", "3furlong"], "furlong"),
        (&["--rate-hz", "10", "--columns", "ax,ax"], "named twice"),
    ] {
        let refused = run(arguments)?;
        let text = String::from_utf8_lossy(&refused.stderr).into_owned();
        check(refused.status.code() == Some(2) && text.contains(said), format!("{arguments:?}: {text}"))?;
    }
    Ok(())
}

fn adis16405(folder: &std::path::Path) -> Result<(), Failed> {
    let gyro = ["gx_lsb", "gy_lsb", "gz_lsb"];
    let request = Request { rate_hz: Some(100.0), ..Request::default() };
    // Counts, from the README of the data: gyro 0.05 °/s, accelerometer 3.33 mg.
    let noise = noise::analyse(&folder.join("adis16405/run1_counts.csv"), &request, |name| {
        let (scale, quantity) =
            if gyro.contains(&name) { ("0.05deg/s", Quantity::Gyro) } else { ("3.33mg", Quantity::Accelerometer) };
        Unit::parse(scale, quantity).unwrap_or_else(|_| Unit::unknown())
    })?;
    // Known of it (README): Allan deviation at 1 s as N, °/√h and m/s/√h, and its minimum over
    // 0.664, °/h and mg. They carry two or three digits, so half a digit is allowed beside the
    // interval.
    let known = [
        ("gx_lsb", 2.47, 29.0),
        ("gy_lsb", 2.58, 49.0),
        ("gz_lsb", 2.31, 45.0),
        ("ax_lsb", 0.42, 0.46),
        ("ay_lsb", 0.30, 0.34),
        ("az_lsb", 0.37, 0.36),
    ];
    for (name, white, stability) in known {
        let channel = noise.channels.iter().find(|c| c.name == name).ok_or("a channel")?;
        let at = channel.at_one_second().ok_or("an averaging time of 1 s")?;
        let factor = channel.unit.coefficient(Term::White).1;
        let [low, high] = at.ci95.map(|e| e * factor);
        check(low * 0.985 <= white && white <= high * 1.015, format!("{name}: N {low} to {high}, known {white}"))?;
        let (_, ci95) = channel.bias_stability().ok_or("a minimum")?;
        let factor = channel.unit.coefficient(Term::Flicker).1;
        let [low, high] = ci95.map(|e| e * factor);
        check(
            low * 0.985 <= stability && stability <= high * 1.015,
            format!("{name}: B {low} to {high}, known {stability}"),
        )?;
        let roll_off = channel.roll_off.unwrap_or(1.0);
        check(roll_off < 0.7, format!("{name}: its on-chip filter goes unnoticed ({roll_off})"))?;
    }
    let line = noise.channels.iter().find(|c| c.name == "ax_lsb").and_then(|c| c.lines.first());
    check(line.is_some(), "the accelerometer's vibration near 0.6 Hz goes unnoticed")
}
