//! Every number of a study that may be drawn per member: its key, its unit, its sign, and its random-number slot.

use std::f64::consts::TAU;
use std::ops::{Index, IndexMut};

use super::number::Number;
use crate::rng::{Stream, philox4x32_10};
use crate::units::{
    DEGREE, DEGREE_PER_HOUR, DEGREE_PER_HOUR_PER_ROOT_HOUR, DEGREE_PER_ROOT_HOUR, DENSITY_TO_RANDOM_WALK, MICRO_G,
    MILLI_G, PPM, STANDARD_GRAVITY_M_S2,
};

/// A parameter. The discriminant is its slot in the tolerance stream, so that fixing one does not change another's draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
#[allow(missing_docs, reason = "the table below says what each one is")]
pub enum Parameter {
    Resonance,
    DampingRatio,
    CubicStiffness,
    QuadraticStiffness,
    QuadraticDamping,
    SqueezeFilm,
    CoulombFriction,
    ForceNoise,
    Mass,
    Damping,
    Stiffness,
    CubicSpring,
    Range,
    AccelerometerBias,
    ScaleFactor,
    K2,
    NoiseDensity,
    VelocityRandomWalk,
    AccelerometerBiasInstability,
    AccelerationRandomWalk,
    Quantisation,
    GyroBias,
    GyroNoiseDensity,
    AngleRandomWalk,
    GyroBiasInstability,
    RateRandomWalk,
    ExcitationSize,
    Frequency,
    Phase,
}

/// Which values make sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Any.
    Any,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
}

/// What is known of a parameter.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    /// Which.
    pub parameter: Parameter,
    /// Key in study.toml.
    pub key: &'static str,
    /// Name in a sensor table.
    pub name: &'static str,
    /// Datasheet unit.
    pub unit: &'static str,
    /// SI value = datasheet value × factor.
    pub factor: f64,
    /// Which values make sense.
    pub sign: Sign,
}

const fn row(
    parameter: Parameter,
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    factor: f64,
    sign: Sign,
) -> Description {
    Description { parameter, key, name, unit, factor, sign }
}

/// How many parameters there are.
pub const COUNT: usize = 29;

/// All of them, in slot order.
#[rustfmt::skip]
pub const PARAMETERS: [Description; COUNT] = {
    use Parameter::*;
    use Sign::*;
    [
        row(Resonance, "sensor.resonance_hz", "resonance", "Hz", TAU, Positive),
        row(DampingRatio, "sensor.damping_ratio", "damping ratio ζ", "1", 1.0, NotNegative),
        row(CubicStiffness, "sensor.cubic_stiffness_per_m2_s2", "cubic stiffness β", "1/(m² s²)", 1.0, Any),
        row(QuadraticStiffness, "sensor.quadratic_stiffness_per_m_s2", "quadratic stiffness α", "1/(m s²)", 1.0, Any),
        row(QuadraticDamping, "sensor.quadratic_damping_per_m", "quadratic damping c₂", "1/m", 1.0, NotNegative),
        row(SqueezeFilm, "sensor.squeeze_film_per_m2_s", "squeeze-film damping", "1/(m² s)", 1.0, NotNegative),
        row(CoulombFriction, "sensor.coulomb_friction_m_s2", "Coulomb friction", "m/s²", 1.0, NotNegative),
        row(ForceNoise, "sensor.force_noise_density_ug_rthz", "force noise density (one-sided)", "µg/√Hz", MICRO_G * DENSITY_TO_RANDOM_WALK, NotNegative),
        row(Mass, "sensor.mass_kg", "proof mass m", "kg", 1.0, Positive),
        row(Damping, "sensor.damping_n_s_m", "damping D₀", "N s/m", 1.0, NotNegative),
        row(Stiffness, "sensor.stiffness_n_m", "stiffness k", "N/m", 1.0, Positive),
        row(CubicSpring, "sensor.cubic_stiffness_n_m3", "cubic stiffness ε", "N/m³", 1.0, Any),
        row(Range, "sensor.range_g", "range", "g", STANDARD_GRAVITY_M_S2, Positive),
        row(AccelerometerBias, "accelerometer.bias_mg", "accelerometer bias", "mg", MILLI_G, Any),
        row(ScaleFactor, "accelerometer.scale_factor_ppm", "scale-factor error", "ppm", PPM, Any),
        // (µg/g²): an error of K₂ µg at 1 g, growing with the square.
        row(K2, "accelerometer.k2_ug_per_g2", "nonlinearity K₂", "µg/g²", 1e-6 / STANDARD_GRAVITY_M_S2, Any),
        row(NoiseDensity, "accelerometer.noise_density_ug_rthz", "noise density n (one-sided)", "µg/√Hz", MICRO_G * DENSITY_TO_RANDOM_WALK, NotNegative),
        row(VelocityRandomWalk, "accelerometer.velocity_random_walk_m_s_rth", "velocity random walk N", "m/s/√h", 1.0 / 60.0, NotNegative),
        row(AccelerometerBiasInstability, "accelerometer.bias_instability_ug", "bias instability B", "µg", MICRO_G, NotNegative),
        row(AccelerationRandomWalk, "accelerometer.acceleration_random_walk_ug_rts", "acceleration random walk K", "µg/√s", MICRO_G, NotNegative),
        row(Quantisation, "accelerometer.quantisation_mg", "quantisation step", "mg", MILLI_G, NotNegative),
        row(GyroBias, "gyro.bias_deg_h", "gyro bias", "°/h", DEGREE_PER_HOUR, Any),
        row(GyroNoiseDensity, "gyro.noise_density_deg_s_rthz", "gyro noise density (one-sided)", "°/s/√Hz", DEGREE * DENSITY_TO_RANDOM_WALK, NotNegative),
        row(AngleRandomWalk, "gyro.angle_random_walk_deg_rth", "angle random walk N", "°/√h", DEGREE_PER_ROOT_HOUR, NotNegative),
        row(GyroBiasInstability, "gyro.bias_instability_deg_h", "gyro bias instability B", "°/h", DEGREE_PER_HOUR, NotNegative),
        row(RateRandomWalk, "gyro.rate_random_walk_deg_h_rth", "rate random walk K", "°/h/√h", DEGREE_PER_HOUR_PER_ROOT_HOUR, NotNegative),
        row(ExcitationSize, "excitation.amplitude", "excitation amplitude", "", 1.0, Any),
        row(Frequency, "excitation.frequency_hz", "excitation frequency", "Hz", 1.0, Positive),
        row(Phase, "excitation.phase_rad", "excitation phase", "rad", 1.0, Any),
    ]
};

