//! Laws whose form has an exponent, which the search defers: a spring and a damping of one power, a drift
//! along one of time; with those of `own_sharpness`. Next to the stated law each would fit whatever departs from it a
//! little; it is tried only where a law that was chosen departs from its form, and takes its place
//! only where the data determine the exponent: where its own free form gains nothing over it, and no
//! other departure of one number does as well.

use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::interval;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::driven::simulation::structure::ModelStructure;
use crate::gate::Gate;
use crate::parallel;
use crate::physics::bias_drift::{BiasDrift, Course};
use crate::physics::free_form::{Extent, FreeForm, Freed};
use crate::physics::law::Noise;
use crate::physics::library::Term;
use crate::physics::power::Exponent;
use crate::physics::power_law_damping::PowerLawDamping;
use crate::physics::power_law_stiffness::PowerLawStiffness;
use crate::physics::scales::Scales;
use crate::physics::shaped_friction::{Shape, ShapedFriction};
use crate::physics::warm_up::WarmUp;
use crate::trace::Step;

use super::earned::{ITERATIONS, earned};
use super::free_forms::{LEAST_LEAD, UNDONE, with_instead};
use super::heats::best_of;
use super::judged::{Departing, Judged, Rival, Selection, judge};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

/// Most further heats of a fit that moves exponent and strength along each other.
const HEATS: usize = 4;
/// A heat that gains less log-likelihood than this was the last.
const CONVERGED: f64 = 0.1;
/// Place of the exponent among the values of a power.
const OF_POWER: usize = 2;
/// An exponent within this many intervals of the one found counts as the same.
const SAME: f64 = 2.0;

/// Puts a law with its own exponent instead of one that departs from its form, where the data
/// distinguish that form from others.
pub(super) fn decide_exponents(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let search = Search { data, scales, tried: selection.tried, budget };
    let departing = || selection.departing.clone().or_else(|| shaped(&selection.chosen));
    let departing = data.trace.is_on(Gate::OwnPower).then(departing).flatten();
    let power = departing.and_then(|departing| search.power(&selection.chosen, &departing));
    let memory = || data.trace.is_on(Gate::OwnSharpness).then(|| search.memory(selection)).flatten();
    let power = power.map(|found| (Gate::OwnPower, found));
    let course = || data.trace.is_on(Gate::OwnCourse).then(|| search.course(&selection.chosen)).flatten();
    let power = power.or_else(|| Some((Gate::OwnCourse, course()?)));
    if let Some((gate, found)) = power.or_else(|| Some((Gate::OwnSharpness, memory()?))) {
        let lead = found.score() - selection.chosen.score();
        data.trace.acts(Step::of(gate, selection.chosen.words(), found.words()).measured(lead, 0.0));
        let before = (gate == Gate::OwnCourse && lead < TIE).then(|| selection.chosen.clone());
        take(selection, found);
        // What the power does not clearly lead stays its rival, under the name that it does not have.
        if let (Some(judged), Some(rivals)) = (before, selection.rivals.last_mut()) {
            rivals.push(Rival { id: Term::WarmUp(WarmUp).id(), judged });
        }
    }
}

/// A model with a friction whose shape was fitted, as one that departs from the sharp one.
pub(super) fn shaped(chosen: &Judged) -> Option<Departing> {
    let is_shaped = |t: &Term| matches!(t, Term::ShapedFriction(_));
    let index = chosen.fit.structure.terms.iter().position(is_shaped)?;
    Some(Departing { judged: chosen.clone(), index })
}

/// Puts a model instead of the chosen one: what stood next to each of its terms and is not
/// clearly behind it stays its rival.
fn take(selection: &mut Selection, found: Judged) {
    let before = &selection.chosen.fit.structure.terms;
    let score = found.score();
    let rivals_of = |t: &Term, only: bool| {
        // The law of a power stands where the law of which it is a power stood.
        let place = before.iter().position(|b| b.id() == t.id()).or(only.then_some(0));
        let all = place.and_then(|p| selection.rivals.get(p)).into_iter().flatten();
        all.filter(|r| !found.has(r.id) && score - r.judged.score() < TIE).cloned().collect()
    };
    let only = before.len() == 1;
    selection.rivals = found.fit.structure.terms.iter().map(|t| rivals_of(t, only)).collect();
    selection.chosen = found;
    selection.departing = None;
}

