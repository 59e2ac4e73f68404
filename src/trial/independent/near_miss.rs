//! Draws driven near misses: laws next to one of the library, with other exponents, smooth edges,
//! other memories, lags and filters.

use super::draw::Draw;
use super::exact::{Made, reach};
use super::law::{Course, Law};
use super::oscillator_base::{Size, Wish, stage};
use super::readout::Readout;
use super::sizing::{Piece, assemble, strengthen, target};
use super::truth::{Truth, effect};
use super::wave::Shape;

pub(super) const SUBS: [&str; 22] = [
    "spring |x|^1.6–2.2",
    "spring |x|^2.6–3.4",
    "friction tanh",
    "friction Stribeck",
    "stop Hertz",
    "stop soft",
    "Bouc–Wen n ≠ 1",
    "second mass coupled",
    "drag |v|^1.3–1.7",
    "drag |v|^2.3–2.8",
    "input late",
    "input early",
    "input noisy",
    "low-pass two poles",
    "low-pass 1.5 poles",
    "saturation tanh",
    "readout dead zone",
    "spring sin x",
    "spring drift t^p",
    "spring settles",
    "delay",
    "offset drift t^p",
];

/// Names of a spring and of a drag of one power: the nearest statement, and the one with that power.
const POWER_SPRING: [&str; 2] = ["cubic-stiffness", "power-law-stiffness"];
const POWER_DRAG: [&str; 2] = ["quadratic-damping", "power-law-damping"];

