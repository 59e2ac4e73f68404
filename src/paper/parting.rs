//! Figure 20: distance in the chaotic regime. Members that differ only in noise part exponentially;
//! a linear sensor's do not.
//!
//! The noise is a force on the proof mass, far below the drive, as its Brownian motion would be.

use super::check::{Check, Exhibit};
use proofmass_base::parallel;
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_physics::dynamics::duffing::{Drive, Oscillator, PAPER, State};
use proofmass_physics::dynamics::estimate::{Estimate, slope};

/// Force noise, two-sided coefficient, N·√s.
pub(crate) const NOISE_N_RTS: f64 = 1e-6;
/// The same for the twins, so small that they stay near for many Lyapunov times.
const TWIN_NOISE_N_RTS: f64 = 1e-10;
/// Members of each ensemble.
pub(crate) const MEMBERS: u64 = 200;
/// States how long they are followed.
pub(crate) const END_S: f64 = 240.0;
/// Runge–Kutta steps per period of the force.
const STEPS: u32 = 256;

/// One ensemble: distance error of its members at the sampled times.
#[derive(Debug, Clone)]
pub struct Spread {
    /// Sampled times, s.
    pub time_s: Vec<f64>,
    /// Distance error of each member at each time: `[member][time]`, m.
    pub distance_error_m: Vec<Vec<f64>>,
    /// Standard deviation over members, m.
    pub sd_m: Vec<f64>,
}

/// Curves and checks of figure 20.
#[derive(Debug, Clone)]
pub struct Parting {
    /// Cubic proof mass in the chaotic regime.
    pub cubic: Spread,
    /// Linear proof mass under the same force and the same noise.
    pub linear: Spread,
    /// (time, mean natural logarithm of the distance between twins in phase space) of the cubic
    /// mass.
    pub separation: Vec<(f64, f64)>,
    /// Rate at which twins part, 1/s.
    pub rate: Estimate,
    /// Figure 20 with its checks.
    pub exhibit: Exhibit,
}

/// One member's path: distance error at each sample and, for twins, its state.
struct Path {
    states: Vec<State>,
    distance_error_m: Vec<f64>,
}

/// Follows one member from a state, its own noise added to the force; samples once per `STEPS / 8`
/// steps.
fn follow(oscillator: &Oscillator, drive: &Drive, start: State, member: u64, noise_n_rts: f64) -> Path {
    let (table, h) = (drive.table_n(STEPS), drive.period_s() / f64::from(STEPS));
    let sigma_n = noise_n_rts / h.sqrt();
    let mut random = Philox::new(20, member, Stream::Force);
    let mut state = start;
    // Errors are integrated, never readings: what the sensor says beyond the true force per mass.
    let (mut speed_error, mut distance_error) = (0.0, 0.0);
    let scale = oscillator.stiffness_n_m / oscillator.mass_kg;
    let mut path = Path { states: Vec::new(), distance_error_m: Vec::new() };
    for step in 0..(END_S / h) as u32 {
        let j = (step % STEPS) as usize;
        if (step % (STEPS / 8)) == 0 {
            path.states.push(state);
            path.distance_error_m.push(distance_error);
        }
        let normal = random.normal();
        let force = [2 * j, 2 * j + 1, 2 * j + 2].map(|i| table[i] + sigma_n * normal);
        let error_before = scale * state.x_m - table[2 * j] / oscillator.mass_kg;
        state = oscillator.step(state, h, force);
        let error_after = scale * state.x_m - table[2 * j + 2] / oscillator.mass_kg;
        distance_error += h * speed_error + h * h / 6.0 * (2.0 * error_before + error_after);
        speed_error += 0.5 * h * (error_before + error_after);
    }
    path
}

/// Returns where the orbit is after many periods, at the beginning of a period.
fn settled(oscillator: &Oscillator, drive: &Drive, index: u64) -> State {
    let (table, h) = (drive.table_n(STEPS), drive.period_s() / f64::from(STEPS));
    let mut state = State { x_m: 0.05 * index as f64, v_m_s: 0.0 };
    for _ in 0..300 {
        for j in 0..STEPS as usize {
            state = oscillator.step(state, h, [table[2 * j], table[2 * j + 1], table[2 * j + 2]]);
        }
    }
    state
}