/// A search for the form of laws that were chosen.
pub(super) struct Search<'a> {
    pub data: &'a Data,
    pub scales: &'a Scales,
    pub tried: usize,
    pub budget: Budget,
}

/// Law of one power that may stand instead of a free form, its strength and exponent where it
/// comes nearest, and the exponents that other names have.
struct Power {
    term: fn(Exponent) -> Term,
    size: f64,
    strength: f64,
    exponent: f64,
    /// Exponents from which fits begin besides.
    further: &'static [f64],
    /// Exponents that belong to the base model and to the stated law.
    known: &'static [f64],
    /// Powers, one of which next to the stated law is another departure of one number.
    beside: &'static [f64],
    stated: Stated,
}

/// The law in the place of which a power stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stated {
    Spring,
    Drag,
    Friction,
}

fn stiffness(exponent: Exponent) -> Term {
    Term::PowerLawStiffness(PowerLawStiffness(exponent))
}

fn damping(exponent: Exponent) -> Term {
    Term::PowerLawDamping(PowerLawDamping(exponent))
}

impl Power {
    /// Returns the law of a free form with these values. For a spring c a³ s^d is
    /// (c size²) s^(2 + d) a; for a drag c |a|a s^d is (c size) s^(1 + d) a.
    fn of(term: &Term, values: &[f64], scales: &Scales) -> Option<Self> {
        let Term::FreeForm(form) = term else { return Self::of_friction(term, values, scales) };
        let (size, beyond) = (form.size, values.get(1).copied().unwrap_or(0.0));
        let spring = Self {
            term: stiffness,
            size,
            strength: values[0] * size * size,
            exponent: (3.0 + beyond).clamp(1.3, 7.0),
            further: &[1.7, 2.3, 4.0, 5.5],
            known: &[1.0, 3.0],
            beside: &[2.0, 4.0, 5.0, 7.0],
            stated: Stated::Spring,
        };
        // A form of one number is the power already.
        let further: &[f64] = if form.extent == Extent::Narrow { &[] } else { &[0.5, 1.5, 2.8] };
        match form.law {
            Freed::CubicSpring if form.extent == Extent::Narrow => Some(Self { further, ..spring }),
            Freed::CubicSpring => Some(spring),
            Freed::Drag => Some(Self {
                term: damping,
                strength: values[0] * size,
                exponent: (2.0 + beyond).clamp(0.3, 5.0),
                further,
                known: &[0.0, 1.0, 2.0],
                beside: &[0.0, 3.0, 4.0],
                stated: Stated::Drag,
                ..spring
            }),
            _ => None,
        }
    }

    /// Returns the damping by a power that is as strong as a friction at twice the usual velocity.
    fn of_friction(term: &Term, values: &[f64], scales: &Scales) -> Option<Self> {
        let size = 2.0 * scales.velocity;
        matches!(term, Term::ShapedFriction(_)).then_some(Self {
            term: damping,
            size,
            strength: values[0] / size,
            exponent: 0.3,
            further: &[0.5, 0.8, 1.5],
            known: &[0.0, 1.0, 2.0],
            beside: &[2.0, 3.0],
            stated: Stated::Friction,
        })
    }

    /// Values from which fits begin: as strong at half the size, whatever the exponent.
    fn starts(&self) -> Vec<Vec<f64>> {
        let at = |n: f64| vec![self.strength * 0.5f64.powf(self.exponent - n), self.size, n];
        std::iter::once(self.exponent).chain(self.further.iter().copied()).map(at).collect()
    }
}

