//! Symmetric positive definite band matrices: their Cholesky factor, and solutions with it.
//!
//! Source: Golub & Van Loan, *Matrix computations*, fourth edition, §4.3.5. Not for matrices that
//! may be singular.

/// A symmetric matrix of which only the diagonal and the bands below it are kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Banded {
    /// Bands, the diagonal included.
    bands: usize,
    /// Row by row: the entries from `row − bands + 1` to the diagonal.
    entries: Vec<f64>,
}

/// The lower triangular factor of a band matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor(Banded);

impl Banded {
    /// Zeros, of this size, with this many bands, the diagonal included.
    pub fn zeros(size: usize, bands: usize) -> Self {
        Self { bands, entries: vec![0.0; size * bands] }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.entries.len() / self.bands
    }

    /// Adds to the entry of a row and a column to the left of the diagonal, or on it.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let place = self.place(row, column);
        self.entries[place] += value;
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * self.bands + self.bands - 1 - (row - column)
    }

    fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[self.place(row, column)]
    }

    /// The first column that a row holds.
    fn first(&self, row: usize) -> usize {
        (row + 1).saturating_sub(self.bands)
    }

    /// Its factor; none where it is not positive definite.
    pub fn factor(mut self) -> Option<Factor> {
        for row in 0..self.size() {
            for column in self.first(row)..=row {
                let from = self.first(row).max(self.first(column));
                let sum: f64 = (from..column).map(|k| self.get(row, k) * self.get(column, k)).sum();
                let rest = self.get(row, column) - sum;
                let place = self.place(row, column);
                self.entries[place] = match column == row {
                    true if rest > 0.0 => rest.sqrt(),
                    true => return None,
                    false => rest / self.get(column, column),
                };
            }
        }
        Some(Factor(self))
    }
}

impl Factor {
    /// Solves for one right-hand side, in its place.
    pub fn solve(&self, x: &mut [f64]) {
        let lower = &self.0;
        for row in 0..lower.size() {
            let sum: f64 = (lower.first(row)..row).map(|k| lower.get(row, k) * x[k]).sum();
            x[row] = (x[row] - sum) / lower.get(row, row);
        }
        for row in (0..lower.size()).rev() {
            x[row] /= lower.get(row, row);
            let value = x[row];
            for (k, x) in x.iter_mut().enumerate().take(row).skip(lower.first(row)) {
                *x -= lower.get(row, k) * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_satisfies_the_equations_and_a_singular_matrix_is_refused() {
        // 1 −2 1 squared and a little more on the diagonal.
        let size = 40;
        let mut matrix = Banded::zeros(size, 3);
        for row in 0..size {
            matrix.add(row, row, 6.01);
            (row > 0).then(|| matrix.add(row, row - 1, -4.0));
            (row > 1).then(|| matrix.add(row, row - 2, 1.0));
        }
        let truth: Vec<f64> = (0..size).map(|k| (k as f64 * 0.7).sin()).collect();
        let at = |r: usize, c: usize| match r.abs_diff(c) {
            0 => 6.01,
            1 => -4.0,
            2 => 1.0,
            _ => 0.0,
        };
        let mut x: Vec<f64> = (0..size).map(|r| (0..size).map(|c| at(r, c) * truth[c]).sum()).collect();
        matrix.factor().expect("positive definite").solve(&mut x);
        assert!(x.iter().zip(&truth).all(|(x, t)| (x - t).abs() < 1e-10));
        assert!(Banded::zeros(3, 2).factor().is_none());
    }
}
