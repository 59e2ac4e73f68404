//! Temperature of the sensor along a run: points with straight lines between them.

/// Temperatures that a sensor may have, °C.
pub(crate) const POSSIBLE_DEG_C: std::ops::Range<f64> = -273.15..1000.0;

/// A profile, and the temperature at which the sensor's stated errors hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Temperature {
    /// Time, s, and temperature, °C; times increase. Before the first and after the last point it
    /// stays.
    pub points: Vec<[f64; 2]>,
    /// Temperature at which the stated errors hold, °C.
    pub reference_deg_c: f64,
}

impl Temperature {
    /// How much warmer than the reference it is, K; zero without points.
    pub fn above_reference_k(&self, time_s: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] <= time_s);
        let at = match (after.checked_sub(1).and_then(|n| self.points.get(n)), self.points.get(after)) {
            (Some([from_s, from]), Some([to_s, to])) => from + (to - from) * (time_s - from_s) / (to_s - from_s),
            (Some([_, only]), None) | (None, Some([_, only])) => *only,
            (None, None) => return 0.0,
        };
        at - self.reference_deg_c
    }
}

#[cfg(test)]
mod tests {
    use super::Temperature;

    #[test]
    fn it_is_straight_between_points_and_stays_beyond_them() {
        let profile = Temperature { points: vec![[10.0, 20.0], [30.0, 40.0]], reference_deg_c: 25.0 };
        let got = [0.0, 10.0, 15.0, 30.0, 99.0].map(|t| profile.above_reference_k(t));
        assert_eq!(got, [-5.0, -5.0, 0.0, 15.0, 15.0]);
        assert_eq!(Temperature::default().above_reference_k(5.0), 0.0);
    }
}
