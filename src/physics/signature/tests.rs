//! Pictures against closed forms, and one for every law.

use super::super::candidate::{Candidate, Kind};
use super::super::library::CANDIDATES;
use super::{Curve, Picture, of};

fn picture(id: &str, kind: Kind) -> Picture {
    let candidate = CANDIDATES.iter().find(|c| c.id == id).expect("it is listed");
    of(&Candidate { kind, ..*candidate }).expect("it has a picture")
}

fn law(picture: &Picture) -> &Curve {
    picture.curves.last().expect("a picture has curves")
}

fn at(curve: &Curve, x: f64) -> f64 {
    let near = curve.points.iter().min_by(|a, b| (a.0 - x).abs().total_cmp(&(b.0 - x).abs()));
    near.expect("a curve has points").1
}

#[test]
fn every_law_has_a_picture_with_a_curve_that_is_not_its_guide() {
    for candidate in CANDIDATES {
        for kind in [Kind::Driven, Kind::Response] {
            let picture = of(&Candidate { kind, ..*candidate });
            let picture = picture.unwrap_or_else(|| panic!("{} has none", candidate.id));
            let law = law(&picture);
            assert!(!law.is_guide && law.points.len() > 20, "{}", candidate.id);
            let all = picture.curves.iter().flat_map(|c| &c.points);
            assert!(all.clone().all(|p| p.0.is_finite() && p.1.is_finite()), "{}", candidate.id);
            let guide = picture.curves.iter().find(|c| c.is_guide);
            // By 5 %: a line is about 1 % of the height wide.
            let differs = |g: &Curve| law.points.iter().any(|p| (at(g, p.0) - p.1).abs() > 0.05 * p.1.abs());
            assert!(guide.is_none_or(differs), "{} looks like what it would be without", candidate.id);
        }
    }
}

#[test]
fn forces_have_the_shape_of_their_equations() {
    let cube = picture("cubic-stiffness", Kind::Driven);
    assert!(law(&cube).points.iter().all(|(x, y)| (y - x.powi(3)).abs() < 1e-12));
    let drag = picture("quadratic-damping", Kind::Driven);
    assert!(
        drag.x.label.starts_with("velocity") && law(&drag).points.iter().all(|(v, f)| (f - v * v.abs()).abs() < 1e-12)
    );
    assert!(picture("drive-nonlinearity", Kind::Driven).x.label.starts_with("input"));
    // −c x² x′ over x = cos t is −c cos² t · (−sin t): largest where cos² = 2/3. Of 400 instants one is within π/400
    // of it, where less than 3·(π/400)²/2 = 1e-4 of the force is missing.
    let film = picture("squeeze-film-damping", Kind::Driven);
    let most = (1.0f64 / 3.0).sqrt() * 2.0 / 3.0;
    let off = |(x, y): &(f64, f64)| (y.abs() - x * x * (1.0 - x * x).max(0.0).sqrt() / most).abs();
    assert!(law(&film).points.iter().all(|p| off(p) < 1e-3));
}

#[test]
fn a_spring_with_memory_runs_through_a_loop() {
    let loops = picture("hysteresis", Kind::Driven);
    assert!(loops.x.label.starts_with("displacement"), "{}", loops.x.label);
    let points = &law(&loops).points;
    let (begin, end) = (points[0], points[points.len() - 1]);
    assert!((begin.0 - end.0).hypot(begin.1 - end.1) < 1e-3, "it closes: {begin:?} {end:?}");
    let area: f64 = points.windows(2).map(|p| 0.5 * (p[0].0 * p[1].1 - p[1].0 * p[0].1)).sum();
    // The square that the axes span has an area of 4, a force without memory encloses none.
    assert!(area.abs() > 0.5, "{area}");
}

#[test]
fn filters_and_modes_answer_as_their_equations_say() {
    let corner = |id| picture(id, Kind::Trajectory);
    let (low, high) = (corner("readout-lowpass"), corner("readout-highpass"));
    for (f, gain) in &law(&low).points {
        assert!((gain - 1.0 / (1.0 + f * f).sqrt()).abs() < 1e-9);
    }
    for (f, gain) in &law(&high).points {
        assert!((gain - f / (1.0 + f * f).sqrt()).abs() < 1e-9);
    }
    // An AC-coupled input of time constant τ: the gain of the mass times |1 + 1/(jωτ)|.
    let coupled = picture("input-highpass", Kind::Driven);
    let ratio = |f| at(&coupled.curves[1], f) / at(&coupled.curves[0], f);
    let tau = (ratio(1.0).powi(2) - 1.0).sqrt().recip();
    assert!((ratio(0.1) - (1.0 + (0.1 * tau).powi(-2)).sqrt()).abs() < 1e-6 && tau > 1.0);
    // A second mass as heavy as the first, a twentieth above it: two peaks with a dip at its own frequency.
    let split = picture("coupled-mode", Kind::Driven);
    assert!(at(law(&split), 1.05) < 0.3 * at(law(&split), 0.65));
}

#[test]
fn resonances_bend_and_widen_with_the_drive() {
    let top = |curve: &Curve| curve.points.iter().copied().fold((0.0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let spring = picture("cubic-stiffness", Kind::Response);
    let tops: Vec<f64> = spring.curves.iter().map(|c| top(c).0).collect();
    assert!(tops.windows(2).all(|pair| pair[0] < pair[1]), "{tops:?}");
    // ω² = 1 + ¾βa² on the backbone, where ¾β is a quarter of 2ζ, at twice the drive; frequencies are 0.005 apart,
    // so that ω² is known to 0.01.
    let (f, part) = top(&spring.curves[3]);
    assert!((f * f - 1.0 - 0.025 * (2.0 * part).powi(2)).abs() < 0.01, "{f}");
    let drag = picture("quadratic-damping", Kind::Response);
    let heights: Vec<f64> = drag.curves.iter().map(|c| top(c).1).collect();
    assert!(heights.windows(2).all(|pair| pair[0] > pair[1]), "{heights:?}");
}