impl Search<'_> {
    pub(super) fn is_over(&self) -> bool {
        self.data.work.is_spent(self.budget)
    }

    fn fitted(&self, model: &Fit, index: usize, term: Term, values: &[f64]) -> Option<Fit> {
        let (structure, point) = with_instead(model, index, term, values);
        fit(self.data, &structure, &point, self.scales, ITERATIONS)
    }

    /// The best of fits from these values of one law, taken further until it rests.
    pub(super) fn best(&self, model: &Fit, index: usize, term: Term, starts: &[Vec<f64>]) -> Option<Judged> {
        self.rested(starts.iter().map(|start| with_instead(model, index, term, start)).collect())
    }

    /// The best of fits from these points, taken further until it rests.
    fn rested(&self, starts: Vec<(ModelStructure, Vec<f64>)>) -> Option<Judged> {
        let mut best = best_of(self.data, &starts, self.scales)?;
        for _ in 0..HEATS {
            if best.converged || self.is_over() {
                break;
            }
            let Some(further) = fit(self.data, &best.structure, &best.point, self.scales, ITERATIONS) else { break };
            let gained = further.log_likelihood() - best.log_likelihood();
            if gained <= 0.0 {
                break;
            }
            best = further;
            if gained < CONVERGED {
                break;
            }
        }
        Some(judge(self.data, best, self.scales))
    }

    /// Returns whether the interval of an exponent, this many times as wide, holds none of these.
    pub(super) fn is_apart(&self, model: &Fit, place: usize, times: f64, known: &[f64]) -> bool {
        let Some(free) = model.free.iter().position(|f| *f == place) else { return false };
        let (n, reach) = (model.point[place], interval::spread(model).reach[free].map(|r| times * r));
        // By its logarithm, as it is fitted.
        let holds = |k: &f64| *k > 0.0 && n * (-reach[0]).exp() <= *k && *k <= n * reach[1].exp();
        reach.iter().all(|r| r.is_finite()) && !known.iter().any(holds)
    }

    /// Returns whether a model leaves next to nothing, or no more than another.
    pub(super) fn leaves_no_more(&self, model: &Judged, than: &Judged) -> bool {
        let left = |j: &Judged| residual_structure(self.data, &j.fit).r_squared;
        let found = left(model);
        found <= UNDONE || found <= left(than)
    }

    /// Fits a law of one power instead of the law that departs, where the data show that it is
    /// one.
    pub(super) fn power(&self, stated: &Judged, departing: &Departing) -> Option<Judged> {
        let (free, index) = (&departing.judged, departing.index);
        let law =
            Power::of(&free.fit.structure.terms[index], free.fit.structure.of(index, &free.fit.point), self.scales)?;
        // The stated model has the same terms, in the same places.
        if self.is_over() || stated.fit.structure.terms.len() != free.fit.structure.terms.len() {
            return None;
        }
        let found = self.best(&free.fit, index, (law.term)(Exponent::Free), &law.starts())?;
        // A law of another family must lead; one of the same family must only not fall behind.
        let least = if law.stated == Stated::Friction { TIE } else { -LEAST_LEAD };
        let holds = found.score() - free.score() >= least
            && !found.fit.at_bound(self.scales)
            && self.is_apart(&found.fit, found.fit.structure.first[index] + OF_POWER, 1.0, law.known)
            && earned(self.data, stated, &found, self.scales, self.tried).is_some()
            && self.leaves_no_more(&found, free);
        (holds && !self.is_free_to_gain(&law, &found, index) && !self.is_matched(&law, stated, &found, index))
            .then_some(found)
    }

    /// Returns whether the free form of the stated law, begun at the power, gains over it.
    fn is_free_to_gain(&self, law: &Power, found: &Judged, index: usize) -> bool {
        let [strength, size, n] = *found.fit.structure.of(index, &found.fit.point) else { return true };
        let (freed, first, stated) = match law.stated {
            Stated::Spring => (Freed::CubicSpring, strength / (size * size), 3.0),
            _ => (Freed::Drag, strength / size, 2.0),
        };
        let wide = Term::FreeForm(FreeForm { law: freed, size, extent: Extent::Wide });
        let free = self.best(&found.fit, index, wide, &[vec![first, n - stated, 0.0, 0.0]]);
        free.is_some_and(|free| free.score() > found.score() + LEAST_LEAD)
    }

    /// Returns whether another departure of one number does as well: one further power of a fixed
    /// exponent next to the stated law, or a friction that is smooth.
    fn is_matched(&self, law: &Power, stated: &Judged, found: &Judged, index: usize) -> bool {
        let bar = found.score() - TIE;
        let size = found.fit.structure.of(index, &found.fit.point)[1];
        let plain = match law.stated {
            Stated::Spring => self.as_stated(stated, found, index),
            _ => self.as_drag(stated, found, index),
        };
        let Some(plain) = plain else { return true };
        // The very power that was found is no other departure: next to it nothing of the rest
        // remains.
        let place = found.fit.structure.first[index] + OF_POWER;
        let others: Vec<f64> =
            law.beside.iter().copied().filter(|q| self.is_apart(&found.fit, place, SAME, &[*q])).collect();
        let beside = |exponent: &f64| {
            let values = [0.0, size, *exponent];
            let (structure, point) = plain.with((law.term)(Exponent::Held), &values);
            let other = fit(self.data, &structure, &point, self.scales, ITERATIONS)?;
            Some(judge(self.data, other, self.scales).score())
        };
        if parallel::filter_map(&others, beside).into_iter().any(|score| score > bar) {
            return true;
        }
        if law.stated == Stated::Spring {
            return false;
        }
        let smooth = Term::ShapedFriction(ShapedFriction(Shape::Smooth));
        let strength = found.fit.structure.of(index, &found.fit.point)[0] * size;
        let starts: Vec<Vec<f64>> = [0.05, 0.3, 1.0].map(|part| vec![0.5 * strength, part * size]).to_vec();
        self.best(&found.fit, index, smooth, &starts).is_some_and(|smooth| smooth.score() > bar)
    }

    /// The model of the power with the stated law in its place.
    fn as_stated(&self, stated: &Judged, found: &Judged, index: usize) -> Option<Fit> {
        let old = &stated.fit;
        self.fitted(&found.fit, index, old.structure.terms[index], old.structure.of(index, &old.point))
    }

    /// The same with a quadratic damping, whichever law departed.
    fn as_drag(&self, stated: &Judged, found: &Judged, index: usize) -> Option<Fit> {
        if let Term::QuadraticDamping(_) = stated.fit.structure.terms[index] {
            return self.as_stated(stated, found, index);
        }
        let [strength, size, _] = *found.fit.structure.of(index, &found.fit.point) else { return None };
        self.fitted(&found.fit, index, Term::QuadraticDamping(Default::default()), &[strength / size])
    }

    /// A drift along one power of time instead of laws of time, or one and a walk, that were chosen together: two of
    /// them can imitate a power to within the noise.
    fn course(&self, chosen: &Judged) -> Option<Judged> {
        let fit = &chosen.fit;
        let terms = &fit.structure.terms;
        let is_course = |t: &Term| matches!(t, Term::BiasDrift(_) | Term::WarmUp(_));
        let others: Vec<usize> = (0..terms.len()).filter(|i| !is_course(&terms[*i])).collect();
        let walks = terms.iter().filter(|t| t.noise() == Some(Noise::Walk)).count();
        let laws = terms.len() - others.len();
        if laws == 0 || laws + walks < 2 || self.is_over() {
            return None;
        }
        let term = Term::BiasDrift(BiasDrift(Course::Power));
        let (structure, point) = fit.only(&others);
        let structure = ModelStructure::over(&[structure.terms.as_slice(), &[term]].concat(), structure.further);
        let start = |values: Vec<f64>| (structure.clone(), [point.as_slice(), &values].concat());
        let found = self.rested(term.starts(self.scales).into_iter().map(start).collect())?;
        let found = Departing { judged: found, index: others.len() };
        let Departing { judged: found, index } = found.pruned(self.data, self.scales, chosen.score());
        let place = found.fit.structure.first[index] + OF_POWER;
        let fewer = found.fit.structure.terms.len() < terms.len();
        let holds = found.score() - chosen.score() >= if fewer { -LEAST_LEAD } else { TIE }
            && !found.fit.at_bound(self.scales)
            && self.is_apart(&found.fit, place, 1.0, &[1.0])
            && self.leaves_no_more(&found, chosen);
        holds.then_some(found)
    }
}
