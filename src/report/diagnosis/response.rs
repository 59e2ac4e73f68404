//! Figures of a diagnosis: sweeps of a resonator.

use proofmass_diagnosis::response::detail::{Detail, Sweep};

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark, labelled};

/// X and Y of every step, of one kind.
type Steps = fn(&Sweep) -> &Vec<[f64; 2]>;

/// Points of a sweep.
type Curve<'a> = &'a dyn Fn(&Sweep) -> Vec<(f64, f64)>;

/// Its figures; the amplitude is the opening.
pub(super) fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    if detail.sweeps.is_empty() {
        return Vec::new();
    }
    let per_drive = labelled("amplitude over drive", &format!("{}/{}", detail.unit, detail.drive_unit));
    let frequency = || Axis::linear("frequency / Hz");
    let size = |of: Steps| {
        move |s: &Sweep| -> Vec<(f64, f64)> {
            s.frequency_hz.iter().zip(of(s)).map(|(f, [x, y])| (*f, x.hypot(*y) / s.drive)).collect()
        }
    };
    let angle = |of: Steps| {
        move |s: &Sweep| -> Vec<(f64, f64)> {
            s.frequency_hz.iter().zip(of(s)).map(|(f, [x, y])| (*f, y.atan2(*x).to_degrees())).collect()
        }
    };
    let circle = |of: Steps| {
        move |s: &Sweep| -> Vec<(f64, f64)> { of(s).iter().map(|[x, y]| (x / s.drive, y / s.drive)).collect() }
    };
    let (read, model): (Steps, Steps) = (|s| &s.read, |s| &s.model);
    let all = |name: &str, part: Part, chart: Chart, caption: &str| Exhibit {
        part,
        name: name.into(),
        figure: chart.draw(),
        caption: caption.into(),
    };
    let mut out = vec![
        all(
            "amplitude",
            Part::Opening,
            sweeps(
                Chart::new("Amplitude of the sweeps", frequency(), Axis::linear(&per_drive)),
                detail,
                [&size(read), &size(model)],
            ),
            "Amplitude over drive as read, up and down, and as the model has it when the history of each sweep is \
             followed: a jump is where the motion that was followed ceases to be stable.",
        ),
        all(
            "phase",
            Part::Improvement,
            sweeps(
                Chart::new("Phase of the sweeps", frequency(), Axis::linear("phase / °")),
                detail,
                [&angle(read), &angle(model)],
            ),
            "Phase of the same steps.",
        ),
        all(
            "nyquist",
            Part::Improvement,
            sweeps(
                Chart::new(
                    "Nyquist diagram",
                    Axis::linear(&per_drive.replacen("amplitude", "X", 1)),
                    Axis::linear(&per_drive.replacen("amplitude", "Y", 1)),
                ),
                detail,
                [&circle(read), &circle(model)],
            ),
            "Y over X, both over the drive. A linear resonance is a circle, shifted by the background.",
        ),
    ];
    let mut spine = Chart::new(
        "Backbone and branches",
        frequency(),
        Axis::linear(&labelled("amplitude of the motion", &detail.unit)),
    );
    for (n, (drive, branch)) in detail.backbone.branches.iter().enumerate() {
        let name = format!("stable, drive {}", proofmass_base::number::short(*drive));
        spine.add(&name, Ink::nth(n), Mark::Dots(1), branch.clone());
    }
    spine.add("largest amplitude", Ink::Black, Mark::Line, detail.backbone.spine.clone());
    out.push(all(
        "backbone",
        Part::Improvement,
        spine,
        "Every stable motion that the model allows at each drive, and the largest amplitude as the drive grows. Where \
         two stand at one frequency, the history of the sweep decides.",
    ));
    let errors = |i: usize| -> Vec<(f64, f64)> {
        detail.sweeps.iter().flat_map(|s| s.frequency_hz.iter().zip(&s.errors).map(move |(f, e)| (*f, e[i]))).collect()
    };
    let mut residual =
        Chart::new("Residual over the noise", frequency(), Axis::linear("root-mean-square of X and Y over the noise"))
            .with("base model", Ink::Soft, Mark::Dots(2), errors(0));
    let named = detail.sweeps.iter().any(|s| s.errors.iter().any(|e| e[0] != e[1]));
    if named {
        residual.add("with the named physics", Ink::Red, Mark::Dots(2), errors(1));
    }
    out.push(all(
        "residual",
        Part::Isolation,
        residual,
        "Error of each step over the measured noise; 1 is noise alone.",
    ));
    out
}

/// Steps as read, up and down, and lines of the model.
fn sweeps(mut chart: Chart, detail: &Detail, [read, model]: [Curve<'_>; 2]) -> Chart {
    for (rises, name, ink) in [(true, "read, up", Ink::Blue), (false, "read, down", Ink::Orange)] {
        let points: Vec<(f64, f64)> = detail.sweeps.iter().filter(|s| s.rises == rises).flat_map(read).collect();
        if !points.is_empty() {
            chart.add(name, ink, Mark::Dots(2), points);
        }
    }
    for (n, sweep) in detail.sweeps.iter().enumerate() {
        chart.add(if n == 0 { "model" } else { "" }, Ink::Red, Mark::Line, model(sweep));
    }
    chart
}
