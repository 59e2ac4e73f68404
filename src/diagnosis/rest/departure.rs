//! Whether a drift follows the law it was named for: the law's exponent is set free and has its
//! say.
//!
//! Laws of noise and drift have whole exponents: 1/f, 1/f², a bias along t. A drift of another
//! exponent, or one along a smooth course that is no noise at all, is described by a library law or
//! by a sum of them until a fit with a free exponent describes it better. Three things can come
//! out: the exponent lies near the law's, the law is refuted, or the recording cannot tell. Not for
//! channels that share their drift (`common`): that is a course by definition.

use super::blocks;
use super::candidate::row;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Fitted, Term};
use super::laws::{SLOW, slow_laws};
use super::profile::{Profiled, profile};
use super::spectrum::{self, Law, Part};
use super::standing::CLOSE;
use crate::numerics::log_time::log_time;

/// An exponent nearer to a law's than this part of it makes no difference that matters.
const NEAR: f64 = 0.2;
/// Twice the log-likelihood by which a free exponent leaves the 95 % interval of a whole one, so
/// that this one is in doubt.
const DOUBTED: f64 = 3.84;
/// Twice the log-likelihood that a free exponent must gain over a whole one to refute it: one in a
/// thousand by chance.
const REFUTED: f64 = 10.8;
/// Exponents of a spectrum that are tried. A smooth course has a spectrum steeper than any noise's.
const SPECTRAL: [f64; 2] = [0.2, 4.4];
/// Exponents of a drift in time that are tried.
const TEMPORAL: [f64; 2] = [0.15, 4.0];
/// Values that a drift in time is judged on, at most.
const MOST: usize = 2048;
/// Highest degree of a polynomial that stands for a smooth course.
const DEGREES: usize = 6;

/// What a free exponent says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Departure {
    pub(super) ruling: Ruling,
    pub(super) of: Of,
    /// The free exponent; `None` where a smooth course of no such form does best.
    pub(super) exponent: Option<Profiled>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ruling {
    /// The laws named are not what drifts.
    Refuted,
    /// They may be; the recording cannot tell.
    Open,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// Of the spectrum, f^−α.
    Spectrum,
    /// Of the course in time, t^p.
    Time,
}

impl Departure {
    /// Whether it speaks of this cause.
    pub(super) fn concerns(&self, cause: Cause) -> bool {
        let is_slow = SLOW.contains(&cause);
        match (self.of, self.ruling) {
            (Of::Spectrum, _) => is_slow,
            (Of::Time, Ruling::Refuted) => is_slow || is_course(cause),
            (Of::Time, Ruling::Open) => is_course(cause),
        }
    }
}

fn is_course(cause: Cause) -> bool {
    matches!(cause, Cause::RateRamp | Cause::WarmUp)
}

/// What free exponents say of a channel's drift; `None` where its laws hold or it has none.
pub(super) fn judge(channel: &Channel, chosen: &Fitted) -> Option<Departure> {
    let both = [in_time(channel, chosen), in_spectrum(channel, chosen)];
    let refuted = both.iter().flatten().find(|d| d.ruling == Ruling::Refuted).copied();
    refuted.or_else(|| both.into_iter().flatten().next())
}

/// Whether a channel's drift follows a power of time better than the laws that it was named for.
pub(super) fn is_power_of_time(channel: &Channel, chosen: &Fitted) -> bool {
    in_time(channel, chosen).is_some_and(|d| d.ruling == Ruling::Refuted && d.exponent.is_some())
}

/// What is said of one whole exponent: an interval that is merely wide speaks against no law. Which
/// of the whole ones fits is settled before (`laws`).
fn whole(law: f64, free: Profiled, gain: f64) -> Option<Ruling> {
    let is_material = (free.value - law).abs() > NEAR * law;
    if is_material && gain > REFUTED {
        Some(Ruling::Refuted)
    } else if is_material && gain > DOUBTED {
        Some(Ruling::Open)
    } else {
        None
    }
}

/// What is said of another description, by how much better it is.
fn rival(better_by: f64) -> Option<Ruling> {
    if better_by > CLOSE {
        Some(Ruling::Refuted)
    } else if better_by > -CLOSE {
        Some(Ruling::Open)
    } else {
        None
    }
}

