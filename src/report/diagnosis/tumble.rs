//! Figures of a diagnosis: an IMU in many still poses.

use proofmass_diagnosis::tumble::{Detail, PoseDetail};

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark};

/// Its figures; one of them is the opening.
pub(crate) fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    let mut out = vec![
        exhibit(
            Part::Opening,
            "residual-by-pose",
            opening(detail),
            "Residual of each pose relative to its noise, all three kinds together, before and after the identified \
             physics. Dashed: noise alone; poses well above it show missing physics.",
        ),
        exhibit(
            Part::Improvement,
            "gravity-length",
            by_pose(detail, "Magnitude of gravity: |f| − g", "error / (mm/s²)", 0),
            "Magnitude of the specific force minus gravity in each pose. Bars: the noise of a \
             pose (±2 standard deviations).",
        ),
        exhibit(
            Part::Improvement,
            "turn-direction",
            by_pose(detail, "Gravity's direction after a turn", "error / mrad", 4),
            "The integrated gyro rotates gravity from one pose to the next: the angle between the result and what the \
            accelerometer reads.",
        ),
    ];
    for axis in 0..3 {
        let name = ["x", "y", "z"][axis];
        out.push(exhibit(
            Part::Improvement,
            &format!("still-{name}"),
            by_pose(detail, &format!("Gyro at rest, {name}"), "rate / (°/s)", 1 + axis),
            "The gyro's reading where the rate is zero, pose by pose.",
        ));
    }
    for axis in 0..3 {
        let name = ["x", "y", "z"][axis];
        out.push(exhibit(
            Part::Isolation,
            &format!("rate-by-force-{name}"),
            follows(detail, axis),
            "The gyro at rest against the component of gravity along the axis that it follows most. A slope is \
             g-sensitivity.",
        ));
    }
    out.push(exhibit(
        Part::Isolation,
        "stillness",
        stillness(detail),
        "Magnitude of the specific force over time with the repaired calibration; the band marks the poses.",
    ));
    if !detail.g_sensitivity.is_empty() {
        out.push(exhibit(
            Part::Identification,
            "g-sensitivity",
            intervals(detail),
            "The gyro's g-sensitivity, entry by entry (row: gyro axis, column: direction of force), with 95 % intervals.",
        ));
    }
    out
}

fn exhibit(part: Part, name: &str, chart: Chart, caption: &str) -> Exhibit {
    Exhibit { part, name: name.into(), figure: chart.draw(), caption: caption.into() }
}

/// Root-mean-square residual of a pose over its noise.
fn over_noise(values: &[f64; 5], noise: &[f64; 5]) -> f64 {
    let terms: Vec<f64> = values.iter().zip(noise).filter(|(_, n)| **n > 0.0).map(|(v, n)| (v / n).powi(2)).collect();
    (terms.iter().sum::<f64>() / terms.len().max(1) as f64).sqrt()
}

fn opening(detail: &Detail) -> Chart {
    let points = |of: fn(&PoseDetail) -> &[f64; 5]| -> Vec<(f64, f64)> {
        detail.poses.iter().enumerate().map(|(k, p)| (k as f64 + 1.0, over_noise(of(p), &p.noise).max(0.05))).collect()
    };
    let last = detail.poses.len() as f64;
    Chart::new("Residual of each pose", Axis::linear("pose"), Axis::log("residual over noise"))
        .with("noise alone", Ink::Black, Mark::Dashed, vec![(0.0, 1.0), (last + 1.0, 1.0)])
        .with("before", Ink::Soft, Mark::Dots(4), points(|p| &p.before))
        .with("with the named physics", Ink::Red, Mark::Dots(4), points(|p| &p.after))
}

