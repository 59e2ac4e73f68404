//! Residuals of a reference against dead reckoning, and their slopes by every parameter, as evenly
//! spaced rows.
//!
//! Means over bins of some poses, differenced until what dead reckoning cannot know (where it
//! began, how fast) is gone: attitude once, position twice, and to the sides three times where
//! attitude wanders and gravity with it. Not for what stands in them: `attitude`, `position`,
//! `along_gyro`.

use nalgebra::Vector3;

use super::parameters::PARAMETERS;

/// One vector of the residual, and its slopes.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Time of its middle on the reference's clock, s.
    pub time_s: f64,
    /// Residual; its three components are north, east and down.
    pub residual: Vector3<f64>,
    /// Its derivative by each parameter.
    pub slope: Box<[Vector3<f64>; PARAMETERS]>,
    /// States whether every pose and reading that it needs is there.
    pub holds: bool,
}

/// States how poses are gathered into bins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bins {
    /// From one to the next, s.
    pub width_s: f64,
    /// Bin of each pose.
    pub of: Vec<usize>,
    /// Number of poses in each bin.
    pub count: Vec<usize>,
    /// Begin of the first, s.
    pub start_s: f64,
    /// Mean time of the poses of each, s.
    middle_s: Vec<f64>,
}

/// Share of the usual number of poses that a bin needs.
const FULL: f64 = 0.5;

impl Bins {
    /// Over poses at these times, about as wide as wanted.
    pub(super) fn over(time_s: &[f64], width_s: f64) -> Self {
        let start_s = time_s.first().copied().unwrap_or_default();
        let of: Vec<usize> = time_s.iter().map(|t| ((t - start_s) / width_s + 1e-6).max(0.0) as usize).collect();
        // The last bin is cut short.
        let bins = of.last().copied().unwrap_or_default();
        let mut count = vec![0; bins];
        of.iter().filter(|b| **b < bins).for_each(|b| count[*b] += 1);
        let mut middle_s = vec![0.0; bins];
        of.iter().zip(time_s).filter(|(b, _)| **b < bins).for_each(|(b, t)| middle_s[*b] += t / count[*b] as f64);
        for (k, middle_s) in middle_s.iter_mut().enumerate().filter(|(k, _)| count[*k] == 0) {
            *middle_s = start_s + (k as f64 + 0.5) * width_s;
        }
        Self { width_s, of, count, start_s, middle_s }
    }

    /// Means of values that stand at the poses.
    pub(super) fn means(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut sums = vec![Vector3::zeros(); self.count.len()];
        for (bin, value) in self.of.iter().zip(values) {
            if let Some(sum) = sums.get_mut(*bin) {
                *sum += value;
            }
        }
        sums.iter().zip(&self.count).map(|(sum, n)| sum / (*n).max(1) as f64).collect()
    }

    /// Returns whether each bin has its poses, and nothing that is left out lies in it.
    fn whole(&self, left_out_s: &[f64]) -> Vec<bool> {
        let usual = crate::numerics::order::median(self.count.iter().map(|n| *n as f64).collect()).unwrap_or(1.0);
        let mut whole: Vec<bool> = self.count.iter().map(|n| *n as f64 >= (FULL * usual).max(1.0)).collect();
        for time_s in left_out_s {
            let bin = ((time_s - self.start_s) / self.width_s).floor();
            if bin >= 0.0
                && let Some(whole) = whole.get_mut(bin as usize)
            {
                *whole = false;
            }
        }
        whole
    }
}

/// States how often the bin means of each axis are differenced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Orders {
    /// By axis.
    pub of: [usize; 3],
    /// Holds what is taken for the time from one bin to the next.
    pub spacing: Spacing,
}

/// The time from one bin to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spacing {
    /// The width of a bin.
    Width,
    /// From the mean time of one bin's poses to that of the next: poses that stand a little uneven
    /// leave nothing of a velocity that the reference does not know.
    Middles,
}

impl Orders {
    fn least(self) -> usize {
        self.of.into_iter().min().unwrap_or_default()
    }

    fn most(self) -> usize {
        self.of.into_iter().max().unwrap_or_default()
    }

    /// Groups of axes whose noise has one colour.
    pub(super) fn groups(self) -> Vec<Vec<usize>> {
        let mut orders = self.of.to_vec();
        orders.sort_unstable();
        orders.dedup();
        orders.into_iter().map(|order| (0..3).filter(|axis| self.of[*axis] == order).collect()).collect()
    }
}

/// Differences of bin means, over the time between bins to the power of the least order.
pub(super) fn differenced(means: &[Vector3<f64>], orders: Orders, bins: &Bins) -> Vec<Vector3<f64>> {
    let mut values = means.to_vec();
    let mut at_s = bins.middle_s.clone();
    for _ in 0..orders.least() {
        let steps = at_s.windows(2).map(|t| match orders.spacing {
            Spacing::Width => bins.width_s,
            Spacing::Middles => t[1] - t[0],
        });
        values = values.windows(2).zip(steps).map(|(v, step_s)| (v[1] - v[0]) / step_s).collect();
        at_s = at_s.windows(2).map(|t| 0.5 * (t[0] + t[1])).collect();
    }
    for order in orders.least()..orders.most() {
        let more = |v: &[Vector3<f64>]| {
            Vector3::from_fn(|axis, _| if orders.of[axis] > order { v[1][axis] - v[0][axis] } else { v[0][axis] })
        };
        values = values.windows(2).map(more).collect();
    }
    values
}

/// Rows out of a residual and its slopes, each given at the poses; those do not hold that need a
/// bin with a time that is left out, on the clock of the poses.
pub(super) fn rows(
    left_out_s: &[f64],
    bins: &Bins,
    orders: Orders,
    residual: &[Vector3<f64>],
    slopes: &[Option<Vec<Vector3<f64>>>],
) -> Vec<Row> {
    let of = |values: &[Vector3<f64>]| differenced(&bins.means(values), orders, bins);
    let residual = of(residual);
    let slopes: Vec<Option<Vec<Vector3<f64>>>> = slopes.iter().map(|s| s.as_deref().map(of)).collect();
    let whole = bins.whole(left_out_s);
    let order = orders.most();
    let row = |(k, residual): (usize, &Vector3<f64>)| Row {
        time_s: bins.start_s + (k as f64 + 0.5 * (order + 1) as f64) * bins.width_s,
        residual: *residual,
        slope: Box::new(std::array::from_fn(|p| slopes[p].as_ref().map_or(Vector3::zeros(), |s| s[k]))),
        holds: whole[k..=k + order].iter().all(|w| *w),
    };
    residual.iter().enumerate().map(row).collect()
}
