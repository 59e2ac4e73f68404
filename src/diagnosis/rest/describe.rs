//! From fitted strengths to a datasheet's numbers and back: parameters of effects with intervals, promised noise, curves.

use super::ChannelDetail;
use super::channel::{Addition, Channel, Fitted, Term};
use super::spectrum::{self, Bin, Law};
use crate::diagnosis::model::Noise;
use crate::diagnosis::verdict::Estimate;
use crate::numerics::allan;
use crate::numerics::order;
use crate::numerics::special::{chi_squared_quantile, normal_quantile};

/// Variance per bin that a datasheet promises beyond white noise, in the channel's scale.
pub(super) fn promised(channel: &Channel, noise: Option<&Noise>) -> Vec<f64> {
    let Some(noise) = noise.filter(|n| n.bias_instability > 0.0 || n.random_walk > 0.0) else { return Vec::new() };
    let flicker = (noise.bias_instability / channel.scale).powi(2);
    let walk = (noise.random_walk / channel.scale).powi(2) / channel.rate_hz;
    let at = |b: &Bin| flicker * Law::Flicker.variance(b.theta) + walk * Law::Walk.variance(b.theta);
    spectrum::bins(&channel.coefficients).iter().map(at).collect()
}

/// Variance of a white sample that a one-sided density promises, in the channel's scale.
pub(super) fn white_of_density(channel: &Channel, density: f64) -> f64 {
    (density / channel.scale).powi(2) * channel.rate_hz / 2.0
}

/// One-sided density of a white variance in the channel's scale.
pub(super) fn density_of_white(channel: &Channel, variance: f64) -> f64 {
    (2.0 * variance / channel.rate_hz).sqrt() * channel.scale
}

/// 95 % interval of a variance: χ² with the degrees of freedom that its standard error amounts to.
pub(super) fn variance_interval(value: f64, error: f64) -> [f64; 2] {
    let freedom = 2.0 * (value / error).powi(2);
    [0.975, 0.025].map(|p| value * freedom / chi_squared_quantile(p, freedom))
}

/// A value whose square is a fitted strength.
fn root(name: &str, unit: String, factor: f64, (value, error): (f64, f64)) -> Estimate {
    let ci95 = variance_interval(value, error).map(|e| e.sqrt() * factor);
    Estimate { name: name.into(), value: value.sqrt() * factor, unit, ci95 }
}

fn straight(name: &str, unit: String, factor: f64, (value, error): (f64, f64)) -> Estimate {
    let half = normal_quantile(0.975) * error;
    let mut ci95 = [(value - half) * factor, (value + half) * factor];
    order::sort(&mut ci95);
    Estimate { name: name.into(), value: value * factor, unit, ci95 }
}

/// Parameters of a term as the library names them, in file units.
pub(super) fn parameters(channel: &Channel, fitted: &Fitted, index: usize, unit: &str) -> Vec<Estimate> {
    let term = &fitted.terms[index];
    let (scale, step_s) = (channel.scale, 1.0 / channel.rate_hz);
    let duration_s = channel.values.len() as f64 * step_s;
    match &term.addition {
        Addition::Law(law) => {
            let strength = fitted.strength_of(index);
            match law {
                Law::White | Law::Smoothed(_) => Vec::new(),
                Law::Differenced => vec![root("Q", format!("{unit}·s"), scale * step_s, strength)],
                Law::Flicker => vec![root("B", unit.into(), scale, strength)],
                Law::Walk => vec![root("K", format!("{unit}/√s"), scale * channel.rate_hz.sqrt(), strength)],
                Law::Markov(_) => {
                    vec![root("sigma", unit.into(), scale, strength), searched("T", channel, fitted, index, step_s)]
                }
            }
        }
        Addition::Curves(_) => {
            let amplitudes = fitted.amplitudes_of(index);
            match term.id {
                "rate-ramp" => vec![straight("rate", format!("{unit}/s"), scale / duration_s, amplitudes[0])],
                "warm-up" => vec![
                    straight("amplitude", unit.into(), scale, amplitudes[0]),
                    searched("T", channel, fitted, index, step_s),
                ],
                "sinusoid" => sinusoid(channel, fitted, term, amplitudes, unit),
                _ => {
                    let column = term.column.clone().unwrap_or_else(|| "the common cause".into());
                    vec![straight("slope", format!("{unit} per unit of {column}"), scale, amplitudes[0])]
                }
            }
        }
    }
}

fn sinusoid(channel: &Channel, fitted: &Fitted, term: &Term, parts: &[(f64, f64)], unit: &str) -> Vec<Estimate> {
    let amplitude = parts[0].0.hypot(parts[1].0);
    let error = parts[0].1.max(parts[1].1);
    // Cramér–Rao bound of a frequency: var(ω) = 24 s/(A² N³), and 2 s/N is the variance of an amplitude.
    let count = channel.values.len() as f64;
    let spread = (12.0f64).sqrt() * error / (amplitude * count) / std::f64::consts::TAU;
    debug_assert!(fitted.amplitudes.len() >= 2, "a sine has two amplitudes");
    vec![
        straight("amplitude", unit.into(), channel.scale, (amplitude, error)),
        straight("frequency", "Hz".into(), channel.rate_hz, (term.searched, spread)),
    ]
}

