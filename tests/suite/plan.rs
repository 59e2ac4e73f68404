//! `plan` against a generator with equations of its own: laws that a first recording does not tell apart
//! are recorded as proposed and diagnosed, and the answer is right as often as was promised.

use std::fmt::Write as _;
use std::path::PathBuf;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::plan::limits::{Limit, Limits};
use proofmass::diagnosis::plan::search::{Planned, search};
use proofmass::diagnosis::plan::{Wish, asked, plan};
use proofmass::diagnosis::verdict::Outcome;
use proofmass::diagnosis::{self, answer::Answer, model};
use proofmass::recording::{Column, Recording};
use proofmass::rng::{Philox, Stream};
use proofmass::trial::independent::columns::Columns;
use proofmass::trial::independent::driven::Driven;
use proofmass::trial::independent::law::Law;
use proofmass::trial::independent::oscillator::Oscillator;
use proofmass::trial::independent::readout::{Noise, Readout};
use proofmass::trial::independent::wave::Shape;
use rand::RngExt;
use rayon::prelude::*;

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Parts that the pairs are divided into, so that each test is short.
const PARTS: u64 = 4;
/// Sensors drawn for one part; of about a half the first recording leaves two laws.
const DRAWN: u64 = 14;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let part =
        |part: u64| test(&format!("plan: laws left open are decided as promised, part {part}"), move || pairs(part));
    let mut all = vec![
        test("plan: the command says what shows a cubic spring of 1 %, and writes the input to play", shown),
        test("plan: ten times the noise is promised less, and what is in the way is named", noise),
        test("plan: what cannot be planned is refused with what to do", refused),
    ];
    all.extend((0..PARTS).map(part));
    all
}

const MODEL: &str = "kind = \"driven\"\nrate_hz = 200.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n[start]\n\
                     resonance_hz = 8.0\ndamping_ratio = 0.03\n";

/// Kinds of experiment: few, so that a test is short.
const VARY: &str = "vary = [\"sine-ladder\", \"multisine\"]\n";

fn limits(noise: f64) -> String {
    format!("largest_input_m_s2 = 2.0\nrate_hz = 200.0\nlongest_s = 30.0\n{VARY}[sensor]\nnoise = {noise}\n")
}

fn shown() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let (model, limits) = (bench.file("model.toml", MODEL)?, bench.file("limits.toml", &limits(0.02))?);
    let plan = || {
        let mut command = program();
        command.arg("plan").arg(&model).arg("--limits").arg(&limits).args(["--show", "cubic-stiffness=1%"]);
        command
    };
    let out = bench.path("out");
    let said = run(plan().args(["--json", "--confirm", "2", "--out"]).arg(&out))?.json()?;
    check(said["schema"] == "proofmass.plan/1" && said["reached"] == true, said.to_string())?;
    let best = &said["experiments"][0];
    let [probability, samples] = ["decides", "samples"].map(|key| best[key].as_f64().unwrap_or(0.0));
    check(probability >= 0.95, best.to_string())?;
    let beta = said["rivals"][0]["parameters"][0]["value"].as_f64().unwrap_or(0.0);
    check(beta > 0.0, said["rivals"].to_string())?;
    // Two recordings with the spring and two without.
    check(best["confirmed"]["of"] == 4 && best["confirmed"]["wrong"] == 0, best["confirmed"].to_string())?;
    let page = std::fs::read_to_string(out.join("report.html"))?;
    check(page.contains("<svg") && page.contains("To play"), "a page without its input")?;
    let text = std::fs::read_to_string(out.join("experiment.csv"))?;
    let mut rows = text.lines();
    check(rows.next() == Some("t_s,input_m_s2"), &text[..40])?;
    let inputs: Vec<f64> = rows.filter_map(|r| r.split(',').nth(1)?.parse().ok()).collect();
    let peak = inputs.iter().fold(0.0f64, |a, u| a.max(u.abs()));
    check(inputs.len() as f64 == samples && peak <= 2.0 + 1e-9, format!("{} rows, peak {peak}", inputs.len()))?;
    let words = run(&mut plan())?;
    for part in ["Play ", "cubic-stiffness with beta = ", "probability of", "next best: "] {
        check(words.stdout.contains(part), format!("no \"{part}\" in {}", words.stdout))?;
    }
    Ok(())
}

