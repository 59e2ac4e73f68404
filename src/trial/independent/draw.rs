//! Random numbers of the second generator: xoshiro256++ (Blackman & Vigna, ACM TOMS 47, 2021), one
//! stream per case.
//!
//! Not the generator of `rng`: the two trials share no numerics with each other or with what they
//! test.

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Draw {
    state: [u64; 4],
    spare: Option<f64>,
}

/// SplitMix64, which fills the state (same authors).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

impl Draw {
    /// The stream of one purpose: same arguments, same numbers.
    pub fn new(seed: u64, case: u64, purpose: u64) -> Self {
        let mut mix = seed;
        let mut key = split_mix(&mut mix) ^ case.wrapping_mul(0xD134_2543_DE82_EF95);
        key = split_mix(&mut key) ^ purpose.wrapping_mul(0xA24B_AED4_963E_E407);
        Self { state: std::array::from_fn(|_| split_mix(&mut key)), spare: None }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let s = &mut self.state;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        result
    }

    /// Uniform in (0, 1), never an end.
    pub fn unit(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) * (0.5f64).powi(53)
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform between two positive numbers.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// One of these values, all equally likely.
    pub fn one_of<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// +1 or −1 with equal probability.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Standard normal (Marsaglia's polar method).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let square = a * a + b * b;
            if square < 1.0 && square > 0.0 {
                let scale = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(b * scale);
                return a * scale;
            }
        }
    }

    /// Exponential with mean one.
    pub fn exponential(&mut self) -> f64 {
        -self.unit().ln()
    }

    /// Gamma with a half-integer shape and scale one: sums of exponentials and a half square of a
    /// normal number.
    pub fn gamma_half(&mut self, twice_shape: usize) -> f64 {
        let whole: f64 = (0..twice_shape / 2).map(|_| self.exponential()).sum();
        whole + if twice_shape % 2 == 1 { 0.5 * self.normal().powi(2) } else { 0.0 }
    }

    /// Student's t with `freedom` degrees of freedom.
    pub fn student(&mut self, freedom: usize) -> f64 {
        let chi_square = 2.0 * self.gamma_half(freedom);
        self.normal() / (chi_square / freedom as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(values: &[f64]) -> [f64; 3] {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let central = |p: i32| values.iter().map(|v| (v - mean).powi(p)).sum::<f64>() / n;
        [mean, central(2), central(4) / central(2).powi(2)]
    }

    // Normal: kurtosis 3. Student t with ν > 4: variance ν/(ν − 2), kurtosis 3 + 6/(ν − 4); for ν =
    // 9: 9/7 and 4.2.
    #[test]
    fn normal_and_student_numbers_have_their_moments() {
        let mut draw = Draw::new(1, 2, 3);
        let normal: Vec<f64> = (0..400_000).map(|_| draw.normal()).collect();
        let [mean, variance, kurtosis] = moments(&normal);
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.01 && (kurtosis - 3.0).abs() < 0.05);
        let student: Vec<f64> = (0..400_000).map(|_| draw.student(9)).collect();
        let [_, variance, heavy] = moments(&student);
        assert!((variance - 9.0 / 7.0).abs() < 0.02 && (heavy - 4.2).abs() < 0.4, "{variance} {heavy}");
        // Control: the check tells the two apart.
        assert!((kurtosis - 4.2).abs() > 0.4);
    }

    #[test]
    fn streams_differ_and_repeat() {
        let first = |case, purpose| Draw::new(7, case, purpose).bits();
        assert_eq!(first(1, 1), first(1, 1));
        assert_ne!(first(1, 1), first(2, 1));
        assert_ne!(first(1, 1), first(1, 2));
    }
}
