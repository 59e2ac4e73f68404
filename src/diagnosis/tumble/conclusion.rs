//! From a selection to the verdict: outcome, intervals, what it costs and what to do next.

use nalgebra::Vector3;

use super::calibration::{Calibration, Point, accelerometer, gyro};
use super::candidate::{CANDIDATES, Term};
use super::fit::Fit;
use super::imu::Observed;
use super::isolation::locate;
use super::remainder::Remainder;
use super::rows::{GROUPS, Group};
use super::selection::{Folds, Selection, Standing, held_out_squares};
use super::units::{factor, name_and_unit};
use super::words::next_experiment;
use super::{Detail, pose_details};
use crate::diagnosis::candidate::Kind;
use crate::diagnosis::model::Tumble;
use crate::diagnosis::verdict::{
    Effect, Estimate, Evidence, Fit as FitScore, Outcome, SCHEMA, Score, Source, Verdict, Whiteness,
};
use crate::diagnosis::{Diagnosis, Ranked};
use crate::number::short;
use crate::numerics::special::t_quantile;
use crate::recording::Recording;
use crate::sensor::Sense;

/// What a conclusion is drawn about.
pub struct Case<'a> {
    /// As read.
    pub recording: &'a Recording,
    /// As given.
    pub model: &'a Tumble,
    /// Poses and noise.
    pub observed: &'a Observed<'a>,
    /// Held-out poses.
    pub folds: &'a Folds,
    /// So far.
    pub findings: Vec<String>,
    /// Whether the tool found the poses.
    pub poses_found: bool,
}

