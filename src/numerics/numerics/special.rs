//! Distributions and their quantiles, and the control of false discoveries over many tests.
//!
//! Thin, total wrappers around `statrs`: an argument outside a distribution's domain gives NaN,
//! never a panic.

use statrs::distribution::{Beta, ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use super::order::ranked;

/// Φ(z) of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// z with Φ(z) = `probability`.
pub fn normal_quantile(probability: f64) -> f64 {
    if (0.0..=1.0).contains(&probability) { Normal::standard().inverse_cdf(probability) } else { f64::NAN }
}

/// Probability that χ² with `degrees_of_freedom` degrees of freedom exceeds `value`.
pub fn chi_squared_survival(value: f64, degrees_of_freedom: f64) -> f64 {
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |d| d.sf(value.max(0.0)))
}

/// χ² with `degrees_of_freedom` degrees of freedom stays below this value with `probability`.
/// `degrees_of_freedom` need not be whole.
pub fn chi_squared_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if !(0.0..=1.0).contains(&probability) || !degrees_of_freedom.is_finite() {
        return f64::NAN;
    }
    if degrees_of_freedom > 1e4 {
        // Wilson & Hilferty 1931; the error is below 1e-6 of the value here.
        let spread = 2.0 / (9.0 * degrees_of_freedom);
        return degrees_of_freedom * (1.0 - spread + normal_quantile(probability) * spread.sqrt()).powi(3);
    }
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |d| d.inverse_cdf(probability))
}

/// Probability that F with these degrees of freedom exceeds `value`; NaN if an argument makes no sense.
pub fn f_survival(value: f64, numerator: f64, denominator: f64) -> f64 {
    // Beyond this the argument of the beta function overflows; the probability is long zero.
    if !(numerator * value).is_finite() {
        return if value > 0.0 { 0.0 } else { f64::NAN };
    }
    FisherSnedecor::new(numerator, denominator).map_or(f64::NAN, |d| d.sf(value.max(0.0)))
}

/// t with `degrees_of_freedom` degrees of freedom stays below this value with `probability`.
pub fn t_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if !(0.0..=1.0).contains(&probability) {
        return f64::NAN;
    }
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::NAN, |d| d.inverse_cdf(probability))
}

/// Exact interval of a probability that gave `hits` of `cases` (Clopper & Pearson, Biometrika 26,
/// 1934), at a `level` like 0.95. The whole of 0 to 1 where there are no cases.
pub fn exact_interval(hits: u64, cases: u64, level: f64) -> [f64; 2] {
    let tail = 0.5 * (1.0 - level);
    let quantile = |a: u64, b: u64, p: f64| Beta::new(a as f64, b as f64).map_or(f64::NAN, |beta| beta.inverse_cdf(p));
    let hits = hits.min(cases);
    let low = if hits == 0 { 0.0 } else { quantile(hits, cases - hits + 1, tail) };
    let high = if hits == cases { 1.0 } else { quantile(hits + 1, cases - hits, 1.0 - tail) };
    [low, high]
}

/// Which of many tests are discoveries when at most `rate` of those named may be false on average
/// (Benjamini & Hochberg, J. R. Stat. Soc. B 57, 1995). NaN is never a discovery.
pub fn discoveries(p_values: &[f64], rate: f64) -> Vec<bool> {
    let mut order = ranked(p_values);
    order.retain(|i| !p_values[*i].is_nan());
    let limit = |rank: usize| rate * (rank + 1) as f64 / p_values.len() as f64;
    let last = order.iter().enumerate().rev().find(|(rank, i)| p_values[**i] <= limit(*rank)).map(|(rank, _)| rank);
    let mut found = vec![false; p_values.len()];
    for index in order.iter().take(last.map_or(0, |l| l + 1)) {
        found[*index] = true;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    // Abramowitz & Stegun, Handbook of Mathematical Functions, tables 26.1, 26.8, 26.9, 26.10.
    #[test]
    fn exact_intervals_are_those_in_print() {
        // 0 of n has the upper limit 1 − 0.025^(1/n); 3 of 10 is [0.0667, 0.6525] in Clopper and
        // Pearson's tables.
        let [low, high] = exact_interval(0, 300, 0.95);
        assert!(low == 0.0 && (high - (1.0 - 0.025f64.powf(1.0 / 300.0))).abs() < 1e-9);
        let [low, high] = exact_interval(3, 10, 0.95);
        assert!((low - 0.0667).abs() < 1e-4 && (high - 0.6525).abs() < 1e-4, "{low} {high}");
        assert_eq!(exact_interval(0, 0, 0.95), [0.0, 1.0]);
    }

    #[test]
    fn tabulated_quantiles() {
        let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 2e-4, "{got} is not {want}");
        close(normal_quantile(0.975), 1.959964);
        close(chi_squared_quantile(0.95, 10.0), 18.3070);
        close(chi_squared_quantile(0.025, 1.0), 0.000982069);
        close(chi_squared_survival(18.3070, 10.0), 0.05);
        close(f_survival(3.3258, 5.0, 10.0), 0.05);
        close(t_quantile(0.975, 10.0), 2.228);
        close(chi_squared_quantile(0.975, 2e4), ChiSquared::new(2e4).expect("valid").inverse_cdf(0.975));
    }

    #[test]
    fn nonsense_is_nan() {
        assert!(chi_squared_quantile(0.5, -1.0).is_nan() && normal_quantile(2.0).is_nan());
        assert!(f_survival(f64::NAN, 1.0, 1.0).is_nan() && f_survival(f64::INFINITY, 3.0, 7.0) == 0.0);
        assert!(f_survival(1.0, 0.0, 1.0).is_nan() && t_quantile(0.5, f64::NAN).is_nan());
    }

    // Benjamini & Hochberg 1995, section 3.1: fifteen p-values, four discoveries at 5 %.
    #[test]
    fn the_published_example_of_false_discovery_control() {
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719, 0.6528,
            0.7590, 1.0000,
        ];
        assert_eq!(discoveries(&p, 0.05).iter().filter(|d| **d).count(), 4);
    }
}
