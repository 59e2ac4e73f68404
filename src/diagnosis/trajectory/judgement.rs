//! States what one candidate does to a model: its interval by a jackknife over blocks of time, and
//! what held-out blocks say.
//!
//! Residuals are coloured and the reference's errors change with the motion: no formula for white
//! noise is trusted alone.

use nalgebra::{DMatrix, DVector};

use super::blocks::{BLOCKS, Linear};
use super::candidate::Term;
use super::parameters::Point;
use super::{shown, slow};
use crate::numerics::special::{chi_squared_survival, f_survival, t_quantile};
use crate::remainder::REAL;

/// Chance of a false name that is accepted, over all candidates together: what every kind calls
/// real.
pub(super) const FALSE_NAME: f64 = REAL;
/// Correlation of neighbouring residuals up to which they count as white. One half of the band then
/// has up to 2/π of this fraction of the power too much (spectrum 1 + 2ρ cos ω): a fall by less may
/// be that alone.
pub(super) const COLOUR: f64 = 0.1;
/// Interleaved parts of the blocks that are held out in turn.
const FOLDS: usize = 5;

/// Holds what one term does to a model.
#[derive(Debug, Clone)]
pub(super) struct Standing {
    /// The candidate that was judged.
    pub term: &'static Term,
    /// Fraction of the held-out mean square beyond the noise that it removes.
    pub gain: f64,
    /// 95 % interval of the gain.
    pub ci95: [f64; 2],
    /// Corrected for the number of candidates tried.
    pub p_value: f64,
    /// By how much the held-out sum of squares falls, in units of the noise.
    pub fall: f64,
    /// The lower end of its 95 % interval.
    pub least_fall: f64,
    /// States whether its parameters lie where the library allows.
    pub plausible: bool,
    /// The largest of them, as it is stated, SI.
    pub largest: f64,
    /// States whether one of them is large enough to cost anything, and the fall is large enough to
    /// be no matter of the noise's colour.
    pub matters: bool,
    /// Half-widths of the 95 % intervals of its parameters, SI.
    pub half_widths: Vec<f64>,
}

impl Standing {
    /// Parameters that the motion determines: the others are left as they are without the candidate.
    pub(super) fn determined(&self) -> impl Iterator<Item = usize> {
        self.each().filter(|(.., is_known)| *is_known).map(|(p, ..)| p)
    }

    /// Names of those that it does not determine.
    pub(super) fn undetermined(&self) -> Vec<&'static str> {
        self.each().filter(|(.., is_known)| !is_known).map(|(_, name, _)| name).collect()
    }

    /// Each parameter with its name, and whether it is known.
    fn each(&self) -> impl Iterator<Item = (usize, &'static str, bool)> {
        let known = self.half_widths.iter().map(|half| self.term.knows(*half));
        self.term.parameters.clone().zip(self.term.names).zip(known).map(|((p, name), known)| (p, *name, known))
    }

    /// Returns whether it may be named.
    pub(super) fn counts(&self) -> bool {
        self.holds() && self.matters
    }

    /// Returns whether it is there, whatever its size.
    pub(super) fn holds(&self) -> bool {
        self.p_value < FALSE_NAME && self.least_fall > 0.0 && self.plausible
    }
}

/// Half the width of the 95 % interval of a number that is made of parameters: delete-one-block
/// jackknife, and no less than white noise would give.
pub(super) fn half_width(of: &dyn Fn(&Point) -> f64, replicates: &[Point], white: f64) -> f64 {
    let n = replicates.len() as f64;
    let values: Vec<f64> = replicates.iter().map(of).collect();
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n - 1.0) / n;
    t_quantile(0.975, n - 1.0) * variance.sqrt().max(white)
}

/// Holds what is asked of a candidate.
pub(super) struct Question<'a> {
    /// The linearised model, summed by block.
    pub linear: &'a Linear,
    /// Indices of the parameters without the candidate.
    pub smaller: &'a [usize],
    /// Indices of the parameters with it.
    pub larger: &'a [usize],
    /// The candidate that is judged.
    pub term: &'static Term,
    /// Below which angle times gravity nothing is blamed on the accelerometer, rad.
    pub tilt_rad: f64,
    /// Fraction of the held-out sum of squares that must fall.
    pub least_part: f64,
    /// From one reading to the next, s.
    pub interval_s: f64,
}

