//! States where the mismatch of a still sensor lives: in frequency, averaging time and time,
//! channel by channel.

use super::channel::Channel;
use super::detail::{Hops, Jump, Knocked, Location, Mismatch, Spiky};
use super::residual::{Residual, residual};
use super::selection::Selection;
use super::telegraph::Telegraph;
use crate::answer::Places;
use crate::numerics::order;
use crate::recording::disturbance::Knock;
use crate::remainder::REAL;
use crate::verdict::Stretch;

/// Channels told of one by one; the page shows all.
const SPOKEN_OF: usize = 3;

/// Of the mismatch that repair removed where all channels are described `well`, else of what is
/// left.
pub(super) fn locate(
    channels: &[Channel],
    selected: &[Selection],
    residuals: &[Residual],
    well: &[bool],
) -> (Places, Location) {
    let described = well.iter().all(|w| *w);
    let base: Vec<Residual>;
    let shown: &[Residual] = if described {
        base = channels.iter().zip(selected).map(|(c, s)| residual(c, &s.base, 0.0)).collect();
        &base
    } else {
        residuals
    };
    // Probabilities below the smallest number are all the same; then the excess decides.
    let excess = |i: usize| shown[i].frequency_hz.iter().chain(&shown[i].time_s).map(|s| s.excess).fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..shown.len()).collect();
    order::sort_by_key(&mut order, |i| -excess(*i));
    order::sort_by_key(&mut order, |i| shown[*i].p_value);
    let Some(worst) = order.first().copied() else { return <_>::default() };
    let frequency_hz = shown[worst].frequency_hz.clone();
    // Averaging times that a band of frequency shows in: a third to a half of its period.
    let state =
        frequency_hz.iter().map(|s| Stretch { from: 0.37 / s.to, to: 0.37 / s.from, excess: s.excess }).collect();
    let stands_out = |i: &usize| match described {
        true => shown[*i].p_value * (channels.len() as f64) < REAL,
        false => !well[*i],
    };
    let off: Vec<usize> = order.into_iter().filter(stands_out).collect();
    let (hopping, off): (Vec<usize>, Vec<usize>) =
        off.into_iter().partition(|i| !described && shown[*i].telegraph.is_some());
    let (leaping, off): (Vec<usize>, Vec<usize>) =
        off.into_iter().partition(|i| !described && shown[*i].jump.is_some());
    // A channel may be off by a knock or an exponent alone, which are told apart.
    let remains = |i: &usize| described || shown[*i].p_value * (channels.len() as f64) < REAL;
    let mismatched: Vec<usize> = off.into_iter().filter(remains).collect();
    let location = Location {
        described,
        jumps: jumps(channels, shown, leaping),
        knocks: channels.iter().flat_map(knocks).collect(),
        spikes: channels.iter().filter_map(spiky).collect(),
        hops: hopping.iter().filter_map(|i| Some(hops(&channels[*i], shown[*i].telegraph.as_ref()?))).collect(),
        mismatches: mismatched.iter().take(SPOKEN_OF).map(|i| mismatch(&channels[*i].name, &shown[*i])).collect(),
        also: mismatched.iter().skip(SPOKEN_OF).map(|i| channels[*i].name.clone()).collect(),
    };
    let time_s = shown[worst].time_s.clone();
    (Places { time_s, frequency_hz, state, ..Places::default() }, location)
}

/// Every moment at which channels jump, however many do.
fn jumps(channels: &[Channel], shown: &[Residual], mut leaping: Vec<usize>) -> Vec<Jump> {
    let mut out = Vec::new();
    while let Some(first) = leaping.first().copied() {
        let at = |i: usize| shown[i].jump.unwrap_or(0.0);
        let (same, others): (Vec<usize>, Vec<usize>) =
            leaping.into_iter().partition(|i| (at(*i) - at(first)).abs() <= 0.01 * at(first));
        out.push(Jump { channels: same.iter().map(|i| channels[*i].name.clone()).collect(), time_s: at(first) });
        leaping = others;
    }
    out
}

fn knocks(channel: &Channel) -> Vec<Knocked> {
    let rate_hz = channel.rate_hz * channel.together as f64;
    let of = |k: &Knock| Knocked {
        channel: channel.name.clone(),
        from_s: k.from as f64 / rate_hz,
        to_s: k.to as f64 / rate_hz,
        deviations: k.deviations,
    };
    channel.disturbances.knocks.iter().map(of).collect()
}

fn spiky(channel: &Channel) -> Option<Spiky> {
    let count = channel.disturbances.spikes;
    (count > 0).then(|| Spiky { channel: channel.name.clone(), count })
}

fn hops(channel: &Channel, hops: &Telegraph) -> Hops {
    Hops {
        channel: channel.name.clone(),
        levels: hops.levels.iter().map(|level| level * channel.scale).collect(),
        dwell_s: hops.dwell.iter().map(|samples| samples / channel.rate_hz).collect(),
        count: hops.hops,
    }
}

fn mismatch(channel: &str, residual: &Residual) -> Mismatch {
    Mismatch {
        channel: channel.into(),
        band_hz: residual.frequency_hz.iter().max_by(|a, b| a.excess.total_cmp(&b.excess)).copied(),
        fading: residual.fading,
        steady: residual.p_value_in_time >= REAL,
        power: residual.power,
        time_s: residual.time_s.clone(),
        creep: residual.creep,
        only_there: residual.only_there,
    }
}
