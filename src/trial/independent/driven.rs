//! A driven recording of the second generator: an oscillator, its noise, and how its columns are
//! written.

use serde::{Deserialize, Serialize};

use super::columns::Columns;
use super::draw::Draw;
use super::law::{Course, Law};
use super::linear::{self, Fine};
use super::oscillator::{self, Oscillator};
use super::readout::{self, Noise, Readout};
use super::simulate::{self, Run};
use super::truth::Parameter;

/// A driven recording as drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Proof mass with input, laws and readout.
    pub oscillator: Oscillator,
    /// Law of the readout noise.
    pub noise: Noise,
    /// Rms of the readout noise, internal units.
    pub sigma: f64,
    /// Units, headings and order of the columns.
    pub columns: Columns,
    /// States whether model.toml states where the resonance is.
    pub hint: bool,
}

/// Readings and input in internal units, without noise where `noisy` is false.
pub struct Readings {
    /// Measured input; empty in a ring-down.
    pub input: Vec<f64>,
    /// Reading at each row, internal units.
    pub reading: Vec<f64>,
}

impl Driven {
    /// The first rows. None when the motion runs away.
    pub fn readings(&self, rows: usize, noisy: bool) -> Option<Readings> {
        let o = &self.oscillator;
        let Run { mut input, signal } = simulate::run(o, rows)?;
        let mut draw = Draw::new(o.seed, 0, 31);
        let noise: Vec<f64> = match noisy {
            true => self.noise.series(&signal, &mut draw).iter().map(|e| self.sigma * e).collect(),
            false => vec![0.0; rows],
        };
        // Rounding without noise would leave its steps in what is called signal.
        let stages: Vec<Readout> = match noisy {
            true => o.readout.clone(),
            false => o.readout.iter().filter(|r| !matches!(r, Readout::Round { .. })).cloned().collect(),
        };
        let reading = readout::read(&stages, &signal, &input, &noise, o.rate_hz, o.seed);
        if noisy && o.input_noise > 0.0 {
            let rms = rms(&input);
            input.iter_mut().for_each(|u| *u += o.input_noise * rms * draw.normal());
        }
        if o.input == super::wave::Shape::None {
            input.clear();
        }
        Some(Readings { input, reading })
    }

    /// Returns what the best base model leaves of the noiseless reading; it knows the measured
    /// input between rows as well.
    pub fn left_by_base(&self, reading: &[f64]) -> Vec<f64> {
        let o = &self.oscillator;
        let fine = (o.input != super::wave::Shape::None).then(|| measured(o, reading.len()));
        linear::refit(reading, fine.as_ref(), o.rate_hz, [o.omega, o.zeta]).0
    }

    /// Rms that the best base model leaves of the first rows.
    pub fn visible(&self, rows: usize) -> Option<f64> {
        let readings = self.readings(rows, false)?;
        Some(rms(&self.left_by_base(&readings.reading)))
    }

