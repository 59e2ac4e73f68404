//! Figures 1 to 4 on the page.

use super::section::{checks, head, thin};
use crate::Paper;
use crate::array::{self, SENSORS};
use crate::envelope::Envelope;
use crate::growth::{ANGLE_WALK_RAD_RTS, Growth};
use proofmass_base::number::significant;
use proofmass_base::units::{DEGREE, STANDARD_GRAVITY_M_S2};
use proofmass_report::figure::{Axis, Chart, Ink, Mark};
use proofmass_report::html::Page;

pub(super) fn write(page: &mut Page, paper: &Paper) {
    one(page, &paper.array);
    figure_2(page, &paper.growth);
    figure_3(page, &paper.growth);
    figure_4(page, &paper.growth);
}

fn one(page: &mut Page, array: &array::Array) {
    head(page, &array.exhibit);
    page.paragraph(
        "The Allan deviation answers: if I average a resting sensor for a time τ, how much do two neighbouring averages \
         differ? White noise averages out and falls as 1/√τ. A slow walk of the zero point does the opposite and rises. The \
         lowest point between them is the best that averaging can do.",
    );
    let mut chart = Chart::new(
        "Averages of one sensor and of sixteen",
        Axis::log("averaging time τ / s"),
        Axis::log("Allan deviation / (m/s²)"),
    );
    for (name, d, ink) in [("single sensor", &array.single, Ink::Blue), ("mean of 16", &array.array, Ink::Green)] {
        let low: Vec<(f64, f64)> = d.curve.iter().zip(&d.band).map(|(c, b)| (c.0, b.0)).collect();
        chart.add("", ink, Mark::Band(d.band.iter().map(|b| b.1).collect()), low);
        chart.add(name, ink, Mark::Line, d.curve.clone());
        chart.add("", Ink::Soft, Mark::Dashed, d.law.clone());
    }
    chart.add("law of what was put in", Ink::Soft, Mark::Dashed, vec![]);
    page.figure(
        &chart.draw(),
        &format!(
            "Four hours of {SENSORS} simulated accelerometers at 20 Hz: white noise of 1 mm/s/√s each, and one walk of 4 \
             µm/s²/√s that all share, as a common temperature would make it. Overlapping Allan deviation with its 95 % band. \
             The white part falls by √16 = 4; the shared part does not fall at all, so the best average gains only a factor 2."
        ),
    );
    checks(page, &array.exhibit);
}

fn figure_2(page: &mut Page, growth: &Growth) {
    head(page, &growth.exhibits[0]);
    page.paragraph(
        "The accelerometer cannot tell gravity from motion. If the sensor believes it is level but is tilted by Δ, a part g \
         sin Δ of gravity looks like acceleration, and eq. 2 integrates it twice.",
    );
    let pick = |value: fn(&(f64, f64, f64)) -> f64| -> Vec<(f64, f64)> {
        thin(&growth.rolls.iter().map(|r| (r.0, value(r) / DEGREE)).collect::<Vec<_>>(), 500)
    };
    let rolls = Chart::new("Two sensors, one of them off by 0.2°", Axis::linear("time / s"), Axis::linear("roll / °"))
        .with("true zero", Ink::Blue, Mark::Line, pick(|r| r.1))
        .with("biased by Δ = 0.2°", Ink::Red, Mark::Line, pick(|r| r.2))
        .draw();
    let e = &growth.tilted;
    let law = |t: f64| 0.5 * STANDARD_GRAVITY_M_S2 * (0.2 * DEGREE).sin() * t * t;
    let distance = Chart::new("What that becomes", Axis::linear("time / s"), Axis::linear("distance error / m"))
        .with("5 to 95 %", Ink::Red, Mark::Band(e.p95.clone()), e.curve(&e.p05))
        .with("mean of 2000", Ink::Red, Mark::Line, e.curve(&e.mean))
        .with("½ g sin Δ t²", Ink::Black, Mark::Dashed, e.time_s.iter().map(|t| (*t, law(*t))).collect())
        .draw();
    page.figure_row(&[
        (&rolls, "A simulated slow roll seen by two sensors with a noise of 0.02°, one with a bias of 0.2°."),
        (
            &distance,
            "Eq. 2 with aₙ = g sin 0.2° = 0.034 m/s² plus white noise of 1.4 mm/s/√s: 1.7 m after ten seconds, as the paper \
             says. The noise alone would be a few centimetres.",
        ),
    ]);
    checks(page, &growth.exhibits[0]);
}

