//! Measures how far a named law departs from the form that its name states, over the arguments that
//! the recording visited.

use crate::driven::identification::fit::Fit;
use crate::driven::identification::interval;
use crate::driven::intake::data::Data;
use crate::driven::selection::free_forms::{freed, visits};
use crate::driven::selection::judged::Judged;
use crate::numerics::moments::rms;
use crate::numerics::order;
use crate::physics::free_form::{Argument, FreeForm, Freed, VALUES};
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::verdict::Form;

/// Places of the curve that is kept.
const PLACES: usize = 41;
/// Visits that the departure is weighed by.
const VISITS: usize = 400;
/// 95 % quantile, as a number of standard deviations, of the length of what three free values do by
/// chance (√χ²₀.₉₅ with three degrees of freedom): as far as a departure is no evidence of one.
const BY_CHANCE: f64 = 2.795;
/// Step of a free value, in standard deviations, for the derivative of the curve.
const NUDGE: f64 = 0.05;

/// The free form of a law as it was fitted.
#[derive(Debug, Clone)]
pub struct Freely<'a> {
    /// The model in which it is free.
    pub fit: &'a Fit,
    /// Place of the law among the terms of that model.
    pub index: usize,
    /// States whether it predicts unseen samples better than the stated form does.
    pub departs: bool,
}

/// The form of one named law of a model, found by a fit of its own where none is given.
pub(crate) fn form(
    data: &Data,
    model: &Judged,
    index: usize,
    scales: &Scales,
    known: Option<Freely<'_>>,
) -> Option<Form> {
    if let Some(known) = known {
        return departure(data, &known);
    }
    let fit = freed(data, &model.fit, index, scales, false)?;
    // Smooth friction, for one, comes near dry friction and never there: where it fits worse it
    // shows nothing of the form.
    if fit.log_likelihood() < model.fit.log_likelihood() {
        return None;
    }
    departure(data, &Freely { fit: &fit, index, departs: false })
}

fn departure(data: &Data, freely: &Freely<'_>) -> Option<Form> {
    let fit = freely.fit;
    let Term::FreeForm(form) = fit.structure.terms[freely.index] else { return None };
    let mut visited = visits(data, fit, form.law.argument());
    order::sort(&mut visited);
    if visited.len() < 2 {
        return None;
    }
    let last = visited.len() - 1;
    let at: Vec<f64> = (0..VISITS).map(|i| visited[last * i / (VISITS - 1)]).collect();
    let mut values = fit.structure.of(freely.index, &fit.point).to_vec();
    let fitted = values.len();
    values.resize(VALUES, 0.0);
    let curve = |p: &[f64], at: &[f64]| -> Vec<f64> { at.iter().map(|a| form.curve::<f64, false>(p, *a)).collect() };
    let whole = curve(&values, &at);
    let split = Split::of(&form, &values, &at, &whole)?;
    let size = rms(split.stated.iter().copied()).max(1e-300);
    let rest = rms(split.rest.iter().copied());
    let departure = rest / size;
    // The departure's own direction as a linear function of the free values.
    let spread = interval::spread(fit);
    let first = fit.structure.first[freely.index];
    let free: Vec<usize> = (0..fitted).filter_map(|j| fit.free.iter().position(|f| *f == first + j)).collect();
    let slopes: Vec<f64> = free
        .iter()
        .map(|f| {
            let step = NUDGE * spread.deviation[*f].min(1e3) * fit.slopes[*f];
            let mut moved = values.clone();
            moved[fit.free[*f] - first] += step;
            let bent = curve(&moved, &at).iter().zip(&whole).map(|(m, w)| m - w).collect::<Vec<f64>>();
            let along: f64 = bent.iter().zip(&split.rest).map(|(b, r)| b * r).sum();
            along / (VISITS as f64 * rest.max(1e-300) * size * NUDGE)
        })
        .collect();
    let mut variance = 0.0;
    for (i, a) in free.iter().zip(&slopes) {
        for (j, b) in free.iter().zip(&slopes) {
            variance += a * b * spread.correlation[(*i, *j)];
        }
    }
    let deviation = variance.max(0.0).sqrt();
    if !departure.is_finite() || !deviation.is_finite() {
        return None;
    }
    let low = if freely.departs { (departure - BY_CHANCE * deviation).max(0.0) } else { 0.0 };
    let high = departure + interval::reach() * deviation;
    let (from, to) = (visited[0], visited[last]);
    let places: Vec<f64> = (0..PLACES).map(|i| from + (to - from) * i as f64 / (PLACES - 1) as f64).collect();
    let drawn = curve(&values, &places).iter().zip(&places).map(|(f, a)| [*a, f - split.base(*a)]).collect();
    let stated = places.iter().map(|a| [*a, split.stated_at(*a)]).collect();
    Some(Form {
        law: form.law,
        stated: form.law.stated().to_owned(),
        departure,
        ci95: [low, high],
        curve: drawn,
        stated_curve: stated,
        departs: freely.departs,
    })
}

