//! Runs one round of candidates on top of a model: each screened by one linear step, the most
//! promising fitted together with the base and judged. Not the order of rounds (`stepwise`) and not
//! what makes a term worth its place (`earned`).

use crate::control::{Control, Stopped};
use crate::driven::identification::fit::{Fit, Search, fit};
use crate::driven::identification::start_search::StartSearch;
use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::driven::simulation::structure::ModelStructure;
use crate::gate::Gate;
use crate::numerics::least_squares::Linear;
use crate::numerics::order;
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::physics::state::LANES;

use super::earned::ITERATIONS;
use super::heats::HEAT;
use super::held_out::{Comparison, compare};
use super::input_line::follows_input;
use super::judged::{Judged, Trial, judge};

/// Candidates that are fitted in full in one round; the rest stop at the linear step.
const FINALISTS: usize = 6;
/// Starts of one candidate that are fitted in full.
const STARTS: usize = 2;
/// The same where its law has a corner, so that there are many local minima.
const CORNER_STARTS: usize = 4;
/// Candidates that are fitted whatever the best one promises.
pub(super) const SURE: usize = 3;
/// Log-likelihood that a candidate must promise to be fitted.
const LEAST_PROMISE: f64 = 8.0;
/// Candidates that are fitted to the end in one round.
const POLISHED: usize = 3;

/// The starts of a term, as points of the model with it: first the one from which a linear step
/// promises most, each with what it promises.
pub(crate) fn screen(
    data: &Data,
    model: &Fit,
    ensemble: Option<&StartSearch<'_>>,
    term: Term,
    scales: &Scales,
) -> Vec<(f64, Vec<f64>)> {
    let found = ensemble.and_then(|e| e.starts(term, scales, CORNER_STARTS)).filter(|s| !s.is_empty());
    let with = |values: &Vec<f64>| model.with(term, values).1;
    let starts = found.unwrap_or_else(|| term.starts(scales).iter().map(with).collect());
    // The strength of a noise is only looked at from its starts: it bends every derivative of the
    // base.
    let own = if term.noise().is_some() { 0 } else { term.values() };
    let Some(first) = starts.first() else { return Vec::new() };
    let structure = model.with(term, &vec![0.0; term.values()]).0;
    let search = Search::all(data, &structure, first, scales);
    let steps = starts.iter().map(|s| structure.coarse_steps(s, scales)).max().unwrap_or(1).max(model.steps);
    let mut points = Vec::new();
    for start in &starts {
        let z = search.z(start);
        points.push(search.point(&z));
        for j in 0..own {
            let mut moved = z.clone();
            let index = moved.len() - structure.block(structure.terms.len() - 1).len() + j;
            moved[index] += 1e-4;
            points.push(search.point(&moved));
        }
    }
    let run = Run { range: data.hull.clone(), steps, corrected: true };
    let rows: Vec<usize> = data.train.iter().flat_map(|r| r.clone()).map(|k| k - data.hull.start).collect();
    let traces: Vec<Vec<f64>> = points
        .chunks(LANES)
        .flat_map(|group| {
            let lanes = innovations(data, &structure, group, &run, &mut Nothing);
            (0..group.len()).map(|l| rows.iter().map(|k| lanes[*k][l]).collect::<Vec<f64>>()).collect::<Vec<_>>()
        })
        .collect();
    let mut promises: Vec<(f64, Vec<f64>)> = traces
        .chunks(own + 1)
        .zip(starts)
        .filter(|(group, _)| group.iter().flatten().all(|v| v.is_finite()))
        .map(|(group, start)| {
            if own == 0 {
                return (group[0].iter().map(|e| e * e).sum(), start);
            }
            let mut columns = model.linear.columns.clone();
            for moved in &group[1..] {
                columns.push(moved.iter().zip(&group[0]).map(|(m, e)| (m - e) / 1e-4).collect());
            }
            (Linear { residual: group[0].clone(), columns }.normal().predicted(), start)
        })
        .collect();
    order::sort_by_key(&mut promises, |p| p.0);
    promises
}

