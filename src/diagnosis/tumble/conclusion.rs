//! From a selection to the verdict: outcome, intervals, what it costs and what to do next.

use nalgebra::Vector3;

use super::account::{Account, Drift, Fate, Knocked, Location, NamedTerm, SeenFrom};
use super::by_pose::pose_details;
use super::calibration::{Calibration, Point, gyro};
use super::candidate::{NEVER_FITTED, Seen, Stated};
use super::detail::Detail;
use super::estimated;
use super::fit::Fit;
use super::group::{GROUPS, Group};
use super::imu::Observed;
use super::isolation::locate;
use super::jackknife;
use super::residual::Residual;
use super::selection::{Drifting, Named, Selection};
use super::standing::{Folds, Standing, held_out_squares};
use super::units::{factor, name_and_unit};
use crate::answer::{self, Answer};
use crate::candidate::Kind;
use crate::model::Tumble;
use crate::numerics::moments;
use crate::numerics::special::t_quantile;
use crate::recording::Recording;
use crate::ruling::{self, rule};
use crate::sensor::Sense;
use crate::standing::{Gain, Note, Ranked};
use crate::units::DEGREE;
use crate::verdict::{Effect, Estimate, Evidence, Fit as FitScore, RecordingInfo, Score};

/// Holds what a search found.
pub(super) struct Found {
    /// Base model, chosen model and what stands in it.
    pub selection: Selection,
    /// Poses that were left out.
    pub knocked: Vec<usize>,
    /// States whether the noise of a pose was raised to what wanders between the poses.
    pub wanders: bool,
}

/// Holds what a conclusion is drawn about.
pub(super) struct Case<'a> {
    /// The recording as read.
    pub recording: &'a Recording,
    /// Its model.toml.
    pub model: &'a Tumble,
    /// Poses and moves with their noise.
    pub observed: &'a Observed<'a>,
    /// Which poses are held out in turn.
    pub folds: &'a Folds,
    /// Findings of the intake, one sentence each.
    pub findings: Vec<String>,
    /// States whether the tool found the poses.
    pub poses_found: bool,
}

