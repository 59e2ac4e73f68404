//! The overlapping Allan deviation of a stream of any length in a few hundred kilobytes.
//!
//! Up to 128 samples the estimator is fully overlapped. Above, the integrated signal is thinned by
//! powers of two, so that an averaging time always spans 80 to 128 kept points: windows start every
//! 1/128 to 1/80 of the averaging time instead of at every sample. The equivalent degrees of
//! freedom saturate at about 8 starts per averaging time (Greenhall & Riley, *Uncertainty of
//! stability variances based on finite differences*, PTTI 2003), so nothing measurable is lost.
//!
//! Definition (IEEE 952, NIST SP 1065): with x the integral of the signal, σ²(τ = mτ₀) = ⟨(x_{k+2m}
//! − 2x_{k+m} + x_k)²⟩ / (2 m² τ₀²). Laws: `law`; uncertainty: `covariance`; coefficients: `fit`.
//!
//! Of readings 1, −1, 1, −1, … the variance is 2 at one sample and 0 over any two:
//!
//! ```
//! use proofmass_numerics::numerics::allan::Accumulator;
//!
//! let mut allan = Accumulator::new();
//! (0..1000).for_each(|i| allan.push(if i % 2 == 0 { 1.0 } else { -1.0 }));
//! let curve = allan.points(100.0);
//! assert_eq!((curve[0].tau_s, curve[0].variance), (0.01, 2.0));
//! assert_eq!((curve[1].tau_s, curve[1].variance), (0.02, 0.0));
//! ```

pub mod covariance;
pub mod fit;
pub mod fitted;
pub mod law;

/// Averaging factors of the first level, about ten per decade.
const FIRST: [usize; 19] = [1, 2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 25, 32, 40, 50, 64, 80, 100, 128];
/// Averaging factors of every further level, in its own points.
const FURTHER: [usize; 3] = [80, 100, 128];
/// Points that the longest window of a level looks back on.
const KEPT: usize = 256;
const BLOCK: usize = KEPT + 1024;
/// 2³¹ × 128 samples are years at any rate.
const LEVELS: usize = 32;

/// Averaging time, Allan variance and sample count of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Averaging time in samples.
    pub factor: usize,
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan variance, unit of the samples squared.
    pub variance: f64,
    /// Samples that the windows behind it span, over all parts of the recording.
    pub samples: usize,
}

impl Point {
    /// Returns whether it stands on the octave grid that fits use: neighbours there are only weakly
    /// correlated.
    pub fn on_octave(&self) -> bool {
        self.factor.is_power_of_two()
    }
}

/// An Allan curve being accumulated.
#[derive(Debug, Clone)]
pub struct Accumulator {
    levels: Vec<Level>,
    origin: Option<f64>,
    phase: f64,
    index: usize,
    count: usize,
}

impl Default for Accumulator {
    fn default() -> Self {
        Self::new()
    }
}

impl Accumulator {
    /// Starts an empty curve.
    pub fn new() -> Self {
        let levels = (0..LEVELS).map(|l| Level::new(if l == 0 { &FIRST } else { &FURTHER })).collect();
        Self { levels, origin: None, phase: 0.0, index: 0, count: 0 }
    }

    /// Adds the next sample.
    pub fn push(&mut self, value: f64) {
        // The first value is taken off so that a large constant costs no digits in the running
        // integral.
        let origin = *self.origin.get_or_insert(value);
        if self.index == 0 {
            self.keep_phase();
        }
        self.phase += value - origin;
        self.index += 1;
        self.count += 1;
        self.keep_phase();
    }

    fn keep_phase(&mut self) {
        let thinned = (self.index.trailing_zeros() as usize).min(LEVELS - 1);
        for level in &mut self.levels[..=thinned] {
            level.push(self.phase);
        }
    }

    /// The recording breaks off here: no window reaches across.
    pub fn interrupt(&mut self) {
        for level in &mut self.levels {
            level.digest();
            level.phases.clear();
            level.fresh = 0;
        }
        (self.index, self.phase) = (0, 0.0);
    }

    /// The curve, by rising averaging time; it ends where an averaging time is longer than a third
    /// of the recording.
    pub fn points(&self, rate_hz: f64) -> Vec<Point> {
        let mut points = Vec::new();
        for (l, level) in self.levels.iter().enumerate() {
            let mut level = level.clone();
            level.digest();
            for ((factor, sum), windows) in level.factors.iter().zip(&level.sums).zip(&level.windows) {
                let factor = factor << l;
                if *windows == 0 || factor > self.count / 3 {
                    continue;
                }
                let variance = sum / *windows as f64 / (2.0 * (factor as f64).powi(2));
                let samples = (windows << l) + 2 * factor - (1 << l);
                points.push(Point { factor, tau_s: factor as f64 / rate_hz, variance, samples });
            }
        }
        points
    }
}

/// The curve of a sequence in memory.
pub fn curve(values: &[f64], rate_hz: f64) -> Vec<Point> {
    let mut accumulator = Accumulator::new();
    values.iter().for_each(|v| accumulator.push(*v));
    accumulator.points(rate_hz)
}