/// One of a pose's five residuals, pose by pose, with the noise of each.
fn by_pose(detail: &Detail, title: &str, label: &str, channel: usize) -> Chart {
    // The last pose has no move after it.
    let used = detail.poses.iter().enumerate().filter(|(_, p)| p.noise[channel] > 0.0);
    let poses: Vec<(f64, &PoseDetail)> = used.map(|(k, p)| (k as f64 + 1.0, p)).collect();
    let points = |value: &dyn Fn(&PoseDetail) -> f64| poses.iter().map(|(k, p)| (*k, value(p))).collect();
    let noise = poses.iter().map(|(_, p)| 2.0 * p.noise[channel]).collect();
    // An error of direction has no sign.
    let below = points(&|p| if channel == 4 { 0.0 } else { -2.0 * p.noise[channel] });
    Chart::new(title, Axis::linear("pose"), Axis::linear(label))
        .with("", Ink::Black, Mark::Whiskers(noise), below)
        .with("before", Ink::Soft, Mark::Dots(4), points(&|p| p.before[channel]))
        .with("after", Ink::Red, Mark::Dots(4), points(&|p| p.after[channel]))
}

/// The gyro's axis against the component of gravity that it correlates with most.
fn follows(detail: &Detail, axis: usize) -> Chart {
    let correlation = |along: usize| {
        let sum: f64 = detail.poses.iter().map(|p| p.before[1 + axis] * p.share[along]).sum();
        let power: f64 = detail.poses.iter().map(|p| p.share[along].powi(2)).sum();
        sum / power.max(f64::MIN_POSITIVE).sqrt()
    };
    let along = (0..3).max_by(|a, b| correlation(*a).abs().total_cmp(&correlation(*b).abs())).unwrap_or(0);
    let points = |of: fn(&PoseDetail) -> &[f64; 5]| -> Vec<(f64, f64)> {
        detail.poses.iter().map(|p| (p.share[along], of(p)[1 + axis])).collect()
    };
    let names = ["x", "y", "z"];
    Chart::new(
        &format!("Gyro {} against gravity along {}", names[axis], names[along]),
        Axis::linear(&format!("specific force along {} / g", names[along])),
        Axis::linear("rate at rest / (°/s)"),
    )
    .with("before", Ink::Soft, Mark::Dots(4), points(|p| &p.before))
    .with("with the named physics", Ink::Red, Mark::Dots(4), points(|p| &p.after))
}

fn stillness(detail: &Detail) -> Chart {
    let g = detail.gravity_m_s2;
    let mut chart = Chart::new(
        if detail.poses_found { "Still poses, found by the tool" } else { "Still poses, as given" },
        Axis::linear("time / s"),
        Axis::linear("|f| / (m/s²)").within(g - 3.0, g + 3.0),
    );
    for (k, pose) in detail.poses.iter().enumerate() {
        let name = if k == 0 { "pose" } else { "" };
        let ends = pose.time_s.map(|t| (t, g - 2.6));
        chart.add(name, Ink::Sky, Mark::Band(vec![g - 2.2; 2]), ends.to_vec());
    }
    chart.with("|f|", Ink::Black, Mark::Line, detail.length_m_s2.clone())
}

fn intervals(detail: &Detail) -> Chart {
    let entries = &detail.g_sensitivity;
    let at = |n: usize| n as f64 + 1.0;
    let mut chart = Chart::new(
        "g-sensitivity of the gyro",
        Axis::linear("entry of K: xx xy xz, yx yy yz, zx zy zz").within(0.5, entries.len() as f64 + 0.5),
        Axis::linear("g-sensitivity / (°/s/g)"),
    )
    .with("", Ink::Soft, Mark::Dashed, vec![(0.5, 0.0), (entries.len() as f64 + 0.5, 0.0)]);
    chart.add(
        "95 % interval",
        Ink::Blue,
        Mark::Whiskers(entries.iter().map(|e| e.2[1]).collect()),
        entries.iter().enumerate().map(|(n, e)| (at(n), e.2[0])).collect(),
    );
    chart.add("fitted", Ink::Blue, Mark::Dots(4), entries.iter().enumerate().map(|(n, e)| (at(n), e.1)).collect());
    chart
}
