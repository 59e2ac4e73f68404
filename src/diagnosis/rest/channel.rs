//! One channel and its model: laws of noise plus curves of known shape, fitted together.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::cause::Cause;
use super::followed::Followed;
use super::products::Products;
use super::spectrum::{self, Bin, Law, Part, Strengths};
use crate::numerics::cosine;
use crate::numerics::moments::mean;
use crate::recording::disturbance::Disturbances;

/// Times that curves and laws are fitted in turn.
const ROUNDS: usize = 4;
/// Part of the white level behind a filter that may be leakage.
const LEAKAGE: f64 = 0.05;

/// A channel, in units of its own scale so that all numbers are near one.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    pub(super) name: String,
    /// Words for its unit; "unit" where nothing states one.
    pub(super) unit: String,
    /// Uniform samples, mean removed, over `scale`.
    pub(super) values: Vec<f64>,
    /// Holds what was removed, in file units.
    pub(super) mean: f64,
    /// File units per unit here.
    pub(super) scale: f64,
    pub(super) rate_hz: f64,
    pub(super) coefficients: Arc<[f64]>,
    /// Step that the readings were rounded to before any averaging, where they were; in this scale.
    pub(super) step: Option<f64>,
    /// Readings averaged into one value.
    pub(super) together: usize,
    /// Holds what was taken out of it before; places among the readings, before any averaging.
    pub(super) disturbances: Disturbances,
    /// Variance that the datasheet promises to every bin, beyond white noise; empty for none.
    pub(super) promised: Vec<f64>,
}

/// A curve of known shape in the mean: its samples and their cosine coefficients.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) values: Arc<[f64]>,
    coefficients: Arc<[f64]>,
}

impl Curve {
    pub(super) fn new(mut values: Vec<f64>) -> Self {
        let mean = mean(&values);
        values.iter_mut().for_each(|v| *v -= mean);
        let coefficients = cosine::transform(&values).into();
        Self { values: values.into(), coefficients }
    }
}

/// Environment columns by name.
pub(super) type Environment = [(String, Curve)];

/// Something a candidate adds: a law, or one or two curves.
#[derive(Debug, Clone)]
pub(super) enum Addition {
    Law(Law),
    Curves(Vec<Curve>),
}

/// A candidate in a channel, with the number that was searched for (time constant, frequency).
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub(super) cause: Cause,
    pub(super) addition: Addition,
    /// Correlation time or time constant in samples; frequency in cycles per sample.
    pub(super) searched: f64,
    /// Environment column it follows.
    pub(super) column: Option<Followed>,
}

impl Term {
    /// Returns whether it follows this environment column.
    pub(super) fn follows(&self, column: &str) -> bool {
        self.column.as_ref().is_some_and(|f| f.column == column)
    }
}

/// A model fitted to a channel.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) terms: Vec<Term>,
    pub(super) strengths: Strengths,
    /// Per curve, in order of terms: value and standard error.
    pub(super) amplitudes: Vec<(f64, f64)>,
    /// Cosine coefficients without the curves.
    pub(super) residual: Arc<[f64]>,
    pub(super) bins: Vec<Bin>,
    pub(super) variances: Vec<f64>,
}

impl Fitted {
    /// Variance of every bin, not below a part of the white level: behind a filter hardly anything
    /// is left at some frequencies, and what is there is leakage, which must not decide.
    pub(super) fn safe_variances(&self) -> Vec<f64> {
        let least = match self.has(Cause::BandLimit) {
            true => LEAKAGE * self.white().0,
            false => 0.0,
        };
        self.variances.iter().map(|v| v.max(least)).collect()
    }

    pub(super) fn log_likelihood(&self) -> f64 {
        self.strengths.log_likelihood
    }

    /// Twice the log-likelihood that a model gains by one of its terms. A slow law counts only
    /// where the model without it has more than leakage: where a filter stops nearly all, what is
    /// there comes from the two ends of the log, and a law that takes it up has not been seen.
    pub(super) fn gain_over(&self, without: &Fitted, term: usize) -> f64 {
        let slow = matches!(self.terms[term].addition, Addition::Law(law) if law.is_low_frequency());
        if !slow || !without.has(Cause::BandLimit) {
            return 2.0 * (self.log_likelihood() - without.log_likelihood());
        }
        let safe = without.safe_variances();
        let told = |of: &Fitted| {
            let seen = of.bins.iter().zip(&of.variances).zip(without.variances.iter().zip(&safe));
            let (bins, variances): (Vec<Bin>, Vec<f64>) =
                seen.filter(|(_, (v, safe))| v >= safe).map(|((bin, v), _)| (*bin, *v)).unzip();
            spectrum::log_likelihood(&bins, &variances, Part::All)
        };
        2.0 * (told(self) - told(without))
    }

