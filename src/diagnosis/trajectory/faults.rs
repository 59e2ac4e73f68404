//! Stretches in which a reference of attitude does not turn as the gyro does: leaps, standing
//! still, losing the body. They are found before anything is fitted, listed with their rows and
//! left out.
//!
//! The reference's rate over short windows is held against what the gyro reads there, along one
//! robust alignment for all of the recording. Wrong is what no sensor makes of a right reference: a
//! difference larger than half of what the gyro turns nearby, and by far larger than the usual one.
//! Smaller errors are for the fit and for `reference-noise`. Not for faults of positions.

use nalgebra::Vector3;

use super::alignment::{Alignment, turning};
use super::log::{Log, Motion};
use super::rates::{Rates, WINDOW_S};
use crate::number::rounded;
use crate::numerics::order;

/// Difference over the quickest turn nearby: scale factor, axes, low-pass and lag together make
/// less.
const HALF: f64 = 0.5;
/// Difference over the usual one, as for rows of the fit.
const APART: f64 = 8.0;
/// Quartile of the length of three normal numbers, in their deviation (χ², 3 degrees of freedom).
const QUARTILE: f64 = 1.10;
/// A stretch between two faults must last longer to be believed, s: where the motion turns round,
/// a wrong reference agrees with it for a moment.
const TOGETHER_S: f64 = 2.0;
/// Left out next to a fault at least, in poses: a bin of the fit.
const BESIDE: f64 = 3.0;
/// Of what remains, how much the alignment must explain; the part of the turning windows that must
/// remain; and how long they must last, s.
const REMAINS: (f64, f64, f64) = (0.9, 0.25, 10.0);
/// A step is a leap where it is so many times quicker than the gyro reads anywhere, and the
/// reference stands still where it turns by less than this part of what the gyro does.
const LEAPS: f64 = 2.0;
const STANDS: f64 = 0.2;
/// Rows that are listed.
const LISTED: usize = 8;

/// A stretch that is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    /// Its first pose and the one behind its last.
    pub poses: [usize; 2],
    /// Poses behind which it leaps, and by how much, rad.
    pub leaps: Vec<(usize, f64)>,
    /// States whether the reference stands while the gyro turns.
    pub stands: bool,
}

/// One window: what both read, and by how much they differ.
struct Compared {
    poses: [usize; 2],
    reference: Vector3<f64>,
    read: Vector3<f64>,
    apart: f64,
}

/// The faults of a reference, in order of time, with the alignment that they stand out from;
/// nothing where too little would remain: then it is no matter of stretches.
pub(super) fn find(log: &Log, masked: &[bool], motion: &Motion) -> Option<(Vec<Fault>, Alignment)> {
    let alignment = Alignment::of(&Rates::some(log, masked, motion))?;
    let rates = Rates::all(log, masked, motion);
    let compared: Vec<Compared> = rates
        .windows
        .iter()
        .filter_map(|w| {
            let read = rates.read(w, alignment.late_s)?;
            let apart = (read - alignment.expected(&w.rate)).norm();
            Some(Compared { poses: w.poses, reference: w.rate, read, apart })
        })
        .collect();
    let pairs = |wanted: &dyn Fn(&Compared) -> bool| -> Vec<(Vector3<f64>, Vector3<f64>)> {
        compared.iter().filter(|c| wanted(c)).map(|c| (c.reference, c.read)).collect()
    };
    let all = pairs(&|_| true);
    let turns = turning(&all).into_iter().map(|(_, y)| y.norm()).fold(f64::INFINITY, f64::min);
    let quarter = |least: f64| {
        let mut apart: Vec<f64> = compared.iter().filter(|c| c.read.norm() >= least).map(|c| c.apart).collect();
        order::sort(&mut apart);
        if apart.is_empty() { 0.0 } else { order::quantile(&apart, 0.25) }
    };
    let usual = quarter(0.0).max(quarter(turns)) / QUARTILE;
    let is_wrong = |k: usize| {
        let near = &compared[k.saturating_sub(2)..(k + 3).min(compared.len())];
        let quickest = near.iter().map(|c| c.read.norm()).fold(0.0, f64::max);
        compared[k].apart > HALF * quickest + APART * usual
    };
    let time = &motion.time_s;
    let quickest = log.rate.iter().map(Vector3::norm).fold(0.0, f64::max);
    let leaps = leaps(motion, quickest);
    let windows = (0..compared.len()).filter(|k| is_wrong(*k)).map(|k| compared[k].poses);
    let wrong = joined(windows.chain(leaps.iter().map(|l| [l.0, l.0 + 1])).collect(), time, TOGETHER_S);
    // What lies between two of them is believed where the alignment explains it.
    let is_believed = |[from, to]: [usize; 2]| {
        let inside = compared.iter().filter(|c| c.poses[0] >= from && c.poses[1] <= to);
        let (apart, least) = inside.fold((0.0, 0.0), |(apart, least), c| {
            let spare = (1.0 - REMAINS.0) * c.read.norm_squared() + APART * usual * usual;
            (apart + c.apart * c.apart, least + spare)
        });
        apart <= least
    };
    let ends = [0].into_iter().chain(wrong.iter().map(|w| w[1]));
    let between = ends.zip(wrong.iter().map(|w| w[0]).chain([time.len() - 1])).map(|(from, to)| [from, to]);
    let doubted: Vec<[usize; 2]> = between.filter(|b| b[1] > b[0] && !wrong.is_empty() && !is_believed(*b)).collect();
    let beside_s = WINDOW_S.max(BESIDE * motion.interval_s);
    let faults: Vec<Fault> = joined(wrong.into_iter().chain(doubted).collect(), time, TOGETHER_S)
        .into_iter()
        .map(|[from, to]| {
            let inside = pairs(&|c| c.poses[0] >= from && c.poses[1] <= to);
            let length = |x: &Vector3<f64>| x.norm().min(LEAPS * quickest);
            let [reference, read] = inside.iter().fold([0.0, 0.0], |s, (x, y)| [s[0] + length(x), s[1] + length(y)]);
            let poses = [
                time.partition_point(|t| *t < time[from] - beside_s),
                time.partition_point(|t| *t <= time[to] + beside_s),
            ];
            let leaps = leaps.iter().copied().filter(|l| (from..to).contains(&l.0)).collect();
            Fault { poses, leaps, stands: reference < STANDS * read }
        })
        .collect();
    let is_left = |c: &Compared| faults.iter().all(|f| c.poses[1] < f.poses[0] || c.poses[0] >= f.poses[1]);
    let left = pairs(&is_left);
    let apart: f64 = compared.iter().filter(|c| is_left(c)).map(|c| c.apart * c.apart).sum();
    let square: f64 = left.iter().map(|(_, y)| y.norm_squared()).sum();
    let turning_left = left.iter().filter(|(_, y)| y.norm() >= turns).count() as f64;
    let lost: f64 = faults.iter().map(|f| time[f.poses[1] - 1] - time[f.poses[0]]).sum();
    let is_enough = apart <= (1.0 - REMAINS.0) * square
        && turning_left >= REMAINS.1 * turning(&all).len() as f64
        && time[time.len() - 1] - time[0] - lost >= REMAINS.2;
    is_enough.then_some((faults, alignment))
}

