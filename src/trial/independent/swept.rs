//! States how sweeps are taken and written: drives, band, lock-in, background, noise, units, columns.

use std::f64::consts::PI;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::columns::table;
use super::draw::Draw;
use super::readout::Noise;
use super::stepped::{Resonator, Step};

/// Holds what stands between the motion and the reading; times in 1/ω₀.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct LockIn {
    /// Part of a reading that its filter keeps of the step before.
    pub lag: f64,
    /// Delay.
    pub delay: f64,
    /// Time constant of a low-pass.
    pub tau: f64,
    /// Part by which its gain changes to the end.
    pub drift: f64,
    /// Part of the gain that is lost at unit amplitude.
    pub bend: f64,
}

/// States how a recording is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Written {
    /// f₀, Hz.
    pub f0_hz: f64,
    /// Reading for unit amplitude.
    pub scale: f64,
    /// Angle of the reference, rad.
    pub turn: f64,
    /// Largest drive.
    pub drive: f64,
    /// States whether Y has the other sign.
    pub mirrored: bool,
    /// States whether amplitude and phase are written.
    pub polar: bool,
    /// States whether the time of each step is written.
    pub clock: bool,
    /// States whether frequencies are in kHz.
    pub kilo: bool,
}

/// Recipe of a recording of sweeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Swept {
    /// Seed of the noise.
    pub seed: u64,
    /// The resonator.
    pub resonator: Resonator,
    /// Drives in the order taken, as parts of the largest; each is swept up and down.
    pub drives: Vec<f64>,
    /// Lowest and highest frequency, in ω₀.
    pub band: [f64; 2],
    /// Steps of one sweep.
    pub steps: usize,
    /// The lock-in.
    pub lock_in: LockIn,
    /// Background for unit amplitude: constant, along the band, and both in proportion to the drive.
    pub background: [[f64; 2]; 4],
    /// Law of the noise.
    pub noise: Noise,
    /// Standard deviation of X and of Y for unit amplitude.
    pub sigma: f64,
    /// Units and columns.
    pub written: Written,
}

impl Swept {
    /// The steps in the order taken.
    pub fn taken(&self) -> Vec<Step> {
        let [low, high] = self.band;
        let (rows, last) = (2 * self.steps * self.drives.len(), (self.steps - 1) as f64);
        let one = |row: usize| {
            let (drive, own) = (row / (2 * self.steps), row % (2 * self.steps));
            let k = if own < self.steps { own } else { 2 * self.steps - 1 - own };
            let along = 2.0 * k as f64 / last - 1.0;
            let omega = 0.5 * (low + high) + 0.5 * (high - low) * along;
            Step { omega, part: self.drives[drive], along, when: row as f64 / rows as f64, begins: own == 0 }
        };
        (0..rows).map(one).collect()
    }

    /// Reading for a unit of displacement of this amplitude at a step.
    pub fn gain(&self, step: &Step, amplitude: f64) -> Complex<f64> {
        let l = &self.lock_in;
        let size = (1.0 + l.drift * step.when) * (1.0 - l.bend * amplitude * amplitude);
        Complex::from_polar(size, -(step.omega - 1.0) * l.delay) / Complex::new(1.0, step.omega * l.tau)
    }

    /// Settled readings on their background, for unit amplitude.
    pub fn settled(&self, motion: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let one = |(step, x): (Step, &Complex<f64>)| {
            let shapes = [1.0, step.along, step.part, step.along * step.part];
            let background = self.background.iter().zip(shapes).map(|([re, im], s)| Complex::new(*re, *im) * s);
            self.gain(&step, x.norm()) * x + background.sum::<Complex<f64>>()
        };
        self.taken().into_iter().zip(motion).map(one).collect()
    }

    /// X and Y of each step as written.
    fn read(&self) -> Vec<Complex<f64>> {
        let steps = self.taken();
        let mut all = self.settled(&self.resonator.motion(&steps));
        for k in (1..all.len()).filter(|k| !steps[*k].begins) {
            all[k] = all[k] * (1.0 - self.lock_in.lag) + all[k - 1] * self.lock_in.lag;
        }
        let size: Vec<f64> = all.iter().map(|y| y.norm()).collect();
        let [x, y] = [1, 2].map(|axis| self.noise.series(&size, &mut Draw::new(self.seed, axis, 61)));
        for (k, z) in all.iter_mut().enumerate() {
            *z += Complex::new(x[k], y[k]) * self.sigma;
            *z *= Complex::from_polar(self.written.scale, self.written.turn);
            z.im *= if self.written.mirrored { -1.0 } else { 1.0 };
        }
        all
    }

    /// Texts of recording.csv and model.toml.
    pub fn texts(&self) -> [String; 2] {
        let (w, steps, read) = (&self.written, self.taken(), self.read());
        let of = |f: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..steps.len()).map(f).collect() };
        let per_hz = if w.kilo { 1e-3 } else { 1.0 };
        let frequency = of(&|k| steps[k].omega * w.f0_hz * per_hz);
        let (first, second) = match w.polar {
            true => (of(&|k| read[k].norm()), of(&|k| read[k].arg() * 180.0 / PI)),
            false => (of(&|k| read[k].re), of(&|k| read[k].im)),
        };
        let (drive, time) = (of(&|k| steps[k].part * w.drive), of(&|k| steps[k].when * self.length_s()));
        let names = if w.polar { ["amplitude", "phase"] } else { ["x", "y"] };
        let headings = if w.polar { ["R_V", "phase_deg"] } else { ["X_V", "Y_V"] };
        let heading = if w.kilo { "f_kHz" } else { "frequency_hz" };
        let mut columns: Vec<(&str, &[f64])> = vec![(heading, &frequency), (headings[0], &first)];
        columns.extend([(headings[1], &second[..]), ("drive_V", &drive[..])]);
        let mut model = format!("kind = \"response\"\n[columns]\nfrequency = {heading:?}\ndrive = \"drive_V\"\n");
        for (name, heading) in names.iter().zip(headings) {
            model += &format!("{name} = {heading:?}\n");
        }
        if w.clock {
            columns.insert(0, ("t_s", &time));
            model += "time = \"t_s\"\n";
        }
        [table(&columns), model]
    }

    /// Length of the recording, s.
    pub fn length_s(&self) -> f64 {
        2.0 * (self.steps * self.drives.len()) as f64 * 2.5 * self.resonator.quality / self.written.f0_hz
    }
}
