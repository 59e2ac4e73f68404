//! Frequencies that stand out in what a model leaves of every sample: in some of the samples alone they are
//! those of aliases.

use crate::driven::identification::refined_scales::lines;
use crate::driven::simulation::filter::Nothing;
use crate::engine::kind::Point;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, spectrum};
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::rows::Rows;
use super::system::System;

/// Samples up to which the lines of each set's own residual are computed; beyond, those of the base model serve.
const MOST: usize = 300_000;
/// Factor by which a residual is padded with zeros before its spectrum is taken.
const PADDED: usize = 4;
/// Peaks of the reading at which a mode may start: the first ones may be side lobes of the highest.
const PEAKS: usize = 5;

impl System {
    /// Scales with which a law is added to a set. A periodic disturbance and a mode start at the lines of the residual
    /// that the set leaves; a free mode also at further peaks of the reading, which a segment too short to beat hides.
    pub(super) fn scales_for(&self, term: &Term, set: &[usize], point: &Point) -> Scales {
        let is_short = self.samples().at.len() <= MOST;
        let lines_hz = match term {
            Term::PeriodicDisturbance(_) | Term::ParasiticMode(_) if is_short => self.lines_hz(set, point),
            Term::RingingMode(_) | Term::PumpedStiffness(_) if is_short => {
                self.peaks_hz().into_iter().skip(1).chain(self.lines_hz(set, point)).collect()
            }
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
        lines(&over_time(rows, &left), rows.data.rate_hz)
    }

    /// Frequencies of the peaks in the spectrum of the reading, the highest first.
    pub(in crate::driven) fn peaks_hz(&self) -> Vec<f64> {
        let rows = self.samples();
        let mean = mean_sd(rows.readings()).0;
        let moved: Vec<f64> = rows.readings().iter().map(|y| y - mean).collect();
        let raw = spectrum::periodogram(&over_time(rows, &moved), rows.data.rate_hz);
        let d = &raw.density;
        let mut peaks: Vec<usize> =
            (1..d.len().saturating_sub(1)).filter(|i| d[*i] > d[i - 1] && d[*i] >= d[i + 1]).collect();
        order::sort_by_key(&mut peaks, |i| -d[*i]);
        peaks.iter().take(PEAKS).map(|i| raw.frequency_hz[*i]).collect()
    }
}

/// Values of some rows over time: nothing where nothing is fitted, so that a line keeps its phase; and behind it,
/// so that a frequency is met within a part of its width.
fn over_time(rows: &Rows, values: &[f64]) -> Vec<f64> {
    let [Some(first), Some(last)] = [rows.at.first(), rows.at.last()] else { return Vec::new() };
    let mut all = vec![0.0; PADDED * (last + 1 - first)];
    rows.at.iter().zip(values).for_each(|(k, value)| all[k - first] = *value);
    all
}
