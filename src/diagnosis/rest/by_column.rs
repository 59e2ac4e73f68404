//! A drift that a flexible function of an environment column describes as well is no noise: it
//! depends on that column in a way that no law here states.
//!
//! The library's law bends by a square and a cube. What bends otherwise, at a kink or in an S,
//! leaves a slow rest, which a memory, a walk or a slow sine absorbs. So these are held against
//! kinked lines and higher polynomials of the column, as `departure` holds them against the same of
//! time. Not for a column that is itself smooth in time: `in_time` has set it aside.

use super::block_means;
use super::candidate::row;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Environment, Fitted, Term};
use super::column::Column;
use super::course::is_course;
use super::decimated::{self, PENALTY};
use super::departure::{self, Departure, Of, Ruling, Takes, rival};
use super::followed::Delay;
use super::laws::SLOW;
use super::profile::peak;
use super::slow::is_slow;
use crate::numerics::legendre::legendre;

/// Highest degree of a polynomial of the column; beyond, the bends of one recording's noise.
const DEGREES: usize = 8;
/// Places at which a line is tried with a kink, between the ends of the column, before the best is
/// refined.
const KINKS: usize = 15;
/// Pieces of a line that is broken at places as far from one another: for what bends at once.
const PIECES: [usize; 3] = [4, 8, 12];

/// A drift that a column may stand for.
pub(super) struct Asked<'a> {
    pub(super) channel: &'a Channel,
    pub(super) chosen: &'a Fitted,
    pub(super) environment: &'a Environment,
}

/// Returns whether a term may be what a column does otherwise than by its law.
fn may_be_bent(term: &Term, channel: &Channel) -> bool {
    SLOW.contains(&term.cause) || is_course(term.cause) || term.cause == Cause::Sinusoid && is_slow(term, channel)
}

impl Asked<'_> {
    /// Returns what a function of a column says where it does better than the drift that was named,
    /// else what free exponents and smooth courses say. `correction` as in `standing`.
    pub(super) fn judge_with_time(&self, correction: f64) -> Option<Departure> {
        let by_column = self.judge();
        let ruled = |ruling| by_column.filter(|d| d.ruling == ruling);
        let otherwise = || departure::judge(self.channel, self.chosen, correction);
        ruled(Ruling::Refuted).or_else(otherwise).or(ruled(Ruling::Open))
    }

    /// Returns the column, of all, whose function does at least as well as the drift that was
    /// named; `None` where none does.
    pub(super) fn judge(&self) -> Option<Departure> {
        let drifts = self.chosen.terms.iter().filter(|t| may_be_bent(t, self.channel));
        let drift: Vec<&Term> = drifts.collect();
        if !drift.iter().any(|t| !is_course(t.cause)) {
            return None;
        }
        // Of several sines the fast ones are no function of a slow column.
        let sines = |t: &&Term| t.cause == Cause::Sinusoid;
        let slow_lines = drift.iter().copied().filter(sines).count() == self.chosen.terms.iter().filter(sines).count();
        let together = decimated::together(self.channel.values.len());
        let own = block_means::channel(self.channel, &self.channel.values, together);
        let on_means = |t: &Term| block_means::term(t, together);
        let held = own.fit(self.chosen.terms.iter().filter_map(on_means).collect());
        let held = 2.0 * held.log_likelihood() - PENALTY * numbers(&self.chosen.terms);
        let of_column = |(place, (name, curve)): (usize, &(String, Curve))| {
            let column = Column::of(name, curve)?;
            let kept: Vec<Term> = self
                .chosen
                .terms
                .iter()
                .filter(|t| !may_be_bent(t, self.channel) && !t.follows(name))
                .cloned()
                .collect();
            let rest = Rest { channel: &own, terms: kept.iter().filter_map(on_means).collect(), cost: numbers(&kept) };
            let followed = self.chosen.terms.iter().find_map(|t| t.column.as_ref().filter(|f| f.column == *name));
            let delay = followed.map_or(Delay::None, |f| f.delay.in_means(together));
            let better_by = rest.best(&delay.of(&column.means)) - delay.numbers() * PENALTY - held;
            let takes = Takes { courses: true, noise: true, slow_lines };
            let ruling = rival(better_by)?;
            Some(Departure { ruling, of: Of::Column(place), exponent: None, better_by, takes })
        };
        let found = self.environment.iter().enumerate().filter_map(of_column);
        found.max_by(|a, b| a.better_by.total_cmp(&b.better_by))
    }
}

/// Numbers of a model, those of curves of a column included.
fn numbers(terms: &[Term]) -> f64 {
    let of = |t: &Term| match (&t.addition, &t.column) {
        (Addition::Curves(curves), Some(followed)) => curves.len() as f64 + followed.delay.numbers(),
        _ => row(t.cause).numbers,
    };
    terms.iter().map(of).sum()
}

