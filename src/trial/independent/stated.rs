//! States what a law leaves of the truth in the shape in which a verdict states it.
//!
//! The verdict gives the powers and the delay, a lag or play with its number; amplitudes are fitted
//! to the truth, and whether they are right is for the coverage of their intervals. A reading that
//! follows temperature with a lag is described by a verdict that states the lag, and not by one
//! that states a square. The library's statement holds the shapes (`slope`, `square`, `cube`, after
//! a `lag` or `play`), so that the nearest statement is the one that the verdict made.

use super::case::{Body, Case};
use super::linear::left_by;
use super::still::{Process, Still};
use crate::said::Said;

/// Id that states shapes.
const ID: &str = "temperature-sensitivity";

/// Evidence of what the stated shapes, at their best amplitudes, leave of a reading that follows
/// temperature, all channels together; `None` for other truths.
pub(super) fn left(case: &Case, said: &Said) -> Option<f64> {
    let Body::Still(still) = &case.body else { return None };
    let process = still.processes.iter().position(|p| matches!(p.0, Process::Temperature { .. }))?;
    let of = |channel: usize| {
        let ones = vec![1.0; still.rows];
        let courses = stated(still, said, channel);
        let columns: Vec<&[f64]> = std::iter::once(&ones[..]).chain(courses.iter().map(Vec::as_slice)).collect();
        left_by(&columns, &still.effect(process, channel)).iter().map(|v| v * v).sum::<f64>()
    };
    Some((0..still.sigma.len()).map(of).sum())
}

/// The powers of the temperature that a verdict states for a channel, after the delay that it
/// states; of any amplitude.
fn stated(still: &Still, said: &Said, channel: usize) -> Vec<Vec<f64>> {
    let number = |name: &str| {
        let mut own = said.numbers.iter().filter(|n| n.id == ID && n.channel == still.headings[channel]);
        own.find(|n| n.name == name).map(|n| n.value)
    };
    let temperature = still.temperatures();
    let dt = 1.0 / still.rate_hz;
    let (keep, half) = (number("lag").map(|lag| (-dt / lag).exp()), number("play").unwrap_or(0.0));
    let mut state = temperature[0];
    let delayed: Vec<f64> = temperature
        .iter()
        .map(|now| {
            state = match keep {
                Some(keep) => keep * state + (1.0 - keep) * now,
                None => state.clamp(now - half, now + half),
            };
            state
        })
        .collect();
    let mean = delayed.iter().sum::<f64>() / delayed.len() as f64;
    let powers = [("slope", 1), ("square", 2), ("cube", 3)].into_iter().filter(|(name, _)| number(name).is_some());
    powers.map(|(_, p)| delayed.iter().map(|v| (v - mean).powi(p)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::independent::case::Place;
    use crate::independent::oscillator_base::Size;
    use crate::independent::truth::SEEN;
    use crate::said::{Ending, Number};

    #[test]
    fn the_shape_that_is_there_leaves_nothing_and_another_one_much() {
        let size = Size { rows: 4000 };
        let lagging = (0..400).filter(|n| Place::of(*n).sub == "temperature, lag");
        let cases = lagging.filter_map(|n| Case::make(7, n, size));
        let mut seen = 0;
        for case in cases.filter(|c| c.truth.departure.is_some_and(|d| d > 4.0 * SEEN)) {
            let Body::Still(still) = &case.body else { continue };
            let Process::Temperature { lag, .. } = still.processes[0].0 else { continue };
            let said = |shape: &[(&str, f64)]| {
                let number = |channel: &String, (name, value): &(&str, f64)| Number {
                    id: ID.into(),
                    channel: channel.clone(),
                    name: (*name).into(),
                    value: *value,
                    ci95: [*value; 2],
                };
                let numbers = still.headings.iter().flat_map(|c| shape.iter().map(move |s| number(c, s))).collect();
                let (groups, words) = (vec![vec![ID.to_owned()]], String::new());
                Said { outcome: Ending::Explained, groups, numbers, rmse: [0.0; 3], seconds: 0.0, words }
            };
            let left_by = |shape: &[(&str, f64)]| left(&case, &said(shape)).expect("follows temperature");
            assert!(left_by(&[("slope", 1.0), ("lag", lag)]) < 1e-6 * case.truth.evidence);
            assert!(left_by(&[("slope", 1.0)]) > SEEN, "a straight line: control");
            assert!(left_by(&[("slope", 1.0), ("lag", 3.0 * lag)]) > SEEN, "another lag: control");
            seen += 1;
        }
        assert!(seen > 0);
    }
}
