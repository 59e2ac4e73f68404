//! What others have published for GPUs, to stand beside what this machine does. Copied figures, not measurements of ours:
//! another machine, another clock, and where noted another scheme.

/// One published speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    /// What was solved, in the words of our own row.
    pub work: &'static str,
    /// By what.
    pub solver: &'static str,
    /// On what.
    pub machine: &'static str,
    /// Steps of one system per second.
    pub per_second: f64,
    /// Where it is printed.
    pub source: &'static str,
}

/// The figures are quoted as they are passed on in the field; the articles behind them (on MPGOS and on DiffEqGPU.jl) were not
/// at hand to compare setting by setting.
const QUOTED: &str = "published figure, quoted; its setting was not compared";

/// All.
pub const PUBLISHED: [Published; 2] = [
    Published {
        work: super::LORENZ,
        solver: "MPGOS (CUDA C++), f32",
        machine: "NVIDIA V100",
        per_second: 8.9e10,
        source: QUOTED,
    },
    Published {
        work: super::DIFFUSION,
        solver: "DiffEqGPU.jl, f32",
        machine: "a GPU",
        per_second: 3.0e9,
        source: QUOTED,
    },
];
