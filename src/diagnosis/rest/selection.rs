//! Which candidates a channel needs: stepwise forward by likelihood, checked on data held out, pruned backwards.

use std::f64::consts::TAU;

use super::channel::{Addition, BAND_LIMIT, Channel, Curve, Fitted, Term};
use super::laws::{self, Rivals};
use super::spectrum::Law;
use crate::numerics::order;
use crate::numerics::special::chi_squared_above;
use crate::progress;

/// Every candidate tried against a model, and the model with the best of those wanted.
pub(super) struct Tried {
    pub(super) standings: Vec<Standing>,
    pub(super) best: Option<(Standing, Fitted)>,
}

/// How well a candidate did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing {
    pub(super) id: &'static str,
    /// Twice the gain in log-likelihood.
    pub(super) gain: f64,
    /// Of that gain by chance, the search for its time constant or frequency included; not yet corrected for the number
    /// of candidates.
    pub(super) p_value: f64,
    /// Gain in log-likelihood on held-out coefficients, or share of the held-out mean square for curves.
    pub(super) held_out: f64,
    /// Free numbers, searched ones included.
    parameters: f64,
}

impl Standing {
    /// Akaike's criterion, turned so that more is better.
    pub(super) fn merit(&self) -> f64 {
        self.gain - 2.0 * self.parameters
    }

    pub(super) fn counts(&self, correction: f64) -> bool {
        self.p_value * correction < ALPHA && self.held_out > 0.0
    }
}

/// Corrected probability below which a candidate counts.
pub(super) const ALPHA: f64 = 0.004;
/// Candidates tried per channel.
const TRIED: f64 = 9.0;
/// Candidates whose merits differ by less are tied: so much chance does to a difference of likelihoods.
pub(super) const CLOSE: f64 = 4.0;
/// At most this many effects per channel.
const MOST: usize = 6;

/// What a channel needs, and how every candidate did alone.
pub(super) struct Selected {
    pub(super) base: Fitted,
    pub(super) fitted: Fitted,
    pub(super) alone: Vec<Standing>,
    /// Per term: corrected probability, share of the held-out gain, candidates that do as well.
    pub(super) evidence: Vec<(f64, f64, Vec<&'static str>)>,
}

/// Environment columns by name.
pub(super) type Environment = [(String, Curve)];

/// What every probability of a channel is multiplied by when `channels` are judged.
pub(super) fn correction(channels: usize) -> f64 {
    TRIED * channels as f64
}

/// Selects; `channels` corrects for their number.
pub(super) fn select(channel: &Channel, environment: &Environment, channels: usize) -> Selected {
    let correction = correction(channels);
    let base = channel.fit(Vec::new());
    let mut current = base.clone();
    let mut alone = Vec::new();
    let mut rivals: Rivals = Vec::new();
    for round in 0..MOST {
        // Whoever asked for the diagnosis hears of Ctrl-C from `rest::diagnose`.
        if progress::interrupted() {
            break;
        }
        let Tried { standings, best } = try_all(channel, &current, environment, |t| t.counts(correction));
        if round == 0 {
            alone.clone_from(&standings);
        }
        let Some((best, fitted)) = best else { break };
        let mut close: Vec<Standing> = standings
            .into_iter()
            .filter(|t| t.id != best.id && t.id != BAND_LIMIT && !contains(t.id, best.id))
            .filter(|t| best.merit() - t.merit() < CLOSE)
            .collect();
        order::sort_by_key(&mut close, |t| -t.merit());
        rivals.push((best.id, close.iter().map(|t| t.id).collect()));
        current = prune(channel, fitted, correction);
    }
    let (current, settled) = laws::settle(channel, current, correction);
    // Which of the slow laws: of the sums compared. All else: of the round in which it was taken.
    for (id, own) in settled {
        let before = rivals.iter().rev().find(|r| r.0 == id).map(|r| r.1.clone()).unwrap_or_default();
        let others = before.into_iter().filter(|r| !laws::SLOW.contains(r));
        rivals.push((id, own.into_iter().chain(others).collect()));
    }
    let evidence = evidence(channel, &base, &current, correction, &rivals);
    Selected { base, fitted: current, alone, evidence }
}

/// Per term of a model: corrected probability, share of the held-out gain, rivals.
pub(super) fn evidence(
    channel: &Channel,
    base: &Fitted,
    current: &Fitted,
    correction: f64,
    rivals: &Rivals,
) -> Vec<(f64, f64, Vec<&'static str>)> {
    let full = current.held_out(&channel.promised);
    let possible = (full - base.held_out(&channel.promised)).max(f64::MIN_POSITIVE);
    (0..current.terms.len())
        .map(|index| {
            let without = channel.fit(others(current, index));
            let gain = 2.0 * (current.log_likelihood() - without.log_likelihood());
            let p_value = (probability(&current.terms[index], gain, channel) * correction).min(1.0);
            let share = match current.terms[index].addition {
                Addition::Law(_) => ((full - without.held_out(&channel.promised)) / possible).clamp(0.0, 1.0),
                Addition::Curves(_) => channel.held_out_share(current, index),
            };
            let id = current.terms[index].id;
            let close = rivals.iter().rev().find(|r| r.0 == id).map(|r| r.1.clone()).unwrap_or_default();
            (p_value, share, close)
        })
        .collect()
}

/// Whether the richer candidate imitates the simpler one at the edge of its range: then the simpler one is preferred.
pub(super) fn contains(richer: &str, simpler: &str) -> bool {
    matches!((richer, simpler), ("warm-up", "rate-ramp") | ("gauss-markov", "random-walk"))
}

/// The terms of a model without one.
pub(super) fn others(fitted: &Fitted, index: usize) -> Vec<Term> {
    fitted.terms.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, t)| t.clone()).collect()
}

