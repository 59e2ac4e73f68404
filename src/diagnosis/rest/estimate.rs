//! From a fitted strength, amplitude or searched number to a stated value with its 95 % interval,
//! in file units.

use super::channel::{Addition, Channel, Fitted};
use crate::numerics::order;
use crate::numerics::special::{chi_squared_quantile, normal_quantile};
use crate::verdict::Estimate;

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

/// A model with another value, in samples, of a term's searched time constant.
pub(super) fn with_searched(
    channel: &Channel,
    fitted: &Fitted,
    index: usize,
    value: f64,
    addition: &dyn Fn(f64) -> Addition,
) -> Fitted {
    let mut terms = fitted.terms.clone();
    terms[index].searched = value;
    terms[index].addition = addition(value);
    channel.fit(terms)
}

/// A strength or amplitude whose own interval holds a time constant fixed, with what that may be
/// off by: `at` is the value at an end of the time constant's interval, which is as far from the best
/// one as 95 % of chance lets it be. Of two independent reaches the whole is the root of the sum of
/// squares (the delta method); of what is above zero, in its logarithm.
pub(super) fn beside_searched(own: Estimate, time: &Estimate, at: impl Fn(f64) -> f64) -> Estimate {
    let ends = time.ci95.map(at);
    let is_size = own.ci95[0] > 0.0 && ends.iter().all(|e| *e > 0.0);
    let scale = |v: f64| if is_size { v.ln() } else { v };
    let value = scale(own.value);
    let reach = |side: f64, end: f64| {
        let other = ends.iter().map(|e| side * (scale(*e) - value)).fold(0.0, f64::max);
        let wide = value + side * (side * (scale(end) - value)).hypot(other);
        if is_size { wide.exp() } else { wide }
    };
    Estimate { ci95: [reach(-1.0, own.ci95[0]), reach(1.0, own.ci95[1])], ..own }
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
        fitted.log_likelihood() - with_searched(channel, fitted, index, value, addition).log_likelihood() < 1.92
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_time_constant_may_be_off_by_is_added_as_chance_is() {
        let of = |value: f64, ci95: [f64; 2]| Estimate { name: String::new(), value, unit: String::new(), ci95 };
        let time = of(2.0, [1.0, 4.0]);
        // A slope that passes through zero: 3 on its own and 4 by the time constant are 5.
        let signed = beside_searched(of(0.0, [-3.0, 3.0]), &time, |t| if t < 2.0 { -4.0 } else { 4.0 });
        assert!(signed.ci95 == [-5.0, 5.0], "{signed:?}");
        // What stays the same at any time constant keeps its interval, and a size stays above zero.
        let held = beside_searched(of(1.0, [0.5, 2.0]), &time, |_| 1.0);
        assert!((held.ci95[0] - 0.5).abs() < 1e-12 && (held.ci95[1] - 2.0).abs() < 1e-12);
        let size = beside_searched(of(1.0, [0.9, 1.1]), &time, |t| (t / 2.0).sqrt());
        assert!(size.ci95[0] > 0.6 && size.ci95[0] < 1.0 / 2f64.sqrt() && size.ci95[1] > 2f64.sqrt(), "{size:?}");
    }
}