fn spread(oscillator: &Oscillator, drive: &Drive) -> Spread {
    let start = settled(oscillator, drive, 0);
    let distance_error_m: Vec<Vec<f64>> =
        parallel::map_members(0..MEMBERS, |m| follow(oscillator, drive, start, m, NOISE_N_RTS).distance_error_m);
    let samples = distance_error_m[0].len();
    let every = drive.period_s() / 8.0;
    let sd_m = (0..samples).map(|i| {
        let mean = distance_error_m.iter().map(|m| m[i]).sum::<f64>() / MEMBERS as f64;
        (distance_error_m.iter().map(|m| (m[i] - mean).powi(2)).sum::<f64>() / (MEMBERS - 1) as f64).sqrt()
    });
    Spread { time_s: (0..samples).map(|i| i as f64 * every).collect(), sd_m: sd_m.collect(), distance_error_m }
}

/// Computes the figure for the drive that figure 17 found, and the exponent found there.
pub fn compute(drive: &Drive, exponent: Estimate) -> Parting {
    let (cubic, linear) = (spread(&PAPER, drive), spread(&PAPER.linear(), drive));
    // Twins: same start, other noise, from 128 places on the attractor, so that the mean does not
    // hang on one orbit.
    let twins: Vec<Vec<f64>> = parallel::map_members(0..128, |i| {
        let start = settled(&PAPER, drive, i);
        let path = |m| follow(&PAPER, drive, start, m, TWIN_NOISE_N_RTS).states;
        let (a, b) = (path(1000 + 2 * i), path(1001 + 2 * i));
        a.iter().zip(&b).map(|(a, b)| (a.x_m - b.x_m).hypot(a.v_m_s - b.v_m_s).ln()).collect()
    });
    let mean = |i: usize| twins.iter().map(|t| t[i]).sum::<f64>() / twins.len() as f64;
    let separation: Vec<(f64, f64)> = cubic.time_s.iter().enumerate().map(|(i, t)| (*t, mean(i))).skip(1).collect();
    // Between the noise's own beginning and the size of the attractor the growth is exponential.
    // One strobe per period, because the distance breathes with the phase of the force.
    let strobes = (8..cubic.time_s.len()).step_by(8);
    let growing: Vec<usize> = strobes.filter(|i| (-20.0..-9.0).contains(&mean(*i))).collect();
    let (first, last) = (growing.first().copied().unwrap_or(1), growing.last().copied().unwrap_or(2));
    let span_s = cubic.time_s[last] - cubic.time_s[first];
    let rates: Vec<f64> = twins.iter().map(|t| (t[last] - t[first]) / span_s).collect();
    let rate = Estimate::of_mean(&rates);
    let exhibit = Exhibit::simulated(
        20,
        "The rectangle in the chaotic regime, and the effect of noise",
        checks(drive, exponent, rate, &cubic, &linear),
    );
    Parting { cubic, linear, separation, rate, exhibit }
}

fn checks(drive: &Drive, exponent: Estimate, rate: Estimate, cubic: &Spread, linear: &Spread) -> Vec<Check> {
    let end_s = *linear.time_s.last().unwrap_or(&f64::NAN);
    let law = NOISE_N_RTS / PAPER.mass_kg * end_s.powf(1.5) / 3f64.sqrt();
    let end = |s: &Spread| s.sd_m.last().copied().unwrap_or(f64::NAN);
    let late: Vec<(f64, f64)> =
        linear.time_s.iter().zip(&linear.sd_m).filter(|(t, _)| **t > 60.0).map(|(t, sd)| (t.ln(), sd.ln())).collect();
    let amplitude = drive.amplitude_n / PAPER.mass_kg;
    vec![
        Check::near(
            "rate at which pairs diverge / (1/s)",
            "the largest Lyapunov exponent of figure 17's lanes, found without noise; four joint standard errors",
            exponent.value,
            rate.value,
            4.0 * rate.standard_error.hypot(exponent.standard_error),
        ),
        Check::near(
            "linear sensor: spread of the distance at the end over its law",
            "N√(t³/3) (white force noise integrated twice; the sensor passes low frequencies unchanged); four standard \
             errors 1/√(2·200) of a standard deviation",
            1.0,
            end(linear) / law,
            0.2,
        ),
        Check::near(
            "linear sensor: exponent of the spread's growth in time",
            "1.5, the same law; the curve wanders by about 0.25 over four fold in time in 200 members",
            1.5,
            slope(&late).value,
            0.3,
        ),
        Check::between(
            "spread at the end, chaotic over linear, log₁₀",
            "by then twins are lost on the attractor: at least the true motion's own amplitude F₀/(mω²), at most that of \
             a reading wrong by F₀/m throughout, ½F₀t²/m",
            (amplitude / drive.omega_rad_s.powi(2) / law).log10(),
            (0.5 * amplitude * end_s * end_s / law).log10(),
            (end(cubic) / end(linear)).log10(),
        ),
    ]
}
