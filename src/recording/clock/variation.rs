//! Decides whether the sampling rate is the same throughout: a sudden change, a slow drift, or
//! neither.

use super::survey::Stretch;

/// Pieces in which a sudden change is looked for.
const PIECES: usize = 64;
/// Pieces by which a drift is judged.
const COARSE_PIECES: usize = 16;
/// A sudden change by less than this is told as a drift.
const SUDDEN: f64 = 0.01;
/// A drift over more than this has no one rate.
const TOO_FAR: f64 = 0.05;
/// A drift over less than this is not worth a word.
const SLIGHT: f64 = 0.001;
/// Standard errors that a change must be beyond.
const CLEAR: f64 = 6.0;

/// Holds what became of the rate; steps are in the file's unit per sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Variation {
    /// Constant rate.
    None,
    /// Slow, between these steps.
    Slight {
        /// The shortest, and its row where rates are far apart.
        shortest: f64,
        /// The longest step, and its row where rates are far apart.
        longest: f64,
    },
    /// From one step to another, near this row.
    Sudden {
        /// Row of the change.
        row: usize,
        /// Time since the first stamp.
        at: f64,
        /// Step before the change.
        before: f64,
        /// Step after the change.
        after: f64,
    },
    /// Between these steps, at these rows.
    Far {
        /// The shortest, and its row where rates are far apart.
        shortest: (f64, usize),
        /// The longest step and its row.
        longest: (f64, usize),
    },
}

/// States how a stretch tells the step from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Count {
    /// Every row is a sample; stamps are rounded to this, in the file's unit.
    Rows {
        /// Step that stamps are rounded to.
        quantum: f64,
    },
    /// By ticks, of which some may have no row.
    Ticks,
    /// Every row is a sample, at times that are no whole ticks.
    Steps,
}

impl Count {
    fn samples(self, s: &Stretch) -> f64 {
        if self == Count::Ticks { s.ticks } else { s.steps }
    }

    fn step(self, s: &Stretch) -> f64 {
        s.span / self.samples(s)
    }

    /// Relative standard error of the step.
    fn error(self, s: &Stretch) -> f64 {
        match self {
            Count::Rows { quantum } => quantum / s.span,
            // Independent steps; those between stamps that jitter alone are surer.
            Count::Ticks => s.squares.sqrt() / s.span,
            // What is off by more than half a tick counts there as a tick more or less.
            Count::Steps => 2.0 * s.squares.sqrt() / s.span,
        }
    }

    /// Neighbours joined to at most this many pieces, none of them too short to tell a step.
    fn pieces(self, stretches: &[Stretch], most: usize) -> Vec<Stretch> {
        let total: f64 = stretches.iter().map(|s| s.steps).sum();
        let enough = |s: &Stretch| {
            let wide = match self {
                Count::Rows { quantum } => s.span > 20.0 * quantum,
                Count::Ticks | Count::Steps => s.ticks > 0.0,
            };
            wide && s.steps >= total / most as f64
        };
        let mut out: Vec<Stretch> = Vec::new();
        for stretch in stretches {
            match out.last_mut().filter(|last| !enough(last)) {
                Some(last) => *last = last.joined(*stretch),
                None => out.push(*stretch),
            }
        }
        if out.len() > 1 && out.last().is_some_and(|last| !enough(last)) {
            let short = out.pop().unwrap_or_default();
            if let Some(last) = out.last_mut() {
                *last = last.joined(short);
            }
        }
        out.retain(|s| self.samples(s) > 0.0 && s.span > 0.0);
        out
    }
}

/// Judges the stretches of a clock.
pub fn judge(stretches: &[Stretch], count: Count) -> Variation {
    if let Some(sudden) = sudden(stretches, count) {
        return sudden;
    }
    let pieces = count.pieces(stretches, COARSE_PIECES);
    let step = |s: &&Stretch| count.step(s);
    let by_step = |a: &&Stretch, b: &&Stretch| step(a).total_cmp(&step(b));
    let (Some(short), Some(long)) = (pieces.iter().min_by(by_step), pieces.iter().max_by(by_step)) else {
        return Variation::None;
    };
    let (shortest, longest) = (count.step(short), count.step(long));
    let range = longest / shortest - 1.0;
    let chance = CLEAR * count.error(short).hypot(count.error(long));
    if range > TOO_FAR.max(chance) {
        return Variation::Far { shortest: (shortest, short.first_row), longest: (longest, long.first_row) };
    }
    if range > SLIGHT.max(chance) { Variation::Slight { shortest, longest } } else { Variation::None }
}

