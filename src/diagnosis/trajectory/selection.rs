//! Which candidates are named: forward by what held-out blocks gain, backward to drop what is not
//! needed any more.

use super::blocks::Linear;
use super::candidate::{LOWPASS, MOUNTING, TIME_OFFSET, Term};
use super::course::Case;
use super::judgement::{Question, Standing, judge};
use super::parameters::{self, FORCE_BIAS, FORCE_MATRIX, GYRO_BIAS, GYRO_MISALIGNMENT, OFFSET, TILT};
use crate::control::{Control, Stopped};
use crate::numerics::order;

/// Turns of adding and dropping before a search that goes in circles ends.
const ROUNDS: usize = 6;
/// Two models whose sums of squares differ by less, in units of the noise, are not told apart (Kass
/// & Raftery 1995).
const TIED: f64 = 6.0;
/// Fall of the held-out sum of squares that is needed for each parameter: what a criterion of
/// information asks.
const PER_PARAMETER: f64 = 2.0;

/// The outcome of a search.
#[derive(Debug, Clone)]
pub(super) struct Selection {
    /// Parameters of the base model.
    pub base: Vec<usize>,
    /// Parameters of which the motion shows noise alone.
    pub open: Vec<usize>,
    /// Named, strongest first, each judged against the model without it.
    pub named: Vec<Named>,
    /// The rest, judged as additions.
    pub others: Vec<Standing>,
}

/// A term of the chosen model.
#[derive(Debug, Clone)]
pub(super) struct Named {
    /// Its evidence, against the model without it.
    pub standing: Standing,
    /// Others that would do as well in its place.
    pub rivals: Vec<&'static Term>,
}

impl Selection {
    /// Returns whether a parameter is of a term that was judged.
    pub(super) fn judges(&self, p: usize) -> bool {
        let named = self.named.iter().map(|n| &n.standing);
        named.chain(&self.others).any(|standing| standing.term.parameters.contains(&p))
    }

    /// Half the width of the 95 % interval of a parameter of a term that was judged, SI.
    pub(super) fn half_width(&self, p: usize) -> Option<f64> {
        let mut judged = self.named.iter().map(|n| &n.standing).chain(&self.others);
        let standing = judged.find(|standing| standing.term.parameters.contains(&p))?;
        standing.half_widths.get(p - standing.term.parameters.start).copied()
    }

    /// Returns what was named by this id.
    pub(super) fn term(&self, id: &str) -> Option<&Named> {
        self.named.iter().find(|n| n.standing.term.id() == id)
    }

    /// Those parameters of a model of which the motion shows more than noise.
    pub(super) fn shown(&self, model: &[usize]) -> Vec<usize> {
        model.iter().copied().filter(|p| !self.open.contains(p)).collect()
    }

    /// The chosen model's parameters.
    pub(super) fn active(&self) -> Vec<usize> {
        self.base.iter().copied().chain(self.named.iter().flat_map(|n| n.standing.determined())).collect()
    }
}

/// Parameters of the base model.
///
/// A mounting that the search began with is a rough one, and free like a bias: what is left of it would
/// pass for misalignment.
pub(super) fn base(case: &Case<'_>) -> Vec<usize> {
    let halves = case.motion.halves;
    let by_position = FORCE_BIAS.chain(TILT.filter(|_| halves.attitude)).filter(|_| halves.position);
    let seat = parameters::MOUNTING.filter(|_| case.refines_mounting());
    GYRO_BIAS.chain(by_position).chain(FORCE_MATRIX.filter(|_| !halves.attitude)).chain(seat).collect()
}

/// A model and more terms.
pub(super) fn with(active: &[usize], terms: impl IntoIterator<Item = &'static Term>) -> Vec<usize> {
    active.iter().copied().chain(terms.into_iter().flat_map(|t| t.parameters.clone())).collect()
}

/// Holds what the reference allows to be told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Allowed<'a> {
    /// Parameters of the base model.
    pub base: &'a [usize],
    /// Parameters of which the motion shows noise alone.
    pub open: &'a [usize],
    /// Fraction of the held-out sum of squares that a name must account for.
    pub least_part: f64,
    /// By how much attitudes may err, root mean square: what is smaller in the accelerometer may be
    /// gravity along an attitude that errs.
    pub tilt_rad: f64,
    /// From one reading to the next, s.
    pub interval_s: f64,
}