#[derive(Debug, Clone)]
struct Level {
    factors: &'static [usize],
    sums: Vec<f64>,
    windows: Vec<usize>,
    phases: Vec<f64>,
    /// Phases before this one have ended a window already.
    fresh: usize,
}

impl Level {
    fn new(factors: &'static [usize]) -> Self {
        let (sums, windows) = (vec![0.0; factors.len()], vec![0; factors.len()]);
        Self { factors, sums, windows, phases: Vec::new(), fresh: 0 }
    }

    fn push(&mut self, phase: f64) {
        self.phases.push(phase);
        if self.phases.len() == BLOCK {
            self.digest();
            self.phases.copy_within(BLOCK - KEPT.., 0);
            self.phases.truncate(KEPT);
            self.fresh = KEPT;
        }
    }

    fn digest(&mut self) {
        let x = &self.phases;
        for ((m, sum), windows) in self.factors.iter().zip(&mut self.sums).zip(&mut self.windows) {
            let start = self.fresh.max(2 * m);
            if start >= x.len() {
                continue;
            }
            let (late, middle, early) = (&x[start..], &x[start - m..], &x[start - 2 * m..]);
            *sum += squares(late, middle, early);
            *windows += late.len();
        }
        self.fresh = x.len();
    }
}

/// Sum of the squared second differences, in eight sums at a time: one would wait for itself at
/// every term.
fn squares(late: &[f64], middle: &[f64], early: &[f64]) -> f64 {
    let square = |l: f64, m: f64, e: f64| (l - 2.0 * m + e).powi(2);
    let (late, late_rest) = late.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (k, l) in late.iter().enumerate() {
        let (m, e) = (&middle[8 * k..8 * k + 8], &early[8 * k..8 * k + 8]);
        for lane in 0..8 {
            sums[lane] += square(l[lane], m[lane], e[lane]);
        }
    }
    let done = 8 * late.len();
    let rest = late_rest.iter().zip(&middle[done..]).zip(&early[done..]).map(|((l, m), e)| square(*l, *m, *e));
    sums.iter().sum::<f64>() + rest.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thousand-point set of NBS Monograph 140 Annex 8.E, as generated in NIST SP 1065 (Riley
    /// 2008), section 12.4.
    fn nbs14() -> Vec<f64> {
        let mut n: u64 = 1_234_567_890;
        (0..1000)
            .map(|_| {
                let value = n as f64 / 2_147_483_647.0;
                n = 16_807 * n % 2_147_483_647;
                value
            })
            .collect()
    }

    // NIST SP 1065, table 31: overlapping Allan deviation of the 1000-point frequency data at τ =
    // 1, 10, 100.
    #[test]
    fn published_overlapping_deviations() {
        let curve = curve(&nbs14(), 1.0);
        for (tau, published) in [(1, 2.922319e-1), (10, 9.159953e-2), (100, 3.241343e-2)] {
            let point = curve.iter().find(|p| p.factor == tau).expect("on the grid");
            assert!((point.variance.sqrt() - published).abs() < 1e-7, "{tau}: {}", point.variance.sqrt());
        }
        let wrong = curve.iter().find(|p| p.factor == 10).expect("on the grid").variance.sqrt();
        assert!((wrong - 9.965736e-2).abs() > 1e-3, "9.965736e-2 is the deviation without overlap");
    }

    /// The definition, term by term.
    fn by_definition(values: &[f64], m: usize, stride: usize) -> f64 {
        let mut x = vec![0.0];
        values.iter().for_each(|v| x.push(x[x.len() - 1] + v));
        let terms: Vec<f64> =
            (0..x.len() - 2 * m).step_by(stride).map(|k| (x[k + 2 * m] - 2.0 * x[k + m] + x[k]).powi(2)).collect();
        terms.iter().sum::<f64>() / terms.len() as f64 / (2.0 * (m * m) as f64)
    }

    #[test]
    fn streaming_is_the_definition_and_thinning_changes_little() {
        let mut values = nbs14();
        for round in 1..8 {
            values.extend(nbs14().iter().map(|v| v * 0.9f64.powi(round) + 0.1));
        }
        for point in curve(&values, 1.0) {
            let stride = point.factor.div_ceil(128).next_power_of_two();
            let exact = by_definition(&values, point.factor, stride);
            assert!((point.variance / exact - 1.0).abs() < 1e-9, "{}", point.factor);
            let full = by_definition(&values, point.factor, 1);
            assert!((point.variance / full - 1.0).abs() < 2e-2, "{}: {} of {full}", point.factor, point.variance);
        }
    }

    #[test]
    fn no_window_reaches_across_an_interruption() {
        let values = nbs14();
        let mut apart = Accumulator::new();
        values.iter().for_each(|v| apart.push(*v));
        apart.interrupt();
        values.iter().for_each(|v| apart.push(*v + 1000.0));
        let whole = curve(&values, 1.0);
        for (a, b) in apart.points(1.0).iter().zip(&whole) {
            assert!((a.variance / b.variance - 1.0).abs() < 1e-6, "{}", a.factor);
        }
    }

    #[test]
    fn nothing_and_one_sample_give_no_points() {
        assert!(curve(&[], 1.0).is_empty() && curve(&[1.0], 1.0).is_empty());
    }
}
