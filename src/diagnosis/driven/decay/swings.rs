//! Swings of a free motion between its passes through the place of rest: its cycle, where it was let
//! go, where something knocks it again, where it ends.

use std::ops::Range;

use crate::numerics::order;

/// A swing begins and ends beyond this many standard deviations of the noise.
const ABOVE_NOISE: f64 = 5.0;
/// … and beyond this part of the largest swing.
const LEAST: f64 = 0.01;
/// A swing this many times as long as a common one holds a time in which the mass is held.
const HELD: f64 = 1.5;
/// Part of the displacement at which a mass was held that it has after it was let go.
const LET_GO: f64 = 0.9;
/// A swing this many times as large as those before it was knocked, if it is at least this part of
/// the largest one: beats grow more slowly.
const KNOCKED: [f64; 2] = [1.5, 0.2];
/// Swings of a stretch at least.
const FEWEST: usize = 4;

/// One swing to one side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Swing {
    /// First row beyond the threshold.
    from: usize,
    /// Last such row before the other side's first.
    to: usize,
    /// Row of the largest displacement.
    peak: usize,
    /// Absolute value of that displacement.
    size: f64,
}

/// Free motion in a recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    /// Rows of a cycle.
    pub cycle: f64,
    /// Stretches of free motion, ascending.
    pub stretches: Vec<Range<usize>>,
    /// States whether the mass is held before the first stretch.
    pub is_released: bool,
    /// Rows at which it is knocked again.
    pub knocks: Vec<usize>,
}

impl Motion {
    /// The same without knocks: what grows again beats.
    pub(super) fn unbroken(&self) -> Self {
        let (first, last) = (self.stretches[0].start, self.stretches[self.stretches.len() - 1].end);
        Self { stretches: std::iter::once(first..last).collect(), knocks: Vec::new(), ..self.clone() }
    }

    /// The same, knocked again at these rows, too; those that leave fewer than a few swings to a side are left out.
    pub(super) fn broken(&self, hits: &[usize]) -> Self {
        let least = (0.5 * FEWEST as f64 * self.cycle) as usize;
        let mut broken = self.clone();
        for hit in hits {
            let is_apart = |s: &Range<usize>| s.start + least <= *hit && hit + least <= s.end;
            let Some(place) = broken.stretches.iter().position(is_apart) else { continue };
            let end = std::mem::replace(&mut broken.stretches[place].end, *hit);
            // The row between keeps the stretches apart: no segment goes on across a hit.
            broken.stretches.insert(place + 1, *hit + 1..end);
            broken.knocks.push(*hit);
        }
        broken.knocks.sort_unstable();
        broken
    }
}

/// Finds the free motion within some rows, with noise of this deviation; `None` where nothing swings.
pub(crate) fn motion(reading: &[f64], rows: Range<usize>, noise: f64) -> Option<Motion> {
    let y = &reading[rows.clone()];
    let centre = order::median(y[y.len() - (y.len() / 4).max(1)..].to_vec())?;
    let z: Vec<f64> = y.iter().map(|v| v - centre).collect();
    let largest = z.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let swings = swings(&z, (ABOVE_NOISE * noise).max(LEAST * largest));
    let passes: Vec<f64> = swings.windows(2).map(|w| 0.5 * (w[0].to + w[1].from) as f64).collect();
    let halves: Vec<f64> = passes.windows(2).map(|w| w[1] - w[0]).collect();
    let half = order::median(halves)?;
    let loudest = (0..swings.len()).max_by(|a, b| swings[*a].size.total_cmp(&swings[*b].size))?;
    let begins = |i: usize| if i == 0 { 0.0 } else { passes[i - 1] };
    let is_held = |i: usize| passes.get(i).is_some_and(|end| end - begins(i) > HELD * half);
    let mut starts = vec![start(&z, &swings, loudest, is_held(loudest))];
    let mut knocks = Vec::new();
    for i in loudest + 2..swings.len() {
        let before = swings[i - 1].size.max(swings[i - 2].size);
        if swings[i].size > KNOCKED[0] * before && swings[i].size > KNOCKED[1] * swings[loudest].size {
            knocks.push(rows.start + swings[i].from);
            starts.push((i, swings[i].peak));
        }
    }
    // Where friction brings a mass to rest, it may stick a swing earlier or later: no fit follows that.
    let last = swings.last()?.to + 1;
    // A recording that ends before another swing could begin ends with the motion.
    let last = if ((z.len() - last) as f64) < half { z.len() } else { last };
    let mut stretches = Vec::new();
    for (n, (first, from)) in starts.iter().enumerate() {
        let next = starts.get(n + 1);
        let end = next.map_or(last, |(i, _)| swings[i - 1].peak);
        let count = next.map_or(swings.len(), |(i, _)| *i) - first;
        if count >= FEWEST && end > *from {
            stretches.push(rows.start + from..rows.start + end);
        }
    }
    let is_released = is_held(loudest);
    (!stretches.is_empty()).then_some(Motion { cycle: 2.0 * half, stretches, is_released, knocks })
}

