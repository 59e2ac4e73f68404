//! Uncertainty of an Allan curve: the covariance of its points for any mixture of the five terms.
//!
//! For a Gaussian signal two points vary together as 2/(n_i n_j) Σ R_ij(u)², R_ij being the
//! covariance of the second differences behind them, summed over all pairs of windows. R_ij is
//! known in closed form for every term (`law`), so this is the combined estimate of equivalent
//! degrees of freedom by Greenhall & Riley (PTTI 2003), taken for mixtures and for pairs of
//! averaging times. Lags are summed in steps of an eighth of the shorter time.

use super::law::{TERMS, Term};
use crate::numerics::order;

/// Lags per shorter averaging time.
const LAGS: usize = 8;
/// Points whose averaging times differ by more than this factor are taken as uncorrelated (it is
/// below 3 %).
const REACH: usize = 64;

/// Covariances of a set of points as a quadratic form in the squared coefficients.
#[derive(Debug, Clone)]
pub struct Covariance {
    count: usize,
    taus_s: Vec<f64>,
    /// Per pair of points (row-major), per pair of terms: 2/(n_i n_j) Σ R_p R_q.
    products: Vec<[[f64; 4]; 4]>,
    /// Per pair of points, per term: 1/(n_i n_j) Σ R_p, what a ramp is multiplied by.
    sums: Vec<[f64; 4]>,
    /// Relative variance of the realised square of white noise beyond that of normal noise.
    tails: f64,
}

impl Covariance {
    /// For points at these averaging factors, each measured over this many samples.
    pub fn new(factors: &[usize], samples: &[usize], rate_hz: f64) -> Self {
        let count = factors.len();
        let mut products = vec![[[0.0; 4]; 4]; count * count];
        let mut sums = vec![[0.0; 4]; count * count];
        for i in 0..count {
            for j in i..count {
                if factors[j] > REACH * factors[i] {
                    continue;
                }
                let pair = Pair::new([factors[i], factors[j]], [samples[i], samples[j]], rate_hz);
                let (product, sum) = pair.sums();
                for at in [i * count + j, j * count + i] {
                    products[at] = product;
                    sums[at] = sum;
                }
            }
        }
        let taus_s = factors.iter().map(|m| *m as f64 / rate_hz).collect();
        Self { count, taus_s, products, sums, tails: 0.0 }
    }

    /// For white noise with heavy tails: `tails` is its excess kurtosis over the number of samples. By so much the
    /// mean square of the samples varies beyond 2/n, relative to its square, and all points with it.
    pub fn with_tails(self, tails: f64) -> Self {
        Self { tails, ..self }
    }

    /// Covariance of points `i` and `j` for these squared coefficients (order of [`TERMS`]).
    pub(crate) fn at(&self, i: usize, j: usize, squares: &[f64; 5]) -> f64 {
        let pair = i * self.count + j;
        let mut out = 0.0;
        for (p, row) in self.products[pair].iter().enumerate() {
            for (q, product) in row.iter().enumerate() {
                out += squares[p] * squares[q] * product;
            }
        }
        let white = |i: usize| squares[Term::White as usize] * Term::White.variance(self.taus_s[i]);
        out += self.tails * white(i) * white(j);
        let ramp = squares[4] * self.taus_s[i] * self.taus_s[j] / 2.0;
        out + 4.0 * ramp * self.sums[pair].iter().zip(squares).map(|(s, square)| s * square).sum::<f64>()
    }

    /// Equivalent degrees of freedom of point `i`: twice its squared expectation over its variance.
    pub fn degrees_of_freedom(&self, i: usize, squares: &[f64; 5]) -> f64 {
        2.0 * super::law::variance(squares, self.taus_s[i]).powi(2) / self.at(i, i, squares)
    }
}

/// Two points of the curve.
struct Pair {
    factors: [f64; 2],
    windows: [f64; 2],
    tick_s: f64,
}

impl Pair {
    fn new(factors: [usize; 2], samples: [usize; 2], rate_hz: f64) -> Self {
        let windows = [0, 1].map(|i| (samples[i] + 1).saturating_sub(2 * factors[i]).max(1) as f64);
        Self { factors: factors.map(|m| m as f64), windows, tick_s: 1.0 / rate_hz }
    }

