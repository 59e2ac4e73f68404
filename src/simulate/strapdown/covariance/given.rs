//! Writes the share of the axes in one source of error as columns and families that the covariance
//! carries.

use super::found::{Found, column};
use crate::kernel::flicker;
use crate::kernel::flight::Flight;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::source::ErrorSource;
use crate::sensor::{Sense, SensorTerm, coupling, mechanics};
use crate::strapdown::family::{Column, Family, Gain, Process};
use crate::strapdown::held;
use crate::study::in_motion::InMotion;
use crate::study::tolerances::Tolerances;
use crate::units::key::Key;

/// Phases over which a held process is averaged.
const PHASES: u64 = 8;

/// Adds what readings take from other axes, from the temperature and from late stamps.
pub fn couplings(key: &'static Key, motion: &InMotion, found: Option<&Found>, flight: &Flight) -> Vec<Column> {
    if *key == coupling::TIME_OFFSET || *key == coupling::CLOCK_DRIFT {
        let moments = motion.between[0].moments(key);
        let gain = if *key == coupling::CLOCK_DRIFT { Gain::Later } else { Gain::Late };
        return if moments == (0.0, 0.0) { Vec::new() } else { vec![column(gain, moments, found, flight)] };
    }
    if *key == coupling::TIME_JITTER || *key == coupling::GYRO_RANGE {
        // Noise is no column, and a range is not linear.
        return Vec::new();
    }
    match coupling::OVER_TEMPERATURE.into_iter().position(|other| other == key) {
        Some(place) => over_temperature(place, key, motion, found, flight),
        None => between_axes(key, motion, found, flight),
    }
}

/// Adds what follows the temperature: which of the four.
fn over_temperature(
    place: usize,
    key: &'static Key,
    motion: &InMotion,
    found: Option<&Found>,
    flight: &Flight,
) -> Vec<Column> {
    let one = |axis: usize| {
        let (input, moments) = (3 * (place / 2) + axis, motion.between[axis].moments(key));
        let gain = if place.is_multiple_of(2) { Gain::Warmer(input, 1) } else { Gain::WarmerFelt(input) };
        (moments != (0.0, 0.0)).then(|| column(gain, moments, found, flight))
    };
    (0..3).filter_map(one).collect()
}

fn between_axes(key: &'static Key, motion: &InMotion, found: Option<&Found>, flight: &Flight) -> Vec<Column> {
    let mut columns = Vec::new();
    for axis in 0..3 {
        let moments = motion.between[axis].moments(key);
        if moments == (0.0, 0.0) {
            continue;
        }
        for from in 0..3 {
            let gain = if *key == coupling::ACCELEROMETER_MISALIGNMENT && from < axis {
                Gain::Force(axis, from, 1)
            } else if *key == coupling::G_SENSITIVITY {
                Gain::Force(3 + axis, from, 1)
            } else if *key == coupling::GYRO_SCALE_FACTOR && from == axis
                || *key == coupling::GYRO_MISALIGNMENT && from != axis
            {
                Gain::Rate(3 + axis, from)
            } else {
                continue;
            };
            columns.push(column(gain, moments, found, flight));
        }
    }
    columns
}

/// Share of the axes in one source: moments of its coefficient, SI.
pub struct Given<'a> {
    source: ErrorSource,
    pub(super) moments: [(f64, f64); 3],
    pub(super) tolerances: &'a [Tolerances; 3],
}

impl<'a> Given<'a> {
    /// Its moments; `None` where no axis has it.
    pub fn of(source: ErrorSource, motion: &'a InMotion) -> Option<Self> {
        let moments = motion.tolerances.each_ref().map(|all| match source {
            ErrorSource::Mechanics => {
                (if all[&mechanics::RESONANCE].is_some() || all[&mechanics::MASS].is_some() { 1.0 } else { 0.0 }, 0.0)
            }
            ErrorSource::ForceNoise => all.moments(&mechanics::FORCE_NOISE),
            ErrorSource::Term(term) => all.given(term).map_or((0.0, 0.0), |key| all.moments(key)),
        });
        let tolerances = &motion.tolerances;
        moments.iter().any(|m| *m != (0.0, 0.0)).then_some(Self { source, moments, tolerances })
    }

    /// Mean squares of the coefficients at the inputs of a sense.
    pub fn squares(&self, sense: Sense) -> [f64; 6] {
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        let mut squares = [0.0; 6];
        (0..3).for_each(|axis| squares[first + axis] = self.moments[axis].0.powi(2) + self.moments[axis].1);
        squares
    }

