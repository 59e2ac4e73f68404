//! From a fitted strength, amplitude or searched number to a stated value with its 95 % interval,
//! in file units.

use super::channel::{Addition, Channel, Fitted};
use crate::diagnosis::verdict::Estimate;
use crate::numerics::order;
use crate::numerics::special::{chi_squared_quantile, normal_quantile};

/// 95 % interval of a variance: χ² with the degrees of freedom that its standard error amounts to.
pub(super) fn variance_interval(value: f64, error: f64) -> [f64; 2] {
    let degrees_of_freedom = 2.0 * (value / error).powi(2);
    [0.975, 0.025].map(|p| value * degrees_of_freedom / chi_squared_quantile(p, degrees_of_freedom))
}

/// A value whose square is a fitted strength, given with its standard error.
pub(super) fn root(name: &str, unit: String, factor: f64, (value, error): (f64, f64)) -> Estimate {
    let ci95 = variance_interval(value, error).map(|e| e.sqrt() * factor);
    Estimate { name: name.into(), value: value.sqrt() * factor, unit, ci95 }
}

/// A value that is fitted itself, given with its standard error.
pub(super) fn straight(name: &str, unit: String, factor: f64, (value, error): (f64, f64)) -> Estimate {
    let half = normal_quantile(0.975) * error;
    let mut ci95 = [(value - half) * factor, (value + half) * factor];
    order::sort(&mut ci95);
    Estimate { name: name.into(), value: value * factor, unit, ci95 }
}

/// A searched time constant, s, with the interval where the profile likelihood falls by half of
/// χ²₁'s 95 % point; `addition` makes the term anew for a time constant in samples.
pub(super) fn searched(
    name: &str,
    channel: &Channel,
    fitted: &Fitted,
    index: usize,
    addition: &dyn Fn(f64) -> Addition,
) -> Estimate {
    let step_s = 1.0 / channel.rate_hz;
    let best = fitted.terms[index].searched;
    let inside = |value: f64| {
        let mut terms = fitted.terms.clone();
        terms[index].searched = value;
        terms[index].addition = addition(value);
        fitted.log_likelihood() - channel.fit(terms).log_likelihood() < 1.92
    };
    let edge = |direction: f64| {
        let (mut near, mut far) = (0.0, 0.25);
        while far < 4.0 && inside(best * (direction * far).exp()) {
            (near, far) = (far, 2.0 * far);
        }
        for _ in 0..5 {
            let middle = (near + far) / 2.0;
            if inside(best * (direction * middle).exp()) { near = middle } else { far = middle }
        }
        best * (direction * far).exp() * step_s
    };
    Estimate { name: name.into(), value: best * step_s, unit: "s".into(), ci95: [edge(-1.0), edge(1.0)] }
}