fn figure_3(page: &mut Page, growth: &Growth) {
    head(page, &growth.exhibits[1]);
    page.paragraph(
        "A gyro reads rate, and angle is its integral. White noise of the rate, integrated, is a walk: each step is \
         independent, the steps never cancel for good, and the typical distance from the start grows as √t. Two axes walk \
         independently and draw the path of a Brownian particle.",
    );
    let mut plane =
        Chart::new("Five walks over 100 s", Axis::linear("angle about x / °"), Axis::linear("angle about y / °"));
    let radius = ANGLE_WALK_RAD_RTS * 200f64.sqrt() / DEGREE;
    let circle = |k: i32| {
        let a = f64::from(k) * std::f64::consts::PI / 60.0;
        (radius * a.cos(), radius * a.sin())
    };
    for (i, walk) in growth.walks.iter().enumerate() {
        let degrees: Vec<(f64, f64)> = walk.iter().map(|p| (p.0 / DEGREE, p.1 / DEGREE)).collect();
        plane.add("", Ink::nth(i), Mark::Line, degrees);
    }
    plane.add("N√(2t)", Ink::Black, Mark::Dashed, (0..=120).map(circle).collect());
    plane.size = (480, 460);
    plane.equal = true;
    let rms: Vec<(f64, f64)> = growth.rms.iter().map(|p| (p.0, p.1 / DEGREE)).collect();
    let law = rms.iter().map(|p| (p.0, ANGLE_WALK_RAD_RTS * (2.0 * p.0).sqrt() / DEGREE)).collect();
    let growth_chart =
        Chart::new("Distance from the start", Axis::log("time / s"), Axis::log("root mean square angle / °"))
            .with("2000 walks", Ink::Blue, Mark::Line, rms)
            .with("N√(2t)", Ink::Black, Mark::Dashed, law)
            .draw();
    page.figure_row(&[
        (
            &plane.draw(),
            "Two gyro axes with an angle random walk N of 3 °/√h each, integrated at 10 Hz; the circle is the root \
                  mean square distance of all walks after 100 s.",
        ),
        (
            &growth_chart,
            "Root mean square over 2000 walks against the law: slope one half. The checks below also ask whether \
                  any direction is preferred.",
        ),
    ]);
    checks(page, &growth.exhibits[1]);
}

fn figure_4(page: &mut Page, growth: &Growth) {
    head(page, &growth.exhibits[2]);
    page.paragraph(
        "An accelerometer's bias is integrated twice and grows as ½ b t². A gyro's bias is integrated once into tilt, tilt lets \
         gravity in, and that is integrated twice: g b t³/6. The cube starts lower and always wins.",
    );
    let mut chart = Chart::new("Two kinds of bias", Axis::log("time / s"), Axis::log("distance error / m"));
    let parts: [(&str, &Envelope, Ink); 2] =
        [("gyro's part, t³", &growth.cubic, Ink::Blue), ("accelerometer's part, t²", &growth.quadratic, Ink::Red)];
    for (name, e, ink) in parts {
        let twice: Vec<f64> = e.sd.iter().map(|s| 1.96 * s).collect();
        chart.add(name, ink, Mark::Line, e.curve(&e.sd));
        chart.add("", ink, Mark::Dashed, e.curve(&twice));
    }
    chart.add("19 of 20 stay below", Ink::Soft, Mark::Dashed, vec![]);
    let at = growth.crossing_s;
    let level = growth.cubic.time_s.iter().zip(&growth.cubic.sd).find(|(t, _)| **t >= at).map_or(1.0, |p| *p.1);
    chart.note((at * 1.15, level * 0.25), &format!("cross at {} s", significant(at, 2)));
    page.figure(
        &chart.draw(),
        "Standard deviation over 2000 simulated sensors whose accelerometer bias is drawn with 1 mg and whose gyro bias with \
         10 °/h, each with some white noise; both parts integrated by eq. 2, tilt entering as g times angle. Valid on a flat \
         Earth, for minutes; the Schuler oscillation is left out, as in the paper.",
    );
    checks(page, &growth.exhibits[2]);
}