/// Parameters of a candidate as a fit of everything in a model has them.
struct Own {
    value: DVector<f64>,
    /// Their covariance under white noise.
    white: DMatrix<f64>,
    /// States whether the motion shows each.
    shows: Vec<bool>,
    replicates: Vec<Point>,
    /// Half-widths of their 95 % intervals, SI.
    half_widths: Vec<f64>,
}

impl Own {
    fn of(linear: &Linear, model: &[usize], own: &[usize]) -> Self {
        let solved = linear.solve(model, |_| true);
        let replicates = linear.replicates(model);
        let place = |p: &usize| model.iter().position(|q| q == p).unwrap_or_default();
        let places: Vec<usize> = own.iter().map(place).collect();
        let white = DMatrix::from_fn(own.len(), own.len(), |i, j| solved.covariance[(places[i], places[j])]);
        let apart = slow::apart(linear, model, &solved);
        let shared = |i: usize, p: usize| shown::shared(linear, p, white[(i, i)]);
        let half = |(i, p): (usize, &usize)| {
            let of = |point: &Point| point[*p];
            let by_block = half_width(&of, &replicates, white[(i, i)].max(0.0).sqrt());
            by_block.max(slow::half_width(&of, &solved.point, &apart)) + shared(i, *p)
        };
        let half_widths = own.iter().enumerate().map(half).collect();
        let moved = DVector::from_iterator(own.len(), own.iter().enumerate().map(|(i, p)| shared(i, *p).powi(2)));
        let shows = own.iter().enumerate().map(|(i, p)| shown::shows(linear, *p, white[(i, i)])).collect();
        Self {
            value: DVector::from_fn(own.len(), |i, _| solved.point[own[i]]),
            white: white + DMatrix::from_diagonal(&moved),
            shows,
            replicates,
            half_widths,
        }
    }

    fn chance(&self, own: &[usize]) -> f64 {
        let by_block = chance(&self.value, &jackknife(&self.replicates, own), self.replicates.len());
        by_block.max(chance(&self.value, &self.white, usize::MAX))
    }
}

/// Judges one candidate of `tried`, by which its p-value is corrected.
///
/// Leaves at zero those of its numbers that the motion does not determine, or that come out as none of such sensors
/// has: a turn about one axis that is misaligned shows on the others as a scale of any size. They say nothing for or
/// against the rest.
pub(super) fn judge(question: &Question<'_>, tried: usize) -> Standing {
    let Question { linear, smaller, larger, term, tilt_rad, least_part, interval_s } = *question;
    let all: Vec<usize> = term.parameters.clone().filter(|p| larger.contains(p)).collect();
    let whole = Own::of(linear, larger, &all);
    let place = |p: usize| all.iter().position(|q| *q == p);
    let tells = |i: usize| {
        whole.shows[i] && term.knows(whole.half_widths[i]) && term.allows(whole.value[i], whole.half_widths[i])
    };
    let told: Vec<usize> = all.iter().enumerate().filter(|(i, _)| tells(*i)).map(|(_, p)| *p).collect();
    let partly = !told.is_empty() && told.len() < all.len();
    let half = |p: usize| place(p).filter(|i| !partly || tells(*i)).map_or(f64::INFINITY, |i| whole.half_widths[i]);
    let half_widths: Vec<f64> = term.parameters.clone().map(half).collect();
    let larger: Vec<usize> =
        larger.iter().copied().filter(|p| !partly || !all.contains(p) || told.contains(p)).collect();
    let (own, fit) = if partly { (&told, Own::of(linear, &larger, &told)) } else { (&all, whole) };
    let held = HeldOut::of(linear, smaller, &larger);
    let (fall, [least_fall, most_fall]) = held.interval(|(before, after, _)| before - after);
    // Of what lies above the noise before.
    let above = held.above().max(fall).max(f64::MIN_POSITIVE);
    Standing {
        term,
        gain: fall / above,
        ci95: [least_fall / above, most_fall / above],
        p_value: (fit.chance(own) * tried as f64).min(1.0),
        fall,
        least_fall,
        plausible: !told.is_empty() && fit.value.iter().zip(&fit.half_widths).all(|(v, half)| term.allows(*v, *half)),
        largest: fit.value.iter().map(|v| term.size(v.abs())).fold(0.0, f64::max),
        matters: fit.value.iter().any(|v| term.matters(*v, tilt_rad, interval_s))
            && fall >= least_part * held.sums(usize::MAX).0,
        half_widths,
    }
}

