//! The strength of a law that is to be shown, from the largest motion within the limits, and the lengths that
//! an experiment may have.

use std::f64::consts::FRAC_PI_2;

use crate::driven::base::{GAIN, OMEGA, ZETA};
use crate::driven::intake::input::REACH;
use crate::parallel;
use crate::physics::law::Role;
use crate::physics::state::{BaseLanes, Instants, LANES, MOST_STAGED, MOST_VALUES};

use super::experiment::{self, Experiment};
use super::limits::Limits;
use super::question::{Known, Purpose, Question, Sensor, Strength};
use super::simulated::{Motion, Truth};

/// Cycles of the resonance, and samples, of the shortest experiment.
pub(super) const SHORTEST: (f64, usize) = (30.0, 600);
/// Samples of the longest: beyond them a diagnosis searches a stretch alone.
const MOST_SAMPLES: f64 = 40_000.0;

/// Lengths from the shortest on, each twice the one before, and the longest.
pub(super) fn lengths(limits: &Limits, sensor: &Sensor) -> Vec<f64> {
    let shortest = (SHORTEST.0 / sensor.resonance_hz()).max((SHORTEST.1 + 2 * REACH) as f64 / limits.rate_hz);
    let longest = limits.longest_s.min(MOST_SAMPLES / limits.rate_hz);
    let doubled = std::iter::successors(Some(shortest), |s| Some(2.0 * s));
    doubled.take_while(|s| *s < longest).chain((shortest <= longest).then_some(longest)).collect()
}

/// The question with the strength of a law that is to be shown.
pub(super) fn settled(question: &Question, limits: &Limits) -> Option<Question> {
    let Purpose::Show(strength) = question.purpose else { return Some(question.clone()) };
    let truth = Truth { sensor: &question.sensor, common: &question.common, own: None };
    let hz = question.sensor.resonance_hz();
    let seconds = lengths(limits, &question.sensor).last().copied()?.min(200.0 / hz);
    let shapes = experiment::all(limits, hz, question.sensor.base[ZETA]);
    let motions = parallel::filter_map(&shapes, |(shape, level)| {
        Motion::of(&truth, &Experiment { shape: *shape, level: *level, seconds, rate_hz: limits.rate_hz }, limits)
    });
    let motion = motions.into_iter().max_by(|a, b| a.largest().total_cmp(&b.largest()))?;
    let mut known = question.rivals.first()?.clone();
    let starts = known.term.starts(motion.scales());
    known.values = starts.get(starts.len() / 2)?.clone();
    known.values[0] = match strength {
        Strength::Value(value) => value,
        Strength::Share(share) => strength_of(&known, &question.sensor, motion.largest(), share),
    };
    Some(Question { rivals: vec![known], ..question.clone() })
}

/// The first parameter of a force that is, at most, this part of the spring's in a swing of this size.
fn strength_of(known: &Known, sensor: &Sensor, largest: f64, share: f64) -> f64 {
    let [gain, omega, zeta] = [GAIN, OMEGA, ZETA].map(|i| sensor.base[i]);
    let spring = omega * omega * largest;
    if known.term.role() == Role::Friction {
        return share * spring;
    }
    let all = |v: f64| [v; LANES];
    let base = BaseLanes { gain: all(gain), stiffness: all(omega * omega), damping: all(2.0 * zeta * omega) };
    let mut p = [[0.0; LANES]; MOST_VALUES];
    p.iter_mut().zip(&known.values).for_each(|(row, v)| *row = all(*v));
    p[0] = all(1.0);
    // Eight phases of a quarter swing, its ends among them.
    let phase = |l: usize| FRAC_PI_2 * l as f64 / (LANES - 1) as f64;
    let at = Instants {
        time: 0.0,
        step: 0.0,
        input: std::array::from_fn(|l| spring / gain * phase(l).cos()),
        x: std::array::from_fn(|l| largest * phase(l).cos()),
        v: std::array::from_fn(|l| largest * omega * phase(l).sin()),
        base: &base,
        environment: &[],
    };
    let (own, mut rates, mut acceleration) = ([all(0.0); MOST_STAGED], [all(0.0); MOST_STAGED], all(0.0));
    known.term.force::<f64, LANES, false>(&at, &p, &own, &mut rates, &mut acceleration);
    share * spring / acceleration.iter().fold(1e-300f64, |a, f| a.max(f.abs()))
}