/// The swing that a motion begins with and its first row: after it was let go, at the first row of
/// the recording where it begins with the motion, else where it is largest.
fn start(z: &[f64], swings: &[Swing], loudest: usize, is_held: bool) -> (usize, usize) {
    let swing = &swings[loudest];
    if is_held {
        let beyond = |k: &usize| z[*k].abs() >= LET_GO * swing.size;
        return (loudest, (swing.from..=swing.to).rev().find(beyond).unwrap_or(swing.peak));
    }
    (loudest, if loudest == 0 { 0 } else { swing.peak })
}

fn swings(z: &[f64], threshold: f64) -> Vec<Swing> {
    let mut all: Vec<Swing> = Vec::new();
    let mut side = 0.0;
    for (k, v) in z.iter().enumerate().filter(|(_, v)| v.abs() > threshold) {
        match all.last_mut().filter(|_| v.signum() == side) {
            Some(swing) => {
                swing.to = k;
                if v.abs() > swing.size {
                    (swing.peak, swing.size) = (k, v.abs());
                }
            }
            None => all.push(Swing { from: k, to: k, peak: k, size: v.abs() }),
        }
        side = v.signum();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A decay of 40 rows a cycle.
    fn decay(rows: usize, size: f64) -> Vec<f64> {
        (0..rows).map(|k| size * (-(k as f64) / 400.0).exp() * (TAU * k as f64 / 40.0).cos()).collect()
    }

    #[test]
    fn a_decay_that_begins_with_the_recording_is_used_whole() {
        let found = motion(&decay(1200, 1.0), 0..1200, 1e-4).expect("it swings");
        assert!((found.cycle - 40.0).abs() < 1.0 && !found.is_released && found.knocks.is_empty(), "{found:?}");
        assert_eq!(found.stretches.as_slice(), std::slice::from_ref(&(0..1200)));
    }

    #[test]
    fn a_motion_ends_with_its_last_clear_swing_or_with_the_recording() {
        // Below a hundredth of 1 after 400 · ln 100 = 1842 rows.
        let found = motion(&decay(4000, 1.0), 0..4000, 1e-4).expect("it swings");
        assert!((1800..1845).contains(&found.stretches[0].end), "{found:?}");
        // Cut off where it passes through its place of rest: no row is left out.
        let cut = motion(&decay(1210, 1.0), 0..1210, 1e-4).expect("it swings");
        assert_eq!(cut.stretches[0].end, 1210, "{cut:?}");
    }

    // At rest, pushed aside within 100 rows, held for 90, let go at row 490.
    #[test]
    fn a_decay_that_begins_with_a_hold_begins_where_it_is_let_go() {
        let aside = |k: usize| (k as f64 / 100.0).min(1.0);
        let mut y: Vec<f64> = vec![0.0; 300];
        y.extend((0..190).map(aside));
        y.extend(decay(1200, 1.0));
        let found = motion(&y, 0..y.len(), 1e-4).expect("it swings");
        assert!(found.is_released && found.stretches.len() == 1, "{found:?}");
        assert!((490..496).contains(&found.stretches[0].start), "{found:?}");
    }

    #[test]
    fn a_knock_begins_another_stretch() {
        let mut y = decay(800, 1.0);
        y.extend(decay(800, 0.8));
        let found = motion(&y, 0..1600, 1e-4).expect("it swings");
        assert_eq!((found.stretches.len(), found.knocks.len()), (2, 1), "{found:?}");
        // The first row is that of a knock at the top: no row of the second decay comes before it.
        assert!((795..=801).contains(&found.stretches[1].start), "{found:?}");
        assert!(motion(&[0.0; 400], 0..400, 1e-4).is_none());
    }
}
