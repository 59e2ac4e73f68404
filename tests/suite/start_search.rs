//! The search for start values finds what a few starts would miss, profiles of the likelihood are
//! what refits give, and the simulation that both rest on has the order that its steps are chosen
//! for.

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::driven::base::BASE;
use proofmass::diagnosis::driven::identification::fit::{Search, fit};
use proofmass::diagnosis::driven::identification::interval::spread;
use proofmass::diagnosis::driven::identification::profile::profiles;
use proofmass::diagnosis::driven::identification::refined_scales::refined;
use proofmass::diagnosis::driven::identification::start::first_scales;
use proofmass::diagnosis::driven::identification::start_search::StartSearch;
use proofmass::diagnosis::driven::intake::data::Data;
use proofmass::diagnosis::driven::intake::input::{Input, Interpolation};
use proofmass::diagnosis::driven::intake::observed::Observed;
use proofmass::diagnosis::driven::intake::work::Stage;
use proofmass::diagnosis::driven::simulation::filter::Nothing;
use proofmass::diagnosis::driven::simulation::run::{Run, innovations};
use proofmass::diagnosis::driven::simulation::structure::ModelStructure;
use proofmass::diagnosis::verdict::{Effect, Estimate, Evidence};
use proofmass::numerics::least_squares::Residuals;
use proofmass::physics::cubic_stiffness::CubicStiffness;
use proofmass::physics::end_stop::{EndStop, Side};
use proofmass::physics::hysteresis::{Hysteresis, Sharpness};
use proofmass::physics::library::Term;
use proofmass::physics::scales::Scales;

use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("start search: errors of the simulation fall with the fourth power of the step", fourth_order),
        test("start search: a profile is what refits with the parameter held give", profile_is_refits),
        test("start search: from where the cloud says, a rarely touched stop is found", cloud_finds_gap),
        test("start search: the best start lies closer than the law's own ones", cloud_is_closer),
        test("start search: a loop in a sharp resonance is begun with the resonance moved along", loop_is_followed),
    ]
}

const RATE_HZ: f64 = 1000.0;
/// ω₀ of the base point.
const OMEGA: f64 = 502.65;
/// Its square.
const STIFF: f64 = OMEGA * OMEGA;
/// Gain, ω₀, ζ, offset, displacement and velocity at the beginning.
const FITTED: [f64; 6] = [0.9, OMEGA, 0.1, 0.001, 0.002, 0.3];

/// A recording: incommensurate tones below a third of Nyquist in, an arbitrary tone out.
fn data(interpolation: Interpolation) -> Data {
    let tone = |k: usize, f: f64, p: f64| (std::f64::consts::TAU * f * k as f64 / RATE_HZ + p).sin();
    let push = |k: usize| 1e3 * (tone(k, 73.1, 0.3) + tone(k, 41.7, 1.1) + 0.7 * tone(k, 118.9, 2.0) + 0.1);
    let samples = 1500;
    Data {
        reading: (0..samples).map(|k| 0.012 * tone(k, 61.3, 0.4)).collect(),
        input: Some(Input::new((0..samples).map(push).collect(), interpolation)),
        environment: Vec::new(),
        environments: 0,
        followed: Vec::new(),
        observed: Observed::default(),
        rate_hz: RATE_HZ,
        hull: 24..samples - 24,
        breaks: Vec::new(),
        train: vec![24..700, 900..samples - 24],
        validation: vec![700..800, 800..900],
        test: Vec::new(),
        own_test: false,
        windows: None,
        clock_s: Vec::new(),
        work: Default::default(),
        trace: Default::default(),
    }
}

/// Errors of free simulation by the filter.
fn filtered(data: &Data, terms: &[Term], own: &[f64], steps: usize) -> Vec<f64> {
    let point: Vec<f64> = FITTED.iter().chain(own).copied().collect();
    let run = Run { range: data.hull.clone(), steps, corrected: false };
    innovations(data, &ModelStructure::new(terms), &[point], &run, &mut Nothing).iter().map(|e| e[0]).collect()
}

fn squares(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum()
}

fn fourth_order() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let at = |steps| squares(&filtered(&data, &[Term::CubicStiffness(CubicStiffness)], &[2e3 * STIFF], steps));
    let exact = at(32);
    let ratio = (at(4) - exact) / (at(8) - exact);
    // 2⁴ for a method of order four; of order three 8, of five 32.
    check((12.0..22.0).contains(&ratio), format!("halving the step divides the error by {ratio}"))
}

