//! Families by hand: ordinary IMUs with more or fewer poses and one thing more, near laws, and
//! nulls.

use super::draw::Draw;
use super::oscillator_base::Size;
use super::posed;
use super::readout::Noise;
use super::truth::{Effect, Family, SEEN, Truth};
use super::turned::{GRAVITY, Sensor, Turned};

/// A name, what was made and its truth.
pub(crate) type Made = (String, Turned, Truth);

const LETTER: [&str; 7] = [
    "ordinary, 26 poses and more",
    "ordinary, 12 to 25 poses",
    "ordinary, 26 poses and more",
    "ordinary with k2",
    "ordinary with g-sensitivity",
    "ordinary, one pose knocked",
    "ordinary with flicker",
];
const NEAR: [&str; 4] = [
    "scale bends as |f|f",
    "offsets drift over the recording",
    "offsets settle with temperature",
    "gyro scale bends as |ω|ω",
];
const NULL: [&str; 6] = [
    "offset and common scale, normal noise",
    "offset and common scale, Student t5 noise",
    "offset and common scale, flicker",
    "offset and common scale, one pose knocked",
    "offset and common scale, coarse counts",
    "offset and common scale, temperature column",
];

const ONES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn ideal(draw: &mut Draw, scale: f64, quantity: f64, sigma: f64) -> Sensor {
    Sensor {
        scale: [scale * (1.0 + 0.03 * draw.normal().clamp(-2.0, 2.0)); 3],
        skew: ONES,
        offset: std::array::from_fn(|_| scale * quantity * draw.between(-0.1, 0.1)),
        square: [0.0; 3],
        bend: [0.0; 3],
        sigma: scale * sigma,
        flicker: 0.0,
        drift: [0.0; 3],
    }
}

fn bare(draw: &mut Draw, poses: usize) -> Turned {
    let accelerometer_scale = draw.log_between(100.0, 2000.0);
    let gyro_scale = draw.log_between(900.0, 8000.0);
    let [force_noise, rate_noise] = [draw.log_between(0.003, 0.05), draw.log_between(0.0005, 0.005)];
    let accelerometer = ideal(draw, accelerometer_scale, GRAVITY, force_noise);
    let gyro = ideal(draw, gyro_scale, 0.3, rate_noise);
    Turned {
        seed: draw.bits() >> 12,
        rate_hz: draw.one_of(&[50.0, 100.0, 100.0, 200.0]),
        poses,
        rest_s: [3.0, 6.0],
        accelerometer,
        gyro,
        g_sensitivity: [[0.0; 3]; 3],
        noise: Noise::Gauss,
        knock: None,
        whole: draw.chance(0.7),
        temperature: false,
    }
}

/// Scale and misalignment on both sensors, as every unit has.
fn ordinary(turned: &mut Turned, draw: &mut Draw) {
    let [scale, skew] = [draw.log_between(0.003, 0.02), draw.log_between(0.003, 0.02)];
    for (sensor, gyro) in [(&mut turned.accelerometer, false), (&mut turned.gyro, true)] {
        for i in 0..3 {
            sensor.scale[i] *= 1.0 + scale * draw.sign() * draw.between(0.5, 1.5);
            for j in 0..3 {
                // The accelerometer's x axis is the body's and its y axis lies in the x–y plane.
                if i != j && (gyro || j < i) {
                    sensor.skew[i][j] = skew * draw.sign() * draw.between(0.5, 1.5);
                }
            }
        }
    }
}

/// Means of rests tell a force to σ/√n; what is wrong by `size` m/s² in each pose is so large. Its
/// evidence is found when all effects are known.
fn effect(turned: &Turned, right: &[&str], size: f64) -> Effect {
    let sigma = turned.accelerometer.sigma / turned.accelerometer.scale[0];
    let samples = 4.5 * turned.rate_hz;
    let over_noise = size * samples.sqrt() / sigma;
    let right = right.iter().map(|r| (*r).to_owned()).collect();
    Effect { right, evidence: 0.0, over_noise }
}

fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

fn named_as_ordinary(turned: &Turned, truth: &mut Truth) {
    let a = &turned.accelerometer;
    truth.effects.push(effect(turned, &["scale-factor"], GRAVITY * spread(&a.scale)));
    let skew: Vec<f64> = (0..3).flat_map(|i| (0..i).map(move |j| a.skew[i][j])).collect();
    let size = (skew.iter().map(|m| m * m).sum::<f64>() / 3.0).sqrt();
    truth.effects.push(effect(turned, &["misalignment"], 0.5 * GRAVITY * size));
}

