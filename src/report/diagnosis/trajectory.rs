//! Figures of a diagnosis: an IMU in motion.

use proofmass_diagnosis::trajectory::detail::{Detail, Series};

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark};

/// Its figures; one of them is the opening.
pub(super) fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    let mut out = Vec::new();
    if !detail.attitude.before.is_empty() {
        out.push(exhibit(
            Part::Opening,
            "attitude-error",
            series("Attitude against the reference", "error of the rate / (mrad/s)", &detail.attitude),
            "Change of the angle between the reference's attitude and that integrated from the gyro, over each short \
             window.",
        ));
        out.push(exhibit(
            Part::Improvement,
            "attitude-drift",
            Chart::new("Dead-reckoned attitude", Axis::linear("time / s"), Axis::linear("angle / mrad")).with(
                "everything fitted",
                Ink::Red,
                Mark::Line,
                detail.drift.iter().map(|(t, v)| (*t, v * 1e3)).collect(),
            ),
            "Angle between the reference and attitude dead-reckoned through the whole recording, both ways from its \
             middle.",
        ));
    }
    if !detail.position.before.is_empty() {
        out.push(exhibit(
            if detail.attitude.before.is_empty() { Part::Opening } else { Part::Improvement },
            "acceleration-error",
            series("Position against the reference", "error of acceleration / (mm/s²)", &detail.position),
            if detail.attitude.before.is_empty() {
                "Second difference of the distance, up and down, between the reference's position and that integrated from \
                 specific force along the gyro's attitude."
            } else {
                "Second difference of the distance between the reference's position and that integrated from specific force."
            },
        ));
    }
    let sensors = [("gyro", "(mrad/s)/√Hz"), ("accelerometer", "(mm/s²)/√Hz")];
    for (k, (name, unit)) in sensors.into_iter().enumerate() {
        let points: Vec<(f64, f64)> = detail.spectra[k].iter().map(|(hz, v)| (*hz, (v * 1e3).max(1e-9))).collect();
        let ends = [points.first().map_or(1.0, |p| p.0), points.last().map_or(1.0, |p| p.0)];
        let mut chart = Chart::new(
            &format!("Spectrum of the {name} in motion"),
            Axis::log("frequency / Hz"),
            Axis::log(&format!("density / {unit}")),
        )
        .with("in motion", Ink::Blue, Mark::Line, points);
        if let Some(stated) = detail.stated[k] {
            chart.add("stated", Ink::Black, Mark::Dashed, ends.map(|hz| (hz, stated * 1e3)).to_vec());
        }
        out.push(exhibit(
            if k == 0 && out.is_empty() { Part::Opening } else { Part::Isolation },
            &format!("spectrum-{name}"),
            chart,
            "Mean of the three axes. Above the frequencies of the motion, anything over the stated noise is vibration.",
        ));
    }
    out
}

fn series(title: &str, label: &str, series: &Series) -> Chart {
    let points = |of: &[(f64, f64)]| of.iter().map(|(t, v)| (*t, v * 1e3)).collect();
    let mut chart = Chart::new(title, Axis::linear("time / s"), Axis::linear(label)).with(
        "as it was",
        Ink::Soft,
        Mark::Dots(2),
        points(&series.before),
    );
    // Where nothing was named, both are the same.
    if series.after != series.before {
        chart.add("with the named physics", Ink::Red, Mark::Dots(2), points(&series.after));
    }
    chart
}

fn exhibit(part: Part, name: &str, chart: Chart, caption: &str) -> Exhibit {
    Exhibit { part, name: name.into(), figure: chart.draw(), caption: caption.into() }
}
