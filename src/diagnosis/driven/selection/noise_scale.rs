//! Estimates the strength of the noise at each sample, where it changes with time or with the
//! motion: a product of one factor each for the stretch of time, the displacement, the velocity and
//! the amplitude. With it, errors of uneven noise can be weighed alike. Not a test: see
//! `noise_character`.

use crate::numerics::order;

/// Stretches of time with a factor each, and the fewest samples in one.
const STRETCHES: usize = 64;
const LEAST_SAMPLES: usize = 64;
/// Ranges, equally full, of each variable of the motion with a factor each.
const RANGES: usize = 16;
/// Times that all factors are found in turn.
const PASSES: usize = 3;

/// Displacement and velocity of the mass at each sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MassMotion<'a> {
    pub x: &'a [f64],
    pub v: &'a [f64],
    /// Angular frequency by which a velocity is compared with a displacement.
    pub omega_rad_s: f64,
}

impl MassMotion<'_> {
    /// √(x² + (v/ω)²) about the mean displacement.
    pub(crate) fn amplitude(&self) -> Vec<f64> {
        let mean = self.x.iter().sum::<f64>() / self.x.len().max(1) as f64;
        self.x.iter().zip(self.v).map(|(x, v)| (x - mean).hypot(v / self.omega_rad_s)).collect()
    }
}

/// Mean absolute error to be expected at each sample, relative to that of the whole.
pub(super) fn local_scale(errors: &[f64], motion: &MassMotion<'_>) -> Vec<f64> {
    let n = errors.len();
    let mut scale = vec![1.0; n];
    if n < 2 * LEAST_SAMPLES {
        return scale;
    }
    let ranges = |keys: &[f64]| {
        let ranked = order::ranked(keys);
        (0..RANGES).map(|i| ranked[n * i / RANGES..n * (i + 1) / RANGES].to_vec()).collect::<Vec<_>>()
    };
    let stretches = (n / LEAST_SAMPLES).min(STRETCHES);
    let by_time = (0..stretches).map(|i| (n * i / stretches..n * (i + 1) / stretches).collect()).collect::<Vec<_>>();
    let groupings = [by_time, ranges(motion.x), ranges(motion.v), ranges(&motion.amplitude())];
    for _ in 0..PASSES {
        for group in groupings.iter().flatten() {
            let size = group.iter().map(|k| errors[*k].abs() / scale[*k]).sum::<f64>() / group.len() as f64;
            if size > 0.0 && size.is_finite() {
                group.iter().for_each(|k| scale[*k] *= size);
            }
        }
    }
    let whole = scale.iter().sum::<f64>() / n as f64;
    scale.iter_mut().for_each(|s| *s /= whole);
    scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn noise_that_grows_with_time_and_with_displacement_is_even_in_its_scale() {
        let n = 20_000;
        let mut rng = Philox::new(3, 0, Stream::Host);
        let x: Vec<f64> = (0..n).map(|k| (0.31 * f64::from(k)).sin()).collect();
        let v: Vec<f64> = (0..n).map(|k| (0.31 * f64::from(k)).cos()).collect();
        let truth: Vec<f64> = (0..n as usize).map(|k| (0.5 + k as f64 / f64::from(n)) * (0.2 + x[k].abs())).collect();
        let errors: Vec<f64> = truth.iter().map(|s| s * rng.normal()).collect();
        let scale = local_scale(&errors, &MassMotion { x: &x, v: &v, omega_rad_s: 1.0 });
        let mean = truth.iter().sum::<f64>() / f64::from(n);
        let off = scale.iter().zip(&truth).map(|(s, t)| (s * mean / t).ln().powi(2)).sum::<f64>() / f64::from(n);
        // A range of displacement in which the strength changes by a half errs by a sixth at its
        // ends.
        assert!(off.sqrt() < 0.15, "{}", off.sqrt());
        // Control: one strength for all is three times as wrong.
        let even = truth.iter().map(|t| (mean / t).ln().powi(2)).sum::<f64>() / f64::from(n);
        assert!(even.sqrt() > 0.45, "{}", even.sqrt());
    }
}