    /// Covariance of the scaled second differences, one from each point, whose windows begin `lag`
    /// samples apart.
    fn covariance(&self, term: Term, lag: f64) -> f64 {
        let [m, n] = self.factors;
        let mut sum = 0.0;
        for (a, weight_a) in [(0.0, 1.0), (1.0, -2.0), (2.0, 1.0)] {
            for (b, weight_b) in [(0.0, 1.0), (1.0, -2.0), (2.0, 1.0)] {
                sum += weight_a * weight_b * term.integral_covariance((lag + b * n - a * m) * self.tick_s);
            }
        }
        sum / (2.0 * m * n * self.tick_s * self.tick_s)
    }

    /// Number of pairs of windows that begin `lag` apart.
    fn pairs(&self, lag: f64) -> f64 {
        let [n_i, n_j] = self.windows;
        (n_j.min(n_i + lag) - lag.max(0.0)).max(0.0)
    }

    fn sums(&self) -> ([[f64; 4]; 4], [f64; 4]) {
        let mut product = [[0.0; 4]; 4];
        let mut sum = [0.0; 4];
        let [m, n] = self.factors;
        let mut add = |lag: f64, weight: f64, quantisation: bool| {
            let pairs = weight * self.pairs(lag);
            if pairs <= 0.0 {
                return;
            }
            let r: [f64; 4] = std::array::from_fn(|p| self.covariance(TERMS[p], lag));
            for p in 0..4 {
                for q in 0..4 {
                    // Quantisation correlates at single lags only: those are visited one by one.
                    if (p == 0 || q == 0) == quantisation {
                        product[p][q] += pairs * r[p] * r[q];
                    }
                }
                if (p == 0) == quantisation {
                    sum[p] += pairs * r[p];
                }
            }
        };
        // Beyond, white and walking windows share nothing and flickering ones little. Windows
        // centred on each other begin m − n apart.
        let step = (m / LAGS as f64).floor().max(1.0);
        let reach = (3.0 * (m + n) / step).ceil() as i64;
        for k in -reach..=reach {
            add(m - n + k as f64 * step, step, false);
        }
        let mut single: Vec<f64> =
            [0.0, 1.0, 2.0].iter().flat_map(|a| [0.0, 1.0, 2.0].map(|b| a * m - b * n)).collect();
        order::sort(&mut single);
        single.dedup();
        single.iter().for_each(|lag| add(*lag, 1.0, true));
        let all = self.windows[0] * self.windows[1];
        (product.map(|row| row.map(|v| 2.0 * v / all)), sum.map(|v| v / all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees_of_freedom(term: Term, factor: usize, samples: usize) -> f64 {
        let mut squares = [0.0; 5];
        squares[term as usize] = 1.0;
        Covariance::new(&[factor], &[samples], 1.0).degrees_of_freedom(0, &squares)
    }

    // Independent arithmetic: for white noise at m = 1 the second difference is y₁ − y₀, whose
    // square correlates by 1/4 with its neighbours, so the variance of the mean of n squares is
    // 2(1 + 2·(1/4)(n − 1)/n)/n.
    #[test]
    fn white_noise_at_one_sample() {
        let n = 99.0;
        let want = n / (1.0 + 0.5 * (n - 1.0) / n);
        assert!((degrees_of_freedom(Term::White, 1, 100) / want - 1.0).abs() < 1e-9);
    }

    // NIST SP 1065, section 5.4.1: approximate degrees of freedom of the overlapping Allan
    // variance, white FM [3(N−1)/2m − 2(N−2)/N] 4m²/(4m²+5); flicker FM 5N²/[4m(N+3m)]; random walk
    // FM (N−2)/m · [(N−1)² − 3m(N−1) + 4m²]/(N−3)². N counts phase points. Stated there to be good
    // to several per cent.
    #[test]
    fn degrees_of_freedom_follow_the_published_approximations() {
        for (factor, samples) in [(8, 1000), (32, 1000), (100, 1000)] {
            let (m, n) = (factor as f64, samples as f64 + 1.0);
            let white = (1.5 * (n - 1.0) / m - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
            let flicker = 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
            let walk = (n - 2.0) / m * ((n - 1.0).powi(2) - 3.0 * m * (n - 1.0) + 4.0 * m * m) / (n - 3.0).powi(2);
            for (term, want) in [(Term::White, white), (Term::Flicker, flicker), (Term::Walk, walk)] {
                let got = degrees_of_freedom(term, factor, samples);
                assert!((got / want - 1.0).abs() < 0.1, "{term:?} m = {m}: {got} against {want}");
            }
        }
    }
}
