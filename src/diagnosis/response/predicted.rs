//! States what a model predicts for every step, with its derivatives.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::physics::library::Term;

use super::force::Law;
use super::impedance::Impedance;
use super::intake::Sweeps;
use super::steady_state::Table;
use super::values::{Sizes, Values};

/// Step in coordinates for the derivatives of laws: small next to any feature, large next to
/// rounding.
pub(super) const NUDGE: f64 = 1e-4;
/// Amplitudes are tabulated up to so many times the largest that was read.
pub(super) const REACH: f64 = 1.6;
/// Least slope of the push with amplitude, in that of a linear spring, by which a derivative is computed: at a fold
/// the slope is zero and the derivative infinite, which would lead a fit astray.
const LEAST_SLOPE: f64 = 0.3;
/// Part of (Γ/2)² below which the product of both rates at which a motion settles says that the slower one is less
/// than half of Γ/2, that of a linear resonance: 1 − √(1 − q) < ½.
const SLOW: f64 = 0.75;

/// Part of the largest amplitude of a drive by which the motions of two branches differ at least.
const FAR: f64 = super::unsettled::LEAST;

type Phasor = Complex<f64>;

/// States where the amplitude of a motion comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Amplitude {
    /// From the reading: the force of the laws is that of the motion that was read.
    Read,
    /// From the model: of the motions that it allows, the one nearest to the reading.
    Nearest,
    /// From the model alone: the motion of the step before is followed for as long as it is stable.
    Followed,
}

/// A model's prediction.
#[derive(Debug, Clone)]
pub(super) struct Predicted {
    /// Predicted reading of each step.
    pub reading: Vec<Phasor>,
    /// Amplitude of the displacement.
    pub amplitude: Vec<f64>,
    /// Steps at which the model allows several stable motions.
    pub several: Vec<bool>,
    /// Steps at which the motion settles at less than half the rate of a linear resonance, as next to the end of a
    /// branch.
    pub is_slow: Vec<bool>,
    /// Steps whose motion is one of the model's own; false where it is read on a branch that the model has not.
    pub is_there: Vec<bool>,
    /// Force of the laws over amplitude and frequency.
    pub table: Table,
    /// Origin of the amplitude.
    from: Amplitude,
    /// Amplitude at which the force of the laws is taken.
    argument: Vec<f64>,
    /// Reading of each step without what the step before left in it.
    settled: Vec<Phasor>,
    /// Displacement.
    motion: Vec<Phasor>,
    /// Z of each step, and its slope by amplitude where the amplitude answers.
    impedance: Vec<(Phasor, Phasor)>,
    /// Reading over displacement.
    readout: Vec<Phasor>,
}

/// Reading for a unit of displacement: its derivative by time, the lock-in's angle, and what the
/// laws of the readout do.
pub(super) fn readout(sweeps: &Sweeps, sizes: &Sizes, values: &Values, k: usize) -> Phasor {
    let omega = TAU * sweeps.frequency_hz[k];
    let all = Phasor::new(0.0, omega).powi(sweeps.derivatives) * Phasor::from_polar(1.0, values.angle_rad);
    let about = sizes.laws.omega_rad_s;
    // About the resonance, so that size and angle there stay the gain's, whatever the law's strength.
    let filters = values.laws.iter().filter_map(|law| Some(filter(law, omega)? / filter(law, about)?));
    all * filters.product::<Phasor>()
}

/// Response of a law of the readout.
fn filter(law: &Law, omega_rad_s: f64) -> Option<Phasor> {
    let turn = omega_rad_s * law.values.first()?;
    match law.term {
        Term::ReadoutDelay(_) => Some(Phasor::from_polar(1.0, -turn)),
        Term::ReadoutLowpass(_) => Some(Phasor::new(1.0, turn).inv()),
        Term::ReadoutHighpass(_) => Some(Phasor::new(1.0, -1.0 / turn).inv()),
        _ => None,
    }
}

/// Displacement of modes that answer the same drive and are read with the mass.
pub(super) fn beside(sweeps: &Sweeps, values: &Values, k: usize) -> Phasor {
    let omega = TAU * sweeps.frequency_hz[k];
    let modes = values.laws.iter().filter(|law| matches!(law.term, Term::ParasiticMode(_)));
    let one = |law: &Law| {
        let [gain, own, zeta] = [law.values[0], law.values[1], law.values[2]];
        gain * sweeps.drive[k] / Phasor::new(own * own - omega * omega, 2.0 * zeta * own * omega)
    };
    modes.map(one).sum()
}