    pub(super) fn laws(&self) -> Vec<Law> {
        laws(&self.terms)
    }

    pub(super) fn has(&self, cause: Cause) -> bool {
        self.terms.iter().any(|t| t.cause == cause)
    }

    /// Returns where the amplitudes of a term's curves stand.
    pub(super) fn amplitudes_of(&self, term: usize) -> &[(f64, f64)] {
        let curves = |t: &Term| if let Addition::Curves(c) = &t.addition { c.len() } else { 0 };
        let start = self.terms[..term].iter().map(curves).sum();
        &self.amplitudes[start..start + curves(&self.terms[term])]
    }

    /// Variance and standard error of the white noise at frequencies that no filter in the sensor
    /// reaches.
    pub(super) fn white(&self) -> (f64, f64) {
        let (value, error) = (self.strengths.values[0], self.strengths.errors[0]);
        match self.terms.iter().position(|t| t.cause == Cause::BandLimit) {
            Some(index) => {
                let (more, own) = self.strength_of(index);
                (value + more, error.hypot(own))
            }
            None => (value, error),
        }
    }

    /// Variance of what is white within the sensor's band, as a mean over all frequencies.
    pub(super) fn floor(&self) -> f64 {
        let power = self.terms.iter().find_map(|t| match t.addition {
            Addition::Law(law @ Law::Filtered(_)) => Some(law),
            _ => None,
        });
        let white = self.strengths.values[0];
        let Some(law) = power else { return white };
        let (sum, count) = self.bins.iter().fold((0.0, 0.0), |(sum, count), b| {
            let width = (b.to - b.from) as f64;
            (sum + width * law.variance(b.theta), count + width)
        });
        white + (self.white().0 - white) * sum / count
    }

    /// Strength and standard error of a term that is a law.
    pub(super) fn strength_of(&self, term: usize) -> (f64, f64) {
        let law = self.terms[..term].iter().filter(|t| matches!(t.addition, Addition::Law(_))).count() + 1;
        (self.strengths.values[law], self.strengths.errors[law])
    }

    /// Sum of the fitted curves.
    pub(super) fn mean_curve(&self, count: usize) -> Vec<f64> {
        let mut out = vec![0.0; count];
        for (curve, (amplitude, _)) in curves(&self.terms).zip(&self.amplitudes) {
            out.iter_mut().zip(curve.values.iter()).for_each(|(o, v)| *o += amplitude * v);
        }
        out
    }

    /// Log-likelihood of each fold under laws fitted to the other.
    pub(super) fn held_out(&self, promised: &[f64]) -> f64 {
        let laws = self.laws();
        (0..2)
            .map(|fold| {
                let fitted = spectrum::fit(&self.bins, &laws, promised, Part::Fold(1 - fold));
                let variances = spectrum::variances(&self.bins, &laws, &fitted.values, promised);
                spectrum::log_likelihood(&self.bins, &variances, Part::Fold(fold))
            })
            .sum()
    }
}

fn laws(terms: &[Term]) -> Vec<Law> {
    let added = terms.iter().filter_map(|t| if let Addition::Law(law) = t.addition { Some(law) } else { None });
    std::iter::once(Law::White).chain(added).collect()
}

fn curves(terms: &[Term]) -> impl Iterator<Item = &Curve> {
    terms.iter().flat_map(|t| if let Addition::Curves(c) = &t.addition { &c[..] } else { &[] })
}

