//! The steady motion of an oscillator with any laws of the library under a sine: harmonic balance.
//!
//! Along x = c + a cos θ (and further harmonics where the laws need them) the laws' own force has a
//! fundamental F̂(a, ω); the motion then satisfies (ω₀² − ω² + iωΓ − F̂/a) X = g·D. For each set of
//! parameters F̂ is tabulated over amplitude at three frequencies; every motion that the equation
//! allows follows from the sign changes of |Z|a − gD, those that are stable with it rising.

use super::cycle::{Cycle, HARMONICS, HEARD};
use super::force::{Law, Oscillator};

/// Amplitudes of a table.
pub(super) const NODES: usize = 48;

/// Fundamental of the force over amplitude and frequency.
#[derive(Debug, Clone)]
pub(super) struct Table {
    /// Largest amplitude.
    pub most: f64,
    /// Its three frequencies.
    pub at_rad_s: [f64; 3],
    /// Real and imaginary part of the force at each frequency, by amplitude.
    pub parts: [[[f64; NODES]; 3]; 2],
    /// States that no law acts, whose force would be tabulated.
    pub is_empty: bool,
    /// Harmonics that were followed, the fundamental among them.
    pub harmonics: usize,
}

impl Table {
    /// Tabulates laws for amplitudes up to `most` over a band of frequencies.
    pub(super) fn new(mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        Self::up_to(HARMONICS, mass, laws, most, band_rad_s)
    }

    /// The same with the fundamental alone: a place to begin, some per cent off.
    pub(super) fn rough(mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        Self::up_to(1, mass, laws, most, band_rad_s)
    }

    fn up_to(harmonics: usize, mass: &Oscillator, laws: &[Law], most: f64, band_rad_s: [f64; 2]) -> Self {
        let acting: Vec<&Law> = laws.iter().filter(|law| law.is_tabulated()).collect();
        let [low, high] = band_rad_s;
        let at_rad_s = [low, 0.5 * (low + high), high];
        if acting.is_empty() {
            return Self { most, at_rad_s, parts: [[[0.0; NODES]; 3]; 2], is_empty: true, harmonics: 1 };
        }
        let cycle = |omega_rad_s: f64| Cycle { mass, laws: &acting, omega_rad_s };
        let middle = cycle(at_rad_s[1]);
        // An even force acts by the mean and the second harmonic that it makes, and by them alone.
        let harmonics = if middle.has_mean(0.7 * most) { HARMONICS } else { harmonics };
        let [bare, full] = [1, harmonics].map(|h| middle.fundamental(0.7 * most, h));
        let harmonics = if (full - bare).norm() > HEARD * bare.norm() { harmonics } else { 1 };
        // A spring alone is the same at every frequency, but for its harmonics.
        let is_alike = harmonics == 1 && acting.iter().all(|law| !law.has_velocity(mass, 0.7 * most));
        let node = |i: usize| {
            let at = |omega: f64| cycle(omega).fundamental(amplitude(most, i), harmonics);
            if is_alike { [at(at_rad_s[1]); 3] } else { at_rad_s.map(at) }
        };
        let mut parts = [[[0.0; NODES]; 3]; 2];
        let [re, im] = &mut parts;
        for (i, forces) in (0..NODES).map(|i| (i, node(i))) {
            for ((re, im), force) in re.iter_mut().zip(im.iter_mut()).zip(forces) {
                (re[i], im[i]) = (force.re, force.im);
            }
        }
        Self { most, at_rad_s, parts, is_empty: false, harmonics }
    }
}

/// Amplitude of a node of a table up to `most`.
pub(super) fn amplitude(most: f64, node: usize) -> f64 {
    most * (node as f64 / (NODES - 1) as f64).powi(2)
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;
    use crate::physics::cubic_stiffness::CubicStiffness;
    use crate::physics::library::Term;

    // Of a spring βx³ under a sine, (ω₀² + κa² − ω²)² + Γ²ω² = (push/a)² with κ = 3β/4 (Nayfeh & Mook, Nonlinear
    // Oscillations, 1979, ch. 4): for each amplitude below the peak the branch that is jumped from is at the smaller
    // of two ω². The peak lies ten and thirty widths of the line above ω₀.
    #[test]
    fn the_upper_branch_is_followed_to_its_end() {
        let (mass, push) = (Oscillator { omega_rad_s: 1.0, damping_per_s: 0.01 }, 0.01);
        for widths in [10.0, 30.0] {
            let kappa = 2.0 * widths * mass.damping_per_s;
            let law = Law { term: Term::CubicStiffness(CubicStiffness), values: vec![kappa / 0.75] };
            let highest: f64 = 1.0 + kappa;
            let most = 1.2 / highest.sqrt();
            let table = Table::rough(&mass, &[law], most, [0.8, 1.2 * highest.sqrt()]);
            // Γωa = push at the peak.
            let peak = 1.0 / (1.0 + kappa).sqrt();
            for part in [0.5, 0.8, 0.9, 0.95, 0.97, 0.98, 0.985, 0.99] {
                let a = part * peak;
                let spring = 1.0 + kappa * a * a;
                let (half, whole) = (spring - 0.5 * mass.damping_per_s.powi(2), spring * spring - (push / a).powi(2));
                let squared = half - (half * half - whole).max(0.0).sqrt();
                let found = table.along(&mass, squared.sqrt(), Complex::new(0.0, 0.0)).stable(push);
                let last = found.last().copied().unwrap_or(f64::NAN);
                assert!((last / a - 1.0).abs() < 2e-3, "{widths} {part}: {found:?} for {a}");
            }
        }
    }
}
