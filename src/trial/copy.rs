//! Copies of a user's recording: their excitation, rate, length and noise, without the physics,
//! ready to be planted into.

use std::ops::Range;

use super::case::{Body, Family};
use super::driven::{Driven, Planted};
use super::equation::Oscillator;
use super::excitation::Excitation;
use super::interval::median;
use super::physics::{Physics, Term};
use super::plant::{self, Size};
use super::refit::{self, Window};
use super::standstill::{Slow, Still};
use proofmass_base::error::{Error, Result};
use proofmass_diagnosis::model;
use proofmass_numerics::rng::{Philox, Stream};
use proofmass_recording::Recording;

/// Rows used of a longer recording: the diagnosis of each planted copy takes as long as that of the
/// original.
pub(crate) const ROWS: usize = 20_000;
/// Sub-steps of the linear fit.
const SUBSTEPS: usize = 8;

/// Fewer rows than this are no recording to plant into.
const FEWEST: usize = 100;

/// The rows that copies are made of: the longest range that the model fits, as the diagnosis learns
/// from that only.
///
/// # Errors
/// A range that does not lie in the recording; too few rows.
pub fn rows(data: &Recording, model: &model::Driven) -> Result<Range<usize>> {
    let longest = model.split.train.iter().max_by_key(|r| r[1].saturating_sub(r[0]));
    let [from, to] = longest.copied().unwrap_or([0, data.samples()]);
    if from > to || to > data.samples() || to - from < FEWEST {
        return Err(Error::new(
            format!("could not make copies of {}", data.path.display()),
            format!("rows {from} to {to} of its {} are to be copied", data.samples()),
            format!("at least {FEWEST} rows; ranges under [split] are half-open and counted from zero: [[0, 10000]]"),
        ));
    }
    Ok(from..to.min(from + ROWS))
}

/// A proof mass as the base model finds it in these rows, with the recorded input. None where no
/// linear one fits at all.
pub fn driven(data: &Recording, model: &model::Driven, rows: Range<usize>, seed: u64) -> Option<(Driven, String)> {
    let output = data.column(&model.columns.output)?;
    let samples = rows.len();
    let output = &output[rows.clone()];
    let excitation = match &model.columns.input {
        Some(name) => Excitation::Recorded { samples: data.column(name)?[rows].to_vec(), rate_hz: data.rate_hz },
        None => Excitation::None,
    };
    let half_step_s = 0.5 / (data.rate_hz * SUBSTEPS as f64);
    let input = match excitation {
        Excitation::None => Vec::new(),
        _ => excitation.tabulate(0.0, half_step_s, 2 * SUBSTEPS * (samples - 1) + 1),
    };
    let window = Window { input: &input, output, substeps: SUBSTEPS, rate_hz: data.rate_hz };
    let hint = model.start.resonance_hz.map(|f| f * std::f64::consts::TAU).zip(model.start.damping_ratio);
    let fit = refit::search(&window, hint.map(|(omega, zeta)| [omega, zeta]))?;
    let spread = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    // The readout's noise is what remains at the highest frequencies of the residual, where no
    // resonator reaches: its fourth difference, whose gain on white noise is √(1 + 16 + 36 + 16 +
    // 1).
    let fourth_difference: Vec<f64> =
        fit.residual.windows(5).map(|r| r[0] - 4.0 * r[1] + 6.0 * r[2] - 4.0 * r[3] + r[4]).collect();
    let noise = spread(&fourth_difference) / 70f64.sqrt();
    let oscillator = Oscillator { omega_rad_s: fit.omega_rad_s, zeta: fit.zeta, gain: fit.gain, start: fit.start };
    let mut case = Driven::linear(oscillator, excitation, data.rate_hz, samples, seed);
    case.offset = fit.offset;
    case.noise = noise;
    // What else the base model leaves is taken for noise that enters as a force, though part of it
    // may be the very effect that is asked for: the sizes found are rather too large than too
    // small.
    let rest = (fit.rms().powi(2) - noise * noise).max(0.0).sqrt();
    let mut base = format!(
        "resonance {:.4} Hz, damping ratio {:.4}, an output of {:.3e} rms with readout noise of {noise:.3e}",
        fit.omega_rad_s / std::f64::consts::TAU,
        fit.zeta,
        case.output_rms
    );
    if rest > noise {
        let fraction = rest / case.output_rms;
        let term = Term { physics: Physics::ForceNoise, amplitude: rest / case.scales.x, shape: [0.0; 2] };
        case.planted.push(Planted { term, visible: fraction, raw: fraction });
        base += &format!(" and force noise that moves it by {rest:.3e} rms");
    }
    Some((case, base))
}

