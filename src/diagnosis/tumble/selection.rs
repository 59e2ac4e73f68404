//! Which candidates are named: from what nearly every unit has, forward by evidence and backward to
//! drop what is not needed, judged on poses that were held out.

use rand::RngExt;

use super::calibration::Point;
use super::candidate::{Role, Term, terms};
use super::fit::{AS_MEASURED, Fit};
use super::group::{GROUPS, Group};
use super::imu::Observed;
use super::residual::Residual;
use super::start;
use super::units::factor;
use crate::control::{Control, Stopped};
use crate::numerics::order;
use crate::numerics::special::{f_survival, normal_quantile};
use crate::rng::{Philox, Stream};
use crate::sensor::Sense;

/// Chance of a false name that is accepted, over all candidates together.
pub(crate) const FALSE_NAME: f64 = 0.005;
/// Interleaved folds of poses where the model states no split.
const FOLDS: usize = 5;
/// Resamplings of poses for the interval of a gain.
const RESAMPLES: usize = 400;
/// Two models closer than this in the Bayesian information criterion are not told apart (Kass &
/// Raftery 1995: "positive").
const TIED: f64 = 6.0;

/// Which poses are held out together; `None` is never held out.
pub(super) type Folds = Vec<Option<usize>>;

pub(crate) fn interleaved(poses: usize) -> Folds {
    (0..poses).map(|k| Some(k % FOLDS)).collect()
}

/// What one term does to a model.
#[derive(Debug, Clone)]
pub(crate) struct Standing {
    pub term: &'static Term,
    /// Share of the held-out mean square beyond the noise that it removes.
    pub gain: f64,
    /// 95 % interval of the gain.
    pub ci95: [f64; 2],
    /// Corrected for the number of candidates tried.
    pub p_value: f64,
    /// How much the information criterion falls by it; positive is better with it.
    pub criterion: f64,
    /// Whether the recording determines its parameters beside the others.
    pub determined: bool,
    /// Whether its parameters lie where the library allows.
    pub plausible: bool,
    /// Helped, but what it is judged by stayed above the noise.
    pub withdrawn: bool,
    /// Smallest size of each parameter that would have been named, in its public unit.
    pub visible: Vec<f64>,
}

impl Standing {
    /// Whether it may be named.
    pub(super) fn counts(&self) -> bool {
        self.p_value < FALSE_NAME && self.ci95[0] > 0.0 && self.criterion > 0.0 && self.determined && self.plausible
    }

    /// Whether it carries most of what it is judged by, with values outside the range that the
    /// library allows.
    pub(super) fn would_but_for_its_size(&self) -> bool {
        !self.plausible && self.p_value < FALSE_NAME && self.ci95[0] > 0.5 && self.criterion > 0.0 && self.determined
    }
}

/// The outcome of the search.
#[derive(Debug, Clone)]
pub(crate) struct Selection {
    /// The base model, refitted alone.
    pub base: Fit,
    /// Base and named terms together.
    pub chosen: Fit,
    /// Named, strongest first; each judged against the chosen model without it.
    pub named: Vec<Named>,
    /// The rest, judged as an addition to the chosen model.
    pub others: Vec<Standing>,
    /// Sensors whose offsets drift slowly, fitted with the chosen model and not named.
    pub drifting: Vec<Sense>,
}

impl Selection {
    /// The terms named, strongest first.
    pub(super) fn named_terms(&self) -> impl Iterator<Item = &'static Term> {
        self.named.iter().map(|n| n.standing.term)
    }
}

/// A term of the chosen model.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub standing: Standing,
    /// Others that would fit nearly as well in its place.
    pub rivals: Vec<&'static Term>,
}

