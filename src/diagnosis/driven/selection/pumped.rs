//! Looks for a disturbance that is the motion times a tone, as of a spring or a damper that
//! something pumps: the disturbance times the motion is examined at all frequencies at once, and
//! where it stands out most, the motion times a cosine and a sine of that frequency can be tested.

use std::f64::consts::TAU;

use crate::numerics::{fourier, order};

/// Frequencies that stand out most, each of which is tested.
const LOUDEST: usize = 4;
/// Bins about a frequency that hold the same one: a tone between two bins, padded to twice its
/// length, is spread over four.
const SAME: usize = 4;
/// Bins over which a spectrum is taken to be even: noise through a resonance is not, over all of it.
const EVEN_BINS: usize = 128;

/// The motion times tones.
pub(super) struct Pumped {
    /// Motion times cosine and sine, for each frequency tested.
    pub columns: Vec<[Vec<f64>; 2]>,
    /// Frequencies that were looked at.
    pub looked_at: usize,
}

impl Pumped {
    /// Finds the frequencies at which this disturbance follows this motion most; `None` where
    /// either is too short.
    pub(super) fn of(disturbance: &[f64], motion: &[f64]) -> Option<Self> {
        let rows = disturbance.len().min(motion.len());
        if rows < EVEN_BINS {
            return None;
        }
        let mut product: Vec<f64> = disturbance.iter().zip(motion).map(|(d, m)| d * m).collect();
        product.resize(2 * rows, 0.0);
        let plan = fourier::forward(product.len());
        let mut bins = plan.make_output_vec();
        plan.process(&mut product, &mut bins).ok()?;
        let mut power = Vec::with_capacity(bins.len());
        for part in bins.chunks(EVEN_BINS) {
            let here: Vec<f64> = part.iter().map(|b| b.norm_sqr()).collect();
            let middle = order::median(here.clone()).filter(|m| *m > 0.0)?;
            power.extend(here.iter().map(|p| p / middle));
        }
        let mut columns = Vec::with_capacity(LOUDEST);
        while columns.len() < LOUDEST {
            let (bin, _) = power.iter().enumerate().skip(SAME).max_by(|a, b| a.1.total_cmp(b.1))?;
            let turn = TAU * bin as f64 / (2 * rows) as f64;
            columns.push([0.0, 0.25 * TAU].map(|phase| {
                let at = |(k, m): (usize, &f64)| m * (turn * k as f64 - phase).cos();
                motion.iter().enumerate().map(at).collect()
            }));
            let last = (bin + SAME).min(power.len() - 1);
            power[bin - SAME..=last].fill(0.0);
        }
        Some(Self { columns, looked_at: rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 3000;
    /// Turns per sample of the tone, between two bins.
    const TONE: f64 = 0.0371;

    /// Noise that rings, and a disturbance that is noise of unit size and this much of that motion
    /// times a tone; of the columns that were picked, the largest correlation with the latter.
    fn picked(seed: u64, part: f64) -> f64 {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        let mut motion = vec![0.0; ROWS];
        for k in 2..ROWS {
            motion[k] = 1.9 * motion[k - 1] - 0.97 * motion[k - 2] + 0.1 * rng.normal();
        }
        let tone: Vec<f64> = motion.iter().enumerate().map(|(k, m)| m * (TAU * TONE * k as f64 + 0.4).cos()).collect();
        let disturbance: Vec<f64> = tone.iter().map(|t| part * t + rng.normal()).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let of = |c: &[f64]| dot(c, &tone).powi(2) / (dot(c, c) * dot(&tone, &tone));
        let Some(pumped) = Pumped::of(&disturbance, &motion) else { return f64::NAN };
        pumped.columns.iter().map(|[c, s]| of(c) + of(s)).fold(0.0, f64::max)
    }

    // A tone half a bin from the nearest one, over twice the length, keeps sinc²(1/4) = 0.81 of its
    // power there.
    #[test]
    fn a_motion_times_a_tone_is_among_the_loudest_and_noise_picks_it_by_chance_only() {
        let near = |part: f64| (0..20).filter(|seed| picked(*seed, part) > 0.8).count();
        assert_eq!(near(1.0), 20);
        assert!(near(0.0) <= 2, "{}", near(0.0));
    }
}
