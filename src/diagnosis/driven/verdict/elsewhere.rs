//! Tests what a model leaves of samples outside the recording that was fitted: those of `--test`, and
//! of a part that `[split]` names. A law that was found in one recording need not hold in another.

use std::ops::Range;

use crate::driven::base::OFFSET;
use crate::driven::identification::fit::{Fit, Search};
use crate::driven::intake::data::Data;
use crate::driven::selection::held_out::{LEAD, settled};
use crate::driven::selection::residual_structure::of_noise;
use crate::driven::simulation::run::{Run, trace};
use crate::driven::simulation::structure::coordinates;
use crate::physics::scales::Scales;
use crate::remainder::{Remainder, Test};

use super::conclude::remembers;

/// Tests the residual of each range outside, with the offset and the beginning that fit there; noise
/// where there is none, and where the response is chaotic, as no simulation of it lasts.
pub(super) fn left(data: &Data, fit: &Fit, scales: &Scales) -> Remainder {
    if !data.own_test || data.windows.is_some() {
        return Remainder::of([]);
    }
    let ranges: Vec<&Range<usize>> = data.test.iter().filter(|r| is_outside(data, r)).collect();
    let several = ranges.len() as f64;
    let test = |range: &&Range<usize>| {
        let left = remembers(&of_noise_there(data, fit, scales, range));
        Test { p_value: several * left.p_value, ..left }
    };
    Remainder::of(ranges.iter().map(test))
}

/// Returns the structure that the innovations of a range outside give away.
fn of_noise_there(data: &Data, fit: &Fit, scales: &Scales, range: &Range<usize>) -> crate::detection::Structure {
    let mut free = fit.structure.beginnings();
    free.push(OFFSET);
    let run = Run { range: range.clone(), steps: fit.steps, corrected: false };
    let search = Search {
        data,
        structure: &fit.structure,
        point: settled(data, fit, scales, range),
        free,
        coordinates: coordinates(&fit.structure, scales),
        run: run.clone(),
        rows: vec![range.clone()],
    };
    let point = search.minimise(10).map_or_else(|| search.point.clone(), |m| search.point(&m.z));
    let (mut innovations, mut states) = trace(data, &fit.structure, &point, &Run { corrected: true, ..run });
    let lead = LEAD.min(range.len() / 4);
    innovations.drain(..lead);
    states.x.drain(..lead);
    states.v.drain(..lead);
    let here = range.start + lead..range.end;
    let there = Data { hull: here.clone(), breaks: Vec::new(), train: vec![here], ..data.clone() };
    of_noise(&there, fit, (innovations, states)).structure
}

fn is_outside(data: &Data, range: &Range<usize>) -> bool {
    range.start >= data.hull.end || range.end <= data.hull.start
}
