//! The envelope of an ensemble: spread and quantiles at every sampled time.
//!
//! Small ensembles held in memory; large ones stream through `statistics`.

use proofmass_numerics::numerics::moments::mean;
use proofmass_numerics::numerics::order;

/// Mean, spread and quantiles of an ensemble over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Sampled times, s.
    pub time_s: Vec<f64>,
    /// Mean over members at each time.
    pub mean: Vec<f64>,
    /// Standard deviation over members.
    pub sd: Vec<f64>,
    /// 5 % quantile over members at each time.
    pub p05: Vec<f64>,
    /// 95 % quantile over members at each time.
    pub p95: Vec<f64>,
}

impl Envelope {
    /// From members' values at the sampled times: `[member][time]`, each as long as `time_s`.
    pub fn of(time_s: Vec<f64>, members: &[Vec<f64>]) -> Self {
        let n = members.len() as f64;
        let mut envelope = Self { time_s, mean: vec![], sd: vec![], p05: vec![], p95: vec![] };
        for i in 0..envelope.time_s.len() {
            let mut values: Vec<f64> = members.iter().map(|m| m[i]).collect();
            order::sort(&mut values);
            let mean = mean(&values);
            envelope.mean.push(mean);
            envelope.sd.push((values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt());
            envelope.p05.push(order::quantile(&values, 0.05));
            envelope.p95.push(order::quantile(&values, 0.95));
        }
        envelope
    }

    /// (time, value) pairs of one of the curves.
    pub fn curve(&self, values: &[f64]) -> Vec<(f64, f64)> {
        self.time_s.iter().copied().zip(values.iter().copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_members_have_their_mean_and_spread() {
        let envelope = Envelope::of(vec![0.0], &[vec![1.0], vec![3.0]]);
        assert_eq!((envelope.mean[0], envelope.sd[0]), (2.0, 2f64.sqrt()));
    }
}
