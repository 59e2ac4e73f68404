//! Finds stretches in which a reading does not change though its noise would have moved it, and
//! leaves them out of the fit.
//!
//! A logger that repeats its last number, or a sensor that hangs, shows a level without noise: no
//! law makes one, and every law that moves slowly is named for it. So such rows are treated as lost
//! ones: a line with the noise of their surroundings takes their place. Not for readings that rest
//! at one number anyway, on coarse steps: there a plateau is no sign.

use std::ops::Range;

use crate::recording::lost;

/// Rows over which the share of readings that repeat the one before is looked at: enough for one to
/// a few per cent, and few enough to see a level that lies in the middle of a step for a while.
const BLOCK: usize = 256;
/// The longest run by chance is near ln n / ln(1/p) in n readings that repeat with probability p
/// (Erdős & Rényi 1970); the margin is that of the reading's health (`recording::health`).
const MARGIN: f64 = 4.0;
/// Fewer rows than this are no stretch, whatever the chance of them.
const FEWEST: f64 = 20.0;
/// Lengths of runs, one after the other, of which one at least is no chance where all are frozen: a run that fills a block
/// stands for a faithful one until it is taken out itself.
const FELLOWS: usize = 3;
/// With more of the rows frozen, the rest is no surroundings to fill them from.
const MOST: f64 = 0.5;

/// Takes stretches that do not change out of values, with those that were filled in already; returns
/// them.
pub(super) fn take_out(values: &mut [f64], filled: &[Range<usize>]) -> Vec<Range<usize>> {
    let stuck = find(values, filled);
    for stretch in &stuck {
        bridge(values, stretch);
    }
    let mut all: Vec<Range<usize>> = filled.iter().chain(&stuck).cloned().collect();
    all.sort_by_key(|gap| gap.start);
    lost::draw(values, &all);
    stuck
}

/// Puts a straight line between the readings about a stretch.
fn bridge(values: &mut [f64], stretch: &Range<usize>) {
    let before = stretch.start.checked_sub(1).and_then(|n| values.get(n).copied());
    let after = values.get(stretch.end).copied();
    let Some((from, to)) = before.or(after).zip(after.or(before)) else { return };
    let width = (stretch.len() + 1) as f64;
    for (n, value) in values[stretch.clone()].iter_mut().enumerate() {
        *value = from + (to - from) * (n + 1) as f64 / width;
    }
}

/// Stretches of one value that are longer than chance makes them, in their order.
fn find(values: &[f64], filled: &[Range<usize>]) -> Vec<Range<usize>> {
    let runs = runs(values, filled);
    let mut lengths: Vec<usize> = runs.iter().map(Range::len).filter(|l| *l as f64 > FEWEST).collect();
    lengths.sort_unstable_by(|a, b| b.cmp(a));
    lengths.dedup();
    // From the longest down, as long as what is shorter does not explain it, unless that is frozen itself.
    let frozen: Vec<bool> = lengths.iter().map(|l| is_frozen(*l, values.len(), &runs)).collect();
    let explained =
        frozen.windows(FELLOWS.min(frozen.len().max(1))).position(|some| !some.contains(&true)).unwrap_or(frozen.len());
    let least = frozen[..explained].iter().rposition(|is| *is).map(|n| lengths[n]);
    let Some(least) = least else { return Vec::new() };
    let stuck: Vec<Range<usize>> = runs.into_iter().filter(|run| run.len() >= least).collect();
    let rows: usize = stuck.iter().map(Range::len).sum();
    if rows as f64 > MOST * values.len() as f64 { Vec::new() } else { stuck }
}

/// Runs of one value over two readings and more; rows that were filled in are in none.
fn runs(values: &[f64], filled: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut is_filled = vec![false; values.len()];
    for gap in filled.iter().filter(|gap| gap.end <= values.len()) {
        is_filled[gap.clone()].fill(true);
    }
    let mut out = Vec::new();
    let mut from = 0;
    for n in 1..=values.len() {
        if n < values.len() && values[n] == values[from] && is_filled[n] == is_filled[from] {
            continue;
        }
        if n - from > 1 && !is_filled[from] {
            out.push(from..n);
        }
        from = n;
    }
    out
}

/// Returns whether runs of this length are longer than the most faithful block of the other
/// readings would give.
fn is_frozen(length: usize, count: usize, runs: &[Range<usize>]) -> bool {
    // By block: readings outside such runs, and those of them that repeat the one before.
    let mut blocks = vec![(BLOCK.min(count), 0usize); count.div_ceil(BLOCK)];
    for run in runs {
        for n in run.clone() {
            let (outside, repeats) = &mut blocks[n / BLOCK];
            if run.len() >= length {
                *outside = outside.saturating_sub(1);
            } else if n > run.start {
                *repeats += 1;
            }
        }
    }
    let whole = blocks.iter().filter(|(outside, _)| 2 * outside > BLOCK);
    let share = whole.map(|(outside, repeats)| (*repeats as f64 + 1.0) / *outside as f64).fold(0.0, f64::max);
    let chance = share.clamp(1.0 / count as f64, 0.999);
    length as f64 > FEWEST - MARGIN * (count as f64).ln() / chance.ln()
}

