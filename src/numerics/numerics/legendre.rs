//! Legendre's polynomials: smooth courses over a recording, nearly orthogonal to each other and with
//! any slope at its ends.

/// Legendre's polynomial of a degree at a place from −1 to 1, by Bonnet's recursion (Abramowitz &
/// Stegun, 22.7.10).
pub fn legendre(degree: usize, x: f64) -> f64 {
    let (mut before, mut now) = (1.0, x);
    for k in 1..degree {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
    }
    if degree == 0 { 1.0 } else { now }
}

#[cfg(test)]
mod tests {
    use super::legendre;

    // P₂ = (3x² − 1)/2 and P₃ = (5x³ − 3x)/2 (Abramowitz & Stegun, 22.3.8), and 1 at the end.
    #[test]
    fn the_first_ones_are_as_the_tables_have_them() {
        for x in [-1.0, -0.3, 0.0, 0.7, 1.0f64] {
            let tables = [1.0, x, 0.5 * (3.0 * x * x - 1.0), 0.5 * (5.0 * x.powi(3) - 3.0 * x)];
            for (degree, expected) in tables.into_iter().enumerate() {
                assert!((legendre(degree, x) - expected).abs() < 1e-14, "P{degree}({x})");
            }
        }
        assert!((legendre(8, 1.0) - 1.0).abs() < 1e-14 && legendre(8, 0.9) < 0.9);
    }
}