impl Parameter {
    /// Its row of the table.
    pub fn description(self) -> &'static Description {
        &PARAMETERS[self as usize]
    }
}

/// One number per parameter, in datasheet units as written; absent ones are switched off.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances([Option<Number>; COUNT]);

impl Default for Tolerances {
    fn default() -> Self {
        Self([None; COUNT])
    }
}

impl Index<Parameter> for Tolerances {
    type Output = Option<Number>;

    fn index(&self, parameter: Parameter) -> &Option<Number> {
        &self.0[parameter as usize]
    }
}

impl IndexMut<Parameter> for Tolerances {
    fn index_mut(&mut self, parameter: Parameter) -> &mut Option<Number> {
        &mut self.0[parameter as usize]
    }
}

impl Tolerances {
    /// The SI value of a parameter for one member; zero if it was left out.
    pub fn draw(&self, parameter: Parameter, seed: u64, member: u64) -> f64 {
        let description = parameter.description();
        let value = match self[parameter] {
            None => 0.0,
            Some(Number::Fixed(value)) => value,
            Some(number) => {
                let key = [seed as u32, (seed >> 32) as u32];
                let counter = [parameter as u32, member as u32, (member >> 32) as u32, Stream::Tolerance as u32];
                let bits = philox4x32_10(counter, key);
                let mantissa = (u64::from(bits[1]) << 32 | u64::from(bits[0])) >> 11;
                // The middle of one of 2⁵³ cells: never 0 or 1.
                let uniform = (mantissa as f64 + 0.5) / (1u64 << 53) as f64;
                number.quantile(uniform.min(1.0 - f64::EPSILON / 2.0), description.sign != Sign::Any)
            }
        };
        value * description.factor
    }

    /// Mean and variance over members, SI.
    pub fn moments(&self, parameter: Parameter) -> (f64, f64) {
        let description = parameter.description();
        let (mean, variance) = self[parameter].map_or((0.0, 0.0), |n| n.moments(description.sign != Sign::Any));
        (mean * description.factor, variance * description.factor * description.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_slot_order_and_keys_are_unique() {
        for (slot, row) in PARAMETERS.iter().enumerate() {
            assert_eq!(row.parameter as usize, slot);
            assert_eq!(PARAMETERS.iter().filter(|r| r.key == row.key).count(), 1, "{}", row.key);
        }
    }

    #[test]
    fn fixing_one_parameter_leaves_the_draws_of_another() {
        let mut both = Tolerances::default();
        both[Parameter::AccelerometerBias] = Some(Number::Normal { mean: 0.0, sd: 1.0 });
        both[Parameter::ScaleFactor] = Some(Number::Uniform { min: -5.0, max: 5.0 });
        let mut one = both.clone();
        one[Parameter::ScaleFactor] = Some(Number::Fixed(1.0));
        for member in 0..100 {
            let draw = |t: &Tolerances| t.draw(Parameter::AccelerometerBias, 7, member);
            assert_eq!(draw(&both), draw(&one));
        }
        assert_ne!(both.draw(Parameter::AccelerometerBias, 7, 0), both.draw(Parameter::AccelerometerBias, 8, 0));
    }

    #[test]
    fn draws_have_the_stated_mean_and_spread_and_are_uncorrelated() {
        let mut tolerances = Tolerances::default();
        tolerances[Parameter::AccelerometerBias] = Some(Number::Normal { mean: 2.0, sd: 1.0 });
        tolerances[Parameter::GyroBias] = Some(Number::Uniform { min: -10.0, max: 20.0 });
        let n = 40_000u64;
        let column = |p: Parameter| -> Vec<f64> {
            let (mean, variance) = tolerances.moments(p);
            (0..n).map(|m| (tolerances.draw(p, 3, m) - mean) / variance.sqrt()).collect()
        };
        let (a, b) = (column(Parameter::AccelerometerBias), column(Parameter::GyroBias));
        let mean = |v: &mut dyn Iterator<Item = f64>| v.sum::<f64>() / n as f64;
        // Five standard errors of each: 1/√n for a mean or a correlation, √(2/n) for a normal's variance.
        assert!(mean(&mut a.iter().copied()).abs() < 0.025);
        assert!(mean(&mut b.iter().copied()).abs() < 0.025);
        assert!((mean(&mut a.iter().map(|x| x * x)) - 1.0).abs() < 0.036);
        assert!((mean(&mut b.iter().map(|x| x * x)) - 1.0).abs() < 0.036);
        assert!(mean(&mut a.iter().zip(&b).map(|(x, y)| x * y)).abs() < 0.025);
    }
}
