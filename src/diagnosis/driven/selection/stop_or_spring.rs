//! Decides between a stop and a spring of another power than the library's.

use crate::driven::identification::fit::{Fit, OMEGA, ZETA, fit};
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::gate::Gate;
use crate::numerics::moments::rms;
use crate::physics::cubic_stiffness::CubicStiffness;
use crate::physics::end_stop::{EndStop, Side};
use crate::physics::free_form::{Argument, Extent, FreeForm, Freed, VALUES};
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::earned::{ITERATIONS, earned};
use super::free_forms::{IMMATERIAL, LEAST_LEAD, MANY, UNDONE, visits, with_instead};
use super::held_out::compare;
use super::judged::{Departing, Judged, Rival, Selection, judge};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

/// Powers beyond the cube among which the one nearest to a stop is looked for: from all but a
/// linear spring to a wall, in steps within which a fit reaches its lowest point.
const POWERS: [f64; 2] = [-1.9, 3.0];
const BETWEEN_POWERS: f64 = 0.05;
/// A fit that moves exponent, strength and the linear spring along each other goes slowly.
const LONG: usize = 4 * ITERATIONS;

/// A fit of the power that starts at the cube ends before it gets there, and a stop whose gap lies
/// within the motion imitates it. Started where its force is nearest to the stop's, the fit gets
/// there; where it then does better than the stop, the law is a spring, and where it does as well,
/// the two are indistinguishable.
pub(super) fn decide_stop_or_spring(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let found = selection.departing.as_ref().map_or(&selection.chosen, |d| &d.judged);
    let terms = &found.fit.structure.terms;
    let Some(index) = terms.iter().position(|t| stop(t).is_some()) else { return };
    // One law at a time is given freedom in its form.
    let mut others = terms.iter().enumerate().filter(|(i, _)| *i != index);
    if others.any(|(_, t)| matches!(t, Term::CubicStiffness(_) | Term::FreeForm(_))) {
        return;
    }
    let leaves = |judged: &Judged| residual_structure(data, &judged.fit).r_squared > UNDONE;
    if data.work.is_spent(budget) || !data.trace.is_on(Gate::PowerForStop) {
        return;
    }
    let Some(power) = in_place(data, &found.fit, index, scales) else { return };
    let power = Departing { judged: judge(data, power, scales), index };
    if data.work.is_spent(budget) || terms.len() > MANY && leaves(&power.judged) {
        return;
    }
    // What the spring leaves idle costs it nothing.
    let power = power.pruned(data, scales, found.score());
    // At the end of its range a power is another law.
    if power.judged.fit.term_at_bound(power.index, scales) {
        return;
    }
    let fewer = power.judged.fit.structure.terms.len() < terms.len();
    let lead = power.judged.score() - found.score();
    if lead < -TIE {
        return;
    }
    let Some(stated) = as_cube(data, &power, scales) else { return };
    let gain = compare(&stated.held_out, &power.judged.held_out).gain;
    let departs = earned(data, &stated, &power.judged, scales, selection.tried).is_some() && gain >= IMMATERIAL;
    if !departs {
        return;
    }
    let chosen = &selection.chosen.fit.structure.terms;
    let least = if fewer { -LEAST_LEAD } else { TIE };
    let is_better = lead >= least;
    let step = |after: String| Step::of(Gate::PowerForStop, selection.chosen.words(), after);
    if !is_better {
        let Some(place) = chosen.iter().position(|t| stop(t).is_some()) else { return };
        let id = stated.fit.structure.terms[power.index].id();
        selection.rivals.resize_with(chosen.len(), Vec::new);
        if !selection.rivals[place].iter().any(|r| r.id == id) {
            data.trace.acts(step(format!("tied with {}", chosen[place].id())).measured(lead, -TIE));
            selection.rivals[place].push(Rival { judged: stated, id });
        }
        return;
    }
    data.trace.acts(step(stated.words()).measured(lead, least));
    let known = |t: &Term| chosen.iter().position(|c| c.id() == t.id()).and_then(|p| selection.rivals.get(p));
    let rivals_of = |t: &Term| -> Vec<Rival> {
        let all = known(t).into_iter().flatten();
        all.filter(|rival| !stated.has(rival.id)).cloned().collect()
    };
    selection.rivals = stated.fit.structure.terms.iter().map(rivals_of).collect();
    selection.chosen = stated;
    selection.departing = Some(power);
}

/// A stop on both sides as a free form; none of another term. One on one side is no power of the
/// displacement.
fn stop(term: &Term) -> Option<FreeForm> {
    let as_stated = FreeForm { law: Freed::Stop(Side::Both), size: 1.0, extent: Extent::Wide };
    match term {
        Term::EndStop(EndStop(Side::Both)) => Some(as_stated),
        Term::FreeForm(form) if form.law == as_stated.law => Some(*form),
        _ => None,
    }
}

