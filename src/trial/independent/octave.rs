//! States how far noise departs from white and 1/f noise, by octaves of Haar details: these are
//! orthonormal, so white noise has the same variance in every octave, and 1/f noise twice that of
//! the next finer one (Wornell, *Signal Processing with Fractals*, ch. 3: 2^γ for f^−γ).

use super::sizing::octaves;

/// Variance of the octave `n` of 1/f noise over that of the finest.
fn of_flicker(n: usize) -> f64 {
    2f64.powi(n as i32)
}

/// Twice the log-likelihood by which white noise and this process depart from white and 1/f noise.
pub(super) fn departure_from_flicker(process: &[f64]) -> f64 {
    let levels: Vec<[f64; 2]> = octaves(process).into_iter().map(|(n, level)| [n, 1.0 + level]).collect();
    let apart = |white: f64, flicker: f64| -> f64 {
        let of = |(octave, [n, level]): (usize, &[f64; 2])| {
            let ratio = level / (white + flicker * of_flicker(octave));
            n * (ratio - 1.0 - ratio.ln())
        };
        levels.iter().enumerate().map(of).sum()
    };
    let grid = |n: i32| 10f64.powf(-6.0 + 8.0 * f64::from(n) / 80.0);
    // Near half the sampling rate a sum of relaxations is whiter than 1/f: its own part of the
    // white.
    let best = (0..=80)
        .flat_map(|f| (0..=160).map(move |w| (0.7 * 10f64.powf(f64::from(w) / 80.0), f)))
        .map(|(white, f)| apart(white, grid(f)))
        .fold(f64::INFINITY, f64::min);
    // Each octave scatters by its own degrees of freedom: one unit each in the mean.
    (best - levels.len() as f64).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::independent::draw::Draw;
    use crate::independent::still::flicker;
    use crate::independent::truth::SEEN;

    const ROWS: usize = 20_000;

    fn process(alpha: f64, size: f64, case: u64) -> Vec<f64> {
        flicker(ROWS, alpha, &mut Draw::new(3, case, 0)).into_iter().map(|v| size * v).collect()
    }

    // 1/f noise of a tenth of the white noise to twice it. A quarter of what counts as seen: of a
    // dozen octaves the sum scatters by √(2·12) = 5, and relaxations, one per octave, are no exact
    // 1/f.
    #[test]
    fn flicker_does_not_depart_from_itself_and_other_exponents_do() {
        for case in 0..4 {
            for size in [0.1, 0.5, 2.0] {
                let own = departure_from_flicker(&process(1.0, size, case));
                assert!(own < 0.25 * SEEN, "{case}, 1/f of {size}: {own}");
            }
            let other = departure_from_flicker(&process(1.6, 0.5, case));
            assert!(other > SEEN, "{case}, f^-1.6: {other}");
        }
    }
}
