//! Statistics of a trial: exact intervals for proportions, the size at which nine of ten effects are
//! noticed, a median.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};

/// The middle one of the finite values, the upper of an even number; zero where there are none.
///
/// The trial's own: what generates and scores shares no numerics with what is tested.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// A proportion of cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Proportion {
    /// Hits over cases; zero when there are none.
    pub value: f64,
    /// Exact 95 % interval (Clopper & Pearson, Biometrika 26, 1934).
    pub ci95: [f64; 2],
    /// Cases that count as hits.
    #[serde(skip)]
    pub hits: usize,
    /// All cases.
    #[serde(skip)]
    pub cases: usize,
}

impl Proportion {
    /// `hits` of `cases`.
    pub fn of(hits: usize, cases: usize) -> Self {
        let quantile =
            |a: usize, b: usize, p: f64| Beta::new(a as f64, b as f64).map_or(f64::NAN, |beta| beta.inverse_cdf(p));
        let low = if hits == 0 { 0.0 } else { quantile(hits, cases - hits + 1, 0.025) };
        let high = if hits == cases { 1.0 } else { quantile(hits + 1, cases - hits, 0.975) };
        Self { value: hits as f64 / cases.max(1) as f64, ci95: [low, high], hits, cases }
    }

    /// Counts the true ones.
    pub fn over(hits: impl IntoIterator<Item = bool>) -> Self {
        let (mut count, mut cases) = (0, 0);
        for hit in hits {
            count += usize::from(hit);
            cases += 1;
        }
        Self::of(count, cases)
    }
}

/// A detection curve p = 1/(1 + e^(−slope·(ln size − middle))).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Curve {
    /// ln size of half power.
    pub middle: f64,
    /// Steepness per unit of ln size.
    pub slope: f64,
}

/// The most probable detection curve and all that are not refuted at 95 %.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Power {
    pub best: Curve,
    /// Within 1.92 of its log-likelihood: half the 95 % quantile of chi-square with one degree of
    /// freedom.
    likely: Vec<Curve>,
}

impl Curve {
    /// Log-probability of (size, noticed) pairs; the slope is held near 3 by a log-normal prior of
    /// one unit, because few cases per effect cannot tell it.
    fn score(self, cases: &[(f64, bool)]) -> f64 {
        let fit: f64 = cases
            .iter()
            .map(|(size, hit)| {
                let x = self.slope * (size.ln() - self.middle);
                // ln of the logistic function, without overflow.
                let toward = if *hit { -x } else { x };
                -(toward.max(0.0) + (-toward.abs()).exp().ln_1p())
            })
            .sum();
        fit - 0.5 * (self.slope / 3.0).ln().powi(2)
    }

    /// Size found with this power.
    pub(crate) fn size_at(&self, power: f64) -> f64 {
        (self.middle + (power / (1.0 - power)).ln() / self.slope).exp()
    }

    /// Power at a size.
    pub(crate) fn power_at(&self, size: f64) -> f64 {
        1.0 / (1.0 + (-self.slope * (size.ln() - self.middle)).exp())
    }
}

impl Power {
    /// Fits curves on a grid. None when nothing, or everything, was noticed: there is no limit in
    /// range.
    pub(crate) fn fit(cases: &[(f64, bool)]) -> Option<Self> {
        let noticed = cases.iter().filter(|c| c.1).count();
        if noticed == 0 || noticed == cases.len() {
            return None;
        }
        let sizes = || cases.iter().map(|c| c.0.ln());
        let (low, high) =
            (sizes().fold(f64::INFINITY, f64::min) - 1.0, sizes().fold(f64::NEG_INFINITY, f64::max) + 1.0);
        let middles = (0..=120).map(|i| low + (high - low) * f64::from(i) / 120.0);
        let curves = middles
            .flat_map(|middle| (0..=30).map(move |j| Curve { middle, slope: 0.5 * 24f64.powf(f64::from(j) / 30.0) }));
        let scored: Vec<(f64, Curve)> = curves.map(|curve| (curve.score(cases), curve)).collect();
        let (top, best) = *scored.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let likely = scored.into_iter().filter(|(score, _)| top - score <= 1.92).map(|(_, curve)| curve).collect();
        Some(Self { best, likely })
    }

    fn range(&self, of: impl Fn(&Curve) -> f64) -> [f64; 2] {
        let values = || self.likely.iter().map(&of);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// 95 % interval of the size found with this power.
    pub(crate) fn size_ci95(&self, power: f64) -> [f64; 2] {
        self.range(|curve| curve.size_at(power))
    }

    /// 95 % interval of the power at a size.
    pub(crate) fn power_ci95(&self, size: f64) -> [f64; 2] {
        self.range(|curve| curve.power_at(size))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Clopper & Pearson: 0 of 300 has the upper limit 1 − 0.025^(1/300) = 0.01222; 3 of 10 is
    // [0.0667, 0.6525].
    #[test]
    fn exact_intervals_match_the_tables() {
        assert!((Proportion::of(0, 300).ci95[1] - 0.012_22).abs() < 1e-5);
        let share = Proportion::of(3, 10);
        assert!((share.ci95[0] - 0.066_74).abs() < 1e-4 && (share.ci95[1] - 0.652_45).abs() < 1e-4, "{share:?}");
        assert_eq!(Proportion::of(5, 5).ci95[1], 1.0);
    }

    #[test]
    fn a_curve_finds_the_size_where_noticing_begins() {
        let cases: Vec<(f64, bool)> = (0..200).map(|k| 0.01 * 1.04f64.powi(k)).map(|s| (s, s > 0.2)).collect();
        let power = Power::fit(&cases).expect("both kinds");
        let (limit, [low, high]) = (power.best.size_at(0.9), power.size_ci95(0.9));
        assert!((0.15..0.35).contains(&limit), "{limit}");
        assert!(low <= limit && limit <= high && high < 2.0 * low, "{low} {high}");
        assert!(Power::fit(&[(1.0, true), (2.0, true)]).is_none());
    }
}
