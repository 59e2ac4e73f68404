//! Weights of the control points of a uniform B-spline of order six (degree five), and their
//! derivatives.

/// Control points that matter at an instant.
pub const ORDER: usize = 6;

/// Weights of the control points of a segment, and their first two derivatives by the segment's own
/// coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// They add up to one.
    pub value: [f64; ORDER],
    /// First derivatives; they add up to zero.
    pub first: [f64; ORDER],
    /// Second derivatives; they add up to zero.
    pub second: [f64; ORDER],
}

/// Raises the weights of one order at `u` to those of the next: Cox and de Boor's recursion on
/// integer knots. `from[k]` is the k-th of `order`.
fn raised(from: [f64; ORDER], order: usize, u: f64) -> [f64; ORDER] {
    let degree = order as f64;
    let mut to = [0.0; ORDER];
    for (k, weight) in to.iter_mut().enumerate().take(order + 1) {
        // The k-th weight belongs to the function that begins `order − k` knots before this
        // segment.
        let since = u + degree - k as f64;
        let before = if k < order { from[k] } else { 0.0 };
        let at = if k > 0 { from[k - 1] } else { 0.0 };
        *weight = (since * at + (degree + 1.0 - since) * before) / degree;
    }
    to
}

/// Derivatives of weights from those of one order less.
fn derivative(lower: [f64; ORDER]) -> [f64; ORDER] {
    std::array::from_fn(|k| if k > 0 { lower[k - 1] - lower[k] } else { -lower[k] })
}

impl Weights {
    /// At the coordinate 0 ≤ u ≤ 1 of a segment.
    pub fn at(u: f64) -> Self {
        let mut orders = [[0.0; ORDER]; ORDER];
        orders[0][0] = 1.0;
        for order in 1..ORDER {
            orders[order] = raised(orders[order - 1], order, u);
        }
        Self { value: orders[5], first: derivative(orders[4]), second: derivative(derivative(orders[3])) }
    }

    /// The sums from each weight to the last: how far each step from one control point to the next
    /// is taken.
    pub fn cumulative(&self) -> Self {
        let sums = |weights: [f64; ORDER]| {
            let mut sums = weights;
            (0..ORDER - 1).rev().for_each(|k| sums[k] += sums[k + 1]);
            sums
        };
        Self { value: sums(self.value), first: sums(self.first), second: sums(self.second) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_the_textbook_and_derivatives_their_slopes() {
        // de Boor, A practical guide to splines, ch. IX: on integer knots 1/120, 26/120, 66/120,
        // 26/120, 1/120.
        let knot = Weights::at(0.0).value.map(|w| w * 120.0);
        for (got, expected) in knot.iter().zip([1.0, 26.0, 66.0, 26.0, 1.0, 0.0]) {
            assert!((got - expected).abs() < 1e-12, "{knot:?}");
        }
        let step = 1e-5;
        for u in [0.1, 0.5, 0.83] {
            let (before, here, after) = (Weights::at(u - step), Weights::at(u), Weights::at(u + step));
            assert!((here.value.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!((here.cumulative().value[0] - 1.0).abs() < 1e-14);
            for k in 0..ORDER {
                let first = (after.value[k] - before.value[k]) / (2.0 * step);
                let second = (after.first[k] - before.first[k]) / (2.0 * step);
                assert!((here.first[k] - first).abs() < 1e-9 && (here.second[k] - second).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn polynomials_up_to_the_fifth_degree_lie_in_their_span() {
        // Marsden's identity: the product of (t − knot) over a function's five inner knots weighs
        // it for t⁵-like curves.
        for u in [0.0, 0.3, 0.9] {
            let weights = Weights::at(u).value;
            let at = 0.37;
            let sum: f64 = weights
                .iter()
                .enumerate()
                .map(|(k, w)| w * (1..ORDER).map(|j| (k as f64 - 5.0 + j as f64) - at).product::<f64>())
                .sum();
            assert!((sum - (u - at).powi(5)).abs() < 1e-13, "{sum}");
        }
    }
}
