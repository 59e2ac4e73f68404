//! Integrates slow errors that have a time of their own n times: a Gauss–Markov process, what dies
//! out exponentially, and a sine.
//!
//! With T = t/τ and p counted back from the end, n integrations weigh an error by pⁿ⁻¹/(n−1)!, and
//! what they make of e^(−t/τ) is τⁿ Aₙ(T), Aₙ(T) = Σ_{k≥n} (−1)^(k−n) Tᵏ/k!: A₀ = e^(−T),
//! A₁ = 1 − e^(−T), A₂ = T − 1 + e^(−T). A Gauss–Markov process, whose covariance is
//! σ² e^(−|Δt|/τ), has the variance 2σ² τ²ⁿ ∫₀ᵀ pⁿ⁻¹/(n−1)! Aₙ(p) dp. Source: Titterton & Weston,
//! *Strapdown Inertial Navigation Technology*, 2nd ed., §12; the integrals are done here.

use std::f64::consts::LN_2;

/// Argument below which the closed forms cancel and the series take over.
const SERIES_BELOW: f64 = 2.0 * LN_2;
/// Terms of a series: the last is below 1e-19 of the first.
const TERMS: u32 = 24;

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

fn sign(k: u32) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Aₙ(T).
fn decayed(n: u32, t: f64) -> f64 {
    if t < SERIES_BELOW {
        return (0..TERMS).map(|k| sign(k) * t.powi((n + k) as i32) / factorial(n + k)).sum();
    }
    // A_{n+1} = Tⁿ/n! − Aₙ.
    (0..n).fold((-t).exp(), |a, k| t.powi(k as i32) / factorial(k) - a)
}

/// Returns what `integrations` until `time_s` make of e^(−t/τ).
pub fn settled(tau_s: f64, integrations: u32, time_s: f64) -> f64 {
    tau_s.powi(integrations as i32) * decayed(integrations, time_s / tau_s)
}

/// Mean square of `integrations` of a Gauss–Markov process of deviation one until `time_s`.
pub fn markov(tau_s: f64, integrations: u32, time_s: f64) -> f64 {
    let (n, t) = (integrations, time_s / tau_s);
    if n == 0 {
        return 1.0;
    }
    let end = |m: u32| t.powi(m as i32);
    let integral = if t < SERIES_BELOW {
        let term = |k: u32| sign(k) * end(2 * n + k) / (factorial(n + k) * factorial(n - 1) * f64::from(2 * n + k));
        (0..TERMS).map(term).sum::<f64>()
    } else {
        // Aₙ(p) = Σ_{k<n} (−1)^(n−1−k) pᵏ/k! + (−1)ⁿ e^(−p), and ∫₀ᵀ pᵐ/m! e^(−p) dp = 1 −
        // e^(−T) Σ_{k≤m} Tᵏ/k!.
        let power = |k: u32| sign(n - 1 - k) * end(n + k) / (factorial(k) * factorial(n - 1) * f64::from(n + k));
        let left = (-t).exp() * (0..n).map(|k| end(k) / factorial(k)).sum::<f64>();
        (0..n).map(power).sum::<f64>() + sign(n) * (1.0 - left)
    };
    2.0 * tau_s.powi(2 * n as i32) * integral
}

/// The same with the mean over a still start of `still_s` before it subtracted. What comes before
/// the end of the start and after it have the covariance of two decays.
pub fn markov_after_still_start(tau_s: f64, still_s: f64, integrations: u32, time_s: f64) -> f64 {
    let taken = time_s.powi(integrations as i32) / factorial(integrations);
    let of_mean = markov(tau_s, 1, still_s) / (still_s * still_s);
    let with_mean = settled(tau_s, integrations, time_s) * settled(tau_s, 1, still_s) / still_s;
    markov(tau_s, integrations, time_s) - 2.0 * taken * with_mean + taken * taken * of_mean
}

/// Returns what `integrations` until `time_s` make of e^(−t/τ) that began with a still start of
/// `still_s`, whose mean is taken off.
pub fn settled_after_still_start(tau_s: f64, still_s: f64, integrations: u32, time_s: f64) -> f64 {
    let taken = time_s.powi(integrations as i32) / factorial(integrations);
    let mean = if still_s > 0.0 { mean_settling(tau_s, still_s) } else { 0.0 };
    (-still_s / tau_s).exp() * settled(tau_s, integrations, time_s) - taken * mean
}

/// Mean of e^(−t/τ) over the first `seconds`.
pub fn mean_settling(tau_s: f64, seconds: f64) -> f64 {
    if seconds > 0.0 { settled(tau_s, 1, seconds) / seconds } else { 1.0 }
}

/// Mean of a sine over s `seconds`, divided by its value in the middle: sin(ωs/2)/(ωs/2).
pub fn mean_turning(omega_rad_s: f64, seconds: f64) -> f64 {
    let half = 0.5 * omega_rad_s * seconds;
    if half > 0.0 { half.sin() / half } else { 1.0 }
}