fn piece(sub: &str, draw: &mut Draw, base: &super::driven::Driven, target: f64) -> (Piece, Vec<&'static str>) {
    let o = &base.oscillator;
    let (w, w2) = (o.omega, o.omega * o.omega);
    let law = Piece::Law;
    let read = Piece::Stage;
    let friction = target * o.zeta * w2;
    match sub {
        "spring |x|^1.6–2.2" => {
            (law(Law::OddSpring { size: 0.3 * target * w2, p: draw.between(1.6, 2.2) }), POWER_SPRING.to_vec())
        }
        "spring |x|^2.6–3.4" => {
            // Off three by more than the eye: 2.6–2.85 or 3.15–3.4.
            let p = 3.0 + draw.sign() * draw.between(0.15, 0.4);
            (law(Law::OddSpring { size: 0.1 * target * w2, p }), POWER_SPRING.to_vec())
        }
        "friction tanh" => (
            law(Law::SmoothFriction { size: friction, v_s: w * draw.log_between(0.01, 0.3) }),
            vec!["coulomb-friction"],
        ),
        "friction Stribeck" => (
            law(Law::Stribeck {
                size: friction,
                rise: draw.between(0.2, 1.0),
                v_s: w * draw.log_between(0.05, 0.4),
                v_t: w * draw.log_between(0.005, 0.04),
            }),
            vec!["coulomb-friction"],
        ),
        "stop Hertz" => (
            law(Law::Stop {
                size: draw.log_between(0.3, 10.0) * w2,
                gap: draw.between(0.5, 0.8) * reach(base),
                p: 1.5,
                both: draw.chance(0.5),
                sign: draw.sign(),
            }),
            vec!["end-stop"],
        ),
        "stop soft" => (
            law(Law::Stop {
                size: draw.log_between(0.05, 0.3) * w2,
                gap: draw.between(0.3, 0.7) * reach(base),
                p: 1.0,
                both: draw.chance(0.5),
                sign: draw.sign(),
            }),
            vec!["end-stop"],
        ),
        "Bouc–Wen n ≠ 1" => {
            let z_y = draw.log_between(0.2, 1.0);
            let n = if draw.chance(0.5) { draw.between(1.3, 3.0) } else { draw.between(0.6, 0.85) };
            // b + g > 0 bounds z, b > g dissipates; g of either sign.
            let b = draw.between(0.55, 1.2);
            let all = 1.0 / z_y.powf(n);
            (law(Law::BoucWen { size: target * w2, b: b * all, g: (1.0 - b) * all, n }), vec!["hysteresis"])
        }
        "second mass coupled" => (
            law(Law::Absorber {
                size: 0.1 * target,
                omega: w * draw.log_between(0.6, 1.7),
                zeta: draw.log_between(0.003, 0.1),
            }),
            vec!["coupled-mode", "parasitic-mode"],
        ),
        "drag |v|^1.3–1.7" | "drag |v|^2.3–2.8" => {
            let p = if sub == "drag |v|^1.3–1.7" { draw.between(1.3, 1.7) } else { draw.between(2.3, 2.8) };
            (law(Law::Drag { size: 2.0 * target * o.zeta * w.powf(2.0 - p), p }), POWER_DRAG.to_vec())
        }
        "input late" => (Piece::Lag(draw.log_between(0.03, 0.6) / w), vec!["input-lag"]),
        // An input that is recorded early cannot be told from a reading that comes late.
        "input early" => (Piece::Lag(-draw.log_between(0.03, 0.6) / w), vec!["readout-delay", "input-lag"]),
        // The model is driven with noise that the mass never saw: noise in the force.
        "input noisy" => (Piece::InputNoise(draw.log_between(0.01, 0.2)), vec!["force-noise"]),
        "low-pass two poles" => {
            let tau = draw.log_between(0.05, 0.5) / w;
            (
                read(Readout::Poles { taus: vec![tau, tau * draw.between(0.3, 1.0)] }),
                vec!["readout-lowpass", "readout-delay"],
            )
        }
        "low-pass 1.5 poles" => {
            let tau = draw.log_between(0.05, 0.5) / w;
            (
                read(Readout::Poles { taus: vec![tau, tau * draw.between(0.08, 0.2)] }),
                vec!["readout-lowpass", "readout-delay"],
            )
        }
        "saturation tanh" => (
            read(Readout::Soft { limit: reach(base) * draw.log_between(0.7, 2.5) }),
            vec!["readout-saturation", "readout-nonlinearity"],
        ),
        "readout dead zone" => (read(Readout::Dead { size: target }), vec!["readout-nonlinearity"]),
        "spring sin x" => (law(Law::Sine { size: target }), vec!["cubic-stiffness"]),
        "spring drift t^p" => {
            let p = if draw.chance(0.5) { draw.between(0.4, 0.75) } else { draw.between(1.4, 3.0) };
            let size = target * o.zeta * draw.sign();
            (law(Law::SpringDrift { size, course: Course::Power { p } }), vec!["stiffness-drift"])
        }
        "spring settles" => {
            let course = if draw.chance(0.5) {
                Course::Settling { part: draw.between(0.05, 0.4) }
            } else {
                Course::Sine { periods: draw.between(0.5, 3.0), phase: draw.between(0.0, 6.0) }
            };
            (law(Law::SpringDrift { size: target * o.zeta * draw.sign(), course }), vec!["stiffness-drift"])
        }
        "delay" => (read(Readout::Delay { tau: draw.log_between(0.03, 0.6) / w }), vec!["readout-delay"]),
        _ => {
            let p = if draw.chance(0.5) { draw.between(0.4, 0.8) } else { draw.between(1.3, 2.5) };
            (
                read(Readout::Slow { size: 3.0 * target * draw.sign(), course: Course::Power { p } }),
                vec!["bias-drift", "warm-up"],
            )
        }
    }
}

/// Returns the sub-family of the n-th case.
pub(crate) fn sub(nth: usize) -> &'static str {
    SUBS[nth % SUBS.len()]
}

/// The n-th case of the family.
pub(crate) fn draw(nth: usize, draw: &mut Draw, size: Size) -> Made {
    let sub = sub(nth);
    let linear = ["input", "low-pass", "delay"].iter().any(|s| sub.starts_with(s));
    loop {
        let base = stage(draw, if linear { Wish::Rich } else { Wish::Any }, size);
        if base.oscillator.held && sub.starts_with("input") || linear && base.oscillator.input == Shape::None {
            continue;
        }
        let target = target(draw, &base);
        let (mut piece, right) = piece(sub, draw, &base, target);
        if !strengthen(&base, &mut piece, target) {
            continue;
        }
        let random = matches!(piece, Piece::InputNoise(_));
        if let Some((driven, mut truth)) = assemble(base, &[(piece, effect(&right))], Truth::default()) {
            let sigma = driven.sigma * driven.columns.output_scale.abs();
            truth.floor = (!random).then_some([sigma, driven.oscillator.rows as f64]);
            return (sub.to_owned(), driven, truth);
        }
    }
}
