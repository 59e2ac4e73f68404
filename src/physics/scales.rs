//! Sizes: how large things are in a recording, and by what measure each parameter moves, so that no
//! fit knows a unit.
//!
//! Not where fits begin (`start`), which finds most of these sizes.

/// Optimiser coordinate of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// In units of a typical size.
    Linear(f64),
    /// By its logarithm: positive, of unknown order of magnitude. Kept within these bounds.
    Log(f64, f64),
    /// In units of a typical size, kept within bounds.
    Bounded(f64, f64, f64),
    /// Not at all: a size that was chosen, by which others are measured.
    Held,
}

/// Sizes that the base fit found; they scale the candidates' parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// Standard deviation of the output.
    pub output: f64,
    /// Extremes of the output.
    pub output_range: (f64, f64),
    /// Standard deviation of the velocity of the base model.
    pub velocity: f64,
    /// Standard deviation of the input; 0 without one.
    pub input: f64,
    /// ω₀ of the base model.
    pub omega_rad_s: f64,
    /// ζ of the base model.
    pub zeta: f64,
    /// Gain of the base model.
    pub gain: f64,
    /// Sampling interval, s.
    pub interval_s: f64,
    /// Length of the fitted stretch.
    pub duration_s: f64,
    /// Standard deviation of the residual at hand.
    pub residual: f64,
    /// Half the rate at which the reading was sampled, Hz.
    pub highest_hz: f64,
    /// Frequencies at which the residual's spectrum stands out, strongest first, Hz.
    pub lines_hz: Vec<f64>,
    /// Standard deviation of each environment column.
    pub environment: Vec<f64>,
    /// Mean of the output.
    pub centre: f64,
    /// Fineness with which the terms are integrated: steps turn their fastest rate by a quarter of
    /// a radian over this.
    pub fineness: f64,
    /// Samples by which the output clearly lags the input; 0 where it does not.
    pub lag_samples: f64,
    /// States whether the reading follows the input at once, so that ω₀ and ζ are a convention.
    pub at_once: bool,
}

impl Scales {
    /// Sets gain, ω₀ in rad/s and ζ of the base model, and the velocity that goes with them.
    pub fn begun(&mut self, [gain, omega_rad_s, zeta]: &[f64; 3]) {
        (self.gain, self.omega_rad_s, self.zeta) = (*gain, *omega_rad_s, *zeta);
        self.velocity = self.output * omega_rad_s;
    }
}

#[cfg(test)]
impl Scales {
    /// Those of a mass at ω₀ = 2 rad/s that moves by about 1, in the tests of laws.
    pub(super) fn of_a_mass() -> Self {
        Self {
            output: 1.0,
            output_range: (-2.0, 2.0),
            velocity: 2.0,
            input: 1.0,
            omega_rad_s: 2.0,
            zeta: 0.1,
            gain: 1.0,
            interval_s: 0.1,
            duration_s: 100.0,
            residual: 0.1,
            highest_hz: 5.0,
            lines_hz: Vec::new(),
            environment: Vec::new(),
            centre: 0.0,
            fineness: 1.0,
            lag_samples: 0.0,
            at_once: false,
        }
    }
}