/// Stretches in order, those together that less than a time parts.
fn joined(mut stretches: Vec<[usize; 2]>, time_s: &[f64], together_s: f64) -> Vec<[usize; 2]> {
    stretches.sort_unstable();
    let mut all: Vec<[usize; 2]> = Vec::new();
    for [from, to] in stretches {
        match all.last_mut() {
            Some(last) if time_s[from] - time_s[last[1]] < together_s => last[1] = last[1].max(to),
            _ => all.push([from, to]),
        }
    }
    all
}

/// Poses behind which the reference turns quicker than the gyro, which reads this at most, reads
/// anywhere, by far more than from pose to pose as a rule; and by what angle, rad.
fn leaps(motion: &Motion, quickest: f64) -> Vec<(usize, f64)> {
    let time = &motion.time_s;
    let angles: Vec<f64> = motion.attitude.windows(2).map(|q| q[0].angle_to(&q[1])).collect();
    let rate = |k: usize| angles[k] / (time[k + 1] - time[k]);
    let mut sorted: Vec<f64> = (0..angles.len()).map(rate).collect();
    order::sort(&mut sorted);
    let most = LEAPS * quickest + if sorted.is_empty() { 0.0 } else { APART * order::quantile(&sorted, 0.25) };
    (0..angles.len()).filter(|k| rate(*k) > most).map(|k| (k, angles[k])).collect()
}

/// The poses without the faults.
pub(super) fn sound(faults: &[Fault], motion: &Motion) -> Motion {
    let ranges: Vec<[usize; 2]> = faults.iter().map(|f| f.poses).collect();
    motion.without(&ranges)
}

/// Returns what is said of them, each sentence for the list of what was found in the files.
pub(super) fn words(faults: &[Fault], motion: &Motion) -> Vec<String> {
    if faults.is_empty() {
        return Vec::new();
    }
    let row = |pose: usize| motion.row[pose];
    let listed = |all: &[String]| match all.len().checked_sub(LISTED).filter(|more| *more > 0) {
        Some(more) => format!("{} and {more} more", all[..LISTED].join(", ")),
        None => all.join(", "),
    };
    let rows = |wanted: &dyn Fn(&Fault) -> bool| -> Vec<String> {
        let ends = |f: &Fault| format!("{} to {}", row(f.poses[0]), row(f.poses[1] - 1));
        faults.iter().filter(|f| wanted(f)).map(ends).collect()
    };
    let time = &motion.time_s;
    let lost: f64 = faults.iter().map(|f| time[f.poses[1] - 1] - time[f.poses[0]]).sum();
    let all_s = time[time.len() - 1] - time[0];
    let mut words = vec![format!(
        "the reference does not turn as the gyro does for {} of {} s, which are left out: its rows {}",
        rounded(lost, 3),
        rounded(all_s, 3),
        listed(&rows(&|_| true))
    )];
    let mut leaps: Vec<(usize, f64)> = faults.iter().flat_map(|f| f.leaps.iter().copied()).collect();
    if let Some(widest) = leaps.iter().map(|l| l.1).max_by(f64::total_cmp) {
        let count = leaps.len();
        leaps.sort_by_key(|l| l.0);
        let behind: Vec<String> = leaps.iter().map(|l| row(l.0).to_string()).collect();
        words.push(format!(
            "the reference leaps {count} times, by up to {}° from one row to the next, quicker than twice the gyro's \
             quickest: behind its rows {}",
            rounded(widest.to_degrees(), 3),
            listed(&behind)
        ));
    }
    let standing = rows(&|f| f.stands);
    if !standing.is_empty() {
        words.push(format!("the reference stands still while the gyro turns: its rows {}", listed(&standing)));
    }
    words
}
