//! Predicts one window by the linear error model: the effect of biases and of each error of a
//! sensor on its end.

use nalgebra::{SMatrix, SVector};

use super::window::{Nine, Window};
use crate::error::Result;
use crate::kernel::flight::Flight;
use crate::kernel::job::Clock;
use crate::sensor::Sense;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::source::ErrorSource;
use crate::strapdown::covariance::given::Given;
use crate::strapdown::covariance::steps::{self, Stop};
use crate::strapdown::covariance::{self, Carried, Cause, given};
use crate::strapdown::family::{Column, Family, Gain};
use crate::strapdown::linear::Square;
use crate::study::in_motion::{InMotion, Run};
use crate::study::second::Seeds;

/// Effect of biases on the end.
pub type ToEnd = SMatrix<f64, 9, 6>;

/// A window as the linear model has it.
pub struct Linear {
    flight: Flight,
    stride: u64,
    steps: Vec<Stop>,
    /// End errors per unit of a bias.
    pub to_end: ToEnd,
    /// End errors per radian of an attitude error at the start, about north, east and down.
    pub attitude: [Nine; 3],
    /// End errors per m/s and per m of an error of velocity and of position at the start, north, east and down.
    moved: [[Nine; 3]; 2],
    /// Standard deviations of the reference's position, m, and velocity, m/s, along each axis.
    reference: [f64; 2],
}

/// One error of a sensor.
#[derive(Debug, Clone)]
pub enum Part {
    /// A constant of the sensor, the same in every window of a flight: end error per unit, its mean
    /// and its variance.
    Constant {
        /// Input that the constant acts on, and how.
        gain: Gain,
        /// End error per unit.
        end: Nine,
        /// Mean of the constant.
        mean: f64,
        /// Variance of the constant.
        variance: f64,
    },
    /// Noise that no two windows share.
    Noise {
        /// Dynamics of the error.
        kind: Kind,
        /// Squared coefficients at the six inputs, SI.
        squares: [f64; 6],
        /// Covariance of the end error.
        end: Box<Square>,
    },
}

/// Kinds of noise, by what they do to biases that were found at another time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// White: nothing but what a mean leaves.
    White,
    /// A random walk, which goes on between.
    Walk,
    /// Bias instability: flicker noise.
    Flicker,
    /// The attitude of the reference.
    Attitude,
    /// Position and velocity of the reference.
    Poses,
}

/// Fewest steps of a window.
const FEWEST_STEPS: u64 = 250;

impl Linear {
    /// Of a window.
    ///
    /// # Errors
    /// A proof mass that no integrator can step.
    pub fn new(motion: &InMotion, window: &Window) -> Result<Self> {
        let flight = flight(motion, window)?;
        let stride = steps::stride(&flight, FEWEST_STEPS);
        let steps = steps::steps(&flight, stride);
        let column = |gain| Column { state: SVector::zeros(), taken: SVector::zeros(), gain, mean: 0.0, variance: 1.0 };
        let mut columns: Vec<Column> = (0..6).map(|input| column(Gain::One(input))).collect();
        // Attitude, velocity, position.
        columns.extend((0..9).map(|place| {
            let mut off = column(Gain::None);
            off.state[place] = 1.0;
            off
        }));
        let ends = steps::responses(&steps, columns);
        Ok(Self {
            flight,
            stride,
            steps,
            to_end: ToEnd::from_columns(&ends[..6]),
            attitude: [ends[6], ends[7], ends[8]],
            moved: [[ends[9], ends[10], ends[11]], [ends[12], ends[13], ends[14]]],
            reference: window.reference,
        })
    }

    /// The errors of a sensor, always in the same order, and the causes that the model leaves out.
    ///
    /// # Errors
    /// A proof mass that no integrator can step.
    pub fn parts(&self, sensor: &InMotion) -> Result<(Vec<Part>, Vec<Cause>)> {
        let (causes, left_out) = covariance::causes(sensor, &self.flight, self.stride);
        let mut parts = Vec::new();
        for Carried { cause, columns, families, squares } in causes {
            if cause == Cause::Alignment || is_left_out(cause) {
                continue;
            }
            let ends = steps::responses(&self.steps, columns.clone());
            parts.extend(columns.iter().zip(ends).map(|(column, end)| Part::Constant {
                gain: column.gain,
                end,
                mean: column.mean,
                variance: column.variance,
            }));
            if !families.is_empty() {
                let kind = kind(cause);
                parts.push(Part::Noise { kind, squares, end: Box::new(self.carried(families)) });
            }
        }
        parts.push(self.reference_part());
        let misalignment = self.flight.misalignment;
        let variances =
            [misalignment.tilt_sd_rad, misalignment.tilt_sd_rad, misalignment.heading_sd_rad].map(|s| s * s);
        if variances.iter().any(|v| *v > 0.0) {
            parts.push(self.attitude_part(variances));
        }
        Ok((parts, left_out))
    }

