//! Allan curves and their coefficients: what is put in comes out, with intervals that cover as often as they claim.

use libtest_mimic::{Failed, Trial};
use proofmass::numerics::allan::{self, fit::Fit};
use proofmass::rng::{Philox, Stream};
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("allan: white noise, flicker and walk come back, covered as claimed", || {
            round_trip("N, B, K", [0.0, 0.1, 0.02, 0.003, 0.0])
        }),
        test("allan: quantisation, white noise and a ramp come back, covered as claimed", || {
            round_trip("Q, N, R", [0.02, 0.1, 0.0, 0.0, 2e-4])
        }),
    ]
}

const RATE_HZ: f64 = 10.0;

/// A signal of the five terms, made from their definitions (not from the fit's laws). Flicker is a sum of Gauss–Markov
/// processes three apart in correlation time: density Σ 4σ²τ/(1 + (2πfτ)²) → σ²/(f ln 3), so σ² = B² ln 3/π.
fn signal(count: usize, [q, n, b, k, r]: [f64; 5], rng: &mut impl Rng) -> Vec<f64> {
    let step_s = 1.0 / RATE_HZ;
    let mut normal = || rng.sample::<f64, _>(StandardNormal);
    let mut markov: Vec<(f64, f64, f64)> = (0..14)
        .map(|i| {
            let memory = (-step_s / (0.5 * step_s * 3f64.powi(i))).exp();
            let sigma = b * (3f64.ln() / std::f64::consts::PI).sqrt();
            (memory, sigma, sigma * normal())
        })
        .collect();
    let (mut walk, mut corner) = (0.0, q * normal());
    (0..count)
        .map(|i| {
            let before = corner;
            corner = q * normal();
            walk += k * step_s.sqrt() * normal();
            for (memory, sigma, state) in &mut markov {
                *state = *memory * *state + *sigma * (1.0 - *memory * *memory).sqrt() * normal();
            }
            let flicker: f64 = markov.iter().map(|m| m.2).sum();
            (corner - before) / step_s + n * RATE_HZ.sqrt() * normal() + flicker + walk + r * i as f64 * step_s
        })
        .collect()
}

fn round_trip(name: &str, truth: [f64; 5]) -> Result<(), Failed> {
    const REPLICAS: u64 = 160;
    let fits: Vec<Fit> = (0..REPLICAS)
        .into_par_iter()
        .filter_map(|replica| {
            let mut rng = Philox::new(11, replica, Stream::Host);
            let values = signal(32_768, truth, &mut rng);
            allan::fit::fit(&allan::curve(&values, RATE_HZ), RATE_HZ, &mut rng)
        })
        .collect();
    check(fits.len() as u64 == REPLICAS, "every replica can be fitted")?;
    let good = fits.iter().filter(|f| f.good()).count() as f64 / REPLICAS as f64;
    check(good >= 0.95, format!("{name}: only {good} of the fits are called good"))?;
    for (p, want) in truth.into_iter().enumerate() {
        let inside = |f: &&Fit| (f.coefficients[p].ci95[0]..=f.coefficients[p].ci95[1]).contains(&want);
        let covered = fits.iter().filter(inside).count() as f64 / REPLICAS as f64;
        let symbol = allan::law::TERMS[p].symbol();
        // Two and a half standard errors of a share of 95 % below it; an estimate at the wall of zero covers more often.
        check(covered >= 0.907, format!("{name}: {symbol} is covered in {covered} of the replicas"))?;
        let narrow = |f: &&Fit| {
            let c = f.coefficients[p];
            (c.value - 0.4 * (c.value - c.ci95[0])..=c.value + 0.4 * (c.ci95[1] - c.value)).contains(&want)
        };
        let narrow = fits.iter().filter(narrow).count() as f64 / REPLICAS as f64;
        check(
            want == 0.0 || narrow < 0.8,
            format!("{name}: {symbol} is covered in {narrow} even by 0.4 of the interval"),
        )?;
    }
    Ok(())
}
