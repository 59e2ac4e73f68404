//! Names of columns and files from the words of a figure: "position error / m" is
//! `position_error_m`.

/// The unit of a label, as its last part after " / ".
fn parts(label: &str) -> (&str, Option<&str>) {
    label.rsplit_once(" / ").map_or((label, None), |(quantity, unit)| (quantity, Some(unit)))
}

/// A quantity and what further describes it, with the unit of `label` at the end, in the way of the
/// keys of a study.
pub(crate) fn column(label: &str, more: &[&str]) -> String {
    let (quantity, unit) = parts(label);
    let unit = unit.map(|u| match u.trim_matches(['(', ')']).strip_prefix("1/") {
        Some(of) => format!("per {of}"),
        None => u.to_owned(),
    });
    let words = std::iter::once(quantity).chain(more.iter().copied()).chain(unit.as_deref());
    slug(&words.collect::<Vec<_>>().join(" "), '_')
}

/// Returns whether words carry a unit of their own.
pub(crate) fn has_unit(label: &str) -> bool {
    parts(label).1.is_some()
}

/// A title as the name of a file.
pub(crate) fn file(title: &str) -> String {
    let name: String = slug(title, '-').chars().take(LONGEST).collect();
    if name.is_empty() { "figure".into() } else { name }
}

/// Characters of a file name.
const LONGEST: usize = 80;

/// ASCII letters and digits, everything else between them one separator; the letters of formulas by
/// their names.
fn slug(text: &str, separator: char) -> String {
    let mut out = String::new();
    let mut apart = false;
    for c in text.chars() {
        let (word, alone) = spelt(c);
        if word.is_empty() {
            apart = true;
            continue;
        }
        if (apart || alone) && !out.is_empty() && !out.ends_with(separator) {
            out.push(separator);
        }
        out += &word;
        apart = alone;
    }
    out
}

/// Spells a character in ASCII, and says whether it is a word of its own.
fn spelt(c: char) -> (String, bool) {
    let word = match c {
        _ if c.is_ascii_alphanumeric() => return (c.to_ascii_lowercase().to_string(), false),
        '²' | '₂' => return ("2".into(), false),
        '³' => return ("3".into(), false),
        '₀' => return ("0".into(), false),
        '₁' => return ("1".into(), false),
        'µ' | 'μ' => return ("u".into(), false),
        '√' => return ("rt".into(), false),
        '°' => return ("deg".into(), false),
        '%' => "percent",
        '−' => "minus",
        '½' => "half",
        'τ' => "tau",
        'σ' => "sigma",
        'λ' => "lambda",
        'ω' => "omega",
        'π' => "pi",
        'ε' => "epsilon",
        'Δ' => "delta",
        _ => "",
    };
    (word.into(), true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_end_in_their_unit_as_the_keys_of_a_study_do() {
        for (label, more, name) in [
            ("position error / m", &[][..], "position_error_m"),
            ("Allan deviation / (m/s²)", &["recorded", "low"], "allan_deviation_recorded_low_m_s2"),
            ("density / (µg/√Hz)", &[], "density_ug_rthz"),
            ("largest exponent / (1/s)", &[], "largest_exponent_per_s"),
            ("averaging time τ / s", &[], "averaging_time_tau_s"),
            ("rate / (°/s)", &["5–95 %"], "rate_5_95_percent_deg_s"),
            ("recorded − simulated / V", &[], "recorded_minus_simulated_v"),
            ("standard deviation", &[], "standard_deviation"),
        ] {
            assert_eq!(column(label, more), name);
        }
        assert_eq!(file("Force on «x» / over time"), "force-on-x-over-time");
        assert_eq!(file("加速度"), "figure");
    }
}
