//! States what one term does to a model: its gain on poses held out, its probability by chance, the
//! criterion by which models are compared, and what of it would have been seen.

use rand::RngExt;

use super::candidate::Term;
use super::fit::Fit;
use super::group::{GROUPS, Group};
use super::units::factor;
use crate::numerics::order;
use crate::numerics::special::{f_survival, normal_quantile};
use crate::rng::{Philox, Stream};

/// Chance of a false name that is accepted, over all candidates together.
pub(crate) const FALSE_NAME: f64 = 0.005;
/// Resamplings of poses for the interval of a gain.
const RESAMPLES: usize = 400;
/// Which poses are held out together; `None` is never held out.
pub(super) type Folds = Vec<Option<usize>>;

/// Holds what one term does to a model.
#[derive(Debug, Clone)]
pub(crate) struct Standing {
    pub term: &'static Term,
    /// Share of the held-out mean square beyond the noise that it removes.
    pub gain: f64,
    /// 95 % interval of the gain.
    pub ci95: [f64; 2],
    /// Corrected for the number of candidates tried.
    pub p_value: f64,
    /// States how much the information criterion falls by it; positive is better with it.
    pub criterion: f64,
    /// States whether the recording determines its parameters next to the others.
    pub determined: bool,
    /// States whether its parameters lie where the library allows.
    pub plausible: bool,
    /// Helped, but what it is judged by stayed above the noise.
    pub withdrawn: bool,
    /// Smallest size of each parameter that would have been named, in its public unit.
    pub visible: Vec<f64>,
}

impl Standing {
    /// Returns whether it may be named.
    pub(super) fn counts(&self) -> bool {
        self.p_value < FALSE_NAME && self.ci95[0] > 0.0 && self.criterion > 0.0 && self.determined && self.plausible
    }

    /// Returns whether it carries most of what it is judged by, with values outside the range that
    /// the library allows.
    pub(super) fn would_but_for_its_size(&self) -> bool {
        !self.plausible && self.p_value < FALSE_NAME && self.ci95[0] > 0.5 && self.criterion > 0.0 && self.determined
    }
}

/// Judges a term by the model with it against the one without.
pub(super) fn judge(smaller: &Fit, larger: &Fit, term: &'static Term, folds: &Folds, tried: usize) -> Standing {
    let spent = (larger.active.len() - smaller.active.len()).max(1) as f64;
    // Each group is weighed by what is left of it, so that another effect's mismatch counts as
    // noise here.
    let improvement: f64 = GROUPS
        .iter()
        .map(|g| (smaller.rows.chi_square(*g).0 - larger.rows.chi_square(*g).0) / larger.reduced(*g).max(1.0))
        .sum();
    let degrees_of_freedom = larger.rows.chi_square(term.judged).1 as f64 - larger.leverage(term.judged);
    let p = if degrees_of_freedom >= 1.0 {
        f_survival((improvement / spent).max(0.0), spent, degrees_of_freedom)
    } else {
        1.0
    };
    let (gain, ci95) = held_out_gain(smaller, larger, term.judged, folds);
    Standing {
        term,
        gain,
        ci95,
        p_value: (p * tried as f64).clamp(0.0, 1.0),
        criterion: criterion(smaller) - criterion(larger),
        determined: larger.determined,
        plausible: plausible(larger, term),
        withdrawn: false,
        visible: {
            let deviations = larger.deviations();
            let own = larger.active.iter().copied().zip(deviations).filter(|(p, _)| term.active().any(|t| t == *p));
            visible(own, tried)
        },
    }
}

/// Bayesian information criterion with each group's own scale, never below its measured noise.
pub(super) fn criterion(fit: &Fit) -> f64 {
    let mut rows = 0;
    let misfit: f64 = GROUPS
        .iter()
        .map(|g| {
            let (sum, n) = fit.rows.chi_square(*g);
            rows += n;
            let scale = (sum / (n as f64).max(1.0)).max(1.0);
            sum / scale + n as f64 * scale.ln()
        })
        .sum();
    misfit + fit.active.len() as f64 * (rows as f64).max(1.0).ln()
}

/// Per pose the sum of squares of held-out residuals over their noise, and how many there are;
/// `None` without any.
pub(crate) fn held_out_squares(fit: &Fit, group: Group, folds: &Folds) -> Vec<Option<(f64, usize)>> {
    let residual = fit.held_out(folds);
    let mut out = vec![None; folds.len()];
    for r in (0..residual.len()).filter(|r| fit.rows.group[*r] == group) {
        let pose = fit.rows.pose[r];
        if folds[pose].is_some() {
            let entry: &mut (f64, usize) = out[pose].get_or_insert((0.0, 0));
            entry.0 += residual[r].powi(2);
            entry.1 += 1;
        }
    }
    out
}

pub(super) fn held_out_gain(smaller: &Fit, larger: &Fit, group: Group, folds: &Folds) -> (f64, [f64; 2]) {
    let (before, after) = (held_out_squares(smaller, group, folds), held_out_squares(larger, group, folds));
    let pairs: Vec<(f64, f64, f64)> = before
        .iter()
        .zip(&after)
        .filter_map(|(b, a)| Some((b.as_ref()?.0, a.as_ref()?.0, a.as_ref()?.1 as f64)))
        .collect();
    if pairs.is_empty() {
        return (0.0, [0.0; 2]);
    }
    let gain = |chosen: &mut dyn Iterator<Item = usize>| {
        let (b, a, n) = chosen.fold((0.0, 0.0, 0.0), |s, k| (s.0 + pairs[k].0, s.1 + pairs[k].1, s.2 + pairs[k].2));
        // Where the base is at the noise already, the share of nothing would be any number: a tenth
        // is the least.
        ((b - a) / (b - n).max(0.1 * b).max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0)
    };
    let mut rng = Philox::new(1, group as u64, Stream::Host);
    let mut resampled: Vec<f64> = (0..RESAMPLES)
        .map(|_| gain(&mut (0..pairs.len()).map(|_| rng.random_range(0..pairs.len())).collect::<Vec<_>>().into_iter()))
        .collect();
    order::sort(&mut resampled);
    let quantile = |q: f64| resampled[((RESAMPLES - 1) as f64 * q).round() as usize];
    (gain(&mut (0..pairs.len())), [quantile(0.025), quantile(0.975)])
}

/// Returns whether no parameter lies outside its range by more than its own uncertainty.
fn plausible(fit: &Fit, term: &Term) -> bool {
    let deviations = fit.deviations();
    let ranges = term.candidate.parameters;
    term.parameters.iter().enumerate().all(|(n, range)| {
        let stated = ranges.get(n).or(ranges.last()).map_or((f64::NEG_INFINITY, f64::INFINITY), |p| p.range);
        range.clone().all(|p| {
            let (unit, spread) =
                (factor(p), 3.0 * fit.active.iter().position(|a| *a == p).map_or(0.0, |c| deviations[c]));
            let value = fit.point[p];
            (value - spread) * unit <= stated.1 && (value + spread) * unit >= stated.0
        })
    })
}

/// Returns the smallest of an effect that would still have been named, in public units:
/// threshold and power of 95 %.
fn visible(deviations: impl Iterator<Item = (usize, f64)>, tried: usize) -> Vec<f64> {
    // Normal quantiles for a two-sided test at the corrected level, plus 1.645 for the power.
    let level = normal_quantile(1.0 - FALSE_NAME / tried.max(1) as f64 / 2.0) + 1.645;
    deviations.map(|(p, d)| level * d * factor(p)).collect()
}
