//! The free linear oscillator: how displacement and velocity go on without any force, exactly.

/// exp(At) for A = [[0, 1], [−ω², −2ζω]], row by row; any ζ ≥ 0.
pub fn transition(omega: f64, zeta: f64, t: f64) -> [f64; 4] {
    let decay = (-zeta * omega * t).exp();
    let d = 1.0 - zeta * zeta;
    // C = cos(w t) and S = sin(w t)/w, continued analytically through critical damping.
    let (c, s) = if d > 1e-8 {
        let w = omega * d.sqrt();
        ((w * t).cos() * decay, (w * t).sin() / w * decay)
    } else if d < -1e-8 {
        let w = omega * (-d).sqrt();
        let (up, down) = (((w - zeta * omega) * t).exp(), ((-w - zeta * omega) * t).exp());
        (0.5 * (up + down), 0.5 * (up - down) / w)
    } else {
        let square = -d * (omega * t).powi(2);
        (decay * (1.0 + 0.5 * square), t * decay * (1.0 + square / 6.0))
    };
    let a = zeta * omega;
    [c + a * s, s, -omega * omega * s, c - a * s]
}

/// The fastest rate of the free motion: ω, or how fast an overdamped one comes to rest.
pub(crate) fn fastest_rad_s(omega: f64, zeta: f64) -> f64 {
    omega * (zeta + (zeta * zeta - 1.0).max(0.0).sqrt()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Roots of λ² + 2ζωλ + ω²: of size ω up to critical damping, (ζ + √(ζ² − 1))ω beyond.
    #[test]
    fn the_fastest_rate_is_the_larger_root() {
        assert_eq!([0.0, 0.7, 1.0].map(|zeta| fastest_rad_s(3.0, zeta)), [3.0; 3]);
        let fast = fastest_rad_s(3.0, 1.25);
        assert!((fast * fast - 2.0 * 1.25 * 3.0 * fast + 9.0).abs() < 1e-12 && fast > 3.0, "{fast}");
    }

    #[test]
    fn it_solves_its_equation_on_both_sides_of_critical_damping() {
        for zeta in [0.02, 0.7, 1.0, 1.5] {
            let (omega, t, d) = (3.0, 0.4, 1e-6);
            let (e0, e1) = (transition(omega, zeta, t - d), transition(omega, zeta, t + d));
            let e = transition(omega, zeta, t);
            for j in 0..2 {
                assert!(((e1[j] - e0[j]) / (2.0 * d) - e[2 + j]).abs() < 1e-7);
                let force = -omega * omega * e[j] - 2.0 * zeta * omega * e[2 + j];
                assert!(((e1[2 + j] - e0[2 + j]) / (2.0 * d) - force).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn two_halves_are_the_whole_also_close_to_critical_damping() {
        for (omega, zeta) in [(0.1, 0.1), (7.7, 0.006), (1.0, 1.0), (1.0, 1.000_000_005), (2.0, 225.0), (1e-3, 0.5)] {
            let [[a, b], [d, e]] = [[0, 1], [2, 3]].map(|row| row.map(|i: usize| transition(omega, zeta, 0.5)[i]));
            let squared = [a * a + b * d, a * b + b * e, d * a + e * d, d * b + e * e];
            for (got, want) in squared.iter().zip(transition(omega, zeta, 1.0)) {
                assert!((got - want).abs() < 1e-11 * (1.0 + omega * omega), "{omega} {zeta}: {got} {want}");
            }
        }
    }
}