/// Searches the library.
///
/// # Errors
/// When stopped.
pub(crate) fn select(
    observed: &Observed<'_>,
    guess: &Point,
    folds: &Folds,
    control: &Control,
) -> Result<Selection, Stopped> {
    let with_gyro = observed.imu.gyro.is_some();
    let library = terms(with_gyro, observed.imu.covariate.is_some());
    let base = Fit::new(observed, guess, &start::base(with_gyro), &AS_MEASURED);
    let mut search = Search { observed, folds, control, tried: library.len(), library, banned: Vec::new(), base };
    // Scale and misalignment hide each other: the search begins with all that nearly every unit
    // has, and drops what is not needed. Where poses do not determine all of it, it begins with
    // nothing.
    let usual: Vec<&'static Term> = search.library.iter().copied().filter(|t| t.role == Role::EveryUnit).collect();
    let full = search.fitted(&search.base, &usual);
    let mut state = if full.determined { State { named: usual, model: full } } else { search.bare() };
    loop {
        state = search.settled(state)?;
        let doubtful = search.doubtful(&state);
        if doubtful.is_empty() {
            break;
        }
        // What helps but leaves the residual it is judged by above the noise is not what was left
        // out: it is withdrawn, and the search goes on without it.
        search.banned.extend(&doubtful);
        state.named.retain(|t| !doubtful.contains(t));
        state.model = search.fitted(&state.model, &state.named);
    }
    search.concluded(state)
}

/// A model on the way.
struct State {
    named: Vec<&'static Term>,
    model: Fit,
}

/// What a search has at hand.
struct Search<'a> {
    observed: &'a Observed<'a>,
    folds: &'a Folds,
    control: &'a Control,
    library: Vec<&'static Term>,
    tried: usize,
    banned: Vec<&'static Term>,
    base: Fit,
}

/// Turns of adding and dropping before a search that goes in circles ends.
const ROUNDS: usize = 6;
/// Fraction of the excess over the noise that scale and misalignment must remove from poses held
/// out to be kept although something else is left (lower end of the 95 % interval): less may be the
/// work of stand-ins.
const CARRIES: f64 = 0.5;