/// A recording made by the filter at a known point, with noise of 0.2 % that no two samples share.
fn planted(terms: &[Term], own: &[f64]) -> Data {
    let mut data = data(Interpolation::BandLimited);
    let errors = filtered(&data, terms, own, 8);
    for (k, e) in data.hull.clone().zip(errors) {
        let noise = (f64::from((k as u32).wrapping_mul(2_654_435_769) >> 8) / f64::from(1u32 << 24) - 0.5) * 1e-4;
        data.reading[k] += noise - e;
    }
    data
}

fn profile_is_refits() -> Result<(), Failed> {
    let (terms, own) = ([Term::CubicStiffness(CubicStiffness)], [300.0 * STIFF]);
    let data = planted(&terms, &own);
    let scales = first_scales(&data);
    let start: Vec<f64> = FITTED.iter().chain(&own).copied().collect();
    let structure = ModelStructure::new(&terms);
    let fitted = fit(&data, &structure, &start, &scales, 20).ok_or("no fit")?;
    let spread = spread(&fitted);
    let free = fitted.free.iter().position(|f| *f == BASE).ok_or("the spring does not move")?;
    let reach = 2.0 * spread.deviation[free] * fitted.slopes[free];
    let value = fitted.point[BASE];
    near("the planted spring", value / own[0], 1.0, 3.0 * reach / own[0])?;
    let estimate = Estimate { name: "beta".into(), value, unit: String::new(), ci95: [value - reach, value + reach] };
    let effect = Effect {
        id: "cubic-stiffness".into(),
        statement: String::new(),
        equation: String::new(),
        parameters: vec![estimate],
        channels: Vec::new(),
        form: None,
        evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
        share: None,
        base: Vec::new(),
        confusable_with: Vec::new(),
    };
    let budget = data.work.budget(Stage::Conclusion, data.hull.len());
    let look = || profiles(&data, &fitted, &scales, std::slice::from_ref(&effect), &spread, budget);
    let (found, left_out) = look();
    check(left_out.is_empty(), "a profile was left out")?;
    let profile = found.first().ok_or("no profile")?;
    let least = fitted.variance * data.train_len() as f64;
    let rows = data.train_len() as f64 / spread.dispersion[free];
    let loss = |sum: f64| 0.5 * rows * (sum / least).ln();
    for (at, lost) in profile.points.iter().step_by(8) {
        let mut search = Search::all(&data, &structure, &fitted.point, &scales);
        search.run.steps = fitted.steps;
        search.point[BASE] = *at;
        let alone = loss(left_at(&search, &search.point));
        search.free.retain(|f| *f != BASE);
        let refitted = loss(search.minimise(10).ok_or("no refit")?.sum);
        // The tangent leaves what bends: a hundredth of the loss.
        near("loss", *lost, refitted, 0.02 * refitted + 0.01)?;
        let far = (at - value).abs() > 0.9 * reach;
        check(!far || alone > 1.5 * refitted, format!("others need not follow: {alone} and {refitted}"))?;
    }
    // With the work for it spent there is no profile, and that is known.
    data.work.add(usize::MAX / 2);
    let (found, left_out) = look();
    check(found.is_empty() && left_out == ["cubic-stiffness beta"], format!("{left_out:?}"))
}

fn cloud_finds_gap() -> Result<(), Failed> {
    let term = Term::EndStop(EndStop(Side::Upper));
    let own = [20.0 * STIFF, 0.0205];
    let data = planted(&[term], &own);
    let scales = Scales { omega_rad_s: OMEGA, ..first_scales(&data) };
    let base = fit(&data, &ModelStructure::new(&[]), &FITTED, &scales, 20).ok_or("no fit")?;
    let scales = refined(&data, &base, &scales);
    let ensemble = StartSearch::around(&data, &base).ok_or("no ensemble")?;
    let starts = ensemble.starts(term, &scales, 1).ok_or("no starts")?;
    let found = fit(&data, &ModelStructure::new(&[term]), &starts[0], &scales, 20).ok_or("no fit with the stop")?;
    near("the gap", found.point[BASE + 1] / own[1], 1.0, 0.01)?;
    // The noise is spread evenly over 1e-4.
    let noise = 1e-8 / 12.0;
    check(found.variance < 1.3 * noise, format!("{:e} is left of {noise:e}", found.variance))?;
    check(base.variance > 4.0 * noise, format!("the base model alone leaves {:e}", base.variance))
}

