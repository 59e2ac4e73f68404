//! From a datasheet's noise to variances and back, and the curves that figures show.

use super::channel::{Channel, Fitted};
use super::detail::ChannelDetail;
use super::spectrum::{self, Bin, Law};
use crate::model::{Noise, Static};
use crate::numerics::allan;

/// Variance per bin that a datasheet promises beyond white noise, in the channel's scale.
pub(super) fn promised(channel: &Channel, noise: Option<&Noise>) -> Vec<f64> {
    let Some(noise) = noise.filter(|n| n.bias_instability > 0.0 || n.random_walk > 0.0) else { return Vec::new() };
    let laws = promised_laws(channel, noise);
    let at = |b: &Bin| laws.iter().map(|(law, strength)| strength * law.variance(b.theta)).sum();
    spectrum::bins(&channel.coefficients).iter().map(at).collect()
}

/// Slow laws that a datasheet promises, with their strengths in the channel's scale.
pub(super) fn promised_laws(channel: &Channel, noise: &Noise) -> [(Law, f64); 2] {
    let flicker = (noise.bias_instability / channel.scale).powi(2);
    let walk = (noise.random_walk / channel.scale).powi(2) / channel.rate_hz;
    [(Law::Flicker, flicker), (Law::Walk, walk)]
}

/// Variance of a white sample that a one-sided density promises, in the channel's scale.
pub(super) fn white_of_density(channel: &Channel, density: f64) -> f64 {
    (density / channel.scale).powi(2) * channel.rate_hz / 2.0
}

/// One-sided density of a white variance in the channel's scale.
pub(super) fn density_of_white(channel: &Channel, variance: f64) -> f64 {
    (2.0 * variance / channel.rate_hz).sqrt() * channel.scale
}

/// Returns what the base model says of every bin: the promised noise, else white noise at its best
/// level.
pub(super) fn base_variances(channel: &Channel, base: &Fitted, model: &Static) -> Vec<f64> {
    match &model.noise {
        None => base.variances.clone(),
        Some(noise) => {
            let white = white_of_density(channel, noise.density);
            spectrum::variances(&base.bins, &[Law::White], &[white], &channel.promised)
        }
    }
}

/// Allan variance of coefficients with these variances per bin: 2/N Σ S sin⁴(mθ)/(m sin θ)². Where
/// a bin spans many ripples their mean, 3/8, stands for sin⁴.
fn allan_variance(bins: &[Bin], variances: &[f64], count: usize, factor: usize) -> f64 {
    let m = factor as f64;
    let each = |(b, v): (&Bin, &f64)| {
        let width = (b.to - b.from) as f64;
        let ripples = m * width * std::f64::consts::PI / (2 * count) as f64;
        let sine_factor = if ripples > 1.0 { 0.375 } else { (m * b.theta).sin().powi(4) };
        v * width * sine_factor / (m * b.theta.sin()).powi(2)
    };
    2.0 / count as f64 * bins.iter().zip(variances).map(each).sum::<f64>()
}

/// Returns what figures show of a channel.
pub(super) fn detail(channel: &Channel, base: &[f64], fitted: &Fitted) -> ChannelDetail {
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
    ChannelDetail { name: channel.name.clone(), allan, density, trace, ..ChannelDetail::default() }
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
