//! Which terms the recording asks for: screened by one linear step each, fitted together with the base, worth a place where
//! they predict samples that were not fitted, dropped again when others have made them needless. Not the order in which they
//! are added (`stepwise`).

use crate::numerics::least_squares::Linear;
use crate::numerics::order;
use crate::numerics::spectrum;
use crate::parallel;
use crate::progress;

use super::ensemble::Ensemble;
use super::filter::Nothing;
use super::fit::{Data, Fit, Run, Search, Shape, fit, innovations, trace};
use super::folds::{Fold, turned};
use super::held_out::{Comparison, HeldOut, compare, held_out};
use super::rivals::Rival;
use super::term::{LANES, Scales, Term};

/// Candidates that are fitted in full in one round; the rest stop at the linear step.
const FINALISTS: usize = 6;
/// Starts of one candidate that are fitted in full.
const STARTS: usize = 2;
/// The same where its law has a corner, so that valleys are many.
const CORNER_STARTS: usize = 4;
/// Candidates that are fitted whatever the best one promises.
pub const SURE: usize = 3;
/// Log-likelihood that a candidate must promise to be fitted.
const LEAST_PROMISE: f64 = 8.0;
/// Candidates that are fitted to the end in one round.
const POLISHED: usize = 3;
/// Level of the test on validation samples. Only the few candidates that are best on the fitted samples come before it, at a
/// price there of ln(tried), so that no further correction is due.
const LEVEL: f64 = 0.002;
/// Smallest share of the one-step error that is worth a name: below it, the simulation's own errors begin.
pub const SMALLEST_GAIN: f64 = 0.005;
/// Lead on the fitted samples at which validation samples that show nothing are doubted: what is rare may have missed them.
const DOUBT: f64 = 25.0;
/// Iterations after which the laggards are left behind.
const HEAT: usize = 3;
/// Iterations of one fit.
const ITERATIONS: usize = 14;

/// A model with its record.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The fit.
    pub fit: Fit,
    /// Its errors on the validation samples.
    pub held_out: HeldOut,
}

impl Judged {
    /// Log-likelihood less the price of its terms' parameters (Schwarz 1978).
    pub fn score(&self) -> f64 {
        let n = self.fit.linear.residual.len().max(2) as f64;
        self.fit.log_likelihood() - 0.5 * self.fit.free.len() as f64 * n.ln()
    }

    /// Whether a term with this id is in it.
    pub fn has(&self, id: &str) -> bool {
        self.fit.shape.terms.iter().any(|t| t.id() == id)
    }
}

/// One candidate's trial against a model.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The candidate.
    pub term: Term,
    /// Sum of squares that one linear step promised, relative to the model's.
    pub promised: f64,
    /// The fit with it, where it came that far.
    pub judged: Option<Judged>,
    /// Against the model without it.
    pub comparison: Comparison,
}

/// What a search leaves.
#[derive(Debug, Clone)]
pub struct Selection {
    /// The base model.
    pub base: Judged,
    /// The model chosen; the base where nothing was.
    pub chosen: Judged,
    /// Each candidate alone against the base, best first.
    pub alone: Vec<Trial>,
    /// Candidates that were tried.
    pub tried: usize,
    /// For each term of the chosen model, the candidates that would do as well in its place.
    pub rivals: Vec<Vec<Rival>>,
    /// Whether the search ended because its work was spent, with structure left.
    pub cut_short: bool,
    /// Whether some of those candidates were not tried because the work for it was spent.
    pub rivals_left_out: bool,
}

/// Judges a fit.
pub fn judge(data: &Data, fit: Fit, scales: &Scales) -> Judged {
    let held_out = held_out(data, &fit, scales, &data.validation);
    Judged { fit, held_out }
}

/// Sizes after the base (or a better model) has been fitted.
pub fn refined(data: &Data, fit: &Fit, scales: &Scales) -> Scales {
    let (innovations, states) = trace(data, &fit.shape, &fit.point, &fit.run(data, true));
    let mut scales = scales.clone();
    scales.velocity = super::start::spread(&states.v).1.max(1e-300);
    scales.residual = fit.variance.sqrt().max(1e-300);
    scales.lines_hz = lines(&innovations, data.rate_hz);
    scales
}

