//! The figures of a verdict at rest: how well it fits, and how every candidate stands.

use super::candidate::row;
use super::channel::{Channel, Fitted};
use super::effects::Found;
use super::selection::Selection;
use super::spectrum::{self, Part};
use super::standing::correction;
use crate::numerics::order;
use crate::standing::{Gain, Note, Ranked};
use crate::verdict::{Fit, LogScore, Score};

/// Errors on either half of the recording and the log-likelihood, with the base model's `before`
/// per bin.
pub(super) fn fit(
    channels: &[Channel],
    selected: &[Selection],
    finals: &[Fitted],
    before: &[Vec<f64>],
    unit: &str,
) -> Fit {
    let count: f64 = channels.iter().map(|c| c.values.len() as f64).sum();
    let power = |values: &dyn Fn(usize) -> f64| -> f64 {
        ((0..channels.len()).map(|i| values(i) * channels[i].scale.powi(2)).sum::<f64>() / count).sqrt()
    };
    let noise_floor = power(&|i| finals[i].floor() * channels[i].values.len() as f64);
    let squares: Vec<[[f64; 2]; 2]> = channels.iter().zip(finals).map(|(c, f)| c.held_out_squares(f)).collect();
    // Each part is half of the recording.
    let part = |part: usize| Score {
        rmse_before: power(&|i| 2.0 * squares[i][part][0]),
        rmse_after: Some(power(&|i| 2.0 * squares[i][part][1])),
        ratio_ci95: None,
        share: None,
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
        noise: None,
        train: part(0),
        test: part(1),
        test_ranges: Vec::new(),
        recordings: Vec::new(),
        log_score: Some(LogScore { before: score(before), after: score(after) }),
        with_unnamed: None,
        one_step_rmse: None,
    }
}

/// Every candidate's standing alone, channel by channel; those named first.
pub(super) fn ranking(channels: &[Channel], selected: &[Selection], effects: &[Found]) -> Vec<Ranked> {
    let correction = correction(channels.len());
    let mut out: Vec<Ranked> = Vec::new();
    for (i, (channel, selection)) in channels.iter().zip(selected).enumerate() {
        let possible = selection.possible(channel);
        let entries = selection.alone.iter().filter_map(|s| Some((s, row(s.cause).entry?)));
        out.extend(entries.map(|(standing, entry)| Ranked {
            id: entry.id,
            channels: vec![channel.name.clone()],
            gain: Gain::HeldOut { value: standing.held_out.share_of(possible), ci95: None },
            p_value: (standing.p_value * correction).min(1.0),
            named: effects.iter().any(|e| e.is(standing.cause, i)),
            note: Note::AloneByLikelihood { gain: standing.gain / 2.0, held_out_better: standing.held_out.is_better() },
        }));
    }
    order::sort_by_key(&mut out, |r| -r.gain.value());
    order::sort_by_key(&mut out, |r| if r.named { 0.0 } else { 1.0 });
    out
}
