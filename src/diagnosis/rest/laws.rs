//! Which slow laws together: every sum of flicker, walk and memory against every other.
//!
//! Selection goes forward one law at a time, and what it took first may since be better told by others: a walk beside a
//! short memory resembles flicker over the decades of one log. So the sums are compared as wholes: of those that do as
//! well the simplest is taken, and those as simple are tied with it.

use super::channel::{Addition, Channel, Fitted, Term};
use super::selection::{CLOSE, contains, needs_all, searched};
use super::spectrum::Law;

/// Ids of the laws that may stand for one another.
pub(super) const SLOW: [&str; 3] = ["flicker-noise", "random-walk", "gauss-markov"];

/// Candidates that did as well as the one chosen, by its id.
pub(super) type Rivals = Vec<(&'static str, Vec<&'static str>)>;

fn is_slow_law(term: &Term) -> bool {
    matches!(term.addition, Addition::Law(Law::Flicker | Law::Walk | Law::Markov(_)))
}

/// Akaike's criterion, turned so that more is better; what all models here share is left out.
fn merit(fitted: &Fitted) -> f64 {
    let numbers: f64 = fitted.terms.iter().map(|t| if t.id == "gauss-markov" { 2.0 } else { 1.0 }).sum();
    2.0 * (fitted.log_likelihood() - numbers)
}

fn slow_ids(fitted: &Fitted) -> Vec<&'static str> {
    fitted.terms.iter().filter(|t| is_slow_law(t)).map(|t| t.id).collect()
}

/// The best sum of slow laws in place of the one selected, and what each of its laws cannot be told from.
pub(super) fn settle(channel: &Channel, selected: Fitted, correction: f64) -> (Fitted, Rivals) {
    let chosen = slow_ids(&selected);
    if chosen.is_empty() {
        return (selected, Vec::new());
    }
    let rest: Vec<Term> = selected.terms.iter().filter(|t| !is_slow_law(t)).cloned().collect();
    let laws = rest.iter().filter(|t| matches!(t.addition, Addition::Law(_))).count();
    let longest = (channel.values.len() as f64 / 4.0).ln();
    let sums = (1..1usize << SLOW.len()).map(|set| {
        let ids: Vec<&'static str> = (0..SLOW.len()).filter(|i| set >> i & 1 == 1).map(|i| SLOW[i]).collect();
        ids
    });
    let fit = |ids: &Vec<&'static str>| {
        let with = |memory: f64| {
            let law = |id: &'static str| match id {
                "flicker-noise" => Law::Flicker,
                "random-walk" => Law::Walk,
                _ => Law::Markov(memory),
            };
            let term = |id| {
                let searched = if id == "gauss-markov" { memory } else { 0.0 };
                Term { id, addition: Addition::Law(law(id)), searched, column: None }
            };
            channel.fit(rest.iter().cloned().chain(ids.iter().map(|id| term(*id))).collect())
        };
        if ids.contains(&"gauss-markov") { searched(1.5f64.ln(), longest, 14, |m| with(m.exp())) } else { with(1.0) }
    };
    // A memory was searched for when it was taken, beside fewer terms than there are now.
    let again = fit(&chosen);
    let selected = if again.log_likelihood() > selected.log_likelihood() { again } else { selected };
    // Four laws beside white noise are all that one spectrum can tell apart; and no sum may hold a law it does not need.
    let open = |ids: &Vec<&'static str>| {
        laws + ids.len() < 5 && !(ids.len() == chosen.len() && ids.iter().all(|i| chosen.contains(i)))
    };
    let mut all: Vec<Fitted> = sums.filter(open).map(|ids| fit(&ids)).collect();
    all.retain(|f| merit(f) > merit(&selected) - CLOSE && needs_all(channel, f, correction));
    all.push(selected);
    let most = all.iter().map(merit).fold(f64::NEG_INFINITY, f64::max);
    // Of those as good as the best the simplest; all of its size are tied with it.
    all.retain(|f| merit(f) > most - CLOSE);
    let fewest = all.iter().map(|f| f.terms.len()).min().unwrap_or(0);
    all.retain(|f| f.terms.len() == fewest);
    let Some(best) = (0..all.len()).max_by(|a, b| merit(&all[*a]).total_cmp(&merit(&all[*b]))) else {
        return (channel.fit(rest), Vec::new());
    };
    let best = all.swap_remove(best);
    let ids = slow_ids(&best);
    let ties: Vec<Vec<&'static str>> = all.iter().map(slow_ids).collect();
    let rivals = ids
        .iter()
        .map(|id| {
            let of = ties.iter().filter(|t| !t.contains(id)).flatten();
            let mut found: Vec<&'static str> = of.copied().filter(|r| !ids.contains(r) && !contains(r, id)).collect();
            found.dedup();
            (*id, found)
        })
        .collect();
    (best, rivals)
}
