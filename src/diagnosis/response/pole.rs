//! A few steps as one pole: (a + bδ)/(c + δ) of the distance δ in frequency, which any response near a
//! resonance is, and a linear one exactly.

use nalgebra::{Complex, Matrix3, Vector3};

/// Rounds of weighing by the distance from the pole.
const ROUNDS: usize = 3;

/// Frequencies about a centre, in units of the farthest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    centre_hz: f64,
    width_hz: f64,
}

impl Local {
    /// About a frequency; `None` where all are at it.
    pub(super) fn about(centre_hz: f64, frequency_hz: &[f64]) -> Option<Self> {
        let width_hz = frequency_hz.iter().fold(0.0f64, |m, f| m.max((f - centre_hz).abs()));
        (width_hz > 0.0).then_some(Self { centre_hz, width_hz })
    }

    /// A frequency as a distance.
    pub(super) fn at(&self, frequency_hz: f64) -> f64 {
        (frequency_hz - self.centre_hz) / self.width_hz
    }
}

/// The function (a + bδ)/(c + δ).
#[derive(Debug, Clone, Copy)]
pub(super) struct Pole {
    above: [Complex<f64>; 2],
    /// c.
    pub from: Complex<f64>,
}

/// The pole through these points, in least squares.
pub(super) fn pole(points: &[(f64, Complex<f64>)]) -> Option<Pole> {
    let size = points.iter().fold(0.0f64, |m, (_, y)| m.max(y.norm()));
    if size == 0.0 {
        return None;
    }
    let mut weights = vec![1.0; points.len()];
    let mut found = None;
    for _ in 0..ROUNDS {
        // a + bδ − c·y = δ·y.
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for ((delta, y), w) in points.iter().zip(&weights) {
            let y = y / size;
            let row = Vector3::new(Complex::new(1.0, 0.0), Complex::new(*delta, 0.0), -y);
            normal += row.conjugate() * row.transpose() * Complex::new(*w, 0.0);
            right += row.conjugate() * (y * *delta) * Complex::new(*w, 0.0);
        }
        let solved = normal.lu().solve(&right)?;
        for ((delta, _), w) in points.iter().zip(&mut weights) {
            *w = 1.0 / (solved[2] + delta).norm_sqr().max(1e-12);
        }
        found = Some(Pole { above: [solved[0] * size, solved[1] * size], from: solved[2] });
    }
    found
}

/// Readings continued to another frequency.
pub(super) fn continued(frequency_hz: &[f64], reading: &[Complex<f64>], to_hz: f64) -> Option<Complex<f64>> {
    let local = Local::about(to_hz, frequency_hz)?;
    let points: Vec<(f64, Complex<f64>)> =
        frequency_hz.iter().map(|f| local.at(*f)).zip(reading.iter().copied()).collect();
    let Pole { above, from } = pole(&points)?;
    let value = above[0] / from;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    // A linear resonance is a pole: it is continued past its peak from one side.
    #[test]
    fn a_resonance_is_continued_from_one_side_to_the_other() {
        let of = |f: f64| Complex::new(0.3, 0.1) / Complex::new(10.0 - f, 0.2) + Complex::new(0.1, -0.2);
        let frequency: Vec<f64> = (0..5).map(|k| 9.7 + 0.05 * f64::from(k)).collect();
        let reading: Vec<Complex<f64>> = frequency.iter().map(|f| of(*f)).collect();
        let there = continued(&frequency, &reading, 10.1).expect("it is one pole");
        assert!((there - of(10.1)).norm() < 1e-6, "{there}");
        assert!((there - reading[4]).norm() > 0.1, "it goes on, and does not stay");
    }
}
