//! From a selection to the verdict: outcome, intervals, what it costs and what to do next.

use nalgebra::Vector3;

use super::calibration::{Calibration, Point, Sensor as Which, accelerometer, gyro};
use super::candidate::{CANDIDATES, Term};
use super::fit::Fit;
use super::imu::Observed;
use super::isolation::{locate, residuals};
use super::rows::{GROUPS, Group};
use super::selection::{FALSE_NAME, Folds, Selection, Standing, held_out_squares};
use super::units::{factor, name_and_unit};
use super::{Detail, pose_details};
use crate::diagnosis::candidate::Kind;
use crate::diagnosis::model::Tumble;
use crate::diagnosis::repair::{Cost, Repair, Vibration};
use crate::diagnosis::verdict::{
    Effect, Estimate, Evidence, Fit as FitScore, Outcome, SCHEMA, Score, Source, Verdict, Whiteness,
};
use crate::diagnosis::{Diagnosis, Ranked};
use crate::navigation::closed_form::Process;
use crate::numerics::special::{f_above, normal_cdf, t_quantile};
use crate::recording::Recording;
use crate::sensor::Sensor;
use crate::units::{DEGREE_PER_HOUR, STANDARD_GRAVITY_M_S2};

/// Degrees of freedom behind the measured noise: its own uncertainty is about ±13 %.
const NOISE_FREEDOM: f64 = 60.0;
/// The remaining residual is more than noise below this probability.
const UNEXPLAINED: f64 = 0.003;
/// The remaining residual must also be this many times the noise variance: less is within what a noise model can promise.
const MATERIAL: f64 = 1.6;

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

/// What is left after repair.
struct Remainder {
    p_value: f64,
    worst: Option<(Group, f64)>,
}

