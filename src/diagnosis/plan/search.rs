//! The search for the shortest experiment: all that the limits allow at one length after the other, by
//! one linear step of each rival, and the most promising by the search that a diagnosis makes.

use crate::control::{Control, Stopped};
use crate::driven::base::ZETA;
use crate::error::{Error, Result};
use crate::number::short;
use crate::numerics::order;
use crate::parallel;

use super::chance::Comparisons;
use super::experiment::{self, Experiment, Shape};
use super::limits::{Limit, Limits};
use super::question::{Known, Purpose, Question};
use super::simulated::{Motion, Truth};
use super::strength::{SHORTEST, lengths, settled};

/// Experiments of one length that are looked at closely.
const FINALISTS: usize = 3;
/// Laws that a truth is held against at other values than the most likely ones.
const NEAREST: usize = 5;
/// Doublings of a limit that are looked at.
const DOUBLINGS: i32 = 6;

/// An experiment and what a diagnosis of it would say.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// The experiment.
    pub experiment: Experiment,
    /// Probability that the diagnosis decides rightly, where each rival is as likely to be true as another; no
    /// more than where none of them is.
    pub probability: f64,
    /// The same for each rival, in order, and where none of them is true.
    pub each: Vec<f64>,
    /// Half the width of the 95 % interval of the first rival's first parameter.
    pub half_width: Option<f64>,
    /// Laws that come nearest to each rival; empty where it was held against the others by one linear step.
    nearest: Vec<Vec<&'static str>>,
}

/// The limit that is most in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Binding {
    /// Which one.
    pub limit: Limit,
    /// Times that it would have to be as large; `None` where no such factor was found.
    pub factor: Option<f64>,
    /// Probability at twice the limit, for each of them.
    pub doubled: [(Limit, f64); 3],
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The question, with the strength of what is to be shown.
    pub question: Question,
    /// The best experiment, and the next best of another shape.
    pub best: Vec<Proposal>,
    /// True where the best one answers the question.
    pub reached: bool,
    /// The shortest multisine over the whole band, at the largest input, that does as well.
    pub broadband: Option<Proposal>,
    /// The limit in the way, where the best one does not.
    pub binding: Option<Binding>,
}

impl Planned {
    /// The best experiment and the next best.
    pub fn proposals(&self) -> impl Iterator<Item = &Proposal> {
        self.best.iter()
    }
}

pub(super) fn stopped(by: Stopped) -> Error {
    by.during("stopped planning", "nothing was written; run it again, or with a shorter longest_s")
}

/// Finds it.
///
/// # Errors
/// When stopped; where no experiment can be simulated.
pub fn search(question: &Question, limits: &Limits, probability: f64, control: &Control) -> Result<Planned> {
    let nothing = || {
        Error::new(
            "could not plan an experiment",
            format!(
                "none can be simulated with largest_input_m_s2 = {}, rate_hz = {} and longest_s = {} about a resonance of {} Hz",
                limits.largest_input_m_s2,
                limits.rate_hz,
                limits.longest_s,
                short(question.sensor.resonance_hz())
            ),
            format!(
                "need a rate above twice the resonance, {} cycles of it and {} samples, and a motion that stays finite and within largest_reading",
                SHORTEST.0, SHORTEST.1
            ),
        )
    };
    if question.sensor.resonance_hz() >= 0.5 * limits.rate_hz {
        return Err(nothing());
    }
    let question = settled(question, limits).ok_or_else(nothing)?;
    let look = Look { question: &question, limits, probability, control };
    let best = look.shortest().map_err(stopped)?;
    let Some(first) = best.first() else { return Err(nothing()) };
    let reached = look.is_reached(first);
    let broadband = if reached { look.broadband(first).map_err(stopped)? } else { None };
    let binding = if reached { None } else { Some(look.binding(first).map_err(stopped)?) };
    Ok(Planned { question: question.clone(), reached, best, broadband, binding })
}

