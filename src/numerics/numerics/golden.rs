//! Golden section: the least value of a function of one variable in a bracket.

/// Place of the least value found in a bracket, and that value: of a function with one minimum there,
/// to 0.618 to the power of `sections` of its width. Ends sooner at a value that is `enough`.
///
/// Source: Kiefer, Proc. Am. Math. Soc. 4 (1953) 502.
pub fn least(
    value: impl Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    sections: usize,
    enough: impl Fn(f64) -> bool,
) -> (f64, f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let inside = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let [mut a, mut b] = inside(low, high);
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..sections {
        if enough(at_a.min(at_b)) {
            break;
        }
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inside(low, high)[0];
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inside(low, high)[1];
            at_b = value(b);
        }
    }
    if at_a < at_b { (a, at_a) } else { (b, at_b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_and_a_cusp_are_found_to_the_width_promised() {
        for place in [0.1, 0.5, 0.93] {
            for value in [&|x: f64| (x - place).powi(2), &|x: f64| (x - place).abs()] as [&dyn Fn(f64) -> f64; 2] {
                let (found, least) = least(value, [0.0, 1.0], 30, |_| false);
                assert!((found - place).abs() < 0.62f64.powi(30) && least == value(found), "{place}: {found}");
            }
        }
        let (_, first) = least(|x| x * x, [-1.0, 1.0], 30, |value| value < 0.1);
        assert!(first < 0.1 && first > 1e-6, "{first}: it goes on though that is enough");
    }
}