impl Case<'_> {
    /// The diagnosis.
    pub fn conclude(mut self, selection: Selection) -> Diagnosis {
        let repaired = &selection.repaired;
        let calibration = Calibration::from_point(&repaired.point);
        let forces = self.observed.forces_m_s2(&calibration);
        let replicates = repaired.replicates(self.observed.poses.len());
        let remainder = remainder(repaired);
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
        } else if remainder.worst.is_some() {
            Outcome::Unexplained
        } else if selection.named.is_empty() {
            Outcome::Adequate
        } else {
            Outcome::Explained
        }
    }

    fn columns_of(&self, sensor: Which) -> Vec<String> {
        match sensor {
            Which::Accelerometer => self.model.columns.accelerometer.to_vec(),
            Which::Gyro => self.model.columns.gyro.to_vec(),
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
                Which::Accelerometer => {
                    (accelerometer::SCALE.start, accelerometer::AXIS_SCALE.start, "count per m/s^2")
                }
                Which::Gyro => (gyro::SCALE.start, gyro::AXIS_SCALE.start, "count per rad/s"),
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
        let both = |group: Group| {
            let noise = residuals(&selection.repaired).iter().find(|r| r.group == group).map_or(0.0, |r| r.noise);
            [&selection.base, &selection.repaired].map(|f| mean_held_out(f, &[group], self.folds).sqrt() * noise)
        };
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
            before: residuals(&selection.base),
            after: residuals(&selection.repaired),
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
            channels: self.columns_of(Which::Accelerometer),
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
        if !s.determined {
            return format!("{judged}; not determined by these poses");
        }
        if !s.plausible {
            return format!("{judged}; fitted outside its plausible range");
        }
        let smallest = s.visible.iter().copied().fold(0.0, f64::max);
        let unit = s.term.active().next().map(|p| name_and_unit(p, &self.covariate_unit()).1).unwrap_or_default();
        let power = if s.term.id == "earth-rate" {
            format!("; the earth's 15.04 °/h would have to exceed {} °/h to be seen", round(smallest))
        } else if s.visible.is_empty() {
            String::new()
        } else {
            format!("; above {} {unit} it would have been seen", round(smallest))
        };
        let added = if selection.named.is_empty() { "" } else { ", beside those named" };
        format!("{judged}{added}{power}")
    }

    fn sentence(&self, outcome: Outcome, selection: &Selection, remainder: &Remainder, detail: &Detail) -> String {
        let improvement = |group: Group| {
            let n = GROUPS.iter().position(|g| *g == group).unwrap_or(0);
            let [before, after] = detail.held_out[n];
            format!("{} {} → {} {}", group.words(), round(before), round(after), group.unit())
        };
        let names: Vec<String> = selection.named.iter().map(|s| spoken(s.term)).collect();
        match outcome {
            Outcome::Adequate => format!(
                "Nothing is missing that these {} poses could show: what is left of gravity, of the gyro at rest and of \
                 the turns is noise.",
                self.observed.poses.len()
            ),
            Outcome::Explained => format!(
                "The model left out {}. With {} fitted, poses that were held out agree: {}.",
                join(&names),
                if names.len() == 1 { "it" } else { "them" },
                join(&GROUPS.map(improvement))
            ),
            Outcome::Unexplained => {
                let (group, times) = remainder.worst.unwrap_or((Group::Gravity, 1.0));
                let part = match names.is_empty() {
                    true => "Nothing in the library accounts for the mismatch".to_owned(),
                    false => format!("{} {} named, but something else is left out", join(&names), is_are(&names)),
                };
                format!("{part}: {} still errs by {} times its noise.", group.words(), round(times.sqrt()))
            }
            Outcome::Undecidable if !selection.base.determined => {
                "These poses do not span all directions, so that not even offsets and scales are determined.".into()
            }
            Outcome::Undecidable => {
                let pairs: Vec<String> = selection
                    .named
                    .iter()
                    .zip(&selection.tied)
                    .filter(|(_, t)| !t.is_empty())
                    .map(|(s, t)| {
                        format!("{} or {}", spoken(s.term), t.iter().map(|t| t.id).collect::<Vec<_>>().join(" or "))
                    })
                    .collect();
                format!("Something is left out, but these poses cannot tell which: {}.", join(&pairs))
            }
        }
    }

    fn repair(&self, selection: &Selection, detail: &Detail) -> Repair {
        let noise = |of: &[super::noise::AxisNoise; 3], scale: f64| {
            let mean = |f: &dyn Fn(&super::noise::AxisNoise) -> f64| of.iter().map(f).sum::<f64>() / 3.0 / scale;
            (mean(&|n| n.random_walk), mean(&|n| n.bias_instability))
        };
        let (vrw, acceleration_flicker) = noise(&self.observed.accelerometer_noise, self.observed.accelerometer_scale);
        let (arw, rate_flicker) = noise(&self.observed.gyro_noise, self.observed.gyro_scale);
        let mut after = Sensor::ideal();
        after.accelerometer.velocity_random_walk_m_s_rts = vrw;
        after.accelerometer.bias_instability_m_s2 = acceleration_flicker;
        after.gyro.angle_random_walk_rad_rts = arw;
        after.gyro.bias_instability_rad_s = rate_flicker;
        let mut before = after;
        let (force, rate) = self.leftover(selection);
        if !selection.named.is_empty() {
            before.accelerometer.bias_m_s2 = force;
            before.gyro.bias_rad_s = rate;
        }
        let at_rest = |of: &str, process: Process, integrations: u32, lever: f64| {
            let [ten, sixty] = [10.0, 60.0].map(|t| process.variance(integrations, t).sqrt() * lever);
            Cost {
                of: of.into(),
                under: "held in one attitude, rms over the recorded ones".into(),
                position_10_s_m: ten,
                position_60_s_m: sixty,
                basis: if integrations == 2 { "½ b t²" } else { "g ω t³/6" }.into(),
            }
        };
        let mut own_cost = Vec::new();
        for sensor in [Which::Accelerometer, Which::Gyro] {
            let ids: Vec<&str> =
                selection.named.iter().filter(|s| s.term.sensor == sensor).map(|s| s.term.id).collect();
            if ids.is_empty() {
                continue;
            }
            own_cost.push(match sensor {
                Which::Accelerometer => {
                    at_rest(&format!("accelerometer: {}", ids.join(", ")), Process::Constant(force), 2, 1.0)
                }
                Which::Gyro => {
                    at_rest(&format!("gyro: {}", ids.join(", ")), Process::Constant(rate), 3, STANDARD_GRAVITY_M_S2)
                }
            });
        }
        Repair {
            before,
            after,
            relation: format!(
                "Counts became m/s² and rad/s by the calibration found here ({} counts per m/s², {} per rad/s). Without \
                 the named physics a sensor at rest errs by {} mm/s² and {} °/h (rms over axes and recorded attitudes); \
                 that is the constant bias of the first row.",
                round(detail.calibration.accelerometer.scale.mean()),
                round(detail.calibration.gyro.scale.mean()),
                round(force * 1e3),
                round(rate / DEGREE_PER_HOUR)
            ),
            not_expressible: selection
                .named
                .iter()
                .map(|s| {
                    format!(
                        "{} ({}): a study has one axis and one attitude",
                        spoken(s.term),
                        s.term.candidate().equation
                    )
                })
                .collect(),
            vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 0.0 },
            own_cost,
        }
    }

    /// What the base model gets wrong at rest beside the repaired one: m/s² and rad/s per axis, rms over the poses.
    fn leftover(&self, selection: &Selection) -> (f64, f64) {
        let (base, repaired) =
            (Calibration::from_point(&selection.base.point), Calibration::from_point(&selection.repaired.point));
        let count = 3.0 * self.observed.poses.len().max(1) as f64;
        let (force, rate) = self.observed.poses.iter().fold((0.0, 0.0), |sums, pose| {
            let of = |c: &Calibration| {
                let f = c.specific_force_m_s2(pose.accelerometer.into(), pose.covariate);
                (f, c.rate_rad_s(pose.gyro.into(), &f, pose.covariate))
            };
            let ((f0, w0), (f1, w1)) = (of(&base), of(&repaired));
            (sums.0 + (f0 - f1).norm_squared(), sums.1 + (w0 - w1).norm_squared())
        });
        ((force / count).sqrt(), (rate / count).sqrt())
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

fn mean_held_out(fit: &Fit, groups: &[Group], folds: &Folds) -> f64 {
    let all = groups.iter().flat_map(|g| held_out_squares(fit, *g, folds)).flatten();
    let (sum, n) = all.fold((0.0, 0), |s, (sum, n)| (s.0 + sum, s.1 + n));
    sum / f64::from(n.max(1) as u32)
}

/// Is what is left more than noise, and does it remember the pose before?
fn remainder(fit: &Fit) -> Remainder {
    let mut tests: Vec<f64> = Vec::new();
    let mut worst: Option<(Group, f64, f64)> = None;
    for group in GROUPS {
        let (ratio, n) = (fit.reduced(group), fit.rows.chi_square(group).1 as f64);
        let freedom = (n - fit.leverage(group)).max(1.0);
        let p = f_above(ratio, freedom, NOISE_FREEDOM);
        tests.push(p);
        if p < UNEXPLAINED / 3.0 && ratio > MATERIAL && worst.is_none_or(|w| p < w.2) {
            worst = Some((group, ratio, p));
        }
    }
    for channel in 0..4 {
        let values: Vec<f64> = (0..fit.rows.group.len())
            .filter(|r| fit.rows.group[*r] != Group::Turn)
            .collect::<Vec<_>>()
            .chunks_exact(4)
            .map(|rows| fit.rows.residual[rows[channel]])
            .collect();
        tests.push(memory(&values));
    }
    let count = tests.len() as f64;
    let smallest = tests.into_iter().fold(1.0, f64::min);
    Remainder { p_value: (smallest * count).min(1.0), worst: worst.map(|w| (w.0, w.1)) }
}

/// Probability of so strong a correlation between neighbouring poses by chance.
fn memory(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n.max(1.0);
    let power: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if n < 8.0 || power <= 0.0 {
        return 1.0;
    }
    let product: f64 = values.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    let z = (product / power + 1.0 / n) * n.sqrt();
    2.0 * (1.0 - normal_cdf(z.abs()))
}

fn next_experiment(outcome: Outcome, selection: &Selection, remainder: &Remainder) -> String {
    match outcome {
        Outcome::Adequate => "To see smaller effects: more poses, each longer, spread over all directions, and quick turns \
                              between them."
            .into(),
        Outcome::Explained => "Repeat the poses on another day with this calibration: constants that hold are the \
                               sensor's, constants that move are temperature or mounting."
            .into(),
        Outcome::Unexplained => match remainder.worst {
            Some((Group::Still, _)) => "Repeat the same attitude with another heading, and after turning in from the other \
                                        side: a rate that follows the heading points outside the sensor, one that follows \
                                        the way in points to hysteresis."
                .into(),
            Some((Group::Turn, _)) => "Repeat single turns about one axis, slow and fast, to and fro: what depends on speed \
                                       is the gyro's bandwidth or clock, what depends on direction its scale."
                .into(),
            _ => "Return to the same attitude from opposite sides several times: bias that depends on the way in is \
                  hysteresis, bias that does not repeat is the mount."
                .into(),
        },
        Outcome::Undecidable if !selection.base.determined => {
            "Add poses on the faces and edges that are missing: each axis up, down and slanted.".into()
        }
        Outcome::Undecidable => "Add poses where the candidates differ: each axis up and down, slanted in between, and \
                                 every attitude twice at different times."
            .into(),
    }
}

fn spoken(term: &Term) -> String {
    let sensor = match term.sensor {
        Which::Accelerometer => "accelerometer",
        Which::Gyro => "gyro",
    };
    format!("{} of the {sensor}", term.id)
}

fn join(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

fn is_are(names: &[String]) -> &'static str {
    if names.len() == 1 { "is" } else { "are" }
}

/// Two digits, plainly.
fn round(value: f64) -> String {
    let size = value.abs().max(1e-12).log10().floor();
    let digits = (1.0 - size).clamp(0.0, 8.0) as usize;
    format!("{value:.digits$}")
}

/// What is smallest of an effect that would still have been named, in public units: threshold and power of 95 %.
pub fn visible(deviations: impl Iterator<Item = (usize, f64)>, tried: usize) -> Vec<f64> {
    // Normal quantiles for a two-sided test at the corrected level, plus 1.645 for the power.
    let level = crate::numerics::special::normal_quantile(1.0 - FALSE_NAME / tried.max(1) as f64 / 2.0) + 1.645;
    deviations.map(|(p, d)| level * d * factor(p)).collect()
}
