//! One exponent for the drifts of several channels.
//!
//! Channels of one sensor share their physics. Noise whose exponent lies between two laws is then
//! often taken for one law in one channel and for another in the next, for the little that chance
//! does to each. Where the channels do not speak alike, one power law f^−α with one exponent for
//! all is held against one whole law for all, one memory for all, and each channel's own laws
//! together. Strengths differ freely. Where it does as well, what it says of the exponent holds in
//! every channel.

use super::candidate::{memories, row};
use super::cause::Cause;
use super::channel::{Channel, Fitted};
use super::departure::{Departure, Of, POINTS, Ruling, SPECTRAL, Takes, in_place, rival, whole};
use super::laws::{SLOW, slow_laws};
use super::profile::{Profiled, peak, profile};
use super::spectrum::Law;
use super::standing::CLOSE;
use crate::numerics::special::chi_squared_survival;

/// Probability below which the channels do not have one exponent.
const DISAGREE: f64 = 0.01;

/// A channel that drifts, and what was said of it alone.
#[derive(Clone, Copy)]
pub(super) struct Member<'a> {
    pub(super) channel: &'a Channel,
    pub(super) chosen: &'a Fitted,
    pub(super) departure: Option<Departure>,
}

impl Member<'_> {
    fn with(&self, law: Law) -> f64 {
        in_place(self.channel, self.chosen, &self.chosen.bins, law)
    }

    /// Numbers of its slow laws.
    fn numbers(&self) -> f64 {
        let slow = self.chosen.terms.iter().filter(|t| SLOW.contains(&t.cause));
        slow.map(|t| row(t.cause).numbers).sum()
    }

    /// One whole law that its own spectrum does not put in doubt.
    fn is_whole(&self) -> bool {
        matches!(slow_laws(self.chosen)[..], [Cause::FlickerNoise | Cause::RandomWalk]) && self.departure.is_none()
    }

    /// Returns what is said of it by an exponent that all share: where the recording cannot tell,
    /// what was not in doubt stays so.
    pub(super) fn told(&self, shared: Departure) -> Option<Departure> {
        match shared.ruling == Ruling::Open && self.is_whole() {
            true => self.departure,
            false => Some(shared),
        }
    }
}

/// Returns whether a channel drifts by noise alone, so that it may share an exponent.
pub(super) fn may_share(member: &Member<'_>) -> bool {
    !slow_laws(member.chosen).is_empty() && member.departure.is_none_or(|d| d.of == Of::Spectrum && !d.takes.courses)
}