    /// The columns and families of the source; `None` where it has no place in a linear model.
    pub fn built(
        &self,
        flight: &Flight,
        found: Option<&Found>,
        stride: u64,
        step_s: f64,
    ) -> Option<(Vec<Column>, Vec<Family>)> {
        let constants = |gain: &dyn Fn(usize) -> Gain| -> (Vec<Column>, Vec<Family>) {
            let axis = |axis: usize| column(gain(axis), self.moments[axis], found, flight);
            ((0..3).map(axis).collect(), Vec::new())
        };
        let (term, sense) = match self.source {
            ErrorSource::Mechanics => return None,
            ErrorSource::ForceNoise => {
                return Some((Vec::new(), vec![white(self.squares(Sense::Accelerometer), found)]));
            }
            ErrorSource::Term(term) => (term, term.sense()),
        };
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        Some(match term.law() {
            // What follows the temperature is given between the axes.
            ErrorLaw::Rounding
            | ErrorLaw::FullScale
            | ErrorLaw::LowPass
            | ErrorLaw::Delay
            | ErrorLaw::Warm(_)
            | ErrorLaw::Shape(_) => return None,
            ErrorLaw::Markov(_) => (Vec::new(), vec![self.markov(term, found, step_s)?]),
            ErrorLaw::Settling => (self.settling(term, flight, found)?, Vec::new()),
            ErrorLaw::Sine => (self.sines(term, flight, found)?, Vec::new()),
            ErrorLaw::Constant | ErrorLaw::Offset => constants(&|axis| Gain::One(first + axis)),
            ErrorLaw::Proportional(power) => constants(&|axis| match sense {
                Sense::Accelerometer => Gain::Force(axis, axis, power as i32),
                Sense::Gyro => Gain::Rate(3 + axis, axis),
            }),
            ErrorLaw::Force(power) => constants(&|axis| Gain::Force(first + axis, axis, power as i32)),
            ErrorLaw::WarmPower(power) => constants(&|axis| Gain::Warmer(first + axis, power as i32)),
            ErrorLaw::Ramp => constants(&|axis| Gain::Time(first + axis, found.map_or(0.0, |f| f.seconds))),
            ErrorLaw::White(_) => (Vec::new(), vec![white(self.squares(sense), found)]),
            ErrorLaw::Walk(_) => (Vec::new(), vec![walk(self.squares(sense), found)]),
            ErrorLaw::Flicker(_) => (Vec::new(), self.flicker(term, flight, found, stride, step_s)),
        })
    }

    /// The terms of a bias instability.
    fn flicker(
        &self,
        term: SensorTerm,
        flight: &Flight,
        found: Option<&Found>,
        stride: u64,
        step_s: f64,
    ) -> Vec<Family> {
        let squares = self.squares(term.sense());
        let sample_s = flight.clock().sample_s();
        let mut families = Vec::new();
        let mut fast = [0.0; 6];
        for j in 0..flicker::terms(flight.clock().samples) {
            let variance = squares.map(|b| b * flicker::amplitude(j).powi(2));
            let hold = 4u64.pow(j as u32);
            if hold < stride {
                // White over a step: the sum of its covariances over all lags.
                let kept = (-1.0f64).exp();
                let seconds = hold as f64 * sample_s * (1.0 + kept) / (1.0 - kept);
                fast.iter_mut().zip(variance).for_each(|(f, v)| *f += v * seconds);
                continue;
            }
            let every = hold / stride;
            let (_, firsts) = flicker::hold_and_firsts(j, PHASES);
            for first in &firsts {
                // First renewals count from the beginning of the run, steps from the end of the
                // still start.
                let first = (first + hold - flight.clock().still_samples % hold) % hold / stride;
                let process = Process::Held { every, first, variance };
                let mut family = Family::new(process, 1.0 / firsts.len() as f64);
                if let Some(found) = found {
                    let [of_mean, with_end] = held::mean_and_end(every, first, found.seconds / step_s);
                    let (mean, cross) = (variance.map(|v| v * of_mean), variance.map(|v| v * with_end));
                    family.found(&mean, &cross, &found.state, &found.taken);
                }
                families.push(family);
            }
        }
        if fast.iter().any(|f| *f > 0.0) {
            families.push(white(fast, found));
        }
        families
    }
}

/// White noise of these densities, N².
pub fn white(density: [f64; 6], found: Option<&Found>) -> Family {
    let mut family = Family::new(Process::White(density), 1.0);
    if let Some(found) = found {
        family.found(&density.map(|q| q / found.seconds), &[0.0; 6], &found.state, &found.taken);
    }
    family
}

/// Random walks with these K²: over a still start of T the mean has variance K²T/3, the end K²T,
/// and both K²T/2.
pub fn walk(squares: [f64; 6], found: Option<&Found>) -> Family {
    let mut family = Family::new(Process::Walk(squares), 1.0);
    if let Some(found) = found {
        let by = |share: f64| squares.map(|k| k * found.seconds * share);
        family.found(&by(1.0 / 3.0), &by(0.5), &found.state, &found.taken);
        family.began(&by(1.0));
    }
    family
}
