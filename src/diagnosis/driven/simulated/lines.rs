//! Frequencies that stand out in what a model leaves of every sample: in some of the samples alone they are
//! those of aliases.

use crate::driven::identification::refined_scales::lines;
use crate::driven::simulation::filter::Nothing;
use crate::engine::kind::Point;
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::rows::Rows;
use super::system::System;

/// Samples up to which the lines of each set's own residual are computed; beyond, those of the base model serve.
const MOST: usize = 300_000;
/// Factor by which a residual is padded with zeros before its spectrum is taken.
const PADDED: usize = 4;

impl System {
    /// Scales with which a law is added to a set. A periodic disturbance starts at the lines of the residual
    /// that the set leaves.
    pub(super) fn scales_for(&self, term: &Term, set: &[usize], point: &Point) -> Scales {
        let lines_hz = match term {
            Term::PeriodicDisturbance(_) if self.samples().at.len() <= MOST => self.lines_hz(set, point),
            _ => self.scales.lines_hz.clone(),
        };
        Scales { lines_hz, ..self.scales.clone() }
    }

    fn samples(&self) -> &Rows {
        self.rows.samples.as_deref().unwrap_or(&self.rows)
    }

    /// Frequencies that stand out in what a set leaves of every sample, strongest first.
    pub(in crate::driven) fn lines_hz(&self, set: &[usize], point: &Point) -> Vec<f64> {
        let rows = self.samples();
        let left = Self { rows: rows.clone(), ..self.clone() }.traced(set, point, &mut Nothing);
        let at = &rows.at;
        let [Some(first), Some(last)] = [at.first(), at.last()] else { return Vec::new() };
        // Nothing where nothing is fitted, so that a line keeps its phase; and behind it, so that a frequency is
        // met within a part of its width.
        let mut over_time = vec![0.0; PADDED * (last + 1 - first)];
        at.iter().zip(left).for_each(|(k, e)| over_time[k - first] = e);
        lines(&over_time, rows.data.rate_hz)
    }
}