/// A curve as the stated form of some strength, what the base model does besides, and the rest.
pub(crate) struct Split {
    law: Freed,
    /// Strengths of the stated form and of the base model's part.
    strengths: Vec<f64>,
    gap: [f64; 2],
    /// The stated form at each visit.
    pub(crate) stated: Vec<f64>,
    /// Rest of the curve.
    pub(crate) rest: Vec<f64>,
}

impl Split {
    /// The nearest one: by least squares over the visits, over the gaps too for a stop.
    pub(crate) fn of(form: &FreeForm, values: &[f64], at: &[f64], whole: &[f64]) -> Option<Self> {
        let gaps: Vec<[f64; 2]> = match form.law {
            Freed::Stop(_) => {
                let (furthest, gap) = (at.iter().fold(0.0f64, |m, a| m.max(a.abs())), values[1]);
                (0..=40).map(|i| gap + (furthest - gap) * f64::from(i) / 42.0).map(|g| [g; 2]).collect()
            }
            _ => vec![[0.0; 2]],
        };
        let all = gaps.into_iter().filter_map(|gap| Self::at_gap(form.law, gap, at, whole));
        all.min_by(|a, b| rms(a.rest.iter().copied()).total_cmp(&rms(b.rest.iter().copied())))
    }

    fn at_gap(law: Freed, gap: [f64; 2], at: &[f64], whole: &[f64]) -> Option<Self> {
        let columns: Vec<Vec<f64>> = at.iter().map(|a| functions(law, gap, *a)).collect();
        let n = columns[0].len();
        let matrix = nalgebra::DMatrix::from_fn(at.len(), n, |i, j| columns[i][j]);
        let sizes: Vec<f64> = (0..n).map(|j| matrix.column(j).norm().max(1e-300)).collect();
        let scaled = nalgebra::DMatrix::from_fn(at.len(), n, |i, j| matrix[(i, j)] / sizes[j]);
        let solved = scaled.svd(true, true).solve(&nalgebra::DVector::from_column_slice(whole), 1e-10).ok()?;
        let strengths: Vec<f64> = solved.iter().zip(&sizes).map(|(s, size)| s / size).collect();
        let fitted: Vec<f64> = columns.iter().map(|c| c.iter().zip(&strengths).map(|(c, s)| c * s).sum()).collect();
        let own = |c: &[f64]| c.iter().zip(&strengths).take(strengths_of(law)).map(|(c, s)| c * s).sum();
        let stated = columns.iter().map(|c| own(c)).collect();
        let rest = whole.iter().zip(&fitted).map(|(w, f)| w - f).collect();
        Some(Self { law, strengths, gap, stated, rest })
    }

    /// Returns the part of it that the base model's own parameters do.
    pub(crate) fn base(&self, a: f64) -> f64 {
        let all = functions(self.law, self.gap, a);
        all.iter().zip(&self.strengths).skip(strengths_of(self.law)).map(|(f, s)| f * s).sum()
    }

    pub(crate) fn stated_at(&self, a: f64) -> f64 {
        let all = functions(self.law, self.gap, a);
        all.iter().zip(&self.strengths).take(strengths_of(self.law)).map(|(f, s)| f * s).sum()
    }
}

/// Returns how many strengths a stated form has.
fn strengths_of(law: Freed) -> usize {
    if law == Freed::Readout { 2 } else { 1 }
}

