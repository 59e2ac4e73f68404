//! Decides whether a drift follows the law it was named for: the law's exponent is set free and has
//! its say.
//!
//! Laws of noise and drift have whole exponents: 1/f, 1/f², a bias along t. A drift of another
//! exponent, or one along a smooth course that is no noise at all, is described by a library law or
//! by a sum of them until a fit with a free exponent describes it better. Three things can come
//! out: the exponent lies near the law's, the law is refuted, or the recording cannot tell. Not for
//! channels that share their drift (`common`): that is a course by definition.

use super::block_means;
use super::candidate::row;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Fitted, Term};
use super::course::{EXPONENTS, course, is_course, smooth};
use super::laws::{SLOW, slow_laws};
use super::profile::{Profiled, profile};
use super::spectrum::{self, Bin, Law, Part};
use super::standing::{ALPHA, CLOSE, CLOSE_TO_NOISE, probability};

/// An exponent nearer to a law's than this part of it makes no difference that matters: over the
/// three decades of one log f^−0.1 changes the power by a factor of two in all, so that a law
/// fitted in the middle errs by a fifth in size at either end.
const NEAR: f64 = 0.1;
/// Twice the log-likelihood by which a free exponent leaves the 95 % interval of a whole one, so
/// that this one is in doubt.
const DOUBTED: f64 = 3.84;
/// Twice the log-likelihood that a free exponent must gain over a whole one to refute it: one in a
/// thousand by chance.
const REFUTED: f64 = 10.8;
/// Exponents of a spectrum that are tried. A smooth course has a spectrum steeper than any noise's.
pub(super) const SPECTRAL: [f64; 2] = [0.2, 4.4];
/// States how many, before the best is refined.
pub(super) const POINTS: usize = 22;
/// Values that a drift in time is judged on, at most.
const MOST: usize = 2048;

/// Holds what a free exponent says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Departure {
    pub(super) ruling: Ruling,
    pub(super) of: Of,
    /// The free exponent; `None` where a smooth course of no such form does best.
    pub(super) exponent: Option<Profiled>,
    /// By how much it is better than what was chosen, or where channels share it, than one memory
    /// or one whole law for all: twice the log-likelihood less what the numbers cost.
    pub(super) better_by: f64,
    /// States whether it stands for the straight or settling courses too, and for the noise.
    pub(super) takes: Takes,
}

/// Holds what another description stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Takes {
    pub(super) courses: bool,
    pub(super) noise: bool,
    /// Sines of a few cycles in the recording.
    pub(super) slow_lines: bool,
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
    /// Of no course in time but of the environment column at this place.
    Column(usize),
    /// Of nothing: the bias may have jumped once, at this sample.
    Jump(usize),
}

impl Departure {
    /// One jump that describes a channel as well as its drift does.
    pub(super) fn jump(at: usize) -> Self {
        let takes = Takes { courses: true, noise: true, slow_lines: true };
        Self { ruling: Ruling::Open, of: Of::Jump(at), exponent: None, better_by: 0.0, takes }
    }

    /// Returns whether it speaks of this cause.
    pub(super) fn concerns(&self, cause: Cause) -> bool {
        self.takes.noise && SLOW.contains(&cause)
            || self.takes.courses && is_course(cause)
            || self.takes.slow_lines && cause == Cause::Sinusoid
    }
}

/// Returns what free exponents say of a channel's drift; `None` where its laws hold or it has none.
/// `correction` as in `standing`.
pub(super) fn judge(channel: &Channel, chosen: &Fitted, correction: f64) -> Option<Departure> {
    let both = [in_time(channel, chosen), in_spectrum(channel, chosen, correction)];
    let refuted = both.iter().flatten().find(|d| d.ruling == Ruling::Refuted).copied();
    let [time, spectrum] = both;
    refuted.or(spectrum).or(time)
}

