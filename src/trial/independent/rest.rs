//! Families at rest: processes to the letter, near laws (other exponents, other courses of a
//! temperature), nulls.

use std::f64::consts::TAU;

use super::draw::Draw;
use super::linear::left_by;
use super::masking;
use super::octave::departure_from_flicker;
use super::oscillator_base::Size;
use super::readout::Noise;
use super::sizing::coloured_evidence;
use super::still::{Filter, Process, Still};
use super::truth::{Effect, Family, Truth};

/// A name, what was made and its truth.
pub(crate) type Made = (String, Still, Truth);

const LETTER: [&str; 12] = [
    "white-noise",
    "quantisation-noise",
    "flicker-noise",
    "random-walk",
    "rate-ramp",
    "gauss-markov",
    "sinusoid",
    "warm-up",
    "temperature-sensitivity",
    "random-walk beside a knock",
    "rate-ramp + flicker-noise",
    "sinusoid + random-walk",
];
const NEAR: [&str; 12] = [
    "density f^-0.8",
    "density f^-1.3",
    "drift √t",
    "drift t^0.8",
    "warm-up in two speeds",
    "temperature, parabola",
    "temperature, lag",
    "temperature, play",
    "popcorn",
    "jump",
    "sine of changing frequency",
    "drift t^1.5",
];
/// Sub-family of one strong channel next to silent ones.
pub(crate) const BESIDE_SILENT: &str = "temperature, lag in one channel";
const NULL: [&str; 10] = [
    "normal noise",
    "Student t3 noise",
    "Student t5 noise",
    "Laplace noise",
    "noise grows with time",
    "one bad reading",
    "moving average on chip",
    "second-order filter on chip",
    "finely quantised",
    "temperature column without effect",
];

fn bare(draw: &mut Draw, size: Size) -> Still {
    let channels = draw.one_of(&[1, 1, 2, 3]);
    bare_of(channels, draw, size)
}

fn bare_of(channels: usize, draw: &mut Draw, size: Size) -> Still {
    let rate_hz = draw.log_between(1.0, 1000.0);
    let rows = draw.log_between(4000.0f64.min(size.rows as f64), size.rows as f64) as usize;
    let unit: &str = draw.one_of(&["g", "m/s^2", "deg/s", "V"]);
    let level = draw.log_between(1e-5, 10.0);
    let names = draw.one_of(&[["ax", "ay", "az"], ["gyro x", "gyro y", "gyro z"], ["ch1_V", "ch2_V", "ch3_V"]]);
    Still {
        seed: draw.bits() >> 12,
        rate_hz: (rate_hz * 1000.0).round() / 1000.0,
        rows,
        // One data sheet: channels are alike within a few per cent where nothing else is said.
        sigma: vec![level; channels],
        mean: (0..channels).map(|_| level * draw.between(-300.0, 300.0)).collect(),
        processes: Vec::new(),
        noise: Noise::Gauss,
        filter: Filter::None,
        step: 0.0,
        knocks: Vec::new(),
        temperature: false,
        promised: None,
        unit: unit.into(),
        headings: names[..channels].iter().map(|n| (*n).to_owned()).collect(),
    }
}

/// Evidence of the n-th process in all channels, and its rms over σ in the channel that shows it
/// most.
fn evidence(still: &Still, n: usize) -> [f64; 2] {
    let random = still.processes[n].0.is_random();
    let channels = (0..still.sigma.len()).map(|c| {
        let mut values = still.effect(n, c);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter_mut().for_each(|v| *v -= mean);
        let power: f64 = values.iter().map(|v| v * v).sum();
        let found = if random { coloured_evidence(&values, 1.0) } else { power };
        [found, (power / values.len() as f64).sqrt()]
    });
    channels.fold([0.0, 0.0], |a, b| [a[0] + b[0], f64::max(a[1], b[1])])
}

