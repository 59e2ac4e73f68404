//! Draws proof masses, excitations and shapes, and sets an effect's amplitude so that its visible
//! size is the one asked.

use rand::{Rng, RngExt};

use super::driven::{Driven, Planted, Scene};
use super::equation::Oscillator;
use super::excitation::{Excitation, Lines};
use super::physics::{Physics, Term};

/// Excitation of a driven case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// Multisine, random or sweep around the resonance, steady or growing.
    Any,
    /// A narrow band at the resonance, one amplitude: where base parameters absorb most.
    Narrow,
    /// None: a free ring-down of a lightly damped mass.
    RingDown,
}

pub(super) fn uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

pub(super) fn log_uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    (uniform(rng, low.ln(), high.ln())).exp()
}

pub(super) fn sign(rng: &mut impl Rng) -> f64 {
    if rng.random::<bool>() { 1.0 } else { -1.0 }
}

fn excitation(rng: &mut impl Rng, drive: Drive, rate_hz: f64, f0: f64, zeta: f64, samples: usize) -> Excitation {
    let duration_s = samples as f64 / rate_hz;
    let rms = log_uniform(rng, 0.01, 10.0);
    let seed = rng.random::<u64>();
    if drive == Drive::RingDown {
        return Excitation::None;
    }
    if drive == Drive::Narrow {
        let width = uniform(rng, 0.5, 1.0) * (2.0 * zeta).clamp(0.06, 0.5);
        let (from_hz, to_hz) = (f0 * (1.0 - width), f0 * (1.0 + width).min(0.4 * rate_hz / f0));
        return Excitation::Multisine(Lines { rms, from_hz, to_hz, count: 12, envelope_start: 1.0, duration_s, seed });
    }
    let from_hz = f0 * uniform(rng, 0.1, 0.5);
    let to_hz = (f0 * uniform(rng, 1.6, 3.0)).min(0.4 * rate_hz);
    let envelope_start = if rng.random::<f64>() < 0.7 { 1.0 } else { uniform(rng, 0.1, 0.6) };
    let count = rng.random_range(40..=80);
    match rng.random_range(0..5) {
        0..=1 => Excitation::Multisine(Lines { rms, from_hz, to_hz, count, envelope_start, duration_s, seed }),
        2..=3 => Excitation::Random(Lines { rms, from_hz, to_hz, count, envelope_start, duration_s, seed }),
        _ => Excitation::Sweep { amplitude: rms * std::f64::consts::SQRT_2, from_hz, to_hz, duration_s },
    }
}

/// A proof mass with its excitation and noise (`noise` relative to the rms output) and nothing
/// planted.
pub(crate) fn bare(rng: &mut impl Rng, drive: Drive, samples: usize, noise: f64) -> Driven {
    let rate_hz = log_uniform(rng, 50.0, 5000.0);
    let f0 = rate_hz * log_uniform(rng, 0.02, 0.12);
    let zeta = if drive == Drive::RingDown { log_uniform(rng, 5e-4, 4e-3) } else { log_uniform(rng, 0.02, 0.7) };
    let omega = std::f64::consts::TAU * f0;
    let excitation = excitation(rng, drive, rate_hz, f0, zeta, samples);
    let gain = omega * omega * log_uniform(rng, 0.1, 10.0);
    let hint = |rng: &mut _| log_uniform(rng, 0.55, 1.8);
    let hints = (rng.random::<f64>() < 0.5).then(|| [f0 * hint(rng), zeta * hint(rng)]);
    let start = [if drive == Drive::RingDown { log_uniform(rng, 0.01, 1.0) } else { 0.0 }, 0.0];
    let oscillator = Oscillator { omega_rad_s: omega, zeta, gain, start };
    let mut case = Driven::linear(oscillator, excitation, rate_hz, samples, rng.random());
    case.hints = hints;
    case.offset = case.scales.x * uniform(rng, -1.0, 1.0);
    case.noise = case.scales.x * noise;
    case
}

/// A shape for an effect, drawn at random.
pub fn shape(rng: &mut impl Rng, physics: Physics, case: &Driven) -> [f64; 2] {
    use Physics::*;
    match physics {
        // Springs harden more often than they soften.
        CubicStiffness => [if rng.random::<f64>() < 0.75 { 1.0 } else { -1.0 }, 0.0],
        QuadraticStiffness | DriveNonlinearity | Feedthrough | BiasDrift => [sign(rng), 0.0],
        // Half of them with β = γ, the usual choice; the rest anywhere up to γ = 0.
        Hysteresis => {
            let ratio = if rng.random::<bool>() { 0.5 } else { uniform(rng, 0.5, 1.0) };
            [uniform(rng, 0.3, 1.0), ratio]
        }
        StiffnessDrift => [sign(rng), if rng.random::<f64>() < 0.3 { 1.0 } else { 0.0 }],
        ParasiticMode => {
            let highest = (0.4 * std::f64::consts::TAU * case.rate_hz / case.omega_rad_s).min(3.0);
            [sign(rng) * uniform(rng, 1.4, highest), log_uniform(rng, 0.01, 0.1)]
        }
        CoupledMode => [log_uniform(rng, 0.6, 1.7), log_uniform(rng, 0.01, 0.1)],
        EndStop => [log_uniform(rng, 10.0, 50.0), f64::from(rng.random_range(-1..=1))],
        ReadoutSaturation => [0.0, f64::from(rng.random_range(-1..=1))],
        ReadoutNonlinearity => match rng.random_range(0..3) {
            0 => [sign(rng), 0.0],
            1 => [0.0, sign(rng)],
            _ => [sign(rng), sign(rng) * uniform(rng, 0.3, 1.0)],
        },
        WarmUp => [log_uniform(rng, 0.03, 0.4), sign(rng)],
        PeriodicDisturbance => [case.rate_hz * uniform(rng, 0.01, 0.45), uniform(rng, 0.0, std::f64::consts::TAU)],
        FractionalDamper => [uniform(rng, 0.3, 0.7), 0.0],
        SlippingMount => [uniform(rng, 0.8, 1.5), 0.0],
        NegativeDamping => [uniform(rng, 0.15, 0.5), 0.0],
        BacklashSpring => [uniform(rng, 0.1, 0.4), 0.0],
        ParametricPumping => [uniform(rng, 0.3, 2.2), uniform(rng, 0.0, std::f64::consts::TAU)],
        StiffnessJump => [uniform(rng, 0.25, 0.75), sign(rng)],
        GainControl => [uniform(rng, 0.01, 0.1), 0.0],
        ClockWander => [uniform(rng, 1.5, 6.0), 0.0],
        DampingDrift => [sign(rng), 0.0],
        _ => [0.0, 0.0],
    }
}