/// Drops what the others have made superfluous.
pub(super) fn prune(channel: &Channel, mut fitted: Fitted, correction: f64) -> Fitted {
    loop {
        let superfluous = (0..fitted.terms.len()).find_map(|index| {
            let without = channel.fit(others(&fitted, index));
            let gain = 2.0 * (fitted.log_likelihood() - without.log_likelihood());
            (probability(&fitted.terms[index], gain, channel) * correction > 0.05).then_some(without)
        });
        match superfluous {
            Some(without) => fitted = without,
            None => return fitted,
        }
    }
}

/// Whether a model would be worse, by more than chance, without any one of its terms.
pub(super) fn needs_all(channel: &Channel, fitted: &Fitted, correction: f64) -> bool {
    (0..fitted.terms.len()).all(|index| {
        let gain = 2.0 * (fitted.log_likelihood() - channel.fit(others(fitted, index)).log_likelihood());
        probability(&fitted.terms[index], gain, channel) * correction < ALPHA
    })
}

/// Of a gain at least this large by chance. A variance at its wall counts half (Self & Liang 1987); a searched number
/// multiplies by the independent places it was searched at.
fn probability(term: &Term, gain: f64, channel: &Channel) -> f64 {
    let gain = gain.max(0.0);
    let p = match (term.id, &term.addition) {
        ("gauss-markov", _) => 4.0 * chi_squared_above(gain, 2.0),
        ("sinusoid", _) => 2.0 * channel.values.len() as f64 * chi_squared_above(gain, 2.0),
        ("warm-up", _) => 5.0 * chi_squared_above(gain, 1.0),
        (BAND_LIMIT, _) => 1.5 * chi_squared_above(gain, 1.0),
        (_, Addition::Law(_)) => 0.5 * chi_squared_above(gain, 1.0),
        (_, Addition::Curves(curves)) => chi_squared_above(gain, curves.len() as f64),
    };
    p.min(1.0)
}

