//! The dimension of a parameter, and the one rule by which its value moves to other units.
//!
//! A parameter of unit y^a u^b s^c (y the displacement's unit, u the input's) is multiplied by Y^a
//! U^b S^c, where Y, U and S say how many of the new units one of the old ones is. So the term
//! p·xⁱ·(x′)ʲ of a study, in which the reading a = ω₀²x is the unknown and the substep h the unit
//! of time (Y = ω₀², S = 1/h), has the coefficient p·ω₀²h²·ω₀^(−2i)·(ω₀²h)^(−j).

/// Powers of the units of displacement, input and time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dimension {
    /// Power of the displacement's unit.
    pub y: i32,
    /// Power of the input's unit.
    pub u: i32,
    pub s: i32,
}

/// Conversion factors from old units to new ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Of displacement: new units per old one.
    pub y: f64,
    /// Of input: new units per old one.
    pub u: f64,
    /// Of time: new units per old one.
    pub s: f64,
}

impl Dimension {
    /// Of a unit as the library writes it, e.g. `1/(y^2 s^2)`. Radians and numbers count nothing,
    /// Hz is 1/s. Not for roots of units, which only noise has.
    pub(crate) const fn of(unit: &str) -> Self {
        let text = unit.as_bytes();
        let mut d = Self { y: 0, u: 0, s: 0 };
        let (mut i, mut sign) = (0, 1);
        while i < text.len() {
            let alone = i + 1 == text.len() || !text[i + 1].is_ascii_alphabetic();
            let power = if i + 2 < text.len() && text[i + 1] == b'^' { (text[i + 2] - b'0') as i32 } else { 1 };
            match text[i] {
                b'/' => sign = -1,
                b'y' if alone => d.y += sign * power,
                b'u' if alone => d.u += sign * power,
                b's' if alone => d.s += sign * power,
                b'H' => d.s -= sign,
                _ => {}
            }
            // A word that is none of the three letters is passed over whole.
            if text[i].is_ascii_alphabetic() {
                while i < text.len() && text[i].is_ascii_alphabetic() {
                    i += 1;
                }
            } else if text[i] == b'^' {
                i += 2;
            } else {
                i += 1;
            }
        }
        d
    }

    /// Returns the factor of a value of this dimension.
    pub(crate) fn factor(self, units: &Units) -> f64 {
        units.y.powi(self.y) * units.u.powi(self.u) * units.s.powi(self.s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_library_are_read() {
        let d = |y, u, s| Dimension { y, u, s };
        for (unit, expected) in [
            ("1/(y^2 s^2)", d(-2, 0, -2)),
            ("1/(y^2 s)", d(-2, 0, -1)),
            ("1/y", d(-1, 0, 0)),
            ("y/s^2", d(1, 0, -2)),
            ("y/(u s^2)", d(1, -1, -2)),
            ("rad/s", d(0, 0, -1)),
            ("Hz", d(0, 0, -1)),
            ("1", d(0, 0, 0)),
            ("1/u", d(0, -1, 0)),
        ] {
            assert_eq!(Dimension::of(unit), expected, "{unit}");
        }
        assert_ne!(Dimension::of("1/(y s^2)"), Dimension::of("1/(y^2 s^2)"), "powers count");
    }

    // β x³ of a mass with ω₀ = 3 rad/s in steps of 0.1 s: W·γ with W = (ω₀h)² and γ = β/ω₀⁶
    // (kernel::member).
    #[test]
    fn a_cubic_spring_has_the_coefficient_of_the_reading() {
        let (omega, h, beta) = (3.0f64, 0.1, 7.0);
        let units = Units { y: omega * omega, u: 1.0, s: 1.0 / h };
        let got = beta * Dimension::of("1/(y^2 s^2)").factor(&units);
        assert!((got / ((omega * h).powi(2) * beta / omega.powi(6)) - 1.0).abs() < 1e-14);
    }
}