/// The split that leaves least variance, if one step explains nearly all of it.
fn sudden(stretches: &[Stretch], count: Count) -> Option<Variation> {
    let pieces = count.pieces(stretches, PIECES);
    let mean = |part: &[Stretch]| part.iter().copied().reduce(Stretch::joined).map(|s| (count.step(&s), s));
    let between = |k: usize| {
        let (Some((a, before)), Some((b, after))) = (mean(&pieces[..k]), mean(&pieces[k..])) else { return 0.0 };
        let (m, n) = (count.samples(&before), count.samples(&after));
        (a - b) * (a - b) * m * n / (m + n)
    };
    let split = (1..pieces.len()).max_by(|a, b| between(*a).total_cmp(&between(*b)))?;
    // The pieces next to the split may hold some of either.
    let before = &pieces[..split.saturating_sub(1).max(1)];
    let after = &pieces[(split + 1).min(pieces.len() - 1)..];
    let ((a, all_before), (b, all_after)) = (mean(before)?, mean(after)?);
    let change = (b / a - 1.0).abs();
    let scatter = |part: &[Stretch], mean: f64| {
        (part.iter().map(|s| (count.step(s) - mean).powi(2)).sum::<f64>() / part.len() as f64).sqrt()
    };
    let clear = change > CLEAR * count.error(&all_before).hypot(count.error(&all_after));
    let steady = scatter(before, a).max(scatter(after, b)) < 0.15 * (b - a).abs();
    if change < SUDDEN || !clear || !steady {
        return None;
    }
    // The first short stretch near the split that is nearer to what follows.
    let from = pieces[split.saturating_sub(1)].first_row;
    let near_after = |s: &&Stretch| {
        let step = count.step(s);
        s.first_row >= from && (step - b).abs() < (step - a).abs()
    };
    let first = stretches.iter().find(near_after).copied().unwrap_or(pieces[split]);
    let (early, late): (Vec<Stretch>, Vec<Stretch>) = stretches.iter().partition(|s| s.first_row < first.first_row);
    let (before, after) = (mean(&early).map_or(a, |m| m.0), mean(&late).map_or(b, |m| m.0));
    Some(Variation::Sudden { row: first.first_row, at: first.from, before, after })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretches(step: impl Fn(usize) -> f64) -> Vec<Stretch> {
        (0..200)
            .map(|k| Stretch {
                first_row: 32 * k,
                from: 0.0,
                steps: 32.0,
                span: 32.0 * step(k),
                ticks: 32.0,
                uneven: 0.0,
                squares: 0.0,
            })
            .collect()
    }

    #[test]
    fn a_step_a_drift_and_a_steady_clock_are_told_apart() {
        let judge = |step: &dyn Fn(usize) -> f64| super::judge(&stretches(step), Count::Ticks);
        assert_eq!(judge(&|_| 0.01), Variation::None);
        assert_eq!(judge(&|k| 0.01 * (1.0 + 2e-6 * k as f64)), Variation::None, "an oscillator that warms up");
        for (at, ratio) in [(5, 0.5), (100, 0.95), (195, 1.02)] {
            let Variation::Sudden { row, before, after, .. } = judge(&|k| if k < at { 0.01 } else { 0.01 * ratio })
            else {
                unreachable!("a step by {ratio} at {at}")
            };
            assert!((before - 0.01).abs() < 1e-5 && (after / 0.01 - ratio).abs() < 1e-3, "{before} {after}");
            assert!(row.abs_diff(32 * at) <= 32, "{row}");
        }
        assert!(matches!(judge(&|k| 0.01 * (1.0 + 2e-3 * k as f64)), Variation::Far { .. }));
        assert!(matches!(judge(&|k| 0.01 * (1.0 + 2e-5 * k as f64)), Variation::Slight { .. }));
        assert!(matches!(judge(&|k| if (60..120).contains(&k) { 0.02 } else { 0.01 }), Variation::Far { .. }));
    }
}
