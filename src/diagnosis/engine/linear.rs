//! A linearised model in which each segment has a start of its own: normal equations with the starts
//! eliminated, and the residual of every block under the fit to all others.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::numerics::moments::dot;

use super::kind::{Layout, Linearised};

/// Relative ridge that keeps directions without effect from being followed.
const RIDGE: f64 = 1e-10;

/// Products of all columns: starts, shared coordinates, residual, in this order.
#[derive(Debug, Clone)]
pub(crate) struct Products {
    starts: usize,
    shared: usize,
    /// Of each block.
    blocks: Vec<DMatrix<f64>>,
    /// Of each segment.
    segments: Vec<DMatrix<f64>>,
}

/// A segment's products with its start eliminated.
struct Reduced {
    /// Products of the shared columns and the residual.
    products: DMatrix<f64>,
    /// Start coordinates that go with each of those columns.
    starts: DMatrix<f64>,
}

/// A step from a linearised model.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    /// Of the shared coordinates.
    pub shared: DVector<f64>,
    /// Of each segment's start.
    pub starts: Vec<DVector<f64>>,
}

/// Every block as the fit to all other blocks predicts it.
#[derive(Debug, Clone)]
pub(crate) struct LeftOut {
    /// Residual row by row; zero where a row does not count.
    pub residual: Vec<f64>,
    /// Step of the shared coordinates that leaving each block out causes.
    pub steps: Vec<DVector<f64>>,
}

/// Solves a symmetric system after scaling; directions without effect stay still.
fn solve(matrix: &DMatrix<f64>, right: &DMatrix<f64>, damping: f64) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    if n == 0 {
        return Some(right.clone());
    }
    let size: Vec<f64> = (0..n).map(|i| matrix[(i, i)].max(0.0).sqrt().max(1e-150)).collect();
    let mut scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (size[i] * size[j]));
    for i in 0..n {
        scaled[(i, i)] = 1.0 + damping + RIDGE;
    }
    let right = DMatrix::from_fn(n, right.ncols(), |i, j| right[(i, j)] / size[i]);
    let mut solved = scaled.cholesky()?.solve(&right);
    for (i, size) in size.iter().enumerate() {
        solved.row_mut(i).scale_mut(1.0 / size);
    }
    solved.iter().all(|v| v.is_finite()).then_some(solved)
}

impl Products {
    /// Of a model whose coordinates in `held` do not move.
    pub(crate) fn of(layout: &Layout, model: &Linearised, held: &[bool]) -> Self {
        let (starts, shared) = (model.starts.len(), model.shared.len());
        let columns: Vec<&[f64]> = model
            .starts
            .iter()
            .chain(&model.shared)
            .chain(std::iter::once(&model.residual))
            .map(Vec::as_slice)
            .collect();
        let still = |i: usize| i >= starts && held.get(i - starts).copied().unwrap_or(false);
        let of = |rows: &Range<usize>| {
            let mut products = DMatrix::zeros(columns.len(), columns.len());
            for i in 0..columns.len() {
                for j in 0..=i {
                    if !(still(i) || still(j)) {
                        let value = dot(&columns[i][rows.clone()], &columns[j][rows.clone()]);
                        (products[(i, j)], products[(j, i)]) = (value, value);
                    }
                }
            }
            products
        };
        let blocks: Vec<DMatrix<f64>> = layout.blocks.iter().map(of).collect();
        let mut segments = vec![DMatrix::zeros(columns.len(), columns.len()); layout.segments.len()];
        for (block, owner) in blocks.iter().zip(&layout.owner) {
            segments[*owner] += block;
        }
        Self { starts, shared, blocks, segments }
    }

