//! The public answer of a decay: verdict, names with their shares, repair and figure data.

use std::ops::Range;

use crate::answer::{self, Answer, Places};
use crate::candidate::Kind as Recorded;
use crate::detection::structure;
use crate::driven::base::{OFFSET, OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::intake::notes::Notes;
use crate::driven::selection::identifiability::FEWEST_CYCLES;
use crate::driven::selection::residual_structure::of_noise;
use crate::driven::simulated::system::System;
use crate::driven::verdict::asked::Asked;
use crate::driven::verdict::detail::{Account, Detail, Shown};
use crate::driven::verdict::effects::{Channels, unit_of};
use crate::driven::verdict::isolation::{Compared, locate};
use crate::driven::verdict::noise_words::how;
use crate::driven::verdict::residual_tests::{WHITE, remembers};
use crate::driven::verdict::sensor::repair;
use crate::driven::verdict::surface::{FreeRun, Surface, surface};
use crate::engine::fit::Fitted;
use crate::engine::levels::{AT_NOISE, FAINT};
use crate::engine::names::Named;
use crate::model::Output;
use crate::numerics::least_squares::Linear;
use crate::numerics::moments::rms;
use crate::numerics::special;
use crate::remainder::{Remainder, Size, Test};
use crate::ruling::{self, rule};
use crate::verdict::{DependsOn, Fit as Score, Noise, RecordingInfo, RecordingScore};

use super::effects::{self, share};
use super::findings;
use super::known;
use super::read::Read;
use super::rows::in_samples;
use super::searched::Decay;

/// Cycles that a look at both models spans.
const SHOWN: f64 = 8.0;
/// Own past that is examined for the colour of the residual, in rows.
const LAGS: usize = 12;
/// Cells of the restoring-force surface that the verdict lists.
const CELLS: usize = 32;

/// The complete answer.
pub(crate) fn answer(asked: &Asked<'_>, decay: &Decay, mut notes: Notes) -> Answer {
    let (columns, data) = (asked.columns, &decay.data);
    let unit = asked.unit.map_or_else(|| unit_of(asked.recording, &columns.output, "output unit"), str::to_owned);
    let channels = Channels {
        output: columns.output.clone(),
        output_unit: unit.clone(),
        input_unit: columns.input.as_ref().map_or_else(String::new, |c| unit_of(asked.recording, c, "input unit")),
        environment_units: data
            .followed
            .iter()
            .map(|f| unit_of(asked.recording, &f.heading, "environment unit"))
            .collect(),
    };
    let read = Read { channels, observed: data.observed };
    let channels = read.of_displacement();
    let found = &decay.found;
    let [before, after] = [&found.base, &found.model].map(|m| decay.errors(m));
    let remainder = decay.remainder();
    let named = effects::effects(decay, &read);
    let is_tied = |law: &Named| {
        let id = decay.system.members[found.model.set[law.place]].term.id();
        named.iter().any(|effect| effect.id == id && !effect.confusable_with.is_empty())
    };
    let cycles = decay.cycles();
    let few_cycles = (cycles < FEWEST_CYCLES).then_some(cycles);
    let outcome = rule(&ruling::Evidence {
        named: found.named.len(),
        departs: found.named.iter().any(|n| n.departs.is_some()),
        tied: found.named.iter().filter(|n| is_tied(n)).count(),
        stand_ins: !found.imitations.is_empty(),
        remainder: remainder.size,
        base_determined: few_cycles.is_none() || found.named.is_empty(),
        ..ruling::Evidence::default()
    });
    let surfaces = [(&found.base, &before), (&found.model, &after)].map(|(m, e)| decay.surface(m, e));
    let states = decay.passed(&found.base);
    let compared = Compared {
        error: &before,
        noise: decay.variance.sqrt(),
        state: &states.x,
        rate_hz: decay.system.rows.data.rate_hz,
        unit: &channels.output_unit,
    };
    let (places, mut place, at_noise) = locate(&compared, decay.first());
    if let Some(words) = surfaces[0].words() {
        place += &format!("; {words}");
    }
    let argument =
        found.rest.first().map(|rest| DependsOn { name: rest.argument.word().to_owned(), share: share(rest.gain) });
    let base = effects::base(decay, &read);
    if data.input.is_none() && named.is_empty() {
        notes.may_be_steady(&base);
    }
    notes.findings.extend(findings::findings(decay, data, &unit));
    let rest = decay.structure(&after);
    let [before, after] = [before, after].map(|errors| errors.iter().map(|e| decay.reading(*e)).collect::<Vec<f64>>());
    let account = Account {
        place,
        at_noise,
        doubts: notes.doubts,
        broken: notes.broken.filter(|_| found.named.is_empty()),
        predictable: rest.r_squared,
        is_structured: remainder.size > Size::Negligible,
        detectable_r_squared: rest.detectable_r_squared,
        neighbour: (remainder.size == Size::Negligible && rest.own_r_squared > WHITE).then(|| neighbour(&after)),
        few_cycles,
        has_input: data.input.is_some(),
        resonance_hz: decay.system.scales.omega_rad_s / std::f64::consts::TAU,
        ..Account::default()
    };
    let ranking = effects::ranking(decay, &read.channels);
    let detail = Detail {
        output: columns.output.clone(),
        rate_hz: decay.system.rows.data.rate_hz,
        shown: decay.shown(&before, &after),
        state: states.x,
        from: decay.first(),
        forms: named.iter().filter_map(|e| Some((decay.id(&e.id)?, e.form.clone()?))).collect(),
        named: !found.named.is_empty(),
        candidates: ranking.iter().map(|r| (r.id.to_owned(), r.gain, r.named)).collect(),
        account,
        unit: unit.clone(),
        innovations: after.clone(),
        before,
        after,
        surfaces,
        ..Detail::default()
    };
    let before = decay.as_fit(&decay.system, &found.base);
    let after = decay.as_fit(&decay.numbers.system, &decay.numbers.model);
    let repair = Some(repair(asked, data, [&before, &after], 1.0));
    Answer {
        kind: Recorded::Driven,
        outcome,
        recording: RecordingInfo::of(asked.recording),
        base,
        effects: named,
        places: Places { state_cells: detail.surfaces[0].strongest(CELLS), argument, ..places },
        fit: decay.score(asked, &unit, remainder),
        residual_after: remainder.whiteness(),
        findings: notes.findings,
        ranking,
        trace: Vec::new(),
        repair,
        detail: answer::Detail::Driven(Box::new(detail)),
    }
}

/// Correlation of neighbouring errors.
fn neighbour(errors: &[f64]) -> f64 {
    let product: f64 = errors.windows(2).map(|w| w[0] * w[1]).sum();
    product / errors.iter().map(|e| e * e).sum::<f64>().max(1e-300)
}

impl Decay {
    /// A displacement as the reading that it stands for.
    fn reading(&self, displacement: f64) -> f64 {
        displacement * self.data.observed.per_displacement()
    }

    /// The size of that reading.
    pub(super) fn size(&self, displacement: f64) -> f64 {
        self.reading(displacement).abs()
    }

    /// First row that is fitted, in rows of those that are.
    fn first(&self) -> usize {
        let at = &self.system.rows.at;
        at[0] / self.system.rows.step
    }

    /// Residual of free simulation over all rows; zero where a row does not count.
    fn errors(&self, model: &Fitted) -> Vec<f64> {
        model.model.residual.clone()
    }

    /// Cycles that are fitted.
    pub(super) fn cycles(&self) -> f64 {
        self.motion.stretches.iter().map(Range::len).sum::<usize>() as f64 / self.motion.cycle
    }

    /// The library's own text of an id.
    fn id(&self, id: &str) -> Option<&'static str> {
        self.system.members.iter().map(|m| m.term.id()).find(|known| *known == id)
    }

    /// Structure in what a model leaves, by its own past.
    fn structure(&self, errors: &[f64]) -> crate::detection::Predictability {
        let counted = errors.iter().zip(&self.system.rows.layout.counts).filter(|(_, c)| **c).map(|(e, _)| *e);
        structure(&counted.collect::<Vec<f64>>(), LAGS, &[])
    }

    /// Judges what the final model leaves over the noise: real where it depends on an argument, or
    /// grows with the motion; noise of some colour keeps its size while the motion dies away. Next
    /// to named laws, what is clearly more than the noise is real: they are near, and not exact.
    fn remainder(&self) -> Remainder {
        let (found, model) = (&self.found, &self.found.model);
        let excess = model.variance / self.variance - 1.0;
        let depends = !found.rest.is_empty() || found.named.iter().any(|n| n.departs.is_some());
        let size = Size::of(excess, AT_NOISE, FAINT);
        if self.data.input.is_some() {
            // What does not depend on the input is noise, unless it remembers longer than a readout does.
            let p_value = if depends || self.foretold(model) { 0.0 } else { 1.0 };
            let fit = self.as_fit(&self.system, model);
            let passed = (model.model.residual.clone(), self.passed(model));
            let left = of_noise(&self.system.rows.data, &fit, passed).structure;
            return Remainder::of([Test { p_value, size }, remembers(&left)]);
        }
        let is_inexact = !found.named.is_empty() && excess >= FAINT;
        let p_value = if depends || is_inexact { 0.0 } else { self.grows_by_chance(model) };
        Remainder::of([Test { p_value, size }])
    }

    /// Returns whether a forecast from input, state and time removes part of the residual.
    fn foretold(&self, model: &Fitted) -> bool {
        let gain = known::foretold(&self.system, model, &self.passed(model), self.variance);
        gain.is_some_and(|gain| gain.holds())
    }

    /// Probability that the power of the residual goes up and down with that of the motion by chance:
    /// by the correlation of their ranks over the blocks.
    fn grows_by_chance(&self, model: &Fitted) -> f64 {
        let (layout, reading) = (&self.system.rows.layout, self.system.rows.readings());
        let centre = self.system.own(OFFSET, &self.system.shared_values(&model.set, &model.point));
        let power = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            layout.blocks.iter().map(|b| rms(b.clone().filter(|k| layout.counts[*k]).map(of))).collect()
        };
        let (error, motion) = (power(&|k| model.model.residual[k]), power(&|k| reading[k] - centre));
        let ranks = |values: &[f64]| {
            let mut ranks = vec![0.0; values.len()];
            crate::numerics::order::ranked(values).iter().enumerate().for_each(|(r, k)| ranks[*k] = r as f64);
            ranks
        };
        let (a, b, n) = (ranks(&error), ranks(&motion), error.len() as f64);
        let middle = 0.5 * (n - 1.0);
        let product: f64 = a.iter().zip(&b).map(|(x, y)| (x - middle) * (y - middle)).sum();
        let r = (product / (n * (n * n - 1.0) / 12.0)).clamp(-0.999_999, 0.999_999);
        let t = r * ((n - 2.0) / (1.0 - r * r)).sqrt();
        if t <= 0.0 { 1.0 } else { 0.5 * special::f_survival(t * t, 1.0, n - 2.0) }
    }

    /// Errors before and after, on fitted and on held-out samples.
    fn score(&self, asked: &Asked<'_>, unit: &str, remainder: Remainder) -> Score {
        let found = &self.found;
        let rows = self.system.rows.layout.rows() as f64;
        let named = !found.named.is_empty();
        let held_out = |m: &Fitted| self.size((m.error / rows).sqrt());
        let fitted = |m: &Fitted| self.size((m.model.residual.iter().map(|e| e * e).sum::<f64>() / rows).sqrt());
        let of = |error: &dyn Fn(&Fitted) -> f64| crate::verdict::Score {
            rmse_before: error(&found.base),
            rmse_after: named.then(|| error(&found.model)),
            ratio_ci95: None,
            share: None,
        };
        let together = found.together.map(share);
        let remains = |s: f64| {
            let floor = self.variance * rows;
            ((floor + (1.0 - s) * (found.base.error - floor).max(0.0)) / found.base.error).max(0.0).sqrt()
        };
        let ratio_ci95 = together.map(|s| [remains(s.ci95[1]), remains(s.ci95[0])]);
        let test = crate::verdict::Score { ratio_ci95, share: together, ..of(&held_out) };
        let recordings = asked.pieces.iter().take(1).map(|piece| RecordingScore {
            file: piece.file.clone(),
            role: piece.role,
            samples: self.motion.stretches.iter().map(Range::len).sum(),
            rmse_before: fitted(&found.base),
            rmse_after: named.then(|| fitted(&found.model)),
            force_error_before: None,
            force_error_after: None,
        });
        Score {
            unit: unit.to_owned(),
            noise_floor: self.size(self.variance.min(found.model.variance).sqrt()),
            noise: Some(self.noise_of_the_reading(unit, remainder)),
            train: of(&fitted),
            test,
            test_ranges: Vec::new(),
            recordings: recordings.collect(),
            log_score: None,
            with_unnamed: None,
            one_step_rmse: None,
        }
    }

    /// Returns whether nothing is named, and the residual is more than the noise that was measured and does not
    /// follow the motion: whether it is a noise that the library knows, however long it remembers, is still to be
    /// asked.
    pub(crate) fn leaves_noise_with_memory(&self) -> bool {
        let model = &self.found.model;
        let is_more = model.variance > (1.0 + AT_NOISE) * self.variance;
        let follows = || match self.data.input {
            Some(_) => !self.found.rest.is_empty() || self.foretold(model),
            None => self.remainder().size != Size::Negligible,
        };
        self.found.named.is_empty() && is_more && !follows()
    }

    /// The noise of a reading: as it was measured; where that is only its white part, or more than the model
    /// leaves, the residual.
    fn noise_of_the_reading(&self, unit: &str, remainder: Remainder) -> Noise {
        let left = self.found.model.variance;
        let is_more = left > (1.0 + AT_NOISE) * self.variance && remainder.size == Size::Negligible;
        if is_more || left < (1.0 - AT_NOISE) * self.variance {
            let said = if is_more { "the residual, whose size does not follow the motion" } else { "the residual" };
            return Noise { value: self.size(left.sqrt()), unit: unit.to_owned(), how: said.to_owned() };
        }
        Noise { value: self.size(self.noise.deviation), unit: unit.to_owned(), how: how(self.noise.how) }
    }

    /// The model as the rest of the diagnosis of driven recordings knows it; its variance is that of a
    /// reading.
    fn as_fit(&self, system: &System, model: &Fitted) -> Fit {
        let excess = (model.variance - self.variance).max(0.0);
        let (structure, mut point) = (system.structure(&model.set), system.parameters(&model.set, &model.point));
        for (term, first) in structure.terms.iter().zip(&structure.first) {
            let own = point[*first..*first + term.values()].to_vec();
            own.iter().enumerate().for_each(|(j, v)| point[first + j] = v * in_samples(&system.rows, term, &own, j));
        }
        Fit {
            steps: structure.steps(&point, &system.scales),
            structure,
            point,
            linear: Linear { residual: model.model.residual.clone(), columns: Vec::new() },
            free: Vec::new(),
            slopes: Vec::new(),
            variance: self.noise.deviation.powi(2) + excess,
            converged: true,
        }
    }

    /// The force that a model lacks; an error of velocity or acceleration is no displacement, and shows none.
    fn surface(&self, model: &Fitted, error: &[f64]) -> Surface {
        if self.data.observed.output != Output::Displacement {
            return Surface::default();
        }
        let states = self.passed(model);
        let values = self.system.shared_values(&model.set, &model.point);
        let rate_hz = self.system.rows.data.rate_hz;
        let [omega_rad_s, zeta] = [OMEGA, ZETA].map(|place| self.system.own(place, &values));
        surface(&FreeRun { error, x: &states.x, v: &states.v, omega_rad_s, zeta, rate_hz })
    }

    /// Both models where they differ most.
    fn shown(&self, before: &[f64], after: &[f64]) -> Shown {
        let rows = &self.system.rows;
        let length = (SHOWN * self.motion.cycle) as usize / rows.step;
        let length = length.clamp(1, rows.at.len());
        let power = |from: usize| before[from..from + length].iter().map(|e| e * e).sum::<f64>();
        let starts = (0..=rows.at.len() - length).step_by((length / 4).max(1));
        let Some(from) = starts.max_by(|a, b| power(*a).total_cmp(&power(*b))) else { return Shown::default() };
        let reading: Vec<f64> = rows.readings()[from..from + length].iter().map(|y| self.reading(*y)).collect();
        let less = |errors: &[f64]| reading.iter().zip(&errors[from..]).map(|(y, e)| y - e).collect();
        let first = self.first() + from;
        Shown {
            from: first,
            held_out: std::iter::once(first..first + length).collect(),
            base: less(before),
            repaired: less(after),
            reading,
        }
    }
}
