//! From what was selected to a verdict: which effects stand, what is left, how well it fits.

use super::by_column::Asked;
use super::candidate::row;
use super::cause::Cause;
use super::channel::{Channel, Environment, Fitted};
use super::common::Common;
use super::departure::{Departure, Of, Ruling};
use super::detail::{self, ChannelDetail, Detail};
use super::effects::{self, Basis, Found};
use super::findings;
use super::intake::Columns;
use super::jump;
use super::level::{self, Levels};
use super::mean::Mean;
use super::near_law::{self, Judged};
use super::residual::{Residual, TOLERANCE, residual};
use super::score::{fit, ranking};
use super::selection::Selection;
use super::shared_exponent::{self, Member};
use super::standing::correction;
use super::statement::Statement;
use super::{describe, earth, location, plausible, sensor, statements, telegraph};
use crate::answer::{self, Answer};
use crate::candidate::Kind;
use crate::model;
use crate::numerics::order;
use crate::parallel;
use crate::recording::Recording;
use crate::remainder::{REAL, Remainder, Size, Test};
use crate::ruling::{Evidence, rule};
use crate::verdict::{Effect, Estimate, RecordingInfo};

/// Holds what a conclusion is drawn from.
pub(super) struct Material<'a> {
    pub(super) recording: &'a Recording,
    pub(super) columns: &'a Columns<'a>,
    pub(super) model: &'a model::Static,
    pub(super) channels: &'a [Channel],
    pub(super) selected: &'a [Selection],
    pub(super) common: Option<Common>,
    pub(super) environment: &'a Environment,
    pub(super) findings: Vec<String>,
}

pub(super) fn conclude(material: Material<'_>) -> Answer {
    let mut draft = Draft::of(material);
    draft.find_effects();
    draft.test_residuals();
    draft.name_near_laws();
    draft.drop_passing_levels();
    draft.drop_stand_ins();
    draft.mention();
    draft.answer()
}

/// A conclusion in the making; vectors by channel.
struct Draft<'a> {
    recording: &'a Recording,
    columns: &'a Columns<'a>,
    model: &'a model::Static,
    channels: &'a [Channel],
    selected: &'a [Selection],
    common: Option<Common>,
    environment: &'a Environment,
    findings: Vec<String>,
    unit: &'a str,
    /// The final models: those selected, or with what channels share.
    finals: Vec<Fitted>,
    residuals: Vec<Residual>,
    /// States whether a jump, or hops between levels, describe a channel better than its drift
    /// does.
    leaps: Vec<bool>,
    /// Holds what free exponents say of a channel's drift.
    departures: Vec<Option<Departure>>,
    effects: Vec<Found>,
}

impl<'a> Draft<'a> {
    fn of(material: Material<'a>) -> Self {
        let Material { recording, columns, model, channels, selected, common, environment, findings } = material;
        Self {
            recording,
            columns,
            model,
            channels,
            selected,
            common,
            environment,
            findings,
            unit: if model.unit.is_empty() { "unit" } else { &model.unit },
            finals: selected.iter().map(|s| s.chosen.clone()).collect(),
            residuals: Vec::new(),
            leaps: vec![false; channels.len()],
            departures: vec![None; channels.len()],
            effects: Vec::new(),
        }
    }

    /// Returns whether a channel takes part in the common drift.
    fn is_common(&self, i: usize) -> bool {
        self.common.as_ref().is_some_and(|c| c.leader == i || c.followers.iter().any(|f| f.channel == i))
    }

    /// States what was selected, as effects: the drift that channels share, each channel's own
    /// terms, its white level.
    fn find_effects(&mut self) {
        if let Some(common) = &self.common {
            self.effects.push(effects::of_common(common, self.channels, &mut self.finals));
        }
        let noise = self.model.noise.as_ref();
        for (i, channel) in self.channels.iter().enumerate() {
            let own = effects::of_terms(i, channel, &self.selected[i], self.is_common(i));
            self.effects.extend(own);
            self.effects.extend(effects::of_level(i, channel, &self.finals[i], noise));
            self.findings.extend(plausible::level(channel, &self.finals[i], noise));
        }
    }