/// The slow laws of noise against one of free exponent, on the spectrum that the model's curves
/// leave.
fn in_spectrum(channel: &Channel, chosen: &Fitted) -> Option<Departure> {
    let slow = slow_laws(chosen);
    if slow.is_empty() {
        return None;
    }
    let kept = chosen.terms.iter().filter(|t| !SLOW.contains(&t.cause)).filter_map(|t| match t.addition {
        Addition::Law(law) => Some(law),
        Addition::Curves(_) => None,
    });
    let laws: Vec<Law> = std::iter::once(Law::White).chain(kept).collect();
    let with = |exponent: f64| {
        let all: Vec<Law> = laws.iter().copied().chain([Law::Power(exponent)]).collect();
        spectrum::fit(&chosen.bins, &all, &channel.promised, Part::All).log_likelihood
    };
    let (free, best) = profile(SPECTRAL, 22, with);
    let gain = 2.0 * (best - chosen.log_likelihood());
    let ruling = match slow[..] {
        [Cause::FlickerNoise] => whole(1.0, free, gain)?,
        [Cause::RandomWalk] => whole(2.0, free, gain)?,
        // A memory or a sum has as many numbers as a free exponent, or more.
        _ => {
            let numbers: f64 = slow.iter().map(|c| row(*c).numbers).sum();
            rival(gain + 2.0 * (numbers - 2.0))?
        }
    };
    Some(Departure { ruling, of: Of::Spectrum, exponent: Some(free) })
}

/// A curve over the recording, from 0 to 1.
fn course(count: usize, at: impl Fn(f64) -> f64) -> Curve {
    Curve::new((0..count).map(|n| at((n as f64 + 0.5) / count as f64)).collect())
}

fn term(cause: Cause, curves: Vec<Curve>) -> Term {
    Term { cause, addition: Addition::Curves(curves), searched: 0.0, column: None }
}

/// The drift terms against smooth courses in time: a power of time, a line with a kink,
/// polynomials.
fn in_time(channel: &Channel, chosen: &Fitted) -> Option<Departure> {
    let drifts = |t: &&Term| SLOW.contains(&t.cause) || is_course(t.cause);
    let drift: Vec<Cause> = chosen.terms.iter().filter(drifts).map(|t| t.cause).collect();
    if drift.is_empty() {
        return None;
    }
    let together = channel.values.len().div_ceil(MOST);
    let own = blocks::channel(channel, &channel.values, together);
    let count = own.values.len();
    let coarse = |terms: Vec<&Term>| terms.into_iter().filter_map(|t| blocks::term(t, together)).collect::<Vec<Term>>();
    let rest = coarse(chosen.terms.iter().filter(|t| !drifts(t)).collect());
    let before = own.fit(coarse(chosen.terms.iter().collect()));
    // What a number costs where it is fitted to this many values (Schwarz 1978): a curve takes up
    // what it can of any noise.
    let penalty = (count as f64).ln();
    let with = |curves: Vec<Curve>| -> f64 {
        own.fit(rest.iter().cloned().chain([term(Cause::RateRamp, curves)]).collect()).log_likelihood()
    };
    let merit = |log_likelihood: f64, numbers: f64| 2.0 * log_likelihood - penalty * numbers;
    let numbers: f64 = drift.iter().map(|c| row(*c).numbers).sum();
    let held = merit(before.log_likelihood(), numbers);
    let (free, best) = profile(TEMPORAL.map(f64::ln), 12, |p: f64| with(vec![course(count, |u| u.powf(p.exp()))]));
    let free = free.map(f64::exp);
    if drift[..] == [Cause::RateRamp] {
        let ruling = whole(1.0, free, 2.0 * (best - before.log_likelihood()))?;
        return Some(Departure { ruling, of: Of::Time, exponent: Some(free) });
    }
    let power = merit(best, 2.0);
    let kinked = (1..16).map(|k| f64::from(k) / 16.0).map(|place| {
        let curves = vec![course(count, |u| u), course(count, |u| (u - place).max(0.0))];
        merit(with(curves), 3.0)
    });
    // Of time, and of its logarithm: what settles in several speeds.
    let clocks: [&dyn Fn(f64) -> f64; 2] = [&|u| u, &log_time];
    let polynomials = clocks.iter().flat_map(|clock| (2..=DEGREES).map(move |degree| (clock, degree)));
    let polynomials = polynomials.map(|(clock, degree)| {
        let curves = (1..=degree).map(|d| course(count, |u| legendre(d, 2.0 * clock(u) - 1.0))).collect();
        merit(with(curves), degree as f64)
    });
    let smooth = kinked.chain(polynomials).fold(f64::NEG_INFINITY, f64::max);
    let exponent = (power >= smooth).then_some(free);
    let better_by = power.max(smooth) - held;
    let ruling = match drift[..] {
        [Cause::WarmUp] => rival(better_by)?,
        // That a course does as well as noise is what noise looks like.
        _ => rival(better_by).filter(|r| *r == Ruling::Refuted)?,
    };
    Some(Departure { ruling, of: Of::Time, exponent })
}

