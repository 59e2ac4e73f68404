//! Errors of one law on all axes of one instrument, as the covariance carries them: a constant with
//! a gain that follows the motion, white noise, a random walk, a held process.
//!
//! After a still start what it has found is taken off: a constant input c next to the process
//! itself, correlated with it.

use nalgebra::SMatrix;

use super::gains::Gains;
use super::linear::{Drive, Felt, Square, Step};
use crate::navigation::slow;

type Inputs = SMatrix<f64, 6, 6>;

/// The response to one constant that is drawn: a column of a root of the covariance.
#[derive(Debug, Clone)]
pub struct Column {
    /// Errors per unit of the constant.
    pub state: SMatrix<f64, 9, 1>,
    /// Part that a still start takes off the inputs, per unit.
    pub taken: SMatrix<f64, 6, 1>,
    /// The input that it acts on, and how.
    pub gain: Gain,
    /// Mean of the constant.
    pub mean: f64,
    /// Variance of the constant.
    pub variance: f64,
}

/// Factor that makes a constant an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gain {
    /// It is no input; it acts by what was taken off or by where the state began.
    None,
    /// One, on this input.
    One(usize),
    /// Specific force along a body axis to a power, on this input.
    Force(usize, usize, i32),
    /// Angular rate about a body axis, on this input.
    Rate(usize, usize),
    /// Time from the beginning of the run, on this input; the still start lasted so long, s.
    Time(usize, f64),
    /// An error that dies out from the beginning of the run on, on this input.
    Settling {
        /// The input.
        input: usize,
        /// The still start lasted so long, s.
        still_s: f64,
        /// Time constant, s.
        tau_s: f64,
    },
    /// A sine from the beginning of the run on, on this input.
    Sine {
        /// The input.
        input: usize,
        /// The still start lasted so long, s.
        still_s: f64,
        /// Frequency, rad/s.
        omega_rad_s: f64,
        /// Phase at the beginning of the run, rad.
        phase_rad: f64,
    },
    /// Kelvins above the reference to a power, on this input.
    Warmer(usize, i32),
    /// The same times what an axis of the input's own instrument feels.
    WarmerFelt(usize),
    /// Change of each input, taken off all of them: per second that the stamps are late.
    Late,
    /// The same times the time from the end of the still start: per second that they gain each
    /// second.
    Later,
}

impl Gain {
    /// The inputs at a time after the end of the still start, when this is felt.
    pub fn inputs(self, felt: &Felt, time_s: f64) -> SMatrix<f64, 6, 1> {
        let mut inputs = SMatrix::zeros();
        match self {
            Self::None => {}
            Self::One(input) => inputs[input] = 1.0,
            Self::Force(input, axis, power) => inputs[input] = felt.force[axis].powi(power),
            Self::Rate(input, axis) => inputs[input] = felt.rate[axis],
            Self::Time(input, still_s) => inputs[input] = still_s + time_s,
            Self::Settling { .. } | Self::Sine { .. } => return self.mean(felt, time_s, 0.0),
            Self::Warmer(input, power) => inputs[input] = felt.warmer_k.powi(power),
            Self::WarmerFelt(input) => {
                let own = if input < 3 { felt.force[input] } else { felt.rate[input - 3] };
                inputs[input] = felt.warmer_k * own;
            }
            Self::Late => {
                (0..3).for_each(|i| inputs[i] = -felt.force_change[i]);
                (0..3).for_each(|i| inputs[3 + i] = -felt.rate_change[i]);
            }
            Self::Later => inputs = Self::Late.inputs(felt, time_s) * time_s,
        }
        inputs
    }

    /// Mean of the inputs over `seconds` that begin `begin_s` after the still start: their value in
    /// the middle, except for the two terms whose course in time is not a straight line.
    pub fn mean(self, felt: &Felt, begin_s: f64, seconds: f64) -> SMatrix<f64, 6, 1> {
        let mut inputs = SMatrix::zeros();
        match self {
            Self::Settling { input, still_s, tau_s } => {
                inputs[input] = (-(still_s + begin_s) / tau_s).exp() * slow::mean_settling(tau_s, seconds);
            }
            Self::Sine { input, still_s, omega_rad_s, phase_rad } => {
                let middle = omega_rad_s * (still_s + begin_s + 0.5 * seconds) + phase_rad;
                inputs[input] = middle.sin() * slow::mean_turning(omega_rad_s, seconds);
            }
            _ => inputs = self.inputs(felt, begin_s + 0.5 * seconds),
        }
        inputs
    }
}

impl Column {
    /// Takes it through a step that begins `time_s` after the end of the still start.
    pub fn advance(&mut self, step: &Step, time_s: f64) {
        let inputs = self.gain.mean(step.felt(), time_s, step.seconds) - self.taken;
        self.state = step.transition * self.state + step.response * inputs;
    }

    /// Corrects it by what a fix sees of it.
    pub fn correct(&mut self, gains: &Gains) {
        self.taken += gains.taken * self.state;
        self.state = gains.kept * self.state;
    }
}