/// Adds a process in one or all channels, scaled to an evidence.
fn add(still: &mut Still, draw: &mut Draw, process: Process, goal: f64) {
    let channels = still.sigma.len();
    let only = draw.chance(0.4).then(|| draw.below(channels));
    let weights: Vec<f64> = (0..channels)
        .map(|c| match only {
            Some(one) if one != c => 0.0,
            _ => draw.between(0.5, 1.0) * if process.is_random() { 1.0 } else { draw.sign() },
        })
        .collect();
    add_weighted(still, weights, process, goal);
}

/// Adds a process with a weight in each channel, scaled to an evidence.
fn add_weighted(still: &mut Still, weights: Vec<f64>, mut process: Process, goal: f64) {
    *process.size_mut() = 0.1;
    let n = still.processes.len();
    still.processes.push((process, weights));
    for _ in 0..30 {
        let [found, _] = evidence(still, n);
        if found > goal / 1.1 && found < goal * 1.1 {
            break;
        }
        // Evidence grows as the square at least.
        let factor = (goal / found.max(1e-12)).powf(0.4).clamp(0.05, 20.0);
        *still.processes[n].0.size_mut() *= factor;
    }
}

fn letter_process(id: &str, draw: &mut Draw, length_s: f64, rate_hz: f64) -> Option<Process> {
    let size = 1.0;
    Some(match id {
        "flicker-noise" => Process::Flicker { size, alpha: 1.0 },
        "random-walk" | "random-walk beside a knock" => Process::Walk { size },
        "rate-ramp" => Process::Drift { size, p: 1.0 },
        "gauss-markov" => Process::GaussMarkov { size, tau: draw.log_between(10.0 / rate_hz, length_s / 30.0) },
        "sinusoid" => Process::Sine {
            size,
            hz: draw.log_between(20.0 / length_s, 0.45 * rate_hz),
            phase: TAU * draw.unit(),
            chirp: 0.0,
        },
        "warm-up" => Process::WarmUp { size, tau: length_s * draw.log_between(0.04, 0.3) },
        "temperature-sensitivity" => Process::Temperature { size, square: 0.0, lag: 0.0, play: 0.0 },
        _ => return None,
    })
}

fn near_process(sub: &str, draw: &mut Draw, length_s: f64, rate_hz: f64) -> (Process, &'static [&'static str]) {
    let size = 1.0;
    let drift = |p: f64| (Process::Drift { size, p }, &["rate-ramp", "warm-up"][..]);
    match sub {
        "density f^-0.8" => (Process::Flicker { size, alpha: 0.8 }, &["flicker-noise"]),
        "density f^-1.3" => (Process::Flicker { size, alpha: 1.3 }, &["flicker-noise"]),
        "drift √t" => drift(0.5),
        "drift t^0.8" => drift(0.8),
        "drift t^1.5" => drift(1.5),
        "warm-up in two speeds" => {
            let tau = length_s * draw.log_between(0.02, 0.08);
            let (part, ratio) = (draw.between(0.5, 1.5), draw.between(4.0, 10.0));
            (Process::TwoSpeeds { size, tau, part, ratio }, &["warm-up"])
        }
        "temperature, parabola" => {
            let square = draw.between(0.08, 0.4);
            (Process::Temperature { size, square, lag: 0.0, play: 0.0 }, &["temperature-sensitivity"])
        }
        "temperature, lag" => {
            let lag = length_s * draw.between(0.03, 0.15);
            (Process::Temperature { size, square: 0.0, lag, play: 0.0 }, &["temperature-sensitivity"])
        }
        "temperature, play" => {
            let play = draw.between(0.3, 1.0);
            (Process::Temperature { size, square: 0.0, lag: 0.0, play }, &["temperature-sensitivity"])
        }
        // Switching between two levels has the spectrum of a Gauss–Markov process, and not its law.
        "popcorn" => {
            let dwell = draw.log_between(20.0 / rate_hz, length_s / 20.0);
            (Process::Popcorn { size, dwell }, &["gauss-markov", "popcorn", "popcorn-noise"])
        }
        "jump" => (Process::Jump { size, at: draw.between(0.15, 0.85) }, &["jump", "step"]),
        _ => {
            let hz = draw.log_between(50.0 / length_s, 0.3 * rate_hz);
            let chirp = draw.between(3.0, 30.0) / (hz * length_s);
            (Process::Sine { size, hz, phase: TAU * draw.unit(), chirp }, &["sinusoid"])
        }
    }
}

