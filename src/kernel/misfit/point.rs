//! One model of a driven recording: the parameters of base and candidates together, and the numbers that the misfit kernel
//! makes of them.

use super::{COLUMNS, FAR, Job, STATE, column};

/// Parameters of one model; y the reading's unit, u the input's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// g, y/(u s²).
    pub gain: f64,
    /// ω₀.
    pub omega_rad_s: f64,
    /// ζ.
    pub zeta: f64,
    /// Offset of the reading, y.
    pub offset: f64,
    /// Displacement at the beginning of the run, y.
    pub x0: f64,
    /// Velocity there, y/s.
    pub v0: f64,
    /// β of βx³, 1/(y² s²).
    pub cubic: f64,
    /// α of αx², 1/(y s²).
    pub quadratic: f64,
    /// c₂ of c₂|x′|x′, 1/y.
    pub speed_damping: f64,
    /// c of c x²x′, 1/(y² s).
    pub squeeze_film: f64,
    /// f_c of f_c sgn x′, y/s².
    pub friction: f64,
    /// κ of ω₀²(1 + κt), 1/s.
    pub stiffness_drift: f64,
    /// κ of g(u + κu²), 1/u.
    pub drive_square: f64,
    /// Stiffness of the stop above, 1/s².
    pub stop_above: f64,
    /// Its distance, y.
    pub gap_above: f64,
    /// Stiffness of the stop below, 1/s².
    pub stop_below: f64,
    /// Its distance, y.
    pub gap_below: f64,
    /// k_h of the Bouc–Wen spring, 1/s².
    pub hysteresis: f64,
    /// Its yield displacement z_y, y.
    pub yield_displacement: f64,
    /// The share of |x′|z in its slip, 1.
    pub slip_share: f64,
    /// Its z at the beginning of the run, y.
    pub hysteresis_z0: f64,
    /// g₂ of the second mode, y/(u s²).
    pub mode_gain: f64,
    /// ω₂.
    pub mode_omega_rad_s: f64,
    /// ζ₂.
    pub mode_zeta: f64,
    /// Its displacement at the beginning of the run, y.
    pub mode_x0: f64,
    /// Its velocity there, y/s.
    pub mode_v0: f64,
    /// τ of the readout's low-pass; zero: none.
    pub lowpass_s: f64,
    /// Delay of the reading.
    pub delay_s: f64,
    /// d of y = x + d·u, y/u.
    pub feedthrough: f64,
    /// k₂ of the readout, 1/y.
    pub bend_2: f64,
    /// k₃ of the readout, 1/y².
    pub bend_3: f64,
    /// c of c·t, y/s.
    pub ramp: f64,
    /// c of c·exp(−t/τ), y.
    pub warm_up: f64,
    /// Its τ.
    pub warm_up_s: f64,
    /// Lower rail, y.
    pub low: f64,
    /// Upper rail, y.
    pub high: f64,
}

impl Default for Point {
    fn default() -> Self {
        Self {
            gain: 0.0,
            omega_rad_s: 1.0,
            zeta: 0.0,
            offset: 0.0,
            x0: 0.0,
            v0: 0.0,
            cubic: 0.0,
            quadratic: 0.0,
            speed_damping: 0.0,
            squeeze_film: 0.0,
            friction: 0.0,
            stiffness_drift: 0.0,
            drive_square: 0.0,
            stop_above: 0.0,
            gap_above: 0.0,
            stop_below: 0.0,
            gap_below: 0.0,
            hysteresis: 0.0,
            yield_displacement: 1.0,
            slip_share: 0.5,
            hysteresis_z0: 0.0,
            mode_gain: 0.0,
            mode_omega_rad_s: 1.0,
            mode_zeta: 0.0,
            mode_x0: 0.0,
            mode_v0: 0.0,
            lowpass_s: 0.0,
            delay_s: 0.0,
            feedthrough: 0.0,
            bend_2: 0.0,
            bend_3: 0.0,
            ramp: 0.0,
            warm_up: 0.0,
            warm_up_s: 1.0,
            low: -FAR,
            high: FAR,
        }
    }
}

