//! States what a recording in which nothing is named could have shown: for each candidate the
//! smallest strength that would have been named, and which candidates it could not have
//! distinguished.
//!
//! From the base model's fit, linearised: what a candidate does to the reading, less what refitted
//! base parameters would hide of it, must rise above the noise by what the selection asks for. A
//! forecast from one recording, not a trial: `trial --like` plants and counts. Noise terms,
//! rounding and contacts are left out: no derivative shows when they begin to show.

use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::selection::earned::LEVEL;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::numerics::least_squares::Linear;
use crate::numerics::{order, special};
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};
use crate::physics::state::LANES;
use crate::verdict::Detectable;

use super::effects::{Channels, parameter_unit};

/// Share of the recordings in which such an effect would be named.
const POWER: f64 = 0.9;
/// Shapes of one candidate that are looked at (frequencies, yields, time constants).
const SHAPES: usize = 4;
/// Signatures more alike than this are indistinguishable.
const ALIKE: f64 = 0.95;
/// A strength small enough for a derivative, in typical ones.
const SMALL: f64 = 0.01;

/// Limits of what could have been seen.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Limits {
    /// Root-mean-square, over the noise, that an effect must leave after the base model is
    /// refitted.
    pub least_over_noise: f64,
    /// Candidate by candidate, in the library's order.
    pub candidates: Vec<Detectable>,
    /// Pairs whose signatures could not have been distinguished.
    pub indistinguishable: Vec<[&'static str; 2]>,
}

/// Signature of one candidate in the training rows, less what the base model hides of it.
struct Signature {
    term: Term,
    /// Index of its parameter that is its strength.
    parameter: usize,
    /// The strength it is given for.
    strength: f64,
    /// Root mean square of what it does before the base is refitted.
    raw: f64,
    /// Rest after the base is refitted, row by row.
    rows: Vec<f64>,
    /// Root mean square of that.
    residual: f64,
}

/// Limits of detection around a base model that leaves noise.
pub(super) fn limits(data: &Data, base: &Fit, scales: &Scales, candidates: &[Term], channels: &Channels) -> Limits {
    let (rows, judging) =
        (base.linear.residual.len() as f64, data.validation.iter().map(|r| r.len()).sum::<usize>() as f64);
    let noise = base.variance.sqrt();
    let z = |probability: f64| special::normal_quantile(probability);
    // By the penalty of a parameter, and by the test on validation samples.
    let penalty = 3.0 + (candidates.len().max(1) as f64).ln() + 0.5 * rows.ln();
    let least = (((2.0 * penalty).sqrt() + z(POWER)) / rows.sqrt())
        .max(2.0 * (z(1.0 - LEVEL) + z(POWER)) / judging.max(1.0).sqrt());
    let found: Vec<Signature> =
        parallel::map(candidates, |term| signatures(data, base, scales, *term)).into_iter().flatten().collect();
    let mut limits = Limits { least_over_noise: least, ..Limits::default() };
    for s in &found {
        let strength = if s.residual > 1e-6 * s.raw { s.strength * least * noise / s.residual } else { f64::INFINITY };
        let parameter = s.term.candidate().parameters[s.parameter];
        limits.candidates.push(Detectable {
            id: s.term.id().to_owned(),
            parameter: parameter.name.to_owned(),
            strength: Some(strength).filter(|v| v.is_finite()),
            unit: parameter_unit(&s.term, s.parameter, channels),
            effect_over_noise: Some(least * s.raw / s.residual).filter(|v| v.is_finite()),
            hidden_share: 1.0 - (s.residual / s.raw).powi(2).min(1.0),
        });
    }
    for (i, a) in found.iter().enumerate() {
        for b in &found[i + 1..] {
            let product: f64 = a.rows.iter().zip(&b.rows).map(|(x, y)| x * y).sum::<f64>() / rows;
            let seen = a.residual > 1e-6 * a.raw && b.residual > 1e-6 * b.raw;
            if a.term.id() != b.term.id() && seen && product.abs() > ALIKE * a.residual * b.residual {
                limits.indistinguishable.push([a.term.id(), b.term.id()]);
            }
        }
    }
    limits.indistinguishable.dedup();
    limits
}

/// Its signature for each parameter that is a strength; of several shapes the middle one.
fn signatures(data: &Data, base: &Fit, scales: &Scales, term: Term) -> Vec<Signature> {
    if term.noise().is_some()
        || matches!(term, Term::ReadoutQuantisation(_) | Term::EndStop(_) | Term::ReadoutSaturation(_))
    {
        return Vec::new();
    }
    let starts = term.starts(scales);
    let step = starts.len().div_ceil(SHAPES).max(1);
    let starts: Vec<Vec<f64>> = starts.into_iter().step_by(step).collect();
    let strengths = if matches!(term, Term::ReadoutNonlinearity(_)) { 2 } else { 1 };
    (0..strengths)
        .filter_map(|parameter| {
            let coordinate = term.coordinates(scales)[parameter];
            let mut shapes: Vec<Signature> = starts
                .iter()
                .filter_map(|start| {
                    let strength = match coordinate {
                        Coordinate::Linear(scale) | Coordinate::Bounded(scale, ..) => SMALL * scale,
                        Coordinate::Log(..) | Coordinate::Held => start[parameter],
                    };
                    let mut values = start.clone();
                    values[parameter] = strength;
                    signature(data, base, scales, term, &values).map(|(raw, rows, residual)| Signature {
                        term,
                        parameter,
                        strength,
                        raw,
                        rows,
                        residual,
                    })
                })
                .collect();
            order::sort_by_key(&mut shapes, |s| s.strength / s.residual);
            let middle = shapes.len() / 2;
            (!shapes.is_empty()).then(|| shapes.swap_remove(middle))
        })
        .collect()
}

/// Returns what a term with these parameters does to the training rows: its size, what the base
/// cannot hide, the size of that.
fn signature(data: &Data, base: &Fit, scales: &Scales, term: Term, values: &[f64]) -> Option<(f64, Vec<f64>, f64)> {
    let (structure, point) = base.with(term, values);
    let steps = structure.coarse_steps(&point, scales).max(base.steps);
    let run = Run { range: data.hull.clone(), steps, corrected: true };
    let errors = |structure, point: &Vec<f64>| -> Vec<f64> {
        let lanes: Vec<[f64; LANES]> = innovations(data, structure, std::slice::from_ref(point), &run, &mut Nothing);
        data.train.iter().flat_map(|r| r.clone()).map(|k| lanes[k - data.hull.start][0]).collect()
    };
    let (with, without) = (errors(&structure, &point), errors(&base.structure, &base.point));
    let moved: Vec<f64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
    let n = moved.len() as f64;
    let size = |rows: &[f64]| (rows.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
    let raw = size(&moved);
    if !(raw > 0.0 && raw.is_finite()) {
        return None;
    }
    let linear = Linear { residual: moved, columns: base.linear.columns.clone() };
    let step = linear.normal().step(1e-9);
    let mut rows = linear.residual;
    for (column, s) in linear.columns.iter().zip(step.iter()) {
        rows.iter_mut().zip(column).for_each(|(row, c)| *row += c * s);
    }
    let residual = size(&rows);
    Some((raw, rows, residual))
}
