//! The table of sensor terms: every error of an accelerometer's and a gyro's reading, one row each.
//!
//! # Adding a term
//! 1. A row below: the field of the sensor with its SI unit, the term's name, its law, and its keys
//!    in study.toml, each with a slot that no other key has.
//! 2. If it draws random numbers: a variant of `rng::Stream`.
//! 3. If it is more than a strength, a row for each number of its shape, next to it.
//! 4. If its law is new: a variant of [`ErrorLaw`] and how it is added to a reading, in
//!    `kernel::cpu::reading`.
//!
//! From the row follow the field and its default, reading, checking and drawing the keys, the
//! kernels' columns, states and switches on both backends, the error budget, the closed form, the
//! sensor table and the repaired sensor.

use std::f64::consts::TAU;

use super::coupling::{ACCELEROMETER_BIAS_PER_K, ACCELEROMETER_SCALE_PER_K, G_SENSITIVITY, GYRO_BIAS_PER_K};
use super::error_law::{ErrorLaw, Shape};
use super::sense::Sense;
use crate::rng::Stream;
use crate::units::key::Key;
use crate::units::key::Sign::{Any, NotNegative, Positive};
use crate::units::{
    DEGREE, DEGREE_PER_HOUR, DEGREE_PER_HOUR_PER_ROOT_HOUR, DEGREE_PER_ROOT_HOUR, DENSITY_TO_RANDOM_WALK, MICRO_G,
    MILLI_G, PPM, STANDARD_GRAVITY_M_S2,
};

/// Row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Name in tables and figures.
    pub name: &'static str,
    /// The law it follows.
    pub law: ErrorLaw,
    /// Keys of study.toml, at most one of which is given; several are names of one number. The
    /// first is the one that the tool writes.
    pub keys: &'static [Key],
}

