//! From what was selected to a verdict: which effects stand, what is left, how well it fits.

use super::channel::{BAND_LIMIT, Channel, Fitted};
use super::check::{self, TOLERANCE};
use super::common::Common;
use super::jump::{self, Jump};
use super::selection::{ALPHA, Selected, correction};
use super::spectrum::{self, Law, Part};
use super::{Detail, describe, effects, location, plausible, sensor, telegraph, words};
use crate::diagnosis::candidate::Kind;
use crate::diagnosis::model;
use crate::diagnosis::verdict::{Effect, Fit, LogScore, Outcome, SCHEMA, Score, Source, Verdict, Whiteness};
use crate::diagnosis::{Detail as AnyDetail, Diagnosis, Ranked};
use crate::numerics::order;
use crate::parallel;
use crate::recording::Recording;

pub(super) struct Material<'a> {
    pub(super) recording: &'a Recording,
    pub(super) model: &'a model::Static,
    pub(super) channels: &'a [Channel],
    pub(super) selected: &'a [Selected],
    pub(super) common: Option<Common>,
    pub(super) findings: Vec<String>,
}

pub(super) fn conclude(material: Material<'_>) -> Diagnosis {
    let Material { recording, model, channels, selected, common, mut findings } = material;
    let unit = if model.unit.is_empty() { "unit" } else { &model.unit };
    let mut effects = Vec::new();
    let mut finals: Vec<Fitted> = selected.iter().map(|s| s.fitted.clone()).collect();
    if let Some(common) = &common {
        effects.push(effects::of_common(common, channels, &mut finals));
    }
    let shared =
        |i: usize| common.as_ref().is_some_and(|c| c.leader == i || c.followers.iter().any(|f| f.channel == i));
    for (i, channel) in channels.iter().enumerate() {
        effects.extend(effects::of_terms(channel, &selected[i], shared(i), unit));
        effects.extend(effects::of_level(channel, &finals[i], model.noise.as_ref(), unit));
        findings.extend(words::band_limit(channel, &finals[i]));
        findings.extend(plausible::level(channel, &finals[i], model.noise.as_ref()));
    }
    let count = channels.len() as f64;
    let before: Vec<Vec<f64>> =
        (0..channels.len()).map(|i| base_variances(&channels[i], &selected[i], model)).collect();
    let mut remainders: Vec<_> = channels.iter().zip(&finals).map(|(c, f)| check::remainder(c, f, TOLERANCE)).collect();
    let leaps: Vec<Option<Jump>> = channels.iter().zip(selected).map(|(c, s)| jump::alone(c, &s.fitted)).collect();
    for ((remainder, leap), channel) in remainders.iter_mut().zip(&leaps).zip(channels) {
        if let Some(leap) = leap {
            remainder.jump = Some(leap.at as f64 / channel.rate_hz);
            remainder.p_value = remainder.p_value.min(leap.p_value);
        }
    }
    // What channels share is a common cause, whatever its course.
    let alone: Vec<usize> = (0..channels.len()).filter(|i| !shared(*i)).collect();
    let hops: Vec<_> = parallel::map(&alone, |i| (*i, telegraph::hops(&channels[*i], &selected[*i].fitted)));
    for (i, found) in hops {
        remainders[i].telegraph = found.filter(|t| t.hops > 1 && t.p_value * count < ALPHA);
        remainders[i].p_value = remainders[i].telegraph.map_or(1.0, |t| t.p_value).min(remainders[i].p_value);
    }
    let leaps: Vec<bool> = leaps.iter().zip(&remainders).map(|(l, r)| l.is_some() || r.telegraph.is_some()).collect();
    let well: Vec<bool> = remainders.iter().zip(&leaps).map(|(r, l)| !l && r.p_value * count >= ALPHA).collect();
    let left = remainders.iter().map(|r| r.p_value).fold(1.0, f64::min) * count;
    let described = well.iter().all(|w| *w);
    let strict =
        || channels.iter().zip(&finals).map(|(c, f)| check::remainder(c, f, 0.0).p_value).fold(1.0, f64::min) * count;
    if described && strict() < ALPHA {
        findings.push(format!(
            "what is left differs from noise as modelled by more than chance, but by less than the {:.0} % of its power that \
             count as a mismatch here",
            100.0 * TOLERANCE
        ));
    }
    // What explains a drift by half while something foreign remains is a stand-in, in the channels where it remains. What
    // has a witness of its own stays, and so does a law that holds wherever it rules.
    effects.retain(|e| {
        let at: Vec<usize> = (0..channels.len()).filter(|i| e.channels.contains(&channels[*i].name)).collect();
        // What one jump, or hops between two levels, describe better is no drift.
        let leaps = effects::is_drift(&e.id) && at.iter().any(|i| leaps[*i]);
        !leaps
            && (at.iter().all(|i| well[*i])
                || at.iter().any(|i| effects::stands(e, &channels[*i], &finals[*i], &remainders[*i])))
    });
    order::sort_by_key(&mut effects, |e| -e.evidence.held_out_gain);
    let tied = effects.iter().any(|e| !e.confusable_with.is_empty());
    let outcome = match (described, effects.is_empty(), tied) {
        (false, _, _) => Outcome::Unexplained,
        (true, true, _) => Outcome::Adequate,
        (true, false, true) => Outcome::Undecidable,
        (true, false, false) => Outcome::Explained,
    };
    for (i, channel) in channels.iter().enumerate() {
        let named = |e: &Effect| e.id == "gauss-markov" && e.channels.contains(&channel.name);
        if effects.iter().any(named) {
            findings.extend(words::popcorn(channel, telegraph::power(channel, &finals[i], ALPHA / count)));
        }
    }
    let location = location::locate(channels, selected, &remainders, &well, unit);
    let ranking = ranking(channels, selected, &effects);
    let names = |i: usize| -> Vec<String> {
        effects.iter().filter(|e| e.channels.contains(&channels[i].name)).map(|e| e.id.clone()).collect()
    };
    let details =
        (0..channels.len()).map(|i| describe::detail(&channels[i], &before[i], &finals[i], names(i))).collect();
    let verdict = Verdict {
        schema: SCHEMA,
        kind: Kind::Static,
        verdict: outcome,
        sentence: words::sentence(outcome, &effects, &location.summary, channels, &well),
        recording: Source {
            file: recording.path.display().to_string(),
            sha256: recording.sha256.clone(),
            samples: recording.samples(),
            rate_hz: recording.rate_hz,
        },
        fit: fit(channels, selected, &finals, &before, unit),
        residual_after: Whiteness { white: described, p_value: left.min(1.0) },
        next_experiment: words::next_experiment(outcome, &effects, model),
        detectable: Vec::new(),
        location,
        effects,
        findings,
    };
    let repair = sensor::repair(channels, &finals, &verdict, model);
    let detail = Detail { unit: unit.into(), channels: details };
    Diagnosis { verdict, ranking, repair, detail: AnyDetail::Static(Box::new(detail)) }
}