fn measured(still: &Still, n: usize, right: &[&str]) -> Effect {
    let [evidence, over_noise] = evidence(still, n);
    Effect { right: right.iter().map(|r| (*r).to_owned()).collect(), evidence, over_noise }
}

fn letter(sub: &str, draw: &mut Draw, size: Size) -> Made {
    let mut still = bare(draw, size);
    let length_s = still.rows as f64 / still.rate_hz;
    let mut truth = Truth::default();
    let rows = still.rows as f64 * still.sigma.len() as f64;
    let known = |id: &str, evidence: f64, over_noise: f64| Effect { right: vec![id.into()], evidence, over_noise };
    match sub {
        "white-noise" => {
            let over = draw.log_between(1.15, 2.0);
            let over = if draw.chance(0.5) { over } else { 1.0 / over };
            still.promised = Some(over);
            // Log-likelihood ratio of a variance that is wrong by a factor.
            let ratio = 1.0 / (over * over);
            truth.effects.push(known("white-noise", rows * (ratio - 1.0 - ratio.ln()), (1.0 / over - 1.0).abs()));
        }
        "quantisation-noise" => {
            let steps = draw.log_between(1.5, 6.0);
            still.step = steps * still.sigma[0];
            truth.effects.push(known("quantisation-noise", rows * steps.powi(4) / 144.0, steps / 12f64.sqrt()));
        }
        _ => {
            let goal = draw.log_between(300.0, 3e4);
            for id in sub.split(" + ") {
                let Some(process) = letter_process(id, draw, length_s, still.rate_hz) else { continue };
                add(&mut still, draw, process, goal);
                let name = id.split(' ').next().unwrap_or(id).to_owned();
                truth.effects.push(measured(&still, still.processes.len() - 1, &[&name]));
            }
            if sub == "random-walk beside a knock" {
                still.knocks.push([
                    draw.between(0.05, 0.95),
                    1.0 + draw.below(30) as f64,
                    draw.log_between(15.0, 300.0),
                ]);
            }
            still.temperature = sub == "temperature-sensitivity" || draw.chance(0.2);
        }
    }
    (sub.to_owned(), still, truth)
}

fn near(sub: &str, draw: &mut Draw, size: Size) -> Made {
    let mut still = bare(draw, size);
    let length_s = still.rows as f64 / still.rate_hz;
    let (process, right) = near_process(sub, draw, length_s, still.rate_hz);
    let goal = draw.log_between(300.0, 1e5);
    add(&mut still, draw, process, goal);
    still.temperature = sub.starts_with("temperature") || draw.chance(0.2);
    let effects = vec![measured(&still, 0, right)];
    let departure = departure(&still);
    (sub.to_owned(), still, Truth { effects, departure, ..Truth::default() })
}

/// A case of a temperature that acts late on one channel of three and not at all on the others.
pub(crate) fn draw_beside_silent(draw: &mut Draw, size: Size) -> Made {
    let mut still = bare_of(3, draw, Size { rows: 2 * size.rows });
    let length_s = still.rows as f64 / still.rate_hz;
    let (process, right) = near_process("temperature, lag", draw, length_s, still.rate_hz);
    let (one, weight) = (draw.below(3), draw.sign());
    let weights = (0..3).map(|c| if c == one { weight } else { 0.0 }).collect();
    add_weighted(&mut still, weights, process, draw.log_between(3000.0, 1e5));
    still.temperature = true;
    let effects = vec![measured(&still, 0, right)];
    let silent = still.headings.iter().enumerate().filter(|(c, _)| *c != one).map(|(_, h)| h.clone()).collect();
    let (evidence, departure) = (effects[0].evidence, departure(&still));
    let truth = Truth { evidence, departure, effects, silent, ..Truth::default() };
    (BESIDE_SILENT.to_owned(), still, truth)
}