    /// With the products of further shared columns, behind those of the model.
    pub(crate) fn with(&self, layout: &Layout, model: &Linearised, further: &[&Vec<f64>]) -> Self {
        let (known, more) = (self.starts + self.shared, further.len());
        let columns: Vec<&[f64]> = model.starts.iter().chain(&model.shared).map(Vec::as_slice).collect();
        let place = |i: usize| if i < known { i } else { known + more };
        let of = |(rows, before): (&Range<usize>, &DMatrix<f64>)| {
            let mut products = DMatrix::zeros(known + more + 1, known + more + 1);
            for i in 0..=known {
                for j in 0..=known {
                    products[(place(i), place(j))] = before[(i, j)];
                }
            }
            for (n, column) in further.iter().enumerate() {
                let at = known + n;
                let mut set = |i: usize, other: &[f64]| {
                    let value = dot(&column[rows.clone()], &other[rows.clone()]);
                    (products[(at, i)], products[(i, at)]) = (value, value);
                };
                // What is held has no products at all.
                let moves = |i: &usize| before[(*i, *i)] > 0.0;
                (0..known).filter(moves).for_each(|i| set(i, columns[i]));
                further[..=n].iter().enumerate().for_each(|(m, other)| set(known + m, other));
                set(known + more, &model.residual);
            }
            products
        };
        let blocks: Vec<DMatrix<f64>> = layout.blocks.iter().zip(&self.blocks).map(of).collect();
        let size = known + more + 1;
        let mut segments = vec![DMatrix::zeros(size, size); layout.segments.len()];
        for (block, owner) in blocks.iter().zip(&layout.owner) {
            segments[*owner] += block;
        }
        Self { starts: self.starts, shared: self.shared + more, blocks, segments }
    }

    fn reduced(&self, products: &DMatrix<f64>, damping: f64) -> Option<Reduced> {
        let (q, all) = (self.starts, products.nrows());
        let right = products.view((0, q), (q, all - q)).clone_owned();
        let starts = solve(&products.view((0, 0), (q, q)).clone_owned(), &right, damping)?;
        let products = products.view((q, q), (all - q, all - q)) - right.transpose() * &starts;
        Some(Reduced { products, starts })
    }

    fn all_reduced(&self, damping: f64) -> Option<(Vec<Reduced>, DMatrix<f64>)> {
        let reduced = self.segments.iter().map(|s| self.reduced(s, damping)).collect::<Option<Vec<_>>>()?;
        let total = reduced.iter().fold(DMatrix::zeros(self.shared + 1, self.shared + 1), |sum, r| sum + &r.products);
        Some((reduced, total))
    }

    fn shared_step(&self, total: &DMatrix<f64>, damping: f64) -> Option<DVector<f64>> {
        let p = self.shared;
        let right = total.view((0, p), (p, 1)).clone_owned();
        Some(solve(&total.view((0, 0), (p, p)).clone_owned(), &right, damping)?.column(0).clone_owned())
    }

    /// Steps that lower the sum of squares, one for each damping.
    pub(crate) fn steps(&self, dampings: &[f64]) -> Option<Vec<Step>> {
        let step = |damping: &f64| {
            let (reduced, total) = self.all_reduced(*damping)?;
            let shared = self.shared_step(&total, *damping)?;
            let starts = reduced.iter().map(|r| start_step(&r.starts, &shared)).collect();
            Some(Step { shared, starts })
        };
        dampings.iter().map(step).collect()
    }

    /// Sum of squares of the residual, and the one that a full step promises.
    pub(crate) fn sums(&self) -> Option<[f64; 2]> {
        let (_, total) = self.all_reduced(0.0)?;
        let last = self.starts + self.shared;
        let sum = self.segments.iter().map(|s| s[(last, last)]).sum();
        let step = self.shared_step(&total, 0.0)?;
        let p = self.shared;
        let gain = (0..p).map(|i| step[i] * total[(i, p)]).sum::<f64>();
        Some([sum, (total[(p, p)] - gain).max(0.0)])
    }

    /// Inverse of the normal matrix of the shared coordinates.
    pub(crate) fn inverse(&self) -> Option<DMatrix<f64>> {
        let (_, total) = self.all_reduced(0.0)?;
        let p = self.shared;
        solve(&total.view((0, 0), (p, p)).clone_owned(), &DMatrix::identity(p, p), 0.0)
    }

    /// Every block under the fit to all others. The starts are those of all rows: they are where a
    /// prediction begins, and no part of it.
    pub(crate) fn left_out(&self, layout: &Layout, model: &Linearised) -> Option<LeftOut> {
        let (reduced, total) = self.all_reduced(0.0)?;
        let (p, q) = (self.shared, self.starts);
        let mut residual = vec![0.0; model.residual.len()];
        let mut steps = Vec::with_capacity(self.blocks.len());
        for ((block, rows), owner) in self.blocks.iter().zip(&layout.blocks).zip(&layout.owner) {
            let starts = &reduced[*owner].starts;
            let across = starts.transpose() * block.view((0, q), (q, p + 1));
            let own = block.view((q, q), (p + 1, p + 1)) - &across - across.transpose()
                + starts.transpose() * block.view((0, 0), (q, q)) * starts;
            let step = self.shared_step(&(&total - own), 0.0)?;
            let start = start_step(starts, &step);
            for k in rows.clone() {
                let shared: f64 = model.shared.iter().zip(&step).map(|(c, s)| c[k] * s).sum();
                let own: f64 = model.starts.iter().zip(&start).map(|(c, s)| c[k] * s).sum();
                residual[k] = if layout.counts[k] { model.residual[k] - shared - own } else { 0.0 };
            }
            steps.push(step);
        }
        Some(LeftOut { residual, steps })
    }
}

