//! Finds readings that are held over several rows: the sensor delivers more slowly than it is logged.
//!
//! Steps that are held look like a moving average to a spectrum, and are seen at once in the rows. Not for
//! readings on coarse steps, which repeat now and then, nor for a sensor that hangs (`stuck`).

use crate::number::short;

/// Part of the readings that stand in about as many rows as all do.
const NEARLY_ALL: f64 = 0.95;
/// Fewest readings that say so.
const FEWEST: usize = 64;

/// Rows to a reading, where nearly all readings stand in two and more, as many as the others or one more.
fn rows_to_a_reading(values: &[f64]) -> Option<f64> {
    let runs: Vec<usize> = values.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
    // The first and the last may be cut off.
    let whole = runs.get(1..runs.len().saturating_sub(1)).filter(|runs| runs.len() >= FEWEST)?;
    let mean = whole.iter().sum::<usize>() as f64 / whole.len() as f64;
    let alike = whole.iter().filter(|run| (**run as f64 - mean).abs() < 1.0).count();
    let is_held = mean > 1.9 && alike as f64 > NEARLY_ALL * whole.len() as f64;
    is_held.then_some(mean)
}

/// Says which channels are held, and at which rate their sensor delivers.
pub(super) fn sentence(channels: &[(&str, &[f64])], rate_hz: f64) -> Option<String> {
    let held: Vec<(&str, f64)> =
        channels.iter().filter_map(|(name, values)| Some((*name, rows_to_a_reading(values)?))).collect();
    let (_, rows) = *held.first()?;
    let names: Vec<String> = held.iter().map(|(name, _)| format!("`{name}`")).collect();
    Some(format!(
        "{}: each reading stands in {} rows, so the sensor delivers {} readings a second and not {}: what follows is of the \
         rows, in which such steps look like a moving average",
        names.join(", "),
        short(rows),
        short(rate_hz / rows),
        short(rate_hz)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn held_steps_are_told_with_their_rate_and_coarse_or_free_readings_are_not() {
        let mut rng = Philox::new(71, 0, Stream::Host);
        let noise: Vec<f64> = (0..4000).map(|_| rng.normal()).collect();
        let held = |rows: f64| (0..4000).map(|n| noise[(n as f64 / rows) as usize]).collect::<Vec<f64>>();
        for rows in [2.0, 2.4, 3.0, 10.0] {
            let found = rows_to_a_reading(&held(rows)).expect("nearly every reading is repeated");
            assert!((found / rows - 1.0).abs() < 0.01, "{rows}: {found}");
        }
        let said = sentence(&[("a", &held(2.0)), ("b", &noise)], 100.0).expect("a is held");
        assert!(said.starts_with("`a`: each reading stands in 2.00 rows, so the sensor delivers 50.0"), "{said}");
        for step in [1e-6, 1.0, 3.0] {
            let coarse: Vec<f64> = noise.iter().map(|v| (v / step).round() * step).collect();
            assert_eq!(rows_to_a_reading(&coarse), None, "{step}");
        }
        assert_eq!(rows_to_a_reading(&[1.0; 4000]), None, "a dead channel");
    }
}
