//! Known quantities and flexible functions of them, which noise does not follow and a law that is
//! missing does: the input, the motion, time and the environment.

use nalgebra::Complex;

use crate::driven::intake::data::Data;
use crate::numerics::moments::mean_sd;
use crate::numerics::order;

/// Quantiles at which a regressor may bend.
const KNOTS: [f64; 7] = [0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98];
/// Cosines of time over the recording.
const COSINES: usize = 8;
/// Resonances that remember the input: how many, over which multiples of ω₀, and their quality. Few,
/// as each takes two columns: what lies between two of them shows in the feet of both.
const RESONANCES: usize = 12;
const OVER: [f64; 2] = [0.1, 10.0];
const QUALITY: f64 = 5.0;

/// Known quantity that an estimated disturbance may follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// The measured input.
    Input,
    /// Displacement and velocity of the mass.
    Motion,
    /// Time since the recording began.
    Time,
    /// A column of the environment.
    Environment,
}

/// Returns the values without their mean, of unit size; `None` for a constant.
pub(super) fn standard(values: &[f64]) -> Option<Vec<f64>> {
    let (mean, sd) = mean_sd(values);
    (sd > 1e-12 * mean.abs() && sd.is_finite() && sd > 0.0).then(|| values.iter().map(|v| (v - mean) / sd).collect())
}

/// A variable and what bends at its quantiles.
pub(super) fn bent(values: &[f64]) -> Vec<Vec<f64>> {
    let mut sorted = values.to_vec();
    order::sort(&mut sorted);
    let at = |q: f64| sorted[((sorted.len() - 1) as f64 * q) as usize];
    let bends = KNOTS.iter().map(|q| at(*q)).map(|knot| values.iter().map(|v| (v - knot).max(0.0)).collect());
    std::iter::once(values.to_vec()).chain(bends).collect()
}

/// A known quantity and its functions, row by row of the hull.
pub(super) type Group = (Known, Vec<Vec<f64>>);

/// Known quantities without mean and of unit size, row by row of the hull.
pub(super) struct Regressors {
    x: Vec<f64>,
    v: Vec<f64>,
    /// The input and its change from sample to sample.
    input: Option<(Vec<f64>, Vec<f64>)>,
    environment: Vec<Vec<f64>>,
    /// Phase of the resonance that passes in a sample, rad.
    angle: f64,
}

impl Regressors {
    pub(super) fn of(data: &Data, omega_rad_s: f64, [x, v]: [&[f64]; 2]) -> Self {
        let or_none = |values: &[f64]| standard(values).unwrap_or_else(|| vec![0.0; values.len()]);
        let input = data.input.as_ref().and_then(|i| standard(&i.samples()[data.hull.clone()]));
        let columns = (0..data.environments).filter_map(|j| {
            let column: Vec<f64> = data.hull.clone().map(|k| data.environment[k * data.environments + j]).collect();
            standard(&column)
        });
        Self {
            x: or_none(x),
            v: or_none(v),
            input: input.map(|u| {
                let change = or_none(&changes(&u));
                (u, change)
            }),
            environment: columns.collect(),
            angle: omega_rad_s * data.interval_s(),
        }
    }