impl Search<'_> {
    fn bare(&self) -> State {
        State { named: Vec::new(), model: self.base.clone() }
    }

    /// Base and terms from the point of another model, each group weighed by its own misfit.
    fn fitted(&self, from: &Fit, named: &[&'static Term]) -> Fit {
        let active: Vec<usize> =
            self.base.active.iter().copied().chain(named.iter().flat_map(|t| t.active())).collect();
        let mut start = from.point;
        from.active.iter().filter(|p| !active.contains(p)).for_each(|p| start[*p] = 0.0);
        Fit::balanced(self.observed, &start, &active)
    }

    /// Adds what counts and drops what does not, until nothing is dropped. Adding comes first:
    /// beside a strong effect that is not in the model yet, what belongs there seems not to count.
    fn settled(&self, mut state: State) -> Result<State, Stopped> {
        let mut seen: Vec<Vec<&'static Term>> = Vec::new();
        for _ in 0..ROUNDS {
            loop {
                self.control.go_on()?;
                let free = self.rest(&state).filter(|t| !self.banned.contains(t));
                let judged = free.map(|t| self.with(&state.model, t)).filter(Standing::counts);
                let Some(best) = judged.max_by(|a, b| a.criterion.total_cmp(&b.criterion)) else { break };
                state.named.push(best.term);
                state.model = self.fitted(&state.model, &state.named);
            }
            let before = state.named.len();
            loop {
                self.control.go_on()?;
                let kept = state.named.iter().map(|t| self.within(&state.model, t));
                let weakest = kept.filter(|s| !s.counts()).min_by(|a, b| a.criterion.total_cmp(&b.criterion));
                let Some(weakest) = weakest else { break };
                state.named.retain(|t| *t != weakest.term);
                state.model = self.fitted(&state.model, &state.named);
            }
            if state.named.len() == before || seen.contains(&state.named) {
                break;
            }
            seen.push(state.named.clone());
        }
        Ok(state)
    }

    /// Named terms judged by a residual that stays above its noise, but for scale and misalignment
    /// that carry most of it.
    fn doubtful(&self, state: &State) -> Vec<&'static Term> {
        let above = Residual::of(&state.model).above;
        let doubtful = |group: Group| {
            let own: Vec<&'static Term> =
                state.named.iter().copied().filter(|t| t.judged == group && t.role != Role::Finding).collect();
            if own.is_empty() {
                return own;
            }
            // What only some sensors have needs more than that: a law that nobody knows often looks
            // like a little of it.
            let (usual, rare): (Vec<&'static Term>, Vec<_>) = own.into_iter().partition(|t| t.role == Role::EveryUnit);
            if !rare.is_empty() {
                return rare;
            }
            let rest: Vec<&'static Term> = state.named.iter().copied().filter(|t| !usual.contains(t)).collect();
            let smaller = self.fitted(&state.model, &rest);
            let (_, ci95) = held_out_gain(&smaller, &state.model, group, self.folds);
            if ci95[0] > CARRIES { Vec::new() } else { usual }
        };
        above.iter().flat_map(|(group, _)| doubtful(*group)).collect()
    }

    fn concluded(self, state: State) -> Result<Selection, Stopped> {
        let model = &state.model;
        let mut kept: Vec<Standing> = state.named.iter().map(|t| self.within(model, t)).collect();
        order::sort_by_key(&mut kept, |s| -s.criterion);
        let (findings, kept): (Vec<Standing>, Vec<Standing>) =
            kept.into_iter().partition(|s| s.term.role == Role::Finding);
        let rest = self.rest(&state).filter(|t| t.role != Role::Finding);
        let mut others: Vec<Standing> =
            rest.map(|t| Standing { withdrawn: self.banned.contains(&t), ..self.with(model, t) }).collect();
        order::sort_by_key(&mut others, |s| s.p_value);
        let mut named = Vec::new();
        for standing in kept {
            self.control.go_on()?;
            named.push(Named { rivals: self.rivals(model, &standing, &others), standing });
        }
        let drifts = |sensor: &Sense| findings.iter().any(|s| s.term.sensor == *sensor);
        let drifting = [Sense::Accelerometer, Sense::Gyro].into_iter().filter(drifts).collect();
        Ok(Selection { base: self.base, chosen: state.model, named, others, drifting })
    }

    /// What is not in a model.
    fn rest<'s>(&'s self, state: &'s State) -> impl Iterator<Item = &'static Term> + 's {
        self.library.iter().copied().filter(|t| !state.named.contains(t))
    }

    /// Judges a term as an addition to `model`.
    fn with(&self, model: &Fit, term: &'static Term) -> Standing {
        let active: Vec<usize> = model.active.iter().copied().chain(term.active()).collect();
        let larger = Fit::new(self.observed, &model.point, &active, &model.inflation);
        judge(model, &larger, term, self.folds, self.tried)
    }

    /// Judges a named term against the model without it.
    fn within(&self, model: &Fit, term: &'static Term) -> Standing {
        judge(&self.without(model, term), model, term, self.folds, self.tried)
    }

    fn without(&self, model: &Fit, term: &Term) -> Fit {
        let active: Vec<usize> = model.active.iter().copied().filter(|p| term.active().all(|t| t != *p)).collect();
        let mut start = model.point;
        term.active().for_each(|p| start[p] = 0.0);
        Fit::new(self.observed, &start, &active, &model.inflation)
    }

    /// Terms of the same sensor that would do nearly as well in the place of a named one.
    fn rivals(&self, model: &Fit, standing: &Standing, others: &[Standing]) -> Vec<&'static Term> {
        let smaller = self.without(model, standing.term);
        let mine = criterion(model);
        others
            .iter()
            .filter(|o| o.term.sensor == standing.term.sensor && o.plausible)
            .filter(|o| {
                let active: Vec<usize> = smaller.active.iter().copied().chain(o.term.active()).collect();
                criterion(&Fit::new(self.observed, &smaller.point, &active, &model.inflation)) - mine < TIED
            })
            .map(|o| o.term)
            .collect()
    }
}

fn judge(smaller: &Fit, larger: &Fit, term: &'static Term, folds: &Folds, tried: usize) -> Standing {
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
fn criterion(fit: &Fit) -> f64 {
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

fn held_out_gain(smaller: &Fit, larger: &Fit, group: Group, folds: &Folds) -> (f64, [f64; 2]) {
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

/// Whether no parameter lies outside its range by more than its own uncertainty.
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

/// What is smallest of an effect that would still have been named, in public units: threshold and
/// power of 95 %.
fn visible(deviations: impl Iterator<Item = (usize, f64)>, tried: usize) -> Vec<f64> {
    // Normal quantiles for a two-sided test at the corrected level, plus 1.645 for the power.
    let level = normal_quantile(1.0 - FALSE_NAME / tried.max(1) as f64 / 2.0) + 1.645;
    deviations.map(|(p, d)| level * d * factor(p)).collect()
}
