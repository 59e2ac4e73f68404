//! Which candidates are named: from what nearly every unit has, forward by evidence and backward to
//! drop what is not needed, judged on poses that were held out.

use super::calibration::Point;
use super::candidate::{Role, Term, terms};
use super::fit::{AS_MEASURED, Fit};
use super::group::Group;
use super::imu::Observed;
use super::residual::Residual;
use super::standing::{Folds, Standing, criterion, held_out_gain, judge};
use super::start;
use super::wander;
use crate::control::{Control, Stopped};
use crate::numerics::order;
use crate::sensor::Sense;

/// Interleaved folds of poses where the model states no split.
const FOLDS: usize = 5;
/// Two models closer than this in the Bayesian information criterion are not told apart (Kass &
/// Raftery 1995: "positive").
const TIED: f64 = 6.0;

pub(crate) fn interleaved(poses: usize) -> Folds {
    (0..poses).map(|k| Some(k % FOLDS)).collect()
}

/// The outcome of the search.
#[derive(Debug, Clone)]
pub(crate) struct Selection {
    /// The base model, refitted alone.
    pub base: Fit,
    /// Base and named terms together.
    pub chosen: Fit,
    /// Named, strongest first; each judged against the chosen model without it.
    pub named: Vec<Named>,
    /// The rest, judged as an addition to the chosen model.
    pub others: Vec<Standing>,
    /// Sensors whose offsets drift slowly, fitted with the chosen model.
    pub drifting: Vec<Drifting>,
}

/// A sensor whose offsets drift slowly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Drifting {
    /// The sensor.
    pub sensor: Sense,
    /// States whether it is named, not only told.
    pub is_named: bool,
}

impl Selection {
    /// The terms named, strongest first.
    pub(super) fn named_terms(&self) -> impl Iterator<Item = &'static Term> {
        self.named.iter().map(|n| n.standing.term)
    }
}

/// A term of the chosen model.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub standing: Standing,
    /// Others that would fit nearly as well in its place.
    pub rivals: Vec<&'static Term>,
}

/// Searches the library.
///
/// # Errors
/// When stopped.
pub(crate) fn select(
    observed: &Observed<'_>,
    guess: &Point,
    folds: &Folds,
    control: &Control,
) -> Result<Selection, Stopped> {
    let with_gyro = observed.imu.gyro.is_some();
    let library = terms(with_gyro, observed.imu.covariate.is_some());
    let base = Fit::new(observed, guess, &start::base(with_gyro), &AS_MEASURED);
    let mut search = Search { observed, folds, control, tried: library.len(), library, banned: Vec::new(), base };
    // Scale and misalignment hide each other: the search begins with all that nearly every unit
    // has, and drops what is not needed. Where poses do not determine all of it, it begins with
    // nothing.
    let usual: Vec<&'static Term> = search.library.iter().copied().filter(|t| t.role == Role::EveryUnit).collect();
    let full = search.fitted(&search.base, &usual);
    let mut state = if full.determined { State { named: usual, model: full } } else { search.bare() };
    loop {
        state = search.settled(state)?;
        let doubtful = search.doubtful(&state);
        if doubtful.is_empty() {
            break;
        }
        // What helps but leaves the residual it is judged by above the noise is not what was left
        // out: it is withdrawn, and the search goes on without it.
        search.banned.extend(&doubtful);
        state.named.retain(|t| !doubtful.contains(t));
        state.model = search.fitted(&state.model, &state.named);
    }
    search.concluded(state)
}

/// A model on the way.
struct State {
    named: Vec<&'static Term>,
    model: Fit,
}

/// Holds what a search has at hand.
struct Search<'a> {
    observed: &'a Observed<'a>,
    folds: &'a Folds,
    control: &'a Control,
    library: Vec<&'static Term>,
    tried: usize,
    banned: Vec<&'static Term>,
    base: Fit,
}