macro_rules! sensor_terms {
    ($($(#[doc = $about:literal])+ $section:ident: $instrument:ident {
        $($(#[doc = $doc:literal])+ $field:ident: $term:ident = $row:expr;)+
    })+) => {
        /// One error of a reading.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum SensorTerm {
            $($($(#[doc = $doc])+ $term,)+)+
        }

        $(
            $(#[doc = $about])+
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub struct $instrument {
                $($(#[doc = $doc])+ pub $field: f64,)+
            }

            /// Without any error.
            impl Default for $instrument {
                fn default() -> Self {
                    Self { $($field: SensorTerm::$term.law().neutral(),)+ }
                }
            }
        )+

        const ROWS: &[Row] = &[$($($row,)+)+];

        impl SensorTerm {
            /// All of them, accelerometer first.
            pub const ALL: [Self; ROWS.len()] = [$($(Self::$term,)+)+];

            /// Sensor that the error belongs to.
            pub const fn sense(self) -> Sense {
                match self {
                    $($(Self::$term)|+ => Sense::$instrument,)+
                }
            }

            /// Its coefficient in SI units.
            pub fn of(self, $($section: &$instrument),+) -> f64 {
                match self {
                    $($(Self::$term => $section.$field,)+)+
                }
            }

            /// The coefficients of all of them, in their order.
            pub fn all_of($($section: &$instrument),+) -> [f64; ROWS.len()] {
                [$($($section.$field,)+)+]
            }

            /// Gives it a coefficient in SI units.
            pub fn set(self, $($section: &mut $instrument,)+ coefficient: f64) {
                match self {
                    $($(Self::$term => $section.$field = coefficient,)+)+
                }
            }
        }
    };
}

impl SensorTerm {
    /// Number of them.
    pub const COUNT: usize = ROWS.len();

    /// Its row of the table.
    pub const fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// The law it follows.
    pub const fn law(self) -> ErrorLaw {
        self.row().law
    }

    /// Returns whether it is no error but a number of the term before it.
    pub const fn is_shape(self) -> bool {
        matches!(self.law(), ErrorLaw::Shape(_))
    }

    /// The numbers that stand behind it in the table as its shape.
    pub fn shapes(self) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().skip(self as usize + 1).take_while(|term| term.is_shape())
    }

    /// Returns the number of earlier terms that follow a law of the same kind: its place among
    /// their states.
    pub const fn rank(self) -> usize {
        RANKS[self as usize]
    }

    /// The power of time by which it makes position drift, where it is one power.
    pub fn position_exponent(self) -> Option<f64> {
        let through_tilt = if self.sense() == Sense::Gyro { 1.0 } else { 0.0 };
        self.law().position_exponent().map(|p| p + through_tilt)
    }
}

/// The rank of each term; a table, because kernels ask at every stretch of samples.
const RANKS: [usize; SensorTerm::COUNT] = {
    let mut all = [0; SensorTerm::COUNT];
    let mut row = 0;
    while row < all.len() {
        all[row] = alike(ROWS[row].law, row);
        row += 1;
    }
    all
};

/// Returns the number of terms that follow a law of this kind, among the first `rows` of the table.
pub const fn alike(law: ErrorLaw, rows: usize) -> usize {
    let (mut count, mut row) = (0, 0);
    while row < rows {
        if ROWS[row].law.kind() == law.kind() {
            count += 1;
        }
        row += 1;
    }
    count
}

#[rustfmt::skip]
sensor_terms! {
    /// The accelerometer's reading errors.
    accelerometer: Accelerometer {
        /// Constant bias, m/s².
        bias_m_s2: AccelerometerBias = Row {
            name: "accelerometer bias",
            law: ErrorLaw::Constant,
            keys: &[
                Key::new(13, "accelerometer.bias_mg", "accelerometer bias", "mg", MILLI_G, Any),
                Key::new(44, "accelerometer.bias_m_s2", "accelerometer bias", "m/s²", 1.0, Any),
            ],
        };
        /// Misalignment out of the horizontal plane, m/s²: the gravity that it lets in.
        misalignment_m_s2: AccelerometerMisalignment = Row {
            name: "accelerometer misalignment",
            law: ErrorLaw::Offset,
            keys: &[Key::new(43, "accelerometer.misalignment_mrad", "accelerometer misalignment", "mrad", 1e-3 * STANDARD_GRAVITY_M_S2, Any)],
        };
        /// Initial tilt, m/s²: the gravity that it lets in.
        initial_tilt_m_s2: InitialTilt = Row {
            name: "initial tilt",
            law: ErrorLaw::Offset,
            keys: &[Key::new(45, "alignment.tilt_deg", "initial tilt", "°", DEGREE * STANDARD_GRAVITY_M_S2, Any)],
        };
        /// Scale-factor error, 1.
        scale_factor: ScaleFactor = Row {
            name: "scale factor",
            law: ErrorLaw::Proportional(1),
            keys: &[Key::new(14, "accelerometer.scale_factor_ppm", "scale-factor error", "ppm", PPM, Any)],
        };
        /// Second-order nonlinearity K₂, 1/(m/s²).
        k2_per_m_s2: Nonlinearity = Row {
            name: "nonlinearity K₂",
            law: ErrorLaw::Proportional(2),
            // (µg/g²): an error of K₂ µg at 1 g, growing with the square.
            keys: &[Key::new(15, "accelerometer.k2_ug_per_g2", "nonlinearity K₂", "µg/g²", 1e-6 / STANDARD_GRAVITY_M_S2, Any)],
        };
        /// Third-order nonlinearity K₃, 1/(m/s²)².
        k3_per_m2_s4: CubicNonlinearity = Row {
            name: "nonlinearity K₃",
            law: ErrorLaw::Proportional(3),
            keys: &[Key::new(71, "accelerometer.k3_ug_per_g3", "nonlinearity K₃", "µg/g³", 1e-6 / (STANDARD_GRAVITY_M_S2 * STANDARD_GRAVITY_M_S2), Any)],
        };
        /// Part of the specific force that reaches the reading past the proof mass, 1.
        feedthrough: Feedthrough = Row {
            name: "feedthrough",
            law: ErrorLaw::Force(1),
            keys: &[Key::new(72, "accelerometer.feedthrough_ppm", "feedthrough past the proof mass", "ppm", PPM, Any)],
        };
        /// Velocity random walk N, m/s/√s.
        velocity_random_walk_m_s_rts: VelocityRandomWalk = Row {
            name: "velocity random walk",
            law: ErrorLaw::White(Stream::AccelerometerWhite),
            keys: &[
                Key::new(16, "accelerometer.noise_density_ug_rthz", "noise density n (one-sided)", "µg/√Hz", MICRO_G * DENSITY_TO_RANDOM_WALK, NotNegative).one_sided(),
                Key::new(17, "accelerometer.velocity_random_walk_m_s_rth", "velocity random walk N", "m/s/√h", 1.0 / 60.0, NotNegative),
            ],
        };
        /// Bias instability B (minimum Allan deviation / 0.664), m/s².
        bias_instability_m_s2: AccelerometerBiasInstability = Row {
            name: "accelerometer bias instability",
            law: ErrorLaw::Flicker(Stream::AccelerometerFlicker),
            keys: &[Key::new(18, "accelerometer.bias_instability_ug", "bias instability B", "µg", MICRO_G, NotNegative)],
        };
        /// Acceleration random walk K, m/s²/√s.
        acceleration_random_walk_m_s2_rts: AccelerationRandomWalk = Row {
            name: "acceleration random walk",
            law: ErrorLaw::Walk(Stream::AccelerometerWhite),
            keys: &[Key::new(19, "accelerometer.acceleration_random_walk_ug_rts", "acceleration random walk K", "µg/√s", MICRO_G, NotNegative)],
        };
        /// Acceleration ramp R, m/s³.
        ramp_m_s3: AccelerationRamp = Row {
            name: "acceleration ramp",
            law: ErrorLaw::Ramp,
            keys: &[Key::new(29, "accelerometer.acceleration_ramp_mg_h", "acceleration ramp R", "mg/h", MILLI_G / 3600.0, Any)],
        };
        /// Change of the bias per kelvin, m/s²/K.
        bias_m_s2_per_k: AccelerometerBiasPerKelvin = Row { name: "accelerometer bias over temperature", law: ErrorLaw::Warm(0), keys: &[ACCELEROMETER_BIAS_PER_K] };
        /// The same with the square of the kelvins, m/s²/K².
        bias_m_s2_per_k2: AccelerometerBiasPerKelvinSquared = Row { name: "accelerometer bias over temperature squared", law: ErrorLaw::WarmPower(2), keys: &[Key::new(88, "accelerometer.bias_temperature_ug_k2", "accelerometer bias over temperature squared", "µg/K²", MICRO_G, Any)] };
        /// The same with their cube, m/s²/K³.
        bias_m_s2_per_k3: AccelerometerBiasPerKelvinCubed = Row { name: "accelerometer bias over temperature cubed", law: ErrorLaw::WarmPower(3), keys: &[Key::new(89, "accelerometer.bias_temperature_ug_k3", "accelerometer bias over temperature cubed", "µg/K³", MICRO_G, Any)] };
        /// Change of the scale factor per kelvin, 1/K.
        scale_factor_per_k: ScaleFactorPerKelvin = Row { name: "scale factor over temperature", law: ErrorLaw::Warm(1), keys: &[ACCELEROMETER_SCALE_PER_K] };
        /// Standard deviation σ of a Gauss–Markov process, m/s².
        markov_m_s2: AccelerometerMarkov = Row {
            name: "accelerometer Gauss–Markov bias",
            law: ErrorLaw::Markov(Stream::AccelerometerMarkov),
            keys: &[Key::new(54, "accelerometer.gauss_markov_ug", "Gauss–Markov bias σ", "µg", MICRO_G, NotNegative)],
        };
        /// Its correlation time, s.
        markov_time_s: AccelerometerMarkovTime = Row {
            name: "accelerometer Gauss–Markov correlation time",
            law: ErrorLaw::Shape(Shape::Memory),
            keys: &[Key::new(55, "accelerometer.gauss_markov_time_s", "correlation time of the Gauss–Markov bias", "s", 1.0, Positive)],
        };
        /// Error at switch-on that dies out, m/s².
        warm_up_m_s2: AccelerometerWarmUp = Row {
            name: "accelerometer warm-up",
            law: ErrorLaw::Settling,
            keys: &[Key::new(56, "accelerometer.warm_up_mg", "warm-up", "mg", MILLI_G, Any)],
        };
        /// Its time constant, s.
        warm_up_time_s: AccelerometerWarmUpTime = Row {
            name: "accelerometer warm-up time constant",
            law: ErrorLaw::Shape(Shape::Settling),
            keys: &[Key::new(57, "accelerometer.warm_up_time_s", "time constant of the warm-up", "s", 1.0, Positive)],
        };
        /// Amplitude of a sine that is picked up, m/s².
        sinusoid_m_s2: AccelerometerSinusoid = Row {
            name: "accelerometer sinusoid",
            law: ErrorLaw::Sine,
            keys: &[Key::new(58, "accelerometer.sinusoid_mg", "sinusoid", "mg", MILLI_G, NotNegative)],
        };
        /// Its frequency, rad/s.
        sinusoid_frequency_rad_s: AccelerometerSinusoidFrequency = Row {
            name: "accelerometer sinusoid frequency",
            law: ErrorLaw::Shape(Shape::Frequency),
            keys: &[Key::new(59, "accelerometer.sinusoid_hz", "frequency of the sinusoid", "Hz", TAU, Positive)],
        };
        /// Its phase at the beginning of the run, rad.
        sinusoid_phase_rad: AccelerometerSinusoidPhase = Row {
            name: "accelerometer sinusoid phase",
            law: ErrorLaw::Shape(Shape::Phase),
            keys: &[Key::new(60, "accelerometer.sinusoid_phase_deg", "phase of the sinusoid", "°", DEGREE, Any)],
        };
        /// Quantisation step of the reading, m/s².
        quantisation_m_s2: Quantisation = Row {
            name: "quantisation",
            law: ErrorLaw::Rounding,
            keys: &[Key::new(20, "accelerometer.quantisation_mg", "quantisation step", "mg", MILLI_G, NotNegative)],
        };
        /// Full scale, m/s²; infinity for none.
        range_m_s2: Range = Row {
            name: "range limit",
            law: ErrorLaw::FullScale,
            keys: &[Key::new(12, "sensor.range_g", "range", "g", STANDARD_GRAVITY_M_S2, Positive)],
        };
        /// Time constant of a first-order low-pass behind the proof mass, s.
        readout_lowpass_s: ReadoutLowPass = Row {
            name: "readout low-pass",
            law: ErrorLaw::LowPass,
            keys: &[Key::new(68, "sensor.readout_lowpass_s", "time constant of the readout's low-pass", "s", 1.0, NotNegative)],
        };
        /// Delay of the reading of the proof mass, s.
        readout_delay_s: ReadoutDelay = Row {
            name: "readout delay",
            law: ErrorLaw::Delay,
            keys: &[Key::new(69, "sensor.readout_delay_s", "delay of the readout", "s", 1.0, NotNegative)],
        };
    }
    /// The gyro's errors; its integral is tilt, which through gravity becomes a horizontal
    /// acceleration error.
    gyro: Gyro {
        /// Constant bias, rad/s.
        bias_rad_s: GyroBias = Row {
            name: "gyro bias",
            law: ErrorLaw::Constant,
            keys: &[Key::new(21, "gyro.bias_deg_h", "gyro bias", "°/h", DEGREE_PER_HOUR, Any)],
        };
        /// Sensitivity to the specific force along the accelerometer's axis, rad/s per m/s².
        g_sensitivity_rad_s_per_m_s2: GSensitivity = Row {
            name: "gyro g-sensitivity",
            law: ErrorLaw::Force(1),
            keys: &[G_SENSITIVITY],
        };
        /// Sensitivity to the square of the specific force along its axis, rad/s per (m/s²)²:
        /// rectified vibration.
        g2_sensitivity_rad_s_per_m2_s4: G2Sensitivity = Row {
            name: "gyro g²-sensitivity",
            law: ErrorLaw::Force(2),
            keys: &[Key::new(46, "gyro.g2_sensitivity_deg_h_g2", "g²-sensitivity", "°/h/g²", DEGREE_PER_HOUR / (STANDARD_GRAVITY_M_S2 * STANDARD_GRAVITY_M_S2), Any)],
        };
        /// Angle random walk N, rad/√s.
        angle_random_walk_rad_rts: AngleRandomWalk = Row {
            name: "angle random walk",
            law: ErrorLaw::White(Stream::GyroWhite),
            keys: &[
                Key::new(23, "gyro.angle_random_walk_deg_rth", "angle random walk N", "°/√h", DEGREE_PER_ROOT_HOUR, NotNegative),
                Key::new(22, "gyro.noise_density_deg_s_rthz", "gyro noise density (one-sided)", "°/s/√Hz", DEGREE * DENSITY_TO_RANDOM_WALK, NotNegative).one_sided(),
            ],
        };
        /// Bias instability B, rad/s.
        bias_instability_rad_s: GyroBiasInstability = Row {
            name: "gyro bias instability",
            law: ErrorLaw::Flicker(Stream::GyroFlicker),
            keys: &[Key::new(24, "gyro.bias_instability_deg_h", "gyro bias instability B", "°/h", DEGREE_PER_HOUR, NotNegative)],
        };
        /// Rate random walk K, rad/s/√s.
        rate_random_walk_rad_s_rts: RateRandomWalk = Row {
            name: "rate random walk",
            law: ErrorLaw::Walk(Stream::GyroWhite),
            keys: &[Key::new(25, "gyro.rate_random_walk_deg_h_rth", "rate random walk K", "°/h/√h", DEGREE_PER_HOUR_PER_ROOT_HOUR, NotNegative)],
        };
        /// Change of the bias per kelvin, rad/s/K.
        bias_rad_s_per_k: GyroBiasPerKelvin = Row { name: "gyro bias over temperature", law: ErrorLaw::Warm(0), keys: &[GYRO_BIAS_PER_K] };
        /// The same with the square of the kelvins, rad/s/K².
        bias_rad_s_per_k2: GyroBiasPerKelvinSquared = Row { name: "gyro bias over temperature squared", law: ErrorLaw::WarmPower(2), keys: &[Key::new(90, "gyro.bias_temperature_deg_h_k2", "gyro bias over temperature squared", "°/h/K²", DEGREE_PER_HOUR, Any)] };
        /// The same with their cube, rad/s/K³.
        bias_rad_s_per_k3: GyroBiasPerKelvinCubed = Row { name: "gyro bias over temperature cubed", law: ErrorLaw::WarmPower(3), keys: &[Key::new(91, "gyro.bias_temperature_deg_h_k3", "gyro bias over temperature cubed", "°/h/K³", DEGREE_PER_HOUR, Any)] };
        /// Standard deviation σ of a Gauss–Markov process, rad/s.
        markov_rad_s: GyroMarkov = Row {
            name: "gyro Gauss–Markov bias",
            law: ErrorLaw::Markov(Stream::GyroMarkov),
            keys: &[Key::new(61, "gyro.gauss_markov_deg_h", "Gauss–Markov bias σ", "°/h", DEGREE_PER_HOUR, NotNegative)],
        };
        /// Its correlation time, s.
        markov_time_s: GyroMarkovTime = Row {
            name: "gyro Gauss–Markov correlation time",
            law: ErrorLaw::Shape(Shape::Memory),
            keys: &[Key::new(62, "gyro.gauss_markov_time_s", "correlation time of the Gauss–Markov bias", "s", 1.0, Positive)],
        };
        /// Error at switch-on that dies out, rad/s.
        warm_up_rad_s: GyroWarmUp = Row {
            name: "gyro warm-up",
            law: ErrorLaw::Settling,
            keys: &[Key::new(63, "gyro.warm_up_deg_h", "warm-up", "°/h", DEGREE_PER_HOUR, Any)],
        };
        /// Its time constant, s.
        warm_up_time_s: GyroWarmUpTime = Row {
            name: "gyro warm-up time constant",
            law: ErrorLaw::Shape(Shape::Settling),
            keys: &[Key::new(64, "gyro.warm_up_time_s", "time constant of the warm-up", "s", 1.0, Positive)],
        };
        /// Amplitude of a sine that is picked up, rad/s.
        sinusoid_rate_rad_s: GyroSinusoid = Row {
            name: "gyro sinusoid",
            law: ErrorLaw::Sine,
            keys: &[Key::new(65, "gyro.sinusoid_deg_h", "sinusoid", "°/h", DEGREE_PER_HOUR, NotNegative)],
        };
        /// Its frequency, rad/s.
        sinusoid_frequency_rad_s: GyroSinusoidFrequency = Row {
            name: "gyro sinusoid frequency",
            law: ErrorLaw::Shape(Shape::Frequency),
            keys: &[Key::new(66, "gyro.sinusoid_hz", "frequency of the sinusoid", "Hz", TAU, Positive)],
        };
        /// Its phase at the beginning of the run, rad.
        sinusoid_phase_rad: GyroSinusoidPhase = Row {
            name: "gyro sinusoid phase",
            law: ErrorLaw::Shape(Shape::Phase),
            keys: &[Key::new(67, "gyro.sinusoid_phase_deg", "phase of the sinusoid", "°", DEGREE, Any)],
        };
        /// Rate ramp R, rad/s².
        ramp_rad_s2: RateRamp = Row {
            name: "rate ramp",
            law: ErrorLaw::Ramp,
            keys: &[Key::new(30, "gyro.rate_ramp_deg_h_h", "rate ramp R", "°/h/h", DEGREE_PER_HOUR / 3600.0, Any)],
        };
    }
}
