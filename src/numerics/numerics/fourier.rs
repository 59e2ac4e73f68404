//! Plans of Fourier transforms by their length: to make one costs as much as several transforms, and a search
//! transforms many sequences of few lengths.

use std::sync::{Arc, Mutex, PoisonError};

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Samples over all plans that are kept: about 100 MB of twiddles.
const KEPT: usize = 1 << 22;

/// The transforms of one length.
#[derive(Clone)]
pub struct Plan {
    /// Number of real samples.
    pub count: usize,
    /// From samples to bins.
    pub forward: Arc<dyn RealToComplex<f64>>,
    /// From bins to samples, times their number.
    pub inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Returns the plan of a length, made where it is not among those used last.
pub fn plan(count: usize) -> Plan {
    static PLANS: Mutex<Vec<Plan>> = Mutex::new(Vec::new());
    let known = |plans: &[Plan]| plans.iter().position(|p| p.count == count);
    let mut plans = PLANS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(place) = known(&plans) {
        plans[..=place].rotate_right(1);
        return plans[0].clone();
    }
    drop(plans);
    let mut planner = RealFftPlanner::new();
    let made = Plan { count, forward: planner.plan_fft_forward(count), inverse: planner.plan_fft_inverse(count) };
    let mut plans = PLANS.lock().unwrap_or_else(PoisonError::into_inner);
    if known(&plans).is_none() {
        plans.insert(0, made.clone());
        let mut samples = 0;
        plans.retain(|p| {
            samples += p.count;
            samples <= KEPT
        });
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_of_a_length_is_made_once_and_long_ones_go() {
        let (first, second) = (plan(1001), plan(1001));
        assert!(Arc::ptr_eq(&first.forward, &second.forward));
        plan(KEPT + 1);
        plan(KEPT - 1);
        assert!(!Arc::ptr_eq(&first.forward, &plan(1001).forward), "too many samples were kept");
    }
}
