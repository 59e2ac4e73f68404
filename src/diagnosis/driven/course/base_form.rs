//! The base model of a diagnosis: the linear oscillator that a recording follows, or does not, on the
//! way that its input goes between samples, or in windows where its motion is chaotic.

use super::Course;
use crate::control::{Control, Stopped};
use crate::driven::identification::chaos;
use crate::driven::identification::fit::Fit;
use crate::driven::identification::refined_scales::refined;
use crate::driven::identification::start;
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Interpolation;
use crate::driven::intake::notes::Notes;
use crate::driven::intake::refusal::Refusal;
use crate::driven::selection::base_model::{self, NoOscillator};
use crate::driven::verdict::findings;
use crate::gate::Gate;
use crate::numerics::moments::mean_sd;
use crate::physics::scales::Scales;
use crate::trace::Step;

/// Part of the base model's error to which another way of the input between its samples must bring
/// it.
const BY_FAR: f64 = 0.5;

impl Course {
    /// The base model; what was not recorded is bridged by its readings.
    pub(in crate::driven) fn base(&mut self, control: &Control) -> Result<(Fit, Scales), Refusal> {
        let mut notes = self.notes.clone();
        let mut free = base_model::base(&self.narrow, &self.start, &mut notes);
        let left = free.as_ref().map_or(self.power(), |found| found.0.variance);
        if self.settle_interpolation(left) {
            notes.clone_from(&self.notes);
            free = base_model::base(&self.narrow, &self.start, &mut notes);
        }
        self.settle_whether_it_follows(&free, &mut notes, control)?;
        if let Some(found) = self.chaotic(free.as_ref().ok().map(|f| &f.0)) {
            return Ok(found);
        }
        let (base, scales) = match free {
            Ok(found) => found,
            Err(NoOscillator::Poor { best, .. }) if !self.follows => *best,
            Err(none) => {
                let also: String = notes.doubts.iter().map(|doubt| format!("; {doubt}")).collect();
                return Err(Refusal::Cause(none.cause() + &also));
            }
        };
        self.notes = notes;
        base_model::bridge(&mut self.narrow, &base, &self.filled);
        if self.is_whole() {
            self.data.reading.clone_from(&self.narrow.reading);
        }
        let scales = refined(&self.narrow, &base, &scales);
        Ok((base, scales))
    }

    /// No linear law is to be seen where noise is loud, either: whether the reading follows the
    /// linear oscillator all the same, so that what it leaves is noise.
    fn settle_whether_it_follows(
        &mut self,
        free: &Result<(Fit, Scales), NoOscillator>,
        notes: &mut Notes,
        control: &Control,
    ) -> Result<(), Stopped> {
        let clause = match (self.notes.bent.take(), free) {
            (Some(clause), _) => clause,
            (None, Err(NoOscillator::Poor { explains, .. })) if self.notes.broken.is_none() => {
                format!("the output depends on its input, but by no linear law: the best oscillator {explains}")
            }
            _ => return Ok(()),
        };
        self.follows = match free {
            Ok((fit, _)) => !base_model::leaves_more_than_noise(&self.narrow, fit, control)?,
            Err(NoOscillator::Poor { best, .. }) => !base_model::follows_another_law(&self.narrow, &best.0, control)?,
            Err(NoOscillator::None) => true,
        };
        self.follows |= !self.follows && !self.data.trace.acts(Step::of(Gate::NoLinearLaw, "followed", "not followed"));
        if !self.follows {
            for notes in [&mut self.notes, notes] {
                notes.doubt(clause.clone(), "; a law is named only where it brings the error to the noise");
            }
        }
        Ok(())
    }

    /// An input that is held between its samples, or goes along straight lines, turns the phase by
    /// far where there are few samples to a cycle: the mean square `left` that the base model then
    /// leaves is no physics. Whether the base model follows the reading on such an input, and no
    /// other.
    fn settle_interpolation(&mut self, left: f64) -> bool {
        let least = start::POOR * self.power();
        let is_asked = left >= least && self.filled.is_empty() && self.data.trace.is_on(Gate::BaseInterpolation);
        let Some(input) = self.narrow.input.as_ref().filter(|_| is_asked) else {
            return false;
        };
        let fitted = |data: &Data| start::base(data, &self.start).map_or(f64::INFINITY, |found| found.0.variance);
        let others = [Interpolation::Hold, Interpolation::Linear].map(|how| {
            let data = Data { input: Some(input.clone().gone(how)), ..self.narrow.clone() };
            (how, fitted(&data))
        });
        let best = others.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((how, variance)) = best.filter(|(_, variance)| *variance < least.min(BY_FAR * left)) else {
            return false;
        };
        let step = Step::of(Gate::BaseInterpolation, input.interpolation.words(), how.words());
        if !self.data.trace.acts(step.measured(variance / left, BY_FAR)) {
            return false;
        }
        self.notes.findings.push(base_model::interpolated(how));
        for data in [&mut self.data, &mut self.narrow] {
            data.input = data.input.take().map(|input| input.gone(how));
        }
        true
    }

    /// Mean square of the reading that is fitted, about its mean.
    fn power(&self) -> f64 {
        let rows = self.narrow.train.iter().flat_map(|r| &self.narrow.reading[r.clone()]).copied();
        mean_sd(&rows.collect::<Vec<f64>>()).1.powi(2)
    }

    /// The base model in windows, where the response is chaotic and its free simulation therefore
    /// leaves much.
    fn chaotic(&mut self, free: Option<&Fit>) -> Option<(Fit, Scales)> {
        let follows = free.is_some_and(|fit| fit.variance < start::POOR * self.power());
        if follows || self.notes.broken.is_some() || !self.filled.is_empty() || !self.data.breaks.is_empty() {
            return None;
        }
        let chaos = chaos::chaos(&self.narrow)?;
        let step = Step::of(Gate::Chaos, "whole", "windows").measured(chaos.exponent_per_s, 0.0);
        if !self.data.trace.acts(step) {
            return None;
        }
        let mut narrow = self.narrow.clone();
        chaos.in_windows(&mut narrow, self.own_test);
        let (base, scales) = start::base_from(&narrow, &chaos.force.base)?;
        if self.is_whole() {
            self.data = narrow.clone();
        } else {
            chaos.in_windows(&mut self.data, self.own_test);
        }
        self.narrow = narrow;
        let scales = refined(&self.narrow, &base, &scales);
        let [clause, more] = findings::chaos(&chaos);
        self.notes.doubt(clause, &more);
        Some((base, scales))
    }
}
