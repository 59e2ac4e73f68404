//! The effects of a still sensor, from what was selected: each channel's own, the drift that they
//! share, their levels.

use super::candidate::{Placed, row};
use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted};
use super::common::Common;
use super::quantisation::Counts;
use super::residual::Residual;
use super::selection::Selection;
use super::slow::is_slow;
use super::spectrum::Law;
use super::standing::ALPHA;
use super::{describe, estimate};
use crate::model;
use crate::numerics::special::chi_squared_survival;
use crate::remainder::REAL;
use crate::verdict::{Effect, Estimate, Evidence};

/// Rounding that makes up this share of the white variance is worth a name.
const COARSE: f64 = 0.1;
/// A datasheet's level is a typical one: nearer than this is as promised.
const LEVEL: f64 = 0.05;

/// Holds what an effect rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Basis {
    /// The shape of a spectrum or of a course in time.
    Shape,
    /// More than that: a column, a common cause, a grid, a promise.
    Witness,
    /// A power-law spectrum with a fitted exponent; the residual is noise.
    Exponent,
}

/// An effect that was found, before it is made public.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) cause: Cause,
    /// Places of the channels it shows in.
    pub(super) channels: Vec<usize>,
    pub(super) parameters: Vec<Estimate>,
    pub(super) evidence: Evidence,
    /// Candidates that do as well, the best first.
    pub(super) rivals: Vec<Cause>,
    pub(super) basis: Basis,
}

impl Found {
    /// Returns it as the verdict states it; `None` for what is no physics left out.
    pub(super) fn public(&self, channels: &[Channel]) -> Option<Effect> {
        let entry = row(self.cause).entry?;
        Some(Effect {
            id: entry.id.into(),
            statement: entry.statement.into(),
            equation: entry.equation.into(),
            parameters: self.parameters.clone(),
            channels: self.channels.iter().map(|i| channels[*i].name.clone()).collect(),
            form: None,
            evidence: self.evidence,
            share: None,
            base: Vec::new(),
            confusable_with: self.rivals.iter().filter_map(|c| Some(row(*c).entry?.id.to_owned())).collect(),
        })
    }

    /// Ties it with these before what it is indistinguishable from already.
    pub(super) fn tie(&mut self, others: &[Cause]) {
        let known = self.rivals.iter().filter(|r| !others.contains(r));
        self.rivals = others.iter().chain(known).copied().collect();
    }

    /// Returns whether it is this cause in this channel.
    pub(super) fn is(&self, cause: Cause, channel: usize) -> bool {
        self.cause == cause && self.channels.contains(&channel)
    }

    /// Returns whether it stands in a channel though more is left there: it has a witness of its
    /// own, or it holds wherever it rules.
    pub(super) fn stands(&self, channel: &Channel, fitted: &Fitted, residual: &Residual) -> bool {
        match self.cause {
            Cause::Sinusoid => self.is_a_line(channel, residual),
            cause => self.basis != Basis::Shape || holds_where_it_rules(cause, fitted, residual),
        }
    }

    /// Returns whether nothing is amiss around a sine: a hump wider than a line takes several of
    /// them and is still not described.
    fn is_a_line(&self, channel: &Channel, residual: &Residual) -> bool {
        let frequency_hz = self.parameters.iter().find(|p| p.name == "frequency").map_or(0.0, |p| p.value);
        let theta = std::f64::consts::PI * frequency_hz / channel.rate_hz;
        // Bands are a third wide: this one and its neighbours.
        let is_near = |centre: &f64, within: f64| (theta / centre).ln().abs() < within;
        !residual.failing.iter().any(|c| is_near(c, 0.5)) && !residual.humps.iter().any(|c| is_near(c, 0.05))
    }
}

/// Returns what a channel's own terms amount to; slow ones are left to the common cause where it
/// has one.
pub(super) fn of_terms(place: usize, channel: &Channel, selection: &Selection, shared: bool) -> Vec<Found> {
    let fitted = &selection.chosen;
    let terms = fitted.terms.iter().zip(&selection.named).enumerate();
    terms
        .filter(|(_, (term, _))| row(term.cause).entry.is_some() && !(shared && is_slow(term, channel)))
        .map(|(index, (term, named))| Found {
            cause: term.cause,
            channels: vec![place],
            parameters: (row(term.cause).parameters)(&Placed { channel, fitted, index }),
            evidence: Evidence { held_out_gain: named.held_out_gain, p_value: named.p_value },
            rivals: named.rivals.iter().take(1).copied().collect(),
            basis: if term.cause == Cause::TemperatureSensitivity { Basis::Witness } else { Basis::Shape },
        })
        .collect()
}

/// Returns whether nothing is amiss in time, and in no band where this law is the larger part of
/// the model.
fn holds_where_it_rules(cause: Cause, fitted: &Fitted, residual: &Residual) -> bool {
    let Some(index) = fitted.terms.iter().position(|t| t.cause == cause) else { return false };
    // Laws of finite reach (a memory, differences) fit any hump; only those that rise to the lowest
    // frequency count.
    let Addition::Law(law @ (Law::Walk | Law::Flicker)) = fitted.terms[index].addition else { return false };
    let strength = fitted.strength_of(index).0;
    let all = |theta: f64| -> f64 {
        fitted.laws().iter().zip(&fitted.strengths.values).map(|(l, s)| s * l.variance(theta)).sum()
    };
    let rules = |theta: &f64| strength * law.variance(*theta) > 0.5 * all(*theta);
    residual.p_value_in_time >= REAL && !residual.failing.iter().any(rules)
}