/// Evidence of what the nearest law of the library leaves of the first process, all channels
/// together.
fn departure(still: &Still) -> Option<f64> {
    let rows = still.rows;
    let (ones, dt) = (vec![1.0; rows], 1.0 / still.rate_hz);
    let length_s = rows as f64 * dt;
    let ramp: Vec<f64> = (0..rows).map(|n| n as f64 / rows as f64).collect();
    let settling =
        |part: f64| -> Vec<f64> { (0..rows).map(|n| (-(n as f64) * dt / (part * length_s)).exp()).collect() };
    let courses: Vec<Vec<f64>> = match still.processes[0].0 {
        Process::Drift { .. } => std::iter::once(ramp).chain([0.03, 0.1, 0.3, 0.6, 1.0, 2.0].map(settling)).collect(),
        Process::TwoSpeeds { .. } => [0.02, 0.04, 0.07, 0.12, 0.2, 0.35, 0.6].map(settling).into(),
        Process::Temperature { .. } => vec![still.temperatures()],
        Process::Flicker { .. } => {
            return Some((0..still.sigma.len()).map(|c| departure_from_flicker(&still.effect(0, c))).sum());
        }
        _ => return None,
    };
    let residual_sum = |channel: usize, course: &[f64]| -> f64 {
        left_by(&[&ones, course], &still.effect(0, channel)).iter().map(|v| v * v).sum()
    };
    let of = |channel: usize| courses.iter().map(|c| residual_sum(channel, c)).fold(f64::INFINITY, f64::min);
    Some((0..still.sigma.len()).map(of).sum())
}

fn null(sub: &str, draw: &mut Draw, size: Size) -> Made {
    let mut still = bare(draw, size);
    let mut truth = Truth::default();
    if draw.chance(0.3) {
        // A data sheet that keeps its word.
        still.promised = Some(1.0);
    }
    match sub {
        "Student t3 noise" => still.noise = Noise::Student { freedom: 3 },
        "Student t5 noise" => still.noise = Noise::Student { freedom: 5 },
        "Laplace noise" => still.noise = Noise::Laplace,
        "noise grows with time" => still.noise = Noise::Growing { factor: draw.log_between(1.3, 4.0) },
        "one bad reading" => {
            still.knocks.push([draw.between(0.02, 0.98), 1.0, draw.sign() * draw.log_between(15.0, 1e3)])
        }
        "moving average on chip" => still.filter = Filter::Mean { taps: 2 + draw.below(7) },
        "second-order filter on chip" => still.filter = Filter::TwoPoles { pole: draw.between(0.1, 0.7) },
        "finely quantised" => {
            still.step = still.sigma[0] * draw.log_between(0.1, 0.9);
            // A step near the noise may be said: it is there.
            truth.also.push("quantisation-noise".into());
        }
        "temperature column without effect" => still.temperature = true,
        _ => {}
    }
    if !matches!(still.noise, Noise::Gauss) || still.filter != Filter::None || !still.knocks.is_empty() {
        still.promised = None;
    }
    (sub.to_owned(), still, truth)
}

/// Returns the sub-family of the n-th case of a family.
pub(crate) fn sub(family: Family, nth: usize) -> &'static str {
    match family {
        Family::Letter => LETTER[nth % LETTER.len()],
        Family::Near | Family::Foreign => NEAR[nth % NEAR.len()],
        Family::Null => NULL[nth % NULL.len()],
    }
}

/// The n-th case of a family.
pub(crate) fn draw(family: Family, nth: usize, draw: &mut Draw, size: Size) -> Made {
    let size = Size { rows: 2 * size.rows };
    let (sub, still, mut truth) = match family {
        Family::Letter => letter(sub(family, nth), draw, size),
        Family::Near | Family::Foreign => near(sub(family, nth), draw, size),
        Family::Null => null(sub(family, nth), draw, size),
    };
    truth.evidence = truth.effects.iter().map(|e| e.evidence).sum::<f64>() + 0.0;
    // That something is there is seen in all together; what it is, next to the others.
    if still.processes.len() > 1 {
        for (n, effect) in truth.effects.iter_mut().enumerate() {
            effect.evidence = masking::evidence(&still, n);
        }
    }
    truth.parameters = still.parameters();
    (sub, still, truth)
}
