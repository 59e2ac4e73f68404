//! Draws exact driven cases: each candidate to the letter of its statement, alone, in pairs and
//! triples, at an operating point, chaotic.

use std::f64::consts::TAU;

use super::draw::Draw;
use super::driven::{Driven, rms};
use super::law::{Course, Law};
use super::oscillator_base::{Size, Wish, stage};
use super::readout::Readout;
use super::simulate;
use super::sizing::{Piece, assemble, strengthen, target};
use super::truth::{Truth, effect};
use super::wave::Shape;

/// Ids of single effects.
const IDS: [&str; 23] = [
    "cubic-stiffness",
    "quadratic-stiffness",
    "quadratic-damping",
    "squeeze-film-damping",
    "coulomb-friction",
    "hysteresis",
    "stiffness-drift",
    "parasitic-mode",
    "coupled-mode",
    "drive-nonlinearity",
    "end-stop",
    "force-noise",
    "readout-saturation",
    "readout-quantisation",
    "readout-delay",
    "readout-lowpass",
    "readout-nonlinearity",
    "feedthrough",
    "input-lag",
    "bias-drift",
    "warm-up",
    "bias-random-walk",
    "periodic-disturbance",
];

/// A name, what was made and its truth.
pub(crate) type Made = (String, Driven, Truth);

fn needs_input(id: &str) -> bool {
    matches!(
        id,
        "parasitic-mode" | "drive-nonlinearity" | "readout-delay" | "readout-lowpass" | "feedthrough" | "input-lag"
    )
}

/// The largest displacement of the bare oscillator.
pub(crate) fn reach(base: &Driven) -> f64 {
    let run = simulate::run(&base.oscillator, base.oscillator.rows);
    run.map_or(1.0, |r| r.signal.iter().fold(0.0f64, |a, b| a.max(b.abs())))
}

/// An effect by its id, of a first size that `strengthen` corrects.
pub(crate) fn piece(id: &str, draw: &mut Draw, base: &Driven, target: f64) -> Option<Piece> {
    let o = &base.oscillator;
    let (w, w2) = (o.omega, o.omega * o.omega);
    let length_s = o.rows as f64 / o.rate_hz;
    let law = Piece::Law;
    let read = Piece::Stage;
    Some(match id {
        "cubic-stiffness" => {
            law(Law::OddSpring { size: 0.1 * target * w2 * draw.one_of(&[1.0, 1.0, 1.0, -1.0]), p: 3.0 })
        }
        "quadratic-stiffness" => law(Law::EvenSpring { size: 0.3 * target * w2 * draw.sign() }),
        "quadratic-damping" => law(Law::Drag { size: 2.0 * target * o.zeta, p: 2.0 }),
        "squeeze-film-damping" => law(Law::Squeeze { size: 2.0 * target * o.zeta * w }),
        "coulomb-friction" => law(Law::Friction {
            size: target * o.zeta * w2,
            lean: if draw.chance(0.2) { draw.between(-0.4, 0.4) } else { 0.0 },
        }),
        "hysteresis" => {
            let (z_y, s) = (draw.log_between(0.1, 1.0), draw.between(0.5, 1.0));
            law(Law::BoucWen { size: target * w2, b: s / z_y, g: (1.0 - s) / z_y, n: 1.0 })
        }
        "stiffness-drift" => law(Law::SpringDrift { size: target * o.zeta * draw.sign(), course: Course::Linear }),
        "parasitic-mode" => {
            let ratio = draw.log_between(1.3, 5.0);
            if ratio * w > TAU * 0.4 * o.rate_hz || ratio * w > TAU * o.input.highest_hz() * 1.3 {
                return None;
            }
            law(Law::Beside {
                size: target * o.gain * draw.sign(),
                omega: ratio * w,
                zeta: draw.log_between(0.003, 0.1),
            })
        }
        "coupled-mode" => law(Law::Absorber {
            size: 0.1 * target,
            omega: w * draw.log_between(0.6, 1.7),
            zeta: draw.log_between(0.003, 0.1),
        }),
        "drive-nonlinearity" => law(Law::DriveSquare { size: target * draw.sign() }),
        "end-stop" => law(Law::Stop {
            size: draw.log_between(0.3, 10.0) * w2,
            gap: draw.between(0.5, 0.85) * reach(base),
            p: 1.0,
            both: draw.chance(0.5),
            sign: draw.sign(),
        }),
        "force-noise" => law(Law::WhiteForce { size: 4.0 * o.zeta * w.powi(3) * target * target }),
        "readout-saturation" => {
            let most = reach(base);
            let [a, b] = [0, 1].map(|_| draw.between(0.55, 0.92) * most);
            let one = draw.chance(0.3);
            read(Readout::Rails { low: if one { -1.2 * most } else { -a }, high: b, noisy: draw.chance(0.7) })
        }
        "readout-quantisation" => read(Readout::Round { step: base.sigma * draw.log_between(2.5, 10.0) }),
        "readout-delay" => read(Readout::Delay { tau: (draw.log_between(0.05, 0.6) / w).min(5.0 * length_s) }),
        "readout-lowpass" => read(Readout::Poles { taus: vec![draw.log_between(0.05, 0.8) / w] }),
        "readout-nonlinearity" => {
            let [mut k2, mut k3] = [target * draw.sign(), 0.4 * target * draw.sign()];
            match draw.below(3) {
                0 => k2 = 0.0,
                1 => k3 = 0.0,
                _ => {}
            }
            read(Readout::Bend { k2, k3 })
        }
        "feedthrough" => read(Readout::Feed { size: target * draw.sign() }),
        "input-lag" => Piece::Lag(draw.log_between(0.05, 0.6) / w),
        "bias-drift" => read(Readout::Slow { size: 3.0 * target * draw.sign(), course: Course::Linear }),
        "warm-up" => {
            read(Readout::WarmUp { size: 4.0 * target * draw.sign(), tau: length_s * draw.log_between(0.04, 0.25) })
        }
        "bias-random-walk" => read(Readout::Walk { size: 2.0 * target / length_s.sqrt() }),
        "periodic-disturbance" => {
            let phase = TAU * draw.unit();
            let hz = draw.log_between(20.0 / length_s, 0.45 * o.rate_hz);
            read(Readout::Line { a: 1.4 * target * phase.cos(), b: 1.4 * target * phase.sin(), hz })
        }
        _ => return None,
    })
}

