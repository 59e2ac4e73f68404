//! What is wrong with a column before any physics: missing values, a dead channel, touched rails, a stuck stretch.

use std::path::Path;

use super::{Column, FILL_LIMIT};
use crate::error::{Error, Result};

/// Replaces missing values by straight lines between their neighbours, and says so.
///
/// # Errors
/// When more than 5 % of the values are missing.
pub fn fill(path: &Path, name: &str, values: &mut [f64]) -> Result<Option<String>> {
    let missing = values.iter().filter(|v| v.is_nan()).count();
    if missing == 0 {
        return Ok(None);
    }
    let share = missing as f64 / values.len() as f64;
    if share > FILL_LIMIT {
        return Err(Error::new(
            format!("could not use column `{name}` of {}", path.display()),
            format!("{missing} of {} values are missing", values.len()),
            "leave the column out, or cut the recording to a stretch where it was logged",
        ));
    }
    let mut longest = 0;
    let mut row = 0;
    while row < values.len() {
        if !values[row].is_nan() {
            row += 1;
            continue;
        }
        let end = (row..values.len()).find(|r| !values[*r].is_nan()).unwrap_or(values.len());
        let before = row.checked_sub(1).map(|r| values[r]);
        let after = values.get(end).copied();
        let (left, right) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
        let count = end - row;
        for k in 0..count {
            values[row + k] = left + (right - left) * (k + 1) as f64 / (count + 1) as f64;
        }
        longest = longest.max(count);
        row = end;
    }
    Ok(Some(format!("`{name}`: {missing} missing values were filled by straight lines, at most {longest} in a row")))
}

/// What else a person should know of a column.
pub fn findings(column: &Column) -> Vec<String> {
    let Column { name, values } = column;
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if low == high {
        return vec![format!("`{name}` is constant ({low}): a dead channel?")];
    }
    let mut out = Vec::new();
    for (rail, side) in [(high, "above"), (low, "below")] {
        if let Some(rows) = at_rail(values, rail) {
            out.push(format!("`{name}` stays at {rail} in {rows} rows and never goes {side}: clipped?"));
        }
    }
    if let Some((start, rows)) = stuck(values).filter(|(start, _)| values[*start] != low && values[*start] != high) {
        out.push(format!("`{name}` does not change for {rows} rows from row {start}: stuck?"));
    }
    out
}

/// Rows at an extreme value, where they are far too many for an unclipped reading: more than three times those at the
/// next value inwards. (A quantised sine has at most 2.4 times; a two-level input is no clipped one, hence nine levels.)
fn at_rail(values: &[f64], rail: f64) -> Option<usize> {
    let rows = values.iter().filter(|v| **v == rail).count();
    if rows < 10 {
        return None;
    }
    let next =
        values.iter().copied().filter(|v| *v != rail).min_by(|a, b| (a - rail).abs().total_cmp(&(b - rail).abs()))?;
    let beside = values.iter().filter(|v| **v == next).count();
    let mut levels: Vec<f64> = Vec::new();
    for value in values {
        if !levels.contains(value) {
            levels.push(*value);
        }
        if levels.len() > 8 {
            return (rows > 3 * beside).then_some(rows);
        }
    }
    None
}

/// Start and length of the longest run of one value, where chance would hardly make it so long.
fn stuck(values: &[f64]) -> Option<(usize, usize)> {
    let (mut best, mut start, mut repeats) = ((0, 0), 0, 0usize);
    for row in 1..=values.len() {
        if row < values.len() && values[row] == values[row - 1] {
            repeats += 1;
            continue;
        }
        if row - start > best.1 {
            best = (start, row - start);
        }
        start = row;
    }
    let others = repeats.saturating_sub(best.1) as f64;
    let chance = ((others + 1.0) / values.len() as f64).min(0.999);
    // The longest run in n draws that repeat with this chance is near ln n / ln(1/chance).
    let expected = (values.len() as f64).ln() / -chance.ln();
    (best.1 as f64 > 20.0 + 4.0 * expected).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(values: Vec<f64>) -> Vec<String> {
        findings(&Column { name: "x".into(), values })
    }

    fn sine(amplitude: f64) -> Vec<f64> {
        (0..5000).map(|i| amplitude * (f64::from(i) * 0.0123).sin()).collect()
    }

    #[test]
    fn holes_are_bridged_and_too_many_refused() {
        let nan = f64::NAN;
        let mut values = [vec![nan, 1.0, nan, nan, 4.0], vec![5.0; 95]].concat();
        let finding = fill(Path::new("log.csv"), "x", &mut values).expect("few").expect("said");
        assert_eq!(values[..5], [1.0, 1.0, 2.0, 3.0, 4.0]);
        assert!(finding.contains("3 missing"), "{finding}");
        assert!(fill(Path::new("log.csv"), "x", &mut [nan, 1.0, 2.0]).is_err());
    }

    #[test]
    fn dead_clipped_and_stuck_channels_are_told_and_healthy_ones_left_alone() {
        assert!(judge(vec![3.0; 100])[0].contains("dead"));
        assert_eq!(judge(sine(1.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect()).len(), 2);
        let mut frozen = sine(1.0);
        frozen[1000..1400].fill(0.5);
        assert!(judge(frozen)[0].contains("stuck"));
        assert!(judge(sine(1.0)).is_empty());
        assert!(judge(sine(6.3).iter().map(|v| v.round()).collect()).is_empty(), "a coarse reading is not clipped");
        let square = (0..5000).map(|i| if i / 50 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(judge(square).is_empty(), "a two-level input is not clipped");
    }
}