/// The stated form at an argument, for each of its strengths, and the functions of it that the base
/// model has parameters for.
fn functions(law: Freed, [above, below]: [f64; 2], a: f64) -> Vec<f64> {
    use crate::physics::end_stop::Side;
    let stated = match law {
        Freed::CubicSpring => a.powi(3),
        Freed::QuadraticSpring | Freed::Film | Freed::Drive => a * a,
        Freed::Drag => a.abs() * a,
        Freed::Drift => a,
        Freed::Readout => a.powi(3),
        Freed::Stop(side) => {
            let upper = if side == Side::Lower { 0.0 } else { (a - above).max(0.0) };
            let lower = if side == Side::Upper { 0.0 } else { (-a - below).max(0.0) };
            upper - lower
        }
    };
    match (law, law.argument()) {
        (Freed::Film | Freed::Drift, _) => vec![stated, 1.0],
        (Freed::Readout, _) => vec![stated, a * a, a, 1.0],
        (_, Argument::Velocity) => vec![stated, a],
        _ => vec![stated, a, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::free_form::Extent;

    /// The departure of a free form with these values over arguments spread evenly over (−1, 1).
    fn off(law: Freed, values: [f64; 4]) -> f64 {
        let form = FreeForm { law, size: 1.0, extent: Extent::Wide };
        let at: Vec<f64> = (0..4000).map(|i| (f64::from(i) + 0.5) / 2000.0 - 1.0).collect();
        let whole: Vec<f64> = at.iter().map(|a| form.curve::<f64, false>(&values, *a)).collect();
        let split = Split::of(&form, &values, &at, &whole).expect("it can be split");
        rms(split.rest.iter().copied()) / rms(split.stated.iter().copied())
    }

    // Least squares of |x|^2.4 sgn x by x³ and x over (−1, 1), whose products integrate to 1/(a +
    // b + 1).
    #[test]
    fn the_departure_of_a_power_is_that_of_its_integrals() {
        let product = |a: f64, b: f64| 1.0 / (a + b + 1.0);
        let (p, det) = (2.4, product(3.0, 3.0) * product(1.0, 1.0) - product(3.0, 1.0).powi(2));
        let (b3, b1) = (product(p, 3.0), product(p, 1.0));
        let c3 = (b3 * product(1.0, 1.0) - b1 * product(3.0, 1.0)) / det;
        let c1 = (b1 * product(3.0, 3.0) - b3 * product(3.0, 1.0)) / det;
        let rest = product(p, p) - c3 * b3 - c1 * b1;
        let expected = (rest / (c3 * c3 * product(3.0, 3.0))).sqrt();
        let got = off(Freed::CubicSpring, [1.0, p - 3.0, 0.0, 0.0]);
        assert!((got / expected - 1.0).abs() < 1e-3, "{got} {expected}");
        assert!(off(Freed::CubicSpring, [1.0, 0.0, 0.0, 0.0]) < 1e-9, "the stated law departs by nothing");
    }

    #[test]
    fn a_linear_spring_or_damper_beside_is_no_departure() {
        // x³ · s⁻² is x: the base model's own.
        assert!(off(Freed::CubicSpring, [1.0, 0.0, 0.3, 0.0]) > 0.01);
        let linear = FreeForm { law: Freed::CubicSpring, size: 1.0, extent: Extent::Wide };
        let at: Vec<f64> = (0..400).map(|i| (f64::from(i) + 0.5) / 200.0 - 1.0).collect();
        let whole: Vec<f64> = at.iter().map(|a| a.powi(3) + 5.0 * a + 0.2).collect();
        let split = Split::of(&linear, &[1.0, 0.0, 0.0, 0.0], &at, &whole).expect("it can be split");
        assert!(rms(split.rest.iter().copied()) < 1e-9);
        assert!((split.base(0.5) - 2.7).abs() < 1e-9 && (split.stated_at(0.5) - 0.125).abs() < 1e-9);
    }

    // Least squares of t^1.5 by t and 1 over (0, 1): slope 12(2/7 − 1/5) = 36/35, and of the variance
    // 1/4 − 4/25 = 9/100 what the line leaves is 9/100 − (36/35)²/12 = 0.00183673.
    #[test]
    fn the_departure_of_a_drift_is_beside_a_line_and_a_constant() {
        let form = FreeForm { law: Freed::Drift, size: 1.0, extent: Extent::Wide };
        let at: Vec<f64> = (0..4000).map(|i| (f64::from(i) + 0.5) / 4000.0).collect();
        let whole = |values: [f64; 4]| at.iter().map(|t| form.curve::<f64, false>(&values, *t)).collect::<Vec<f64>>();
        let of = |values: [f64; 4]| {
            let split = Split::of(&form, &values, &at, &whole(values)).expect("it can be split");
            rms(split.rest.iter().copied()) / rms(split.stated.iter().copied())
        };
        let expected = 0.001_836_73f64.sqrt() / (36.0 / 35.0 / 3f64.sqrt());
        let found = of([1.0, 0.5, 0.0, 0.0]);
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        assert!(of([1.0, 0.0, 0.0, 0.0]) < 1e-9, "the stated law departs by nothing");
    }

    #[test]
    fn a_dead_zone_departs_from_a_readout_that_bends_and_two_coefficients_are_none() {
        assert!(off(Freed::Readout, [0.3, 0.1, 0.0, 0.5]) < 1e-9);
        assert!(off(Freed::Readout, [0.0, 0.0, 0.2, 0.2]) > 0.1);
    }

    #[test]
    fn hertz_departs_from_a_straight_stop_and_a_straight_one_does_not() {
        use crate::physics::end_stop::Side;
        let stop = Freed::Stop(Side::Both);
        assert!(off(stop, [10.0, 0.5, 0.5, 0.0]) > 0.03);
        assert!(off(stop, [10.0, 0.5, 0.0, 0.0]) < 0.02);
    }
}