/// Returns what one exponent for all says; `None` where they speak alike, where their exponents
/// differ, or where another law does better.
pub(super) fn of(members: &[Member<'_>]) -> Option<Departure> {
    let first = members.first()?;
    let alike = |m: &Member<'_>| m.is_whole() && slow_laws(m.chosen) == slow_laws(first.chosen);
    if members.len() < 2 || members.iter().all(alike) {
        return None;
    }
    let sum = |law: Law| members.iter().map(|m| m.with(law)).sum::<f64>();
    let (shared, together) = profile(SPECTRAL, POINTS, |exponent: f64| sum(Law::Power(exponent)));
    if !share(members, together) {
        return None;
    }
    let [flicker, walk] = [Law::Flicker, Law::Walk].map(sum);
    // Every channel has one strength; a shared exponent or memory is one number more.
    let own = members.iter().map(|m| 2.0 * (m.chosen.log_likelihood() - (m.numbers() - 1.0))).sum::<f64>();
    if 2.0 * together - 2.0 < own - CLOSE {
        return None;
    }
    let shortest = members.iter().map(|m| m.channel.values.len()).min()?;
    let filtered = members.iter().any(|m| m.chosen.has(Cause::BandLimit));
    let memory = memories(shortest, filtered).map(|range| peak(range, POINTS, |m: f64| sum(Law::Markov(m.exp()))).1);
    let over_memory = memory.map_or(f64::INFINITY, |memory| 2.0 * (together - memory));
    let rulings = [
        whole(1.0, shared, 2.0 * (together - flicker)).unwrap_or(Ruling::Open),
        whole(2.0, shared, 2.0 * (together - walk)).unwrap_or(Ruling::Open),
        rival(over_memory)?,
    ];
    let refuted = rulings.iter().all(|r| *r == Ruling::Refuted);
    Some(Departure {
        ruling: if refuted { Ruling::Refuted } else { Ruling::Open },
        of: Of::Spectrum,
        exponent: Some(shared),
        better_by: over_memory.min(2.0 * (together - flicker.max(walk)) - 2.0),
        takes: Takes { courses: false, noise: true, slow_lines: false },
    })
}

/// Returns whether a power law serves in each channel, and with one exponent in all; `together` is
/// their log-likelihood with it.
fn share(members: &[Member<'_>], together: f64) -> bool {
    let each: Vec<(Profiled, f64)> =
        members.iter().map(|m| profile(SPECTRAL, POINTS, |exponent: f64| m.with(Law::Power(exponent)))).collect();
    // A strength and an exponent against the numbers that the channel's own laws have.
    let serves = |(m, (_, best)): (&Member<'_>, &(Profiled, f64))| {
        2.0 * (best - m.chosen.log_likelihood()) + 2.0 * (m.numbers() - 2.0) > -CLOSE
    };
    let apart = 2.0 * (each.iter().map(|e| e.1).sum::<f64>() - together);
    members.iter().zip(&each).all(serves) && chi_squared_survival(apart, members.len() as f64 - 1.0) > DISAGREE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::cosine;
    use crate::rest::channel::{Addition, Term};
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 16_000;

    /// White noise and noise of this density at the k-th cosine.
    fn channel(density: impl Fn(f64) -> f64, member: u64) -> Channel {
        let mut rng = Philox::new(41, member, Stream::Host);
        let coefficients: Vec<f64> =
            (0..COUNT).map(|k| if k == 0 { 0.0 } else { rng.normal() * (1.0 + density(k as f64)).sqrt() }).collect();
        Channel::new("x", &cosine::invert(&coefficients), 1.0)
    }

    fn fitted(channel: &Channel, cause: Cause, law: Law) -> Fitted {
        channel.fit(vec![Term { cause, addition: Addition::Law(law), searched: 0.0, column: None }])
    }

    /// The best memory.
    fn memory(channel: &Channel) -> Fitted {
        let all = (1..24).map(|n| fitted(channel, Cause::GaussMarkov, Law::Markov(1.5f64.powi(n))));
        all.max_by(|a, b| a.log_likelihood().total_cmp(&b.log_likelihood())).expect("some")
    }

    fn said(channels: &[Channel], chosen: &[Fitted]) -> Option<Departure> {
        let member = |(channel, chosen)| Member { channel, chosen, departure: None };
        of(&channels.iter().zip(chosen).map(member).collect::<Vec<Member<'_>>>())
    }

    // Alone one channel's noise was taken for a memory and the other's for flicker.
    #[test]
    fn an_exponent_between_two_laws_is_found_from_all_channels() {
        let mut refuted = 0;
        for case in 0..6 {
            let channels: Vec<Channel> = (0..3).map(|c| channel(|k| (60.0 / k).powf(1.4), 10 * case + c)).collect();
            let chosen: Vec<Fitted> = vec![
                memory(&channels[0]),
                fitted(&channels[1], Cause::FlickerNoise, Law::Flicker),
                fitted(&channels[2], Cause::FlickerNoise, Law::Flicker),
            ];
            let Some(departure) = said(&channels, &chosen) else { continue };
            let exponent = departure.exponent.expect("of a spectrum");
            assert!((exponent.value - 1.4).abs() < 0.25, "{exponent:?}");
            refuted += usize::from(departure.ruling == Ruling::Refuted);
        }
        assert!(refuted >= 4, "{refuted} of 6");
    }

    #[test]
    fn whole_laws_that_agree_and_laws_that_differ_are_left_alone() {
        let flicker = |n: u64| channel(|k| 60.0 / k, n);
        let lorentz = |n: u64| channel(|k| 40.0 / (1.0 + (k / 60.0).powi(2)), n);
        let of_flicker = |c: &Channel| fitted(c, Cause::FlickerNoise, Law::Flicker);
        for case in 0..4 {
            let alike = [flicker(100 + case), flicker(110 + case)];
            let chosen = [of_flicker(&alike[0]), of_flicker(&alike[1])];
            assert_eq!(said(&alike, &chosen), None, "both flicker");
            let apart = [flicker(120 + case), lorentz(130 + case)];
            let chosen = [of_flicker(&apart[0]), memory(&apart[1])];
            assert_eq!(said(&apart, &chosen), None, "flicker and a memory");
            let two = [lorentz(140 + case), lorentz(150 + case)];
            let chosen = [memory(&two[0]), of_flicker(&two[1])];
            assert_eq!(said(&two, &chosen), None, "two memories");
        }
    }
}
