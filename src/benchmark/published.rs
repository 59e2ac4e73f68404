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

/// Utkarsh et al., "Automated translation and accelerated solving of differential equations on multiple GPU platforms",
/// Comput. Methods Appl. Mech. Eng. 419 (2024) 116591.
const UTKARSH: &str = "Utkarsh et al., Comput. Methods Appl. Mech. Eng. 419 (2024) 116591, read off its figures";

/// All.
pub const PUBLISHED: [Published; 2] = [
    Published {
        work: super::LORENZ,
        solver: "MPGOS (CUDA C++), f32",
        machine: "NVIDIA V100",
        per_second: 8.9e10,
        source: UTKARSH,
    },
    Published {
        work: super::DIFFUSION,
        solver: "DiffEqGPU.jl, f32",
        machine: "a GPU of that study",
        per_second: 3.0e9,
        source: UTKARSH,
    },
];