/// A sensor at rest with the white part of the recorded noise.
pub fn still(data: &Recording, model: &model::Static, seed: u64) -> (Still, String) {
    let samples = data.samples().min(ROWS);
    let mut white = [0.0; 3];
    let mut bias = [0.0; 3];
    for channel in 0..3 {
        let names = &model.columns.channels;
        let values = data.column(&names[channel % names.len()]).unwrap_or_default();
        let values = &values[..samples.min(values.len())];
        // White noise alone survives a first difference, whose median size is 0.6745 × √2 of its
        // deviation; a few jumps and knocks do not move a median.
        let steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        // Coarse counts that mostly repeat have no median step, but a mean square.
        let square = steps.iter().map(|s| s * s).sum::<f64>() / steps.len().max(1) as f64;
        let median = median(steps.into_iter());
        let step = if median > 0.0 { median / 0.6745 } else { square.sqrt() };
        white[channel] = (step / 2f64.sqrt()).max(f64::MIN_POSITIVE);
        bias[channel] = values.iter().sum::<f64>() / samples as f64;
    }
    let still = Still {
        seed,
        rate_hz: data.rate_hz,
        samples,
        white,
        bias,
        planted: Vec::new(),
        promised: false,
        temperature_given: !model.columns.environment.is_empty(),
    };
    let base = format!(
        "white noise of {:.3e}, {:.3e}, {:.3e} per sample (slower noise of the original is not in the copies and would hide more)",
        white[0], white[1], white[2]
    );
    (still, base)
}

/// The nth copy, with an effect of a size over its noise planted, or with nothing. None where the
/// effect cannot be planted.
pub fn plant_driven(bare: &Driven, n: u64, job: Option<(Physics, f64)>) -> Option<(Family, Body)> {
    let mut case = bare.clone();
    case.seed = bare.seed.wrapping_add(n);
    let Some((physics, size)) = job else {
        return Some((Family::Null, Body::Driven(Box::new(case))));
    };
    // What the copy has already cannot be told from more of it.
    if case.planted.iter().any(|p| p.term.physics == physics) {
        return None;
    }
    let noise = case.planted.iter().map(|p| p.visible.powi(2)).sum::<f64>() + (case.noise / case.output_rms).powi(2);
    let needs_input = matches!(physics, Physics::DriveNonlinearity | Physics::Feedthrough | Physics::ParasiticMode);
    if needs_input && case.excitation == Excitation::None {
        return None;
    }
    // A shape may not reach the size; another may.
    (0..4).find_map(|attempt| {
        let mut rng = Philox::new(bare.seed, physics as u64 * 16 + attempt, Stream::Host);
        let shape = plant::shape(&mut rng, physics, &case);
        let mut trial = case.clone();
        let visible = Size::Visible(size * noise.sqrt());
        plant::plant(&mut trial, physics, shape, visible)
            .then(|| (Family::AroundTheLimit, Body::Driven(Box::new(trial))))
    })
}

