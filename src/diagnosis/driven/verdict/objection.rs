//! Raises objections against a term of the final model: the test samples, or its own parameters.

use crate::driven::base::ZETA;
use crate::driven::identification::interval;
use crate::driven::selection::earned::without;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::input_line::follows_input;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::{Named, WORSE};
use crate::driven::verdict::dropped::{Dropped, LeftOut};
use crate::gate::Gate;
use crate::physics::scales::Coordinate;

use super::draft::{Draft, Objection, UNMEASURED};
use super::second_resonance::{APERIODIC, is_beside_the_first, is_second_resonance};

impl Draft<'_> {
    /// Returns why a term may not stay, if it may not: the test samples speak against it, it is not
    /// what its name states, or it may be nothing.
    fn objection(&self, named: &Named) -> Option<Objection> {
        let worse = self.model.held_out.free() / named.without.free();
        let worsens = named.worsens(&self.model);
        let worsens = worsens.then(|| self.objects(named, Gate::Worsens, Dropped::Worsens, [worse, WORSE]));
        worsens.flatten().or_else(|| self.misnamed(named))
    }

    /// Returns why a term is not what its name states in the model that it stands in, if it is not.
    pub(super) fn misnamed(&self, named: &Named) -> Option<Objection> {
        let fit = &self.model.fit;
        let objects = |gate: Gate, reason: Dropped, measured: [f64; 2]| self.objects(named, gate, reason, measured);
        if fit.term_at_bound(named.index, &self.scales)
            && let Some(objection) = objects(Gate::Bound, Dropped::AtBound, UNMEASURED)
        {
            return Some(objection);
        }
        if self.is_noise(named) {
            return None;
        }
        if follows_input(self.data, fit, named.index)
            && let Some(objection) = objects(Gate::InputLine, Dropped::FollowsInput, UNMEASURED)
        {
            return Some(objection);
        }
        let damping = [fit.point[ZETA], APERIODIC];
        if is_second_resonance(&self.term(named.index))
            && !is_beside_the_first(fit)
            && let Some(objection) = objects(Gate::NoSecondResonance, Dropped::NoSecondResonance, damping)
        {
            return Some(objection);
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
        let with_reach = |place: &usize| {
            let free = fit.free.iter().position(|f| f == place);
            [fit.point[*place].abs(), free.map_or(f64::INFINITY, |f| spread.reach[f][0] * fit.slopes[f].abs())]
        };
        let surest = strengths.iter().map(with_reach).max_by(|a, b| (a[0] - a[1]).total_cmp(&(b[0] - b[1])));
        let nothing = surest.filter(|[strength, reach]| strength <= reach)?;
        objects(Gate::MayBeNothing, Dropped::MayBeNothing, nothing)
    }

    /// A term against which something speaks goes, and the others are weighed again without it.
    pub(super) fn drop_what_cannot_stay(&mut self) {
        let worst = |draft: &Self| {
            let all = draft.named.iter().filter_map(|n| Some((n, draft.objection(n)?)));
            let worst = all.min_by(|a, b| a.0.without.free().total_cmp(&b.0.without.free()));
            worst.map(|(n, objection)| (n.index, objection))
        };
        while let Some((index, objection)) = worst(self) {
            self.drop_for(index, objection);
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
