//! The shaders as text: shared parts first, then the kernel.
//!
//! Not for running them: `backend::gpu` does. Its tests, in `mirror`, hold them against the host
//! with naga.

pub mod laws;
#[cfg(test)]
mod mirror;
pub(crate) mod staged;
pub mod terms;

use super::cpu::cheap_noise::EIGHTH;
use super::cpu::navigate::BOUND_M_S;
use super::cpu::sums::BOUND_M_S2;
use super::flicker::{PLACE_MASK, RENEWED, RETAINED, SPREAD};
use super::integrator::{Capability, METHODS};
use super::layout::state;
use super::low_pass;
use super::member::{COEFFICIENTS, column};
use super::places::Places;
use crate::physics::coefficients::StudyLaw;
use crate::physics::cubic_stiffness;
use crate::rng::Stream;
use proofmass_shaders as shaders;
use proofmass_shaders::shared::{
    ACCUMULATE, ELEMENTARY, FIX, LAYOUT, ORBIT, OSCILLATOR, PHILOX, PHILOX_MULTIPLY_16, PHILOX_MULTIPLY_64,
};

/// A shader, ready for a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shader {
    /// Name of its file and of its entry point.
    pub name: &'static str,
    /// The assembled WGSL.
    pub text: String,
}

/// A kernel's own text behind random numbers and elementary functions; `int64`: the adapter has
/// 64-bit integers.
fn with_random_numbers(name: &'static str, text: &str, int64: bool) -> Shader {
    let multiply = if int64 { PHILOX_MULTIPLY_64 } else { PHILOX_MULTIPLY_16 };
    Shader { name, text: [multiply, PHILOX, ELEMENTARY, text].join("\n") }
}

/// The ensemble kernel for proof masses that follow these laws, whose members' numbers stand at these
/// places; behind them those of the laws, then the weights of a low-pass.
pub fn simulate(int64: bool, laws: &[StudyLaw], places: &Places) -> Shader {
    ensemble(int64, laws, places, false)
}

/// The same, writing the errors of every reading of a tile for `navigate`: binding 7.
pub fn simulate_traced(int64: bool, laws: &[StudyLaw], places: &Places) -> Shader {
    ensemble(int64, laws, places, true)
}

/// Texts at the lines `#trace …`.
const TRACE: [(&str, &str); 3] = [
    ("#trace declare", "@group(0) @binding(7) var<storage, read_write> trace: array<f32>;"),
    ("#trace accelerometer", "trace[2u * (n - tile.first_sample) * stride + i] = error;"),
    ("#trace gyro", "trace[(2u * (n - tile.first_sample) + 1u) * stride + i] = turn;"),
];

fn ensemble(int64: bool, laws: &[StudyLaw], places: &Places, traced: bool) -> Shader {
    let mut own = terms::expand(shaders::SIMULATE);
    for (line, text) in TRACE {
        own = own.replace(line, if traced { text } else { "" });
    }
    let follows_temperature = laws.iter().any(|law| law.term.follows_temperature());
    let warm = if follows_temperature { "warmer_k = warmer[n - tile.first_sample];" } else { "" };
    own = own.replace("#warm sample", warm);
    let mut declared = constants(places);
    let own_states = laws.iter().map(|law| law.term.states()).sum::<usize>();
    declared += &format!("const STATE_TERMS = {}u;\n", state::TERMS + own_states);
    let first = places.shown().len() + laws::columns(laws).len();
    for (place, name) in low_pass::NAMED.iter().enumerate() {
        declared += &format!("const LOW_PASS_{name} = {}u;\n", first + place);
    }
    let laws_text = laws::text(laws, places.shown().len()) + &staged::text(laws);
    let text =
        [&declared, LAYOUT, cubic_stiffness::WGSL, OSCILLATOR, &laws_text, &advance(), ACCUMULATE, &own].join("\n");
    with_random_numbers("simulate", &staged::expand(&text, laws), int64)
}

/// One step of the proof mass by whichever method the pipeline was made for.
fn advance() -> String {
    let mut text =
        "fn advance(k: Coefficients, laws: Laws, s: vec2<f32>, f: Force, w: f32, time: f32) -> vec2<f32> {\n"
            .to_owned();
    for method in METHODS.iter().filter(|m| m.moves) {
        let (name, code) = (method.wgsl, method.wgsl.to_uppercase());
        let arguments = if method.reach == Capability::General { "k, laws, s, f, w, time" } else { "k, s, f, w" };
        text += &format!("    if INTEGRATOR == {code} {{\n        return {name}({arguments});\n    }}\n");
    }
    text + "    return s;\n}\n"
}

/// Writes what the host knows by number, so that no number is written twice: columns, states,
/// streams and bounds.
fn constants(places: &Places) -> String {
    let mut text = terms::declarations(places);
    for number in 0..COEFFICIENTS {
        text += &format!("const COEFFICIENT_{number} = {}u;\n", places.column(number));
    }
    for (name, number) in column::NAMED {
        text += &format!("const {name} = {}u;\n", places.column(number));
    }
    for (name, place) in state::NAMED {
        text += &format!("const STATE_{name} = {place}u;\n");
    }
    text += &format!("const SPREAD = {SPREAD}u;\nconst PLACE_MASK = {PLACE_MASK}u;\n");
    text += &format!("const STREAM_FORCE = {}u;\n", Stream::Force as u32);
    for method in METHODS {
        text += &format!("const {} = {}u;\n", method.wgsl.to_uppercase(), method.code());
    }
    let floats = [
        ("RETAINED", RETAINED as f32),
        ("RENEWED", RENEWED as f32),
        ("EIGHTH", EIGHTH as f32),
        ("RENEWED_EIGHTH", (RENEWED * EIGHTH) as f32),
        ("BOUND_M_S2", BOUND_M_S2),
    ];
    for (name, value) in floats {
        text += &format!("const {name} = {value:?};\n");
    }
    text
}

/// The kernel of largest Lyapunov exponents.
pub fn lyapunov(int64: bool) -> Shader {
    with_random_numbers("lyapunov", &[cubic_stiffness::WGSL, ORBIT, shaders::LYAPUNOV].join("\n"), int64)
}

/// The kernel of orbits strobed once per period.
pub fn poincare(int64: bool) -> Shader {
    with_random_numbers("poincare", &[cubic_stiffness::WGSL, ORBIT, shaders::POINCARE].join("\n"), int64)
}

/// The navigation in six axes.
pub fn navigate(int64: bool) -> Shader {
    let streams = [("FIX", Stream::Fix), ("JITTER", Stream::Jitter)];
    let streams = streams.map(|(name, stream)| format!("const STREAM_{name} = {}u;\n", stream as u32)).concat();
    let constants = format!("const BOUND_M_S = {BOUND_M_S:?};\n{streams}");
    let own = shaders::NAVIGATE;
    with_random_numbers("navigate", &[&constants, ACCUMULATE, FIX, own].join("\n"), int64)
}

/// Returns the shader that sums the members of a workgroup.
pub fn reduce() -> Shader {
    Shader { name: "reduce", text: [LAYOUT, shaders::REDUCE].join("\n") }
}

/// Nothing but multiply-adds: the device's peak.
pub fn peak() -> Shader {
    Shader { name: "peak", text: shaders::PEAK.to_owned() }
}

/// A check of the device: what sums keep of a small number next to a large one.
pub fn compensation() -> Shader {
    Shader { name: "compensation", text: [ACCUMULATE, shaders::COMPENSATION].join("\n") }
}
