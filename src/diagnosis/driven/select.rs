//! Which terms the recording asks for: screened by one linear step each, fitted together with the base, added while they
//! predict samples that were not fitted, dropped again when others have made them needless.

use rayon::prelude::*;

use crate::numerics::least_squares::Linear;
use crate::numerics::spectrum;
use crate::progress;

use super::filter::Nothing;
use super::fit::{Data, Fit, Run, Search, Shape, fit, innovations, trace};
use super::held_out::{Comparison, HeldOut, compare, held_out};
use super::term::{LANES, Scales, Term};

/// Candidates that are fitted in full in one round; the rest stop at the linear step.
const FINALISTS: usize = 6;
/// Starts of one candidate that are fitted in full.
const STARTS: usize = 2;
/// Most terms in a model.
const MOST_TERMS: usize = 6;
/// Probability that a recording without any effect is given one.
const FALSE_ALARM: f64 = 0.005;
/// Smallest share of the one-step error that is worth a name: below it, the simulation's own errors begin.
pub const SMALLEST_GAIN: f64 = 0.005;
/// Iterations of one fit.
const ITERATIONS: usize = 20;

/// A model with its record.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The fit.
    pub fit: Fit,
    /// Its errors on the test samples.
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
}

/// Judges a fit.
pub fn judge(data: &Data, fit: Fit, scales: &Scales) -> Judged {
    let held_out = held_out(data, &fit, scales);
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
    stands.sort_by(|a, b| b.0.total_cmp(&a.0));
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
fn screen(data: &Data, model: &Fit, term: Term, scales: &Scales) -> Vec<(f64, Vec<f64>)> {
    let starts = term.starts(scales);
    let own = term.parameters();
    let Some(first) = starts.first() else { return Vec::new() };
    let (shape, point) = model.with(term, first);
    let search = Search::all(data, &shape, &point, scales);
    let steps = starts.iter().map(|s| shape.steps(&model.with(term, s).1, scales)).max().unwrap_or(model.steps);
    let mut points = Vec::new();
    for start in &starts {
        let (_, point) = model.with(term, start);
        let z = search.z(&point);
        points.push(search.point(&z));
        for j in 0..own {
            let mut moved = z.clone();
            let index = moved.len() - own + j;
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
            let mut columns = model.linear.columns.clone();
            for moved in &group[1..] {
                columns.push(moved.iter().zip(&group[0]).map(|(m, e)| (m - e) / 1e-4).collect());
            }
            (Linear { residual: group[0].clone(), columns }.normal().predicted(), start)
        })
        .collect();
    promises.sort_by(|a, b| a.0.total_cmp(&b.0));
    promises
}

/// Tries every candidate on top of a model: all by one linear step, the most promising in full. Best first.
pub fn round(data: &Data, model: &Judged, candidates: &[Term], scales: &Scales, finalists: usize) -> Vec<Trial> {
    let sum = model.fit.linear.normal().sum.max(1e-300);
    let mut promised: Vec<(Term, f64, Vec<Vec<f64>>)> = candidates
        .par_iter()
        .filter(|t| !progress::interrupted() && t.parameters() > 0)
        .map(|term| {
            if term.noise().is_some() {
                return (*term, 0.0, term.starts(scales));
            }
            let promises = screen(data, &model.fit, *term, scales);
            let best = promises.first().map_or(f64::INFINITY, |p| p.0 / sum);
            (*term, best, promises.into_iter().take(STARTS).map(|p| p.1).collect())
        })
        .collect();
    promised.sort_by(|a, b| a.1.total_cmp(&b.1));
    let noises = promised.iter().filter(|p| p.0.noise().is_some()).count();
    let mut trials: Vec<Trial> = promised
        .par_iter()
        .enumerate()
        .map(|(rank, (term, promised, starts))| {
            let nothing = Comparison { gain: 0.0, ci95: [-1.0, 1.0], p_value: 1.0 };
            let mut trial = Trial { term: *term, promised: *promised, judged: None, comparison: nothing };
            if rank >= finalists + noises || progress::interrupted() {
                return trial;
            }
            let best = starts
                .iter()
                .filter_map(|start| {
                    let (shape, point) = model.fit.with(*term, start);
                    fit(data, &shape, &point, scales, ITERATIONS)
                })
                .min_by(|a, b| a.variance.total_cmp(&b.variance));
            if let Some(found) = best {
                let judged = judge(data, found, scales);
                trial.comparison = compare(&model.held_out, &judged.held_out);
                trial.judged = Some(judged);
            }
            trial
        })
        .collect();
    trials.sort_by(|a, b| {
        let score = |t: &Trial| t.judged.as_ref().map_or(f64::NEG_INFINITY, Judged::score);
        score(b).total_cmp(&score(a)).then(a.promised.total_cmp(&b.promised))
    });
    trials
}

/// Whether a richer model has earned its terms against a poorer one.
pub fn earned(poorer: &Judged, richer: &Judged, comparison: &Comparison, tried: usize) -> bool {
    let price = 3.0 + (tried.max(1) as f64).ln();
    richer.score() > poorer.score() + price
        && comparison.gain >= SMALLEST_GAIN
        && comparison.p_value < FALSE_ALARM / tried.max(1) as f64
}

/// Stepwise forward, with backward pruning after every step.
pub fn search(data: &Data, base: Judged, scales: &Scales, candidates: &[Term]) -> Selection {
    let bar = progress::bar("candidates", MOST_TERMS as u64);
    let tried = candidates.len();
    let mut chosen = base.clone();
    let mut alone = Vec::new();
    for step in 0..=MOST_TERMS {
        let here = refined(data, &chosen.fit, scales);
        let open: Vec<Term> = candidates.iter().copied().filter(|t| !chosen.has(t.id())).collect();
        let trials = round(data, &chosen, &open, &here, FINALISTS);
        let best = trials
            .iter()
            .filter_map(|t| t.judged.as_ref().map(|j| (t, j)))
            .take(4)
            .find(|(t, j)| earned(&chosen, j, &t.comparison, tried))
            .map(|(_, j)| j.clone());
        if step == 0 {
            alone = trials;
        }
        bar.inc(1);
        let Some(best) = best else { break };
        chosen = pruned(data, best, scales, tried);
        if chosen.fit.shape.terms.len() >= MOST_TERMS || progress::interrupted() {
            break;
        }
    }
    bar.finish_and_clear();
    Selection { base, chosen, alone, tried }
}

/// Drops every term whose absence costs nothing, the cheapest first.
fn pruned(data: &Data, mut model: Judged, scales: &Scales, tried: usize) -> Judged {
    while model.fit.shape.terms.len() > 1 {
        let poorer: Vec<Judged> = (0..model.fit.shape.terms.len())
            .into_par_iter()
            .filter_map(|i| without(data, &model, i, scales))
            .collect();
        let cheapest = poorer
            .into_iter()
            .filter(|p| !earned(p, &model, &compare(&p.held_out, &model.held_out), tried))
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
