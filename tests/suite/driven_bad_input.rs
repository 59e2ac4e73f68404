//! Driven recordings that are wrong in a way of their own: refused in a sentence, or survived and
//! mentioned; never silent.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};

use super::bench::Bench;
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("driven: a recording that cannot be judged is refused with attempt, cause and hint", refused),
        test("driven: a damaged recording is survived, and the damage mentioned", survived),
        test("driven: columns out of step, exchanged or rescaled midway are told from sound ones", mismatched),
    ]
}

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 3000;
const MODEL: &str = "kind = \"driven\"\nrate_hz = 500.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
const CLOCKED: &str = "kind = \"driven\"\n[columns]\ntime = \"t\"\ninput = \"u\"\noutput = \"y\"\n";

/// Rows of t, u, y: a linear oscillator at 40 Hz under a multisine in steady state, by its
/// frequency response; the reading carries 0.5 % of noise from a fixed recurrence.
fn rows() -> Vec<[f64; 3]> {
    answered(40.0, 0.1)
}

/// Numbers without order, of unit size or so.
fn stray(n: usize) -> f64 {
    ((n * n * 7919 + n * 104_729) % 10_007) as f64 / 2890.0 - 1.73
}

/// As `rows`, by an oscillator with this resonance and damping ratio.
fn answered(resonance_hz: f64, zeta: f64) -> Vec<[f64; 3]> {
    let natural = TAU * resonance_hz;
    let lines: Vec<(f64, f64)> = (12..120).map(|k| (TAU * 0.5 * f64::from(k), f64::from(k * k) * 0.37)).collect();
    let mut state = 1u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..SAMPLES)
        .map(|n| {
            let t = n as f64 / RATE_HZ;
            let (mut u, mut y) = (0.0, 0.0);
            for (omega, phase) in &lines {
                let (real, imaginary) = (natural * natural - omega * omega, 2.0 * zeta * natural * omega);
                u += (omega * t + phase).cos();
                y += 1e4 * (omega * t + phase - imaginary.atan2(real)).cos() / real.hypot(imaginary);
            }
            let noise: f64 = (0..12).map(|_| uniform()).sum();
            [t, u, y + 0.01 * noise]
        })
        .collect()
}

fn csv(rows: &[[f64; 3]]) -> String {
    let cell = |v: &f64| if v.is_nan() { String::new() } else { v.to_string() };
    let lines = rows.iter().map(|r| r.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    String::from("t,u,y\n") + &lines.collect::<String>()
}

fn edited(edit: impl Fn(usize, &mut [f64; 3])) -> String {
    let mut rows = rows();
    rows.iter_mut().enumerate().for_each(|(n, r)| edit(n, r));
    csv(&rows)
}

fn refused() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let good = csv(&rows());
    for (what, csv, model, words) in [
        (
            "a long gap",
            edited(|n, r| {
                if (500..1200).contains(&n) {
                    r[2] = f64::NAN
                }
            }),
            MODEL.to_owned(),
            "missing",
        ),
        ("a dead output", edited(|_, r| r[2] = 1.0), MODEL.to_owned(), "never changes"),
        ("fewer samples than parameters", csv(&rows()[..40]), MODEL.to_owned(), "40 samples"),
        (
            "test beyond the end",
            good.clone(),
            format!("{MODEL}[split]\ntrain = [[0, 2000]]\ntest = [[2000, 9000]]\n"),
            "9000",
        ),
        ("one column in two roles", good.clone(), MODEL.replace("\"y\"", "\"u\""), "two roles"),
        ("an unknown column", good.clone(), MODEL.replace("\"y\"", "\"yy\""), "yy"),
        ("no clock", good.replacen("t,", "first,", 1), MODEL.replace("rate_hz = 500.0\n", ""), "rate"),
        (
            "a clock that contradicts the rate",
            good.clone(),
            CLOCKED.replace("[columns]", "rate_hz = 50.0\n[columns]"),
            "50",
        ),
        (
            "train and test that overlap",
            good.clone(),
            format!("{MODEL}[split]\ntrain = [[0, 2000]]\ntest = [[1500, 3000]]\n"),
            "overlap in 500 samples",
        ),
        (
            "a split that fits ten samples",
            good.clone(),
            format!("{MODEL}[split]\ntrain = [[0, 10]]\ntest = [[1500, 3000]]\n"),
            "train: need at least 120 samples, got 10",
        ),
        (
            "a split that judges on ten samples",
            good.clone(),
            format!("{MODEL}[split]\ntrain = [[0, 2000]]\ntest = [[2000, 2010]]\n"),
            "test: need at least 200 samples, got 10",
        ),
        ("numbers beyond all measure", edited(|_, r| r[2] *= 1e200), MODEL.to_owned(), "double precision"),
        (
            "an input that moves nothing",
            edited(|n, r| r[1] = stray(n)),
            MODEL.to_owned(),
            "no oscillator can be identified",
        ),
        ("an output of noise", edited(|n, r| r[2] = stray(n)), MODEL.to_owned(), "no oscillator can be identified"),
        ("an unknown kind", good.clone(), MODEL.replace("driven", "drivn"), "driven"),
    ] {
        bench.refused(what, &csv, &model, words)?;
    }
    Ok(())
}