/// Searches a library for the candidates that held-out blocks and the jackknife bear out.
///
/// # Errors
/// When stopped.
pub(super) fn select(
    linear: &Linear,
    library: &[&'static Term],
    allowed: &Allowed<'_>,
    control: &Control,
) -> Result<Selection, Stopped> {
    let base = allowed.base;
    let search = Search { linear, library, base, allowed };
    let mut named: Vec<Chosen> = Vec::new();
    let mut seen: Vec<Vec<usize>> = Vec::new();
    for _ in 0..ROUNDS {
        loop {
            control.go_on()?;
            let free = search.rest(&named);
            let judged = free.into_iter().map(|t| search.added(&named, t)).filter(Standing::counts);
            let worth = |s: &Standing| s.fall - PER_PARAMETER * s.determined().count() as f64;
            let Some(best) = judged.max_by(|a, b| worth(a).total_cmp(&worth(b))) else { break };
            named.push(Chosen::of(&best));
        }
        let before = named.len();
        loop {
            control.go_on()?;
            let kept: Vec<Standing> = named.iter().map(|chosen| search.within(&named, chosen.term)).collect();
            named = kept.iter().map(Chosen::of).collect();
            let dropped = kept.iter().filter(|s| !s.counts()).min_by(|a, b| a.fall.total_cmp(&b.fall));
            let Some(weakest) = dropped else { break };
            named.retain(|chosen| chosen.term != weakest.term);
        }
        let state = beyond(base, &named);
        if named.len() == before || seen.contains(&state) {
            break;
        }
        seen.push(state);
    }
    let mut standings: Vec<Standing> = named.iter().map(|chosen| search.within(&named, chosen.term)).collect();
    order::sort_by_key(&mut standings, |s| -s.fall);
    let mut others: Vec<Standing> = search.rest(&named).into_iter().map(|t| search.added(&named, t)).collect();
    order::sort_by_key(&mut others, |s| s.p_value);
    let named =
        standings.into_iter().map(|standing| Named { rivals: search.rivals(&named, &standing), standing }).collect();
    Ok(Selection { base: base.to_vec(), open: allowed.open.to_vec(), named, others })
}

/// A term of the model so far, with those of its parameters that the motion determines: the others would absorb what is
/// another term's.
#[derive(Debug, Clone)]
struct Chosen {
    term: &'static Term,
    parameters: Vec<usize>,
}

impl Chosen {
    fn of(standing: &Standing) -> Self {
        Self { term: standing.term, parameters: standing.determined().collect() }
    }
}

/// The chosen terms but for one.
fn without(chosen: &[Chosen], term: &Term) -> Vec<Chosen> {
    chosen.iter().filter(|chosen| chosen.term != term).cloned().collect()
}

/// A model and the terms chosen so far.
fn beyond(base: &[usize], chosen: &[Chosen]) -> Vec<usize> {
    base.iter().chain(chosen.iter().flat_map(|chosen| &chosen.parameters)).copied().collect()
}

struct Search<'a> {
    linear: &'a Linear,
    library: &'a [&'static Term],
    base: &'a [usize],
    allowed: &'a Allowed<'a>,
}

impl Search<'_> {
    /// Returns what may be added. Where the gyro's misalignment is free it says nothing of a
    /// mounting, and the accelerometer alone cannot tell a mounting from its own misalignment.
    fn rest(&self, named: &[Chosen]) -> Vec<&'static Term> {
        let misaligned = named.iter().any(|chosen| chosen.term.parameters == GYRO_MISALIGNMENT);
        let closed = |t: &Term| misaligned && t.id() == MOUNTING.id;
        self.library.iter().copied().filter(|t| named.iter().all(|chosen| chosen.term != *t) && !closed(t)).collect()
    }

    fn added(&self, named: &[Chosen], term: &'static Term) -> Standing {
        let smaller = beyond(self.base, named);
        let larger = with(&smaller, [term]);
        self.judged(&smaller, &larger, term, named.len() + 1)
    }

    fn within(&self, named: &[Chosen], term: &'static Term) -> Standing {
        let smaller = beyond(self.base, &without(named, term));
        let larger = with(&smaller, [term]);
        self.judged(&smaller, &larger, term, named.len())
    }

    /// Each of the library was tried as often as something was added.
    fn judged(&self, smaller: &[usize], larger: &[usize], term: &'static Term, looks: usize) -> Standing {
        let Allowed { open, tilt_rad, least_part, interval_s, .. } = *self.allowed;
        let shown = |active: &[usize]| active.iter().copied().filter(|p| !open.contains(p)).collect::<Vec<_>>();
        let (smaller, larger) = (&shown(smaller)[..], &shown(larger)[..]);
        let question = Question { linear: self.linear, smaller, larger, term, tilt_rad, least_part, interval_s };
        judge(&question, self.library.len() * looks)
    }

    /// Terms that fall as far in the place of a named one.
    fn rivals(&self, named: &[Chosen], standing: &Standing) -> Vec<&'static Term> {
        let without = without(named, standing.term);
        let fits = |t: &&'static Term| {
            let rival = self.added(&without, t);
            rival.plausible && rival.fall > standing.fall - TIED
        };
        let of_lag = self.lowpass_instead(named).filter(|_| standing.term.id() == TIME_OFFSET.id);
        self.rest(&without).into_iter().filter(|t| *t != standing.term && fits(t)).chain(of_lag).collect()
    }

    /// The low-pass, where one whose lag is the whole offset of the clocks is no worse than none: both have one
    /// parameter.
    fn lowpass_instead(&self, named: &[Chosen]) -> Option<&'static Term> {
        let term = self.rest(named).into_iter().find(|t| t.id() == LOWPASS.id)?;
        let active = with(&beyond(self.base, named), [term]);
        let solved = self.linear.solve(&active, |_| true);
        let place = active.iter().position(|p| *p == parameters::LOWPASS)?;
        let (square, variance) = (solved.point[parameters::LOWPASS], solved.covariance[(place, place)]);
        let lag_s = solved.point[OFFSET];
        let as_lowpass = (square - lag_s * lag_s).powi(2) / variance;
        (lag_s > 0.0 && as_lowpass < square * square / variance + TIED).then_some(term)
    }
}
