//! Computes what theory predicts of a study: mean and variance of every error quantity at every
//! time, source by source, in closed form.
//!
//! Independent sources add in variance. What has no closed form (mechanics, saturation, rounding
//! without noise, a scale error on a sine drawn per member) is left out and said. See
//! `navigation::closed_form` for the laws.

use super::course::{Course, CourseIntegrals, Known};
use crate::excitation;
use crate::excitation::plan::Variation;
use crate::kernel::flicker;
use crate::navigation::closed_form::Process;
use crate::sensor::error_law::{ErrorLaw, Growth, Shape};
use crate::sensor::source::ErrorSource;
use crate::sensor::{SensorTerm, mechanics};
use crate::statistics::quantity;
use crate::study::Study;
use crate::units::STANDARD_GRAVITY_M_S2;
use crate::units::key::Key;
use crate::units::number::Number;

/// Mean and variance of one quantity.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Moment {
    /// Mean over members, in the unit of the quantity.
    pub mean: f64,
    /// Variance over members, in the unit of the quantity squared.
    pub variance: f64,
}

/// The closed forms of a study.
#[derive(Debug, Clone)]
pub struct Expected {
    /// Times from the end of the still start, s.
    pub time_s: Vec<f64>,
    /// Sources with a closed form, each with its moments per time, in the order of
    /// `statistics::QUANTITIES`.
    pub sources: Vec<(ErrorSource, Vec<[Moment; 4]>)>,
    /// Variance of the constant bias that the still start leaves of a source, (m/s²)² or (rad/s)²;
    /// nothing without one.
    pub bias_left: Vec<(ErrorSource, f64)>,
    /// Names of the errors without a closed form.
    pub left_out: Vec<String>,
}

impl Expected {
    /// The closed forms of `study` at these samples.
    pub fn of(study: &Study, samples: &[u64]) -> Self {
        let still_s = study.still_s();
        let time_s: Vec<f64> = samples.iter().map(|s| *s as f64 * study.sample_s()).collect();
        let laws = ErrorSource::ALL.map(|source| (source, law(study, source)));
        // Worth its millions of steps only where a source follows the motion.
        let moves = laws.iter().any(|(_, law)| matches!(law, Law::Motion { .. }));
        let motion = if moves { CourseIntegrals::of(study, &time_s) } else { CourseIntegrals::default() };
        let mut left_out = Vec::new();
        let (mut sources, mut bias_left) = (Vec::new(), Vec::new());
        for (source, law) in laws {
            match law {
                Law::Absent => {}
                Law::None(why) => left_out.push(format!("{}: {why}", source.name())),
                Law::Constant { mean, variance, course } => {
                    let moment = |t: f64, n: u32| {
                        let unit = course.grown(still_s, n, t);
                        Moment { mean: mean * unit, variance: variance * unit * unit }
                    };
                    let found = if still_s > 0.0 { course.mean_of_still_start(still_s) } else { 0.0 };
                    let levelled = Moment { mean: mean * found, variance: variance * found * found };
                    let mut rows = chain(source, &time_s, moment, levelled);
                    if source == ErrorSource::Term(SensorTerm::InitialTilt) {
                        // Its SI value is the gravity that the tilt lets in.
                        let g = STANDARD_GRAVITY_M_S2;
                        let tilt = Moment { mean: mean / g, variance: variance / (g * g) };
                        rows.iter_mut().for_each(|row| row[quantity::TILT] = tilt);
                    }
                    sources.push((source, rows));
                }
                Law::Random(processes) => {
                    let moment = |t: f64, n: u32| Moment {
                        mean: 0.0,
                        variance: processes.iter().map(|p| now_or_later(*p, still_s, n, t, study.sample_s())).sum(),
                    };
                    let mut levelled = Moment::default();
                    if still_s > 0.0 {
                        levelled.variance = processes.iter().map(|p| p.variance_of_mean(still_s)).sum();
                        bias_left.push((source, processes.iter().map(|p| p.bias_left(still_s)).sum()));
                    }
                    sources.push((source, chain(source, &time_s, moment, levelled)));
                }
                Law::Motion { course, mean, variance } => {
                    let at = |k: usize| {
                        let integrals = motion.integrals[course as usize][k];
                        let mut integrals = match source.is_gyro() {
                            true => integrals.through_tilt(),
                            false => integrals.direct(),
                        };
                        if let (Some(power), false) = (course.power_of_kelvins(), source.is_gyro()) {
                            integrals[quantity::TILT] = -motion.taken_k.powi(power) / STANDARD_GRAVITY_M_S2;
                        }
                        integrals.map(|i| Moment { mean: mean * i, variance: variance * i * i })
                    };
                    sources.push((source, (0..time_s.len()).map(at).collect()));
                }
            }
        }
        Self { time_s, sources, bias_left, left_out }
    }