/// What the base model says of every bin: the promised noise, else white noise at its best level.
fn base_variances(channel: &Channel, selected: &Selected, model: &model::Static) -> Vec<f64> {
    match &model.noise {
        None => selected.base.variances.clone(),
        Some(noise) => {
            let white = describe::white_of_density(channel, noise.density);
            spectrum::variances(&selected.base.bins, &[Law::White], &[white], &channel.promised)
        }
    }
}

fn fit(channels: &[Channel], selected: &[Selected], finals: &[Fitted], before: &[Vec<f64>], unit: &str) -> Fit {
    let count: f64 = channels.iter().map(|c| c.values.len() as f64).sum();
    let power = |values: &dyn Fn(usize) -> f64| -> f64 {
        ((0..channels.len()).map(|i| values(i) * channels[i].scale.powi(2)).sum::<f64>() / count).sqrt()
    };
    let noise_floor = power(&|i| finals[i].floor() * channels[i].values.len() as f64);
    let squares: Vec<[[f64; 2]; 2]> = channels.iter().zip(finals).map(|(c, f)| c.held_out_squares(f)).collect();
    // Each part is half of the recording.
    let part = |part: usize| Score {
        rmse_before: power(&|i| 2.0 * squares[i][part][0]),
        rmse_after: power(&|i| 2.0 * squares[i][part][1]),
        ratio_ci95: None,
    };
    let scale: f64 = channels.iter().map(|c| c.values.len() as f64 * c.scale.ln()).sum();
    let constant = -0.5 * count * std::f64::consts::TAU.ln() - scale;
    let score = |per_channel: f64| (per_channel + constant) / count;
    let before =
        (0..channels.len()).map(|i| spectrum::log_likelihood(&selected[i].base.bins, &before[i], Part::All)).sum();
    let after = (0..channels.len()).map(|i| finals[i].held_out(&channels[i].promised)).sum();
    Fit {
        unit: unit.into(),
        noise_floor,
        train: part(0),
        test: part(1),
        test_ranges: Vec::new(),
        log_score: Some(LogScore { before: score(before), after: score(after) }),
        one_step_rmse: None,
    }
}

fn ranking(channels: &[Channel], selected: &[Selected], effects: &[Effect]) -> Vec<Ranked> {
    let correction = correction(channels.len());
    let mut out: Vec<Ranked> = Vec::new();
    for (channel, selected) in channels.iter().zip(selected) {
        let best = selected.alone.iter().map(|t| t.gain).fold(f64::MIN_POSITIVE, f64::max);
        for tried in selected.alone.iter().filter(|t| t.id != BAND_LIMIT) {
            let named = effects.iter().any(|e| e.id == tried.id && e.channels.contains(&channel.name));
            // A share of a best that is itself chance says nothing.
            let gain = if tried.counts(correction) { tried.gain / best } else { 0.0 };
            out.push(Ranked {
                id: tried.id,
                channels: vec![channel.name.clone()],
                held_out_gain: gain,
                ci95: [f64::NEG_INFINITY, f64::INFINITY],
                p_value: (tried.p_value * correction).min(1.0),
                named,
                note: format!(
                    "alone: log-likelihood + {:.1}, share of the best; held out {}",
                    tried.gain / 2.0,
                    if tried.held_out > 0.0 { "better" } else { "no better" }
                ),
            });
        }
    }
    order::sort_by_key(&mut out, |r| -r.held_out_gain);
    order::sort_by_key(&mut out, |r| if r.named { 0.0 } else { 1.0 });
    out
}
