//! States what others have published for GPUs, to stand next to what this machine does. Copied
//! figures, not measurements of ours: another machine, another clock, and where noted another
//! scheme.
//!
//! Both come from the raw timings that the authors of DiffEqGPU.jl publish with their article
//! (Utkarsh et al., Computer Methods in Applied Mechanics and Engineering, 2024, doi
//! 10.1016/j.cma.2023.116591): the repository utkarsh530/GPUODEBenchmarks, largest ensemble of each
//! file, ensemble × steps over seconds. MPGOS is F. Hegedűs's (Communications in Nonlinear Science
//! and Numerical Simulation, 2021, doi 10.1016/j.cnsns.2021.105732).

/// A speed that others have published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    /// Holds what was solved, in the words of our own row.
    pub work: &'static str,
    /// Program that was measured.
    pub solver: &'static str,
    /// Hardware that it ran on.
    pub machine: &'static str,
    /// Systems in the ensemble.
    pub systems: u64,
    /// Steps of each trajectory.
    pub steps: u64,
    /// Holds what they took, without the copying to and from the card.
    pub milliseconds: f64,
    /// States where it is printed, and how its setting differs from ours.
    pub source: &'static str,
}

impl Published {
    /// Steps of one system per second.
    pub fn per_second(&self) -> f64 {
        self.systems as f64 * self.steps as f64 / (1e-3 * self.milliseconds)
    }
}

pub(crate) const PUBLISHED: [Published; 2] = [
    // The card is not written in the file; the timings of DiffEqGPU.jl committed with it are those
    // that the article's artifacts keep under Tesla_V100, number for number.
    Published {
        work: super::LORENZ,
        solver: "MPGOS (CUDA C++), f32",
        machine: "NVIDIA Tesla V100",
        systems: 8_388_608,
        steps: 1000,
        milliseconds: 94.157,
        source: "GPUODEBenchmarks, data/MPGOS_times_unadaptive.txt; steps of 0.001 from (1, 0, 0), also Runge-Kutta 4 with ρ from \
                 0 to 21",
    },
    Published {
        work: super::DIFFUSION,
        solver: "DiffEqGPU.jl, f32",
        machine: "a CUDA card that is not named",
        systems: 8_388_608,
        steps: 256,
        milliseconds: 715.859498,
        source: "GPUODEBenchmarks, paper_artifacts/data/Julia/SDE/Julia_times_unadaptive.txt; the same equation and steps, b = 0.01",
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_those_passed_on_in_the_field() {
        // 8.9·10¹⁰ steps a second for MPGOS on a V100, 3.0·10⁹ for the stochastic equation.
        let [lorenz, diffusion] = PUBLISHED.map(|p| p.per_second());
        assert!((lorenz - 8.9e10).abs() < 0.05e10 && (diffusion - 3.0e9).abs() < 0.05e9, "{lorenz:e} {diffusion:e}");
    }
}