/// The mean of all rivals, and no more than the last: where none of them is true.
fn overall(each: &[f64]) -> f64 {
    let Some((none, rivals)) = each.split_last() else { return 0.0 };
    none.min(rivals.iter().sum::<f64>() / rivals.len().max(1) as f64)
}

/// Care that is taken with an experiment.
#[derive(Clone, Copy)]
enum Care<'a> {
    /// The rivals against each other, by one linear step.
    Nearly,
    /// All laws, by the search of a diagnosis.
    Closely,
    /// The same, of the laws that came nearest in another one.
    Like(&'a Proposal),
}

/// Laws that the truth is held against.
enum Against {
    /// All of the library, by the search of a diagnosis.
    All,
    /// Some, by the same search.
    These(Vec<&'static str>),
    /// The tied ones, by one linear step.
    Tied,
}

/// An experiment under one truth.
struct Seen {
    /// Probability that the diagnosis decides rightly.
    decides: f64,
    /// Half the width of the law's interval, where that is asked.
    half_width: Option<f64>,
    /// The laws that come nearest to it.
    nearest: Vec<&'static str>,
}

/// A search within some limits.
struct Look<'a> {
    question: &'a Question,
    limits: &'a Limits,
    probability: f64,
    control: &'a Control,
}

impl Look<'_> {
    /// Returns whether an experiment answers the question.
    fn is_reached(&self, proposal: &Proposal) -> bool {
        match &self.question.purpose {
            Purpose::Narrow(interval) => proposal.half_width.is_some_and(|h| h <= 0.5 * interval.half_width),
            Purpose::Decide | Purpose::Show(_) => proposal.probability >= self.probability,
        }
    }

    /// Better ones first.
    fn rank(&self, proposals: &mut [Proposal]) {
        let is_narrowing = matches!(self.question.purpose, Purpose::Narrow(_));
        let width = |p: &Proposal| p.half_width.unwrap_or(f64::INFINITY);
        order::sort_by_key(proposals, |p| if is_narrowing { width(p) } else { -p.probability });
    }

    /// An experiment as a diagnosis would see it. `None` where it cannot be simulated.
    fn proposal(&self, experiment: Experiment, care: Care<'_>) -> Result<Option<Proposal>, Stopped> {
        let (mut each, mut half_width, mut nearest) = (Vec::new(), None, Vec::new());
        for (place, rival) in self.question.rivals.iter().enumerate() {
            let against = match care {
                Care::Nearly => Against::Tied,
                Care::Closely => Against::All,
                Care::Like(other) => other.nearest.get(place).map_or(Against::All, |n| Against::These(n.clone())),
            };
            let Some(seen) = self.where_true(Some(rival), &experiment, &against)? else { return Ok(None) };
            half_width = half_width.or(seen.half_width);
            each.push(seen.decides);
            nearest.push(seen.nearest);
        }
        let Some(silent) = self.where_true(None, &experiment, &Against::Tied)? else { return Ok(None) };
        each.push(silent.decides);
        if matches!(care, Care::Nearly) {
            nearest.clear();
        }
        Ok(Some(Proposal { experiment, probability: overall(&each), each, half_width, nearest }))
    }

    /// A proposal averaged over all likely values; at those where the experiment cannot be done it decides nothing.
    fn widened(&self, mut proposal: Proposal) -> Result<Proposal, Stopped> {
        if self.question.purpose != Purpose::Decide {
            return Ok(proposal);
        }
        for (place, rival) in self.question.rivals.iter().enumerate() {
            let near = Against::These(proposal.nearest.get(place).cloned().unwrap_or_default());
            let likely = rival.each_likely();
            let mut decides = proposal.each[place];
            for other in &likely {
                decides += self.where_true(Some(other), &proposal.experiment, &near)?.map_or(0.0, |seen| seen.decides);
            }
            proposal.each[place] = decides / (likely.len() + 1) as f64;
        }
        proposal.probability = overall(&proposal.each);
        Ok(proposal)
    }

    /// An experiment where a law is true, or none. `None` where it cannot be simulated.
    fn where_true(
        &self,
        own: Option<&Known>,
        experiment: &Experiment,
        against: &Against,
    ) -> Result<Option<Seen>, Stopped> {
        self.control.go_on()?;
        let q = self.question;
        let truth = Truth { sensor: q.sensor_with(own), common: &q.common, own };
        let Some(motion) = Motion::of(&truth, experiment, self.limits) else { return Ok(None) };
        let tells = own.is_some() && motion.tells_apart();
        let mut rivals = match against {
            Against::All if tells => motion.best(|_| true, self.control)?,
            Against::These(ids) if tells => motion.best(|id| ids.contains(&id), self.control)?,
            _ => motion.nearly(&q.rivals),
        };
        let comparisons = Comparisons {
            rows: motion.rows(),
            without: motion.without(),
            values: own.map_or(0, |k| k.term.values()),
            rivals: &rivals,
            tried: Motion::tried(),
        };
        let decides = match own {
            Some(_) if tells => comparisons.named(),
            Some(_) => 0.0,
            None => comparisons.silent(),
        };
        let asks_width = matches!(q.purpose, Purpose::Narrow(_)) && own.is_some();
        order::sort_by_key(&mut rivals, |r| r.fitted);
        Ok(Some(Seen {
            decides,
            half_width: if asks_width { motion.half_width() } else { None },
            nearest: rivals.iter().take(NEAREST).map(|r| r.id).collect(),
        }))
    }

    fn all(&self, shapes: &[(Shape, f64)], seconds: f64, care: Care<'_>) -> Result<Vec<Proposal>, Stopped> {
        let rate_hz = self.limits.rate_hz;
        let looked = parallel::map(shapes, |(shape, level)| {
            self.proposal(Experiment { shape: *shape, level: *level, seconds, rate_hz }, care)
        });
        let mut found: Vec<Proposal> =
            looked.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        self.rank(&mut found);
        Ok(found)
    }

    /// The best of one length: all by one step, the most promising with more care, the first of these at all likely
    /// values. Those by one step if none answers the question, unless `always`.
    fn best(
        &self,
        shapes: &[(Shape, f64)],
        seconds: f64,
        always: bool,
        care: Care<'_>,
    ) -> Result<Vec<Proposal>, Stopped> {
        let promising = self.all(shapes, seconds, Care::Nearly)?;
        if !always && !promising.first().is_some_and(|p| self.is_reached(p)) {
            return Ok(promising);
        }
        let finalists: Vec<(Shape, f64)> =
            promising.iter().take(FINALISTS).map(|p| (p.experiment.shape, p.experiment.level)).collect();
        let mut closely = self.all(&finalists, seconds, care)?;
        let is_worth_it = closely.first().is_some_and(|p| always || self.is_reached(p));
        if is_worth_it {
            closely[0] = self.widened(closely[0].clone())?;
        }
        Ok(closely)
    }

    /// The shortest experiments that answer the question, the best and the next best of another shape; those of
    /// the longest where none does.
    fn shortest(&self) -> Result<Vec<Proposal>, Stopped> {
        let (hz, zeta) = (self.question.sensor.resonance_hz(), self.question.sensor.base[ZETA]);
        let progress =
            self.control.stage("lengths of experiments", lengths(self.limits, &self.question.sensor).len() as u64);
        let shapes = experiment::all(self.limits, hz, zeta);
        let mut best = self.shortest_of(&shapes, 0.0, Care::Closely, || progress.step())?;
        let Some(first) = best.first().map(|p| p.experiment.shape) else { return Ok(best) };
        let other = best.iter().position(|p| p.experiment.shape != first);
        let next = other.map(|at| self.widened(best.swap_remove(at))).transpose()?;
        best.truncate(1);
        best.extend(next);
        if !self.is_reached(&best[0]) {
            self.rank(&mut best);
        }
        Ok(best)
    }

    /// The shortest of some shapes that answer the question, no shorter than this; the best of the longest where
    /// none does.
    fn shortest_of(
        &self,
        shapes: &[(Shape, f64)],
        from_s: f64,
        care: Care<'_>,
        looked: impl Fn(),
    ) -> Result<Vec<Proposal>, Stopped> {
        let lengths = lengths(self.limits, &self.question.sensor);
        for (i, seconds) in lengths.iter().enumerate().filter(|(_, s)| **s >= from_s) {
            let is_last = i + 1 == lengths.len();
            let found = self.best(shapes, *seconds, is_last, care)?;
            looked();
            if is_last || found.first().is_some_and(|p| self.is_reached(p)) {
                return self.shortened(found, i.checked_sub(1).map_or(*seconds, |i| lengths[i]));
            }
        }
        Ok(Vec::new())
    }

    /// The same with the best made shorter, down to this length, while it answers the question.
    fn shortened(&self, mut found: Vec<Proposal>, from_s: f64) -> Result<Vec<Proposal>, Stopped> {
        let Some(first) = found.first() else { return Ok(found) };
        let (mut low, mut high) = (from_s, first.experiment.seconds);
        for _ in 0..2 {
            if !self.is_reached(&found[0]) || low >= high {
                break;
            }
            let seconds = (low * high).sqrt();
            let shorter = self.proposal(Experiment { seconds, ..found[0].experiment }, Care::Like(&found[0]))?;
            let shorter = shorter.filter(|p| self.is_reached(p)).map(|p| self.widened(p)).transpose()?;
            match shorter.filter(|p| self.is_reached(p)) {
                Some(shorter) => (found[0], high) = (shorter, seconds),
                None => low = seconds,
            }
        }
        Ok(found)
    }

    /// The shortest broadband multisine that does as well as an experiment.
    fn broadband(&self, best: &Proposal) -> Result<Option<Proposal>, Stopped> {
        let shape = [experiment::broadband(self.limits, self.question.sensor.resonance_hz())];
        let found = self.shortest_of(&shape, 0.5 * best.experiment.seconds, Care::Like(best), || ())?;
        Ok(found.into_iter().next().filter(|p| self.is_reached(p)))
    }

    /// The limit that, doubled, helps most, and by how much it would have to grow.
    fn binding(&self, best: &Proposal) -> Result<Binding, Stopped> {
        let progress = self.control.stage("limits doubled", 3 + DOUBLINGS as u64);
        let Experiment { shape, level, .. } = best.experiment;
        let with = |limit: Limit, factor: f64| -> Result<Option<Proposal>, Stopped> {
            let limits = self.limits.with(limit, factor);
            let look = Look { limits: &limits, ..*self };
            let grown = [(shape, if limit == Limit::Input { factor * level } else { level })];
            progress.step();
            let Some(seconds) = lengths(&limits, &self.question.sensor).last().copied() else { return Ok(None) };
            let found = look.all(&grown, seconds, Care::Like(best))?.into_iter().next();
            found.map(|p| look.widened(p)).transpose()
        };
        let mut doubled = Limit::ALL.map(|limit| (limit, best.clone()));
        for (limit, proposal) in &mut doubled {
            if let Some(found) = with(*limit, 2.0)? {
                *proposal = found;
            }
        }
        let mut ranked: Vec<Proposal> = doubled.iter().map(|d| d.1.clone()).collect();
        self.rank(&mut ranked);
        let limit = doubled.iter().find(|d| d.1 == ranked[0]).map_or(Limit::Input, |d| d.0);
        let mut factor = self.is_reached(&ranked[0]).then_some(2.0);
        for power in 2..=DOUBLINGS {
            if factor.is_some() {
                break;
            }
            let grown = 2f64.powi(power);
            factor = with(limit, grown)?.is_some_and(|p| self.is_reached(&p)).then_some(grown);
        }
        Ok(Binding { limit, factor, doubled: doubled.map(|(limit, p)| (limit, p.probability)) })
    }
}