    /// States what the final models leave, and what leaps rather than drifts.
    fn test_residuals(&mut self) {
        let count = self.channels.len() as f64;
        let mut jumps = vec![None; self.channels.len()];
        self.residuals = self.channels.iter().zip(&self.finals).map(|(c, f)| residual(c, f, TOLERANCE)).collect();
        for (i, (channel, selection)) in self.channels.iter().zip(self.selected).enumerate() {
            let Some(jump::Alone { jump, is_sure }) = jump::alone(channel, &selection.chosen) else { continue };
            if is_sure {
                self.residuals[i].jump = Some(jump.at as f64 / channel.rate_hz);
                self.residuals[i].p_value = self.residuals[i].p_value.min(jump.p_value);
                self.leaps[i] = true;
            } else {
                jumps[i] = Some(jump.at);
            }
        }
        for (i, fitted) in self.finals.iter().enumerate() {
            let step = fitted.terms.iter().find(|t| t.cause == Cause::Jump);
            let at = step.map(|t| t.searched / self.channels[i].rate_hz);
            self.residuals[i].jump = self.residuals[i].jump.or(at);
        }
        // What channels share is a common cause, whatever its course.
        let alone: Vec<usize> = (0..self.channels.len()).filter(|i| !self.is_common(*i)).collect();
        let hops = parallel::map(&alone, |i| (*i, telegraph::hops(&self.channels[*i], &self.selected[*i].chosen)));
        for (i, found) in hops {
            let Some(hops) = found.filter(|t| t.hops > 1 && t.p_value * count < REAL) else { continue };
            self.residuals[i].p_value = self.residuals[i].p_value.min(hops.p_value);
            self.residuals[i].telegraph = Some(hops);
            self.leaps[i] = true;
        }
        let steady: Vec<usize> = alone.into_iter().filter(|i| !self.leaps[*i]).collect();
        let asked = |i: &usize| {
            let (channel, chosen) = (&self.channels[*i], &self.selected[*i].chosen);
            let asked = Asked { channel, chosen, environment: self.environment };
            (*i, asked.judge_with_time(correction(self.channels.len())))
        };
        for (i, found) in parallel::map(&steady, asked) {
            self.departures[i] = found;
        }
        self.share_exponent(&steady);
        for i in steady {
            self.departures[i] = self.departures[i].or(jumps[i].map(Departure::jump));
        }
    }