/// A model with a spring of one power instead of a stop, fitted from where it comes nearest to
/// the stop's force on the mass.
fn in_place(data: &Data, model: &Fit, index: usize, scales: &Scales) -> Option<Fit> {
    let form = stop(&model.structure.terms[index])?;
    let at = thinned(visits(data, model, Argument::Displacement));
    let force = Force::of(&form, model.structure.of(index, &model.point), &at);
    let size = 2.0 * rms(at.iter().copied());
    let moves = size > 0.0 && size.is_finite();
    let spring = moves.then_some(FreeForm { law: Freed::CubicSpring, size, extent: Extent::Narrow })?;
    let count = ((POWERS[1] - POWERS[0]) / BETWEEN_POWERS).round() as usize;
    let powers = (0..=count).map(|i| POWERS[0] + BETWEEN_POWERS * i as f64);
    let leaves_a_spring = |n: &Nearest| n.move_base(&mut model.point.clone()).is_some();
    let all = powers.filter_map(|further| force.nearest(&spring, further)).filter(leaves_a_spring);
    let nearest = all.min_by(|a, b| a.rest.total_cmp(&b.rest))?;
    let values = [nearest.strength, nearest.further];
    let (structure, mut point) = with_instead(model, index, Term::FreeForm(spring), &values);
    nearest.move_base(&mut point)?;
    fit(data, &structure, &point, scales, LONG)
}

/// Displacements from which a force is known well enough.
const ENOUGH: usize = 4096;

/// Returns as many of these as are enough, evenly spread.
fn thinned(visits: Vec<f64>) -> Vec<f64> {
    let every = visits.len() / ENOUGH + 1;
    visits.into_iter().step_by(every).collect()
}

/// The same terms with the cube instead of the power, fitted.
fn as_cube(data: &Data, power: &Departing, scales: &Scales) -> Option<Judged> {
    let (model, index) = (&power.judged.fit, power.index);
    let Term::FreeForm(form) = model.structure.terms[index] else { return None };
    let at = thinned(visits(data, model, Argument::Displacement));
    let nearest = Force::of(&form, model.structure.of(index, &model.point), &at).nearest(&form, 0.0)?;
    let (structure, mut point) = with_instead(model, index, Term::CubicStiffness(CubicStiffness), &[nearest.strength]);
    nearest.move_base(&mut point)?;
    Some(judge(data, fit(data, &structure, &point, scales, ITERATIONS)?, scales))
}

/// Force of a law at the displacements that were visited.
struct Force<'a> {
    at: &'a [f64],
    force: Vec<f64>,
}

/// A power of the displacement and a linear spring that come nearest to a force.
struct Nearest {
    strength: f64,
    /// Power beyond the cube.
    further: f64,
    linear: f64,
    /// Sum of squares of the residual.
    rest: f64,
}

impl<'a> Force<'a> {
    fn of(form: &FreeForm, stated: &[f64], at: &'a [f64]) -> Self {
        let mut values = [0.0; VALUES];
        values.iter_mut().zip(stated).for_each(|(v, s)| *v = *s);
        let force = at.iter().map(|a| form.curve::<f64, false>(&values, *a)).collect();
        Self { at, force }
    }

    /// Finds the nearest power by least squares over the visits, in units of the spring's size.
    fn nearest(&self, spring: &FreeForm, further: f64) -> Option<Nearest> {
        let unit = spring.size.powi(3);
        let (mut pp, mut pl, mut ll, mut pf, mut lf, mut ff) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (a, f) in self.at.iter().zip(&self.force) {
            let p = spring.curve::<f64, false>(&[1.0, further, 0.0, 0.0], *a) / unit;
            let l = a / spring.size;
            pp += p * p;
            pl += p * l;
            ll += l * l;
            pf += p * f;
            lf += l * f;
            ff += f * f;
        }
        let det = pp * ll - pl * pl;
        let (power, linear) = ((pf * ll - lf * pl) / det, (lf * pp - pf * pl) / det);
        let rest = ff - power * pf - linear * lf;
        let finite = det > 0.0 && rest.is_finite();
        finite.then(|| Nearest { strength: power / unit, further, linear: linear / spring.size, rest })
    }
}

impl Nearest {
    /// Gives the linear spring to the base model, whose damping stays what it is; `None` where no
    /// spring would be left.
    fn move_base(&self, point: &mut [f64]) -> Option<()> {
        let omega = point.get(OMEGA)?;
        let (before, after) = (*omega, (omega * omega + self.linear).sqrt());
        if after.is_nan() || after <= 0.0 {
            return None;
        }
        point[OMEGA] = after;
        point[ZETA] *= before / after;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The force of x |x|^0.7 next to 0.3 x is found again: power, strength and linear spring.
    #[test]
    fn a_power_beside_a_linear_spring_is_its_own_nearest() {
        let at: Vec<f64> = (0..400).map(|i| f64::from(i) / 100.0 - 2.0).collect();
        let force = at.iter().map(|a| a * a.abs().powf(0.7) + 0.3 * a).collect();
        let spring = FreeForm { law: Freed::CubicSpring, size: 2.0, extent: Extent::Narrow };
        let force = Force { at: &at, force };
        let rest = |further: f64| force.nearest(&spring, further).map_or(f64::NAN, |n| n.rest);
        assert!(rest(-1.3) < 1e-9 && rest(-1.2) > 1e-4 && rest(-1.4) > 1e-4);
        let nearest = force.nearest(&spring, -1.3).expect("there are visits");
        assert!((nearest.strength / 2f64.powf(-1.3) - 1.0).abs() < 1e-6, "{}", nearest.strength);
        assert!((nearest.linear - 0.3).abs() < 1e-6, "{}", nearest.linear);
        // 2ζω is the damping, and ω² is stiffer by the linear spring.
        let mut point = [1.0, 2.0, 0.1];
        nearest.move_base(&mut point).expect("a spring is left");
        assert!((point[1] * point[1] - 4.3).abs() < 1e-6 && (point[1] * point[2] - 0.2).abs() < 1e-12);
    }
}