impl Case<'_> {
    /// The diagnosis, from what the selection found.
    pub(super) fn conclude(mut self, found: Found) -> Answer {
        let selection = &found.selection;
        if !selection.base.determined {
            self.findings.push("the poses do not span all directions: the base model itself is not determined".into());
        }
        let calibration = Calibration::from_point(&selection.chosen.point);
        let forces = self.observed.forces_m_s2(&calibration);
        let residual = Residual::of(&selection.chosen);
        let replicates = selection.chosen.replicates(self.observed.poses.len());
        let effects: Vec<Effect> =
            selection.named.iter().map(|n| self.effect(n, &selection.chosen, &replicates)).collect();
        let (places, location) = locate(self.observed, &selection.base, &forces);
        let account = self.account(&found, &residual, location);
        let detail = self.detail(selection, account, calibration, &forces, &effects);
        Answer {
            kind: Kind::Tumble,
            outcome: rule(&evidence(selection, &residual, self.ratio_interval(selection)[0])),
            recording: RecordingInfo::of(self.recording),
            base: Vec::new(),
            effects,
            places,
            fit: self.fit(selection),
            residual_after: residual.remainder.whiteness(),
            ranking: self.ranking(selection),
            trace: Vec::new(),
            repair: Some(self.repair(selection, &detail)),
            detail: answer::Detail::Tumble(Box::new(detail)),
            findings: self.findings,
        }
    }

    fn fit(&self, selection: &Selection) -> FitScore {
        let both = [&selection.base, &selection.chosen];
        let score = |[rmse_before, after]: [f64; 2], ratio_ci95| Score {
            rmse_before,
            rmse_after: Some(after),
            ratio_ci95,
            share: None,
        };
        let fitted = both.map(|f| (f.rows.residual.norm_squared() / f.rows.pose.len() as f64).sqrt());
        FitScore {
            unit: "times the noise of a pose".into(),
            noise_floor: 1.0,
            noise: None,
            train: score(fitted, None),
            test_ranges: Vec::new(),
            recordings: Vec::new(),
            test: score(both.map(|f| self.held_out_rms(f)), Some(self.ratio_interval(selection))),
            log_score: None,
            with_unnamed: None,
            one_step_rmse: None,
        }
    }

    fn columns_of(&self, sensor: Sense) -> Vec<String> {
        match sensor {
            Sense::Accelerometer => self.model.columns.accelerometer.to_vec(),
            Sense::Gyro => self.model.columns.gyro.iter().flatten().cloned().collect(),
        }
    }

    fn covariate_unit(&self) -> String {
        self.model.columns.environment.first().map_or("unit of a column".into(), |c| format!("unit of {c}"))
    }

    fn effect(&self, named: &Named, fit: &Fit, replicates: &[Point]) -> Effect {
        let term = named.standing.term;
        let interval = |of: &dyn Fn(&Point) -> f64| jackknife::half_width(of, fit, replicates);
        let mut parameters = Vec::new();
        match term.stated {
            Stated::AxisScales { common, ratio, unit } => {
                for (i, name) in ["scale_x", "scale_y", "scale_z"].into_iter().enumerate() {
                    let of = move |p: &Point| p[common] * if i == 0 { 1.0 } else { 1.0 + p[ratio + i - 1] };
                    parameters.push(estimate(name.into(), unit.into(), of(&fit.point), interval(&of)));
                }
            }
            Stated::RmsOfDrift => {
                let (unit, factor) = match term.sensor {
                    Sense::Accelerometer => ("m/s^2", 1.0),
                    Sense::Gyro => ("°/s", 1.0 / DEGREE),
                };
                for (axis, name) in ["rms_x", "rms_y", "rms_z"].into_iter().enumerate() {
                    let of = move |p: &Point| moments::rms(self.drift(term.sensor, p)[axis].iter().copied()) * factor;
                    parameters.push(estimate(name.into(), unit.into(), of(&fit.point), interval(&of)));
                }
            }
            Stated::AsFitted => {
                for index in term.active() {
                    let (name, unit) = name_and_unit(index, &self.covariate_unit());
                    let of = move |p: &Point| p[index] * factor(index);
                    parameters.push(estimate(name, unit, of(&fit.point), interval(&of)));
                }
            }
        }
        Effect {
            id: term.id().into(),
            statement: term.candidate.statement.into(),
            equation: term.candidate.equation.into(),
            parameters,
            channels: self.columns_of(term.sensor),
            form: None,
            evidence: Evidence { held_out_gain: named.standing.gain, p_value: named.standing.p_value },
            share: None,
            base: Vec::new(),
            confusable_with: named.rivals.iter().map(|t| t.id().to_owned()).collect(),
        }
    }

    fn detail(
        &self,
        selection: &Selection,
        account: Account,
        calibration: Calibration,
        forces: &[Vector3<f64>],
        effects: &[Effect],
    ) -> Detail {
        let both = |group: Group| [&selection.base, &selection.chosen].map(|f| held_out_rms(f, group, self.folds));
        let g_sensitivity = selection
            .named_terms()
            .zip(effects)
            .filter(|(t, _)| t.active().eq(gyro::G_SENSITIVITY))
            .flat_map(|(_, e)| e.parameters.iter().map(|p| (p.name.clone(), p.value, p.ci95)))
            .collect();
        let samples = self.observed.imu.accelerometer[0].len();
        let every = (samples / 1500).max(1);
        let length_m_s2 = (0..samples)
            .step_by(every)
            .map(|k| {
                let counts = self.observed.imu.accelerometer_at(k).into();
                let force = calibration.specific_force_m_s2(counts, &self.observed.imu.slow_at(k));
                (k as f64 / self.observed.imu.rate_hz, force.norm())
            })
            .collect();
        Detail {
            poses: pose_details(self.observed, &selection.base, &selection.chosen, forces),
            poses_found: self.poses_found,
            held_out: GROUPS.map(both),
            calibration,
            published: estimated::calibration(self.observed, &selection.chosen),
            g_sensitivity,
            length_m_s2,
            gravity_m_s2: self.observed.imu.gravity_m_s2,
            account,
        }
    }

    fn held_out_rms(&self, fit: &Fit) -> f64 {
        mean_held_out(fit, &GROUPS, self.folds).sqrt()
    }

    /// 95 % interval of after / before on held-out poses: delete-one-pose jackknife of the
    /// logarithm.
    fn ratio_interval(&self, selection: &Selection) -> [f64; 2] {
        let per_pose = |fit: &Fit| -> Vec<f64> {
            let groups = GROUPS.map(|g| held_out_squares(fit, g, self.folds));
            (0..self.folds.len()).map(|k| groups.iter().filter_map(|g| g[k]).map(|s| s.0).sum()).collect()
        };
        let (before, after) = (per_pose(&selection.base), per_pose(&selection.chosen));
        let ratio = |skip: usize| {
            let total = |v: &[f64]| v.iter().enumerate().filter(|(k, _)| *k != skip).map(|(_, s)| s).sum::<f64>();
            0.5 * (total(&after) / total(&before).max(f64::MIN_POSITIVE)).max(f64::MIN_POSITIVE).ln()
        };
        let n = self.folds.len();
        let each: Vec<f64> = (0..n).map(ratio).collect();
        let half = t_quantile(0.975, n as f64 - 1.0) * jackknife::deviation(&each);
        let centre = ratio(usize::MAX);
        [(centre - half).exp(), (centre + half).exp()]
    }

    fn ranking(&self, selection: &Selection) -> Vec<Ranked> {
        let row = |s: &Standing, named: bool| Ranked {
            id: s.term.id(),
            channels: self.columns_of(s.term.sensor),
            gain: Gain::held_out(s.gain, s.ci95),
            p_value: s.p_value,
            named,
            note: Note::InPoses { judged: s.term.judged, fate: self.fate(s, named, !selection.named.is_empty()) },
        };
        let mut rows: Vec<Ranked> = selection.named.iter().map(|n| row(&n.standing, true)).collect();
        rows.extend(selection.others.iter().map(|s| row(s, false)));
        rows.push(Ranked {
            id: NEVER_FITTED.id,
            channels: self.columns_of(Sense::Accelerometer),
            gain: Gain::held_out(0.0, [0.0; 2]),
            p_value: 1.0,
            named: false,
            note: Note::Indistinguishable,
        });
        rows
    }

    fn fate(&self, s: &Standing, named: bool, beside_named: bool) -> Fate {
        if named {
            return Fate::Named;
        }
        if s.withdrawn {
            return Fate::Withdrawn;
        }
        if !s.determined {
            return Fate::Undetermined;
        }
        if !s.plausible {
            return Fate::Implausible;
        }
        let seen_from = match s.term.seen {
            Seen::InItsBestDirection => {
                Some(SeenFrom::EarthRateDegH(s.visible.iter().copied().fold(f64::INFINITY, f64::min)))
            }
            Seen::InEveryParameter if s.visible.is_empty() => None,
            Seen::InEveryParameter => Some(SeenFrom::Strength {
                value: s.visible.iter().copied().fold(0.0, f64::max),
                unit: s.term.active().next().map(|p| name_and_unit(p, &self.covariate_unit()).1).unwrap_or_default(),
            }),
        };
        Fate::Absent { beside_named, seen_from }
    }

    /// Returns what the words rest on.
    fn account(&self, found: &Found, residual: &Residual, location: Location) -> Account {
        let selection = &found.selection;
        let named = |n: &Named| NamedTerm {
            id: n.standing.term.id(),
            sensor: n.standing.term.sensor,
            rivals: n.rivals.iter().map(|t| t.id()).collect(),
        };
        let oversized = selection.others.iter().filter(|s| s.would_but_for_its_size());
        let seconds = |k: &usize| {
            let samples = &self.observed.poses[*k].samples;
            [samples.start, samples.end].map(|s| s as f64 / self.observed.imu.rate_hz)
        };
        Account {
            base_determined: selection.base.determined,
            with_gyro: self.observed.imu.gyro.is_some(),
            named: selection.named.iter().map(named).collect(),
            above: residual.above.clone(),
            oversized: oversized.map(|s| (s.term.id(), s.term.sensor)).collect(),
            location,
            drifts: selection.drifting.iter().map(|d| self.told_drift(*d, &selection.chosen.point)).collect(),
            has_column: self.observed.imu.covariate.is_some(),
            knocked: found.knocked.iter().map(|k| Knocked { pose: k + 1, time_s: seconds(k) }).collect(),
            wanders: found.wanders,
        }
    }

    fn told_drift(&self, Drifting { sensor, is_named }: Drifting, point: &Point) -> Drift {
        let factor = if sensor == Sense::Gyro { 1.0 / DEGREE } else { 1e3 };
        let range = self.drift(sensor, point).map(|of| {
            let (low, high) = of.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            (high - low) * factor
        });
        Drift { sensor, is_named, range }
    }

    /// The drift of a sensor's offsets at each pose about its mean over the poses, per axis, SI.
    fn drift(&self, sensor: Sense, point: &Point) -> [Vec<f64>; 3] {
        let calibration = Calibration::from_point(point);
        let triad = if sensor == Sense::Gyro { &calibration.gyro } else { &calibration.accelerometer };
        std::array::from_fn(|axis| {
            let at = |p: &super::imu::Pose| (0..3).map(|n| triad.drift[(axis, n)] * p.slow.cosines[n]).sum::<f64>();
            let values: Vec<f64> = self.observed.poses.iter().map(at).collect();
            let mean = moments::mean(&values);
            values.into_iter().map(|v| v - mean).collect()
        })
    }
}

/// Returns what the verdict rests on.
fn evidence(selection: &Selection, residual: &Residual, held_out_ratio: f64) -> ruling::Evidence {
    ruling::Evidence {
        base_determined: selection.base.determined && selection.chosen.determined,
        named: selection.named.len(),
        tied: selection.named.iter().filter(|n| !n.rivals.is_empty()).count(),
        remainder: residual.remainder.size,
        held_out_ratio,
        ..ruling::Evidence::default()
    }
}

fn estimate(name: String, unit: String, value: f64, half: f64) -> Estimate {
    Estimate { name, value, unit, ci95: [value - half, value + half] }
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
