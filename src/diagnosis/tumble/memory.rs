//! Tells how much more the mean of residuals errs than if each were drawn anew.

/// The factor on the variance of a mean of these values by what each remembers of those before: 1 + 2
/// Σ (1 − l/n) ρ_l, over the lags up to the first that is not above chance (the initial positive
/// sequence of Geyer, Statistical Science 7 (1992) 473). Never less than one: a sum of values that
/// alternate is not trusted to be better than chance.
pub(super) fn factor(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n.max(1.0);
    let power: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if !(power > 0.0 && power.is_finite()) {
        return 1.0;
    }
    // Two standard errors of the correlation of values without memory.
    let by_chance = 2.0 / n.sqrt();
    let mut sum = 1.0;
    for lag in 1..values.len() / 4 {
        let product: f64 = values.windows(lag + 1).map(|w| (w[0] - mean) * (w[lag] - mean)).sum();
        if product / power < by_chance {
            break;
        }
        sum += 2.0 * (1.0 - lag as f64 / n) * product / power;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// An autoregression with ρ = 0.7 multiplies the variance of a mean by (1 + ρ)/(1 − ρ) = 5.7, less what a
    /// finite series hides; white noise by one.
    #[test]
    fn a_memory_is_seen_and_white_noise_has_none() {
        let mut rng = Philox::new(2, 0, Stream::Host);
        let mean = |of: &mut dyn FnMut() -> f64| (0..200).map(|_| of()).sum::<f64>() / 200.0;
        let white = mean(&mut || factor(&(0..60).map(|_| rng.normal()).collect::<Vec<_>>()));
        assert!(white < 1.05, "{white}");
        let mut last = 0.0;
        let mut coloured = || {
            last = 0.7 * last + 0.51f64.sqrt() * rng.normal();
            last
        };
        let red = mean(&mut || factor(&(0..60).map(|_| coloured()).collect::<Vec<_>>()));
        assert!((3.0..6.5).contains(&red), "{red}");
        assert_eq!((factor(&[]), factor(&[1.0; 9]), factor(&[f64::NAN; 9])), (1.0, 1.0, 1.0));
    }
}
