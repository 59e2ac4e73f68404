//! A recording under an input, searched by free simulation: first in short segments, then over all that the
//! model follows, on the way of the input between its samples that does best.

use std::f64::consts::TAU;

use crate::driven::base::{GAIN, OMEGA, ZETA};
use crate::driven::identification::refined_scales::lines;
use crate::driven::identification::start::{self, resonances};
use crate::driven::intake::data::Data;
use crate::driven::intake::prepare::Prepared;
use crate::driven::intake::stretches::loudest;
use crate::driven::simulated::under_input;
use crate::engine::fit::{MOST_STEPS, fit};
use crate::engine::kind::{Argument, Kind};
use crate::engine::levels::AT_NOISE;
use crate::engine::names;
use crate::engine::search::Search;
use crate::physics::library::Term;
use crate::physics::parasitic_mode::ParasiticMode;

use super::input::{gone, other_input};
use super::rows::{CYCLES, LEAST_SEGMENT};
use super::searched::{Decay, Numbers, begun, searched, seen};
use super::swings::Motion;

/// Searches a recording under an input; `None` where nothing answers the input like a resonance. The base model
/// begins at the peaks of the response, at the hints, and where the reading rings between the lines of the input.
///
/// The search begins on short segments, which no model loses, and goes on where a simulation follows the
/// motion through longer ones: only there do linear laws show that a start anew every few cycles hides.
pub(crate) fn driven(prepared: &Prepared) -> Option<Decay> {
    let (mut begins, hints) = (resonances(&prepared.data), &prepared.start);
    let [gain, omega_rad_s, _] = *begins.first()?;
    begins.extend(hints.resonance_hz.map(|hz| [gain, TAU * hz, hints.damping_ratio.unwrap_or(0.1)]));
    let cycle = TAU * prepared.data.rate_hz / omega_rad_s;
    let segment = (CYCLES * cycle).max(LEAST_SEGMENT) as usize;
    let data = seen(&prepared.data, omega_rad_s);
    let excerpt = loudest(&data);
    let whole = start::base(excerpt.as_ref().unwrap_or(&data), hints);
    begins.extend(whole.map(|(fit, _)| [GAIN, OMEGA, ZETA].map(|i| fit.point[i])));
    let search_from = |data: Data, begins: &[[f64; 3]]| {
        let rows = under_input::rows(&data, cycle, Some(segment));
        let stretches = std::iter::once(data.hull.clone()).collect();
        let motion = Motion { cycle, stretches, is_released: false, knocks: Vec::new() };
        Some(searched(data, rows, motion, begins)?.further())
    };
    // What the mass is without may belong to another mode than the one that is read the most.
    let search = |data: Data| {
        let first = search_from(data.clone(), &begins)?;
        let others = first.other_modes().into_iter().filter_map(|mode| search_from(data.clone(), &[mode]));
        others.chain([first]).min_by(|a, b| a.left().total_cmp(&b.left()))
    };
    let decay = search(data.clone())?;
    let models = [&*decay.found.model, &*decay.found.best];
    let Some(how) = other_input(&decay.system, decay.variance, &models) else {
        return Some(decay.in_steps_that_suffice());
    };
    let again = search(gone(&data, how));
    let again = again.map_or(decay, |again| Decay { other_input: again.other_input.or(Some(how)), ..again });
    Some(again.in_steps_that_suffice())
}

impl Decay {
    /// Variance that the final model leaves, over that of the noise.
    fn left(&self) -> f64 {
        self.found.model.variance / self.variance
    }

    /// Gain, frequency and damping of each further mode of the best set, where it leaves more than the noise, though no
    /// mode is missing: another one would be in it.
    fn other_modes(&self) -> Vec<[f64; 3]> {
        let (system, best) = (&self.system, &self.found.best);
        let is_mode = |place: &usize| matches!(system.members[best.set[*place]].term, Term::ParasiticMode(_));
        let modes: Vec<usize> = (0..best.set.len()).filter(is_mode).collect();
        if self.left() < 1.0 + AT_NOISE || modes.len() == ParasiticMode::ALL.len() {
            return Vec::new();
        }
        let values = system.shared_values(&best.set, &best.point);
        let first = modes.into_iter().map(|place| system.coordinates(&best.set, place).start);
        first.filter_map(|first| values[first..].first_chunk().copied()).collect()
    }

    /// Searches again over the longest segments that the final model follows the motion through.
    fn further(self) -> Self {
        let mut system = self.numbers.system.clone();
        if system.rows.layout.segments.len() == self.system.rows.layout.segments.len() {
            return self;
        }
        let base = fit(&system, &[], &begun(&self.system, &system, &self.found.base.point), MOST_STEPS);
        let Some(base) = base else { return self };
        system.scales.lines_hz = lines(&base.model.residual, system.rows.data.rate_hz);
        let Some((search, base)) = Search::begin(&system, self.variance, &base.point) else { return self };
        let known = search.at(&self.numbers.model.set, &self.numbers.model.point);
        for (_, rival) in self.numbers.rivals.iter().flatten() {
            search.at(&rival.set, &rival.point);
        }
        let found = names::names(&search, base, known);
        drop(search);
        // A law of the mass shows in short segments as it does in long ones, unless it is so weak that their
        // beginnings hide it: then it leaves nothing in the long ones.
        let is_seen = |law: &usize| system.argument(*law) == Argument::Frequency || self.found.model.set.contains(law);
        let is_at_noise = found.model.variance < (1.0 + AT_NOISE) * self.variance;
        if !is_at_noise && !found.model.set.iter().all(is_seen) {
            return self;
        }
        let rivals = found.named.iter().map(|n| n.rivals.clone()).collect();
        let numbers = Numbers { system: system.clone(), model: found.model.clone(), rivals };
        Self { system, found, numbers, ..self }
    }
}