fn noise() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let model = bench.file("model.toml", MODEL)?;
    let planned = |noise: f64| -> Result<Planned, Failed> {
        let limits = Limits::parse("limits.toml", &limits(noise))?;
        let question = asked::read(&model, Some("cubic-stiffness=0.3%"), &limits)?;
        Ok(search(&question, &limits, 0.95, &Control::silent())?)
    };
    // At a hundredth of the information the promise is smaller, or takes longer to keep.
    let (quiet, loud) = (planned(0.02)?, planned(0.2)?);
    let [few, many] = [&quiet, &loud].map(|p| p.best[0].experiment.samples());
    let is_less = loud.best[0].probability < quiet.best[0].probability;
    check(quiet.reached, format!("{:?}", quiet.best[0]))?;
    check(if loud.reached { many > 2 * few } else { is_less }, format!("{:?} {:?}", quiet.best[0], loud.best[0]))?;
    let far = planned(2.0)?;
    let binding = far.binding.ok_or("a reading of noise alone shows a spring of 0.3 %")?;
    // A cubic spring grows with the cube of the input, and with the length only as its root.
    check(far.best[0].probability < 0.5 && binding.limit == Limit::Input, format!("{binding:?}"))
}

fn refused() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let file = |name: &str, text: &str| bench.file(name, text);
    let (model, good) = (file("model.toml", MODEL)?, file("limits.toml", &limits(0.02))?);
    let silent = file("silent.toml", "largest_input_m_s2 = 2.0\nrate_hz = 200.0\nlongest_s = 30.0\n")?;
    let short = file("short.toml", &limits(0.02).replace("30.0", "0.1"))?;
    let rest = file("rest.toml", "kind = \"static\"\nrate_hz = 10.0\n[columns]\nchannels = [\"ax\"]\n")?;
    let other = file("other.json", "{\"schema\": \"proofmass.study/1\"}")?;
    let cases: [(&PathBuf, &PathBuf, &str, &str); 8] = [
        (&model, &good, "", "leaves no question open"),
        (&model, &good, "cubic-stifness=1%", "cubic-stiffness"),
        (&model, &good, "cubic-stiffness=much", "\"much\""),
        (&model, &good, "readout-delay=1%", "no force"),
        (&model, &silent, "cubic-stiffness=1%", "how much noise"),
        (&model, &short, "cubic-stiffness=1%", "longest_s = 0.1"),
        (&rest, &good, "cubic-stiffness=1%", "kind = \"static\""),
        (&other, &good, "", "missing field"),
    ];
    for (from, limits, show, words) in cases {
        let mut command = program();
        command.arg("plan").arg(from).arg("--limits").arg(limits);
        if !show.is_empty() {
            command.args(["--show", show]);
        }
        run(&mut command)?.refuses(&format!("{} {show}", from.display()), words)?;
    }
    Ok(())
}

/// A sensor with one law, its first recording a band of noise at a third of the largest input.
fn sensor(seed: u64) -> (Driven, &'static str) {
    let mut rng = Philox::new(seed, 77, Stream::Host);
    let mut about = |low: f64, high: f64| low * (high / low).powf(rng.random::<f64>());
    let (f0, zeta) = (about(3.0, 12.0), about(0.01, 0.08));
    let omega = std::f64::consts::TAU * f0;
    let (id, laws, readout) = match seed % 6 {
        0 => ("cubic-stiffness", vec![Law::OddSpring { size: 0.003 * omega * omega, p: 3.0 }], vec![]),
        1 => ("quadratic-damping", vec![Law::Drag { size: 0.02 * zeta, p: 2.0 }], vec![]),
        2 => ("squeeze-film-damping", vec![Law::Squeeze { size: 0.02 * zeta * omega }], vec![]),
        3 => ("coulomb-friction", vec![Law::Friction { size: 0.02 * zeta * omega * omega, lean: 0.0 }], vec![]),
        4 => ("quadratic-stiffness", vec![Law::EvenSpring { size: 0.003 * omega * omega }], vec![]),
        _ => ("readout-nonlinearity", vec![], vec![Readout::Bend { k2: 0.0, k3: 0.001 }]),
    };
    let input =
        Shape::Lines { count: 40, from_hz: 0.2 * f0, to_hz: 2.5 * f0, of_hz: 0.0, odd_only: false, seed: seed ^ 5 };
    let oscillator = Oscillator {
        seed,
        rate_hz: 25.0 * f0,
        rows: 2000,
        omega,
        zeta,
        gain: omega * omega,
        start: [0.0; 2],
        before: 0,
        input,
        held: false,
        constant: 0.0,
        hidden: 0.0,
        laws,
        readout,
        environment: None,
        input_lag_s: 0.0,
        input_noise: 0.0,
        jitter: 0.0,
        slip: None,
    };
    let columns = Columns {
        output_scale: 1.0,
        input_scale: 1.0,
        offset: 0.0,
        step: 0.0,
        headings: ["u", "y", "t"].map(String::from),
        swapped: false,
        every: 1,
    };
    let mut driven = Driven { oscillator, noise: Noise::Gauss, sigma: 1.0, columns, hint: false };
    // So much noise that the law shows in the first recording, and just so: a tenth to a third of it.
    driven.sigma = driven.visible(2000).unwrap_or(0.0) / about(0.1, 0.3);
    (driven, id)
}