    /// Intervals of the library's parameters are held against these: column units.
    pub fn parameters(&self) -> Vec<Parameter> {
        let (o, y) = (&self.oscillator, self.columns.output_scale);
        let u = self.columns.input_scale;
        let length_s = o.rows as f64 / o.rate_hz;
        let mut found = Vec::new();
        let mut add = |id: &str, name: &str, value: f64| {
            found.push(Parameter { id: id.into(), channel: None, name: name.into(), value });
        };
        for law in &o.laws {
            match *law {
                Law::OddSpring { size, p: 3.0 } => add("cubic-stiffness", "beta", size / (y * y)),
                Law::OddSpring { p, .. } => add("power-law-stiffness", "n", p),
                Law::EvenSpring { size } => add("quadratic-stiffness", "alpha", size / y),
                Law::Drag { size, p: 2.0 } => add("quadratic-damping", "c2", size / y.abs()),
                Law::Drag { p, .. } => add("power-law-damping", "n", p),
                Law::Squeeze { size } => add("squeeze-film-damping", "c", size / (y * y)),
                Law::Friction { size, lean: 0.0 } => add("coulomb-friction", "f_c", size * y.abs()),
                Law::BoucWen { size, b, g, n: 1.0 } => {
                    add("hysteresis", "k_h", size);
                    add("hysteresis", "beta", b / y.abs());
                    add("hysteresis", "gamma", g / y.abs());
                }
                Law::BoucWen { n, .. } => add("hysteresis", "n", n),
                Law::SpringDrift { size, course: Course::Linear } => add("stiffness-drift", "kappa", size / length_s),
                Law::Absorber { size, omega, zeta } => {
                    add("coupled-mode", "mu", size);
                    add("coupled-mode", "omega2", omega);
                    add("coupled-mode", "zeta2", zeta);
                }
                Law::Beside { size, omega, zeta } => {
                    add("parasitic-mode", "g2", size * y / u);
                    add("parasitic-mode", "omega2", omega);
                    add("parasitic-mode", "zeta2", zeta);
                }
                Law::DriveSquare { size } => add("drive-nonlinearity", "kappa", size / u),
                Law::Stop { size, gap, p: 1.0, .. } => {
                    add("end-stop", "k_c", size);
                    add("end-stop", "gap", gap * y.abs());
                }
                Law::WhiteForce { size } => {
                    add("force-noise", "rms_displacement", (size / (4.0 * o.zeta * o.omega.powi(3))).sqrt() * y.abs());
                }
                _ => {}
            }
        }
        for stage in &o.readout {
            match stage {
                Readout::Poles { taus } if taus.len() == 1 => add("readout-lowpass", "tau", taus[0]),
                Readout::Delay { tau } => add("readout-delay", "tau", *tau),
                Readout::Bend { k2, k3 } => {
                    add("readout-nonlinearity", "k2", k2 / y);
                    add("readout-nonlinearity", "k3", k3 / (y * y));
                }
                Readout::Feed { size } => add("feedthrough", "d", size * y / u),
                Readout::Slow { size, course: Course::Linear } => add("bias-drift", "c", size * y / length_s),
                Readout::WarmUp { size, tau } => {
                    add("warm-up", "c", size * y);
                    add("warm-up", "tau", *tau);
                }
                Readout::Walk { size } => add("bias-random-walk", "K", size * y.abs()),
                Readout::Line { a, b, hz } => {
                    add("periodic-disturbance", "a", a * y);
                    add("periodic-disturbance", "b", b * y);
                    add("periodic-disturbance", "frequency", *hz);
                }
                Readout::Rails { low, high, .. } => {
                    let [a, b] = [low, high].map(|r| r * y + self.columns.offset);
                    add("readout-saturation", "low", a.min(b));
                    add("readout-saturation", "high", a.max(b));
                }
                Readout::Round { step } => add("readout-quantisation", "step", step * y.abs()),
                _ => {}
            }
        }
        if o.input_lag_s > 0.0 {
            add("input-lag", "tau", o.input_lag_s);
        }
        found
    }

    /// Texts of recording.csv and model.toml.
    pub fn texts(&self) -> [String; 2] {
        let o = &self.oscillator;
        let readings = self.readings(o.rows, true).unwrap_or(Readings { input: Vec::new(), reading: Vec::new() });
        let environment: Option<Vec<f64>> = o
            .environment
            .map(|_| (0..o.rows).map(|n| 20.0 + oscillator::environment(o, n as f64 / o.rows as f64)).collect());
        self.columns.driven(&readings.input, &readings.reading, environment.as_deref(), o.rate_hz, self.hints())
    }

    fn hints(&self) -> Option<[f64; 2]> {
        self.hint.then(|| [self.oscillator.omega / std::f64::consts::TAU * 1.01, self.oscillator.zeta * 1.2])
    }
}

/// The measured input as the base model may know it: with its lag, without its noise.
fn measured(o: &Oscillator, rows: usize) -> Fine {
    let dt = 1.0 / o.rate_hz;
    let wave = o.input.wave(-8.0 * dt, (rows as f64 + 8.0) * dt + o.input_lag_s.abs());
    if o.held {
        let values = (0..rows).map(|n| wave.at(n as f64 * dt) + o.constant).collect();
        return Fine { values, steps: 1, held: true };
    }
    let fastest = (std::f64::consts::TAU * o.input.highest_hz()).max(o.omega);
    let steps = ((fastest * dt / 0.12).ceil() as usize).clamp(1, 40);
    let half = dt / (2.0 * steps as f64);
    let values = (0..2 * steps * rows + 3).map(|n| wave.at(n as f64 * half - o.input_lag_s) + o.constant).collect();
    Fine { values, steps, held: false }
}

pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
