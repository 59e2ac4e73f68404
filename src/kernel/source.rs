//! The shaders as text: shared parts first, then the kernel.
//!
//! Not for running them: `backend::gpu` does. Its tests, in `mirror`, hold them against the host with naga.

#[cfg(test)]
mod mirror;

/// A shader, ready for a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shader {
    /// Name of its file and of its entry point.
    pub name: &'static str,
    /// WGSL.
    pub text: String,
}

const PHILOX: &str = include_str!("../../shaders/shared/philox.wgsl");
const MULTIPLY_16: &str = include_str!("../../shaders/shared/philox_multiply_16.wgsl");
const MULTIPLY_64: &str = include_str!("../../shaders/shared/philox_multiply_64.wgsl");
const ELEMENTARY: &str = include_str!("../../shaders/shared/elementary.wgsl");
const LAYOUT: &str = include_str!("../../shaders/shared/layout.wgsl");
const OSCILLATOR: &str = include_str!("../../shaders/shared/oscillator.wgsl");
const ACCUMULATE: &str = include_str!("../../shaders/shared/accumulate.wgsl");

/// A kernel's own text behind random numbers and elementary functions; `int64`: the adapter has 64-bit integers.
pub fn with_random_numbers(name: &'static str, text: &str, int64: bool) -> Shader {
    let multiply = if int64 { MULTIPLY_64 } else { MULTIPLY_16 };
    Shader { name, text: [multiply, PHILOX, ELEMENTARY, text].join("\n") }
}

/// The ensemble kernel.
pub fn simulate(int64: bool) -> Shader {
    let own = include_str!("../../shaders/simulate.wgsl");
    with_random_numbers("simulate", &[LAYOUT, OSCILLATOR, ACCUMULATE, own].join("\n"), int64)
}

/// Text that both map kernels share.
const ORBIT: &str = include_str!("../../shaders/shared/orbit.wgsl");

/// The kernel of largest Lyapunov exponents.
pub fn lyapunov(int64: bool) -> Shader {
    with_random_numbers("lyapunov", &[ORBIT, include_str!("../../shaders/lyapunov.wgsl")].join("\n"), int64)
}

/// The kernel of orbits strobed once per period.
pub fn poincare(int64: bool) -> Shader {
    with_random_numbers("poincare", &[ORBIT, include_str!("../../shaders/poincare.wgsl")].join("\n"), int64)
}

/// The reduction.
pub fn reduce() -> Shader {
    Shader { name: "reduce", text: [LAYOUT, include_str!("../../shaders/reduce.wgsl")].join("\n") }
}

/// Nothing but multiply-adds: the device's peak.
pub fn peak() -> Shader {
    Shader { name: "peak", text: include_str!("../../shaders/peak.wgsl").to_owned() }
}

/// A check of the device: what sums keep of a small number beside a large one.
pub fn compensation() -> Shader {
    Shader { name: "compensation", text: [ACCUMULATE, include_str!("../../shaders/compensation.wgsl")].join("\n") }
}