/// Measure by which the size of an effect is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// After the best refit of the base, relative to the rms output.
    Visible(f64),
    /// Size before any refit.
    Raw(f64),
}

/// Adds an effect of the size asked; false when no amplitude makes it that large.
pub fn plant(case: &mut Driven, physics: Physics, shape: [f64; 2], size: Size) -> bool {
    let (Size::Visible(asked) | Size::Raw(asked)) = size;
    let mut alone = case.clone();
    let mut term = Term { physics, amplitude: 0.05, shape };
    alone.planted = vec![Planted { term, visible: 0.0, raw: 0.0 }];
    let scene = Scene::coarse(&alone);
    let undisturbed = scene.output(&[], 0.0);
    let (mut low, mut high) = (0.0f64, f64::INFINITY);
    let mut best: Option<(f64, Planted)> = None;
    for _ in 0..14 {
        let [visible, raw] = scene.size_of(term, &undisturbed);
        let reached = if matches!(size, Size::Raw(_)) { raw } else { visible };
        let miss = (reached / asked).ln();
        if miss.is_finite() && best.is_none_or(|(m, _)| miss.abs() < m) {
            best = Some((miss.abs(), Planted { term, visible, raw }));
        }
        if miss.abs() < 0.04 {
            break;
        }
        if reached > asked {
            high = high.min(term.amplitude)
        } else {
            low = low.max(term.amplitude)
        }
        // Sizes grow about as the amplitude: a Newton step in logarithms, held inside what is
        // known.
        let aim = term.amplitude / (reached / asked).clamp(0.05, 20.0);
        let inside = aim > low * 1.001 && aim < high * 0.999;
        term.amplitude = if inside || low == 0.0 || high.is_infinite() { aim } else { (low * high).sqrt() };
        if !(1e-9..1e4).contains(&term.amplitude) {
            break;
        }
    }
    match best {
        Some((miss, planted)) if miss < 0.25 => {
            case.planted.push(planted);
            true
        }
        _ => false,
    }
}

/// Takes the loud part away: the same physics, driven at `ratio` times the amplitude, with noise
/// relative to the new output.
pub(super) fn quieten(case: &mut Driven, ratio: f64, noise: f64) {
    case.excitation.scale(ratio);
    case.output_rms = case.measure_scales().x;
    case.noise = noise * case.output_rms;
    remeasure(case);
}

/// A stop that only the `contacts` highest swings of the undisturbed motion reach; `stiffness`
/// relative to ω₀².
pub(super) fn plant_rare_stop(case: &mut Driven, contacts: usize, stiffness: f64) {
    let undisturbed = Scene::coarse(case).output(&[], 0.0);
    let motion: Vec<f64> = undisturbed.iter().map(|y| (y - case.offset).abs()).collect();
    let mut swings: Vec<f64> = motion.windows(3).filter(|w| w[1] >= w[0] && w[1] > w[2]).map(|w| w[1]).collect();
    swings.sort_unstable_by(f64::total_cmp);
    swings.reverse();
    let gap = swings.get(contacts).or(swings.last()).copied().unwrap_or(case.scales.peak).min(0.98 * case.scales.peak);
    let term = Term { physics: Physics::EndStop, amplitude: case.scales.peak / gap - 1.0, shape: [stiffness, 0.0] };
    case.planted.push(Planted { term, visible: 0.0, raw: 0.0 });
    remeasure(case);
}

/// Measures every planted effect anew, each alone.
fn remeasure(case: &mut Driven) {
    let before = case.clone();
    let scene = Scene::coarse(&before);
    let undisturbed = scene.output(&[], 0.0);
    for planted in &mut case.planted {
        [planted.visible, planted.raw] = scene.size_of(planted.term, &undisturbed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_numerics::rng::{Philox, Stream};

    #[test]
    fn every_effect_reaches_the_size_asked() {
        for (n, &physics) in Physics::LIBRARY.iter().chain(Physics::FOREIGN).chain(Physics::ALIKE).enumerate() {
            let mut rng = Philox::new(11, n as u64, Stream::Host);
            let reached = (0..6).any(|_| {
                let mut case = bare(&mut rng, Drive::Any, 1500, 0.002);
                let shape = shape(&mut rng, physics, &case);
                plant(&mut case, physics, shape, Size::Visible(0.03))
                    && (case.planted[0].visible / 0.03 - 1.0).abs() < 0.3
                    && case.render().reading.iter().all(|y| y.is_finite())
            });
            assert!(reached, "{physics:?}");
        }
    }
}
