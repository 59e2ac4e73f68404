//! Where the mismatch of a still sensor lives: in frequency, averaging time and time, channel by channel.

use super::channel::Channel;
use super::residual::{Residual, residual};
use super::selection::Selection;
use super::telegraph::Telegraph;
use crate::diagnosis::remainder::REAL;
use crate::diagnosis::verdict::{Stretch, Where};
use crate::number::{duration, short};
use crate::numerics::order;

/// Channels spoken of in the summary; the page shows all.
const SPOKEN_OF: usize = 3;

/// Of the mismatch that repair removed where all channels are described `well`, else of what is left.
pub(super) fn locate(
    channels: &[Channel],
    selected: &[Selection],
    residuals: &[Residual],
    well: &[bool],
    unit: &str,
) -> Where {
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
    let Some(worst) = order.first().copied() else { return Where::default() };
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
    let mut spoken = jumps(channels, shown, leaping);
    spoken.extend(hopping.iter().filter_map(|i| Some(popcorn(&channels[*i], shown[*i].telegraph.as_ref()?, unit))));
    if !hopping.is_empty() {
        spoken.push("A Gaussian drift such as `gauss-markov` may have that spectrum, but not two levels.".into());
    }
    spoken.extend(off.iter().take(SPOKEN_OF).map(|i| in_words(&channels[*i].name, &shown[*i], described)));
    if off.len() > SPOKEN_OF {
        let names: Vec<&str> = off[SPOKEN_OF..].iter().map(|i| channels[*i].name.as_str()).collect();
        spoken.push(format!("Also in {}.", names.join(", ")));
    }
    if spoken.is_empty() {
        spoken.push("Nowhere: no band of frequency and no stretch of time stands out.".into());
    }
    let time_s = shown[worst].time_s.clone();
    Where { summary: spoken.join(" "), time_s, frequency_hz, state, state_cells: Vec::new() }
}

/// A sentence for every moment at which channels jump, however many do.
fn jumps(channels: &[Channel], shown: &[Residual], mut leaping: Vec<usize>) -> Vec<String> {
    let mut out = Vec::new();
    while let Some(first) = leaping.first().copied() {
        let at = |i: usize| shown[i].jump.unwrap_or(0.0);
        let (same, others): (Vec<usize>, Vec<usize>) =
            leaping.into_iter().partition(|i| (at(*i) - at(first)).abs() <= 0.01 * at(first));
        let names: Vec<&str> = same.iter().map(|i| channels[*i].name.as_str()).collect();
        out.push(format!(
            "{}: the bias jumps, most at {}; no law of noise or drift in the library does that.",
            names.join(", "),
            duration(at(first))
        ));
        leaping = others;
    }
    out
}

/// A channel that hops, in a sentence.
fn popcorn(channel: &Channel, hops: &Telegraph, unit: &str) -> String {
    let [low, high] = hops.dwell.map(|samples| duration(samples / channel.rate_hz));
    format!(
        "{}: the bias hops between two levels {} {unit} apart (popcorn noise; {} hops, on average after {low} at the lower \
         and {high} at the higher level).",
        channel.name,
        short(hops.apart * channel.scale),
        hops.hops
    )
}

/// One channel's residual in a sentence.
fn in_words(name: &str, residual: &Residual, described: bool) -> String {
    let by = if described { "of white noise" } else { "that the best model explains" };
    let strongest = residual.frequency_hz.iter().max_by(|a, b| a.excess.total_cmp(&b.excess));
    if let Some(s) = strongest {
        // A law of drift or noise reaches over a decade at least.
        let narrow = s.to < 1.6 * s.from && s.excess > 1.3;
        return format!(
            "{name}: most between {} and {} Hz (averaging times {} to {}), with {} times the power {by}.{}",
            short(s.from),
            short(s.to),
            duration(0.37 / s.to),
            duration(0.37 / s.from),
            short(s.excess),
            if narrow { " So narrow a band is usually vibration of what the sensor stands on." } else { "" }
        );
    }
    let fading = residual.fading.map(|[below_hz, share]| {
        format!(
            "below {} Hz it has only {} times the power that the best model has there: what fluctuates slowly is held back, \
             as where the sensor tracks and removes its own bias",
            short(below_hz),
            short(share)
        )
    });
    if let (Some(fading), true) = (&fading, residual.p_value_in_time >= REAL) {
        return format!("{name}: {fading}.");
    }
    let single = residual.outlier.map(|(at, size)| {
        format!(" A single reading at {} lies {} standard deviations off.", duration(at), short(size))
    });
    let [low, high] = residual.power.map(short);
    let unsteady = match residual.time_s.as_slice() {
        [] if residual.creep.is_some() => format!(
            "{name}: its noise is not steady, its power {} by {} of its mean from end to end.",
            if residual.creep.is_some_and(|c| c > 0.0) { "grows" } else { "falls" },
            short(residual.creep.unwrap_or(0.0).abs())
        ),
        [] if single.is_some() => return format!("{name}:{}", single.unwrap_or_default()),
        [] => format!("{name}: its noise is not steady, its power goes from {low} to {high} times that modelled."),
        [first, more @ ..] => format!(
            "{name}: its noise is not steady. From {} to {}{} it has up to {high} times the power modelled, at its quietest \
             {low} times{}.",
            duration(first.from),
            duration(first.to),
            match more.len() {
                0 => String::new(),
                1 => " and in one more stretch".into(),
                n => format!(" and in {n} more stretches"),
            },
            if residual.only_there { "; outside that what is left is noise" } else { "" }
        ),
    };
    unsteady + &single.unwrap_or_default() + &fading.map(|f| format!(" Also, {f}.")).unwrap_or_default()
}
