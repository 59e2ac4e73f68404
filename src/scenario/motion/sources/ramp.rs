//! From standstill to full speed without a jerk.

/// Returns how far along a smooth step from 0 to 1 is at 0 ≤ x ≤ 1, and beyond: 6x⁵ − 15x⁴ + 10x³.
pub fn step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// The integral of [`step`] from 0 to x; from 1 on it grows as x does.
pub fn integral(x: f64) -> f64 {
    let inner = x.clamp(0.0, 1.0);
    inner.powi(4) * (2.5 + inner * (inner - 3.0)) + (x - 1.0).max(0.0)
}

/// A start: standstill, then a speed that is reached smoothly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Time at rest before it, s.
    pub still_s: f64,
    /// Speed after the start, m/s.
    pub speed_m_s: f64,
}

/// Mean acceleration on the way to full speed, m/s².
const ACCELERATION_M_S2: f64 = 1.0;

impl Start {
    /// The way gone at a time, m. Without a standstill it begins at full speed.
    pub fn way_m(&self, time_s: f64) -> f64 {
        if self.still_s <= 0.0 {
            return self.speed_m_s * time_s;
        }
        let length = self.speed_m_s.abs() / ACCELERATION_M_S2;
        if length <= 0.0 {
            return 0.0;
        }
        self.speed_m_s * length * integral((time_s - self.still_s) / length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_is_the_integral_of_the_step() {
        let rule = |x: f64| (0..4000).map(|k| step((f64::from(k) + 0.5) / 4000.0 * x) * x / 4000.0).sum::<f64>();
        for x in [0.2, 0.7, 1.0, 2.5] {
            assert!((integral(x) - rule(x)).abs() < 1e-6, "{x}");
        }
        let start = Start { still_s: 5.0, speed_m_s: 10.0 };
        assert_eq!((start.way_m(5.0), Start { still_s: 0.0, ..start }.way_m(3.0)), (0.0, 30.0));
        assert!((start.way_m(31.0) - start.way_m(30.0) - 10.0).abs() < 1e-9);
    }
}