/// Legendre's polynomial of a degree: nearly orthogonal over the recording.
fn legendre(degree: usize, x: f64) -> f64 {
    let (mut before, mut now) = (1.0, x);
    for k in 1..degree {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
    }
    if degree == 0 { 1.0 } else { now }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::cosine;
    use crate::rng::{Philox, Stream};

    /// Noise whose cosine coefficients have the variance 1 + (knee/k)^exponent: the law to the
    /// letter.
    fn noise(count: usize, exponent: f64, knee: f64, member: u64) -> Vec<f64> {
        let mut rng = Philox::new(31, member, Stream::Host);
        let coefficients: Vec<f64> = (0..count)
            .map(|k| if k == 0 { 0.0 } else { rng.normal() * (1.0 + (knee / k as f64).powf(exponent)).sqrt() })
            .collect();
        cosine::invert(&coefficients)
    }

    fn ruling(values: &[f64], cause: Cause, law: Law) -> Option<Departure> {
        let channel = Channel::new("x", values, 1.0);
        let fitted = channel.fit(vec![Term { cause, addition: Addition::Law(law), searched: 0.0, column: None }]);
        in_spectrum(&channel, &fitted)
    }

    #[test]
    fn a_walk_keeps_its_exponent_and_one_and_a_half_is_refuted_or_open() {
        let (mut held, mut wrong, mut covered) = (0, 0, 0);
        for member in 0..20 {
            let walk = ruling(&noise(20_000, 2.0, 400.0, member), Cause::RandomWalk, Law::Walk);
            held += usize::from(walk.is_none());
            let near = ruling(&noise(20_000, 1.5, 400.0, 100 + member), Cause::RandomWalk, Law::Walk);
            wrong += usize::from(near.is_none());
            let exponent = near.and_then(|d| d.exponent);
            covered += usize::from(exponent.is_some_and(|e| e.ci95[0] <= 1.5 && 1.5 <= e.ci95[1]));
        }
        assert!(held >= 19, "{held} of 20 walks hold");
        // A 95 % interval reaches a quarter of the exponent further once in a while.
        assert!(wrong <= 1, "f^−1.5 taken for a walk {wrong} times of 20");
        // 95 % of 20 less two and a half standard errors.
        assert!(covered >= 17, "{covered} of 20 intervals hold the exponent");
    }

    #[test]
    fn a_drift_along_the_root_of_time_is_no_straight_line() {
        let drifting = |exponent: f64, member: u64| -> Option<Departure> {
            let mut rng = Philox::new(32, member, Stream::Host);
            let values: Vec<f64> =
                (0..4000).map(|n| 5.0 * (f64::from(n) / 4000.0).powf(exponent) + rng.normal()).collect();
            let channel = Channel::new("x", &values, 1.0);
            let ramp = course(4000, |u| u);
            in_time(&channel, &channel.fit(vec![term(Cause::RateRamp, vec![ramp])]))
        };
        for member in 0..10 {
            assert_eq!(drifting(1.0, member), None, "a straight line");
            let root = drifting(0.5, member).expect("no straight line");
            assert_eq!((root.ruling, root.of), (Ruling::Refuted, Of::Time));
            assert!(root.exponent.is_some_and(|e| (e.value - 0.5).abs() < 0.1), "{root:?}");
        }
    }
}