    /// States what one exponent for all channels that drift by noise says of each.
    fn share_exponent(&mut self, steady: &[usize]) {
        let member = |i: &usize| Member {
            channel: &self.channels[*i],
            chosen: &self.selected[*i].chosen,
            departure: self.departures[*i],
        };
        let (places, members): (Vec<usize>, Vec<Member<'_>>) =
            steady.iter().map(|i| (*i, member(i))).filter(|(_, m)| shared_exponent::may_share(m)).unzip();
        let Some(shared) = shared_exponent::of(&members) else { return };
        let told: Vec<Option<Departure>> = members.iter().map(|m| m.told(shared)).collect();
        for (i, told) in places.into_iter().zip(told) {
            self.departures[i] = told;
        }
    }

    /// If one power law f^−α fits a channel's drift as well as its slow laws together,
    /// one effect with the fitted exponent replaces theirs.
    fn name_near_laws(&mut self) {
        let count = self.channels.len();
        for place in 0..count {
            let Some(departure) = self.departures[place] else { continue };
            let (channel, selection) = (&self.channels[place], &self.selected[place]);
            let judged = Judged { place, channel, selection, departure: &departure, count };
            let Some(one) = near_law::one_for_all(&judged) else {
                if let Some((own, ties)) = near_law::ties(&selection.chosen, &departure) {
                    self.effects.iter_mut().filter(|e| e.is(own, place)).for_each(|e| e.tie(&ties));
                }
                continue;
            };
            self.effects.retain(|e| !(e.channels == [place] && departure.concerns(e.cause)));
            self.effects.push(one);
        }
    }

    /// Returns whether what acts on a channel is in no library: a jump, a knock, spikes.
    fn is_disturbed(&self, i: usize) -> bool {
        self.finals[i].has(Cause::Jump) || self.channels[i].disturbances.are_foreign()
    }

    /// Returns whether another description has ruled so of this cause in a channel.
    fn is(&self, ruling: Ruling, cause: Cause, i: usize) -> bool {
        self.departures[i].is_some_and(|d| d.ruling == ruling && d.concerns(cause))
    }

    /// Returns whether a channel drifts by a law that is not the library's.
    fn departs(&self, i: usize) -> bool {
        self.departures[i].is_some_and(|d| d.ruling == Ruling::Refuted)
    }

    /// One test for each channel, corrected for their number. Its tolerance is within the
    /// probability already, so that whatever is found is material.
    fn test(&self, i: usize) -> Test {
        Test { p_value: self.residuals[i].p_value * self.channels.len() as f64, size: Size::Material }
    }

    fn remainder(&self) -> Remainder {
        Remainder::of((0..self.channels.len()).map(|i| self.test(i)))
    }

    /// Returns whether a channel's own model describes it.
    fn fits(&self, i: usize) -> bool {
        !self.leaps[i] && !self.departs(i) && self.test(i).found() == Size::Negligible
    }

    fn all_fit(&self) -> bool {
        (0..self.channels.len()).all(|i| self.fits(i))
    }

    /// A white level that departs from the promise only for a while, or only in a band, is none
    /// that the sensor has. Where it departs for a while the promise is still not kept: that
    /// mismatch has no name here.
    fn drop_passing_levels(&mut self) {
        let Some(noise) = &self.model.noise else { return };
        let levels = |i: usize| Levels {
            fitted: self.finals[i].white().0,
            promised: describe::white_of_density(&self.channels[i], noise.density),
        };
        let passes = |e: &Found| {
            let place =
                |i: &usize| !level::holds(levels(*i), &self.channels[*i], &self.finals[*i], &self.residuals[*i]);
            e.cause == Cause::WhiteNoise && e.channels.iter().any(place)
        };
        let (passing, kept): (Vec<Found>, Vec<Found>) =
            std::mem::take(&mut self.effects).into_iter().partition(|e| passes(e));
        let unsteady = |i: &usize| !level::holds_in_time(levels(*i), &self.residuals[*i]);
        let failing: Vec<(usize, f64)> = passing
            .iter()
            .flat_map(|e| e.channels.iter().filter(|i| unsteady(i)).map(|i| (*i, e.evidence.p_value)))
            .collect();
        self.effects = kept;
        for (i, p_value) in failing {
            self.residuals[i].p_value = self.residuals[i].p_value.min(p_value);
        }
    }

    /// Drops stand-ins: laws that explain a drift by half while something unmodelled remains, in the
    /// channels where it remains. What has a witness of its own stays, and so does a law that holds
    /// wherever it rules.
    fn drop_stand_ins(&mut self) {
        let stands = |found: &Found| {
            let mut at = found.channels.iter();
            // What one jump, or hops between levels, describe better is no drift.
            let leaps = row(found.cause).is_drift
                && at.clone().any(|i| self.leaps[*i] && !self.residuals[*i].keeps(found.cause));
            let holds = |i: &usize| found.stands(&self.channels[*i], &self.finals[*i], &self.residuals[*i]);
            let whole = found.basis != Basis::Exponent;
            let refuted = whole && at.clone().any(|i| self.is(Ruling::Refuted, found.cause, *i));
            let has_hops = |i: &usize| self.leaps[*i] && row(found.cause).is_drift;
            !leaps && !refuted && (at.clone().all(|i| self.fits(*i) || has_hops(i)) || at.any(holds))
        };
        let standing: Vec<Found> = self.effects.iter().filter(|f| stands(f)).cloned().collect();
        self.effects = standing;
        order::sort_by_key(&mut self.effects, |e| -e.evidence.held_out_gain);
    }

    /// States what a reader should know next to the verdict.
    fn mention(&mut self) {
        let count = self.channels.len() as f64;
        let strict = || {
            let all = self.channels.iter().zip(&self.finals).map(|(c, f)| residual(c, f, 0.0).p_value * count);
            all.fold(1.0, f64::min)
        };
        if self.all_fit() && strict() < REAL {
            self.findings.push(findings::within_tolerance());
        }
        let columns = &self.model.columns.environment;
        self.findings.extend(findings::no_witness(columns, self.channels, self.selected));
        for (i, channel) in self.channels.iter().enumerate() {
            if self.effects.iter().any(|e| e.is(Cause::GaussMarkov, i)) {
                let detected = telegraph::power(channel, &self.finals[i], REAL / count);
                self.findings.extend(findings::popcorn(channel, detected));
            }
        }
    }

    /// Returns whether the recording cannot tell if an effect has the library's exponent.
    fn is_open(&self, found: &Found) -> bool {
        found.channels.iter().any(|i| self.is(Ruling::Open, found.cause, *i))
    }

    fn evidence(&self, effects: &[Effect]) -> Evidence {
        Evidence {
            named: effects.len(),
            tied: self.effects.iter().filter(|e| !e.rivals.is_empty() || self.is_open(e)).count(),
            // A drift that is a jump in truth has been dropped, and the library holds no jump, no
            // knock and no spikes.
            stand_ins: self.leaps.contains(&true)
                || (0..self.channels.len()).any(|i| self.is_disturbed(i) || self.departs(i)),
            remainder: self.remainder().size,
            // Laws of noise change no prediction, and a curve that predicts worse does not count in
            // the selection.
            ..Evidence::default()
        }
    }

    /// Every departure that matters to the verdict, with the names that it concerns.
    fn departures_named(&self) -> Vec<detail::Departure> {
        let of = |(i, departure): (usize, &Option<Departure>)| {
            let departure = departure.as_ref()?;
            let chosen = self.selected[i].chosen.terms.iter().filter(|t| departure.concerns(t.cause));
            let refuted = departure.ruling == Ruling::Refuted;
            let by_exponent = |e: &Found| e.basis == Basis::Exponent && e.channels.contains(&i);
            let one = self.effects.iter().any(by_exponent);
            let stands = |cause: Cause| refuted || one || self.effects.iter().any(|e| e.is(cause, i));
            let ids: Vec<&str> =
                chosen.filter(|t| stands(t.cause)).filter_map(|t| Some(row(t.cause).entry?.id)).collect();
            let near =
                self.effects.iter().find(|e| by_exponent(e)).and_then(|e| Some(row(e.cause).entry?.id.to_owned()));
            (!ids.is_empty()).then(|| detail::Departure {
                near,
                channel: self.channels[i].name.clone(),
                ids: ids.into_iter().map(str::to_owned).collect(),
                refuted,
                in_time: departure.of == Of::Time,
                column: match departure.of {
                    Of::Column(place) => self.environment.get(place).map(|(name, _)| name.clone()),
                    Of::Spectrum | Of::Time | Of::Jump(_) => None,
                },
                jump_s: match departure.of {
                    Of::Jump(at) => Some(at as f64 / self.channels[i].rate_hz),
                    Of::Spectrum | Of::Time | Of::Column(_) => None,
                },
                exponent: departure.exponent.map(|e| e.value),
                ci95: departure.exponent.map(|e| e.ci95),
            })
        };
        self.departures.iter().enumerate().filter_map(of).collect()
    }

    fn means(&self) -> Vec<Mean> {
        let noise = self.model.noise.as_ref();
        let columns = self.columns;
        self.channels.iter().zip(&self.finals).map(|(c, f)| Mean::of(c, f, noise, columns)).collect()
    }

    fn answer(self) -> Answer {
        let (channels, count) = (self.channels, self.channels.len());
        let effects: Vec<Effect> = self.effects.iter().filter_map(|e| e.public(channels)).collect();
        let fits: Vec<bool> = (0..count).map(|i| self.fits(i) && !self.is_disturbed(i)).collect();
        let before: Vec<Vec<f64>> =
            (0..count).map(|i| describe::base_variances(&channels[i], &self.selected[i].base, self.model)).collect();
        let (places, location) = location::locate(channels, self.selected, &self.residuals, &fits);
        let of_channel = |i: usize| ChannelDetail {
            named: effects.iter().filter(|e| e.channels.contains(&channels[i].name)).map(|e| e.id.clone()).collect(),
            fits: fits[i],
            ..describe::detail(&channels[i], &before[i], &self.finals[i])
        };
        let means = self.means();
        let base: Vec<Estimate> = means.iter().map(|m| m.estimate()).collect();
        let reference = earth::reference(self.model, &base);
        let mut ranking = ranking(channels, self.selected, &self.effects);
        let names = || channels.iter().map(|c| c.name.clone()).collect();
        ranking.extend(reference.as_ref().and_then(|r| earth::ranked(r, names())));
        let of_readings = statements::of(self.recording, channels, &self.finals, &self.residuals);
        let of_means = means.iter().filter_map(Mean::statement);
        let statements: Vec<Statement> = of_readings.into_iter().chain(of_means).chain(reference).collect();
        let follows_temperature = self.effects.iter().any(|e| e.cause == Cause::TemperatureSensitivity);
        let of_static = Detail {
            unit: self.unit.into(),
            channels: (0..count).map(of_channel).collect(),
            statements,
            departures: self.departures_named(),
            temperature_unlogged: follows_temperature && self.model.columns.environment.is_empty(),
            has_environment: !self.environment.is_empty(),
            location,
        };
        Answer {
            kind: Kind::Static,
            outcome: rule(&self.evidence(&effects)),
            recording: RecordingInfo::of(self.recording),
            places,
            fit: fit(channels, self.selected, &self.finals, &before, self.unit),
            residual_after: self.remainder().whiteness(),
            ranking,
            trace: Vec::new(),
            repair: sensor::repair(self.recording, channels, &self.finals, &self.effects, self.model),
            detail: answer::Detail::Static(Box::new(of_static)),
            base,
            effects,
            findings: self.findings,
        }
    }
}
