//! Figure 1: the Allan deviation of an array of accelerometers against that of a single one.
//!
//! Every sensor has white noise of its own; all share one slow walk, as a common temperature would
//! make it.

use super::check::{Check, Exhibit};
use proofmass_base::parallel;
use proofmass_numerics::numerics::allan::covariance::Covariance;
use proofmass_numerics::numerics::allan::{Point, curve, law};
use proofmass_numerics::numerics::special::chi_squared_quantile;
use proofmass_numerics::rng::{Philox, Stream};

/// Sensors in the array.
pub(crate) const SENSORS: u64 = 16;
/// Velocity random walk of each sensor, m/s/√s.
const WHITE_M_S_RTS: f64 = 1e-3;
/// Acceleration random walk that all share, m/s²/√s.
const WALK_M_S2_RTS: f64 = 4e-6;
const RATE_HZ: f64 = 20.0;
const SAMPLES: usize = 20 * 4 * 3600;

/// An Allan curve with its band and its law.
#[derive(Debug, Clone)]
pub struct Deviation {
    /// Averaging time (s), deviation (m/s²).
    pub curve: Vec<(f64, f64)>,
    /// 95 % interval at each point, m/s².
    pub band: Vec<(f64, f64)>,
    /// Law of the planted noise, m/s².
    pub law: Vec<(f64, f64)>,
    /// Degrees of freedom at each point.
    degrees_of_freedom: Vec<f64>,
}

/// Curves and checks of figure 1.
#[derive(Debug, Clone)]
pub struct Array {
    /// Allan deviation of one sensor.
    pub single: Deviation,
    /// Mean of the array.
    pub array: Deviation,
    /// Figure 1 with its checks.
    pub exhibit: Exhibit,
}

fn noise(member: u64, stream: Stream, sigma: f64) -> Vec<f64> {
    let mut random = Philox::new(1, member, stream);
    (0..SAMPLES).map(|_| sigma * random.normal()).collect()
}

/// Squared coefficients of an array of `sensors`, in the order of `law::TERMS`.
fn squares(sensors: f64) -> [f64; 5] {
    [0.0, WHITE_M_S_RTS.powi(2) / sensors, 0.0, WALK_M_S2_RTS.powi(2), 0.0]
}

fn deviation(values: &[f64], sensors: f64) -> Deviation {
    let points: Vec<Point> = curve(values, RATE_HZ).into_iter().filter(Point::on_octave).collect();
    let column = |pick: fn(&Point) -> usize| points.iter().map(pick).collect::<Vec<_>>();
    let covariance = Covariance::new(&column(|p| p.factor), &column(|p| p.samples), RATE_HZ);
    let squares = squares(sensors);
    let degrees_of_freedom: Vec<f64> = (0..points.len()).map(|i| covariance.degrees_of_freedom(i, &squares)).collect();
    let edge = |p: &Point, f: f64, fraction: f64| (p.variance * f / chi_squared_quantile(fraction, f)).sqrt();
    Deviation {
        curve: points.iter().map(|p| (p.tau_s, p.variance.sqrt())).collect(),
        band: points.iter().zip(&degrees_of_freedom).map(|(p, f)| (edge(p, *f, 0.975), edge(p, *f, 0.025))).collect(),
        law: points.iter().map(|p| (p.tau_s, law::variance(&squares, p.tau_s).sqrt())).collect(),
        degrees_of_freedom,
    }
}

/// Computes the figure.
pub fn compute() -> Array {
    let white = WHITE_M_S_RTS * RATE_HZ.sqrt();
    let own: Vec<Vec<f64>> = parallel::map_members(0..SENSORS, |m| noise(m, Stream::AccelerometerWhite, white));
    let mut level = 0.0;
    let common: Vec<f64> = noise(0, Stream::AccelerometerWalk, WALK_M_S2_RTS / RATE_HZ.sqrt())
        .into_iter()
        .map(|step| {
            level += step;
            level
        })
        .collect();
    let mean = |sensors: &[Vec<f64>]| -> Vec<f64> {
        (0..SAMPLES).map(|i| common[i] + sensors.iter().map(|s| s[i]).sum::<f64>() / sensors.len() as f64).collect()
    };
    let single = deviation(&mean(&own[..1]), 1.0);
    let array = deviation(&mean(&own), SENSORS as f64);
    let exhibit = Exhibit::simulated(1, "An array of accelerometers against a single one", checks(&single, &array));
    Array { single, array, exhibit }
}

fn checks(single: &Deviation, array: &Deviation) -> Vec<Check> {
    let at = |tau_s: f64| {
        let gap = |p: &(f64, f64)| (p.0 / tau_s).ln().abs();
        (0..single.curve.len()).min_by(|a, b| gap(&single.curve[*a]).total_cmp(&gap(&single.curve[*b]))).unwrap_or(0)
    };
    // Four standard errors of a ratio of two deviations with these degrees of freedom, taken as
    // independent.
    let ratio = |i: usize| {
        let relative = (0.5 / single.degrees_of_freedom[i] + 0.5 / array.degrees_of_freedom[i]).sqrt();
        (single.curve[i].1 / array.curve[i].1, 4.0 * relative)
    };
    let (short, long) = (at(0.1), at(2000.0));
    let least = |d: &Deviation| d.curve.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let beyond = single.law[long].1 / array.law[long].1;
    vec![
        Check::near(
            "single over array at 0.1 s",
            "√16: independent white noise averages out; four standard errors",
            (SENSORS as f64).sqrt(),
            ratio(short).0,
            (SENSORS as f64).sqrt() * ratio(short).1,
        ),
        Check::near(
            "single over array at about 30 min",
            "from the laws of the planted noise, nearly 1: what the sensors share does not average out; four standard errors \
             of one curve, since both hold the same walk",
            beyond,
            ratio(long).0,
            beyond
                * 4.0
                * (0.5 / single.degrees_of_freedom[long]).sqrt()
                * (single.law[long].1 / array.law[long].1).max(1.0)
                * 0.5,
        ),
        Check::near(
            "least deviation of the single sensor over that of the array",
            "√√16 = 2: the minimum of N²/τ + K²τ/3 is 2NK/√3; a quarter for the few degrees of freedom at the minimum",
            2.0,
            least(single) / least(array),
            0.5,
        ),
        Check::near(
            "velocity random walk of the single sensor at 0.1 s over what was planted",
            "1: the Allan deviation of white noise is N/√τ; four standard errors",
            1.0,
            single.curve[short].1 * single.curve[short].0.sqrt() / WHITE_M_S_RTS,
            4.0 * (0.5 / single.degrees_of_freedom[short]).sqrt(),
        ),
    ]
}
