//! Outages of GNSS: how far the errors grow while there are no fixes.

use crate::kernel::job::Clock;
use crate::study::aiding::Aiding;

/// Points of the curves of an outage.
const POINTS: u64 = 12;

/// One outage of GNSS and the places of its reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Outage {
    /// When it begins, s: fixes at that time are the last.
    pub from_s: f64,
    /// When it ends, s: fixes at that time are not taken yet.
    pub until_s: f64,
    /// Places of its times in the ensemble, its begin (if that is not the run's) and its end among
    /// them.
    pub places: Vec<usize>,
}

/// The times that the curves need next to the run's own, samples.
pub fn samples(aiding: Option<&Aiding>) -> Vec<u64> {
    let outages = aiding.iter().flat_map(|aiding| &aiding.outages);
    let inside = |[from, until]: &[u64; 2]| {
        let (from, until) = (*from, *until);
        (0..=POINTS).map(move |k| from + (until - from) * k / POINTS).filter(|sample| *sample > 0)
    };
    outages.flat_map(inside).collect()
}

/// The outages of a run whose report times are these samples.
pub fn outages(aiding: Option<&Aiding>, clock: &Clock, samples: &[u64]) -> Vec<Outage> {
    let outage = |[from, until]: &[u64; 2]| Outage {
        from_s: *from as f64 * clock.sample_s(),
        until_s: *until as f64 * clock.sample_s(),
        places: (0..samples.len()).filter(|k| (*from..=*until).contains(&samples[*k])).collect(),
    };
    aiding.iter().flat_map(|aiding| &aiding.outages).map(outage).collect()
}