/// Background of each number in turn.
pub(super) fn shapes(sweeps: &Sweeps, sizes: &Sizes, k: usize) -> [f64; 4] {
    let [low, high] = sizes.band_hz;
    let along = (sweeps.frequency_hz[k] - 0.5 * (low + high)) / (high - low);
    let drive = sweeps.drive[k] / sizes.drive;
    [1.0, along, drive, along * drive]
}

fn background(sweeps: &Sweeps, sizes: &Sizes, values: &Values, k: usize) -> Phasor {
    values.background.iter().zip(shapes(sweeps, sizes, k)).map(|(b, s)| b * s).sum()
}

/// Force of linear laws for a unit of displacement.
fn linear(sweeps: &Sweeps, values: &Values, k: usize) -> Phasor {
    let omega = TAU * sweeps.frequency_hz[k];
    let time_s = sweeps.time_s.as_ref().map_or(0.0, |t| t[k]);
    values.laws.iter().filter(|law| law.is_linear()).map(|law| law.linear(&values.mass, omega, time_s)).sum()
}

fn table(sizes: &Sizes, values: &Values, amplitude: Amplitude) -> Table {
    let band = sizes.band_hz.map(|f| TAU * f);
    let new = if amplitude == Amplitude::Read { Table::rough } else { Table::new };
    new(&values.mass, &values.laws, REACH * sizes.amplitude, band)
}

/// The prediction of a model.
pub(super) fn predicted(sweeps: &Sweeps, sizes: &Sizes, values: &Values, amplitude: Amplitude) -> Predicted {
    let n = sweeps.len();
    let mut all = Predicted {
        reading: Vec::with_capacity(n),
        amplitude: Vec::with_capacity(n),
        several: Vec::with_capacity(n),
        is_slow: Vec::with_capacity(n),
        is_there: Vec::with_capacity(n),
        table: table(sizes, values, amplitude),
        from: amplitude,
        argument: Vec::with_capacity(n),
        settled: Vec::with_capacity(n),
        motion: Vec::with_capacity(n),
        impedance: Vec::with_capacity(n),
        readout: Vec::with_capacity(n),
    };
    for sweep in &sweeps.sweeps {
        for k in sweep.clone() {
            let readout = readout(sweeps, sizes, values, k);
            let background = background(sweeps, sizes, values, k);
            let beside = beside(sweeps, values, k);
            let along = all.table.along(&values.mass, TAU * sweeps.frequency_hz[k], linear(sweeps, values, k));
            let push = values.gain * sweeps.drive[k].max(0.0);
            let first = k == sweep.start || !sweeps.is_ordered;
            let read = {
                let before = if first { sweeps.reading[k] } else { sweeps.reading[k - 1] };
                let settled = (sweeps.reading[k] - before * values.settling) / (1.0 - values.settling);
                ((settled - background) / readout - beside).norm()
            };
            let wanted = match amplitude {
                Amplitude::Followed if !first => all.amplitude[k - 1],
                _ => read,
            };
            let far = FAR * sizes.amplitude * (sweeps.drive[k] / sizes.drive);
            let Moved { amplitude: a, argument, z, slope, several, is_there } =
                moved(&along, push, wanted, (amplitude, far));
            let motion = if push > 0.0 { z.conj() * (a / z.norm().max(1e-300)) } else { Phasor::from(0.0) };
            let settled = readout * (motion + beside) + background;
            let reading = match first {
                true => settled,
                false => settled + (all.reading[k - 1] - settled) * values.settling,
            };
            all.reading.push(reading);
            all.amplitude.push(a);
            all.argument.push(argument);
            all.several.push(several);
            let rates = (z.conj() * (z + slope * a)).re;
            all.is_slow
                .push(is_there && rates < SLOW * (TAU * sweeps.frequency_hz[k] * values.mass.damping_per_s).powi(2));
            all.is_there.push(is_there);
            all.settled.push(settled);
            all.motion.push(motion);
            all.impedance.push((z, slope));
            all.readout.push(readout);
        }
    }
    all
}

/// One motion.
struct Moved {
    amplitude: f64,
    /// Amplitude at which Z is taken.
    argument: f64,
    z: Phasor,
    /// Slope of Z by amplitude.
    slope: Phasor,
    /// States whether there were several.
    several: bool,
    /// States whether it is one of the model's own.
    is_there: bool,
}