/// Tries every candidate on top of a model: all by one linear step, the most promising in full.
/// Best first. At least `sure` of them are fitted, whatever the best promises.
///
/// # Errors
/// Stopped.
pub(crate) fn round(
    data: &Data,
    model: &Judged,
    candidates: &[Term],
    scales: &Scales,
    sure: usize,
    control: &Control,
) -> Result<Vec<Trial>, Stopped> {
    let sum = model.fit.linear.normal().sum.max(1e-300);
    let ensemble = StartSearch::around(data, &model.fit);
    let mut promised: Vec<(Term, f64, Vec<Vec<f64>>)> = parallel::filter_map(candidates, |term| {
        if control.cancelled() || term.values() == 0 {
            return None;
        }
        let promises = screen(data, &model.fit, ensemble.as_ref(), *term, scales);
        let best = promises.first().map_or(f64::INFINITY, |p| p.0 / sum);
        let starts = if term.has_corner() { CORNER_STARTS } else { STARTS };
        Some((*term, best, promises.into_iter().take(starts).map(|p| p.1).collect()))
    });
    order::sort_by_key(&mut promised, |p| p.1);
    let worth = worth_fitting(&promised, model.fit.linear.residual.len(), sure);
    let by_input = data.trace.is_on(Gate::InputLine);
    let mut trials: Vec<Trial> = parallel::map_indices(promised.len(), |i| {
        let (term, promised, starts) = &promised[i];
        let nothing = Comparison { gain: 0.0, ci95: [-1.0, 1.0], p_value: 1.0 };
        let mut trial =
            Trial { term: *term, promised: *promised, judged: None, follows_input: false, comparison: nothing };
        let structure = model.fit.with(*term, &vec![0.0; term.values()]).0;
        let known = known(data, &structure);
        if !(worth[i] || known.is_some()) || control.cancelled() {
            return trial;
        }
        let fits = starts.iter().chain(&known).filter_map(|point| fit(data, &structure, point, scales, HEAT));
        let (following, others): (Vec<Fit>, Vec<Fit>) =
            fits.partition(|fit| by_input && follows_input(data, fit, fit.structure.terms.len() - 1));
        let best = |fits: Vec<Fit>| fits.into_iter().min_by(|a, b| a.variance.total_cmp(&b.variance));
        trial.judged = best(others).map(|found| judge(data, found, scales));
        trial.follows_input = best(following).is_some_and(|found| judge(data, found, scales).score() > model.score());
        trial
    });
    control.go_on()?;
    by_score(&mut trials);
    parallel::for_each_mut(&mut trials, |rank, trial| {
        let Some(judged) = &mut trial.judged else { return };
        if rank < POLISHED
            && !judged.fit.converged
            && let Some(found) = fit(data, &judged.fit.structure, &judged.fit.point, scales, ITERATIONS)
        {
            *judged = judge(data, found, scales);
        }
        trial.comparison = compare(&model.held_out, &judged.held_out);
    });
    control.go_on()?;
    by_score(&mut trials);
    Ok(trials)
}

/// A model of springs alone where a force that describes a chaotic motion puts it: its misfit over
/// the linear base has other minima.
fn known(data: &Data, structure: &ModelStructure) -> Option<Vec<f64>> {
    let force = &data.windows.as_ref()?.force;
    let mut point = vec![0.0; structure.parameters];
    point.get_mut(..force.base.len())?.copy_from_slice(&force.base);
    for (term, first) in structure.terms.iter().zip(&structure.first) {
        point[*first] = match term {
            Term::CubicStiffness(_) => force.cubic,
            Term::QuadraticStiffness(_) => force.quadratic,
            _ => return None,
        };
    }
    Some(point)
}

/// Returns which candidates, best promise first, are fitted in full. Noise corrects itself and so
/// promises more than any law of motion can at first: the two are ranked apart. A shape of a law promises
/// more than its stated form by its further values: it takes no place from another.
fn worth_fitting(promised: &[(Term, f64, Vec<Vec<f64>>)], rows: usize, sure: usize) -> Vec<bool> {
    let is_shape = |t: &Term| matches!(t, Term::ShapedFriction(_));
    let mut worth = vec![false; promised.len()];
    for noise in [false, true] {
        let alike = || promised.iter().enumerate().filter(|(_, p)| p.0.noise().is_some() == noise);
        let best = alike().find(|(_, p)| !is_shape(&p.0)).map_or(1.0, |(_, p)| p.1);
        let mut rank = 0;
        for (index, (term, promise, _)) in alike() {
            // Below this no linear step promises what a name would cost; far behind the best, none
            // will catch up.
            worth[index] = rank < FINALISTS
                && 0.5 * rows as f64 * -promise.min(1.0).ln() > LEAST_PROMISE
                && (rank < sure || *promise < best.sqrt());
            rank += usize::from(!is_shape(term));
        }
    }
    worth
}

fn by_score(trials: &mut [Trial]) {
    order::sort_by_key(trials, |t| t.promised);
    order::sort_by_key(trials, |t| -t.judged.as_ref().map_or(f64::NEG_INFINITY, Judged::score));
}
