//! Driven nulls: the base model is right, and the noise is as noise is.

use super::draw::Draw;
use super::exact::Made;
use super::oscillator_base::{Size, Wish, stage};
use super::readout::Noise;
use super::truth::Truth;

pub(super) const SUBS: [&str; 12] = [
    "normal noise",
    "Laplace noise",
    "Student t3 noise",
    "Student t5 noise",
    "noise grows with amplitude",
    "noise grows with time",
    "finely quantised",
    "slightly coloured noise",
    "single sine",
    "ring-down",
    "operating point",
    "ring-down, Student t5 noise",
];

/// Returns the sub-family of the n-th case.
pub(crate) fn sub(nth: usize) -> &'static str {
    SUBS[nth % SUBS.len()]
}

/// The n-th case of the family.
pub(crate) fn draw(nth: usize, draw: &mut Draw, size: Size) -> Made {
    let sub = sub(nth);
    let wish = match sub {
        "single sine" => Wish::Sine,
        "ring-down" | "ring-down, Student t5 noise" => Wish::RingDown,
        "operating point" => Wish::OperatingPoint,
        _ => Wish::Any,
    };
    let mut driven = stage(draw, wish, size);
    driven.noise = match sub {
        "Laplace noise" => Noise::Laplace,
        "Student t3 noise" => Noise::Student { freedom: 3 },
        "Student t5 noise" | "ring-down, Student t5 noise" => Noise::Student { freedom: 5 },
        "noise grows with amplitude" => Noise::WithAmplitude { more: draw.log_between(0.2, 3.0) },
        "noise grows with time" => Noise::Growing { factor: draw.log_between(1.5, 6.0) },
        // A neighbour correlation that a sigma-delta filter or an anti-alias filter leaves.
        "slightly coloured noise" => Noise::Coloured { correlation: draw.between(0.05, 0.3) * draw.sign() },
        _ => Noise::Gauss,
    };
    if sub == "finely quantised" {
        driven.columns.step = driven.columns.output_scale.abs() * driven.sigma * draw.log_between(0.1, 0.9);
    }
    (sub.to_owned(), driven, Truth::default())
}
