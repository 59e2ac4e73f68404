//! Compares every sum of flicker, walk and memory with every other.
//!
//! Selection goes forward one law at a time, and early choices may be superseded by later ones: a walk next to a short memory resembles flicker over the decades of one log. So the sums
//! are compared as wholes: of those that do as well the simplest is taken, and those as simple are
//! indistinguishable from it. A walk looks like a line with a memory about it too: each law alone
//! is also held against the sum without its straight or settling courses.

use crate::control::{Control, Stopped};

use super::candidate::{MEMORIES, MOST_LAWS, Offer, is_filter, memories, row};
use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::course::is_course;
use super::search;
use super::spectrum::Law;
use super::standing::{ALPHA, CLOSE, contains, needs_all};
use crate::numerics::special::chi_squared_survival;

/// The laws that may stand for one another.
pub(super) const SLOW: [Cause; 3] = [Cause::FlickerNoise, Cause::RandomWalk, Cause::GaussMarkov];

/// Candidates that did as well as the one chosen.
pub(super) type Rivals = Vec<(Cause, Vec<Cause>)>;

fn is_slow_law(term: &Term) -> bool {
    matches!(term.addition, Addition::Law(Law::Flicker | Law::Walk | Law::Markov(_)))
}

/// Akaike's criterion, turned so that more is better; what all models here share is left out.
pub(super) fn minus_aic(fitted: &Fitted) -> f64 {
    let numbers: f64 = fitted.terms.iter().map(|t| row(t.cause).numbers).sum();
    2.0 * (fitted.log_likelihood() - numbers)
}

/// Those that a model holds, in its order.
pub(super) fn slow_laws(fitted: &Fitted) -> Vec<Cause> {
    fitted.terms.iter().filter(|t| is_slow_law(t)).map(|t| t.cause).collect()
}

/// The best sum of slow laws in place of the one selected, and what each of its laws cannot be told
/// from.
///
/// # Errors
/// Stopped.
pub(super) fn settle(
    channel: &Channel,
    selected: Fitted,
    correction: f64,
    control: &Control,
) -> Result<(Fitted, Rivals), Stopped> {
    let chosen = slow_laws(&selected);
    if chosen.is_empty() {
        return Ok((selected, Vec::new()));
    }
    let rest: Vec<Term> = selected.terms.iter().filter(|t| !is_slow_law(t)).cloned().collect();
    let laws = rest.iter().filter(|t| matches!(t.addition, Addition::Law(_))).count();
    let sums = (1..1usize << SLOW.len())
        .map(|set| (0..SLOW.len()).filter(|i| set >> i & 1 == 1).map(|i| SLOW[i]).collect::<Vec<Cause>>());
    let fit_beside = |rest: &[Term], causes: &[Cause]| {
        let with = |memory: f64| {
            let term = |cause| {
                let (law, searched) = match cause {
                    Cause::FlickerNoise => (Law::Flicker, 0.0),
                    Cause::RandomWalk => (Law::Walk, 0.0),
                    _ => (Law::Markov(memory), memory),
                };
                Term { cause, addition: Addition::Law(law), searched, column: None }
            };
            channel.fit(rest.iter().cloned().chain(causes.iter().map(|c| term(*c))).collect())
        };
        let filtered = rest.iter().any(|t| t.cause == Cause::BandLimit);
        match memories(channel.values.len(), filtered).filter(|_| causes.contains(&Cause::GaussMarkov)) {
            Some(range) => search::best(range, MEMORIES, control, |m| with(m.exp())),
            None => Ok(with(1.0)),
        }
    };
    let fit = |causes: &Vec<Cause>| fit_beside(&rest, causes);
    // A memory was searched for when it was taken, next to fewer terms than there are now.
    let again = fit(&chosen)?;
    let selected = if again.log_likelihood() > selected.log_likelihood() { again } else { selected };
    // No sum may hold more laws than one spectrum can tell apart, or a law that it does not need.
    let open = |causes: &Vec<Cause>| {
        laws + causes.len() <= MOST_LAWS && !(causes.len() == chosen.len() && causes.iter().all(|c| chosen.contains(c)))
    };
    let mut all: Vec<Fitted> = sums.filter(open).map(|causes| fit(&causes)).collect::<Result<_, _>>()?;
    let (courses, bare): (Vec<Term>, Vec<Term>) = rest.iter().cloned().partition(|t| is_course(t.cause));
    if !courses.is_empty() {
        for law in SLOW {
            all.push(fit_beside(&bare, &[law])?);
        }
    }
    let more = Beside { channel, rest: &rest, laws: &fit_beside, control }.with_more_courses(laws)?;
    let sums: Vec<&Fitted> = all.iter().chain([&selected]).collect();
    let more: Vec<Fitted> = more.into_iter().filter(|m| leads(m, &sums, correction)).collect();
    all.extend(more);
    all.retain(|f| !is_filter(f) && minus_aic(f) > minus_aic(&selected) - CLOSE && needs_all(channel, f, correction));
    all.push(selected);
    let most = all.iter().map(minus_aic).fold(f64::NEG_INFINITY, f64::max);
    // Of those as good as the best the simplest; all of its size are indistinguishable from it.
    all.retain(|f| minus_aic(f) > most - CLOSE);
    let with_courses = all.iter().filter(|f| f.terms.iter().any(|t| is_course(t.cause)));
    let best_with_courses = with_courses.map(minus_aic).fold(f64::NEG_INFINITY, f64::max);
    let fewest = all.iter().map(|f| f.terms.len()).min().unwrap_or(0);
    all.retain(|f| f.terms.len() == fewest);
    let Some(best) = (0..all.len()).max_by(|a, b| minus_aic(&all[*a]).total_cmp(&minus_aic(&all[*b]))) else {
        return Ok((channel.fit(rest), Vec::new()));
    };
    let best = all.swap_remove(best);
    let causes = slow_laws(&best);
    let ties: Vec<Vec<Cause>> = all.iter().map(slow_laws).collect();
    let rivals = causes
        .iter()
        .map(|cause| {
            let of = ties.iter().filter(|t| !t.contains(cause)).flatten();
            let mut found: Vec<Cause> = of.copied().filter(|r| !causes.contains(r) && !contains(*r, *cause)).collect();
            found.dedup();
            // A course given up for a law that does no better is a rival of that law.
            if !best.terms.iter().any(|t| is_course(t.cause)) && minus_aic(&best) < best_with_courses {
                found.extend(courses.iter().map(|t| t.cause));
            }
            (*cause, found)
        })
        .collect();
    Ok((best, rivals))
}

