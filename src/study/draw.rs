//! One member of the ensemble: tolerances drawn, mechanics derived.

use super::parameter::{Parameter, Tolerances};
use super::plan::Variation;
use crate::excitation::MemberSine;
use crate::kernel::job::Member;
use crate::sensor::{Accelerometer, Gyro, ProofMass, Sensor};

/// Draws a member; a pure function of seed and index.
pub(super) fn member(all: &Tolerances, variation: Variation, seed: u64, member: u64) -> Member {
    let draw = |parameter| all.draw(parameter, seed, member);
    let either = |a: Parameter, b: Parameter| if all[a].is_some() { draw(a) } else { draw(b) };
    use Parameter::*;
    let accelerometer = Accelerometer {
        bias_m_s2: draw(AccelerometerBias),
        scale_factor: draw(ScaleFactor),
        k2_per_m_s2: draw(K2),
        velocity_random_walk_m_s_rts: either(NoiseDensity, VelocityRandomWalk),
        bias_instability_m_s2: draw(AccelerometerBiasInstability),
        acceleration_random_walk_m_s2_rts: draw(AccelerationRandomWalk),
        quantisation_m_s2: draw(Quantisation),
        range_m_s2: if all[Range].is_some() { draw(Range) } else { f64::INFINITY },
    };
    let gyro = Gyro {
        bias_rad_s: draw(GyroBias),
        angle_random_walk_rad_rts: either(GyroNoiseDensity, AngleRandomWalk),
        bias_instability_rad_s: draw(GyroBiasInstability),
        rate_random_walk_rad_s_rts: draw(RateRandomWalk),
    };
    let excitation_gain = if variation == Variation::Gain { draw(ExcitationSize) } else { 1.0 };
    let sine = (variation == Variation::Sine).then(|| MemberSine {
        amplitude_m_s2: draw(ExcitationSize),
        frequency_hz: draw(Frequency),
        phase_rad: draw(Phase),
    });
    let sensor = Sensor { proof_mass: proof_mass(all, &draw), accelerometer, gyro, excitation_gain };
    Member { sensor, sine }
}

/// The proof mass, from its modes or from the paper's m, D₀, k, ε: ω₀² = k/m, 2ζω₀ = D₀/m, β = ε/m.
fn proof_mass(all: &Tolerances, draw: &dyn Fn(Parameter) -> f64) -> Option<ProofMass> {
    use Parameter::*;
    let (natural_frequency_rad_s, damping_ratio, cubic_per_m2_s2) = if all[Mass].is_some() {
        let (mass_kg, stiffness_n_m) = (draw(Mass), draw(Stiffness));
        let damping_ratio = draw(Damping) / (2.0 * (stiffness_n_m * mass_kg).sqrt());
        ((stiffness_n_m / mass_kg).sqrt(), damping_ratio, draw(CubicSpring) / mass_kg)
    } else if all[Resonance].is_some() {
        (draw(Resonance), draw(DampingRatio), draw(CubicStiffness))
    } else {
        return None;
    };
    Some(ProofMass {
        natural_frequency_rad_s,
        damping_ratio,
        cubic_per_m2_s2,
        quadratic_per_m_s2: draw(QuadraticStiffness),
        quadratic_damping_per_m: draw(QuadraticDamping),
        squeeze_film_per_m2_s: draw(SqueezeFilm),
        coulomb_m_s2: draw(CoulombFriction),
        force_noise_m_s_rts: draw(ForceNoise),
    })
}
