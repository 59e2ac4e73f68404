//! Time on the scale of its logarithm: where what settles in several speeds is an even course.

/// Part of a recording at which the logarithm begins.
const EARLY: f64 = 0.01;

/// Place of a time on that scale, both from 0 to 1 over the recording: ln(1 + t/t₀) / ln(1 + 1/t₀).
pub fn log_time(at: f64) -> f64 {
    (at / EARLY).ln_1p() / (1.0 / EARLY).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_stay_and_a_tenth_of_the_time_takes_half_of_the_scale() {
        assert_eq!((log_time(0.0), log_time(1.0)), (0.0, 1.0));
        // ln 11 / ln 101.
        assert!((log_time(0.1) - 0.519_57).abs() < 1e-5, "{}", log_time(0.1));
    }
}