/// Times that a gain by numbers that are searched for comes more often by chance: a settling time
/// and a memory, as in their rows.
const SEARCHED: f64 = 5.0 * 4.0;

/// Returns whether a model with more courses leads every simpler one by more than chance. Each of
/// its terms is needed next to the others as they were fitted with it; but a memory searched for
/// without the course is another one.
fn leads(with: &Fitted, sums: &[&Fitted], correction: f64) -> bool {
    let numbers = |of: &Fitted| -> f64 { of.terms.iter().map(|t| row(t.cause).numbers).sum() };
    sums.iter().all(|sum| {
        let more = numbers(with) - numbers(sum);
        let gain = 2.0 * (with.log_likelihood() - sum.log_likelihood());
        more <= 0.0 || SEARCHED * chi_squared_survival(gain.max(0.0), more) * correction < ALPHA
    })
}

/// Holds what a course is tried next to: the terms that stay, and fits of slow laws with them.
struct Beside<'a, F> {
    channel: &'a Channel,
    rest: &'a [Term],
    laws: &'a F,
    control: &'a Control,
}

impl<F: Fn(&[Term], &[Cause]) -> Result<Fitted, Stopped>> Beside<'_, F> {
    /// Models with a straight or a settling course more, or both, next to no slow law or one: a law
    /// taken first leaves nothing for a course that does better than it. `laws` are in the model
    /// besides.
    fn with_more_courses(&self, laws: usize) -> Result<Vec<Fitted>, Stopped> {
        let missing: Vec<Cause> =
            [Cause::RateRamp, Cause::WarmUp].into_iter().filter(|c| !self.rest.iter().any(|t| t.cause == *c)).collect();
        let mut out = Vec::new();
        let room = laws < MOST_LAWS;
        for slow in std::iter::once(None).chain(SLOW.map(Some).into_iter().filter(|_| room)) {
            for course in &missing {
                out.extend(self.with(&[*course], slow)?);
            }
            if missing.len() > 1 {
                out.extend(self.with(&missing, slow)?);
            }
        }
        Ok(out)
    }

    /// The model with these courses: each number searched in turn, twice, since a memory that was
    /// fitted without the course has grown to take it up.
    fn with(&self, courses: &[Cause], slow: Option<Cause>) -> Result<Option<Fitted>, Stopped> {
        let Self { channel, control, .. } = *self;
        let slow: Vec<Cause> = slow.into_iter().collect();
        let mut rest = self.rest.to_vec();
        for _ in 0..2 {
            for course in courses {
                rest.retain(|t| t.cause != *course);
                let current = (self.laws)(&rest, &slow)?;
                let offered = (row(*course).offer)(&Offer { channel, current: &current, environment: &[], control })?;
                let Some(term) = offered.into_iter().next().and_then(|mut fitted| fitted.terms.pop()) else {
                    return Ok(None);
                };
                rest.push(term);
            }
        }
        (self.laws)(&rest, &slow).map(Some)
    }
}