/// The drift that channels share, as one effect; their models become the ones with it.
pub(super) fn of_common(common: &Common, channels: &[Channel], finals: &mut [Fitted]) -> Found {
    finals[common.leader] = common.leader_fit.clone();
    let mut places = vec![common.leader];
    let (mut p_value, mut r_squared) = (0.0f64, f64::INFINITY);
    let mut parameters = Vec::new();
    let leader = &channels[common.leader];
    for follower in &common.followers {
        let (channel, fitted) = (&channels[follower.channel], &follower.fitted);
        places.push(follower.channel);
        p_value = p_value.max(follower.p_value);
        r_squared = r_squared.min(follower.r_squared);
        let last = Placed { channel, fitted, index: fitted.terms.len() - 1 };
        let slope = (row(Cause::TemperatureSensitivity).parameters)(&last);
        parameters.extend(slope.into_iter().map(|e| Estimate {
            name: format!("{} over {}", channel.name, leader.name),
            value: e.value / leader.scale,
            unit: "1".into(),
            ci95: e.ci95.map(|v| v / leader.scale),
        }));
        finals[follower.channel] = fitted.clone();
    }
    Found {
        cause: Cause::TemperatureSensitivity,
        channels: places,
        parameters,
        evidence: Evidence { held_out_gain: r_squared, p_value },
        rivals: common.rivals.iter().take(1).copied().collect(),
        basis: Basis::Witness,
    }
}

/// Variance by which the white level next to flicker depends on what the sensor does above half the
/// sampling rate: 1/f goes on there, and whether it folds back or is averaged away is no part of
/// the law. Its variance at that frequency.
fn folded(fitted: &Fitted) -> f64 {
    let flicker = fitted.terms.iter().position(|t| matches!(t.addition, Addition::Law(Law::Flicker)));
    flicker.map_or(0.0, |i| fitted.strength_of(i).0 * Law::Flicker.variance(std::f64::consts::FRAC_PI_2))
}

/// Rounding as coarse as the noise, and a white level other than promised.
pub(super) fn of_level(place: usize, channel: &Channel, fitted: &Fitted, noise: Option<&model::Noise>) -> Vec<Found> {
    let mut out = Vec::new();
    let (white, error) = fitted.white();
    let rounding = channel.rounding();
    let fraction = rounding / white.max(rounding);
    let coarse = channel.step.filter(|_| fraction > COARSE);
    let of = |cause, parameter, evidence| Found {
        cause,
        channels: vec![place],
        parameters: vec![parameter],
        evidence,
        rivals: Vec::new(),
        basis: Basis::Witness,
    };
    if let Some(step) = coarse.map(|q| q * channel.scale) {
        let parameter = Estimate { name: "step".into(), value: step, unit: channel.unit.clone(), ci95: [step, step] };
        // A smooth reading would not fall on a grid once.
        out.push(of(
            Cause::QuantisationNoise,
            parameter,
            Evidence { held_out_gain: fraction, p_value: f64::MIN_POSITIVE },
        ));
    }
    let Some(noise) = noise else { return out };
    let promised = describe::white_of_density(channel, noise.density);
    // Variance before rounding, its interval, and the probability of so large a difference from the
    // promise by chance.
    let (own, interval, p_value) = match coarse {
        // Rounded that coarsely, the variance depends on where between two steps the value lies;
        // the counts know.
        Some(step) if fitted.terms.is_empty() && channel.together == 1 => {
            let counts = Counts::of(&channel.values, step);
            let (sigma, interval, gain) = counts.noise(promised.sqrt() / step);
            let variance = |s: f64| (s * step).powi(2);
            (variance(sigma), interval.map(variance), chi_squared_survival(gain, 1.0))
        }
        _ => {
            let own = white - if coarse.is_some() { rounding } else { 0.0 };
            let folded = folded(fitted);
            let z = ((own - promised).abs() - folded).max(0.0) / error.max(0.3 * rounding);
            let [low, high] = estimate::variance_interval(white, error).map(|v| v - white + own);
            let interval = [(low - folded).max(0.0), high + folded];
            (own, interval, chi_squared_survival(z * z, 1.0))
        }
    };
    if p_value < ALPHA && ((own.max(0.0) / promised).sqrt() - 1.0).abs() > LEVEL {
        let density = |v: f64| describe::density_of_white(channel, v);
        let (value, ci95) = (density(own.max(0.0)), interval.map(density));
        let parameter = Estimate { name: "density".into(), value, unit: format!("{}/√Hz", channel.unit), ci95 };
        let gain = 1.0 - (promised / own).min(own.max(0.0) / promised);
        out.push(of(Cause::WhiteNoise, parameter, Evidence { held_out_gain: gain, p_value }));
    }
    out
}