impl Case<'_> {
    /// The diagnosis.
    pub fn conclude(mut self, selection: Selection) -> Diagnosis {
        let repaired = &selection.repaired;
        let calibration = Calibration::from_point(&repaired.point);
        let forces = self.observed.forces_m_s2(&calibration);
        let replicates = repaired.replicates(self.observed.poses.len());
        let remainder = Remainder::of(repaired);
        let outcome = self.outcome(&selection, &remainder);
        let effects: Vec<Effect> = selection
            .named
            .iter()
            .zip(&selection.tied)
            .map(|(standing, tied)| self.effect(standing, tied, repaired, &replicates))
            .collect();
        if !selection.base.determined {
            self.findings.push("the poses do not span all directions: the base model itself is not determined".into());
        }
        let detail = self.detail(&selection, calibration, &forces, &effects);
        let score = |rms: [f64; 2]| Score { rmse_before: rms[0], rmse_after: rms[1], ratio_ci95: None };
        let ratio_ci95 = self.ratio_interval(&selection);
        let fit = FitScore {
            unit: "times the noise of a pose".into(),
            noise_floor: 1.0,
            train: score(
                [&selection.base, repaired].map(|f| (f.rows.residual.norm_squared() / f.rows.pose.len() as f64).sqrt()),
            ),
            test_ranges: Vec::new(),
            test: Score {
                ratio_ci95: Some(ratio_ci95),
                ..score([&selection.base, repaired].map(|f| self.held_out_rms(f)))
            },
            log_score: None,
            one_step_rmse: None,
        };
        let verdict = Verdict {
            schema: SCHEMA,
            kind: Kind::Tumble,
            verdict: outcome,
            sentence: self.sentence(outcome, &selection, &remainder, &detail),
            recording: Source {
                file: self.recording.path.display().to_string(),
                sha256: self.recording.sha256.clone(),
                samples: self.recording.samples(),
                rate_hz: self.recording.rate_hz,
            },
            effects,
            location: locate(self.observed, &selection.base, &forces),
            fit,
            residual_after: Whiteness { white: remainder.p_value >= 0.05, p_value: remainder.p_value },
            next_experiment: next_experiment(outcome, &selection, &remainder),
            detectable: Vec::new(),
            findings: self.findings.clone(),
        };
        Diagnosis {
            verdict,
            ranking: self.ranking(&selection),
            repair: Some(self.repair(&selection, &detail)),
            detail: detail.into(),
        }
    }

    fn outcome(&self, selection: &Selection, remainder: &Remainder) -> Outcome {
        if !selection.base.determined || selection.tied.iter().any(|t| !t.is_empty()) {
            Outcome::Undecidable
        } else if !remainder.above.is_empty() {
            Outcome::Unexplained
        } else if selection.named.is_empty() {
            Outcome::Adequate
        } else {
            Outcome::Explained
        }
    }

    fn columns_of(&self, sensor: Sense) -> Vec<String> {
        match sensor {
            Sense::Accelerometer => self.model.columns.accelerometer.to_vec(),
            Sense::Gyro => self.model.columns.gyro.to_vec(),
        }
    }

    fn covariate_unit(&self) -> String {
        self.model.columns.environment.first().map_or("minute".into(), |c| format!("unit of {c}"))
    }

    fn effect(&self, standing: &Standing, tied: &[&'static Term], fit: &Fit, replicates: &[Point]) -> Effect {
        let term = standing.term;
        let interval = |of: &dyn Fn(&Point) -> f64| jackknife(of, fit, replicates);
        let mut parameters = Vec::new();
        if term.id == "scale-factor" {
            let (common, axis, unit) = match term.sensor {
                Sense::Accelerometer => {
                    (accelerometer::SCALE.start, accelerometer::AXIS_SCALE.start, "count per m/s^2")
                }
                Sense::Gyro => (gyro::SCALE.start, gyro::AXIS_SCALE.start, "count per rad/s"),
            };
            for (i, name) in ["scale_x", "scale_y", "scale_z"].into_iter().enumerate() {
                let of = move |p: &Point| p[common] * if i == 0 { 1.0 } else { 1.0 + p[axis + i - 1] };
                parameters.push(estimate(name.into(), unit.into(), of(&fit.point), interval(&of)));
            }
        } else {
            for index in term.active() {
                let (name, unit) = name_and_unit(index, &self.covariate_unit());
                let of = move |p: &Point| p[index] * factor(index);
                parameters.push(estimate(name, unit, of(&fit.point), interval(&of)));
            }
        }
        let candidate = term.candidate();
        Effect {
            id: term.id.into(),
            statement: candidate.statement.into(),
            equation: candidate.equation.into(),
            parameters,
            channels: self.columns_of(term.sensor),
            evidence: Evidence { held_out_gain: standing.gain, p_value: standing.p_value },
            confusable_with: tied.iter().map(|t| t.id.to_owned()).collect(),
        }
    }

    fn detail(
        &self,
        selection: &Selection,
        calibration: Calibration,
        forces: &[Vector3<f64>],
        effects: &[Effect],
    ) -> Detail {
        let both = |group: Group| [&selection.base, &selection.repaired].map(|f| held_out_rms(f, group, self.folds));
        let g_sensitivity = effects
            .iter()
            .filter(|e| e.id == "g-sensitivity")
            .flat_map(|e| e.parameters.iter().map(|p| (p.name.clone(), p.value, p.ci95)))
            .collect();
        let samples = self.observed.imu.accelerometer[0].len();
        let every = (samples / 1500).max(1);
        let length_m_s2 = (0..samples)
            .step_by(every)
            .map(|k| {
                let counts = self.observed.imu.accelerometer_at(k).into();
                let force = calibration.specific_force_m_s2(counts, self.observed.imu.covariate[k]);
                (k as f64 / self.observed.imu.rate_hz, force.norm())
            })
            .collect();
        Detail {
            poses: pose_details(self.observed, &selection.base, &selection.repaired, forces),
            poses_found: self.poses_found,
            held_out: GROUPS.map(both),
            calibration,
            g_sensitivity,
            length_m_s2,
            gravity_m_s2: self.observed.imu.gravity_m_s2,
        }
    }

    fn held_out_rms(&self, fit: &Fit) -> f64 {
        mean_held_out(fit, &GROUPS, self.folds).sqrt()
    }

    /// 95 % interval of after / before on held-out poses: delete-one-pose jackknife of the logarithm.
    fn ratio_interval(&self, selection: &Selection) -> [f64; 2] {
        let per_pose = |fit: &Fit| -> Vec<f64> {
            let groups = GROUPS.map(|g| held_out_squares(fit, g, self.folds));
            (0..self.folds.len()).map(|k| groups.iter().filter_map(|g| g[k]).map(|s| s.0).sum()).collect()
        };
        let (before, after) = (per_pose(&selection.base), per_pose(&selection.repaired));
        let ratio = |skip: usize| {
            let total = |v: &[f64]| v.iter().enumerate().filter(|(k, _)| *k != skip).map(|(_, s)| s).sum::<f64>();
            0.5 * (total(&after) / total(&before).max(f64::MIN_POSITIVE)).max(f64::MIN_POSITIVE).ln()
        };
        let n = self.folds.len();
        let each: Vec<f64> = (0..n).map(ratio).collect();
        let half = t_quantile(0.975, n as f64 - 1.0) * jackknife_deviation(&each);
        let centre = ratio(usize::MAX);
        [(centre - half).exp(), (centre + half).exp()]
    }

    fn ranking(&self, selection: &Selection) -> Vec<Ranked> {
        let row = |s: &Standing, named: bool| Ranked {
            id: s.term.id,
            channels: self.columns_of(s.term.sensor),
            held_out_gain: s.gain,
            ci95: s.ci95,
            p_value: s.p_value,
            named,
            note: self.note(s, named, selection),
        };
        let mut rows: Vec<Ranked> = selection.named.iter().map(|s| row(s, true)).collect();
        rows.extend(selection.others.iter().map(|s| row(s, false)));
        let gravity = CANDIDATES.iter().find(|c| c.id == "local-gravity");
        rows.extend(gravity.map(|c| Ranked {
            id: c.id,
            channels: self.columns_of(Sense::Accelerometer),
            held_out_gain: 0.0,
            ci95: [0.0; 2],
            p_value: 1.0,
            named: false,
            note: "cannot be told from the common scale by any pose: both multiply |f|".into(),
        }));
        rows
    }

    fn note(&self, s: &Standing, named: bool, selection: &Selection) -> String {
        let judged = format!("judged by {}", s.term.judged.words());
        if named {
            return format!("{judged}, beside the others named");
        }
        if s.withdrawn {
            return format!("{judged}; it helps, but what is left stays above the noise");
        }
        if !s.determined {
            return format!("{judged}; not determined by these poses");
        }
        if !s.plausible {
            return format!("{judged}; fitted outside its plausible range");
        }
        // The earth's rate along gravity looks like a diagonal of g-sensitivity; its level part is what could be seen.
        let smallest = match s.term.id {
            "earth-rate" => s.visible.iter().copied().fold(f64::INFINITY, f64::min),
            _ => s.visible.iter().copied().fold(0.0, f64::max),
        };
        let unit = s.term.active().next().map(|p| name_and_unit(p, &self.covariate_unit()).1).unwrap_or_default();
        let power = if s.term.id == "earth-rate" {
            format!("; the earth's rate is 15.04 °/h, and below {} °/h none could be seen", short(smallest))
        } else if s.visible.is_empty() {
            String::new()
        } else {
            format!("; above {} {unit} it would have been seen", short(smallest))
        };
        let added = if selection.named.is_empty() { "" } else { ", beside those named" };
        format!("{judged}{added}{power}")
    }
}