    /// Returns what the disturbance itself may follow. Of the input only the present value and
    /// which way it goes: what follows linearly from the samples next to it shows how the input
    /// goes between samples, not that a law is missing.
    pub(super) fn of_means(&self) -> Vec<Group> {
        let (x, v, rows) = (&self.x, &self.v, self.x.len());
        let mut motion: Vec<Vec<f64>> = [bent(x), bent(v)].concat();
        let tensors: [&dyn Fn(f64, f64) -> f64; 8] = [
            &|_, v| v.signum(),
            &|x, v| x * v,
            &|x, v| x * x * v,
            &|x, v| x * v * v,
            &|x, v| x.abs() * v,
            &|x, v| x * v.abs(),
            &|x, v| x.abs() * v.signum(),
            &|x, _| x.powi(3),
        ];
        motion.extend(tensors.iter().map(|f| product(x, v, f)));
        let middle = |i: usize| (i as f64 + 0.5) / rows as f64;
        let time: Vec<Vec<f64>> = (1..=COSINES)
            .map(|j| (0..rows).map(|i| (std::f64::consts::PI * j as f64 * middle(i)).cos()).collect())
            .collect();
        // A stiffness or a damping that drifts, along whatever trend.
        let drifts = [x, v].map(|s| time.iter().map(|t| product(t, s, &|t, s| t * s)).collect::<Vec<_>>());
        let mut groups = vec![(Known::Motion, motion), (Known::Time, time)];
        groups.extend(drifts.map(|columns| (Known::Time, columns)));
        if let Some((u, change)) = &self.input {
            let mut all = bent(u);
            all.extend([x, v].map(|s| product(u, s, &|u, s| u * s)));
            all.push(product(u, change, &|_, c| c.signum()));
            all.push(product(u, change, &|u, c| u.abs() * c.signum()));
            groups.push((Known::Input, all));
            groups.push((Known::Input, self.remembered(u)));
        }
        let environment: Vec<Vec<f64>> = self.environment.iter().flat_map(|c| bent(c)).collect();
        if !environment.is_empty() {
            groups.push((Known::Environment, environment));
        }
        groups
    }

    /// Returns the answers of resonances elsewhere to the input.
    fn remembered(&self, input: &[f64]) -> Vec<Vec<f64>> {
        let at = |j: usize| self.angle * OVER[0] * (OVER[1] / OVER[0]).powf(j as f64 / (RESONANCES - 1) as f64);
        let rings = (0..RESONANCES).map(at).filter(|angle| *angle < 0.5 * std::f64::consts::PI).flat_map(|angle| {
            let turn = Complex::from_polar((-0.5 * angle / QUALITY).exp(), angle);
            let mut state = Complex::new(0.0, 0.0);
            let rung: Vec<Complex<f64>> = input
                .iter()
                .map(|u| {
                    state = state * turn + u;
                    state
                })
                .collect();
            [rung.iter().map(|c| c.re).collect(), rung.iter().map(|c| c.im).collect()]
        });
        rings.collect()
    }

    /// Returns how the input goes between samples: forces that show nothing of a law that is
    /// missing.
    pub(super) fn between_samples(&self) -> Vec<Vec<f64>> {
        let Some((u, _)) = &self.input else { return Vec::new() };
        let last = u.len() as isize - 1;
        (-2..=2).map(|lag| (0..=last).map(|i| u[(i + lag).clamp(0, last) as usize]).collect()).collect()
    }

    /// Returns what the disturbance's power may follow: how large and how fast the motion and the
    /// input are, and where they turn. Not time: noise may grow.
    pub(super) fn of_powers(&self) -> Vec<Group> {
        let sizes = |values: &[f64]| bent(&values.iter().map(|v| v.abs()).collect::<Vec<f64>>());
        let both = |values: &[f64], change: &[f64]| {
            let mut all = [bent(values), sizes(values), sizes(change)].concat();
            all.extend([turns(change), product(values, change, &|x, v| (x * v).abs())]);
            all
        };
        let mut groups = vec![(Known::Motion, both(&self.x, &self.v))];
        groups.extend(self.input.as_ref().map(|(u, change)| (Known::Input, both(u, change))));
        groups
    }
}

fn product(a: &[f64], b: &[f64], f: &dyn Fn(f64, f64) -> f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| f(*a, *b)).collect()
}

/// Half of the change from the sample before to the one after.
fn changes(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    (0..values.len()).map(|i| 0.5 * (values[(i + 1).min(last)] - values[i.saturating_sub(1)])).collect()
}

/// One where a velocity changes its sign between a sample and the next.
fn turns(velocity: &[f64]) -> Vec<f64> {
    let last = velocity.len() - 1;
    (0..velocity.len()).map(|i| f64::from(velocity[i] * velocity[(i + 1).min(last)] <= 0.0)).collect()
}
