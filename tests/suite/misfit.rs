//! The misfit kernel simulates what the diagnosis' own filter simulates, for every candidate, on every backend.

use cases::{FITTED, OMEGA, STIFF, base, cases, everything};
use libtest_mimic::{Failed, Trial};
use proofmass::backend::gpu::{self, Gpu};
use proofmass::backend::misfits::evaluate;
use proofmass::diagnosis::driven::identification::fit::{Search, fit};
use proofmass::diagnosis::driven::identification::interval::spread;
use proofmass::diagnosis::driven::identification::profile::profiles;
use proofmass::diagnosis::driven::identification::refined_scales::refined;
use proofmass::diagnosis::driven::identification::start::first_scales;
use proofmass::diagnosis::driven::identification::start_search::StartSearch;
use proofmass::diagnosis::driven::intake::data::Data;
use proofmass::diagnosis::driven::intake::input::{Input, Interpolation};
use proofmass::diagnosis::driven::intake::work::Stage;
use proofmass::diagnosis::driven::simulation::filter::Nothing;
use proofmass::diagnosis::driven::simulation::run::{Run, innovations};
use proofmass::diagnosis::driven::simulation::shape::Shape;
use proofmass::diagnosis::driven::terms::base::BASE;
use proofmass::diagnosis::driven::terms::scales::Scales;
use proofmass::diagnosis::driven::terms::term::Term;
use proofmass::diagnosis::driven::terms::{contact, drift, spring};
use proofmass::diagnosis::verdict::{Effect, Estimate, Evidence};
use proofmass::kernel::misfit::{Job, Point, Units};
use proofmass::numerics::least_squares::Residuals;

use super::world::{check, gpu_test, near, test};

mod cases;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("misfit: every column does what its term does in the diagnosis' own filter", columns_follow_terms),
        test("misfit: where the filter integrates by other means, both meet at the kernel's order", methods_meet),
        test("misfit: f32 stays within rounding of f64", single_follows_double),
        test("misfit: a held input and a ring-down are simulated as the filter does", other_inputs),
        test("misfit: errors of integration fall with the fourth power of the step", fourth_order),
        test("misfit: sums do not depend on grouping and add up over blocks", grouping),
        test("misfit: projections are those of the filter's errors", projections),
        test("misfit: a profile is what refits with the parameter held give", profile_is_refits),
        test("misfit: from where the cloud says, a rarely touched stop is found", cloud_finds_gap),
        test("misfit: a point that diverges is infinite and harms no neighbour", lost),
        gpu_test("misfit: the GPU agrees with the CPU for every candidate", gpu_follows_cpu),
    ]
}

const RATE_HZ: f64 = 1000.0;
const UNITS: Units = Units { output: 0.014, input: 1500.0, interval_s: 1.0 / RATE_HZ };

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
        rate_hz: RATE_HZ,
        hull: 24..samples - 24,
        train: vec![24..700, 900..samples - 24],
        validation: vec![700..800, 800..900],
        test: Vec::new(),
        work: Default::default(),
    }
}

/// Errors of free simulation by the filter.
fn filtered(data: &Data, terms: &[Term], own: &[f64], steps: usize) -> Vec<f64> {
    let point: Vec<f64> = FITTED.iter().chain(own).copied().collect();
    let run = Run { range: data.hull.clone(), steps, corrected: false };
    innovations(data, &Shape::new(terms), &[point], &run, &mut Nothing).iter().map(|e| e[0]).collect()
}

fn squares(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum()
}

/// A job over the whole hull as one block.
fn job<'a>(data: &'a Data, steps: usize, directions: &'a [Vec<f64>]) -> Job<'a> {
    Job {
        reading: &data.reading,
        grid: data.input.as_ref().map_or(&[], |i| i.grid(steps)),
        grid_end: data.input.as_ref().map_or(0, Input::end),
        steps,
        run: data.hull.clone(),
        blocks: vec![data.hull.clone()],
        directions,
        units: UNITS,
    }
}

fn columns_follow_terms() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let job = job(&data, 4, &[]);
    let plain = evaluate::<f64>(&job, &[base()])?[0].squares[0];
    // Same operations in f64, 6000 steps of some 30: rounding of 1e-16 each, damped within 100 steps.
    near("base", plain / squares(&filtered(&data, &[], &[], 4)), 1.0, 1e-12)?;
    for (name, term, own, point) in cases() {
        let expected = squares(&filtered(&data, &[term], &own, 4));
        let got = evaluate::<f64>(&job, &[point])?[0].squares[0];
        if !INTEGRATED_OTHERWISE.iter().any(|(other, ..)| *other == name) {
            near(name, got / expected, 1.0, 1e-12)?;
        }
        // Control: without its column the same comparison fails by far.
        check((plain / expected - 1.0).abs() > 1e-4, format!("{name} moves nothing: {plain:e} and {expected:e}"))?;
    }
    Ok(())
}