/// Returns whether a channel's drift follows a power of time better than the laws that it was named
/// for.
pub(super) fn is_power_of_time(channel: &Channel, chosen: &Fitted) -> bool {
    in_time(channel, chosen).is_some_and(|d| d.ruling == Ruling::Refuted && d.exponent.is_some())
}

/// Returns what is said of one whole exponent: an interval that is merely wide speaks against no
/// law. Which of the whole ones fits is settled before (`laws`).
pub(super) fn whole(law: f64, free: Profiled, gain: f64) -> Option<Ruling> {
    let is_material = (free.value - law).abs() > NEAR * law;
    if is_material && gain > REFUTED {
        Some(Ruling::Refuted)
    } else if is_material && gain > DOUBTED {
        Some(Ruling::Open)
    } else {
        None
    }
}

/// Returns what is said of another description, by how much better it is.
pub(super) fn rival(better_by: f64) -> Option<Ruling> {
    rival_of(better_by, CLOSE)
}

/// The same where it must be better by this much to refute what was chosen.
fn rival_of(better_by: f64, refuting: f64) -> Option<Ruling> {
    if better_by > refuting {
        Some(Ruling::Refuted)
    } else if better_by > -CLOSE {
        Some(Ruling::Open)
    } else {
        None
    }
}

/// The slow laws of noise against one of free exponent, on the spectrum that the model's curves
/// leave.
fn in_spectrum(channel: &Channel, chosen: &Fitted, correction: f64) -> Option<Departure> {
    let slow = slow_laws(chosen);
    if slow.is_empty() {
        return None;
    }
    let (free, best) = free_exponent(channel, chosen, &chosen.bins);
    let gain = 2.0 * (best - chosen.log_likelihood());
    let of = |ruling, free, better_by, courses| {
        let takes = Takes { courses, noise: true, slow_lines: false };
        Some(Departure { ruling, of: Of::Spectrum, exponent: Some(free), better_by, takes })
    };
    // A free exponent has one number more than a whole one.
    let of_whole = |law: f64| of(whole(law, free, gain)?, free, gain - 2.0, false);
    match slow[..] {
        [Cause::FlickerNoise] => of_whole(1.0),
        [Cause::RandomWalk] => of_whole(2.0),
        // A memory or a sum has as many numbers as a free exponent, or more.
        _ => {
            let numbers = |of: &dyn Fn(Cause) -> bool| -> f64 {
                chosen.terms.iter().filter(|t| of(t.cause)).map(|t| row(t.cause).numbers).sum()
            };
            let spared = 2.0 * (numbers(&|c| SLOW.contains(&c)) - 2.0);
            let kept = (gain + spared, free, false);
            // A course that was taken from the lowest frequencies before the law was settled bends
            // the law's exponent: the free one may have them back.
            let taken = chosen.terms.iter().any(|t| is_course(t.cause)).then(|| {
                let own = |t: &&Term| !SLOW.contains(&t.cause) && !is_course(t.cause);
                let law = |(cause, law)| Term { cause, addition: Addition::Law(law), searched: 0.0, column: None };
                let noise = [(Cause::FlickerNoise, Law::Flicker), (Cause::RandomWalk, Law::Walk)].map(law);
                let without = channel.fit(chosen.terms.iter().filter(own).cloned().chain(noise).collect());
                let (free, best) = free_exponent(channel, chosen, &without.bins);
                let gain = 2.0 * (best - chosen.log_likelihood());
                (gain + spared + 2.0 * numbers(&is_course), free, true)
            });
            // A course that gains no more than chance next to a law of free exponent is not there.
            let course = chosen.terms.iter().find(|t| is_course(t.cause));
            let needed = |t: &(f64, Profiled, bool)| {
                let gain = kept.0 - t.0 + 2.0 * numbers(&is_course);
                course.is_some_and(|c| probability(c.cause, gain, channel) * correction < ALPHA)
            };
            let (better_by, free, takes_courses) = taken.filter(|t| !needed(t)).unwrap_or(kept);
            // Two laws side by side follow any power between theirs for decades: one law in their
            // place is in doubt only where they lead it by more than chance.
            let is_sum = slow.len() > 1 && better_by > -REFUTED;
            let ruling = rival(better_by).or(is_sum.then_some(Ruling::Open))?;
            of(ruling, free, better_by, takes_courses)
        }
    }
}