fn survived() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let duplicated: Vec<[f64; 3]> =
        rows().into_iter().enumerate().flat_map(|(n, r)| vec![r; if n % 700 == 5 { 2 } else { 1 }]).collect();
    let dropped: Vec<[f64; 3]> = rows().into_iter().enumerate().filter(|(n, _)| *n != 1500).map(|r| r.1).collect();
    for (what, csv, model, words) in [
        (
            "missing cells",
            edited(|n, r| {
                if n % 400 == 7 {
                    r[2] = f64::NAN
                }
            }),
            MODEL.to_owned(),
            "missing values",
        ),
        ("clipped rails", edited(|_, r| r[2] = r[2].clamp(-1.0, 1.0)), MODEL.to_owned(), "clipped"),
        ("repeated rows", csv(&duplicated), CLOCKED.to_owned(), "repeat the time stamp"),
        ("a dropped row", csv(&dropped), CLOCKED.to_owned(), "missing"),
        ("an uneven clock", edited(|n, r| r[0] += 4e-4 * (n as f64 * 1.7).sin()), CLOCKED.to_owned(), "uneven"),
        (
            "a gap in the output",
            edited(|n, r| r[2] = if (700..760).contains(&n) { f64::NAN } else { r[2] }),
            MODEL.to_owned(),
            "60 missing",
        ),
        ("rows written twice, no clock", csv(&duplicated), MODEL.to_owned(), "written twice"),
        ("a row lost, no clock", csv(&dropped), MODEL.to_owned(), "jumps in row 1"),
        ("a stray reading", edited(|n, r| r[2] *= if n == 1000 { 1e6 } else { 1.0 }), MODEL.to_owned(), "row 1000"),
        ("a dead input", edited(|_, r| r[1] = 1.0), MODEL.to_owned(), "never changes"),
        (
            "a hint above half the rate",
            csv(&rows()),
            format!("{MODEL}[start]\nresonance_hz = 300.0\n"),
            "half the sampling",
        ),
        ("a hint that is no frequency", csv(&rows()), format!("{MODEL}[start]\nresonance_hz = -40.0\n"), "-40 Hz"),
        ("a hint that is no damping", csv(&rows()), format!("{MODEL}[start]\ndamping_ratio = 0.0\n"), "ratio of 0e0"),
        (
            "a hint of a damping that nothing has",
            csv(&rows()),
            format!("{MODEL}[start]\ndamping_ratio = 1e300\n"),
            "ratio of 1e300",
        ),
        (
            "a hint that completes no cycle",
            csv(&rows()),
            format!("{MODEL}[start]\nresonance_hz = 1e-300\n"),
            "1e-300 Hz would not complete one cycle",
        ),
        ("a hint in kHz", csv(&rows()), format!("{MODEL}[start]\nresonance_hz = 0.04\n"), "far from the hint"),
        (
            "a resonance above half the rate",
            csv(&answered(300.0, 0.5)),
            MODEL.to_owned(),
            "above half the sampling rate",
        ),
    ] {
        let verdict = bench.survived(what, &csv, &model, words)?;
        // What was mended is not taken for physics.
        let mended = [
            "missing cells",
            "a gap in the output",
            "repeated rows",
            "rows written twice, no clock",
            "a stray reading",
        ];
        let silent = verdict["verdict"] == "adequate" || !mended.contains(&what);
        check(silent, format!("{what}: {}", verdict["verdict"]))?;
    }
    // Negative control: a sound recording has nothing to be said of.
    let sound = bench.verdict(&csv(&rows()), MODEL)?;
    check(sound["findings"].as_array().is_some_and(Vec::is_empty), format!("{}", sound["findings"]))?;
    // The unit of a reading is a convention: a thousand times larger numbers change nothing but the
    // numbers.
    let plain = bench.verdict(&csv(&rows()), MODEL)?;
    let thousand = bench.verdict(&edited(|_, r| r[2] *= 1000.0), MODEL)?;
    check(plain["verdict"] == "adequate" && thousand["verdict"] == "adequate", "a change of unit changed the verdict")
}

fn mismatched() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let straight = rows();
    // The multisine repeats after 1000 samples, so moving the output in a circle moves it in time.
    let moved = |by: usize| edited(|n, r| r[2] = straight[(n + by) % SAMPLES][2]);
    for (what, csv, words) in [
        ("output 200 samples early", moved(200), "200 samples early"),
        ("output 37 samples late", moved(SAMPLES - 37), "37 samples late"),
        ("input and output exchanged", edited(|_, r| r.swap(1, 2)), "swapped"),
        ("output in another unit from the middle on", edited(|n, r| r[2] *= if n < 1500 { 1.0 } else { 1e3 }), "unit"),
        ("input in another unit from the middle on", edited(|n, r| r[1] *= if n < 1500 { 1.0 } else { 1e3 }), "unit"),
    ] {
        let verdict = bench.verdict(&csv, MODEL)?;
        let said = format!("{} {}", verdict["sentence"], verdict["findings"]);
        check(said.contains(words), format!("{what}: no \"{words}\" in {said}"))?;
        // What is out of step can be set right; the rest belongs to no oscillator, and no effect is
        // blamed for it.
        let right = if what.contains("samples") { "adequate" } else { "unexplained" };
        // Columns that do not belong together are the verdict; a shift is a note next to it.
        let sentence = verdict["sentence"].as_str().unwrap_or_default();
        let is_right = match right {
            "adequate" => sentence.contains(" Note: "),
            _ => sentence.contains("No candidate was tried") && sentence.contains(words),
        };
        check(is_right, format!("{what}: {sentence}"))?;
        check(verdict["verdict"] == right, format!("{what}: {}", verdict["verdict"]))?;
        check(verdict["effects"].as_array().is_some_and(Vec::is_empty), format!("{what}: {}", verdict["effects"]))?;
    }
    // A delay of a few samples is a sensor's, not the recording's.
    let late = bench.verdict(&moved(SAMPLES - 5), MODEL)?;
    check(late["effects"][0]["id"] == "readout-delay", format!("{}", late["effects"]))
}
