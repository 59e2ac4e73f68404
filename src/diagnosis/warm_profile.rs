//! A recorded temperature as a study takes it: a profile of few points.

use crate::motion::temperature::POSSIBLE_DEG_C;
use crate::numerics::moments;

/// Points of a profile, at most.
const POINTS: usize = 60;

/// Returns whether a sensor can be as warm as that, °C.
pub(super) fn is_possible(points: &[[f64; 2]]) -> bool {
    points.iter().all(|[_, deg_c]| POSSIBLE_DEG_C.contains(deg_c))
}

/// Returns whether a heading is that of a temperature in °C: "temp_C", "T", "temperature [°C]",
/// "deg_c".
pub(super) fn is_in_celsius(heading: &str) -> bool {
    let lower = heading.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric() && c != '°').filter(|w| !w.is_empty()).collect();
    let other = ["k", "kelvin", "f", "°f", "degf", "fahrenheit"];
    let celsius = ["c", "°c", "degc", "celsius"];
    let of_temperature = |word: &&str| word.starts_with("temp") || *word == "t";
    !words.iter().any(|word| other.contains(word))
        && words.iter().any(|word| of_temperature(word) || celsius.contains(word))
}

/// Points at equal times from the first sample to the last, each the mean of half the way to its
/// neighbours; the ends are where a straight line through the means of their two quarters ends.
pub(super) fn profile(values: &[f64], rate_hz: f64, to: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let parts = POINTS.min(values.len() / 4).max(1);
    let at = |quarters: usize| quarters * values.len() / (4 * parts);
    let mean = |from: usize, to: usize| {
        let around = &values[at(from)..at(to)];
        moments::mean(around)
    };
    let end = |outer: f64, inner: f64| outer + 0.5 * (outer - inner);
    let last = 4 * parts;
    let point = |k: usize| {
        let value = match k {
            0 => end(mean(0, 1), mean(1, 2)),
            k if k == parts => end(mean(last - 1, last), mean(last - 2, last - 1)),
            k => mean(4 * k - 2, 4 * k + 2),
        };
        [k as f64 * values.len() as f64 / parts as f64 / rate_hz, to(value)]
    };
    (0..=parts).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::{is_in_celsius, profile};

    #[test]
    fn headings_of_other_quantities_are_no_temperature_in_celsius() {
        for heading in ["temp_C", "T", "temperature [°C]", "deg_c", "imu_temp", "degC", "board temperature"] {
            assert!(is_in_celsius(heading), "{heading}");
        }
        for heading in ["supply_V", "fixed_Pa", "hum_pct", "temp_K", "temperature (F)", "current_mA", "attempt"] {
            assert!(!is_in_celsius(heading), "{heading}");
        }
    }

    #[test]
    fn a_profile_goes_through_a_straight_line_and_ends_where_the_recording_does() {
        let points = profile(&(0..2400).map(f64::from).collect::<Vec<_>>(), 40.0, |v| 20.0 + v / 40.0);
        assert_eq!((points.len(), points[0][0], points[60][0]), (61, 0.0, 60.0));
        for [time_s, deg_c] in points {
            assert!((deg_c - (20.0 + time_s)).abs() < 0.02, "{time_s}: {deg_c}");
        }
    }
}