/// The motion at a step whose read or followed amplitude is `wanted`. One that is read on a branch that
/// the model has not, `far` from all that it has, is held against the balance of forces there: across the
/// end of a branch no derivative leads.
fn moved(along: &Impedance<'_>, push: f64, wanted: f64, (amplitude, far): (Amplitude, f64)) -> Moved {
    let stable = if amplitude == Amplitude::Read { Vec::new() } else { along.stable(push) };
    let several = stable.len() > 1;
    let nearest = stable.iter().copied().min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
    let is_there = |a: &f64| amplitude == Amplitude::Followed || (a - wanted).abs() < far;
    match nearest.filter(is_there) {
        Some(a) => {
            let (z, slope) = along.at(a);
            Moved { amplitude: a, argument: a, z, slope, several, is_there: true }
        }
        None => {
            let (z, _) = along.at(wanted);
            let amplitude = push / z.norm().max(1e-300);
            Moved { amplitude, argument: wanted, z, slope: Phasor::from(0.0), several, is_there: false }
        }
    }
}

impl Predicted {
    /// Change of the displacement of a step, over that displacement, where Z changes by `by_z` and
    /// the push by a part `by_push` of itself.
    fn moved(&self, k: usize, by_z: Phasor, by_push: f64) -> Phasor {
        let (z, slope) = self.impedance[k];
        let change = z * by_push - by_z;
        let w = z + slope * self.amplitude[k];
        let square = z.norm_sqr().max(1e-300);
        let along = z.conj() * w;
        let grows = (z.conj() * change).re / along.re.max(LEAST_SLOPE * square);
        let turns = ((z.conj() * change).im - grows * along.im) / square;
        Phasor::new(grows, turns)
    }

    /// Derivatives of the reading by every shared coordinate; `nudged` is the model with each
    /// coordinate of a law moved and the place of that law, `None` where it is held.
    pub(super) fn derivatives(
        &self,
        sweeps: &Sweeps,
        sizes: &Sizes,
        values: &Values,
        nudged: &[Option<(usize, Values)>],
    ) -> Vec<Vec<Phasor>> {
        let n = sweeps.len();
        let nothing = || vec![Phasor::from(0.0); n];
        let steps = |of: &dyn Fn(usize) -> Phasor| -> Vec<Phasor> { (0..n).map(of).collect() };
        let size = |k: usize| self.readout[k] * self.motion[k];
        let omega = |k: usize| TAU * sweeps.frequency_hz[k];
        let by_z = |k: usize, by_z: Phasor| size(k) * self.moved(k, by_z, 0.0);
        let mut all = vec![
            steps(&|k| by_z(k, Phasor::from(2.0 * values.mass.omega_rad_s * sizes.damping_per_s))),
            steps(&|k| by_z(k, Phasor::new(0.0, omega(k) * values.mass.damping_per_s))),
            steps(&|k| size(k) * self.moved(k, Phasor::from(0.0), 1.0)),
            steps(&|k| self.readout[k] * (self.motion[k] + beside(sweeps, values, k)) * Phasor::new(0.0, 1.0)),
        ];
        // Settling comes last, for it acts on all others.
        let settling = all.len();
        all.push(nothing());
        for i in 0..values.background.len() {
            for unit in [Phasor::new(1.0, 0.0), Phasor::new(0.0, 1.0)] {
                all.push(steps(&|k| unit * (0.1 * sizes.reading * shapes(sweeps, sizes, k)[i])));
            }
        }
        for moved in nudged {
            let Some((place, moved)) = moved else {
                all.push(nothing());
                continue;
            };
            let own = moved.laws[*place].is_tabulated().then(|| table(sizes, moved, self.from));
            let other = own.as_ref().unwrap_or(&self.table);
            all.push(steps(&|k| {
                let [from, to] = [(&self.table, values), (other, moved)]
                    .map(|(table, v)| table.along(&v.mass, omega(k), linear(sweeps, v, k)).at(self.argument[k]).0);
                let turned = readout(sweeps, sizes, moved, k) - self.readout[k];
                let [here, there] = [values, moved].map(|v| beside(sweeps, v, k));
                let read = turned * (self.motion[k] + here) + self.readout[k] * (there - here);
                (by_z(k, to - from) + read) / NUDGE
            }));
        }
        for (i, column) in all.iter_mut().enumerate() {
            for sweep in sweeps.sweeps.iter().filter(|_| sweeps.is_ordered) {
                for k in sweep.start + 1..sweep.end {
                    let own = if i == settling {
                        self.reading[k - 1] - self.settled[k]
                    } else {
                        column[k] * (1.0 - values.settling)
                    };
                    column[k] = own + column[k - 1] * values.settling;
                }
            }
        }
        all
    }
}
