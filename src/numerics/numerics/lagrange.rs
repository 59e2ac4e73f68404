//! Weights of Lagrange's interpolating polynomial.

/// Weight of node `j` of `nodes` for the value at `at`. Nodes differ from each other.
pub fn weight(nodes: &[f64], j: usize, at: f64) -> f64 {
    let here = nodes[j];
    let others = nodes.iter().enumerate().filter(|(m, _)| *m != j);
    others.map(|(_, other)| (at - other) / (here - other)).product()
}

/// Weights of nodes at −1, 0, 1 and 2 for the value at `t`.
#[inline]
pub fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_met_exactly_and_a_fourth_power_is_not() {
        let nodes: [f64; 4] = [-1.0, 0.0, 1.0, 2.0];
        let value = |power: i32, t: f64| -> f64 { cubic(t).iter().zip(nodes).map(|(w, x)| w * x.powi(power)).sum() };
        for t in [-0.3_f64, 0.0, 0.4, 1.0, 1.7] {
            for power in 0..4 {
                assert!((value(power, t) - t.powi(power)).abs() < 1e-14, "t^{power} at {t}");
            }
            for (j, w) in cubic(t).into_iter().enumerate() {
                assert!((weight(&nodes, j, t) - w).abs() < 1e-14, "node {j} at {t}");
            }
        }
        assert!((value(4, 0.4) - 0.4f64.powi(4)).abs() > 0.1);
    }
}
