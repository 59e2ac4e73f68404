//! The public answer: verdict, ranking, repair and the numbers behind the figures.

use std::ops::Range;

use crate::answer::{self, Answer, Places};
use crate::candidate::Kind;
use crate::driven::base::{OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::identification::profile;
use crate::driven::intake::data::Data;
use crate::driven::intake::notes::Notes;
use crate::driven::intake::reading_noise::{ReadingNoise, Sample, reading_noise};
use crate::driven::intake::several::Piece;
use crate::driven::selection::held_out::{Block, HeldOut, for_free_simulation, ratio_interval, with_state_at};
use crate::driven::selection::judged::{Judged, Selection};
use crate::driven::selection::term_worth::Named;
use crate::driven::simulation::filter::States;
use crate::driven::simulation::run::{Run, trace};
use crate::numerics::moments;
use crate::physics::library::{CANDIDATES, Term};
use crate::physics::scales::Scales;
use crate::remainder::Size;
use crate::verdict::{
    Fit as Fitted, Form, LogScore, Noise, Outcome, RangeScore, RecordingInfo, RecordingScore, Role, Score, WithUnnamed,
};

use super::asked::Asked;
use super::conclude::Conclusion;
use super::detail::{Account, Detail, Shown};
use super::detectable::{Limits, limits};
use super::dropped::Dropped;
use super::effects::{self, Channels};
use super::findings;
use super::form::{self, Freely};
use super::isolation::{Compared, locate};
use super::noise_words::how;
use super::residual_tests::WHITE;
use super::sensitivity::sensitivity;
use super::sensor::repair;
use super::stated::{stated, unnamed};
use super::surface::{FreeRun, Surface, surface};

/// Periods of the resonance that a look at both models spans, and the samples that it has at least
/// and at most.
const PERIODS: f64 = 8.0;
const LEAST_SHOWN: usize = 100;
const MOST_SHOWN: usize = 600;
/// Cells of the restoring-force surface that the verdict lists.
const CELLS_SHOWN: usize = 32;

/// The complete answer: verdict, ranking, repair and figure data.
pub fn answer(
    asked: &Asked<'_>,
    data: &Data,
    scales: &Scales,
    selection: &Selection,
    c: &Conclusion,
    mut notes: Notes,
) -> Answer {
    let Asked { recording, pieces, judging, columns, unit } = *asked;
    let output = columns.output.clone();
    let output_unit = unit.map_or_else(|| effects::unit_of(recording, &output, "output unit"), str::to_owned);
    let input_unit =
        columns.input.as_deref().map_or_else(String::new, |i| effects::unit_of(recording, i, "input unit"));
    let units = data.followed.iter().map(|kept| effects::unit_of(recording, &kept.heading, "environment unit"));
    let environment_units = units.collect();
    let channels = Channels { output: output.clone(), output_unit: output_unit.clone(), input_unit, environment_units };
    let forms = forms(data, c, scales);
    let named = effects::effects(data, c, selection, scales, &channels, &forms);
    let ranking = effects::ranking(data, c, selection, &channels);
    let free = |fit: &Fit| trace(data, &fit.structure, &for_free_simulation(data, fit, scales), &fit.run(data, false));
    let (before, states) = free(&c.base.fit);
    let (after, repaired) = free(&c.model.fit);
    let missing = |fit: &Fit, error: &[f64], states: &States| {
        let (omega_rad_s, zeta) = (fit.point[OMEGA], fit.point[ZETA]);
        surface(&FreeRun { error, x: &states.x, v: &states.v, omega_rad_s, zeta, rate_hz: data.rate_hz })
    };
    let surfaces = [missing(&c.base.fit, &before, &states), missing(&c.model.fit, &after, &repaired)];
    let (innovations, _) = trace(data, &c.model.fit.structure, &c.model.fit.point, &c.model.fit.run(data, true));
    let errors = [before.as_slice(), after.as_slice()];
    let noise = reading_noise(&Sample::of(data));
    let (places, place, at_noise) = located(data, errors, noise, &states.x, &surfaces[0], &output_unit);
    let mut base = effects::base(c, scales, &channels);
    base.extend(sensitivity(c, scales, &channels).filter(|_| scales.at_once));
    if data.input.is_none() && c.named.is_empty() {
        notes.may_be_steady(&base);
    }
    let Notes { mut findings, doubts, broken, .. } = notes;
    findings.extend(doubtful(c));
    findings.extend(findings::noise(&c.noise, data.rate_hz));
    findings.extend(findings::reach(&selection.reach));
    // What would have been seen is only known where the residual is noise.
    let silent = named.is_empty() && matches!(c.outcome, Outcome::Adequate | Outcome::Undecidable);
    let limits = if silent { seen(data, c, selection, scales, &channels) } else { Limits::default() };
    let account = Account {
        place,
        at_noise,
        doubts,
        broken,
        has_input: data.input.is_some(),
        predictable: c.after.r_squared,
        neighbour: c.noise.memory.map(|m| m.neighbour),
        is_structured: c.after.r_squared >= WHITE,
        strays_elsewhere: c.elsewhere > Size::Negligible && c.after.r_squared < WHITE,
        detectable_r_squared: c.after.detectable_r_squared,
        lines_hz: selection.reach.lines_hz.clone(),
        is_linear_class: !selection.reach.class(&c.model.fit.structure.terms).is_empty(),
        few_cycles: selection.reach.few_cycles,
        runs_away: false,
        resonance_hz: c.base.fit.point[OMEGA] / std::f64::consts::TAU,
    };
    let (profiles, left_out) = profile::profiles(data, &c.model.fit, scales, &named, &c.spread, c.budget);
    findings.extend(left_out.iter().map(|l| format!("{l}: profile not finished, its work limit was reached")));
    findings.extend(profiles.iter().filter_map(profile::Profile::finding));
    let stated = stated(data, c, scales).map(|model| (free(&model.fit).0, model));
    let recordings = recording_scores(data, c, pieces, &before, stated.as_ref());
    let noise = noise.map(|n| Noise { value: n.deviation, unit: output_unit.clone(), how: how(n.how) });
    let fit = Fitted { recordings, noise, ..scores(data, c, errors, stated.as_ref(), judging, &output_unit) };
    let detail = Detail {
        profiles,
        forms: forms.into_iter().map(|(index, form)| (c.model.fit.structure.terms[index].id(), form)).collect(),
        output,
        unit: output_unit,
        rate_hz: data.rate_hz,
        shown: shown(data, c, scales, errors),
        state: states.x,
        before,
        after,
        innovations,
        from: data.hull.start,
        surfaces,
        least_over_noise: limits.least_over_noise,
        indistinguishable: limits.indistinguishable,
        detectable: limits.candidates,
        account,
        named: !c.named.is_empty(),
        candidates: ranking.iter().map(|r| (r.id.to_owned(), r.gain, r.named)).collect(),
    };
    let low_frequency = c.noise.memory.map_or(1.0, |memory| memory.low_frequency);
    let fits = [&c.base.fit, &c.model.fit];
    let repair = (selection.base_follows || !c.named.is_empty()).then(|| repair(asked, data, fits, low_frequency));
    Answer {
        kind: Kind::Driven,
        outcome: c.outcome,
        recording: RecordingInfo::of(recording),
        base,
        effects: named,
        places,
        fit,
        residual_after: c.remainder.whiteness(),
        findings,
        ranking,
        trace: Vec::new(),
        repair,
        detail: answer::Detail::Driven(Box::new(detail)),
    }
}

/// Returns how far each named law departs from its stated form, by its place in the model, as far
/// as the work for it reaches.
fn forms(data: &Data, c: &Conclusion, scales: &Scales) -> Vec<(usize, Form)> {
    let known = |index: usize| {
        let found = c.departing.as_ref()?;
        let terms = &found.judged.fit.structure.terms;
        let same = terms[found.index].id() == c.model.fit.structure.terms[index].id();
        same.then_some(Freely { fit: &found.judged.fit, index: found.index, departs: true })
    };
    let of = |named: &Named| {
        let known = known(named.index);
        if known.is_none() && data.work.is_spent(c.budget) {
            return None;
        }
        Some((named.index, form::form(data, &c.model, named.index, scales, known)?))
    };
    c.named.iter().filter_map(of).collect()
}

/// Returns where the base model errs, and what the force that it lacks follows.
fn located(
    data: &Data,
    [before, after]: [&[f64]; 2],
    noise: Option<ReadingNoise>,
    state: &[f64],
    surface: &Surface,
    unit: &str,
) -> (Places, String, bool) {
    let noise = noise.map_or_else(|| moments::rms(after.iter().copied()), |n| n.deviation);
    let compared = Compared { error: before, noise, state, rate_hz: data.rate_hz, unit };
    let (places, mut words, at_noise) = locate(&compared, data.hull.start);
    if let Some(of_surface) = surface.words() {
        words += &format!("; {of_surface}");
    }
    (Places { state_cells: surface.strongest(CELLS_SHOWN), ..places }, words, at_noise)
}

/// Terms that have no name, those of one reason together, and names that rest on fitted samples alone.
fn doubtful(c: &Conclusion) -> Vec<String> {
    let mut groups: Vec<(Dropped, bool, Vec<&str>)> = Vec::new();
    for (term, reason) in &c.dropped {
        let stays = c.model.has(term.id());
        match groups.iter_mut().find(|(r, s, _)| r == reason && *s == stays) {
            Some((.., ids)) => ids.push(term.id()),
            None => groups.push((*reason, stays, vec![term.id()])),
        }
    }
    let dropped = groups.iter().map(|(reason, stays, ids)| findings::nameless(*reason, *stays, ids));
    let unconfirmed = c.named.iter().filter(|n| n.comparison.p_value > 0.05).map(|named| {
        let id = c.model.fit.structure.terms[named.index].id();
        format!(
            "{id} shows in training samples only: it rests on their likelihood and is not confirmed by held-out \
                 samples"
        )
    });
    dropped.chain(unconfirmed).collect()
}

/// Returns what would have been seen of each candidate.
fn seen(data: &Data, c: &Conclusion, selection: &Selection, scales: &Scales, channels: &Channels) -> Limits {
    let mut candidates: Vec<Term> = selection.alone.iter().map(|t| t.term).collect();
    candidates.sort_by_key(|t| CANDIDATES.iter().position(|c| c.id == t.id()));
    limits(data, &c.base.fit, scales, &candidates, channels)
}

/// The model that the verdict states, with its errors of free simulation.
type Stated<'a> = Option<&'a (Vec<f64>, Judged)>;

/// Errors of the base model, of the model stated, and where that holds less, of the repaired one.
fn scores(
    data: &Data,
    c: &Conclusion,
    [before, repaired]: [&[f64]; 2],
    stated: Stated<'_>,
    test: &[[usize; 2]],
    unit: &str,
) -> Fitted {
    let rmse = |errors: &[f64]| {
        let rows = data.train.iter().flat_map(|r| r.clone()).map(|k| errors[k - data.hull.start].powi(2));
        (rows.sum::<f64>() / data.train_len().max(1) as f64).sqrt()
    };
    let (base, model) = (&c.base.held_out, stated.map(|(_, model)| model));
    let noisy = model.filter(|m| m.fit.structure.is_noisy());
    let unnamed = unnamed(c);
    let with_unnamed = (!unnamed.is_empty()).then(|| WithUnnamed {
        terms: unnamed,
        train_rmse: rmse(repaired),
        test_rmse: c.model.held_out.free().sqrt(),
        test_ranges_rmse: judged_ranges(test).filter_map(|r| Some(within(&c.model.held_out, &r)?.0)).collect(),
    });
    Fitted {
        unit: unit.to_owned(),
        noise_floor: effects::noise_floor(data, &c.model.fit),
        noise: None,
        train: Score {
            rmse_before: rmse(before),
            rmse_after: stated.map(|(errors, _)| rmse(errors)),
            ratio_ci95: None,
            share: None,
        },
        test: Score {
            rmse_before: base.free().sqrt(),
            rmse_after: model.map(|m| m.held_out.free().sqrt()),
            ratio_ci95: model.map(|m| ratio_interval(base, &m.held_out)),
            share: None,
        },
        test_ranges: range_scores(test, base, model.map(|m| &m.held_out)),
        recordings: Vec::new(),
        with_unnamed,
        log_score: noisy.map(|m| LogScore {
            before: base.log_score(c.base.fit.variance),
            after: m.held_out.log_score(m.fit.variance),
        }),
        one_step_rmse: noisy.map(|m| [base.one_step().sqrt(), m.held_out.one_step().sqrt()]),
    }
}

/// The ranges that judge, where there are several.
fn judged_ranges(ranges: &[[usize; 2]]) -> impl Iterator<Item = Range<usize>> {
    ranges.iter().filter(|_| ranges.len() > 1).map(|&[from, to]| from..to)
}

/// Errors on each range that judges, where there are several.
fn range_scores(ranges: &[[usize; 2]], before: &HeldOut, after: Option<&HeldOut>) -> Vec<RangeScore> {
    let score = |range: Range<usize>| {
        let rmse_after = after.and_then(|after| Some(within(after, &range)?.0));
        Some(RangeScore { from: range.start, to: range.end, rmse_before: within(before, &range)?.0, rmse_after })
    };
    judged_ranges(ranges).filter_map(score).collect()
}

/// Root-mean-square error of free simulation on the judged blocks within a range, and their
/// samples.
fn within(held: &HeldOut, range: &Range<usize>) -> Option<(f64, usize)> {
    let inside = held.blocks.iter().filter(|b| range.start <= b.range.start && b.range.end <= range.end);
    let (sum, count) = inside.fold((0.0, 0), |(s, n), b| (s + b.free, n + b.range.len()));
    (count > 0).then(|| ((sum / count as f64).sqrt(), count))
}

/// Errors on each recording: on all samples of one that is fitted, on those that judge of another.
fn recording_scores(
    data: &Data,
    c: &Conclusion,
    pieces: &[Piece],
    before: &[f64],
    stated: Stated<'_>,
) -> Vec<RecordingScore> {
    let fitted = |errors: &[f64], range: &Range<usize>| {
        let inside = range.start.max(data.hull.start) - data.hull.start..range.end.min(data.hull.end) - data.hull.start;
        let count = inside.len();
        ((errors[inside].iter().map(|e| e * e).sum::<f64>() / count.max(1) as f64).sqrt(), count)
    };
    let score = |piece: &Piece| {
        let of = |errors: &[f64], held_out: &HeldOut| match piece.role {
            Role::Train => Some(fitted(errors, &piece.range)),
            Role::Test => within(held_out, &piece.range),
        };
        let (rmse_before, samples) = of(before, &c.base.held_out)?;
        let after = stated.filter(|_| !c.named.is_empty());
        Some(RecordingScore {
            file: piece.file.clone(),
            role: piece.role,
            samples,
            rmse_before,
            rmse_after: after.and_then(|(errors, model)| Some(of(errors, &model.held_out)?.0)),
            force_error_before: None,
            force_error_after: None,
        })
    };
    pieces.iter().filter_map(score).collect()
}

/// Recording and both models around the held-out block on which they differ most (the base errs
/// most, where nothing is named).
fn shown(data: &Data, c: &Conclusion, scales: &Scales, [before, after]: [&[f64]; 2]) -> Shown {
    let named = !c.named.is_empty();
    let gap = |(b, a): (&Block, &Block)| (b.free - if named { a.free } else { 0.0 }) / b.range.len().max(1) as f64;
    let pairs = c.base.held_out.blocks.iter().zip(&c.model.held_out.blocks);
    let Some((block, _)) = pairs.max_by(|x, y| gap(*x).total_cmp(&gap(*y))) else { return Shown::default() };
    let block = block.range.clone();
    let periods = PERIODS * std::f64::consts::TAU / (c.base.fit.point[OMEGA] * data.interval_s());
    let length = (periods as usize).clamp(LEAST_SHOWN, MOST_SHOWN);
    let window = |within: &Range<usize>| {
        let from = ((block.start + block.end) / 2).saturating_sub(length / 2);
        let from = from.min(within.end.saturating_sub(length)).max(within.start);
        from..(from + length).min(within.end)
    };
    let inside = block.start >= data.hull.start && block.end <= data.hull.end;
    let (range, errors) = if inside {
        let range = window(&data.hull);
        let cut = |e: &[f64]| e[range.start - data.hull.start..range.end - data.hull.start].to_vec();
        let errors = [cut(before), cut(after)];
        (range, errors)
    } else {
        let Some(test) = data.test.iter().find(|r| r.start <= block.start && block.end <= r.end) else {
            return Shown::default();
        };
        let range = window(test);
        let simulated = |fit: &Fit| {
            let run = Run { range: test.start..range.end, steps: fit.steps, corrected: false };
            let (errors, _) = trace(data, &fit.structure, &with_state_at(data, fit, scales, test), &run);
            errors[range.start - test.start..].to_vec()
        };
        let errors = [simulated(&c.base.fit), simulated(&c.model.fit)];
        (range, errors)
    };
    let overlap = |r: &Range<usize>| r.start.max(range.start)..r.end.min(range.end);
    let reading = &data.reading[range.clone()];
    let [base, repaired] = errors.map(|e| reading.iter().zip(e).map(|(y, e)| y - e).collect());
    Shown {
        from: range.start,
        held_out: data.test.iter().map(overlap).filter(|r| r.start < r.end).collect(),
        reading: reading.to_vec(),
        base,
        repaired,
    }
}