/// Terms that the filter integrates by another method (the mode exactly, friction with its events inside the step), and by
/// what halving the kernel's step divides the difference: 2⁴ for Runge–Kutta on the mode, 2 for a smoothed sign.
const INTEGRATED_OTHERWISE: [(&str, f64, f64); 2] = [("mode", 12.0, 22.0), ("friction", 1.5, 3.0)];

fn methods_meet() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    for (other, least, most) in INTEGRATED_OTHERWISE {
        let found = cases().into_iter().find(|c| c.0 == other);
        let (name, term, own, point) = found.ok_or_else(|| format!("no case is called {other}"))?;
        let exact = squares(&filtered(&data, &[term], &own, 32));
        let gap =
            |steps| Ok::<f64, Failed>(evaluate::<f64>(&job(&data, steps, &[]), &[point])?[0].squares[0] / exact - 1.0);
        let (coarse, fine) = (gap(4)?, gap(8)?);
        check(
            (least..most).contains(&(coarse / fine)),
            format!("{name}: half the step changes the difference of the methods from {coarse:e} to {fine:e}"),
        )?;
    }
    Ok(())
}

fn single_follows_double() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let job = job(&data, 4, &[]);
    let all = cases().into_iter().map(|c| (c.0, c.3)).chain([("everything", everything())]);
    for (name, point) in all {
        let exact = evaluate::<f64>(&job, &[point])?[0].squares[0];
        // Rounding of 6e-8 per operation gathered over the memory of the resonance, some 200 steps; the sum averages it.
        near(name, evaluate::<f32>(&job, &[point])?[0].squares[0] / exact, 1.0, 1e-5)?;
    }
    let moved = Point { gain: 1.0001 * FITTED[0], ..base() };
    let control = evaluate::<f32>(&job, &[moved])?[0].squares[0] / evaluate::<f64>(&job, &[base()])?[0].squares[0];
    check((control - 1.0).abs() > 1e-5, "the comparison does not see a gain wrong by 1e-4")
}

fn other_inputs() -> Result<(), Failed> {
    let (term, own) = (Term::CubicStiffness(spring::Cubic), [2e3 * STIFF]);
    let point = Point { cubic: own[0], ..base() };
    let mut sums = Vec::new();
    for interpolation in [Some(Interpolation::BandLimited), Some(Interpolation::Hold), None] {
        let mut data = data(interpolation.unwrap_or(Interpolation::Hold));
        if interpolation.is_none() {
            data.input = None;
        }
        let got = evaluate::<f64>(&job(&data, 3, &[]), &[point])?[0].squares[0];
        let expected = squares(&filtered(&data, &[term], &own, 3));
        near(&format!("{interpolation:?}"), got / expected, 1.0, 1e-12)?;
        sums.push(got);
    }
    check(sums[0] != sums[1] && sums[1] != sums[2], format!("the inputs do not differ: {sums:?}"))
}

fn fourth_order() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let point = Point { cubic: 2e3 * STIFF, ..base() };
    let at = |steps| Ok::<f64, Failed>(evaluate::<f64>(&job(&data, steps, &[]), &[point])?[0].squares[0]);
    let exact = at(32)?;
    let ratio = (at(4)? - exact) / (at(8)? - exact);
    // 2⁴ for a method of order four; of order three 8, of five 32.
    check((12.0..22.0).contains(&ratio), format!("halving the step divides the error by {ratio}"))
}

fn grouping() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let whole = job(&data, 4, &[]);
    let many: Vec<Point> = (0..150).map(|i| Point { cubic: f64::from(i + 1) * STIFF, ..base() }).collect();
    let together = evaluate::<f32>(&whole, &many)?;
    let apart = Job { blocks: vec![24..500, 500..501, 620..1476], ..whole.clone() };
    let blocks = evaluate::<f32>(&apart, &many)?;
    let gap = Job { blocks: vec![501..560, 560..620], ..whole.clone() };
    let gaps = evaluate::<f32>(&gap, &many)?;
    for (i, point) in many.iter().enumerate() {
        let alone = &evaluate::<f32>(&whole, &[*point])?[0];
        check(*alone == together[i], format!("point {i} differs in company: {alone:?} and {:?}", together[i]))?;
        let parts: f64 = blocks[i].squares.iter().chain(&gaps[i].squares).sum();
        // Sums of 64 squares are rounded to f32 before they are added in f64.
        near("blocks", parts / alone.squares[0], 1.0, 1e-6)?;
        check(parts - gaps[i].squares[0] < 0.99 * alone.squares[0], "a block left out is not missed")?;
    }
    Ok(())
}

