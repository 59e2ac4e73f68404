//! Bifurcation diagrams: strobed displacement against forcing amplitude, following the attractor up
//! and down.
//!
//! A sweep carries the state from one amplitude to the next, so that where two attractors coexist
//! the way up and the way down differ (hysteresis). That makes it sequential; for independent
//! starts see `map`.

use super::duffing::{Drive, Oscillator, State};
use crate::control::{Control, Stopped};
use crate::rng::{Philox, Stream};

/// Amplitudes of one sweep and what is recorded at each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// First amplitude, N.
    pub from_n: f64,
    /// Last amplitude, N; below `from_n` for a sweep down.
    pub to_n: f64,
    /// Number of amplitudes.
    pub points: u32,
    /// Angular frequency of the force.
    pub omega_rad_s: f64,
    /// Periods after each change of amplitude before strobing.
    pub transient_periods: u32,
    /// Strobes kept per amplitude.
    pub strobes: u32,
    /// White force noise, two-sided coefficient, N·√s.
    pub noise_n_rts: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// (amplitude, strobed displacement) pairs in the order of the sweep, N and m.
///
/// # Errors
/// Stopped.
pub fn sweep(oscillator: &Oscillator, sweep: &Sweep, control: &Control) -> Result<Vec<(f64, f64)>, Stopped> {
    let mut random = Philox::new(sweep.seed, 0, Stream::Force);
    let mut state = State::default();
    let mut cloud = Vec::with_capacity(sweep.points as usize * sweep.strobes as usize);
    let steps = oscillator.steps_per_period(sweep.from_n.abs().max(sweep.to_n.abs()), sweep.omega_rad_s);
    for point in 0..sweep.points {
        let fraction = f64::from(point) / f64::from((sweep.points - 1).max(1));
        let amplitude_n = sweep.from_n + fraction * (sweep.to_n - sweep.from_n);
        let drive = Drive { amplitude_n, omega_rad_s: sweep.omega_rad_s };
        let (table, h) = (drive.table_n(steps), drive.period_s() / f64::from(steps));
        let sigma_n = sweep.noise_n_rts / h.sqrt();
        for period in 0..sweep.transient_periods + sweep.strobes {
            control.go_on()?;
            for j in 0..steps as usize {
                let noise_n = if sigma_n > 0.0 { sigma_n * random.normal() } else { 0.0 };
                let force_n = [table[2 * j] + noise_n, table[2 * j + 1] + noise_n, table[2 * j + 2] + noise_n];
                state = oscillator.step(state, h, force_n);
            }
            if period >= sweep.transient_periods {
                cloud.push((amplitude_n, state.x_m));
            }
        }
    }
    Ok(cloud)
}