/// Stretches that are listed one by one, at most.
const LISTED: usize = 3;

/// Says which rows of which channels were left out: those that froze together in one sentence. Rows
/// are counted from the first of the file.
pub(super) fn sentences(channels: &[&String], stretches: &[Vec<Range<usize>>], rows: usize) -> Vec<String> {
    let mut out = Vec::new();
    let mut rest: Vec<_> = channels.iter().zip(stretches).filter(|(_, stretches)| !stretches.is_empty()).collect();
    while let Some((_, first)) = rest.first().copied() {
        let (alike, others): (Vec<_>, Vec<_>) = rest.into_iter().partition(|(_, stretches)| *stretches == first);
        let names: Vec<String> = alike.iter().map(|(name, _)| format!("`{name}`")).collect();
        out.push(sentence(&names.join(", "), first, rows));
        rest = others;
    }
    out
}

fn sentence(names: &str, stretches: &[Range<usize>], rows: usize) -> String {
    let lost: usize = stretches.iter().map(Range::len).sum();
    let each = |s: &Range<usize>| format!("{} rows from row {}", s.len(), s.start);
    let listed: Vec<String> = stretches.iter().take(LISTED).map(each).collect();
    let more = match stretches.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!(
        "{names}: {lost} of {rows} rows do not change and were left out of the fit as lost ones ({}{more})",
        listed.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 20_000;

    fn rounded(step: f64, drift: f64, member: u64) -> Vec<f64> {
        let mut rng = Philox::new(61, member, Stream::Host);
        let at = |n: usize| drift * n as f64 / COUNT as f64;
        (0..COUNT).map(|n| (at(n) + rng.normal()) / step).map(|v| v.round() * step).collect()
    }

    #[test]
    fn frozen_stretches_are_found_to_the_row_and_replaced_by_noise() {
        for (member, step) in [1e-6, 0.1, 0.5].into_iter().enumerate() {
            let mut values = rounded(step, 0.0, member as u64);
            let planted = [3000..3100, 9000..9400, 15_000..15_100];
            for stretch in planted.clone() {
                let last = values[stretch.start];
                values[stretch.clone()].fill(last);
                // The readings about it are others.
                values[stretch.start - 1] = last + step;
                values[stretch.end] = last - step;
            }
            assert_eq!(take_out(&mut values, &[]), planted, "{step}");
            for stretch in planted {
                let mean = values[stretch.clone()].iter().sum::<f64>() / stretch.len() as f64;
                let square = values[stretch.clone()].iter().map(|v| (v - mean).powi(2)).sum::<f64>();
                let variance = square / stretch.len() as f64;
                // Of a hundred squares of normal noise: four standard deviations, √(2/100) each.
                assert!((variance - 1.0).abs() < 0.6, "{step} {stretch:?}: {variance}");
            }
        }
    }

    // Readings on steps of three to ten standard deviations rest wherever the value lies within a
    // step, and hop where it lies near an edge: a drift goes from one to the other.
    #[test]
    fn readings_that_rest_on_coarse_steps_are_not_frozen_and_neither_is_noise() {
        for (member, (step, drift)) in
            [(1e-6, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, 20.0), (10.0, 40.0), (10.0, 0.0)].into_iter().enumerate()
        {
            let values = rounded(step, drift, 10 + member as u64);
            assert_eq!(find(&values, &[]), [], "{step} {drift}");
        }
        // Rows that were filled in with one value are lost already.
        let mut values = rounded(1e-6, 0.0, 20);
        values[5000..5200].fill(0.0);
        assert_eq!(find(&values, std::slice::from_ref(&(5000..5200))), []);
    }

    #[test]
    fn every_row_is_said_once() {
        let names = ["x", "y", "z", "w"].map(String::from);
        let (both, one) = (vec![5..30, 50..90], std::iter::once(5..30).collect::<Vec<_>>());
        let stretches = [both.clone(), one, both, Vec::new()];
        let names: Vec<&String> = names.iter().collect();
        assert_eq!(
            sentences(&names, &stretches, 100),
            [
                "`x`, `z`: 65 of 100 rows do not change and were left out of the fit as lost ones (25 rows from row 5, \
                 40 rows from row 50)",
                "`y`: 25 of 100 rows do not change and were left out of the fit as lost ones (25 rows from row 5)"
            ]
        );
    }
}
