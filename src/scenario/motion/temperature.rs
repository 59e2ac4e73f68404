//! Temperature of the sensor along a run: points with straight lines between them, which the sensor
//! may follow with a lag.

/// Temperatures that a sensor may have, °C.
pub const POSSIBLE_DEG_C: std::ops::Range<f64> = -273.15..1000.0;

/// A profile, and the temperature at which the sensor's stated errors hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Temperature {
    /// Time, s, and temperature, °C; times increase. Before the first and after the last point it
    /// stays.
    pub points: Vec<[f64; 2]>,
    /// Temperature at which the stated errors hold, °C.
    pub reference_deg_c: f64,
    /// Time constant of the lag with which the sensor follows, s; 0 where it follows at once.
    lag_s: f64,
    /// Temperature of the sensor at the points, °C.
    reached: Vec<f64>,
}

impl Temperature {
    /// A profile that the sensor follows at once.
    pub fn new(points: Vec<[f64; 2]>, reference_deg_c: f64) -> Self {
        let reached = points.iter().map(|[_, deg_c]| *deg_c).collect();
        Self { points, reference_deg_c, lag_s: 0.0, reached }
    }

    /// The same followed with a first-order lag of this time constant, from a sensor as warm as the
    /// first point on.
    pub fn with_lag(mut self, lag_s: f64) -> Self {
        self.lag_s = lag_s;
        for n in 1..self.points.len() {
            let [time_s, _] = self.points[n];
            self.reached[n] = self.within(n - 1, time_s);
        }
        self
    }

    /// Time constant of the lag, s; 0 where the sensor follows at once.
    pub fn lag_s(&self) -> f64 {
        self.lag_s
    }

    /// Returns the temperature of the sensor at a time after a point and not after the next one,
    /// °C.
    fn within(&self, point: usize, time_s: f64) -> f64 {
        let [from_s, from] = self.points[point];
        let since_s = time_s - from_s;
        let (along, per_s) = match self.points.get(point + 1) {
            Some([to_s, to]) => (from + (to - from) * since_s / (to_s - from_s), (to - from) / (to_s - from_s)),
            None => (from, 0.0),
        };
        if self.lag_s == 0.0 {
            return along;
        }
        // τθ′ + θ = u along a straight line u: θ stays τu′ behind it once what was apart has died out.
        // By the exponential less one, as τu′ alone may be larger than all temperatures.
        let gone = -(-since_s / self.lag_s).exp_m1();
        along - per_s * self.lag_s * gone + (self.reached[point] - from) * (1.0 - gone)
    }

    /// Returns the least and the greatest temperature above the reference, K; zeros without points.
    /// With a lag it stays within the points.
    pub fn range_above_reference_k(&self) -> [f64; 2] {
        let all = || self.points.iter().map(|[_, deg_c]| deg_c - self.reference_deg_c);
        if self.points.is_empty() { [0.0; 2] } else { [all().fold(f64::MAX, f64::min), all().fold(f64::MIN, f64::max)] }
    }

    /// Returns the temperature of the sensor above its reference, K; zero without points.
    pub fn above_reference_k(&self, time_s: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] <= time_s);
        let at = match (after.checked_sub(1), self.points.first()) {
            (Some(point), _) => self.within(point, time_s),
            (None, Some([_, first])) => *first,
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
        let profile = Temperature::new(vec![[10.0, 20.0], [30.0, 40.0]], 25.0);
        let got = [0.0, 10.0, 15.0, 30.0, 99.0].map(|t| profile.above_reference_k(t));
        assert_eq!(got, [-5.0, -5.0, 0.0, 15.0, 15.0]);
        assert_eq!(Temperature::default().above_reference_k(5.0), 0.0);
    }

    // Of a ramp by 2 K/s a lag of 5 s is 10 K (1 − e^(−t/5)) behind (Ljung, System Identification,
    // ch. 2); after it ends what is missing dies out. Held against the equation in steps of a
    // millisecond too, through a point between.
    #[test]
    fn a_lag_stays_behind_a_ramp_and_catches_up_after_it() {
        let profile = Temperature::new(vec![[10.0, 20.0], [30.0, 60.0], [40.0, 60.0]], 20.0).with_lag(5.0);
        let missing = |since_s: f64| 10.0 * (1.0 - (-since_s / 5.0_f64).exp());
        for (time_s, expected) in [
            (0.0, 0.0),
            (10.0, 0.0),
            (17.0, 14.0 - missing(7.0)),
            (30.0, 40.0 - missing(20.0)),
            (37.0, 40.0 - missing(20.0) * (-7.0_f64 / 5.0).exp()),
            (55.0, 40.0 - missing(20.0) * (-5.0_f64).exp()),
        ] {
            assert!((profile.above_reference_k(time_s) - expected).abs() < 1e-12, "{time_s}");
        }
        let swing = vec![[0.0, 20.0], [3.0, 26.0], [5.0, 18.0], [11.0, 30.0]];
        let (at_once, late) = (Temperature::new(swing.clone(), 0.0), Temperature::new(swing, 0.0).with_lag(2.0));
        let mut stepped = 20.0;
        for n in 0..12_000 {
            let time_s = f64::from(n) * 1e-3;
            assert!((late.above_reference_k(time_s) - stepped).abs() < 5e-3, "{time_s}");
            stepped += 1e-3 * (at_once.above_reference_k(time_s + 5e-4) - stepped) / 2.0;
        }
        // Control: at once it is elsewhere.
        assert!((at_once.above_reference_k(5.0) - late.above_reference_k(5.0)).abs() > 1.0);
    }
}