/// The best exponent of one law in place of all slow ones on this spectrum, and its log-likelihood.
fn free_exponent(channel: &Channel, chosen: &Fitted, bins: &[Bin]) -> (Profiled, f64) {
    profile(SPECTRAL, POINTS, |exponent: f64| in_place(channel, chosen, bins, Law::Power(exponent)))
}

/// Log-likelihood of one law in place of all slow ones on this spectrum.
pub(super) fn in_place(channel: &Channel, chosen: &Fitted, bins: &[Bin], law: Law) -> f64 {
    let kept = chosen.terms.iter().filter(|t| !SLOW.contains(&t.cause)).filter_map(|t| match t.addition {
        Addition::Law(law) => Some(law),
        Addition::Curves(_) => None,
    });
    let all: Vec<Law> = std::iter::once(Law::White).chain(kept).chain([law]).collect();
    spectrum::fit(bins, &all, &channel.promised, Part::All).log_likelihood
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
    let own = block_means::channel(channel, &channel.values, together);
    let count = own.values.len();
    let coarse =
        |terms: Vec<&Term>| terms.into_iter().filter_map(|t| block_means::term(t, together)).collect::<Vec<Term>>();
    let rest = coarse(chosen.terms.iter().filter(|t| !drifts(t)).collect());
    let before = own.fit(coarse(chosen.terms.iter().collect()));
    // What a number costs where it is fitted to this many values (Schwarz 1978): a curve absorbs
    // what it can of any noise.
    let penalty = (count as f64).ln();
    let with = |curves: Vec<Curve>| -> f64 {
        own.fit(rest.iter().cloned().chain([term(Cause::RateRamp, curves)]).collect()).log_likelihood()
    };
    let score = |log_likelihood: f64, numbers: f64| 2.0 * log_likelihood - penalty * numbers;
    let numbers: f64 = drift.iter().map(|c| row(*c).numbers).sum();
    let held = score(before.log_likelihood(), numbers);
    let (free, best) = profile(EXPONENTS.map(f64::ln), 12, |p: f64| with(vec![course(count, |u| u.powf(p.exp()))]));
    let free = free.map(f64::exp);
    if drift[..] == [Cause::RateRamp] {
        let ruling = whole(1.0, free, 2.0 * (best - before.log_likelihood()))?;
        let better_by = 2.0 * (best - before.log_likelihood()) - penalty;
        let takes = Takes { courses: true, noise: true, slow_lines: false };
        return Some(Departure { ruling, of: Of::Time, exponent: Some(free), better_by, takes });
    }
    let power = score(best, 2.0);
    let of_all = |with: &dyn Fn(Vec<Curve>) -> f64, more: f64| {
        smooth(count).map(|(curves, numbers)| score(with(curves), numbers + more)).fold(f64::NEG_INFINITY, f64::max)
    };
    let smooth = of_all(&with, 0.0);
    let departs =
        |ruling, exponent, better_by, takes| Some(Departure { ruling, of: Of::Time, exponent, better_by, takes });
    let has_noise = drift.iter().any(|cause| SLOW.contains(cause));
    let better_by = power.max(smooth) - held;
    let is_noise = drift.iter().all(|cause| SLOW.contains(cause));
    match rival_of(better_by, if is_noise { CLOSE_TO_NOISE } else { CLOSE }) {
        Some(ruling) if ruling == Ruling::Refuted || has_noise || drift[..] == [Cause::WarmUp] => {
            let exponent = (power >= smooth).then_some(free);
            return departs(ruling, exponent, better_by, Takes { courses: true, noise: true, slow_lines: false });
        }
        _ => {}
    }
    // A slow cause that is no noise, next to a course that the library names.
    let courses: Vec<&Term> = chosen.terms.iter().filter(|t| is_course(t.cause)).collect();
    if !has_noise || courses.is_empty() {
        return None;
    }
    let more: f64 = courses.iter().map(|t| row(t.cause).numbers).sum();
    let kept: Vec<Term> = rest.iter().cloned().chain(coarse(courses)).collect();
    let beside = |curves: Vec<Curve>| -> f64 {
        own.fit(kept.iter().cloned().chain([term(Cause::RateRamp, curves)]).collect()).log_likelihood()
    };
    let better_by = of_all(&beside, more) - held;
    departs(rival(better_by)?, None, better_by, Takes { courses: false, noise: true, slow_lines: false })
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
        in_spectrum(&channel, &fitted, 9.0)
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

    // Between f^−1 and f^−2 two laws side by side follow any power; where both rule over a decade
    // and more of their own, no power follows them: by Whittle's likelihood of the mean spectrum
    // the sum leads by 59, with a standard deviation of 2√59 = 15, so that one in a thousand leads
    // by less than 10.8.
    #[test]
    fn two_laws_stand_where_they_bend_the_spectrum_and_not_in_the_place_of_one_power() {
        let ruled = |bent: bool, member: u64| {
            let mut rng = Philox::new(33, member, Stream::Host);
            let of_order = |k: f64| if bent { 8000.0 / k + (1000.0 / k).powi(2) } else { (1500.0 / k).powf(1.4) };
            let drawn = |k: usize| if k == 0 { 0.0 } else { rng.normal() * (1.0 + of_order(k as f64)).sqrt() };
            let channel = Channel::new("x", &cosine::invert(&(0..20_000).map(drawn).collect::<Vec<f64>>()), 1.0);
            let laws = [(Cause::FlickerNoise, Law::Flicker), (Cause::RandomWalk, Law::Walk)];
            let term = |(cause, law)| Term { cause, addition: Addition::Law(law), searched: 0.0, column: None };
            in_spectrum(&channel, &channel.fit(laws.map(term).to_vec()), 9.0).is_some()
        };
        let doubted = |bent: bool| (0..20).filter(|member| ruled(bent, *member)).count();
        assert!(doubted(true) <= 1, "a bent spectrum is doubted {} times of 20", doubted(true));
        assert_eq!(doubted(false), 20, "f^−1.4 is taken for two laws");
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

    // A slow sine 0.4 of the noise high is all that moves next to the warm-up: no walk by itself. A
    // walk that ends at some five standard deviations has a hundred coefficients above the noise,
    // which no course of a few numbers follows.
    #[test]
    fn a_slow_cause_next_to_a_warm_up_is_doubted_as_a_walk_and_a_walk_is_not() {
        let doubted = |is_walk: bool, member: u64| {
            let mut rng = Philox::new(34, member, Stream::Host);
            let mut state = 0.0;
            let values: Vec<f64> = (0..4000)
                .map(|n| {
                    let u = f64::from(n) / 4000.0;
                    state += if is_walk { 0.08 * rng.normal() } else { 0.0 };
                    let slow = if is_walk { state } else { 0.4 * (9.0 * u).sin() };
                    5.0 * (1.0 - (-10.0 * u).exp()) + slow + rng.normal()
                })
                .collect();
            let channel = Channel::new("x", &values, 1.0);
            let warm = term(Cause::WarmUp, vec![course(4000, |u| 1.0 - (-10.0 * u).exp())]);
            let law = Addition::Law(Law::Walk);
            let walk = Term { cause: Cause::RandomWalk, addition: law, searched: 0.0, column: None };
            in_time(&channel, &channel.fit(vec![warm, walk])).is_some_and(|d| d.concerns(Cause::RandomWalk))
        };
        let count = |is_walk: bool| (0..10).filter(|member| doubted(is_walk, *member)).count();
        assert!(count(false) >= 8, "{} of 10 slow sines are doubted", count(false));
        assert_eq!(count(true), 0, "control: a walk is doubted");
    }
}
