//! From time stamps to a uniform clock: rate, gaps, repeats, jitter; and what is done about each.

use std::ops::Range;
use std::path::Path;

use super::FILL_LIMIT;
use crate::error::{Error, Result};
use crate::numerics::order::median;

/// A step shorter or longer than its number of ticks by this share of a tick is uneven.
const UNEVEN: f64 = 0.25;

/// Where the samples of a uniform clock come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// Sampling rate.
    pub rate_hz: f64,
    /// What was found and survived.
    pub findings: Vec<String>,
    /// First row and weights of that one and the following, per tick; `None` where every row is a tick.
    places: Option<Vec<Place>>,
    kept: Vec<usize>,
    /// Ticks that have no row of their own.
    pub filled: Vec<Range<usize>>,
    /// Share of uneven steps, where there are too many to be ignored.
    uneven: Option<f64>,
    /// Whether every stamp lies within a tick of an even clock.
    near_even: bool,
}

/// Rows from which a value between them is made.
const REACH: usize = 6;

/// First row, and the weights of it and those that follow.
type Place = (usize, [f64; REACH]);

impl Ticks {
    /// Values on the uniform clock: rows as they are, straight lines where a tick has no row, a polynomial through six rows
    /// where the clock is uneven.
    pub fn resample(&self, values: &[f64]) -> Vec<f64> {
        let kept: Vec<f64> = self.kept.iter().map(|row| values[*row]).collect();
        let Some(places) = &self.places else { return kept };
        let at = |(row, weights): &Place| {
            weights.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(j, w)| w * kept[row + j]).sum()
        };
        places.iter().map(at).collect()
    }

    /// Where the stamps are uneven: whether the samples were, or only the stamps, as told by the columns. A signal that was
    /// sampled evenly is smooth row by row, one that was not is smooth only after resampling.
    pub fn settle(&mut self, columns: &[Vec<f64>]) {
        let Some(share) = self.uneven else { return };
        let roughness = |values: &[f64]| -> f64 {
            let fourth = |w: &[f64]| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
            values.windows(5).map(|w| fourth(w).powi(2)).filter(|v| v.is_finite()).sum()
        };
        let ratio = |column: &Vec<f64>| {
            let rows: Vec<f64> = self.kept.iter().map(|row| column[*row]).collect();
            roughness(&self.resample(column)) / roughness(&rows).max(1e-300)
        };
        // Resampling smooths noise by itself, to about a third.
        let smoothest = columns.iter().map(ratio).fold(f64::INFINITY, f64::min);
        let words = format!("the clock is uneven ({:.1} % of the steps are off by more than a quarter)", 100.0 * share);
        let rate = self.rate_hz;
        if self.near_even && smoothest > 0.25 {
            self.places = None;
            self.findings.push(format!("{words}, but the samples are even: taken as {rate:.6} Hz throughout"));
        } else {
            self.findings.push(format!(
                "{words}: resampled to {rate:.6} Hz by polynomials through six rows, which changes what lies near half that \
                 rate"
            ));
        }
    }
}

