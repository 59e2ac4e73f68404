//! Units of a sweep's columns as headings write them: frequency, angle, decibel, time.

use std::f64::consts::{PI, TAU};

use crate::recording::Recording;
use crate::recording::time_unit::TimeUnit;

/// Largest angle in rad that a heading without a unit may hold.
const TURN: f64 = 1.1 * PI;

/// Hertz in one unit of a frequency column.
pub(super) fn hertz(heading: &str, stated: Option<&str>) -> f64 {
    let written = format!("{heading} {}", stated.unwrap_or_default());
    let lower = written.to_lowercase();
    let has = |unit: &str| lower.contains(unit);
    if has("rad/s") || has("rad_s") {
        1.0 / TAU
    } else if has("ghz") {
        1e9
    } else if written.contains("mHz") {
        1e-3
    } else if has("mhz") {
        1e6
    } else if has("khz") {
        1e3
    } else {
        1.0
    }
}

/// Radians in one unit of a phase column; `None` where neither file nor heading states one.
pub(super) fn radians(heading: &str, stated: Option<&str>) -> Option<f64> {
    let unit = stated.unwrap_or(heading).to_lowercase();
    match unit.contains("deg") || unit.contains(['°', 'º']) {
        true => Some(PI / 180.0),
        false => unit.contains("rad").then_some(1.0),
    }
}

/// Radians in one unit of a phase whose unit nothing states, by its largest value.
pub(super) fn radians_by_size(largest: f64) -> f64 {
    if largest > TURN { PI / 180.0 } else { 1.0 }
}

/// The unit of the amplitude that a column in decibel stands for: V of dBV, none that is known of a
/// ratio; `None` where it is in no decibel.
pub(super) fn decibel(heading: &str, stated: Option<&str>) -> Option<&'static str> {
    let text = stated.unwrap_or(heading).to_lowercase();
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |unit: &str| words.contains(&unit);
    if has("dbv") { Some("V") } else { (has("db") || has("dbm") || has("dbu")).then_some("output unit") }
}

/// Amplitude of a level in decibel.
pub(super) fn amplitude(level_db: f64) -> f64 {
    10f64.powf(level_db / 20.0)
}

/// The unit of a column for people. A lock-in reads volts: `x_v` and `drive_v` are in V, though one
/// small letter at the end of a heading says nothing elsewhere.
pub(super) fn words(recording: &Recording, heading: &str, otherwise: &str) -> String {
    let volts = || heading.to_lowercase().ends_with("_v").then(|| "V".to_owned());
    recording.unit_words(heading).or_else(volts).map_or_else(|| otherwise.to_owned(), |unit| unit.replace('²', "^2"))
}

/// Seconds in one unit of a time column.
pub(super) fn seconds(heading: &str) -> f64 {
    TimeUnit::of_heading(heading).map_or(1.0, TimeUnit::seconds)
}

/// The unit of the reading where its column is in decibel.
pub(super) fn of_level(recording: &Recording, heading: &str) -> Option<&'static str> {
    decibel(heading, recording.stated(heading))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_say_the_unit_of_a_frequency() {
        let of = |heading: &str| hertz(heading, None);
        assert_eq!([of("f_kHz"), of("freq_MHz"), of("frequency_hz"), of("f")], [1e3, 1e6, 1.0, 1.0]);
        assert_eq!([of("Frequency (mHz)"), of("Freq [GHz]")], [1e-3, 1e9]);
        assert_eq!([hertz("w", Some("rad/s")), hertz("f", Some("kHz"))], [1.0 / TAU, 1e3]);
    }

    #[test]
    fn headings_say_the_unit_of_an_angle_and_of_a_level() {
        let degree = Some(PI / 180.0);
        for (heading, wanted) in [
            ("Theta (deg)", degree),
            ("Gain: Phase (°)", degree),
            ("phase_deg", degree),
            ("Phase [rad]", Some(1.0)),
            ("phase", None),
        ] {
            assert_eq!(radians(heading, None), wanted, "{heading}");
        }
        assert_eq!([radians_by_size(3.0), radians_by_size(179.0)], [1.0, PI / 180.0]);
        for (heading, stated, wanted) in [
            ("Gain: Magnitude (dB)", Some("dB"), Some("output unit")),
            ("mag_dB", None, Some("output unit")),
            ("Level (dBV)", None, Some("V")),
            ("R (V)", Some("V"), None),
            ("feedback", None, None),
        ] {
            assert_eq!(decibel(heading, stated), wanted, "{heading}");
        }
        // By definition of the decibel: 20 log₁₀ of ten is twenty.
        assert_eq!([amplitude(20.0), amplitude(-40.0), amplitude(0.0)], [10.0, 0.01, 1.0]);
        assert_eq!([seconds("t_s"), seconds("Time (ms)"), seconds("t")], [1.0, 1e-3, 1.0]);
    }
}