/// Frequencies at which a sequence's spectrum stands out most from its neighbourhood, strongest first.
fn lines(values: &[f64], rate_hz: f64) -> Vec<f64> {
    let raw = spectrum::periodogram(values, rate_hz);
    let count = raw.density.len();
    if count < 64 {
        return Vec::new();
    }
    // Against the mean of a neighbourhood, so that a broad hill does not hide a narrow line.
    let mut sums = vec![0.0; count + 1];
    for (i, v) in raw.density.iter().enumerate() {
        sums[i + 1] = sums[i] + v;
    }
    let reach = (count / 200).max(10);
    let mut stands: Vec<(f64, usize)> = (0..count)
        .map(|i| {
            let (a, b) = (i.saturating_sub(reach), (i + reach + 1).min(count));
            (raw.density[i] / ((sums[b] - sums[a]) / (b - a) as f64).max(1e-300), i)
        })
        .collect();
    order::sort_by_key(&mut stands, |s| -s.0);
    let mut chosen: Vec<usize> = Vec::new();
    // The highest density itself, and then what stands out locally.
    if let Some((i, _)) = raw.density.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) {
        chosen.push(i);
    }
    for (_, i) in stands {
        if chosen.len() >= 4 {
            break;
        }
        if !chosen.iter().any(|c| c.abs_diff(i) < reach) {
            chosen.push(i);
        }
    }
    chosen.into_iter().map(|i| raw.frequency_hz[i]).collect()
}