/// The gap where the cloud begins is closer to the planted one than any start of the law's own.
fn cloud_is_closer() -> Result<(), Failed> {
    let term = Term::EndStop(EndStop(Side::Upper));
    let gap = 0.0205;
    let data = planted(&[term], &[20.0 * STIFF, gap]);
    let scales = Scales { omega_rad_s: OMEGA, ..first_scales(&data) };
    let base = fit(&data, &ModelStructure::new(&[]), &FITTED, &scales, 20).ok_or("no fit")?;
    let scales = refined(&data, &base, &scales);
    let search = StartSearch::around(&data, &base).ok_or("no search")?;
    let best = search.starts(term, &scales, 1).ok_or("no starts")?;
    let off = best.iter().map(|s| (s[BASE + 1] - gap).abs()).fold(f64::INFINITY, f64::min);
    check(off < 0.05 * gap, format!("{best:?}"))?;
    let worst = term.starts(&scales).iter().map(|s| (s[1] - gap).abs()).fold(0.0, f64::max);
    check(off < 0.2 * worst, format!("{off} and {worst}"))
}

/// Q = 167, driven at its resonance for 120 cycles, and a loop whose spring of 0.4 % detunes it by two thirds
/// of its half width.
fn loop_is_followed() -> Result<(), Failed> {
    let term = Term::Hysteresis(Hysteresis(Sharpness::One));
    let tone = |k: usize| 10.0 * (OMEGA * k as f64 / RATE_HZ).sin();
    let mut data = data(Interpolation::BandLimited);
    data.input = Some(Input::new((0..data.reading.len()).map(tone).collect(), Interpolation::BandLimited));
    data.reading.fill(0.0);
    let linear = [1.0, OMEGA, 0.003, 0.0, 0.0, 0.0];
    // Of an amplitude of 6 mm it yields at a twentieth.
    let planted: Vec<f64> = linear.into_iter().chain([0.004 * STIFF, 660.0, 2600.0, 0.0]).collect();
    let structure = ModelStructure::new(&[term]);
    let run = Run { range: data.hull.clone(), steps: 16, corrected: false };
    let errors = innovations(&data, &structure, &[planted], &run, &mut Nothing);
    let noise = |k: usize| f64::from((k as u32).wrapping_mul(2_654_435_769) >> 8) / f64::from(1u32 << 24) - 0.5;
    data.hull.clone().zip(errors).for_each(|(k, e)| data.reading[k] = 6e-5 * noise(k) - e[0]);
    let scales = Scales { omega_rad_s: OMEGA, ..first_scales(&data) };
    let base = fit(&data, &ModelStructure::new(&[]), &linear, &scales, 40).ok_or("no fit")?;
    let scales = refined(&data, &base, &scales);
    let starts = StartSearch::around(&data, &base).and_then(|s| s.starts(term, &scales, 1)).ok_or("no starts")?;
    let left = |point: &[f64]| {
        let search = Search::all(&data, &structure, point, &scales);
        left_at(&search, point)
    };
    let base_left = base.variance * data.train_len() as f64;
    check(left(&starts[0]) < base_left, format!("{} of {base_left}", left(&starts[0])))?;
    // Control: the same loop on the resonance as it was fitted without one.
    let unmoved: Vec<f64> = base.point.iter().chain(&starts[0][BASE..]).copied().collect();
    check(left(&unmoved) > base_left, format!("{} of {base_left} without moving along", left(&unmoved)))?;
    let found = fit(&data, &structure, &starts[0], &scales, 100).ok_or("no fit with the loop")?;
    // The noise is spread evenly over 6e-5: its variance is known to √(0.8/1376) = 2.4 %, four of which are allowed.
    check(found.variance < 1.1 * 3.6e-9 / 12.0, format!("{:e} is left", found.variance))
}

/// Sum of squares that a model leaves at a point.
fn left_at(search: &Search<'_>, point: &[f64]) -> f64 {
    squares(&search.residuals(&[search.z(point)])[0])
}
