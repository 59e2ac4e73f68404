//! Nothing moves: what a study without an excitation is subjected to.

use super::plan::{Plan, Spectrum};
use super::reader::Kind;
use super::waveform::Waveform;

pub(crate) const KIND: Kind = Kind { name: "rest", keys: &[], plan: |_| Ok(plan()) };

/// The plan of it.
pub fn plan() -> Plan {
    Plan::shared(Rest, "at rest".into(), Spectrum::Shape)
}

/// Zero specific force throughout: kind = "rest".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest;

impl Waveform for Rest {
    fn specific_force_m_s2(&self, _time_s: f64) -> f64 {
        0.0
    }
}