/// Step of a start that goes with a step of the shared coordinates: the last column belongs to the
/// residual.
fn start_step(starts: &DMatrix<f64>, shared: &DVector<f64>) -> DVector<f64> {
    let p = shared.len();
    starts.column(p) - starts.columns(0, p) * shared
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// Two segments with a line each (own level) and one common slope, by hand.
    fn model(layout: &Layout, rows: usize) -> Linearised {
        let mut rng = Philox::new(3, 0, Stream::Host);
        let time = |k: usize| k as f64 / rows as f64;
        let level = |k: usize| if layout.segments[0].contains(&k) { 2.0 } else { -7.0 };
        Linearised {
            residual: (0..rows).map(|k| 3.0 * time(k) + level(k) + 0.1 * rng.normal()).collect(),
            shared: vec![(0..rows).map(time).collect()],
            starts: vec![vec![1.0; rows]],
        }
    }

    // The oracle: rows less the mean of their segment, and a plain slope through those of the other
    // blocks.
    #[test]
    fn a_block_is_predicted_by_the_slope_of_the_others() {
        let rows = 60;
        let layout = Layout::new(vec![0..30, 30..60], 10, vec![true; rows]);
        let model = model(&layout, rows);
        let products = Products::of(&layout, &model, &[false]);
        let left_out = products.left_out(&layout, &model).expect("regular");
        let centred = |column: &[f64]| -> Vec<f64> {
            let mean = |s: &Range<usize>| column[s.clone()].iter().sum::<f64>() / s.len() as f64;
            layout.segments.iter().flat_map(|s| s.clone().map(|k| column[k] - mean(s)).collect::<Vec<_>>()).collect()
        };
        let (x, y) = (centred(&model.shared[0]), centred(&model.residual));
        for block in &layout.blocks {
            let kept = || (0..rows).filter(|k| !block.contains(k));
            let slope = kept().map(|k| x[k] * y[k]).sum::<f64>() / kept().map(|k| x[k] * x[k]).sum::<f64>();
            for k in block.clone() {
                assert!((left_out.residual[k] - (y[k] - slope * x[k])).abs() < 1e-7, "{k}");
            }
        }
        // Control: the slope through all rows is another one.
        let step = &products.steps(&[0.0]).expect("regular")[0];
        assert!((y[0] - step.shared[0] * x[0] - left_out.residual[0]).abs() > 1e-4);
    }

    // The same columns, given at once or one after the other.
    #[test]
    fn a_further_column_is_as_one_of_the_model() {
        let layout = Layout::new(vec![0..30, 30..60], 10, vec![true; 60]);
        let whole = model(&layout, 60);
        let more: Vec<f64> = (0..60).map(|k| (0.3 * k as f64).sin()).collect();
        let mut larger = whole.clone();
        larger.shared.push(more.clone());
        let step = |products: &Products| products.steps(&[0.0]).expect("regular").remove(0).shared;
        for held in [false, true] {
            let at_once = Products::of(&layout, &larger, &[held, false]);
            let later = Products::of(&layout, &whole, &[held]).with(&layout, &whole, &[&more]);
            assert!((step(&at_once) - step(&later)).norm() < 1e-9, "{held}");
            assert!((step(&later)[0] == 0.0) == held, "the control: a column that is held does not move");
        }
    }

    #[test]
    fn a_coordinate_that_is_held_stays() {
        let layout = Layout::new(vec![0..30, 30..60], 10, vec![true; 60]);
        let model = model(&layout, 60);
        let held = Products::of(&layout, &model, &[true]).steps(&[0.0]).expect("regular");
        assert_eq!(held[0].shared[0], 0.0);
        let free = Products::of(&layout, &model, &[false]).steps(&[0.0]).expect("regular");
        assert!((free[0].shared[0] - 3.0).abs() < 0.5, "{}", free[0].shared[0]);
    }
}
