//! Draws unmodelled driven cases: physics that no candidate describes.

use std::f64::consts::TAU;

use super::draw::Draw;
use super::exact::Made;
use super::law::{Course, Law};
use super::oscillator_base::{Size, Wish, stage};
use super::readout::Readout;
use super::sizing::{Piece, assemble, strengthen, target};
use super::truth::{Truth, effect};

pub(super) const SUBS: [&str; 11] = [
    "fractional damping",
    "parametric excitation",
    "play in the drive",
    "mass changes",
    "clock jitter",
    "rows lost",
    "crosstalk of another signal",
    "dead zone in the drive",
    "telegraph force",
    "feedback with delay",
    "another force",
];

fn piece(sub: &str, draw: &mut Draw, o: &super::oscillator::Oscillator, target: f64) -> (Piece, Vec<&'static str>) {
    let f0 = o.omega / TAU;
    let rows_per_cycle = o.rate_hz / f0;
    let band = [f0 * draw.log_between(0.1, 0.8), (f0 * draw.log_between(1.2, 4.0)).min(0.4 * o.rate_hz)];
    let band = [band[0].min(0.5 * band[1]), band[1]];
    let law = Piece::Law;
    match sub {
        "fractional damping" => {
            (law(Law::Fractional { size: target * o.zeta, alpha: draw.between(0.3, 0.7) }), Vec::new())
        }
        "parametric excitation" => {
            (law(Law::Parametric { size: target * o.zeta, hz: f0 * draw.between(0.05, 2.5) }), vec!["stiffness-drift"])
        }
        "play in the drive" => (law(Law::DrivePlay { size: target }), vec!["drive-nonlinearity", "hysteresis"]),
        "mass changes" => {
            let course = Course::Sine { periods: draw.between(0.5, 3.0), phase: draw.between(0.0, 6.0) };
            (law(Law::MassDrift { size: target * o.zeta, course }), vec!["stiffness-drift"])
        }
        "clock jitter" => (Piece::Jitter((target * rows_per_cycle / TAU).clamp(0.01, 0.3)), Vec::new()),
        "rows lost" => {
            let lost = (target * rows_per_cycle).ceil().clamp(1.0, 20.0);
            (Piece::Slip([draw.between(0.2, 0.8), lost]), vec!["readout-delay", "input-lag"])
        }
        "crosstalk of another signal" => {
            (Piece::Stage(Readout::Cross { size: target, from_hz: band[0], to_hz: band[1] }), Vec::new())
        }
        "dead zone in the drive" => (law(Law::DriveDead { size: 0.5 * target }), vec!["drive-nonlinearity"]),
        "telegraph force" => {
            let dwell = draw.log_between(3.0, 30.0) / f0;
            (law(Law::Telegraph { size: target, dwell }), vec!["force-noise"])
        }
        "feedback with delay" => {
            (law(Law::Feedback { size: 0.3 * target, delay: draw.between(0.5, 3.0) / f0 }), Vec::new())
        }
        _ => (law(Law::Foreign { size: target, from_hz: band[0], to_hz: band[1] }), vec!["force-noise"]),
    }
}

/// Returns the sub-family of the n-th case.
pub(crate) fn sub(nth: usize) -> &'static str {
    SUBS[nth % SUBS.len()]
}

/// The n-th case of the family.
pub(crate) fn draw(nth: usize, draw: &mut Draw, size: Size) -> Made {
    let sub = sub(nth);
    loop {
        let base = stage(draw, Wish::Rich, size);
        let target = target(draw, &base);
        let (mut piece, tolerable) = piece(sub, draw, &base.oscillator, target);
        if !strengthen(&base, &mut piece, target) {
            continue;
        }
        let tolerable = tolerable.into_iter().map(str::to_owned).collect();
        let truth = Truth { tolerable, ..Truth::default() };
        if let Some((driven, truth)) = assemble(base, &[(piece, effect(&[]))], truth) {
            return (sub.to_owned(), driven, truth);
        }
    }
}