/// A searched time constant, with the interval where the profile likelihood falls by half of χ²₁'s 95 % point.
fn searched(name: &str, channel: &Channel, fitted: &Fitted, index: usize, step_s: f64) -> Estimate {
    let best = fitted.terms[index].searched;
    let inside = |value: f64| {
        let mut terms = fitted.terms.clone();
        let count = channel.values.len();
        terms[index].searched = value;
        terms[index].addition = match terms[index].addition {
            Addition::Law(_) => Addition::Law(Law::Markov(value)),
            Addition::Curves(_) => {
                let curve = (0..count).map(|n| (-(n as f64) / value).exp()).collect();
                Addition::Curves(vec![super::channel::Curve::new(curve)])
            }
        };
        fitted.log_likelihood() - channel.fit(terms).log_likelihood() < 1.92
    };
    let edge = |direction: f64| {
        let (mut near, mut far) = (0.0, 0.25);
        while far < 4.0 && inside(best * (direction * far).exp()) {
            (near, far) = (far, 2.0 * far);
        }
        for _ in 0..5 {
            let middle = (near + far) / 2.0;
            if inside(best * (direction * middle).exp()) { near = middle } else { far = middle }
        }
        best * (direction * far).exp() * step_s
    };
    Estimate { name: name.into(), value: best * step_s, unit: "s".into(), ci95: [edge(-1.0), edge(1.0)] }
}

/// Allan variance of coefficients with these variances per bin: 2/N Σ S sin⁴(mθ)/(m sin θ)². Where a bin spans many ripples
/// their mean, 3/8, stands for sin⁴.
fn allan_variance(bins: &[Bin], variances: &[f64], count: usize, factor: usize) -> f64 {
    let m = factor as f64;
    let each = |(b, v): (&Bin, &f64)| {
        let width = (b.to - b.from) as f64;
        let ripples = m * width * std::f64::consts::PI / (2 * count) as f64;
        let fourth = if ripples > 1.0 { 0.375 } else { (m * b.theta).sin().powi(4) };
        v * width * fourth / (m * b.theta.sin()).powi(2)
    };
    2.0 / count as f64 * bins.iter().zip(variances).map(each).sum::<f64>()
}

/// What figures show of a channel.
pub(super) fn detail(channel: &Channel, base: &[f64], fitted: &Fitted, named: Vec<String>) -> ChannelDetail {
    let count = channel.values.len();
    let curve = fitted.mean_curve(count);
    let of_curve = allan::curve(&curve, channel.rate_hz);
    let allan = allan::curve(&channel.values, channel.rate_hz)
        .iter()
        .map(|p| {
            let from_curve = of_curve.iter().find(|c| c.factor == p.factor).map_or(0.0, |c| c.variance);
            let before = allan_variance(&fitted.bins, base, count, p.factor);
            let after = allan_variance(&fitted.bins, &fitted.variances, count, p.factor) + from_curve;
            [p.tau_s, p.variance.sqrt() * channel.scale, before.sqrt() * channel.scale, after.sqrt() * channel.scale]
        })
        .collect();
    let density = thinned(channel, base, fitted);
    let blocks = count.min(400);
    let trace = (0..blocks)
        .map(|b| {
            let (from, to) = (b * count / blocks, (b + 1) * count / blocks);
            let mean = |v: &[f64]| v[from..to].iter().sum::<f64>() / (to - from) as f64 * channel.scale;
            [(from + to) as f64 / 2.0 / channel.rate_hz, mean(&channel.values), mean(&curve)]
        })
        .collect();
    ChannelDetail { name: channel.name.clone(), named, allan, density, trace }
}

/// Densities, at least eight coefficients a point so that the eye is not led astray.
fn thinned(channel: &Channel, base: &[f64], fitted: &Fitted) -> Vec<[f64; 4]> {
    let bins = spectrum::bins(&channel.coefficients);
    let mut out = Vec::new();
    let mut sum = [0.0; 4];
    let mut from = 0;
    for (i, bin) in bins.iter().enumerate() {
        let width = bin.count[0] + bin.count[1];
        sum[0] += width;
        sum[1] += bin.sum[0] + bin.sum[1];
        sum[2] += width * base[i];
        sum[3] += width * fitted.variances[i];
        if sum[0] >= 8.0 && bin.to as f64 > 1.15 * bins[from].from as f64 {
            let middle = ((bins[from].from * bin.to) as f64).sqrt();
            let frequency_hz = middle * channel.rate_hz / (2 * channel.values.len()) as f64;
            let density = |s: f64| density_of_white(channel, s / sum[0]);
            out.push([frequency_hz, density(sum[1]), density(sum[2]), density(sum[3])]);
            sum = [0.0; 4];
            from = i + 1;
            if from == bins.len() {
                break;
            }
        }
    }
    out
}
