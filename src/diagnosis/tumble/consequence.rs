//! The loop closed for a tumble recording: the sensor with its measured noise, and what the
//! omission costs.
//!
//! The cost is stated along one axis and in one attitude, where misalignment and g-sensitivity are
//! constant errors; the study has them axis by axis (`by_axis`).

use super::Detail;
use super::by_axis::{self, Lacking};
use super::calibration::Calibration;
use super::candidate::Term;
use super::conclusion::Case;
use super::selection::Selection;
use crate::motion::temperature::Temperature;
use crate::navigation::closed_form::Process;
use crate::number::short;
use crate::numerics::moments;
use crate::repair::{Cost, Repair, Row, Vibration};
use crate::sensor::{Sense, Sensor, coupling};
use crate::units::{DEGREE_PER_HOUR, STANDARD_GRAVITY_M_S2};
use crate::warm_profile::{is_possible, profile};

impl Case<'_> {
    /// Sensor before and after, and the cost by sensor.
    pub(super) fn repair(&self, selection: &Selection, detail: &Detail) -> Repair {
        let noise = |of: &[super::noise::AxisNoise; 3], scale: f64| {
            let mean = |f: &dyn Fn(&super::noise::AxisNoise) -> f64| of.iter().map(f).sum::<f64>() / 3.0 / scale;
            (mean(&|n| n.random_walk), mean(&|n| n.bias_instability))
        };
        let (vrw, acceleration_flicker) = noise(&self.observed.accelerometer_noise, self.observed.accelerometer_scale);
        let (arw, rate_flicker) = noise(&self.observed.gyro_noise, self.observed.gyro_scale);
        let mut after = Sensor::default();
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
                row: Row::Own,
                of: of.into(),
                under: "held in one attitude, rms over the recorded ones".into(),
                position_10_s_m: ten,
                position_60_s_m: sixty,
                basis: if integrations == 2 { "½ b t²" } else { "g ω t³/6" }.into(),
            }
        };
        let mut own_cost = Vec::new();
        for sensor in [Sense::Accelerometer, Sense::Gyro] {
            let ids: Vec<&str> = selection.named_terms().filter(|t| t.sensor == sensor).map(Term::id).collect();
            if ids.is_empty() {
                continue;
            }
            own_cost.push(match sensor {
                Sense::Accelerometer => {
                    at_rest(&format!("accelerometer: {}", ids.join(", ")), Process::Constant(force), 2, 1.0)
                }
                Sense::Gyro => {
                    at_rest(&format!("gyro: {}", ids.join(", ")), Process::Constant(rate), 3, STANDARD_GRAVITY_M_S2)
                }
            });
        }
        let warmth = self.warmth();
        let of = |term| by_axis::of(term, &detail.calibration, warmth.is_some());
        let named: Vec<_> = selection.named_terms().map(|term| (term, of(term))).collect();
        let not_expressible = named.iter().filter_map(|(t, (_, lacking))| {
            let why = match lacking {
                Lacking::Nothing => return None,
                Lacking::Elements => {
                    "a study has one number for each row, and draws each element about the mean of the row with its spread"
                }
                Lacking::Temperature => "its column holds values that are no temperature in °C",
                Lacking::All => "a study has no key for it",
            };
            Some(format!("{} ({}): {why}", t.phrase(), t.candidate.equation))
        });
        let mut by_axis: Vec<_> = named.iter().filter_map(|(_, (numbers, _))| *numbers).collect();
        by_axis.extend(by_axis::cubes(&by_axis, &detail.calibration));
        if self.observed.imu.gyro.is_some() {
            by_axis.extend(by_axis::turned_gyro(&by_axis, &detail.calibration));
        }
        let follows = by_axis.iter().any(|(key, _)| coupling::OVER_TEMPERATURE.contains(key));
        let moving = if named.iter().any(|(_, (numbers, _))| numbers.is_some()) {
            " The study lies still; give it a [trajectory] of your own motion."
        } else {
            ""
        };
        let warm = match self.model.columns.environment.first().filter(|_| follows) {
            Some(name) => format!(" [temperature] is the column `{name}`, one of its units taken as 1 °C."),
            None => String::new(),
        };
        Repair {
            before,
            after,
            is_inertial: true,
            by_axis,
            not_expressible: not_expressible.collect(),
            temperature: warmth.filter(|_| follows).unwrap_or_default(),
            relation: format!(
                "Counts became m/s² and rad/s by offsets and one scale a sensor, as fitted here ({} counts per m/s², {} per \
                 rad/s), so the repaired sensor has no bias and no common scale error. Without the named physics a sensor at rest errs by {} mm/s² and {} °/h (rms over axes and recorded attitudes); \
                 that is the constant bias of the first row.{moving}{warm}",
                short(detail.calibration.accelerometer.scale.mean()),
                short(detail.calibration.gyro.scale.mean()),
                short(force * 1e3),
                short(rate / DEGREE_PER_HOUR)
            ),
            vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 0.0 },
            own_cost,
        }
    }

    /// The environment column as the temperature that a study follows; `None` where there is none,
    /// or it is none in °C.
    fn warmth(&self) -> Option<Temperature> {
        let name = self.model.columns.environment.first()?;
        let logged = self.recording.columns.iter().find(|column| column.name == *name)?;
        let points = profile(&logged.values, self.observed.imu.rate_hz, |deg_c| deg_c);
        is_possible(&points).then(|| Temperature::new(points, moments::mean(&logged.values)))
    }

    /// Returns what the base model gets wrong at rest next to the repaired one: m/s² and rad/s per
    /// axis, rms over the poses.
    fn leftover(&self, selection: &Selection) -> (f64, f64) {
        let (base, repaired) =
            (Calibration::from_point(&selection.base.point), Calibration::from_point(&selection.chosen.point));
        let count = 3.0 * self.observed.poses.len().max(1) as f64;
        let (force, rate) = self.observed.poses.iter().fold((0.0, 0.0), |sums, pose| {
            let of = |c: &Calibration| {
                let f = c.specific_force_m_s2(pose.accelerometer.into(), &pose.slow);
                (f, c.rate_rad_s(pose.gyro.into(), &f, &pose.slow))
            };
            let ((f0, w0), (f1, w1)) = (of(&base), of(&repaired));
            (sums.0 + (f0 - f1).norm_squared(), sums.1 + (w0 - w1).norm_squared())
        });
        ((force / count).sqrt(), (rate / count).sqrt())
    }
}