    /// All sources together: means add, variances add.
    pub fn total(&self, quantity: usize) -> Vec<Moment> {
        let add = |a: Moment, b: Moment| Moment { mean: a.mean + b.mean, variance: a.variance + b.variance };
        (0..self.time_s.len())
            .map(|k| self.sources.iter().map(|(_, rows)| rows[k][quantity]).fold(Moment::default(), add))
            .collect()
    }
}

/// White noise before any integration is the noise of one sample, and what the still start leaves.
fn now_or_later(process: Process, still_s: f64, integrations: u32, time_s: f64, sample_s: f64) -> f64 {
    match process {
        Process::White(density) if integrations == 0 => density * density / sample_s + process.bias_left(still_s),
        p => p.variance_after_still_start(still_s, integrations, time_s),
    }
}

/// Returns how often a source is integrated on its way to position, velocity, acceleration and
/// tilt, and by g where it is a gyro's. `levelled` is the mean of an accelerometer's source over a
/// still start: the tilt of that much gravity hides it.
fn chain(
    source: ErrorSource,
    time_s: &[f64],
    moment: impl Fn(f64, u32) -> Moment,
    levelled: Moment,
) -> Vec<[Moment; 4]> {
    let gyro = source.is_gyro();
    let g = STANDARD_GRAVITY_M_S2;
    let by_gravity = |m: Moment| Moment { mean: g * m.mean, variance: g * g * m.variance };
    let row = |t: &f64| {
        let mut row = [Moment::default(); 4];
        for (q, n) in [(quantity::POSITION, 2), (quantity::VELOCITY, 1), (quantity::ACCELERATION, 0)] {
            row[q] = if gyro { by_gravity(moment(*t, n + 1)) } else { moment(*t, n) };
        }
        row[quantity::TILT] = match gyro {
            true => moment(*t, 1),
            false => Moment { mean: -levelled.mean / g, variance: levelled.variance / (g * g) },
        };
        row
    };
    time_s.iter().map(row).collect()
}