    /// Errors of the reference's attitude about north, east and down with these variances, rad²:
    /// one at the start, which the navigator begins with, and one at the end, which it is measured
    /// by.
    pub fn attitude_part(&self, variances: [f64; 3]) -> Part {
        let mut end = Square::zeros();
        for (response, variance) in self.attitude.iter().zip(variances) {
            end += response * response.transpose() * variance;
        }
        // About roll and pitch the two tilts are one.
        (0..3).for_each(|axis| end[(6 + axis, 6 + axis)] += variances[axis]);
        let mut squares = [0.0; 6];
        squares[..3].copy_from_slice(&variances);
        Part::Noise { kind: Kind::Attitude, squares, end: Box::new(end) }
    }

    /// Errors of the reference's position and velocity where its poses err each by itself: at the start, which the
    /// navigator begins with, and at the end, which it is measured by.
    fn reference_part(&self) -> Part {
        let [position, velocity] = self.reference.map(|sd| sd * sd);
        let mut end = Square::zeros();
        for (responses, variance) in self.moved.iter().zip([velocity, position]) {
            end += responses.iter().map(|response| response * response.transpose()).sum::<Square>() * variance;
        }
        (0..3).for_each(|axis| end[(axis, axis)] += position);
        (3..6).for_each(|axis| end[(axis, axis)] += velocity);
        Part::Noise { kind: Kind::Poses, squares: [0.0; 6], end: Box::new(end) }
    }

    /// White noise or a random walk with the coefficient one on each axis of an instrument.
    pub fn unit(&self, kind: Kind, sense: Sense) -> Part {
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        let squares = std::array::from_fn(|i| if (first..first + 3).contains(&i) { 1.0 } else { 0.0 });
        let family = match kind {
            Kind::Walk => given::walk(squares, None),
            _ => given::white(squares, None),
        };
        Part::Noise { kind, squares, end: Box::new(self.carried(vec![family])) }
    }

    fn carried(&self, families: Vec<Family>) -> Square {
        let all = steps::propagated(&self.steps, &[], Vec::new(), families);
        all.last().map_or_else(Square::zeros, |errors| errors.covariance)
    }
}

/// Returns whether windows leave an error out: what dies out from switch-on on, which no window
/// tells of, and what windows share by its memory or its phase, which their covariance does not
/// have.
fn is_left_out(cause: Cause) -> bool {
    let Cause::Sensor(ErrorSource::Term(term)) = cause else { return false };
    matches!(term.law(), ErrorLaw::Markov(_) | ErrorLaw::Settling | ErrorLaw::Sine)
}

/// Errors of a sensor that windows leave out.
pub fn left_out(sensor: &InMotion) -> impl Iterator<Item = ErrorSource> {
    let has = |source: &ErrorSource| is_left_out(Cause::Sensor(*source)) && Given::of(*source, sensor).is_some();
    ErrorSource::ALL.into_iter().filter(has)
}

fn kind(cause: Cause) -> Kind {
    match cause {
        Cause::Sensor(ErrorSource::Term(term)) => match term.law() {
            ErrorLaw::Walk(_) => Kind::Walk,
            ErrorLaw::Flicker(_) => Kind::Flicker,
            _ => Kind::White,
        },
        _ => Kind::White,
    }
}

/// Mean squares of all coefficients of one kind at the six inputs, SI.
pub fn coefficients(sensor: &InMotion, of: Kind) -> [f64; 6] {
    let mut sums = [0.0; 6];
    for source in ErrorSource::ALL {
        let noisy = match source {
            ErrorSource::Term(term) => {
                matches!(term.law(), ErrorLaw::White(_) | ErrorLaw::Walk(_) | ErrorLaw::Flicker(_))
            }
            ErrorSource::ForceNoise => true,
            ErrorSource::Mechanics => false,
        };
        if let Some(given) = Given::of(source, sensor).filter(|_| noisy && kind(Cause::Sensor(source)) == of) {
            let sense = if source.is_gyro() { Sense::Gyro } else { Sense::Accelerometer };
            sums.iter_mut().zip(given.squares(sense)).for_each(|(sum, square)| *sum += square);
        }
    }
    sums
}

/// The flight of one window, without a still start: it begins with the reference's state.
fn flight(motion: &InMotion, window: &Window) -> Result<Flight> {
    let samples = window.steps() as u64;
    let clock = Clock {
        step_s: window.course.truth.interval_s,
        steps_per_sample: 1,
        samples,
        report_samples: vec![samples],
        still_samples: 0,
    };
    let run = Run { seeds: &Seeds::one(1), members: 1, clock: &clock, still_samples: 0 };
    motion.along(window.course.clone()).flight(run, vec![samples])
}