/// The verdict on a recording of it.
fn diagnosed(driven: &Driven) -> Option<(Answer, f64)> {
    let rows = driven.oscillator.rows;
    let readings = driven.readings(rows, true)?;
    let peak = readings.input.iter().fold(0.0f64, |a, u| a.max(u.abs()));
    let columns = [("u", readings.input), ("y", readings.reading)];
    let columns: Vec<Column> = columns.map(|(name, values)| Column { name: name.into(), values }).to_vec();
    let recording = Recording { rows, rate_hz: driven.oscillator.rate_hz, columns, ..Recording::default() };
    let text = "kind = \"driven\"\nrate_hz = 1.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let model = model::parse("model.toml", text).ok()?;
    Some((diagnosis::diagnose(&recording, &model, &Control::silent()).ok()?, peak))
}

/// A pair that the first recording left open, recorded as proposed.
#[derive(Debug, Clone)]
struct Pair {
    said: String,
    promised: f64,
    right: bool,
    wrong: bool,
    /// Samples of the experiment, and of the broadband multisine that is to do as well.
    samples: [Option<usize>; 2],
}

fn pair(bench: &Bench, seed: u64) -> Option<Pair> {
    let (mut driven, id) = sensor(seed);
    let (first, peak) = diagnosed(&driven)?;
    if first.outcome != Outcome::Undecidable || first.effects.len() < 2 {
        return None;
    }
    let verdict = proofmass::report::diagnosis::worded(first).verdict;
    let path = bench.file(&format!("{seed}.json"), &serde_json::to_string(&verdict).ok()?).ok()?;
    let rate = driven.oscillator.rate_hz;
    let text = format!(
        "largest_input_m_s2 = {}\nrate_hz = {rate}\nlongest_s = {}\nlargest_reading = 100.0\n",
        1.5 * peak,
        12_000.0 / rate
    );
    let limits = Limits::parse("limits.toml", &text).ok()?;
    let question = asked::read(&path, None, &limits).ok()?;
    let wish = Wish { probability: 0.95, confirm: 0 };
    let (planned, _) = plan(&question, &limits, wish, &Control::silent()).ok()?;
    let best = planned.best.first()?;
    driven.oscillator.input = Shape::Played { rate_hz: best.experiment.rate_hz, values: best.experiment.input() };
    driven.oscillator.rows = best.experiment.samples();
    driven.oscillator.seed += 1_000_000;
    let (second, _) = diagnosed(&driven)?;
    let names: Vec<&str> = second.effects.iter().map(|e| e.id.as_str()).collect();
    let is_said = second.outcome == Outcome::Explained;
    let mut said = format!("{seed} {id}: ");
    let rivals: Vec<&str> = planned.question.rivals.iter().map(|k| k.term.id()).collect();
    let _ =
        write!(said, "{rivals:?} {:?} {:.3} → {:?} {names:?}", best.experiment.shape, best.probability, second.outcome);
    Some(Pair {
        said,
        promised: best.probability,
        right: is_said && names == [id],
        wrong: is_said && !names.contains(&id),
        samples: [Some(best.experiment.samples()), planned.broadband.map(|p| p.experiment.samples())],
    })
}

fn pairs(part: u64) -> Result<(), Failed> {
    let bench = Bench::new()?;
    let seeds = part * DRAWN..(part + 1) * DRAWN;
    let pairs: Vec<Pair> = seeds.into_par_iter().filter_map(|seed| pair(&bench, seed)).collect();
    let promised: Vec<&Pair> = pairs.iter().filter(|p| p.promised >= 0.9).collect();
    let right = promised.iter().filter(|p| p.right).count();
    let wrong: Vec<&Pair> = pairs.iter().filter(|p| p.wrong).collect();
    let brier = pairs.iter().map(|p| (p.promised - f64::from(u8::from(p.right))).powi(2)).sum::<f64>();
    for pair in &pairs {
        println!("{} {} {:?}", if pair.right { "right" } else { "open or wrong" }, pair.said, pair.samples);
    }
    check(wrong.is_empty(), format!("confidently wrong: {wrong:?}"))?;
    // At 95 % three wrong of ten have a chance of 1 %.
    let misses = promised.len() - right;
    check(misses <= 3, format!("{right} of {} right where 90 % were promised; Brier sum {brier}", promised.len()))
}