/// Mean square over all phases of what `integrations` until `time_s` make of a sine of amplitude
/// one, whose mean over a still start of `still_s` before it is taken off: half the square of
/// Jₙ = ∫₀ᵗ (t−u)ⁿ⁻¹/(n−1)! e^(iωu) du less tⁿ/n! times the mean of e^(iωu).
pub fn sine(omega_rad_s: f64, still_s: f64, integrations: u32, time_s: f64) -> f64 {
    let taken = time_s.powi(integrations as i32) / factorial(integrations);
    let [re, im] = turned(omega_rad_s, integrations, time_s);
    let mean = match still_s > 0.0 {
        // From the end of the start backwards: the conjugate.
        true => turned(omega_rad_s, 1, still_s).map(|part| part / still_s),
        false => [0.0; 2],
    };
    0.5 * ((re - taken * mean[0]).powi(2) + (im + taken * mean[1]).powi(2))
}

/// Jₙ: Jₙ₊₁ = (Jₙ − tⁿ/n!)/(iω), as a series where that cancels.
fn turned(omega_rad_s: f64, n: u32, time_s: f64) -> [f64; 2] {
    let turn = omega_rad_s * time_s;
    let scale = time_s.powi(n as i32);
    if turn < SERIES_BELOW {
        // (iθ)ᵏ tⁿ/(n+k)!
        let part = |odd: u32| -> f64 {
            let term = |j: u32| sign(j) * turn.powi((2 * j + odd) as i32) / factorial(n + 2 * j + odd);
            (0..TERMS / 2).map(term).sum()
        };
        return [scale * part(0), scale * part(1)];
    }
    let (mut re, mut im) = (turn.cos(), turn.sin());
    for k in 0..n {
        let less = re - time_s.powi(k as i32) / factorial(k);
        (re, im) = (im / omega_rad_s, -less / omega_rad_s);
    }
    [re, im]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint sums over the weights pⁿ⁻¹/(n−1)!, with a still start before the run.
    fn summed(covariance: &dyn Fn(f64) -> f64, still_s: f64, n: u32, time_s: f64) -> f64 {
        let m = 1200;
        let whole = still_s + time_s;
        let point = |k: usize| (k as f64 + 0.5) * whole / m as f64;
        let weight = |p: f64| match p < time_s {
            true => p.powi(n as i32 - 1) / factorial(n - 1),
            false => -time_s.powi(n as i32) / factorial(n) / still_s,
        };
        let all: Vec<(f64, f64)> = (0..m).map(|k| (point(k), weight(point(k)))).collect();
        let row = |(p, a): &(f64, f64)| all.iter().map(|(q, b)| a * b * covariance((p - q).abs())).sum::<f64>();
        all.iter().map(row).sum::<f64>() * (whole / m as f64).powi(2)
    }

    #[test]
    fn double_sums_over_the_covariances_agree() {
        for (tau_s, still_s, time_s) in [(0.7, 0.0, 6.0), (5.0, 0.0, 6.0), (40.0, 0.0, 6.0), (5.0, 3.0, 6.0)] {
            for n in 1..=3 {
                let sum = summed(&|lag| (-lag / tau_s).exp(), still_s, n, time_s);
                let got = match still_s > 0.0 {
                    true => markov_after_still_start(tau_s, still_s, n, time_s),
                    false => markov(tau_s, n, time_s),
                };
                assert!((got / sum - 1.0).abs() < 3e-4, "τ = {tau_s}, n = {n}: {got} {sum}");
                let sum = summed(&|lag| 0.5 * (lag / tau_s).cos(), still_s, n, time_s);
                let got = sine(1.0 / tau_s, still_s, n, time_s);
                assert!((got / sum - 1.0).abs() < 3e-4, "ω = 1/{tau_s}, n = {n}: {got} {sum}");
            }
        }
        // Control: another correlation time is another variance.
        assert!((markov(5.5, 2, 6.0) / markov(5.0, 2, 6.0) - 1.0).abs() > 3e-3);
    }

    #[test]
    fn a_long_memory_is_a_constant_and_a_short_one_is_white() {
        let t = 7.0f64;
        for (n, constant, white) in
            [(1, t, t), (2, t * t / 2.0, t.powi(3) / 3.0), (3, t.powi(3) / 6.0, t.powi(5) / 20.0)]
        {
            assert!((markov(1e7, n, t).sqrt() / constant - 1.0).abs() < 1e-6);
            // N² = 2 σ² τ.
            assert!((markov(1e-5, n, t) / (2e-5 * white) - 1.0).abs() < 1e-5, "{n}");
            assert!((settled(1e7, n, t) / constant - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_settles_is_the_textbooks_and_its_series_meets_it() {
        let t = 3.0f64;
        let (a1, a2) = (1.0 - (-t).exp(), t - 1.0 + (-t).exp());
        assert!((settled(2.0, 1, 6.0) / (2.0 * a1) - 1.0).abs() < 1e-14);
        assert!((settled(2.0, 2, 6.0) / (4.0 * a2) - 1.0).abs() < 1e-14);
        let edge = SERIES_BELOW * (1.0 - 1e-12);
        for n in 0..=3 {
            assert!((decayed(n, edge) / decayed(n, SERIES_BELOW) - 1.0).abs() < 1e-11, "{n}");
        }
        // A start that lasts much longer than τ has seen it all.
        assert!(settled_after_still_start(1.0, 100.0, 2, 6.0).abs() < 0.01 * 18.1);
    }
}