impl Point {
    /// The numbers that the kernel reads, and the state it begins with.
    pub fn columns(&self, job: &Job<'_>) -> ([f64; COLUMNS], [f64; STATE]) {
        use column::*;
        let (y, u, s) = (job.units.output, job.units.input, job.units.interval_s);
        let h = 1.0 / job.steps as f64;
        let (omega, mode_omega) = (self.omega_rad_s * s, self.mode_omega_rad_s * s);
        let mut c = [0.0; COLUMNS];
        c[FULL..FULL + 4].copy_from_slice(&transition(omega, self.zeta, h));
        c[HALF..HALF + 4].copy_from_slice(&transition(omega, self.zeta, 0.5 * h));
        c[GAIN] = self.gain * u * s * s / y;
        c[STIFFNESS] = omega * omega;
        c[OFFSET] = self.offset / y;
        c[CUBIC] = self.cubic * y * y * s * s;
        c[QUADRATIC] = self.quadratic * y * s * s;
        c[SPEED_DAMPING] = self.speed_damping * y;
        c[SQUEEZE_FILM] = self.squeeze_film * y * y * s;
        c[FRICTION] = self.friction * s * s / y;
        c[STIFFNESS_DRIFT] = c[STIFFNESS] * self.stiffness_drift * s;
        c[DRIVE_SQUARE] = c[GAIN] * self.drive_square * u;
        c[STOP_ABOVE] = self.stop_above * s * s;
        c[GAP_ABOVE] = self.gap_above / y;
        c[STOP_BELOW] = self.stop_below * s * s;
        c[GAP_BELOW] = self.gap_below / y;
        c[HYSTERESIS] = self.hysteresis * s * s;
        c[YIELD] = y / self.yield_displacement;
        c[SHARE] = self.slip_share;
        c[MODE_GAIN] = self.mode_gain * u * s * s / y;
        c[MODE_DAMPING] = 2.0 * self.mode_zeta * mode_omega;
        c[MODE_STIFFNESS] = mode_omega * mode_omega;
        let lag = self.lowpass_s / s;
        c[LAG] = lag / h;
        c[KEEPS] = (-h / lag).exp();
        c[FEEDTHROUGH] = self.feedthrough * u / y;
        c[BEND_2] = self.bend_2 * y;
        c[BEND_3] = self.bend_3 * y * y;
        c[RAMP] = self.ramp * s / y;
        c[FADE] = (-s / self.warm_up_s).exp_m1();
        c[LOW] = (self.low / y).max(-FAR);
        c[HIGH] = (self.high / y).min(FAR);
        let delay = 2.0 * self.delay_s / (s * h);
        c[SHIFT] = delay.ceil();
        c[WEIGHTS..].copy_from_slice(&lagrange(delay.ceil() - delay));
        let (x, v) = (self.x0 / y, self.v0 * s / y);
        let warm_up = self.warm_up / y * (-(job.run.start as f64 * s) / self.warm_up_s).exp();
        (c, [x, v, self.hysteresis_z0 / y, self.mode_x0 / y, self.mode_v0 * s / y, x - lag * v, warm_up, 0.0])
    }
}

/// Weights of the points −1, 0, 1, 2 of a cubic through them, at `t`.
fn lagrange(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

/// exp(At) for A = [[0, 1], [−ω², −2ζω]], row by row; any ζ ≥ 0.
pub fn transition(omega: f64, zeta: f64, t: f64) -> [f64; 4] {
    let decay = (-zeta * omega * t).exp();
    let d = 1.0 - zeta * zeta;
    // C = cos(w t) and S = sin(w t)/w, continued analytically through critical damping.
    let (c, s) = if d > 1e-8 {
        let w = omega * d.sqrt();
        ((w * t).cos() * decay, (w * t).sin() / w * decay)
    } else if d < -1e-8 {
        let w = omega * (-d).sqrt();
        let (up, down) = (((w - zeta * omega) * t).exp(), ((-w - zeta * omega) * t).exp());
        (0.5 * (up + down), 0.5 * (up - down) / w)
    } else {
        (decay, t * decay)
    };
    let a = zeta * omega;
    [c + a * s, s, -omega * omega * s, c - a * s]
}