/// The same at rest.
pub fn plant_still(bare: &Still, n: u64, job: Option<(Slow, f64)>) -> (Family, Body) {
    let mut case = bare.clone();
    case.seed = bare.seed.wrapping_add(n);
    let Some((slow, size)) = job else {
        return (Family::StillNull, Body::Still(Box::new(case)));
    };
    let mut rng = Philox::new(bare.seed, slow as u64, Stream::Host);
    let size = match slow {
        Slow::WhiteNoise => 1.0 + size,
        Slow::QuantisationNoise => size * 12f64.sqrt(),
        _ => size,
    };
    case.plant(&mut rng, slow, size);
    (Family::StillPlanted, Body::Still(Box::new(case)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Lines;
    use proofmass_diagnosis::model::{DrivenColumns, Split, Start, StaticColumns};
    use proofmass_recording::Column;

    fn recording(rate_hz: f64, columns: Vec<(&str, Vec<f64>)>) -> Recording {
        let columns = columns.into_iter().map(|(name, values)| Column { name: name.into(), values }).collect();
        let (path, sha256) = ("log.csv".into(), String::new());
        Recording { path, sha256, rate_hz, columns, ..Recording::default() }
    }

    fn model(train: Vec<[usize; 2]>) -> model::Driven {
        let (input, output) = (Some("force".into()), "reading".into());
        model::Driven {
            topic: None,
            unit: None,
            output_is: model::Output::Displacement,
            rate_hz: Some(200.0),
            force_rate: false,
            rows: Vec::new(),
            columns: DrivenColumns { time: None, input, output, environment: Vec::new() },
            start: Start::default(),
            split: Split { train, test: Vec::new() },
            without: Vec::new(),
        }
    }

    /// A linear proof mass with noise of a hundredth of its motion, as a recording.
    fn original() -> (Driven, Recording) {
        let oscillator = Oscillator { omega_rad_s: 60.0, zeta: 0.1, gain: 3600.0, start: [0.0; 2] };
        let lines =
            Lines { rms: 1.0, from_hz: 2.0, to_hz: 30.0, count: 60, envelope_start: 1.0, duration_s: 20.0, seed: 4 };
        let mut case = Driven::linear(oscillator, Excitation::Multisine(lines), 200.0, 4000, 8);
        case.noise = 0.01 * case.scales.x;
        let columns = case.render();
        let force = columns.force.expect("it is driven");
        (case, recording(200.0, vec![("force", force), ("reading", columns.reading)]))
    }

    #[test]
    fn a_copy_has_the_resonance_and_the_noise_of_its_original_and_nothing_else() {
        let (original, data) = original();
        let model = model(Vec::new());
        let rows = rows(&data, &model).expect("all of them");
        let (copy, _) = driven(&data, &model, rows, 1).expect("a linear proof mass fits");
        assert!((copy.omega_rad_s / 60.0 - 1.0).abs() < 1e-3 && (copy.zeta / 0.1 - 1.0).abs() < 0.02, "{copy:?}");
        // Fourth differences of 4000 values scatter as about 4000/4 independent ones: 2.2 %.
        assert!((copy.noise / original.noise - 1.0).abs() < 0.1, "{} {}", copy.noise, original.noise);
        assert!(copy.planted.is_empty());
    }

    #[test]
    fn rows_that_are_not_there_are_refused() {
        let (_, data) = original();
        assert_eq!(rows(&data, &model(vec![[0, 200], [1000, 3000]])), Ok(1000..3000));
        for wrong in [[5000, 9000], [0, 4001], [3000, 1000], [10, 20]] {
            assert!(rows(&data, &model(vec![wrong])).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn a_copy_at_rest_has_the_white_noise_and_leaves_the_jumps() {
        let mut rng = Philox::new(3, 0, Stream::Host);
        let bare = Still::bare(&mut rng, 8000);
        let mut readings = bare.render().readings;
        // Ten jumps of a hundred standard deviations, which no copy may take for noise.
        readings[0].iter_mut().enumerate().for_each(|(n, v)| *v += (n / 800) as f64 * 100.0 * bare.white[0]);
        let [x, y, z] = readings;
        let columns =
            StaticColumns { time: None, channels: ["x", "y", "z"].map(String::from).into(), environment: Vec::new() };
        let model = model::Static {
            topic: None,
            rate_hz: None,
            force_rate: false,
            rows: Vec::new(),
            unit: "g".into(),
            latitude_deg: None,
            height_m: None,
            columns,
            noise: None,
            split: Split::default(),
        };
        let (copy, _) = still(&recording(bare.rate_hz, vec![("x", x), ("y", y), ("z", z)]), &model, 1);
        // The median of 8000 steps has a standard error of 1.3 % of its own.
        assert!(copy.white.iter().all(|w| (w / bare.white[0] - 1.0).abs() < 0.06), "{:?} {:?}", copy.white, bare.white);
    }
}
