//! Numbers for people: rounded to what they are worth, with their uncertainty, and durations in the
//! unit one would say.

/// `value` with `digits` significant digits, plain where that is short, else ×10ⁿ.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return if value.is_nan() {
            "–".into()
        } else if value > 0.0 {
            "∞".into()
        } else {
            "−∞".into()
        };
    }
    if value == 0.0 {
        return "0".into();
    }
    let rounded = format!("{:.*e}", digits.saturating_sub(1), value);
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if (-3..=digits.max(5) as i32).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{:.*}", decimals, rounded.parse::<f64>().unwrap_or(value))
    } else {
        format!("{mantissa}×10{}", superscript(exponent))
    };
    text.replacen('-', "−", 1)
}

/// Three significant digits: what a sentence needs.
pub fn short(value: f64) -> String {
    significant(value, 3)
}

/// `value` as the nearest number of this many significant digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{:.*e}", digits.saturating_sub(1), value).parse().unwrap_or(value)
}

/// `value` to the digit that `deviation` leaves in doubt; one digit where all of it is in doubt, at
/// most five.
pub fn worth(value: f64, deviation: f64) -> String {
    if !(deviation > 0.0 && deviation.is_finite() && value != 0.0) {
        return significant(value, 3);
    }
    let digits = value.abs().log10().floor() - deviation.log10().floor() + 1.0;
    significant(value, digits.clamp(1.0, 5.0) as usize)
}

/// `value ± deviation`, the deviation to two digits and the value to the same decimal place.
pub fn with_uncertainty(value: f64, deviation: f64) -> String {
    if !(deviation > 0.0 && deviation.is_finite() && value.is_finite()) {
        return significant(value, 4);
    }
    let scale = value.abs().max(deviation).log10().floor() as i32;
    // Digits that the deviation does not vouch for are not printed.
    let power = if (-3..6).contains(&scale) && deviation < 99.5 { 0 } else { scale };
    let shrink = 10f64.powi(power);
    let decimals = (1 - (deviation / shrink).log10().floor() as i32).max(0) as usize;
    // What rounds to nothing has no sign.
    let shown = format!("{:.*}", decimals, value / shrink);
    let shown = if shown.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        shown.trim_start_matches('-').to_owned()
    } else {
        shown.replacen('-', "−", 1)
    };
    let body = format!("{shown} ± {:.*}", decimals, deviation / shrink);
    if power == 0 { body } else { format!("({body})×10{}", superscript(power)) }
}

/// An integer as superscript digits.
pub fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            d => char::from_u32(0x2070 + (d as u32 - '0' as u32)).unwrap_or(d),
        })
        .collect()
}

/// A duration in the unit a person would say it in.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} µs", significant(s * 1e6, 3)),
        s if s < 1.0 => format!("{} ms", significant(s * 1e3, 3)),
        s if s < 120.0 => format!("{} s", significant(s, 3)),
        s if s < 7200.0 => format!("{} min", significant(s / 60.0, 3)),
        s => format!("{} h", significant(s / 3600.0, 3)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_carry_the_digits_they_are_worth() {
        assert_eq!([0.0, 0.1 + 0.2, 123_456.0].map(|v| rounded(v, 4)), [0.0, 0.3, 123_500.0]);
        assert_eq!(significant(1.7, 3), "1.70");
        assert_eq!([0.0, 11.17, 0.5641, 12_345.0, 2.5e-7].map(short), ["0", "11.2", "0.564", "12300", "2.50×10⁻⁷"]);
        assert_eq!([0.02, 450.0, 192_200.0].map(duration), ["20.0 ms", "7.50 min", "53.4 h"]);
        assert_eq!(significant(-0.00123456, 3), "−0.00123");
        assert_eq!(significant(7.3e5, 2), "730000");
        assert_eq!(significant(7.3e9, 2), "7.3×10⁹");
        assert_eq!(with_uncertainty(1.8412, 0.0123), "1.841 ± 0.012");
        assert_eq!(with_uncertainty(7.3e7, 1.2e6), "(7.30 ± 0.12)×10⁷");
        assert_eq!(with_uncertainty(-2e-5, 0.0021), "0.0000 ± 0.0021");
        assert_eq!([worth(42.53, 0.23), worth(-0.179, 0.42), worth(100.04, 1.2)], ["42.5", "−0.2", "100"]);
    }
}
