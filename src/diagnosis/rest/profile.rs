//! The best value of a number and its 95 % interval, by the likelihood that a model has with it.

/// Half of χ²₁'s 95 % point.
const WITHIN: f64 = 1.92;

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Profiled {
    pub(super) value: f64,
    pub(super) ci95: [f64; 2],
}

impl Profiled {
    /// Returns it as another number, which grows with this one.
    pub(super) fn map(self, to: impl Fn(f64) -> f64) -> Self {
        Self { value: to(self.value), ci95: self.ci95.map(to) }
    }
}

/// The value of most likelihood between two bounds, and that likelihood's logarithm: the best of so
/// many points, then between its neighbours.
pub(super) fn peak([from, to]: [f64; 2], points: usize, at: impl Fn(f64) -> f64) -> (f64, f64) {
    let step = (to - from) / (points - 1) as f64;
    let grid: Vec<(f64, f64)> = (0..points).map(|i| from + i as f64 * step).map(|x| (x, at(x))).collect();
    let mut best = grid.iter().copied().fold((from, f64::NEG_INFINITY), |b, g| if g.1 > b.1 { g } else { b });
    let mut width = 0.5 * step;
    for _ in 0..6 {
        let sides = [best.0 - width, best.0 + width].map(|x| x.clamp(from, to)).map(|x| (x, at(x)));
        best = sides.into_iter().fold(best, |b, s| if s.1 > b.1 { s } else { b });
        width /= 2.0;
    }
    best
}

/// The best value of a number between two bounds, and its 95 % interval by profile likelihood.
pub(super) fn profile([from, to]: [f64; 2], points: usize, at: impl Fn(f64) -> f64) -> (Profiled, f64) {
    let step = (to - from) / (points - 1) as f64;
    let best = peak([from, to], points, &at);
    let inside = |x: f64| best.1 - at(x) < WITHIN;
    let edge = |direction: f64| {
        let end = if direction < 0.0 { from } else { to };
        let (mut near, mut reach) = (best.0, 0.5 * step);
        loop {
            let far = (best.0 + direction * reach).clamp(from, to);
            if !inside(far) {
                let mut out = far;
                for _ in 0..10 {
                    let middle = 0.5 * (near + out);
                    if inside(middle) { near = middle } else { out = middle }
                }
                return 0.5 * (near + out);
            }
            if far == end {
                return end;
            }
            (near, reach) = (far, 2.0 * reach);
        }
    };
    (Profiled { value: best.0, ci95: [edge(-1.0), edge(1.0)] }, best.1)
}