fn projections() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let wave = |p: f64| (0..data.hull.len()).map(|k| (0.37 * k as f64 + p).sin() / 30.0).collect::<Vec<f64>>();
    let directions = [wave(0.0), wave(1.6)];
    let errors = filtered(&data, &[Term::BiasDrift(drift::Ramp)], &[0.002], 4);
    let point = Point { ramp: 0.002, ..base() };
    for (name, got, tolerance) in [
        ("f64", evaluate::<f64>(&job(&data, 4, &directions), &[point])?, 1e-12),
        ("f32", evaluate::<f32>(&job(&data, 4, &directions), &[point])?, 1e-5),
    ] {
        for (d, along) in directions.iter().zip(&got[0].along) {
            let expected: f64 = d.iter().zip(&errors).map(|(d, e)| d * e).sum();
            near(name, *along, expected, tolerance * squares(&errors).sqrt())?;
        }
        check((got[0].along[0] - got[0].along[1]).abs() > 1e-3, "both directions give the same")?;
    }
    Ok(())
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
    let (terms, own) = ([Term::CubicStiffness(spring::Cubic)], [300.0 * STIFF]);
    let data = planted(&terms, &own);
    let scales = first_scales(&data);
    let start: Vec<f64> = FITTED.iter().chain(&own).copied().collect();
    let shape = Shape::new(&terms);
    let fitted = fit(&data, &shape, &start, &scales, 20).ok_or("no fit")?;
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
        evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
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
        let mut search = Search::all(&data, &shape, &fitted.point, &scales);
        search.run.steps = fitted.steps;
        search.point[BASE] = *at;
        let alone = loss(search.sums(&[search.z(&search.point)])[0]);
        search.free.retain(|f| *f != BASE);
        let refitted = loss(search.minimise(10).ok_or("no refit")?.sum);
        // Single precision leaves 1e-6 of the sum of squares: 1e-6 · ½n = 5e-4.
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
    let term = Term::EndStop(contact::EndStop(contact::Side::Upper));
    let own = [20.0 * STIFF, 0.0205];
    let data = planted(&[term], &own);
    let scales = Scales { omega_rad_s: OMEGA, ..first_scales(&data) };
    let base = fit(&data, &Shape::new(&[]), &FITTED, &scales, 20).ok_or("no fit")?;
    let scales = refined(&data, &base, &scales);
    let ensemble = StartSearch::around(&data, &base, &scales).ok_or("no ensemble")?;
    let starts = ensemble.starts(term, &scales, 1).ok_or("no starts")?;
    let (shape, point) = base.with(term, &starts[0]);
    let found = fit(&data, &shape, &point, &scales, 20).ok_or("no fit with the stop")?;
    near("the gap", found.point[BASE + 1] / own[1], 1.0, 0.01)?;
    // The noise is spread evenly over 1e-4.
    let noise = 1e-8 / 12.0;
    check(found.variance < 1.3 * noise, format!("{:e} is left of {noise:e}", found.variance))?;
    check(base.variance > 4.0 * noise, format!("the base model alone leaves {:e}", base.variance))
}

fn lost() -> Result<(), Failed> {
    let data = data(Interpolation::BandLimited);
    let whole = job(&data, 4, &[]);
    let good = Point { cubic: STIFF, ..base() };
    // A spring that softens until it pushes: every orbit leaves.
    let bad = Point { cubic: -1e9 * STIFF, ..base() };
    let both = evaluate::<f32>(&whole, &[good, bad, good])?;
    check(both[1].squares[0] == f64::INFINITY, format!("a lost point is said to misfit by {:?}", both[1]))?;
    check(both[0] == evaluate::<f32>(&whole, &[good])?[0] && both[0] == both[2], "a lost point harms its neighbours")
}

fn gpu_follows_cpu() -> Result<(), Failed> {
    let gpu = Gpu::open()?;
    let data = data(Interpolation::BandLimited);
    let directions = [(0..data.hull.len()).map(|k| (0.37 * k as f64).sin() / 30.0).collect::<Vec<f64>>()];
    let blocks = vec![24..700, 900..1476];
    let job = Job { blocks, ..job(&data, 3, &directions) };
    let mut control = 0.0f64;
    // Two points of each candidate, so that a workgroup holds unequal ones.
    let all = cases().into_iter().map(|c| (c.0, c.3)).chain([("everything", everything())]);
    for (name, point) in all {
        let points = [point, Point { gain: 1.0001 * FITTED[0], ..point }];
        let (on_gpu, on_cpu) = (gpu::misfits::evaluate(&gpu, &job, &points)?, evaluate::<f32>(&job, &points)?);
        for (g, c) in on_gpu.iter().zip(&on_cpu) {
            for (g, c) in g.squares.iter().zip(&c.squares) {
                near(name, g / c, 1.0, 1e-5)?;
            }
            near(name, g.along[0], c.along[0], 1e-5)?;
        }
        control = control.max((on_gpu[1].squares[0] / on_cpu[0].squares[0] - 1.0).abs());
    }
    let bad = Point { cubic: -1e9 * STIFF, ..base() };
    let found = gpu::misfits::evaluate(&gpu, &job, &[bad])?;
    check(found[0].squares[0] == f64::INFINITY, format!("a lost point is said to misfit by {found:?}"))?;
    check(control > 1e-5, "the comparison does not see a gain wrong by 1e-4")
}