/// Kind of error that a source is in this study.
enum Law {
    Absent,
    /// There, without a closed form.
    None(&'static str),
    /// A constant per member times a known course.
    Constant {
        mean: f64,
        variance: f64,
        course: Known,
    },
    Random(Vec<Process>),
    /// A constant per member times what all members share.
    Motion {
        course: Course,
        mean: f64,
        variance: f64,
    },
}

fn law(study: &Study, source: ErrorSource) -> Law {
    match source {
        ErrorSource::Mechanics if study.member(0).sensor.proof_mass.is_some() => Law::None(
            "the lag of a linear proof mass stays bounded; further modes, stops and springs that bend have no closed form",
        ),
        ErrorSource::Mechanics => Law::Absent,
        ErrorSource::ForceNoise if is_on(study, &mechanics::FORCE_NOISE) => {
            Law::Random(vec![Process::White(level(study, &mechanics::FORCE_NOISE))])
        }
        ErrorSource::ForceNoise => Law::Absent,
        ErrorSource::Term(term) => match study.tolerances.given(term) {
            Some(key) if is_on(study, key) => law_of_term(study, term, key),
            _ => Law::Absent,
        },
    }
}

fn is_on(study: &Study, key: &Key) -> bool {
    study.tolerances[key].is_some_and(|n| !n.is_zero())
}

/// Root mean square over members, SI: what a spread of noise levels makes of the variance.
fn level(study: &Study, key: &Key) -> f64 {
    let (mean, variance) = study.tolerances.moments(key);
    (mean * mean + variance).sqrt()
}

/// Returns the law of what follows the temperature.
fn warmed(study: &Study, key: &Key, course: Course) -> Law {
    let (mean, variance) = study.tolerances.moments(key);
    Law::Motion { course, mean, variance }
}

fn law_of_term(study: &Study, term: SensorTerm, key: &Key) -> Law {
    let level_si = level(study, key);
    match term.law() {
        ErrorLaw::Proportional(1) | ErrorLaw::Force(1) => motion(study, key, Course::Force),
        ErrorLaw::Proportional(2) | ErrorLaw::Force(2) => motion(study, key, Course::Square),
        ErrorLaw::Proportional(_) | ErrorLaw::Force(_) => Law::None("its error follows the cube of the force"),
        ErrorLaw::Warm(0) => warmed(study, key, Course::Warmer),
        ErrorLaw::Warm(_) => motion(study, key, Course::WarmerForce),
        ErrorLaw::WarmPower(2) => warmed(study, key, Course::WarmerSquare),
        ErrorLaw::WarmPower(_) => warmed(study, key, Course::WarmerCube),
        ErrorLaw::White(_) => Law::Random(vec![Process::White(level_si)]),
        ErrorLaw::Flicker(_) => Law::Random(flicker_processes(study, level_si)),
        ErrorLaw::Walk(_) => Law::Random(vec![Process::Walk(level_si)]),
        ErrorLaw::Markov(_) => match study.tolerances.shape(term, Shape::Memory) {
            Some(tau_s) => Law::Random(vec![Process::Markov { sigma: level_si, tau_s }]),
            None => Law::None("its correlation time is drawn per member"),
        },
        ErrorLaw::Settling => match study.tolerances.shape(term, Shape::Settling) {
            Some(tau_s) => {
                let (mean, variance) = study.tolerances.moments(key);
                Law::Constant { mean, variance, course: Known::Settling(tau_s) }
            }
            None => Law::None("its time constant is drawn per member"),
        },
        ErrorLaw::Sine => match study.tolerances.shape(term, Shape::Frequency) {
            Some(omega_rad_s) if study.tolerances.has_any_phase(term) => {
                Law::Random(vec![Process::Sine { amplitude: level_si, omega_rad_s }])
            }
            _ => Law::None("there is one for a single frequency and all phases"),
        },
        ErrorLaw::Rounding => {
            let white = |other: &SensorTerm| matches!(other.law(), ErrorLaw::White(_)) && other.sense() == term.sense();
            let noise = SensorTerm::ALL.into_iter().find(white).and_then(|t| study.tolerances.given(t));
            let noise_si = noise.map_or(0.0, |key| level(study, key)) / study.sample_s().sqrt();
            // Widrow & Kollár, Quantization Noise (2008), §20: rounding is white with q²/12 once σ
            // is half a step.
            match noise_si >= 0.5 * level_si {
                true => Law::Random(vec![Process::White(level_si / 12f64.sqrt() * study.sample_s().sqrt())]),
                false => Law::None("with less noise than half a step, the rounding error depends on the motion"),
            }
        }
        ErrorLaw::FullScale => Law::None("it acts only beyond full scale"),
        ErrorLaw::LowPass | ErrorLaw::Delay => Law::None(
            "it delays the velocity: the error is that times the change of acceleration, which depends on the motion",
        ),
        law => match law.growth() {
            Growth::OfAConstant(integrals) => {
                let (mean, variance) = study.tolerances.moments(key);
                Law::Constant { mean, variance, course: Known::Power(integrals) }
            }
            Growth::OfWhiteNoise(_) | Growth::Other => Law::None("theory has no closed form for it"),
        },
    }
}

/// Places in the schedule of a flicker term over which its variance is averaged, at most.
const MOST_PLACES: u64 = 256;

/// The sum of held processes that the kernels make bias instability of.
fn flicker_processes(study: &Study, instability: f64) -> Vec<Process> {
    let term = |j: usize| {
        // The mean over the places at which groups of members begin is that of as many processes of
        // a share each.
        let (hold, firsts) = flicker::hold_and_firsts(j, MOST_PLACES);
        let sigma = instability * flicker::amplitude(j) / (firsts.len() as f64).sqrt();
        let (sample_s, hold_s) = (study.sample_s(), hold as f64 * study.sample_s());
        firsts.into_iter().map(move |first| Process::Held { sigma, first_s: first as f64 * sample_s, hold_s })
    };
    (0..flicker::terms(study.alignment.still_samples() + study.clock.samples)).flat_map(term).collect()
}

/// Scale errors act on the motion: a drawn coefficient times a drawn gain to the same power.
fn motion(study: &Study, key: &Key, course: Course) -> Law {
    let (mean, variance) = study.tolerances.moments(key);
    if mean == 0.0 && variance == 0.0 {
        return Law::Absent;
    }
    match study.excitation.variation {
        Variation::Sine => Law::None("its motion is drawn per member"),
        Variation::None => Law::Motion { course, mean, variance },
        Variation::Gain => {
            let gain = study.tolerances[&excitation::SIZE].unwrap_or(Number::Fixed(1.0));
            let expect = |p: i32| {
                let cut = excitation::SIZE.is_cut_at_zero();
                (0..4096).map(|k| gain.quantile((f64::from(k) + 0.5) / 4096.0, cut).powi(p)).sum::<f64>() / 4096.0
            };
            let power = if course == Course::Square { 2 } else { 1 };
            let (first, second) = (expect(power), expect(2 * power));
            Law::Motion {
                course,
                mean: mean * first,
                variance: (mean * mean + variance) * second - (mean * first).powi(2),
            }
        }
    }
}
