//! Finds where a spectrum begins to fall towards half the sampling rate, and judges a recording
//! below it.
//!
//! Behind a low-pass filter the noise is flat, or rises to low frequencies as its laws do, up to a
//! corner; above it less and less is left. Shapes that are stated (`candidate::band_limit`) are
//! fitted as they are. Of others, and where noise passes the filter only in part, the laws follow
//! the filter's skirt instead of the noise: a memory for the corner, flicker as a walk and a memory.
//! Below the corner the noise is the sensor's own, whatever the filter: the coefficients of the
//! cosine transform up to it, turned back, are the recording as a slower logger behind an ideal
//! filter would have it. Not where anything above the corner is stronger than below: that is no
//! filter.

use super::cause::Cause;
use super::channel::{Channel, Curve, Fitted};
use super::laws::slow_laws;
use super::residual::{TOLERANCE, residual};
use super::spectrum::{self, Bin, Law, Part};
use crate::numerics::cosine;
use crate::numerics::special::chi_squared_survival;
use crate::remainder::REAL;

/// Times fewer samples that are tried, least first.
const SLOWER: [usize; 16] = [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32];
/// Fewer samples are not left: they would tell no law from another over two decades.
const FEWEST: usize = 2048;
/// Part of the band, from its top, that is held against what lies below it.
const TOP: f64 = 0.25;
/// Power that may be missing in the top of the band that is kept: less than counts as a mismatch by
/// a factor of three, so that no law is bent by the filter's shoulder.
const SHOULDER: f64 = TOLERANCE / 3.0;

/// Power of bins over a model's, and how many coefficients that is from.
struct Held {
    ratio: f64,
    count: f64,
}

impl Held {
    /// Probability of so little power by chance where this share may be missing.
    fn low(&self, tolerance: f64) -> f64 {
        1.0 - chi_squared_survival(self.count * self.ratio * (1.0 + tolerance), self.count)
    }

    /// Probability of so much power by chance where this share may be too much.
    fn high(&self, tolerance: f64) -> f64 {
        chi_squared_survival(self.count * self.ratio / (1.0 + tolerance), self.count)
    }
}

/// Noise fitted below a frequency: white, flicker and a walk, whichever are there.
struct Below<'a> {
    bins: &'a [Bin],
    strengths: Vec<f64>,
}

const LAWS: [Law; 3] = [Law::White, Law::Flicker, Law::Walk];

impl<'a> Below<'a> {
    fn of(bins: &'a [Bin], theta: f64) -> Self {
        let below: Vec<Bin> = bins.iter().take_while(|b| b.theta < theta).copied().collect();
        Self { bins, strengths: spectrum::fit(&below, &LAWS, &[], Part::All).values }
    }

    /// Power between two angles over that of the laws.
    fn held(&self, [from, to]: [f64; 2]) -> Held {
        let inside: Vec<Bin> = self.bins.iter().filter(|b| from <= b.theta && b.theta < to).copied().collect();
        let variances = spectrum::variances(&inside, &LAWS, &self.strengths, &[]);
        let (sum, count) = inside.iter().zip(&variances).fold((0.0, 0.0), |(sum, count), (bin, variance)| {
            (sum + (bin.sum[0] + bin.sum[1]) / variance, count + bin.count[0] + bin.count[1])
        });
        Held { ratio: sum / f64::max(count, 1.0), count }
    }
}

/// Times fewer samples with which a channel's spectrum does not fall any more; `None` where it does
/// not fall, or where more than a fall is there.
pub(super) fn slower(channel: &Channel) -> Option<usize> {
    let bins = spectrum::bins(&channel.coefficients);
    let half = std::f64::consts::FRAC_PI_2;
    let top = |slower: usize| half / slower as f64;
    let fitted_to = |slower: usize| Below::of(&bins, (1.0 - TOP) * top(slower));
    let falls = |slower: usize, tolerance: f64| {
        fitted_to(slower).held([(1.0 - TOP) * top(slower), top(slower)]).low(tolerance) < REAL
    };
    if !falls(1, TOLERANCE) {
        return None;
    }
    let enough = |slower: &usize| channel.values.len() / slower >= FEWEST;
    let found = SLOWER.into_iter().skip(1).filter(enough).find(|slower| !falls(*slower, SHOULDER))?;
    // By octaves above the corner, nothing is stronger than below it.
    let below = Below::of(&bins, top(found));
    let octaves = (0..6).map(|k| [top(found) * f64::from(1 << k), top(found) * f64::from(2 << k)]);
    let quiet = octaves.take_while(|o| o[0] < half).all(|o| below.held(o).high(TOLERANCE) > REAL);
    quiet.then_some(found)
}

/// Returns whether a filter may have bent a channel's model: noise is named, or something is left.
pub(super) fn may_be_bent(channel: &Channel, chosen: &Fitted, channels: usize) -> bool {
    !slow_laws(chosen).is_empty() || !is_described(channel, chosen, channels)
}

/// Returns whether a model leaves nothing but noise.
pub(super) fn is_described(channel: &Channel, chosen: &Fitted, channels: usize) -> bool {
    residual(channel, chosen, TOLERANCE).p_value * channels as f64 >= REAL
}

/// Returns whether a model holds a sine above half the reduced sampling rate.
pub(super) fn has_line_above(chosen: &Fitted, slower: usize) -> bool {
    chosen.terms.iter().any(|t| t.cause == Cause::Sinusoid && t.searched > 0.5 / slower as f64)
}

/// Reduces the sampling rate by this factor, behind an ideal low-pass filter.
fn slowed(values: &[f64], slower: usize) -> Vec<f64> {
    let count = values.len() / slower;
    let mut coefficients = cosine::transform(&values[..count * slower]);
    coefficients.truncate(count);
    let scale = 1.0 / (slower as f64).sqrt();
    cosine::invert(&coefficients).into_iter().map(|v| scale * v).collect()
}

/// The same of a column.
pub(super) fn slowed_curve(curve: &Curve, slower: usize) -> Curve {
    Curve::new(slowed(&curve.values, slower))
}

/// The same of a channel, with all that is known of its readings.
pub(super) fn slowed_channel(channel: &Channel, slower: usize) -> Channel {
    let values: Vec<f64> = slowed(&channel.values, slower).iter().map(|v| channel.mean + channel.scale * v).collect();
    let own = Channel::new(&channel.name, &values, channel.rate_hz / slower as f64);
    Channel {
        unit: channel.unit.clone(),
        step: channel.step.map(|q| q * channel.scale / own.scale),
        together: channel.together * slower,
        disturbances: channel.disturbances.clone(),
        ..own
    }
}