fn letter(sub: &str, draw: &mut Draw) -> (Turned, Truth) {
    let poses = match sub {
        "ordinary, 12 to 25 poses" => 12 + draw.below(14),
        _ => 26 + draw.below(15),
    };
    let mut turned = bare(draw, poses);
    ordinary(&mut turned, draw);
    let mut truth = Truth::default();
    named_as_ordinary(&turned, &mut truth);
    match sub {
        "ordinary with k2" => {
            // 30 to 500 µg per g².
            for k in &mut turned.accelerometer.square {
                *k = draw.sign() * draw.log_between(1e-3, 5e-3) / GRAVITY;
            }
            let size = 0.3 * turned.accelerometer.square[0].abs() * GRAVITY * GRAVITY;
            truth.effects.push(effect(&turned, &["scale-nonlinearity"], size));
        }
        "ordinary with g-sensitivity" => {
            // 0.02 to 0.3 °/s per g.
            let size = draw.log_between(0.02, 0.3f64).to_radians() / GRAVITY;
            for k in turned.g_sensitivity.iter_mut().flatten() {
                *k = size * draw.between(-1.5, 1.5);
            }
            let sigma = turned.gyro.sigma / turned.gyro.scale[0];
            let over_noise = size * GRAVITY * (4.5 * turned.rate_hz).sqrt() / sigma;
            truth.effects.push(Effect { right: vec!["g-sensitivity".into()], evidence: 0.0, over_noise });
        }
        "ordinary, one pose knocked" => turned.knock = Some((1 + draw.below(poses - 2), draw.log_between(0.2, 2.0))),
        "ordinary with flicker" => {
            turned.accelerometer.flicker = draw.log_between(0.1, 0.6);
            turned.gyro.flicker = draw.log_between(0.1, 0.6);
            truth.also.push("slow-drift".into());
        }
        _ => {}
    }
    truth.parameters = turned.parameters();
    (turned, truth)
}

fn near(sub: &str, draw: &mut Draw) -> (Turned, Truth) {
    let poses = 26 + draw.below(15);
    let mut turned = bare(draw, poses);
    ordinary(&mut turned, draw);
    let mut truth = Truth::default();
    named_as_ordinary(&turned, &mut truth);
    let per_g = draw.log_between(2e-3, 1e-2);
    match sub {
        "scale bends as |f|f" => {
            turned.accelerometer.bend = std::array::from_fn(|_| draw.sign() * per_g / GRAVITY);
            truth.effects.push(effect(&turned, &["scale-nonlinearity"], 0.2 * per_g * GRAVITY));
        }
        "gyro scale bends as |ω|ω" => {
            turned.gyro.bend = std::array::from_fn(|_| draw.sign() * draw.log_between(3e-3, 2e-2));
            // How well the turns show it hangs on their rates: it may be named and need not.
            truth.also.push("scale-nonlinearity".into());
        }
        _ => {
            let size = draw.log_between(0.02, 0.2);
            turned.accelerometer.drift = std::array::from_fn(|_| size * draw.between(-1.5, 1.5));
            turned.gyro.drift = std::array::from_fn(|_| 0.02 * size * draw.between(-1.5, 1.5));
            turned.temperature = sub == "offsets settle with temperature";
            let right: &[&str] = match turned.temperature {
                true => &["temperature-sensitivity"],
                false => &["temperature-sensitivity", "slow-drift", "bias-drift", "drift"],
            };
            truth.effects.push(effect(&turned, right, 0.3 * size));
        }
    }
    (turned, truth)
}

fn null(sub: &str, draw: &mut Draw) -> (Turned, Truth) {
    let poses = 12 + draw.below(29);
    let mut turned = bare(draw, poses);
    let mut truth = Truth::default();
    if sub.ends_with("Student t5 noise") {
        turned.noise = Noise::Student { freedom: 5 };
    } else if sub.ends_with("flicker") {
        turned.accelerometer.flicker = draw.log_between(0.03, 0.3);
        turned.gyro.flicker = draw.log_between(0.03, 0.3);
        truth.also.push("slow-drift".into());
    } else if sub.ends_with("one pose knocked") {
        turned.knock = Some((1 + draw.below(poses - 2), draw.log_between(0.2, 2.0)));
    } else if sub.ends_with("coarse counts") {
        turned.whole = true;
        for sensor in [&mut turned.accelerometer, &mut turned.gyro] {
            // One count is two to four σ.
            let factor = draw.between(0.25, 0.5) / sensor.sigma;
            sensor.scale.iter_mut().chain(&mut sensor.offset).for_each(|v| *v *= factor);
            sensor.sigma *= factor;
        }
    } else if sub.ends_with("temperature column") {
        turned.temperature = true;
    }
    (turned, truth)
}

/// Returns the sub-family of the n-th case of a family.
pub(crate) fn sub(family: Family, nth: usize) -> &'static str {
    match family {
        Family::Letter => LETTER[nth % LETTER.len()],
        Family::Near | Family::Foreign => NEAR[nth % NEAR.len()],
        Family::Null => NULL[nth % NULL.len()],
    }
}

/// The n-th case of a family.
pub(crate) fn draw(family: Family, nth: usize, draw: &mut Draw, _: Size) -> Made {
    let sub = sub(family, nth);
    let (turned, mut truth) = match family {
        Family::Letter => letter(sub, draw),
        Family::Near | Family::Foreign => near(sub, draw),
        Family::Null => null(sub, draw),
    };
    if !truth.effects.is_empty() {
        let names: Vec<&str> = truth.effects.iter().map(|e| e.right[0].as_str()).collect();
        let (each, all) = posed::evidence(&turned, &names);
        truth.evidence = all;
        truth.effects.iter_mut().zip(each).for_each(|(effect, evidence)| effect.evidence = evidence);
    }
    debug_assert!(family == Family::Null || truth.evidence > SEEN);
    (sub.to_owned(), turned, truth)
}