/// Every candidate that the model does not hold yet, each added to it. Only the best model `wanted` is kept: curves of a
/// long recording are large.
pub(super) fn try_all(
    channel: &Channel,
    current: &Fitted,
    environment: &Environment,
    wanted: impl Fn(&Standing) -> bool,
) -> Tried {
    let count = channel.values.len();
    let add = |term: Term| {
        let mut terms = current.terms.clone();
        terms.push(term);
        channel.fit(terms)
    };
    let before = current.log_likelihood();
    let held_out_before = current.held_out(&channel.promised);
    let mut tried = Tried { standings: Vec::new(), best: None };
    let mut found = |fitted: Fitted, parameters: f64| {
        let last = fitted.terms.len() - 1;
        let gain = 2.0 * (fitted.log_likelihood() - before);
        let held_out = match fitted.terms[last].addition {
            Addition::Law(_) => fitted.held_out(&channel.promised) - held_out_before,
            Addition::Curves(_) => channel.held_out_share(&fitted, last),
        };
        let p_value = probability(&fitted.terms[last], gain, channel);
        let standing = Standing { id: fitted.terms[last].id, gain, p_value, held_out, parameters };
        tried.standings.push(standing);
        if wanted(&standing) && tried.best.as_ref().is_none_or(|(best, _)| standing.merit() > best.merit()) {
            tried.best = Some((standing, fitted));
        }
    };
    let law = |id, law, searched| Term { id, addition: Addition::Law(law), searched, column: None };
    // Four laws beside white noise are all that one spectrum can tell apart.
    if current.laws().len() < 5 {
        for (id, of) in
            [("quantisation-noise", Law::Differenced), ("flicker-noise", Law::Flicker), ("random-walk", Law::Walk)]
        {
            if !current.has(id) {
                found(add(law(id, of, 0.0)), 1.0);
            }
        }
        if !current.has("gauss-markov") {
            let best = searched(1.5f64.ln(), (count as f64 / 4.0).ln(), 14, |m| {
                add(law("gauss-markov", Law::Markov(m.exp()), m.exp()))
            });
            found(best, 2.0);
        }
        if !current.has(BAND_LIMIT) {
            let powers = [1, 2, 4].map(|p| add(law(BAND_LIMIT, Law::Smoothed(p), f64::from(p))));
            let best = powers.into_iter().max_by(|a, b| a.log_likelihood().total_cmp(&b.log_likelihood()));
            if let Some(best) = best {
                found(best, 1.0);
            }
        }
    }
    let curve = |id, curves, searched| Term { id, addition: Addition::Curves(curves), searched, column: None };
    if !current.has("rate-ramp") {
        let ramp = Curve::new((0..count).map(|n| n as f64 / count as f64).collect());
        found(add(curve("rate-ramp", vec![ramp], 0.0)), 1.0);
    }
    if !current.has("warm-up") {
        let settle = |m: f64| (0..count).map(|n| (-(n as f64) / m).exp()).collect();
        let best = searched((0.01 * count as f64).ln(), (0.5 * count as f64).ln(), 9, |m| {
            add(curve("warm-up", vec![Curve::new(settle(m.exp()))], m.exp()))
        });
        found(best, 2.0);
    }
    if let Some(frequency) = strongest_line(channel, current) {
        let wave = |f: f64| {
            let part = |shift: f64| Curve::new((0..count).map(|n| (TAU * f * n as f64 + shift).sin()).collect());
            vec![part(0.0), part(TAU / 4.0)]
        };
        let half = 0.6 / count as f64;
        let best = searched(frequency - half, frequency + half, 7, |f| add(curve("sinusoid", wave(f), f)));
        found(best, 3.0);
    }
    for (name, column) in environment {
        if !current.terms.iter().any(|t| t.column.as_ref() == Some(name)) {
            let mut term = curve("temperature-sensitivity", vec![column.clone()], 0.0);
            term.column = Some(name.clone());
            found(add(term), 1.0);
        }
    }
    tried
}

/// The best of a grid, refined once between its neighbours.
pub(super) fn searched(from: f64, to: f64, points: usize, fit: impl Fn(f64) -> Fitted) -> Fitted {
    let step = (to - from) / (points - 1) as f64;
    let at = |i: f64| fit(from + i * step);
    let better = |a: &Fitted, b: &Fitted| a.log_likelihood().total_cmp(&b.log_likelihood());
    let grid = (0..points).take_while(|_| !progress::interrupted()).map(|i| (i as f64, at(i as f64)));
    let Some((mut centre, mut best)) = grid.max_by(|a, b| better(&a.1, &b.1)) else { return fit(from) };
    let mut width = 0.5;
    for _ in 0..5 {
        if progress::interrupted() {
            break;
        }
        for side in [-width, width] {
            let other = at((centre + side).clamp(0.0, (points - 1) as f64));
            if better(&other, &best).is_gt() {
                (centre, best) = ((centre + side).clamp(0.0, (points - 1) as f64), other);
                break;
            }
        }
        width /= 2.0;
    }
    best
}

/// Frequency (cycles per sample) where two neighbouring coefficients stand out most from the model and from their
/// neighbourhood; slower than three cycles is drift.
fn strongest_line(channel: &Channel, current: &Fitted) -> Option<f64> {
    let c = &current.residual;
    let count = c.len();
    let mut best = (0.0, 0);
    for (bin, variance) in current.bins.iter().zip(&current.variances) {
        for k in bin.from.max(6)..bin.to.min(count - 1) {
            let score = (c[k] * c[k] + c[k + 1] * c[k + 1]) / variance;
            if score > best.0 {
                best = (score, k);
            }
        }
    }
    let (score, k) = best;
    if k == 0 {
        return None;
    }
    let near = |i: usize| c[i] * c[i];
    let (from, to) = (k.saturating_sub(40).max(1), (k + 42).min(count));
    let around: f64 = (from..to).filter(|i| i.abs_diff(k) > 3).map(near).sum::<f64>() / (to - from).max(8) as f64;
    let local = (c[k] * c[k] + c[k + 1] * c[k + 1]) / around.max(f64::MIN_POSITIVE);
    let chance = 2.0 * channel.values.len() as f64 * chi_squared_above(local.min(score), 2.0);
    let share = near(k + 1).sqrt() / (near(k).sqrt() + near(k + 1).sqrt());
    (chance < 0.01).then_some((k as f64 + share) / (2 * count) as f64)
}