/// Dynamics of the inputs of a family.
#[derive(Debug, Clone)]
pub enum Process {
    /// White noise of these densities, unit²·s.
    White([f64; 6]),
    /// Random walks with these K², unit²/s.
    Walk([f64; 6]),
    /// Held for `every` steps from a phase on, then renewed with e⁻¹ of the old value; with these
    /// variances.
    Held {
        /// Steps between renewals.
        every: u64,
        /// Steps before the first.
        first: u64,
        /// Variance of each input.
        variance: [f64; 6],
    },
    /// First-order Gauss–Markov processes.
    Markov {
        /// Correlation time of each input, s.
        tau_s: [f64; 6],
        /// Variance of each input.
        variance: [f64; 6],
    },
    /// White noise of the instants at which samples are taken, of this density, s²·s: it acts by
    /// what each input changes by.
    Jitter(f64),
    /// No input: the noise of fixes.
    Fixes,
}

/// Covariance of errors x, of the process s and of what was taken off c.
#[derive(Debug, Clone)]
pub struct Family {
    pub(super) process: Process,
    /// Share of it in the whole: one over the phases of a held process.
    pub share: f64,
    /// x xᵀ.
    pub errors: Square,
    pub(super) with_process: Drive,
    pub(super) with_taken: Drive,
    pub(super) process_process: Inputs,
    pub(super) process_taken: Inputs,
    pub(super) taken_taken: Inputs,
}

impl Family {
    /// Without errors, before anything was found.
    pub fn new(process: Process, share: f64) -> Self {
        let process_process = match &process {
            Process::Held { variance, .. } | Process::Markov { variance, .. } => {
                Inputs::from_diagonal(&(*variance).into())
            }
            _ => Inputs::zeros(),
        };
        Self {
            process,
            share,
            errors: Square::zeros(),
            with_process: Drive::zeros(),
            with_taken: Drive::zeros(),
            process_process,
            process_taken: Inputs::zeros(),
            taken_taken: Inputs::zeros(),
        }
    }

    /// Begins after a still start: the means over it have these variances, and these covariances
    /// with the process at its end; per unit of mean, the errors begin so, and so much is taken
    /// off.
    pub fn found(&mut self, mean: &[f64; 6], with_end: &[f64; 6], state: &Drive, taken: &Inputs) {
        let (mean, cross) = (Inputs::from_diagonal(&(*mean).into()), Inputs::from_diagonal(&(*with_end).into()));
        self.errors = state * mean * state.transpose();
        self.with_process = state * cross;
        self.with_taken = state * mean * taken.transpose();
        self.process_taken = cross * taken.transpose();
        self.taken_taken = taken * mean * taken.transpose();
    }

    /// The process itself has these variances at the end of a still start.
    pub fn began(&mut self, variance: &[f64; 6]) {
        self.process_process = Inputs::from_diagonal(&(*variance).into());
    }

    /// Renews the process at the beginning of step `k`.
    pub fn renew(&mut self, k: u64) {
        if let Process::Held { every, first, variance } = &self.process
            && k > 0
            && k % every == first % every
        {
            let kept = (-1.0f64).exp();
            self.with_process *= kept;
            self.process_taken *= kept;
            self.process_process *= kept * kept;
            (0..6).for_each(|i| self.process_process[(i, i)] += variance[i] * (1.0 - kept * kept));
        }
    }

    /// Takes it through a step.
    pub fn advance(&mut self, step: &Step) {
        // A walk grows half before and half after, and a Gauss–Markov process forgets so.
        self.go_on(0.5 * step.seconds);
        let (phi, gamma) = (&step.transition, &step.response);
        let net = self.with_process - self.with_taken;
        let half = phi * self.errors + gamma * net.transpose();
        self.with_process = phi * self.with_process + gamma * (self.process_process - self.process_taken.transpose());
        self.with_taken = phi * self.with_taken + gamma * (self.process_taken - self.taken_taken);
        self.errors = half * phi.transpose() + (self.with_process - self.with_taken) * gamma.transpose();
        match &self.process {
            Process::White(density) => self.errors += step.white(density),
            Process::Jitter(density) => {
                self.errors += step.white_along(&Gain::Late.inputs(step.felt(), 0.0), *density);
            }
            _ => {}
        }
        self.go_on(0.5 * step.seconds);
    }

    /// Corrects it by what a fix sees of it: x becomes (1 − K H) x, c becomes c + G H x, and both
    /// take the fix's noise.
    pub fn correct(&mut self, gains: &Gains) {
        let (kept, taken) = (&gains.kept, &gains.taken);
        let across = taken * self.with_taken;
        self.taken_taken += across + across.transpose() + taken * self.errors * taken.transpose();
        self.with_taken = kept * (self.with_taken + self.errors * taken.transpose());
        self.process_taken += self.with_process.transpose() * taken.transpose();
        self.with_process = kept * self.with_process;
        self.errors = kept * self.errors * kept.transpose();
        if let Process::Fixes = self.process {
            self.errors += gains.noise;
            self.with_taken += gains.noise_with_taken;
            self.taken_taken += gains.noise_of_taken;
        }
    }

    /// Carries a process that is not held over a time.
    fn go_on(&mut self, seconds: f64) {
        match &self.process {
            Process::Walk(k) => (0..6).for_each(|i| self.process_process[(i, i)] += k[i] * seconds),
            Process::Markov { tau_s, variance } => {
                for i in 0..6 {
                    let kept = (-seconds / tau_s[i]).exp();
                    self.with_process.column_mut(i).scale_mut(kept);
                    self.process_taken.row_mut(i).scale_mut(kept);
                    // Inputs are independent: nothing next to the diagonal.
                    self.process_process[(i, i)] *= kept * kept;
                    self.process_process[(i, i)] += variance[i] * (1.0 - kept * kept);
                }
            }
            _ => {}
        }
    }
}
