//! Slow drift that channels share: temperature, or another common cause, without a column that
//! shows it.
//!
//! The slow part of one channel is offered to another as if it were an environment column, on top
//! of the other's own noise with its own walk or flicker. Two independent walks look alike too;
//! under the other's own walk that likeness is worth no more than chance.

use super::candidate::MOST_LAWS;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Fitted, Term};
use super::course::is_course;
use super::departure;
use super::selection::Selection;
use super::slow::{is_slow, slow_part};
use super::spectrum::Law;
use super::standing::ALPHA;
use crate::numerics::special::chi_squared_survival;

/// A channel that follows another.
#[derive(Debug, Clone)]
pub(super) struct Follower {
    pub(super) channel: usize,
    /// With the leader's slow part in it.
    pub(super) fitted: Fitted,
    pub(super) p_value: f64,
    /// Fraction of its slow variance that the leader's slow part explains.
    pub(super) r_squared: f64,
}

/// The channel whose slow part others follow, and those that do.
#[derive(Debug, Clone)]
pub(super) struct Common {
    pub(super) leader: usize,
    /// The leader, following the best of its followers.
    pub(super) leader_fit: Fitted,
    pub(super) followers: Vec<Follower>,
    /// Courses that every one of these channels would have without the others: they may share no
    /// more than the moment at which they were switched on.
    pub(super) rivals: Vec<Cause>,
}

/// Returns whether a channel drifts in a way that neither a single curve of the library nor a power
/// of time describes: two channels that follow the same power of time need no cause in common.
fn drifts(selected: &Selection, channel: &Channel) -> bool {
    let slow = selected.chosen.terms.iter().filter(|t| is_slow(t, channel));
    let (laws, curves): (Vec<&Term>, Vec<&Term>) = slow.partition(|t| matches!(t.addition, Addition::Law(_)));
    (!laws.is_empty() || curves.len() > 1) && !departure::is_power_of_time(channel, &selected.chosen)
}

/// Noise of its own: a walk and flicker, with whatever fast terms were found.
fn own_noise(channel: &Channel, selected: &Selection) -> Vec<Term> {
    let term = |cause, law| Term { cause, addition: Addition::Law(law), searched: 0.0, column: None };
    let mut terms: Vec<Term> = selected.chosen.terms.iter().filter(|t| !is_slow(t, channel)).cloned().collect();
    terms.push(term(Cause::RandomWalk, Law::Walk));
    if terms.iter().filter(|t| matches!(t.addition, Addition::Law(_))).count() < MOST_LAWS {
        terms.push(term(Cause::FlickerNoise, Law::Flicker));
    }
    terms
}

/// Looks for a common cause among all channels.
pub(super) fn find(channels: &[Channel], selected: &[Selection]) -> Option<Common> {
    let drifting: Vec<usize> = (0..channels.len()).filter(|i| drifts(&selected[*i], &channels[*i])).collect();
    if drifting.len() < 2 {
        return None;
    }
    let own: Vec<Fitted> = channels.iter().zip(selected).map(|(c, s)| c.fit(own_noise(c, s))).collect();
    let slow: Vec<Curve> = drifting.iter().map(|i| Curve::new(slow_part(&own[*i]))).collect();
    let correction = (channels.len() * (channels.len() - 1)) as f64;
    let following = |channel: usize, curve: &Curve| {
        let mut terms = own_noise(&channels[channel], &selected[channel]);
        terms.push(Term {
            cause: Cause::TemperatureSensitivity,
            addition: Addition::Curves(vec![curve.clone()]),
            searched: 0.0,
            column: None,
        });
        channels[channel].fit(terms)
    };
    let followers = |leader: usize| -> Vec<Follower> {
        let others = drifting.iter().copied().filter(|i| *i != drifting[leader]);
        others
            .filter_map(|i| {
                let fitted = following(i, &slow[leader]);
                let gain = 2.0 * (fitted.log_likelihood() - own[i].log_likelihood());
                let p_value = (chi_squared_survival(gain.max(0.0), 1.0) * correction).min(1.0);
                let r_squared = 1.0 - slow_power(&fitted) / slow_power(&own[i]).max(f64::MIN_POSITIVE);
                (p_value < ALPHA && r_squared > 0.5).then_some(Follower { channel: i, fitted, p_value, r_squared })
            })
            .collect()
    };
    // Who leads is arbitrary: the one whom most follow, and most closely.
    let led = (0..drifting.len()).map(|l| (l, followers(l)));
    let closeness = |f: &[Follower]| f.iter().map(|f| f.r_squared).sum::<f64>();
    let (leader, followers) = led.max_by(|a, b| closeness(&a.1).total_cmp(&closeness(&b.1)))?;
    // The leader in turn is described by the channel that follows it best.
    let best = followers.iter().max_by(|a, b| a.r_squared.total_cmp(&b.r_squared))?.channel;
    let best = drifting.iter().position(|i| *i == best)?;
    let leader_fit = following(drifting[leader], &slow[best]);
    let members = followers.iter().map(|f| f.channel).chain([drifting[leader]]);
    let courses = selected[drifting[leader]].chosen.terms.iter().map(|t| t.cause).filter(|c| is_course(*c));
    let rivals = courses.filter(|c| members.clone().all(|i| selected[i].chosen.has(*c))).collect();
    Some(Common { leader: drifting[leader], leader_fit, followers, rivals })
}

/// Power of the coefficients beyond white noise.
fn slow_power(fitted: &Fitted) -> f64 {
    let white = fitted.white().0;
    let of = |(bin, variance): (&super::spectrum::Bin, &f64)| {
        let share = 1.0 - white / variance;
        if share > 0.5 { share * (bin.sum[0] + bin.sum[1]) } else { 0.0 }
    };
    fitted.bins.iter().zip(&fitted.variances).map(of).sum()
}