impl Channel {
    /// `scale` is estimated from differences of neighbours, which no drift reaches.
    pub(super) fn new(name: &str, values: &[f64], rate_hz: f64) -> Self {
        let mean = mean(values);
        let power = values.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2 * (values.len() - 1)) as f64;
        let scale = if power > 0.0 { power.sqrt() } else { 1.0 };
        let values: Vec<f64> = values.iter().map(|v| (v - mean) / scale).collect();
        let coefficients = cosine::transform(&values).into();
        Self {
            name: name.into(),
            unit: "unit".into(),
            mean,
            values,
            scale,
            rate_hz,
            coefficients,
            step: None,
            together: 1,
            disturbances: Disturbances::default(),
            promised: Vec::new(),
        }
    }

    /// Variance that rounding adds to a value.
    pub(super) fn rounding(&self) -> f64 {
        self.step.map_or(0.0, |q| q * q / 12.0 / self.together as f64)
    }

    /// Fits laws and curves together: curves by generalised least squares under the laws, in turn.
    pub(super) fn fit(&self, terms: Vec<Term>) -> Fitted {
        let laws = laws(&terms);
        let curves: Vec<&Curve> = curves(&terms).collect();
        let fitted_to = |bins: &[Bin]| {
            let strengths = spectrum::fit(bins, &laws, &self.promised, Part::All);
            let variances = spectrum::variances(bins, &laws, &strengths.values, &self.promised);
            (strengths, variances)
        };
        let mut bins = spectrum::bins(&self.coefficients);
        if curves.is_empty() {
            let (strengths, variances) = fitted_to(&bins);
            let residual = self.coefficients.clone();
            return Fitted { terms, strengths, amplitudes: Vec::new(), residual, bins, variances };
        }
        let all: Vec<&[f64]> =
            std::iter::once(&self.coefficients[..]).chain(curves.iter().map(|c| &c.coefficients[..])).collect();
        let products = Products::of(&all, &bins);
        let mut variances: Vec<f64> = vec![1.0; bins.len()];
        for _ in 1..ROUNDS {
            products.leave(&products.amplitudes(&variances), &mut bins);
            variances = fitted_to(&bins).1;
        }
        // The last round takes the curves from the coefficients themselves, where nothing cancels.
        let amplitudes = products.amplitudes(&variances);
        let mut residual = self.coefficients.to_vec();
        for (curve, (amplitude, _)) in curves.iter().zip(&amplitudes) {
            residual.iter_mut().zip(curve.coefficients.iter()).for_each(|(r, c)| *r -= amplitude * c);
        }
        let bins = spectrum::bins(&residual);
        let (strengths, variances) = fitted_to(&bins);
        Fitted { terms, strengths, amplitudes, residual: residual.into(), bins, variances }
    }

    /// Share of the mean square on every second of sixteen stretches that curves remove when fitted
    /// to the others.
    pub(super) fn held_out_share(&self, fitted: &Fitted, term: usize) -> f64 {
        let Addition::Curves(curves) = &fitted.terms[term].addition else { return 0.0 };
        let count = self.values.len();
        let others = {
            let mut without = fitted.clone();
            let start: usize = fitted.terms[..term]
                .iter()
                .map(|t| if let Addition::Curves(c) = &t.addition { c.len() } else { 0 })
                .sum();
            without.amplitudes[start..start + curves.len()].iter_mut().for_each(|a| a.0 = 0.0);
            without.mean_curve(count)
        };
        let rest: Vec<f64> = self.values.iter().zip(&others).map(|(v, o)| v - o).collect();
        let [_, [before, after]] = split(&rest, &curves.iter().collect::<Vec<_>>());
        1.0 - after / before
    }

    /// Sums of squares before and after all curves, fitted to every second of sixteen stretches: on
    /// those, then on the others, which they were not fitted to.
    pub(super) fn held_out_squares(&self, fitted: &Fitted) -> [[f64; 2]; 2] {
        // A jump has no name: what is named must predict without it.
        let named: Vec<Term> = fitted.terms.iter().filter(|t| t.cause != Cause::Jump).cloned().collect();
        split(&self.values, &curves(&named).collect::<Vec<_>>())
    }
}

/// Straight least squares of a constant and curves on the even of sixteen stretches: [even, odd],
/// each the sum of squares [about the even stretches' mean, about the fit].
fn split(values: &[f64], curves: &[&Curve]) -> [[f64; 2]; 2] {
    let count = values.len();
    let stretch = |n: usize| n * 16 / count % 2;
    let width = curves.len() + 1;
    let design = |n: usize, p: usize| if p == 0 { 1.0 } else { curves[p - 1].values[n] };
    let (mut normal, mut target) = (DMatrix::<f64>::zeros(width, width), DVector::<f64>::zeros(width));
    for n in (0..count).filter(|n| stretch(*n) == 0) {
        for p in 0..width {
            target[p] += design(n, p) * values[n];
            for q in 0..width {
                normal[(p, q)] += design(n, p) * design(n, q);
            }
        }
    }
    let mean = target[0] / normal[(0, 0)];
    let solution = normal.lu().solve(&target).unwrap_or_else(|| DVector::zeros(width));
    let mut out = [[0.0; 2]; 2];
    for (n, value) in values.iter().enumerate() {
        let predicted: f64 = (0..width).map(|p| solution[p] * design(n, p)).sum();
        out[stretch(n)][0] += (value - mean).powi(2);
        out[stretch(n)][1] += (value - predicted).powi(2);
    }
    out
}
