//! Rows that repeat the one before them exactly, where no clock tells: samples written twice, or lost ones replaced by the
//! last.
//!
//! Only where the columns hardly ever repeat a value otherwise. With a time column the time stamps decide (`clock`).

use std::ops::Range;

/// Share of its rows that a column may repeat a value in, before repeating says nothing.
const SELDOM: f64 = 0.01;

/// What was done.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mended {
    /// In words, where anything was found.
    pub finding: Option<String>,
    /// Samples that stand in for lost ones.
    pub filled: Vec<Range<usize>>,
}

/// Drops rows that were written twice; fills the place of lost ones, which a repeated row only holds open.
pub fn mend(columns: &mut [Vec<f64>]) -> Mended {
    let rows = columns.first().map_or(0, Vec::len);
    if columns.len() < 2 || rows < 100 {
        return Mended::default();
    }
    let seldom = |c: &Vec<f64>| c.windows(2).filter(|w| w[0] == w[1]).count() as f64 <= SELDOM * rows as f64;
    if !columns.iter().all(seldom) {
        return Mended::default();
    }
    let places: Vec<usize> = (1..rows).filter(|k| columns.iter().all(|c| c[*k] == c[*k - 1])).collect();
    if places.is_empty() {
        return Mended::default();
    }
    // z, a, b, b, c: where c is the next sample, z, a, b, c lie on a parabola; where one was lost, z, a, b, (?), c do. Either
    // misfit is over what unit noise would make of it.
    let (mut twice, mut lost) = (0.0, 0.0);
    for k in places.iter().copied().filter(|k| *k >= 3 && k + 1 < rows) {
        for c in columns.iter() {
            let (z, a, b, next) = (c[k - 3], c[k - 2], c[k - 1], c[k + 1]);
            let size = (a - z).abs() + (b - a).abs() + (next - b).abs();
            if size.is_finite() && size > 0.0 {
                twice += ((next - 3.0 * b + 3.0 * a - z) / size).abs() / 20f64.sqrt();
                lost += ((next - 6.0 * b + 8.0 * a - 3.0 * z) / size).abs() / 110f64.sqrt();
            }
        }
    }
    let first = places[0];
    let count = places.len();
    let words = format!("{count} rows, the first is row {first}, repeat the row before them exactly in every column");
    if twice <= lost {
        for c in columns.iter_mut() {
            let mut row = 0;
            c.retain(|_| {
                row += 1;
                places.binary_search(&(row - 1)).is_err()
            });
        }
        return Mended {
            finding: Some(format!("{words}: taken for samples written twice and dropped")),
            filled: vec![],
        };
    }
    for c in columns.iter_mut() {
        for k in places.iter().copied().filter(|k| k + 1 < rows) {
            c[k] = 0.5 * (c[k - 1] + c[k + 1]);
        }
    }
    Mended {
        finding: Some(format!("{words}: taken for lost samples and filled by straight lines")),
        filled: places.iter().map(|k| *k..k + 1).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Vec<f64>> {
        let wave = |rate: f64| (0..1000).map(|k| (rate * f64::from(k)).sin()).collect();
        vec![wave(0.11), wave(0.07)]
    }

    #[test]
    fn rows_written_twice_are_dropped_and_lost_ones_filled() {
        let good = columns();
        let mut twice = good.clone();
        twice.iter_mut().for_each(|c| c.insert(300, c[299]));
        assert!(mend(&mut twice).finding.is_some_and(|f| f.contains("written twice")));
        assert_eq!(twice, good);
        let mut held = good.clone();
        held.iter_mut().for_each(|c| c[300] = c[299]);
        assert_eq!(mend(&mut held).filled, vec![300..301]);
        assert!((held[0][300] - good[0][300]).abs() < 0.01);
        assert_eq!(mend(&mut columns()), Mended::default());
        let coarse = |c: &Vec<f64>| c.iter().map(|v| (v * 4.0).round()).collect();
        assert_eq!(
            mend(&mut good.iter().map(coarse).collect::<Vec<_>>()),
            Mended::default(),
            "a coarse reading repeats"
        );
    }
}