/// A channel on means, with the terms that stay next to a function of a column, and their numbers.
struct Rest<'a> {
    channel: &'a Channel,
    terms: Vec<Term>,
    cost: f64,
}

impl Rest<'_> {
    /// Minus Schwarz's criterion next to the function of these values that it likes best: larger is
    /// better.
    fn best(&self, values: &[f64]) -> f64 {
        let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
        let parts: Vec<f64> = values.iter().map(|v| (v - low) / (high - low).max(f64::MIN_POSITIVE)).collect();
        let curve = |at: &dyn Fn(f64) -> f64| Curve::new(parts.iter().map(|u| at(*u)).collect());
        let bent = |place: f64| vec![curve(&|u| u), curve(&|u| (u - place).max(0.0))];
        let reach = 1.0 / (KINKS + 1) as f64;
        let (_, kinked) = peak([reach, 1.0 - reach], KINKS, |place| self.log_likelihood(bent(place)));
        let polynomial = |degree: usize| {
            let curves = (1..=degree).map(|d| curve(&|u| legendre(d, 2.0 * u - 1.0))).collect();
            self.score(self.log_likelihood(curves), degree as f64)
        };
        let broken = |pieces: &usize| {
            let width = 1.0 / *pieces as f64;
            let curves = (0..*pieces).map(|k| curve(&|u| (u - k as f64 * width).clamp(0.0, width))).collect();
            self.score(self.log_likelihood(curves), *pieces as f64)
        };
        let all = (4..=DEGREES).map(polynomial).chain(PIECES.iter().map(broken));
        all.fold(self.score(kinked, 3.0), f64::max)
    }

    fn log_likelihood(&self, curves: Vec<Curve>) -> f64 {
        let addition = Addition::Curves(curves);
        let function = Term { cause: Cause::TemperatureSensitivity, addition, searched: 0.0, column: None };
        self.channel.fit(self.terms.iter().cloned().chain([function]).collect()).log_likelihood()
    }

    fn score(&self, log_likelihood: f64, numbers: f64) -> f64 {
        2.0 * log_likelihood - PENALTY * (self.cost + numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::spectrum::Law;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 12_000;

    /// A temperature that goes up and down and up.
    fn day(n: usize) -> f64 {
        25.0 + 10.0 * (14.0 * n as f64 / COUNT as f64).sin()
    }

    fn ruling(at: &dyn Fn(usize) -> f64, member: u64) -> Option<Ruling> {
        let mut rng = Philox::new(62, member, Stream::Host);
        let values: Vec<f64> = (0..COUNT).map(|n| at(n) + rng.normal()).collect();
        let channel = Channel::new("x", &values, 1.0);
        let curve = Curve::new((0..COUNT).map(day).collect());
        let column = Column::of("t", &curve)?;
        let memory = Addition::Law(Law::Markov(500.0));
        let drift = Term { cause: Cause::GaussMarkov, addition: memory, searched: 500.0, column: None };
        let chosen = channel.fit(vec![column.term(Delay::None, &[1, 2, 3]), drift]);
        let environment = [("t".to_owned(), curve.clone())];
        Asked { channel: &channel, chosen: &chosen, environment: &environment }.judge().map(|d| d.ruling)
    }

    // Three bends that no cube follows, each some standard deviations of the noise high, and as
    // controls a memory and a walk next to a cube of the same column.
    #[test]
    fn what_bends_otherwise_than_by_a_cube_is_no_memory_and_a_memory_is_one() {
        for member in 0..6 {
            let kink = |n: usize| 0.3 * (day(n) - 27.0).max(0.0);
            let s = |n: usize| (0.4 * (day(n) - 24.0)).tanh();
            let fourth = |n: usize| 1.5 * ((day(n) - 25.0) / 10.0).powi(4);
            for (name, at) in [("kink", &kink as &dyn Fn(usize) -> f64), ("s", &s), ("fourth power", &fourth)] {
                assert_eq!(ruling(at, member), Some(Ruling::Refuted), "{name} {member}");
            }
            let mut rng = Philox::new(63, member, Stream::Host);
            let keep = (-1.0f64 / 500.0).exp();
            let (mut state, mut sum) = (rng.normal(), 0.0);
            let (memory, walk): (Vec<f64>, Vec<f64>) = (0..COUNT)
                .map(|_| {
                    state = keep * state + (1.0 - keep * keep).sqrt() * rng.normal();
                    sum += 0.03 * rng.normal();
                    (state, sum)
                })
                .unzip();
            for (name, drift) in [("memory", memory), ("walk", walk)] {
                let at = |n: usize| 0.001 * (day(n) - 25.0).powi(3) + drift[n];
                assert_eq!(ruling(&at, member), None, "control: {name} {member}");
            }
        }
    }
}
