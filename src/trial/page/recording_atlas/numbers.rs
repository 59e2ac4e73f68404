//! Says an estimate with its interval in as many digits as the interval leaves, and a limit as a
//! limit.

use crate::recording_atlas::measured::Coefficient;
use proofmass_base::number::{significant, superscript};

/// "52.2 (38.1 – 67.2) µg/√s", or "< 7.9 mg/h" of a coefficient whose interval begins at zero.
pub(super) fn coefficient(c: &Coefficient) -> String {
    match c.value {
        Some(value) => format!("{} {}", estimate(value, c.ci95), c.unit),
        None => format!("< {} {}", significant(c.ci95[1], 2), c.unit),
    }
}

/// Value with the ends of its 95 % interval; the ends alone where zero lies between them, as the
/// value is then not told from zero.
pub(super) fn estimate(value: f64, ci95: [f64; 2]) -> String {
    let [low, high] = ci95;
    let half = (high - low) / 2.0;
    let largest = value.abs().max(low.abs()).max(high.abs());
    let scale = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
    let (shrink, times) = match (-3..6).contains(&scale) {
        true => (1.0, String::new()),
        false => (10f64.powi(scale), format!(" ×10{}", superscript(scale))),
    };
    let decimals = match half > 0.0 {
        true => (1 - (half / shrink).log10().floor() as i32).clamp(0, 12) as usize,
        false => 3,
    };
    let say = |v: f64| format!("{:.decimals$}", v / shrink).replacen('-', "−", 1);
    match low < 0.0 && high > 0.0 {
        true => format!("zero within {} to {}{times}", say(low), say(high)),
        false => format!("{} ({} – {}){times}", say(value), say(low), say(high)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_end_where_the_interval_begins_and_zero_makes_a_limit() {
        // Half widths 0.38, 400 and 2e-7: two digits of each.
        assert_eq!(estimate(5.282, [4.9, 5.66]), "5.28 (4.90 – 5.66)");
        assert_eq!(estimate(24992.0, [24592.0, 25392.0]), "24992 (24592 – 25392)");
        assert_eq!(estimate(7.3407e5, [7.3328e5, 7.3486e5]), "734070 (733280 – 734860)");
        assert_eq!(estimate(-1.8297e-5, [-1.85e-5, -1.81e-5]), "−1.830 (−1.850 – −1.810) ×10⁻⁵");
        assert_eq!(estimate(0.009, [-0.003, 0.021]), "zero within −0.003 to 0.021");
        let of = |value, ci95| coefficient(&Coefficient { value, ci95, unit: "mg/h" });
        assert_eq!(of(None, [0.0, 7.87]), "< 7.9 mg/h");
        assert_eq!(of(Some(0.17), [0.09, 0.24]), "0.170 (0.090 – 0.240) mg/h");
    }
}