/// Judges a time column in s. Where `rate_hz` is given as well, the two must agree within 1 %.
///
/// # Errors
/// Time that runs backwards or stands still, more than 5 % of it missing, or a rate that disagrees.
pub fn ticks(path: &Path, times: &[f64], rate_hz: Option<f64>) -> Result<Ticks> {
    let fail = |cause: String, hint: &str| {
        Error::new(format!("could not place {} in time", path.display()), cause, hint.to_owned())
    };
    let mut findings = Vec::new();
    let kept = advancing(times, &mut findings).map_err(|(cause, hint)| fail(cause, hint))?;
    let steps: Vec<f64> = kept.windows(2).map(|w| times[w[1]] - times[w[0]]).collect();
    let median_s = median(steps.clone()).unwrap_or(f64::NAN);
    let part = longest_part(times, &kept, &steps, median_s, &mut findings);
    let (kept, steps) = (&kept[part.clone()], &steps[part.start..part.end - 1]);
    let advance = |step: f64, tick_s: f64| ((step / tick_s + UNEVEN).floor() as usize).max(1);
    let span_s: f64 = steps.iter().sum();
    let tick_s = span_s / steps.iter().map(|s| advance(*s, median_s)).sum::<usize>() as f64;
    let uneven = steps.iter().filter(|s| (**s / tick_s - advance(**s, tick_s) as f64).abs() > UNEVEN).count();
    if !super::RATES_HZ.contains(&(1.0 / tick_s)) {
        return Err(fail(
            format!("its rows are {tick_s:?} s apart"),
            "is this the column that holds the time, and is it in s?",
        ));
    }
    let mut places = None;
    let mut gaps = Vec::new();
    let (mut uneven_share, mut near_even) = (None, false);
    let mut rate = 1.0 / tick_s;
    if uneven as f64 > 0.01 * steps.len() as f64 {
        let grid_s = span_s / steps.len() as f64;
        rate = 1.0 / grid_s;
        places = Some(even_grid(times, kept, grid_s));
        uneven_share = Some(uneven as f64 / steps.len() as f64);
        let first = times[kept[0]];
        near_even = kept.iter().enumerate().all(|(i, row)| (times[*row] - first - i as f64 * grid_s).abs() < grid_s);
    } else {
        // Counted before anything is filled: a logger that wrote in bursts may lack thousands of ticks for every row.
        let ticks = steps.iter().map(|step| advance(*step, tick_s)).sum::<usize>() + 1;
        let missing = ticks - kept.len();
        if missing as f64 > FILL_LIMIT * ticks as f64 {
            let holes = steps.iter().filter(|step| advance(**step, tick_s) > 1).count();
            return Err(fail(
                format!("{missing} of {ticks} samples are missing, in {holes} gaps"),
                "cut the recording to a stretch without gaps",
            ));
        }
        let mut filled: Vec<Place> = Vec::with_capacity(ticks);
        let straight = |row, share: f64| (row, [1.0 - share, share, 0.0, 0.0, 0.0, 0.0]);
        for (row, step) in steps.iter().enumerate() {
            let count = advance(*step, tick_s);
            if count > 1 {
                gaps.push(filled.len() + 1..filled.len() + count);
            }
            filled.extend((0..count).map(|k| straight(row, k as f64 / count as f64)));
        }
        filled.push(straight(kept.len() - 1, 0.0));
        if missing > 0 {
            findings
                .push(format!("{missing} missing samples in {} short gaps were filled by straight lines", gaps.len()));
            places = Some(filled);
        }
    }
    if let Some(stated) = rate_hz {
        let ratio = rate / stated;
        if ratio.is_nan() || (ratio - 1.0).abs() > 0.01 {
            let unit =
                [(1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")].into_iter().find(|(f, _)| (ratio / f - 1.0).abs() < 0.05);
            let hint = match unit {
                Some((_, unit)) => format!("the time column seems to be in {unit}; it must be in s"),
                None => "correct the rate, or leave it out and let the time column decide".to_owned(),
            };
            return Err(fail(format!("the time column says {rate:.6} Hz, the rate given is {stated} Hz"), &hint));
        }
    }
    Ok(Ticks { rate_hz: rate, findings, places, kept: kept.to_vec(), filled: gaps, uneven: uneven_share, near_even })
}

/// Rows whose time is known and later than the one before.
fn advancing(times: &[f64], findings: &mut Vec<String>) -> Result<Vec<usize>, (String, &'static str)> {
    let mut kept: Vec<usize> = Vec::with_capacity(times.len());
    let (mut repeated, mut unknown) = (0, 0);
    for (row, time) in times.iter().enumerate() {
        let before = kept.last().map(|k| times[*k]);
        match before {
            _ if time.is_nan() => unknown += 1,
            Some(before) if *time < before => {
                let cause = format!("time runs backwards in data row {}: {before} s, then {time} s", row + 1);
                return Err((cause, "sort the rows, or cut the file where the clock was reset"));
            }
            Some(before) if *time == before => repeated += 1,
            _ => kept.push(row),
        }
    }
    if kept.len() < 2 || (repeated + unknown) as f64 > FILL_LIMIT * times.len() as f64 {
        let cause =
            format!("of {} time stamps {repeated} repeat the one before and {unknown} are missing", times.len());
        return Err((cause, "if the stamps are only too coarse, give the sampling rate instead of the time column"));
    }
    if repeated > 0 {
        findings.push(format!("{repeated} rows repeat the time stamp before them and were dropped"));
    }
    if unknown > 0 {
        findings.push(format!("{unknown} rows have no time stamp and were dropped"));
    }
    Ok(kept)
}

/// The longest stretch without a gap of more than 1 % of the recording (and ten ticks).
fn longest_part(
    times: &[f64],
    kept: &[usize],
    steps: &[f64],
    median_s: f64,
    findings: &mut Vec<String>,
) -> Range<usize> {
    let limit_s = median_s * (0.01 * kept.len() as f64).max(10.0);
    let mut cuts = vec![0];
    cuts.extend(steps.iter().enumerate().filter(|(_, s)| **s > limit_s).map(|(i, _)| i + 1));
    cuts.push(kept.len());
    let parts = cuts.windows(2).map(|w| w[0]..w[1]);
    let longest = parts.max_by_key(Range::len).filter(|p| p.len() >= 2).unwrap_or(0..kept.len());
    if cuts.len() > 2 {
        findings.push(format!(
            "{} long gaps, the first of {:.3} s after t = {:.3} s; only the longest part is used, {} of {} rows from \
             t = {:.3} s",
            cuts.len() - 2,
            steps[cuts[1] - 1],
            times[kept[cuts[1] - 1]],
            longest.len(),
            kept.len(),
            times[kept[longest.start]]
        ));
    }
    longest
}

fn even_grid(times: &[f64], kept: &[usize], grid_s: f64) -> Vec<Place> {
    let start = times[kept[0]];
    let mut row = 0;
    let at = |tick: usize| {
        let time = start + tick as f64 * grid_s;
        while row + 2 < kept.len() && times[kept[row + 1]] <= time {
            row += 1;
        }
        let reach = REACH.min(kept.len());
        let first = row.saturating_sub(REACH / 2 - 1).min(kept.len() - reach);
        let mut weights = [0.0; REACH];
        for (j, weight) in weights.iter_mut().take(reach).enumerate() {
            // Lagrange's polynomial.
            let here = times[kept[first + j]];
            let others = (0..reach).filter(|m| *m != j).map(|m| times[kept[first + m]]);
            *weight = others.map(|other| (time - other) / (here - other)).product();
        }
        (first, weights)
    };
    (0..kept.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(times: &[f64], rate_hz: Option<f64>) -> Result<Ticks> {
        ticks(Path::new("log.csv"), times, rate_hz)
    }

    fn even(count: usize) -> Vec<f64> {
        (0..count).map(|i| 5.0 + i as f64 * 0.01).collect()
    }

    #[test]
    fn an_even_clock_passes_untouched() {
        let times = even(1000);
        let ticks = judge(&times, Some(100.0)).expect("even");
        assert!((ticks.rate_hz - 100.0).abs() < 1e-6 && ticks.findings.is_empty());
        assert_eq!(ticks.resample(&times), times);
    }

    #[test]
    fn a_short_gap_is_filled_by_a_straight_line_and_a_repeat_dropped() {
        let mut times = even(1000);
        times.drain(400..403);
        times.insert(100, times[100]);
        let ticks = judge(&times, None).expect("survivable");
        let filled = ticks.resample(&times);
        assert_eq!((filled.len(), ticks.findings.len()), (1000, 2), "{:?}", ticks.findings);
        assert!(filled.iter().zip(even(1000)).all(|(got, want)| (got - want).abs() < 1e-9));
    }

    #[test]
    fn at_a_long_gap_the_longer_part_is_kept() {
        let mut times = even(1000);
        times.iter_mut().skip(300).for_each(|t| *t += 60.0);
        let ticks = judge(&times, None).expect("survivable");
        assert_eq!(ticks.resample(&times).len(), 700);
        assert!(ticks.findings[0].contains("longest part"), "{:?}", ticks.findings);
    }

    #[test]
    fn a_clock_in_milliseconds_or_backwards_or_too_coarse_is_refused() {
        let in_ms: Vec<f64> = even(100).iter().map(|t| t * 1e3).collect();
        assert!(judge(&in_ms, Some(100.0)).expect_err("wrong unit").hint.contains("ms"));
        let mut backwards = even(100);
        backwards.swap(50, 51);
        assert!(judge(&backwards, None).expect_err("backwards").cause.contains("row 52"));
        let coarse: Vec<f64> = (0..100).map(|i| (i / 10) as f64).collect();
        assert!(judge(&coarse, None).expect_err("coarse").hint.contains("sampling rate"));
    }

    #[test]
    fn a_log_in_bursts_is_refused_before_its_gaps_are_filled() {
        // Pairs of rows 500 ticks apart: below the 1 % of the rows that cut a recording, yet 250 ticks missing for each row;
        // filled first, they would take gigabytes.
        let times: Vec<f64> = (0..100_000).map(|i| (i / 2 * 501 + i % 2) as f64 * 0.01).collect();
        let refused = judge(&times, None).expect_err("nearly all of it is missing");
        assert!(refused.cause.contains("49999 gaps"), "{refused}");
    }

    #[test]
    fn an_uneven_clock_is_resampled_and_said() {
        let times: Vec<f64> = (0..1000).map(|i| i as f64 + if i % 3 == 1 { 0.4 } else { 0.0 }).collect();
        let mut ticks = judge(&times, None).expect("survivable");
        ticks.settle(std::slice::from_ref(&times));
        let line = ticks.resample(&times);
        assert!(line.windows(2).all(|w| (w[1] - w[0] - 1.0).abs() < 2e-3), "a straight line stays straight");
        assert!(ticks.findings[0].contains("resampled"));
        // Stamps that a busy logger wrote late, of samples that were not.
        let wave: Vec<f64> = (0..1000).map(|i| (0.4 * i as f64).sin()).collect();
        let mut ticks = judge(&times, None).expect("survivable");
        ticks.settle(std::slice::from_ref(&wave));
        assert!(ticks.findings[0].contains("samples are even") && ticks.resample(&wave) == wave);
    }
}