/// Several effects by id, the first at a visible size, the next ones that much smaller.
fn several(ids: &[&str], ratios: &[f64], draw: &mut Draw, wish: Wish, size: Size) -> Option<(Driven, Truth)> {
    let mut base = stage(draw, wish, size);
    if ids.contains(&"stiffness-drift") && ids.len() == 1 && draw.chance(0.3) {
        base.oscillator.environment = Some([draw.between(3.0, 15.0), draw.between(0.1, 1.0)]);
    }
    let is_ring = base.oscillator.input == Shape::None;
    // A late record of an input that is held is late by whole rows: another thing.
    let held_late = base.oscillator.held && ids.contains(&"input-lag");
    if held_late || is_ring && ids.iter().any(|id| needs_input(id)) {
        return None;
    }
    let largest = target(draw, &base);
    let mut pieces = Vec::new();
    for (id, ratio) in ids.iter().zip(ratios) {
        let goal = largest / ratio;
        let mut piece = piece(id, draw, &base, goal)?;
        if let (Some(_), Piece::Law(Law::SpringDrift { size, .. })) = (base.oscillator.environment, &piece) {
            piece = Piece::Law(Law::SpringEnvironment { size: 0.1 * size });
        }
        if !strengthen(&base, &mut piece, goal) {
            return None;
        }
        pieces.push((piece, effect(&[id])));
    }
    let truth = Truth { also: Vec::new(), ..Truth::default() };
    assemble(base, &pieces, truth)
}

