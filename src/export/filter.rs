//! Turns a density into the noise of one message: sent at a rate, behind a low-pass.
//!
//! White noise of two-sided density N² behind a one-pole low-pass |H|² = 1/(1 + f²/f_c²) has the
//! variance N² ∫|H|² df = N² π f_c over all frequencies, and the autocorrelation e^(−2π f_c |τ|)
//! (Papoulis, Probability, Random Variables, and Stochastic Processes, chapter 9). Messages at the
//! rate f_s are correlated by ρ = e^(−2π f_c/f_s), and their sum grows as that of independent ones
//! of variance N² π f_c (1 + ρ)/(1 − ρ) = N² π f_c coth(π f_c/f_s): N² f_s where the filter is
//! narrow, more where it lets noise above f_s/2 through. Without a filter a message is the mean
//! since the one before: N² f_s, independent, as `study` simulates it.
//!
//! Not for the vibration or the motion that a filter leaves: a sensor file states neither.

use proofmass_base::error::{Error, Result};
use std::f64::consts::PI;

/// Filter of a sensor that its messages stand behind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Filter {
    /// None: a message is the mean since the one before.
    #[default]
    Mean,
    /// One pole with this cut-off frequency, Hz.
    LowPass(f64),
}

impl Filter {
    /// Reads `none`, `low-pass:80` or `80`: the cut-off frequency, Hz.
    ///
    /// # Errors
    /// Another text, or a frequency that is not above zero.
    pub fn parse(text: &str) -> Result<Self> {
        let trimmed = text.trim();
        if trimmed == "none" {
            return Ok(Self::Mean);
        }
        let number = trimmed.strip_prefix("low-pass:").unwrap_or(trimmed);
        let cutoff_hz = number.trim().parse().ok().filter(|hz: &f64| hz.is_finite() && *hz > 0.0);
        cutoff_hz.map(Self::LowPass).ok_or_else(|| {
            Error::new(
                "could not read --filter",
                format!("need none, or the cut-off frequency of a one-pole low-pass in Hz, got `{text}`"),
                "e.g. --filter low-pass:80; where a datasheet states the noise bandwidth, divide it by 1.57",
            )
        })
    }

    /// Computes the variance of one message of white noise N.
    pub(super) fn variance(self, white: f64, rate_hz: f64) -> f64 {
        match self {
            Self::Mean => white * white * rate_hz,
            Self::LowPass(cutoff_hz) => white * white * PI * cutoff_hz,
        }
    }

    /// Computes the variance of independent messages whose sum grows as that of these.
    pub(super) fn independent(self, white: f64, rate_hz: f64) -> f64 {
        self.variance(white, rate_hz) * self.growth(rate_hz)
    }

    /// Computes the N of a sum of messages: the sensor's, and what is folded into it.
    pub(super) fn seen(self, white: f64, rate_hz: f64) -> f64 {
        (self.independent(white, rate_hz) / rate_hz).sqrt()
    }

    /// Computes (1 + ρ)/(1 − ρ) of messages that are correlated by ρ.
    fn growth(self, rate_hz: f64) -> f64 {
        match self {
            Self::Mean => 1.0,
            Self::LowPass(cutoff_hz) => (PI * cutoff_hz / rate_hz).tanh().recip(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N = 1 at 100 messages per second.
    const RATE_HZ: f64 = 100.0;

    #[test]
    fn a_narrow_filter_keeps_the_density_and_a_wide_one_folds_noise_into_it() {
        let narrow = Filter::LowPass(1.0);
        assert!((narrow.variance(2.0, RATE_HZ) / (4.0 * PI) - 1.0).abs() < 1e-12);
        // x coth x = 1 + x²/3, x = π/100.
        assert!((narrow.independent(1.0, RATE_HZ) / RATE_HZ - 1.0 - (PI / 100.0).powi(2) / 3.0).abs() < 1e-6);
        // Far above the rate messages are independent, and have all of the filter's variance.
        let wide = Filter::LowPass(1e4);
        assert!((wide.independent(1.0, RATE_HZ) / wide.variance(1.0, RATE_HZ) - 1.0).abs() < 1e-12);
        assert!(wide.independent(1.0, RATE_HZ) > 300.0 * RATE_HZ);
    }

    #[test]
    fn a_low_pass_passes_the_variance_of_its_noise_bandwidth() {
        // ∫ df/(1 + f²/f_c²) by the midpoint rule over ±4000 f_c, whose tails hold 2 f_c/4000.
        let (cutoff_hz, step_hz) = (3.0, 0.01);
        let passed = |n: u32| step_hz / (1.0 + ((f64::from(n) + 0.5) * step_hz / cutoff_hz).powi(2));
        let integral: f64 = 2.0 * (0..1_200_000).map(passed).sum::<f64>() + 2.0 * cutoff_hz / 4000.0;
        let variance = Filter::LowPass(cutoff_hz).variance(1.0, RATE_HZ);
        assert!((variance / integral - 1.0).abs() < 1e-6, "{variance} {integral}");
        // Control: a one-sided band.
        assert!((variance / (0.5 * integral) - 1.0).abs() > 0.9);
    }

    #[test]
    fn a_filter_is_read_or_refused_in_words() {
        for (text, filter) in
            [("none", Filter::Mean), ("80", Filter::LowPass(80.0)), (" low-pass: 80.5", Filter::LowPass(80.5))]
        {
            assert_eq!(Filter::parse(text), Ok(filter));
        }
        for text in ["", "0", "-3", "inf", "high-pass:3", "low-pass:", "80Hz"] {
            let error = Filter::parse(text).expect_err(text);
            assert!(error.cause.contains(&format!("got `{text}`")), "{error}");
        }
    }
}
