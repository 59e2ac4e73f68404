//! Pictures of noise that a simulation does not predict sample by sample.

use super::linear;
use super::picture::{Axis, Curve, POINTS, Picture};
use crate::law::Noise;
use crate::numerics::allan::law::Term;

/// Longest averaging time, in samples.
const LONGEST: f64 = 1e4;
/// Averaging time at which a noise and the white noise next to it are equally large, in samples.
const CROSSING: f64 = 10.0;

/// The picture of a noise: in the spectrum where the resonance colours it, over averaging times where it wanders.
pub(super) fn of(which: Noise) -> Option<Picture> {
    match which {
        Noise::Force => {
            let curve = Curve { name: "force noise", ..linear::alone()? };
            let ends = [curve.points.first()?.0, curve.points.last()?.0];
            let white = Curve { name: "noise of the readout", is_guide: true, points: ends.map(|f| (f, 1.0)).into() };
            let y = Axis::log("amplitude density / lowest");
            Some(Picture { x: linear::frequency(), y, curves: vec![white, curve] })
        }
        Noise::Walk => Some(next_to_white(|samples| Term::Walk.variance(samples))),
    }
}

/// Allan deviation over averaging times in samples, of white noise alone and with another Allan variance, which
/// is taken as large as that of the white noise at ten samples.
pub fn next_to_white(variance: impl Fn(f64) -> f64) -> Picture {
    let samples = |i: usize| LONGEST.powf(i as f64 / (POINTS - 1) as f64);
    let deviation = |of: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        (0..POINTS).map(samples).map(|tau| (tau, of(tau).sqrt())).collect()
    };
    let white = |tau: f64| Term::White.variance(tau);
    let size = white(CROSSING) / variance(CROSSING);
    let curves = vec![
        Curve { name: "white noise as stated", is_guide: true, points: deviation(&white) },
        Curve { name: "with it", is_guide: false, points: deviation(&|tau| white(tau) + size * variance(tau)) },
    ];
    let (x, y) = (Axis::log("averaging time / samples"), Axis::log("Allan deviation / white noise of a sample"));
    Picture { x, y, curves }
}
