//! Searches for the delay by which powers of a column tell most of a channel: a lag, play, or both.
//!
//! A delay is searched for with the powers that are followed, not along a straight line first: what
//! bends and comes late looks, along a straight line, as if it came at another time.

use super::column::Column;
use super::decimated::Coarse;
use super::followed::{Delay, lagged, played};
use super::profile::{Profiled, peak, profile};

/// Points at which a lag and play are tried before the best is refined.
const LAGS: usize = 8;
const PLAYS: usize = 7;
/// Times that the distance to the neighbours of a pair is halved, and moves at one distance at most:
/// from one point of the grid to the next a few are enough.
const HALVINGS: usize = 7;
const MOVES: usize = 6;

/// Which delay is searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    None,
    Lag,
    Play,
    LagAndPlay,
}

impl Kind {
    pub(super) const ALL: [Self; 4] = [Self::None, Self::Lag, Self::Play, Self::LagAndPlay];
}

/// A channel and the powers of a column that it may follow.
pub(super) struct Search<'a> {
    pub(super) coarse: &'a Coarse,
    pub(super) column: &'a Column<'a>,
    pub(super) powers: &'static [i32],
}

impl Search<'_> {
    /// The delay of the highest likelihood, without intervals.
    pub(super) fn best(&self, kind: Kind) -> Delay {
        let (lags, plays) = (self.lags(), self.plays());
        let sure = |log: f64| Profiled { value: log.exp(), ci95: [log.exp(); 2] };
        match kind {
            Kind::None => Delay::None,
            Kind::Lag => Delay::Lag(sure(peak(lags, LAGS, |l| self.late(l)).0)),
            Kind::Play => Delay::Play(sure(peak(plays, PLAYS, |p| self.loose(p)).0)),
            Kind::LagAndPlay => {
                let (lag, play) = self.climbed(self.coarse_pair());
                Delay::LagAndPlay(sure(lag), sure(play))
            }
        }
    }

    /// The same delay with its intervals.
    pub(super) fn with_intervals(&self, delay: Delay) -> Delay {
        let (lags, plays) = (self.lags(), self.plays());
        match delay {
            Delay::None => Delay::None,
            Delay::Lag(_) => Delay::Lag(profile(lags, LAGS, |l| self.late(l)).0.map(f64::exp)),
            Delay::Play(_) => Delay::Play(profile(plays, PLAYS, |p| self.loose(p)).0.map(f64::exp)),
            Delay::LagAndPlay(lag, play) => {
                let (lag, play) = (lag.value.ln(), play.value.ln());
                let late = profile(lags, LAGS, |l| self.both(l, play)).0;
                let loose = profile(plays, PLAYS, |p| self.both(lag, p)).0;
                let wider = self.widening(late, loose);
                let about = |of: Profiled| {
                    let ci95 = of.ci95.map(|end| of.value + wider * (end - of.value));
                    Profiled { value: of.value, ci95 }.map(f64::exp)
                };
                Delay::LagAndPlay(about(late), about(loose))
            }
        }
    }

    fn lags(&self) -> [f64; 2] {
        self.column.lags().map(f64::ln)
    }

    fn plays(&self) -> [f64; 2] {
        self.column.plays().map(f64::ln)
    }

    fn told(&self, delayed: &[f64]) -> f64 {
        self.coarse.with(self.column.powers(delayed, self.powers))
    }

    fn late(&self, log_lag: f64) -> f64 {
        self.told(&lagged(&self.column.means, log_lag.exp()))
    }

    fn loose(&self, log_play: f64) -> f64 {
        self.told(&played(&self.column.means, log_play.exp()))
    }

    fn both(&self, log_lag: f64, log_play: f64) -> f64 {
        self.told(&played(&lagged(&self.column.means, log_lag.exp()), log_play.exp()))
    }

    /// The best pair of a grid of lags and play: each alone, searched without the other, is longer
    /// and wider than it is.
    fn coarse_pair(&self) -> (f64, f64) {
        let grid = |[from, to]: [f64; 2], points: usize| {
            (0..points).map(move |i| from + (to - from) * i as f64 / (points - 1) as f64)
        };
        let pairs = grid(self.lags(), LAGS).flat_map(|lag| grid(self.plays(), PLAYS).map(move |play| (lag, play)));
        let told = pairs.map(|(lag, play)| (lag, play, self.both(lag, play)));
        let (lag, play, _) =
            told.fold((0.0, 0.0, f64::NEG_INFINITY), |best, other| if other.2 > best.2 { other } else { best });
        (lag, play)
    }

    /// The best pair near one: steps to the best of eight neighbours, then to nearer ones. A longer
    /// lag with less play does nearly as well, so that one number after the other would stand still
    /// on that ridge.
    fn climbed(&self, (mut lag, mut play): (f64, f64)) -> (f64, f64) {
        let (lags, plays) = (self.lags(), self.plays());
        let mut distance = [(lags[1] - lags[0]) / (LAGS - 1) as f64, (plays[1] - plays[0]) / (PLAYS - 1) as f64];
        let mut best = self.both(lag, play);
        for _ in 0..HALVINGS {
            distance = distance.map(|d| 0.5 * d);
            for _ in 0..MOVES {
                let sides = [-1.0, 0.0, 1.0];
                let around = sides.into_iter().flat_map(|a| sides.map(|b| (a, b))).filter(|s| *s != (0.0, 0.0));
                let moved = around.map(|(a, b)| {
                    let there = (
                        (lag + a * distance[0]).clamp(lags[0], lags[1]),
                        (play + b * distance[1]).clamp(plays[0], plays[1]),
                    );
                    (there, self.both(there.0, there.1))
                });
                let Some((there, told)) = moved.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|m| m.1 > best) else {
                    break;
                };
                (lag, play) = there;
                best = told;
            }
        }
        (lag, play)
    }

    /// By how much an interval of one is wider where the other is free: 1/√(1 − ρ²), with their
    /// correlation ρ from the curvature of the log-likelihood, whose own parts the intervals next to
    /// the fixed other one show.
    fn widening(&self, lag: Profiled, play: Profiled) -> f64 {
        // Half the interval on either side, so that the quadratic form still holds.
        let [l, p] = [lag, play].map(|of| 0.25 * (of.ci95[1] - of.ci95[0]));
        let at = |a: f64, b: f64| self.both(lag.value + a * l, play.value + b * p);
        let mixed = 0.25 * (at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0));
        // At half the distance a quarter of what ends the interval, χ²₁'s 95 % point over two.
        let own = 2.0 * 0.25 * 1.92;
        let correlation = (mixed / own).clamp(-0.99, 0.99);
        1.0 / (1.0 - correlation * correlation).sqrt()
    }
}
