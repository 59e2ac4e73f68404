//! Intervals of biases: as often as they claim they hold what was planted, and they are no wider
//! than the scatter of the estimates asks for.

use libtest_mimic::{Failed, Trial};

use super::super::world::{check, test};
use super::flight::{PLANTED, base, flown, read};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: intervals of biases hold at least 19 times of 20 where poses err each by itself", white),
        test(
            "trajectory: intervals of biases hold at least 19 times of 20 where the reference's errors are coloured",
            coloured,
        ),
    ]
}

/// Flights of each kind.
const FLIGHTS: u64 = 40;
/// Of the intervals of 40 flights and three axes fewer hold by chance once in a thousand than this:
/// 120 trials at 0.95, 114 ± 2.4, three standard deviations and a half.
const LEAST: usize = 106;
/// Half-width over 1.96 times the scatter of the estimates. Student's t of eight waves alone is
/// 1.18 times the normal quantile; the scatter of 120 numbers is known to 7 %. A reference's white
/// errors enter at the ends of the recording, where waves are as high as can be: √2 more.
const WIDEST: f64 = 1.9;
const NARROWEST: f64 = 0.8;

const SENSORS: [&str; 2] = ["gyro_bias", "accelerometer_bias"];

/// One flight's estimates and half-widths, sensor by axis.
type Estimates = [[(f64, f64); 3]; 2];

fn estimates(correlation_s: f64) -> Result<Vec<Estimates>, Failed> {
    let truths = [1, 6, 11, 12].into_iter().map(flown).collect::<Result<Vec<_>, _>>()?;
    let one = |n: u64| -> Result<Estimates, Failed> {
        let flight = read(&truths[n as usize % truths.len()], 100 + n);
        let answer = flight.with_coloured_reference(500 + n, correlation_s, [1e-3, 2e-3]).diagnosed()?;
        let mut all = [[(0.0, 0.0); 3]; 2];
        for (all, name) in all.iter_mut().zip(SENSORS) {
            for (found, axis) in all.iter_mut().zip(["x", "y", "z"]) {
                let estimate = base(&answer, &format!("{name}_{axis}"))?;
                *found = (estimate.value, 0.5 * (estimate.ci95[1] - estimate.ci95[0]));
            }
        }
        Ok(all)
    };
    (0..FLIGHTS).map(one).collect()
}

fn holds(correlation_s: f64) -> Result<(), Failed> {
    let all = estimates(correlation_s)?;
    for (sensor, name) in SENSORS.into_iter().enumerate() {
        let (mut held, mut narrow, mut square, mut widths) = (0, 0, 0.0, 0.0);
        for (axis, planted) in PLANTED[sensor].into_iter().enumerate() {
            for (value, half) in all.iter().map(|flight| flight[sensor][axis]) {
                let error = (value - planted).abs();
                held += usize::from(error <= half);
                // What intervals of a third of the width would hold.
                narrow += usize::from(error <= half / 3.0);
                square += error * error;
                widths += half;
            }
        }
        let count = 3.0 * all.len() as f64;
        let wide = widths / count / (1.96 * (square / count).sqrt());
        check(held >= LEAST, format!("{name}: {held} of {count} intervals hold"))?;
        check((NARROWEST..WIDEST).contains(&wide), format!("{name}: {wide:.2} times the scatter"))?;
        check(narrow < LEAST, format!("{name}: of intervals a third as wide {narrow} hold as well"))?;
    }
    Ok(())
}

fn white() -> Result<(), Failed> {
    holds(0.0)
}

fn coloured() -> Result<(), Failed> {
    holds(0.5)
}