/// The start of a term from which one linear step promises most, and what it promises.
fn screen(
    data: &Data,
    model: &Fit,
    ensemble: Option<&Ensemble<'_>>,
    term: Term,
    scales: &Scales,
) -> Vec<(f64, Vec<f64>)> {
    let found = ensemble.and_then(|e| e.starts(term, scales, CORNER_STARTS)).filter(|s| !s.is_empty());
    let starts = found.unwrap_or_else(|| term.starts(scales));
    // The strength of a noise is only looked at from its starts: it bends every derivative of the base.
    let own = if term.noise().is_some() { 0 } else { term.parameters() };
    let Some(first) = starts.first() else { return Vec::new() };
    let (shape, point) = model.with(term, first);
    let search = Search::all(data, &shape, &point, scales);
    let steps =
        starts.iter().map(|s| shape.coarse_steps(&model.with(term, s).1, scales)).max().unwrap_or(1).max(model.steps);
    let mut points = Vec::new();
    for start in &starts {
        let (_, point) = model.with(term, start);
        let z = search.z(&point);
        points.push(search.point(&z));
        for j in 0..own {
            let mut moved = z.clone();
            let index = moved.len() - term.parameters() + j;
            moved[index] += 1e-4;
            points.push(search.point(&moved));
        }
    }
    let run = Run { range: data.hull.clone(), steps, corrected: true };
    let rows: Vec<usize> = data.train.iter().flat_map(|r| r.clone()).map(|k| k - data.hull.start).collect();
    let traces: Vec<Vec<f64>> = points
        .chunks(LANES)
        .flat_map(|group| {
            let lanes = innovations(data, &shape, group, &run, &mut Nothing);
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

/// Tries every candidate on top of a model: all by one linear step, the most promising in full. Best first.
/// At least `sure` of them are fitted, whatever the best promises.
pub fn round(data: &Data, model: &Judged, candidates: &[Term], scales: &Scales, sure: usize) -> Vec<Trial> {
    let sum = model.fit.linear.normal().sum.max(1e-300);
    let ensemble = Ensemble::around(data, &model.fit, scales);
    let mut promised: Vec<(Term, f64, Vec<Vec<f64>>)> = parallel::filter_map(candidates, |term| {
        if progress::interrupted() || term.parameters() == 0 {
            return None;
        }
        let promises = screen(data, &model.fit, ensemble.as_ref(), *term, scales);
        let best = promises.first().map_or(f64::INFINITY, |p| p.0 / sum);
        let starts = if term.has_corner() { CORNER_STARTS } else { STARTS };
        Some((*term, best, promises.into_iter().take(starts).map(|p| p.1).collect()))
    });
    order::sort_by_key(&mut promised, |p| p.1);
    let worth = worth_fitting(&promised, model.fit.linear.residual.len(), sure);
    let mut trials: Vec<Trial> = parallel::map_indices(promised.len(), |i| {
        let (term, promised, starts) = &promised[i];
        let nothing = Comparison { gain: 0.0, ci95: [-1.0, 1.0], p_value: 1.0 };
        let mut trial = Trial { term: *term, promised: *promised, judged: None, comparison: nothing };
        if !worth[i] || progress::interrupted() {
            return trial;
        }
        let best = starts
            .iter()
            .filter_map(|start| {
                let (shape, point) = model.fit.with(*term, start);
                fit(data, &shape, &point, scales, HEAT)
            })
            .min_by(|a, b| a.variance.total_cmp(&b.variance));
        trial.judged = best.map(|found| judge(data, found, scales));
        trial
    });
    by_score(&mut trials);
    parallel::for_each_mut(&mut trials, |rank, trial| {
        let Some(judged) = &mut trial.judged else { return };
        if rank < POLISHED
            && !judged.fit.converged
            && let Some(found) = fit(data, &judged.fit.shape, &judged.fit.point, scales, ITERATIONS)
        {
            *judged = judge(data, found, scales);
        }
        trial.comparison = compare(&model.held_out, &judged.held_out);
    });
    by_score(&mut trials);
    trials
}

/// Which candidates, best promise first, are fitted in full. Noise corrects itself and so promises more than any law of motion
/// can at first: the two are ranked apart.
fn worth_fitting(promised: &[(Term, f64, Vec<Vec<f64>>)], rows: usize, sure: usize) -> Vec<bool> {
    let mut worth = vec![false; promised.len()];
    for noise in [false, true] {
        let alike = || promised.iter().enumerate().filter(|(_, p)| p.0.noise().is_some() == noise);
        let best = alike().next().map_or(1.0, |(_, p)| p.1);
        for (rank, (index, (_, promise, _))) in alike().enumerate().take(FINALISTS) {
            // Below this no linear step promises what a name would cost; far behind the best, none will catch up.
            worth[index] =
                0.5 * rows as f64 * -promise.min(1.0).ln() > LEAST_PROMISE && (rank < sure || *promise < best.sqrt());
        }
    }
    worth
}

fn by_score(trials: &mut [Trial]) {
    order::sort_by_key(trials, |t| t.promised);
    order::sort_by_key(trials, |t| -t.judged.as_ref().map_or(f64::NEG_INFINITY, Judged::score));
}

/// What speaks for a richer model that has earned its terms against a poorer one: the validation samples, or where these show
/// less than the fitted ones, all samples in turn.
pub fn earned(data: &Data, poorer: &Judged, richer: &Judged, scales: &Scales, tried: usize) -> Option<Comparison> {
    let least = if richer.fit.shape.terms.len() > 2 { 4.0 * SMALLEST_GAIN } else { SMALLEST_GAIN };
    let lead = richer.score() - poorer.score() - (tried.max(1) as f64).ln();
    let convinces = |c: &Comparison| c.gain >= least && c.p_value < LEVEL;
    let plain = compare(&poorer.held_out, &richer.held_out);
    if lead <= 3.0 || convinces(&plain) {
        return (lead > 3.0).then_some(plain);
    }
    let in_turn = if lead > DOUBT { in_turn(data, poorer, richer, scales) } else { None };
    in_turn.filter(convinces)
}

/// Compares two models on all samples, each third predicted from the others.
fn in_turn(data: &Data, poorer: &Judged, richer: &Judged, scales: &Scales) -> Option<Comparison> {
    let mut both = [poorer.held_out.clone(), richer.held_out.clone()];
    for Fold { train, validation } in turned(data) {
        let data = Data { train, validation, ..data.clone() };
        for (all, model) in both.iter_mut().zip([poorer, richer]) {
            let here = fit(&data, &model.fit.shape, &model.fit.point, scales, ITERATIONS)?;
            all.blocks.extend(held_out(&data, &here, scales, &data.validation).blocks);
        }
    }
    Some(compare(&both[0], &both[1]))
}

/// Drops every term whose absence costs nothing, the cheapest first.
pub fn pruned(data: &Data, mut model: Judged, scales: &Scales, tried: usize) -> Judged {
    while model.fit.shape.terms.len() > 1 {
        let poorer = parallel::map_indices(model.fit.shape.terms.len(), |i| without(data, &model, i, scales));
        let cheapest = poorer
            .into_iter()
            .flatten()
            .filter(|p| earned(data, p, &model, scales, tried).is_none())
            .max_by(|a, b| a.score().total_cmp(&b.score()));
        match cheapest {
            Some(poorer) => model = poorer,
            None => break,
        }
    }
    model
}

/// A model refitted without one of its terms.
pub fn without(data: &Data, model: &Judged, index: usize, scales: &Scales) -> Option<Judged> {
    let (shape, point): (Shape, Vec<f64>) = model.fit.without(index);
    Some(judge(data, fit(data, &shape, &point, scales, ITERATIONS)?, scales))
}
