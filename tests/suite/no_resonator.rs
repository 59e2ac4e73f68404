//! A gyro on a rate table, given as a driven recording: its reading follows the table at once, or is the rate of its
//! angle. There is no proof mass to be seen, and none of its laws may be named.

use libtest_mimic::{Failed, Trial};

use super::bench::Bench;
use super::far_from_linear::{names, normal};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("driven: what follows its input at once is not said to pass a proof mass by", at_once),
        test("driven: a rate and its angle are no force and no mass", rate_and_angle),
    ]
}

const RATE_HZ: f64 = 100.0;
const MODEL: &str = "kind = \"driven\"\nrate_hz = 100.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";

/// Rates of the table, °/s: rests of 3 s, ramps of half a second and 3 s at each speed.
fn table() -> Vec<f64> {
    let speeds = [10.0, -10.0, 50.0, -50.0, 100.0, -100.0, 200.0, -200.0];
    let (ramp, hold) = (50, 300);
    let mut rates = vec![0.0; hold];
    for speed in speeds {
        let up = (0..ramp).map(|k| speed * f64::from(k) / f64::from(ramp));
        rates.extend(up.clone());
        rates.extend(std::iter::repeat_n(speed, hold));
        rates.extend(up.rev());
        rates.extend(std::iter::repeat_n(0.0, hold));
    }
    rates
}

fn csv(rows: impl Iterator<Item = (f64, f64)>) -> String {
    "u,y\n".to_owned() + &rows.map(|(u, y)| format!("{u},{y}\n")).collect::<String>()
}

/// 12.54 mV per °/s about 2.5 V.
fn at_once() -> Result<(), Failed> {
    let mut noise = normal();
    let rows = table().into_iter().map(|rate| (rate, 2.5 + 0.01254 * rate + 1e-4 * noise()));
    let verdict = Bench::new()?.verdict(&csv(rows), MODEL)?;
    check(verdict["verdict"] != "explained", format!("{verdict}"))?;
    check(verdict["verdict"] != "adequate" || names(&verdict).is_empty(), format!("{verdict}"))
}

/// A gyro that reads 0.9 % too much with a bias of 0.15 °/s, and the angle of its table.
fn rate_and_angle() -> Result<(), Failed> {
    let (mut noise, mut angle) = (normal(), 0.0);
    let rows = table().into_iter().map(|rate| {
        angle += rate / RATE_HZ;
        (0.15 + 1.009 * rate + 0.05 * noise(), angle + 1e-3 * noise())
    });
    let verdict = Bench::new()?.verdict(&csv(rows), MODEL)?;
    check(verdict["verdict"] != "adequate" && verdict["verdict"] != "explained", format!("{verdict}"))
}