fn estimate(name: String, unit: String, value: f64, half: f64) -> Estimate {
    Estimate { name, value, unit, ci95: [value - half, value + half] }
}

/// Half the width of a 95 % interval from delete-one-pose replicates.
fn jackknife(of: &dyn Fn(&Point) -> f64, fit: &Fit, replicates: &[Point]) -> f64 {
    let each: Vec<f64> = replicates.iter().map(of).collect();
    // Each pose brings about six equations; a parameter costs its share of a pose.
    let freedom = (each.len() as f64 - fit.active.len() as f64 / 6.0).max(2.0);
    t_quantile(0.975, freedom) * jackknife_deviation(&each)
}

fn jackknife_deviation(each: &[f64]) -> f64 {
    let n = each.len().max(1) as f64;
    let mean = each.iter().sum::<f64>() / n;
    ((n - 1.0) / n * each.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
}

/// Root mean square of held-out residuals in public units, unweighted.
fn held_out_rms(fit: &Fit, group: Group, folds: &Folds) -> f64 {
    let residual = fit.held_out(folds);
    let judged = (0..residual.len()).filter(|r| fit.rows.group[*r] == group && folds[fit.rows.pose[*r]].is_some());
    let (sum, n) = judged.fold((0.0, 0.0), |s, r| (s.0 + (residual[r] * fit.rows.deviation[r]).powi(2), s.1 + 1.0));
    (sum / f64::max(n, 1.0)).sqrt() * group.factor()
}

fn mean_held_out(fit: &Fit, groups: &[Group], folds: &Folds) -> f64 {
    let all = groups.iter().flat_map(|g| held_out_squares(fit, *g, folds)).flatten();
    let (sum, n) = all.fold((0.0, 0), |s, (sum, n)| (s.0 + sum, s.1 + n));
    sum / f64::from(n.max(1) as u32)
}