/// Turns of adding and dropping before a search that goes in circles ends.
const ROUNDS: usize = 6;
/// Fraction of the excess over the noise that scale and misalignment must remove from poses held
/// out to be kept although something else is left (lower end of the 95 % interval): less may be the
/// work of stand-ins.
const CARRIES: f64 = 0.5;

impl Search<'_> {
    fn bare(&self) -> State {
        State { named: Vec::new(), model: self.base.clone() }
    }

    /// Base and terms from the point of another model, or from that of the base where no minimum lies near it, each
    /// group weighed by its own misfit.
    fn fitted(&self, from: &Fit, named: &[&'static Term]) -> Fit {
        let active: Vec<usize> =
            self.base.active.iter().copied().chain(named.iter().flat_map(|t| t.active())).collect();
        let mut start = from.point;
        from.active.iter().filter(|p| !active.contains(p)).for_each(|p| start[*p] = 0.0);
        let fit = Fit::balanced(self.observed, &start, &active);
        if fit.determined { fit } else { Fit::balanced(self.observed, &self.base.point, &active) }
    }

    /// Adds what counts and drops what does not, until nothing is dropped. Adding comes first:
    /// next to a strong effect that is not in the model yet, what belongs there seems not to count.
    fn settled(&self, mut state: State) -> Result<State, Stopped> {
        let mut seen: Vec<Vec<&'static Term>> = Vec::new();
        for _ in 0..ROUNDS {
            loop {
                self.control.go_on()?;
                let free = self.rest(&state).filter(|t| !self.banned.contains(t));
                let judged = free.map(|t| self.with(&state.model, t)).filter(Standing::counts);
                let Some(best) = judged.max_by(|a, b| a.criterion.total_cmp(&b.criterion)) else { break };
                state.named.push(best.term);
                state.model = self.fitted(&state.model, &state.named);
            }
            let before = state.named.len();
            loop {
                self.control.go_on()?;
                let kept = state.named.iter().map(|t| self.within(&state.model, t));
                let weakest = kept.filter(|s| !s.counts()).min_by(|a, b| a.criterion.total_cmp(&b.criterion));
                let Some(weakest) = weakest else { break };
                state.named.retain(|t| *t != weakest.term);
                state.model = self.fitted(&state.model, &state.named);
            }
            if state.named.len() == before || seen.contains(&state.named) {
                break;
            }
            seen.push(state.named.clone());
        }
        Ok(state)
    }

    /// Named terms judged by a residual that stays above its noise, but for scale and misalignment
    /// that carry most of it.
    fn doubtful(&self, state: &State) -> Vec<&'static Term> {
        let above = Residual::of(&state.model).above;
        let doubtful = |group: Group| {
            let own: Vec<&'static Term> =
                state.named.iter().copied().filter(|t| t.judged == group && t.role != Role::Finding).collect();
            if own.is_empty() {
                return own;
            }
            // What only some sensors have needs more than that: a law that nobody knows often looks
            // like a little of it.
            let (usual, rare): (Vec<&'static Term>, Vec<_>) = own.into_iter().partition(|t| t.role == Role::EveryUnit);
            if !rare.is_empty() {
                return rare;
            }
            let rest: Vec<&'static Term> = state.named.iter().copied().filter(|t| !usual.contains(t)).collect();
            let smaller = self.fitted(&state.model, &rest);
            let (_, ci95) = held_out_gain(&smaller, &state.model, group, self.folds);
            if ci95[0] > CARRIES { Vec::new() } else { usual }
        };
        above.iter().flat_map(|(group, _)| doubtful(*group)).collect()
    }

    fn concluded(self, state: State) -> Result<Selection, Stopped> {
        let model = &state.model;
        let mut kept: Vec<Standing> = state.named.iter().map(|t| self.within(model, t)).collect();
        order::sort_by_key(&mut kept, |s| -s.criterion);
        let (findings, kept): (Vec<Standing>, Vec<Standing>) =
            kept.into_iter().partition(|s| s.term.role == Role::Finding);
        let rest = self.rest(&state).filter(|t| t.role != Role::Finding);
        let mut others: Vec<Standing> =
            rest.map(|t| Standing { withdrawn: self.banned.contains(&t), ..self.with(model, t) }).collect();
        order::sort_by_key(&mut others, |s| s.p_value);
        let mut named = Vec::new();
        for standing in kept {
            self.control.go_on()?;
            let smaller = self.without(model, standing.term);
            named.push(Named { rivals: self.rivals(model, &smaller, standing.term.sensor, &others), standing });
        }
        let mut drifting = Vec::new();
        for sensor in [Sense::Accelerometer, Sense::Gyro] {
            let own: Vec<&'static Term> = findings.iter().map(|s| s.term).filter(|t| t.sensor == sensor).collect();
            let Some(first) = own.first() else { continue };
            let drift = self.drift(&state, &own, first, &others);
            drifting.push(Drifting { sensor, is_named: drift.is_some() });
            named.extend(drift);
        }
        order::sort_by_key(&mut named, |n| -n.standing.criterion);
        Ok(Selection { base: self.base, chosen: state.model, named, others, drifting })
    }

    /// The drift of one sensor's offsets as a whole, where it moves the poses by more than 1/f
    /// noise may and leaves no more than noise.
    fn drift(&self, state: &State, own: &[&'static Term], first: &'static Term, others: &[Standing]) -> Option<Named> {
        let model = &state.model;
        let rest: Vec<&'static Term> = state.named.iter().copied().filter(|t| !own.contains(t)).collect();
        let without = self.fitted(model, &rest);
        let group = first.judged;
        let described = Residual::of(model).above.iter().all(|a| a.0 != group);
        if without.reduced(group) < wander::MOST || !described {
            return None;
        }
        let active = without.active.clone();
        let smaller = Fit::new(self.observed, &without.point, &active, &model.inflation);
        let standing = Some(judge(&smaller, model, first, self.folds, self.tried)).filter(Standing::counts)?;
        Some(Named { rivals: self.rivals(model, &smaller, first.sensor, others), standing })
    }

    /// Returns what is not in a model.
    fn rest<'s>(&'s self, state: &'s State) -> impl Iterator<Item = &'static Term> + 's {
        self.library.iter().copied().filter(|t| !state.named.contains(t))
    }

    /// Judges a term as an addition to `model`.
    fn with(&self, model: &Fit, term: &'static Term) -> Standing {
        let active: Vec<usize> = model.active.iter().copied().chain(term.active()).collect();
        let larger = Fit::new(self.observed, &model.point, &active, &model.inflation);
        judge(model, &larger, term, self.folds, self.tried)
    }

    /// Judges a named term against the model without it.
    fn within(&self, model: &Fit, term: &'static Term) -> Standing {
        judge(&self.without(model, term), model, term, self.folds, self.tried)
    }

    fn without(&self, model: &Fit, term: &Term) -> Fit {
        let active: Vec<usize> = model.active.iter().copied().filter(|p| term.active().all(|t| t != *p)).collect();
        let mut start = model.point;
        term.active().for_each(|p| start[p] = 0.0);
        Fit::new(self.observed, &start, &active, &model.inflation)
    }

    /// Terms of a sensor that would do nearly as well in the place of what a smaller model is
    /// without.
    fn rivals(&self, model: &Fit, smaller: &Fit, sensor: Sense, others: &[Standing]) -> Vec<&'static Term> {
        let mine = criterion(model);
        others
            .iter()
            .filter(|o| o.term.sensor == sensor && o.plausible)
            .filter(|o| {
                let active: Vec<usize> = smaller.active.iter().copied().chain(o.term.active()).collect();
                criterion(&Fit::new(self.observed, &smaller.point, &active, &model.inflation)) - mine < TIED
            })
            .map(|o| o.term)
            .collect()
    }
}