/// Returns whether two runs that begin 1e-8 apart part by five decades: a positive Lyapunov
/// exponent, seen.
fn parts(base: &Driven) -> bool {
    let near = |driven: &Driven| simulate::run(&driven.oscillator, driven.oscillator.rows);
    let mut other = base.clone();
    other.oscillator.start[0] += 1e-8;
    let (Some(a), Some(b)) = (near(base), near(&other)) else { return false };
    let rows = a.signal.len();
    let apart = |range: std::ops::Range<usize>| {
        a.signal[range.clone()].iter().zip(&b.signal[range]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    apart(rows - rows / 5..rows) > 1e-3 && apart(0..rows / 20) < 1e-4
}

/// A cubic spring driven so strongly that its response is chaotic.
fn chaotic(draw: &mut Draw, size: Size) -> Option<(Driven, Truth)> {
    let mut base = stage(draw, Wish::Sine, size);
    let o = &mut base.oscillator;
    let per_cycle = draw.log_between(15.0, 80.0);
    (o.rate_hz, o.zeta) = (o.omega / TAU * per_cycle, draw.log_between(0.01, 0.1));
    let drive = o.omega / TAU * draw.between(0.7, 2.0);
    o.input = Shape::Sines { lines: vec![[1.0, drive, TAU * draw.unit()]] };
    // In units of ω₀ and (ω₀²/β)^½: force of 5 to 60.
    o.gain = o.omega * o.omega * draw.log_between(5.0, 60.0);
    o.before = 0;
    o.start = [0.5, 0.0];
    let law = Law::OddSpring { size: o.omega * o.omega, p: 3.0 };
    let mut with = base.clone();
    with.oscillator.laws.push(law.clone());
    if !parts(&with) {
        return None;
    }
    let loud = rms(&simulate::run(&with.oscillator, with.oscillator.rows)?.signal);
    base.sigma *= loud;
    base.columns.output_scale /= loud;
    base.columns.step = 0.0;
    assemble(base, &[(Piece::Law(law), effect(&["cubic-stiffness"]))], Truth::default())
}

const PAIRS: [[&str; 2]; 12] = [
    ["cubic-stiffness", "quadratic-damping"],
    ["cubic-stiffness", "feedthrough"],
    ["cubic-stiffness", "coulomb-friction"],
    ["quadratic-stiffness", "bias-drift"],
    ["coulomb-friction", "warm-up"],
    ["readout-lowpass", "cubic-stiffness"],
    ["drive-nonlinearity", "periodic-disturbance"],
    ["squeeze-film-damping", "cubic-stiffness"],
    ["cubic-stiffness", "bias-random-walk"],
    ["end-stop", "readout-delay"],
    ["parasitic-mode", "quadratic-damping"],
    ["hysteresis", "bias-drift"],
];
const TRIPLES: [[&str; 3]; 5] = [
    ["cubic-stiffness", "quadratic-damping", "periodic-disturbance"],
    ["cubic-stiffness", "quadratic-stiffness", "bias-drift"],
    ["coulomb-friction", "cubic-stiffness", "feedthrough"],
    ["quadratic-damping", "readout-lowpass", "warm-up"],
    ["cubic-stiffness", "parasitic-mode", "bias-random-walk"],
];

/// Returns the sub-family of the n-th case: singles, and each fifth something of several effects or
/// of a special kind.
pub(crate) fn sub(nth: usize) -> &'static str {
    match (nth % 5, (nth / 5) % 4) {
        (4, special) => ["pair", "triple", "chaotic", "operating point"][special],
        _ => IDS[(nth - nth / 5) % IDS.len()],
    }
}

/// The n-th case of the family.
pub(crate) fn draw(nth: usize, draw: &mut Draw, size: Size) -> Made {
    let sub = sub(nth);
    loop {
        let made = match sub {
            "pair" => {
                let pair = PAIRS[(nth / 20) % PAIRS.len()];
                let ratio = draw.log_between(1.0, 20.0);
                let order = if draw.chance(0.5) { pair } else { [pair[1], pair[0]] };
                several(&order, &[1.0, ratio], draw, Wish::Rich, size)
            }
            "triple" => {
                let triple = TRIPLES[(nth / 20) % TRIPLES.len()];
                let ratios = [1.0, draw.log_between(1.0, 4.0), draw.log_between(1.0, 8.0)];
                several(&triple, &ratios, draw, Wish::Rich, size)
            }
            "chaotic" => chaotic(draw, size),
            "operating point" => {
                several(&["cubic-stiffness"], &[1.0], draw, Wish::OperatingPoint, size).map(|(d, mut truth)| {
                    // About its operating point a cubic spring is a quadratic one as well.
                    truth.also.push("quadratic-stiffness".into());
                    (d, truth)
                })
            }
            id => {
                let wish = if needs_input(id) { Wish::Rich } else { Wish::Any };
                several(&[id], &[1.0], draw, wish, size)
            }
        };
        if let Some((driven, truth)) = made {
            return (sub.to_owned(), driven, truth);
        }
    }
}
