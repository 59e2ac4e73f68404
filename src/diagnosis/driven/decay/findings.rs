//! Writes the findings about a decay other than its physics, in sentences.

use crate::driven::intake::data::Data;
use crate::driven::selection::base_model::interpolated;
use crate::number::short;

use super::searched::Decay;

/// Knocks that are listed one by one.
const KNOCKS: usize = 5;

/// States where the motion begins and ends, how it was thinned, what was tried and holds no name.
pub(super) fn findings(decay: &Decay, data: &Data, unit: &str) -> Vec<String> {
    let (motion, rows) = (&decay.motion, &decay.system.rows);
    let second = |row: usize| short(row as f64 / data.rate_hz);
    let (first, last) = (motion.stretches[0].start, motion.stretches[motion.stretches.len() - 1].end);
    let mut all: Vec<String> = decay.other_input.map(interpolated).into_iter().collect();
    if motion.is_released {
        all.push(format!(
            "the mass is held and released at {} s: rows {} to {} lie before it and are not fitted",
            second(first),
            data.hull.start,
            first.saturating_sub(1)
        ));
    } else if first > data.hull.start {
        all.push(format!(
            "the free motion begins at {} s, where it is largest: rows {} to {} lie before it and are not fitted",
            second(first),
            data.hull.start,
            first - 1
        ));
    }
    for knock in motion.knocks.iter().take(KNOCKS) {
        all.push(format!("the mass is excited again near {} s: another stretch begins there", second(*knock)));
    }
    if let further @ 1.. = motion.knocks.len().saturating_sub(KNOCKS) {
        all.push(format!("the mass is excited again {further} times more"));
    }
    if last < data.hull.end {
        all.push(format!(
            "the motion dies out at {} s: rows {last} to {} swing by less than five times the noise or a hundredth of the \
             largest swing, and are not fitted",
            second(last),
            data.hull.end - 1
        ));
    }
    let step = rows.step;
    if step > 1 {
        all.push(format!(
            "the decay has {} samples to a cycle and was fitted at one of {step}, each the value of a parabola through \
             its neighbours; white noise is {} {unit} there",
            short(motion.cycle),
            short(decay.size(decay.variance.sqrt()))
        ));
    }
    if rows.of > 1 {
        all.push(format!(
            "of the decay's {} cycles one segment of some {} in {} is fitted, from the first on",
            short(decay.cycles()),
            short((rows.layout.rows() * rows.step) as f64 / rows.layout.segments.len() as f64 / motion.cycle),
            rows.of
        ));
    }
    if !decay.found.imitations.is_empty() {
        let ids: Vec<&str> = decay.found.imitations.iter().map(|l| decay.system.members[*l].term.id()).collect();
        all.push(format!("{} would remove part of the error, and not enough of it to be named", ids.join(" and ")));
    }
    all
}
