//! What speaks against a term of the final model: the test samples, or its own parameters.

use crate::driven::identification::interval;
use crate::driven::selection::earned::without;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::input_line::follows_input;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::Named;
use crate::driven::verdict::dropped::{Dropped, LeftOut};
use crate::physics::scales::Coordinate;

use super::draft::Draft;
use super::second_resonance::{is_beside_the_first, is_second_resonance};

impl Draft<'_> {
    /// Why a term may not stay, if it may not: the test samples speak against it, it is not what
    /// its name says, or it may be nothing.
    fn objection(&self, named: &Named) -> Option<Dropped> {
        if named.worsens(&self.model) {
            return Some(Dropped::Worsens);
        }
        self.misnamed(named)
    }

    /// Why a term is not what its name says in the model that it stands in, if it is not.
    pub(super) fn misnamed(&self, named: &Named) -> Option<Dropped> {
        let fit = &self.model.fit;
        if fit.term_at_bound(named.index, &self.scales) {
            return Some(Dropped::AtBound);
        }
        if self.is_noise(named) {
            return None;
        }
        if follows_input(self.data, fit, named.index) {
            return Some(Dropped::FollowsInput);
        }
        if is_second_resonance(&self.term(named.index)) && !is_beside_the_first(fit) {
            return Some(Dropped::NoSecondResonance);
        }
        // A law of several strengths is nothing only where each of them may be.
        let (first, spread) = (fit.structure.first[named.index], interval::spread(fit));
        let term = self.term(named.index);
        let parameters = term.candidate().parameters.len();
        let strengths: Vec<usize> = term
            .coordinates(&self.scales)
            .iter()
            .take(parameters)
            .enumerate()
            .filter(|(_, c)| !matches!(c, Coordinate::Log(..)))
            .map(|(j, _)| first + j)
            .collect();
        let may_be_nothing = |place: &usize| {
            let free = fit.free.iter().position(|f| f == place);
            free.is_none_or(|f| fit.point[*place].abs() <= spread.reach[f][0] * fit.slopes[f].abs())
        };
        let nothing = !strengths.is_empty() && strengths.iter().all(may_be_nothing);
        nothing.then_some(Dropped::MayBeNothing)
    }

    /// A term against which something speaks goes, and the others are weighed again without it.
    pub(super) fn drop_what_cannot_stay(&mut self) {
        let worst = |draft: &Self| {
            let all = draft.named.iter().filter_map(|n| Some((n, draft.objection(n)?)));
            all.min_by(|a, b| a.0.without.free().total_cmp(&b.0.without.free())).map(|(n, reason)| (n.index, reason))
        };
        while let Some((index, reason)) = worst(self) {
            self.drop_term(index, reason);
            if self.data.work.is_spent(self.budget) {
                self.named.retain(|n| n.index != index);
                self.left_out.push(LeftOut::WeighingAgain);
                continue;
            }
            let Some(reduced) = without(self.data, &self.model, index, &self.scales) else { break };
            let held_out = held_out(self.data, &reduced.fit, &self.scales, &self.data.test);
            self.model = Judged { held_out, fit: reduced.fit };
            if index < self.rivals.len() {
                self.rivals.remove(index);
            }
            // Without that term the form is another question.
            self.departing = None;
            self.after = residual_structure_of_noise(self.data, &self.model.fit);
            self.weigh();
        }
    }
}
