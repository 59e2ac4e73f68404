//! A fitted subset of the parameters, and numbers made of them with their intervals.

use super::blocks::Linear;
use super::parameters::{LOWPASS, OFFSET, PARAMETERS, Point, lowpass_s, stated};
use super::shown;
use super::slow::{self, deviation, half_width};
use crate::by_axis::Drawn;
use crate::verdict::Estimate;

/// A fitted subset with what its intervals are made of.
pub(super) struct Fitted {
    active: Vec<usize>,
    /// Parameter vector at the optimum, SI units.
    pub point: Point,
    /// The fit with the noise of each slow wave of the recording in it.
    apart: Vec<Point>,
    /// By how much noise that slope and residual share may move each.
    shared: Point,
    /// From one reading to the next, s.
    interval_s: f64,
}

impl Fitted {
    /// A subset of the parameters fitted on all blocks.
    pub(super) fn of(linear: &Linear, active: &[usize], interval_s: f64) -> Self {
        let solved = linear.solve(active, |_| true);
        let apart = slow::apart(linear, active, &solved);
        let mut shared = [0.0; PARAMETERS];
        let variances = solved.covariance.diagonal();
        active.iter().zip(&variances).for_each(|(p, variance)| shared[*p] = shown::shared(linear, *p, *variance));
        Self { active: active.to_vec(), apart, point: solved.point, shared, interval_s }
    }

    /// Returns whether a parameter is in it.
    pub(super) fn has(&self, p: usize) -> bool {
        self.active.contains(&p)
    }

    /// A parameter in a unit of which `per_si` are one SI unit.
    pub(super) fn estimate(&self, p: usize, name: &str, unit: &str, per_si: f64) -> Estimate {
        let of = |point: &Point| stated(point, p);
        let value = of(&self.point);
        let half = half_width(&of, &self.point, &self.apart) + self.within_a_sample_s(p) + self.shared[p];
        let ci95 = [(value - half) * per_si, (value + half) * per_si];
        Estimate { name: name.into(), value: value * per_si, unit: unit.into(), ci95 }
    }

    /// By how much the lag of a low-pass depends on what happens between readings, s: straight
    /// lines between them are a low-pass themselves, of a sixth of the square of their interval.
    fn within_a_sample_s(&self, p: usize) -> f64 {
        let tau_s = lowpass_s(&self.point);
        if tau_s > 0.0 && (p == LOWPASS || p == OFFSET) { self.interval_s.powi(2) / (12.0 * tau_s) } else { 0.0 }
    }

    /// A parameter of the fit with its standard error, SI; nothing where it is not in it.
    pub(super) fn drawn(&self, p: usize) -> Drawn {
        if !self.has(p) {
            return Drawn::default();
        }
        Drawn { mean: self.point[p], sd: deviation(&|point| point[p], &self.point, &self.apart).hypot(self.shared[p]) }
    }

    /// A number made of parameters, with its 95 % interval.
    pub(super) fn number(&self, of: &dyn Fn(&Point) -> f64) -> (f64, [f64; 2]) {
        let value = of(&self.point);
        let moved = |p: usize| {
            let mut point = self.point;
            point[p] += self.shared[p];
            (of(&point) - value).abs()
        };
        let shared: f64 = (0..PARAMETERS).filter(|p| self.shared[*p] > 0.0).map(moved).sum();
        let half = half_width(of, &self.point, &self.apart) + shared;
        (value, [value - half, value + half])
    }
}
