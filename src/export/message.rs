//! The messages of a sensor: at what rate they come, behind which filter, and what a target of them
//! lacks.
//!
//! Not for the noise of one: that is `filter`'s.

use super::filter::Filter;
use super::imu::{Errors, Imu};
use super::sheet::Sheet;
use super::{TARGETS, Target};
use proofmass_base::error::{Error, Result};
use proofmass_base::number::short;
use std::f64::consts::PI;

/// A number of an axis.
pub(super) type Of<'a> = &'a dyn Fn(&Errors) -> f64;

impl Imu {
    /// Returns the sensor as its messages come: at a rate, or its own, and behind a filter.
    ///
    /// # Errors
    /// A rate that is not above zero; for a target of messages also a missing rate and a sensor
    /// without white noise; for others a filter.
    pub fn sent(mut self, target: &Target, rate_hz: Option<f64>, filter: Filter) -> Result<Self> {
        let fail = |cause: String, hint: String| {
            Err(Error::new(format!("could not export {} to {}", self.source, target.name), cause, hint))
        };
        if let Some(rate_hz) = rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            let cause = format!("--rate-hz: need more than zero, got {rate_hz:?}");
            return fail(cause, "give the messages per second, e.g. --rate-hz 200".into());
        }
        if target.messages {
            if rate_hz.is_none() && !self.rate_is_stated {
                return fail(
                    "need the rate of the messages, got a sensor without sample_rate_hz".into(),
                    "give it, e.g. --rate-hz 200, or add sample_rate_hz under [sensor]".into(),
                );
            }
            if [self.accelerometer, self.gyro].iter().all(|errors| errors.white.mean == 0.0) {
                return fail(
                    "need white noise of an accelerometer or a gyro, got none".into(),
                    format!(
                        "add e.g. [gyro] angle_random_walk_deg_rth = 0.3, or measure it: proofmass allan LOG --to {}",
                        target.name
                    ),
                );
            }
        } else if filter != Filter::Mean {
            let takes: Vec<&str> = TARGETS.iter().filter(|t| t.messages).map(|t| t.name).collect();
            return fail(
                format!("{} takes the noise ahead of a filter, which --filter does not change", target.name),
                format!("leave --filter out; {} take it", takes.join(", ")),
            );
        }
        self.rate_hz = rate_hz.unwrap_or(self.rate_hz);
        self.filter = filter;
        Ok(self)
    }

    /// Returns the sensor ahead of a filter where its noise was measured on messages behind it: there,
    /// N² f_s is the variance of independent ones.
    #[must_use]
    pub fn ahead_of(mut self, filter: Filter) -> Self {
        let passed = filter.seen(1.0, self.rate_hz);
        let axes = self.axes.iter_mut().flatten().flatten();
        for errors in axes.chain([&mut self.accelerometer, &mut self.gyro]) {
            errors.white.mean /= passed;
            errors.white.sd /= passed;
        }
        self
    }

    /// Returns a number of x, y and z of the accelerometer (0) or the gyro (1), or says that `key` is
    /// left out where an axis states none.
    pub(super) fn stated(
        &self,
        sheet: &mut Sheet,
        sense: usize,
        key: &str,
        (what, instead): (&str, &str),
        of: Of<'_>,
    ) -> Option<[f64; 3]> {
        let axes = [0, 1, 2].map(|axis| of(&self.axis(axis)[sense]));
        if axes.iter().all(|value| *value > 0.0) {
            return Some(axes);
        }
        let lacking: Vec<&str> = ["x", "y", "z"].into_iter().zip(axes).filter(|a| a.1 == 0.0).map(|a| a.0).collect();
        let of_axes = if lacking.len() == 3 { String::new() } else { format!(" along {}", lacking.join(" and ")) };
        let name = ["accelerometer", "gyro"][sense];
        sheet.note(&format!("{key} is left out: the sensor file states no {what} of the {name}{of_axes}; {instead}"));
        None
    }

    /// Says how the messages come, and their noise in both conventions.
    pub(super) fn say_messages(&self, sheet: &mut Sheet) {
        let (rate_hz, filter) = (self.rate_hz, self.filter);
        match filter {
            Filter::Mean => sheet.note(
                "no filter given: a message is the mean since the one before, variance N^2 rate, and messages are \
                 independent; a narrower filter leaves less in one message, a wider one folds more into it: give \
                 --filter",
            ),
            Filter::LowPass(cutoff_hz) => sheet.note(&format!(
                "behind a one-pole low-pass of {cutoff_hz} Hz: variance N^2 pi cut-off; correlation time \
                 1/(2 pi cut-off) = {} s, messages in succession correlated by {}; independent messages with the \
                 same sum have N^2 pi cut-off coth(pi cut-off / rate)",
                short(1.0 / (2.0 * PI * cutoff_hz)),
                short((-2.0 * PI * cutoff_hz / rate_hz).exp())
            )),
        }
        for (name, errors) in [("accelerometer", &self.accelerometer), ("gyro", &self.gyro)] {
            let white = errors.white.mean;
            if white > 0.0 {
                sheet.note(&format!(
                    "{name}: continuous, N = {} {unit}*sqrt(s) of the sensor itself; discrete, sigma of a message = {} \
                     {unit}; of independent messages with the same sum = {} {unit}",
                    short(white),
                    short(filter.variance(white, rate_hz).sqrt()),
                    short(filter.independent(white, rate_hz).sqrt()),
                    unit = errors.unit
                ));
            }
        }
        sheet.note(
            "vibration and temperature are not in these numbers: they are the vehicle's, and no sensor file has them",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages per second.
    const RATE_HZ: f64 = 100.0;

    #[test]
    fn noise_measured_behind_a_filter_is_the_independent_messages() {
        for filter in [Filter::Mean, Filter::LowPass(8.0), Filter::LowPass(80.0)] {
            let mut imu = Imu::new("log.csv", RATE_HZ);
            imu.gyro.white.mean = 0.3;
            let ahead = imu.ahead_of(filter).gyro.white.mean;
            assert!((filter.independent(ahead, RATE_HZ) / (0.09 * RATE_HZ) - 1.0).abs() < 1e-12, "{filter:?}");
        }
    }
}