fn jackknife(replicates: &[Point], own: &[usize]) -> DMatrix<f64> {
    let n = replicates.len() as f64;
    let mean = DVector::from_fn(own.len(), |i, _| replicates.iter().map(|r| r[own[i]]).sum::<f64>() / n);
    let mut covariance = DMatrix::zeros(own.len(), own.len());
    for replicate in replicates {
        let apart = DVector::from_fn(own.len(), |i, _| replicate[own[i]] - mean[i]);
        covariance += &apart * apart.transpose() * ((n - 1.0) / n);
    }
    covariance
}

/// Chance that parameters which are zero come out like this: Hotelling's T², or χ² where the
/// covariance is known.
fn chance(value: &DVector<f64>, covariance: &DMatrix<f64>, blocks: usize) -> f64 {
    let k = value.len() as f64;
    // In units of the deviations, so that it can be inverted whatever the units.
    let scale = covariance.diagonal().map(|v| v.max(f64::MIN_POSITIVE).sqrt());
    let scaled = DMatrix::from_fn(value.len(), value.len(), |i, j| covariance[(i, j)] / (scale[i] * scale[j]));
    let Some(inverse) = (scaled + DMatrix::identity(value.len(), value.len()) * 1e-9).try_inverse() else { return 1.0 };
    let unit = value.component_div(&scale);
    let square = unit.dot(&(inverse * &unit));
    if blocks == usize::MAX {
        return chi_squared_survival(square, k);
    }
    let n = blocks as f64;
    if n <= k { 1.0 } else { f_survival(square * (n - k) / (k * (n - 1.0)), k, n - k) }
}

/// Sums of squares of blocks that were held out, before and after, in units of the noise.
#[derive(Debug, Clone)]
pub(super) struct HeldOut {
    blocks: Vec<(f64, f64, f64)>,
}

impl HeldOut {
    /// Of two models, each fitted on the other four fifths of the blocks.
    pub(super) fn of(linear: &Linear, smaller: &[usize], larger: &[usize]) -> Self {
        let mut blocks = Vec::new();
        for fold in 0..FOLDS {
            let fitted = |active: &[usize]| linear.solve(active, |b| b % FOLDS != fold).point;
            let (before, after) = (fitted(smaller), fitted(larger));
            for block in (0..BLOCKS).filter(|b| b % FOLDS == fold) {
                let sum = |point: &Point| {
                    let all = (0..linear.sensors.len()).map(|s| linear.squares(s, block, point));
                    all.fold((0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
                };
                let ((b, n), (a, _)) = (sum(&before), sum(&after));
                if n > 0 {
                    blocks.push((b, a, n as f64));
                }
            }
        }
        Self { blocks }
    }

    fn sums(&self, skip: usize) -> (f64, f64, f64) {
        let kept = self.blocks.iter().enumerate().filter(|(k, _)| *k != skip);
        kept.fold((0.0, 0.0, 0.0), |s, (_, b)| (s.0 + b.0, s.1 + b.1, s.2 + b.2))
    }

    /// Returns what lies above the noise before.
    fn above(&self) -> f64 {
        let (before, _, n) = self.sums(usize::MAX);
        before - n
    }

    /// Root mean squares before and after.
    pub(super) fn rms(&self) -> [f64; 2] {
        let (before, after, n) = self.sums(usize::MAX);
        [before, after].map(|s| (s / n.max(1.0)).sqrt())
    }

    /// Value and 95 % interval of a number by leaving out each block in turn.
    fn interval(&self, of: impl Fn((f64, f64, f64)) -> f64) -> (f64, [f64; 2]) {
        let n = self.blocks.len() as f64;
        let value = of(self.sums(usize::MAX));
        let each: Vec<f64> = (0..self.blocks.len()).map(|k| of(self.sums(k))).collect();
        let mean = each.iter().sum::<f64>() / n;
        let deviation = (each.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt();
        let half = t_quantile(0.975, (n - 1.0).max(1.0)) * deviation;
        (value, [value - half, value + half])
    }

    /// Probability that noise of this mean square leaves as much after, by the χ² of all held-out
    /// rows: they are whitened, so each counts.
    pub(super) fn chance_after(&self, mean_square: f64) -> f64 {
        let (_, after, rows) = self.sums(usize::MAX);
        chi_squared_survival(after / mean_square, rows)
    }

    /// 95 % interval of the ratio of root mean squares.
    pub(super) fn ratio(&self) -> [f64; 2] {
        let log = |(before, after, _): (f64, f64, f64)| 0.5 * (after / before.max(f64::MIN_POSITIVE)).ln();
        self.interval(log).1.map(f64::exp)
    }
}
