//! Measures how much of the plane a cloud of points fills: box-counting dimension and correlation
//! dimension, with intervals.
//!
//! Both are slopes over a stated range of scales. Their error joins the scatter between independent
//! groups of points with the scatter of the local slopes along the scales, because a real
//! attractor's slope undulates. Sources: Grassberger and Procaccia, Physica D 9 (1983); Falconer,
//! Fractal Geometry, ch. 2. Not for time series: points are taken as given.

use super::estimate::{Estimate, slope};

/// A dimension with the curve it was read from.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimension {
    /// The slope of the curve, with its standard error.
    pub estimate: Estimate,
    /// (log₂ of scale, log₂ of boxes or of pair fraction) over the range used, all points together.
    pub curve: Vec<(f64, f64)>,
}

/// Scales from 2^−coarse to 2^−fine of the unit square, coarse < fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scales {
    /// Largest scale, as a power of one half.
    pub coarse: u32,
    /// Smallest scale, as a power of one half.
    pub fine: u32,
}

/// Box-counting dimension of groups of points in the unit square. Points outside are left out.
pub fn box_counting(groups: &[Vec<[f64; 2]>], scales: Scales) -> Dimension {
    let curve = |groups: &[&Vec<[f64; 2]>]| -> Vec<(f64, f64)> {
        let levels = scales.coarse..=scales.fine;
        levels.map(|level| (f64::from(level), occupied(groups, level) as f64)).map(|(l, n)| (l, n.log2())).collect()
    };
    let all = curve(&groups.iter().collect::<Vec<_>>());
    // Half of the points is the leanest replicate that is still dense at the finest scale:
    // leave-one-group-out instead, whose scatter is inflated to that of the whole (the delete-one
    // jackknife).
    let without: Vec<f64> = (0..groups.len())
        .map(|k| {
            let kept: Vec<_> = groups.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, g)| g).collect();
            slope(&curve(&kept)).value
        })
        .collect();
    let g = groups.len() as f64;
    let centre = without.iter().sum::<f64>() / g;
    let jackknife = ((g - 1.0) / g * without.iter().map(|v| (v - centre).powi(2)).sum::<f64>()).sqrt();
    let line = slope(&all);
    Dimension { estimate: line.with_further(jackknife), curve: all }
}

fn occupied(groups: &[&Vec<[f64; 2]>], level: u32) -> usize {
    let side = 1usize << level;
    let mut boxes = vec![0u64; (side * side).div_ceil(64)];
    for point in groups.iter().flat_map(|g| g.iter()) {
        let [x, y] = point.map(|c| c * side as f64);
        if x >= 0.0 && y >= 0.0 && x < side as f64 && y < side as f64 {
            let index = y as usize * side + x as usize;
            boxes[index / 64] |= 1 << (index % 64);
        }
    }
    boxes.iter().map(|b| b.count_ones() as usize).sum()
}

/// Correlation dimension of groups of points in the unit square (distance: the larger coordinate
/// difference).
///
/// Each group counts its own pairs; points of one group should come from different times or orbits.
pub fn correlation(groups: &[Vec<[f64; 2]>], scales: Scales) -> Dimension {
    let levels = (scales.fine - scales.coarse + 1) as usize;
    let counts: Vec<Vec<u64>> = groups.iter().map(|group| pairs_within(group, scales)).collect();
    let pairs = |group: &Vec<[f64; 2]>| group.len() as f64 * (group.len() as f64 - 1.0) / 2.0;
    let curve = |counts: &[u64], pairs: f64| -> Vec<(f64, f64)> {
        (0..levels).map(|i| (f64::from(scales.coarse + i as u32), (counts[i] as f64 / pairs).log2())).collect()
    };
    let each: Vec<f64> = counts.iter().zip(groups).map(|(c, g)| -slope(&curve(c, pairs(g))).value).collect();
    let total: Vec<u64> = (0..levels).map(|i| counts.iter().map(|c| c[i]).sum()).collect();
    let all = curve(&total, groups.iter().map(pairs).sum());
    let line = slope(&all);
    let estimate = Estimate { value: -line.value, standard_error: line.standard_error };
    Dimension { estimate: estimate.with_further(Estimate::of_mean(&each).standard_error), curve: all }
}

/// Pairs closer than 2^−level, for each level.
fn pairs_within(points: &[[f64; 2]], scales: Scales) -> Vec<u64> {
    let points: Vec<[f32; 2]> = points.iter().map(|p| [p[0] as f32, p[1] as f32]).collect();
    let radii: Vec<f32> = (scales.coarse..=scales.fine).map(|l| 0.5f32.powi(l as i32)).collect();
    let mut counts = vec![0u64; radii.len()];
    for (i, a) in points.iter().enumerate() {
        // One pass per radius over a short inner loop: each vectorises, a histogram would not.
        for chunk in points[i + 1..].chunks(256) {
            let distances: Vec<f32> = chunk.iter().map(|b| (a[0] - b[0]).abs().max((a[1] - b[1]).abs())).collect();
            for (count, radius) in counts.iter_mut().zip(&radii) {
                *count += distances.iter().map(|d| u32::from(d < radius)).sum::<u32>() as u64;
            }
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use rand::RngExt;

    /// Known shapes: the Sierpiński gasket (each pair of binary digits is 00, 01 or 10, so 3ᵏ boxes
    /// of side 2⁻ᵏ are met exactly), the square, a line: dimension ln 3/ln 2, 2, 1.
    fn cloud(kind: usize, group: u64) -> Vec<[f64; 2]> {
        let mut random = Philox::new(7, group, Stream::Host);
        let mut gasket = || {
            (1..30).fold([0.0, 0.0], |[x, y], k| {
                let digit = 0.5f64.powi(k);
                match random.random_range(0..3u8) {
                    0 => [x, y],
                    1 => [x + digit, y],
                    _ => [x, y + digit],
                }
            })
        };
        let points: Vec<[f64; 2]> = (0..4000).map(|_| gasket()).collect();
        let mut random = Philox::new(8, group, Stream::Host);
        (0..4000)
            .map(|i| match kind {
                0 => points[i],
                1 => [random.random::<f64>(), random.random::<f64>()],
                _ => {
                    let t = random.random::<f64>();
                    [t, 0.3 + 0.4 * t]
                }
            })
            .collect()
    }

    #[test]
    fn known_dimensions_are_found() {
        for (kind, truth) in [(0, 3f64.ln() / 2f64.ln()), (1, 2.0), (2, 1.0)] {
            let groups: Vec<_> = (0..4).map(|g| cloud(kind, g)).collect();
            let correlation = correlation(&groups, Scales { coarse: 2, fine: 6 }).estimate;
            assert!((correlation.value - truth).abs() < 0.1, "kind {kind}: {correlation:?}");
            let boxes = box_counting(&groups, Scales { coarse: 1, fine: 5 }).estimate;
            assert!((boxes.value - truth).abs() < 0.15, "kind {kind}: {boxes:?}");
        }
    }
}
