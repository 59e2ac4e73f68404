//! A curve with fewer points that looks the same (Douglas and Peucker 1973).

/// Distance of a point from the segment between two others.
fn from_segment(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 { (((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p.0 - a.0 - along * dx).hypot(p.1 - a.1 - along * dy)
}

/// Points of `curve` without those that lie within `tolerance` of the straight line between their
/// neighbours that stay. Both ends stay.
pub(super) fn simplified(curve: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let Some(last) = curve.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; curve.len()];
    (kept[0], kept[last]) = (true, true);
    let mut parts = vec![(0, last)];
    while let Some((from, to)) = parts.pop() {
        let between = (from + 1..to).map(|k| (k, from_segment(curve[k], curve[from], curve[to])));
        if let Some((k, distance)) = between.max_by(|a, b| a.1.total_cmp(&b.1))
            && distance > tolerance
        {
            kept[k] = true;
            parts.extend([(from, k), (k, to)]);
        }
    }
    curve.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_ends_and_a_corner_stays() {
        let line: Vec<(f64, f64)> = (0..100).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        assert_eq!(simplified(&line, 0.01), [line[0], line[99]]);
        let corner = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0)];
        assert_eq!(simplified(&corner, 0.01), [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]);
        assert!(simplified(&[], 0.1).is_empty() && simplified(&line[..1], 0.1).len() == 1);
    }

    #[test]
    fn no_point_of_a_sine_is_farther_than_the_tolerance() {
        let sine: Vec<(f64, f64)> = (0..1000).map(|k| f64::from(k) * 0.01).map(|x| (x, x.sin())).collect();
        let few = simplified(&sine, 0.002);
        assert!(few.len() < 120, "{}", few.len());
        for p in &sine {
            let near = few.windows(2).map(|w| from_segment(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
            assert!(near <= 0.002, "{near}");
        }
    }
}
