//! Figures 13 to 16 on the page.

use super::section::{checks, head, thin};
use crate::Paper;
use crate::cubic::Cubic;
use crate::linear::{END_S, Linear, RECTANGLE, reading};
use proofmass_physics::dynamics::duffing::{Oscillator, PAPER};
use proofmass_physics::dynamics::linear::MassResponse;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark};
use proofmass_report::html::Page;

pub(super) fn write(page: &mut Page, paper: &Paper) {
    linear(page, &paper.linear);
    cubic(page, &paper.cubic);
}

type Path = [(f64, MassResponse)];
type Curve = Vec<(f64, f64)>;

/// Reading, speed and distance at a time.
type Ideal<'a> = &'a dyn Fn(f64) -> (f64, f64, f64);

/// Reading, speed and distance against the ideal ones, over part of the time.
pub(super) fn three_figures(
    oscillator: &Oscillator,
    path: &Path,
    until_s: f64,
    (ideal, dots): (Ideal<'_>, Option<&[(f64, f64)]>),
) -> [Figure; 3] {
    let part: Vec<&(f64, MassResponse)> = path.iter().filter(|p| p.0 <= until_s).collect();
    let pick = |value: &dyn Fn(f64, &MassResponse) -> f64| -> Curve {
        thin(&part.iter().map(|p| (p.0, value(p.0, &p.1))).collect::<Vec<_>>(), 4000)
    };
    let chart = |title: &str, label: &str, ink: Ink, real: Curve, true_one: Curve| {
        let mut chart = Chart::new(title, Axis::linear("time / s"), Axis::linear(label))
            .with("sensor", ink, Mark::Line, real)
            .with("ideal", Ink::Black, Mark::Dashed, true_one);
        chart.size = (470, 340);
        chart
    };
    let mut first = chart(
        "Reading",
        "acceleration / (m/s²)",
        Ink::Red,
        pick(&|_, m| reading(oscillator, m).0),
        pick(&|t, _| ideal(t).0),
    );
    if let Some(dots) = dots {
        let dots: Curve = dots.iter().copied().filter(|d| d.0 <= until_s).collect();
        first.add("Runge–Kutta", Ink::Blue, Mark::Dots(2), dots);
    }
    let second =
        chart("Speed", "speed / (m/s)", Ink::Blue, pick(&|_, m| reading(oscillator, m).1), pick(&|t, _| ideal(t).1));
    let third = chart(
        "Displacement",
        "displacement / m",
        Ink::Green,
        pick(&|_, m| reading(oscillator, m).2),
        pick(&|t, _| ideal(t).2),
    );
    [first.draw(), second.draw(), third.draw()]
}

fn linear(page: &mut Page, linear: &Linear) {
    let [exhibit_13, exhibit_14, exhibit_15] = &linear.exhibits;
    let oscillator = PAPER.linear();
    let ideal = |t| RECTANGLE.ideal(t);
    head(page, exhibit_13);
    page.paragraph(
        "Now a sensor without any noise. Inside it a proof mass hangs on a spring: eq. 4, m x″ + D₀x′ + kx = F₀. The reading is \
         not the force but the spring's answer, kx. A step of force makes the mass swing before it settles.",
    );
    page.paragraph(
        "Eq. 5 of the paper is meant to be the solution, but as printed everything stands under one root, and it does \
        not satisfy eq. 4. The correct form is x(t) = F₀/k + c₁e^(r₁t) + c₂e^(r₂t) with r = (−D₀ ± √(D₀² − 4km))/2m, \
        and rest \
         at t = 0 fixes c₁ = r₂F₀/(k(r₁ − r₂)) and c₂ = −r₁F₀/(k(r₁ − r₂)). The residual of both is shown.",
    );
    let [a, b, c] = three_figures(&oscillator, &linear.exact, END_S, (&ideal, None));
    page.figure_row(&[
        (&a, "Reading kx/m, from the exact solution of eq. 4 with m = 1, D₀ = 0.1, k = 1 (the paper's values for its chaotic \
              case; it prints none here) under 1 m/s² for 30 s."),
        (&b, "Its integral: the speed, next to the ideal one."),
    ]);
    let residual =
        |pick: fn(&(f64, f64, f64)) -> f64| -> Curve { linear.residuals.iter().map(|r| (r.0, pick(r))).collect() };
    let chart = Chart::new("Eq. 5 put into eq. 4", Axis::linear("time / s"), Axis::linear("m x″ + D₀x′ + kx − F₀ / N"))
        .with("as printed", Ink::Red, Mark::Line, residual(|r| r.1))
        .with("with the correct roots", Ink::Green, Mark::Line, residual(|r| r.2))
        .draw();
    page.figure_row(&[
        (&c, "Its double integral: the distance. At this scale all seems well."),
        (
            &chart,
            "Residual of eq. 5 in eq. 4 under a step of 1 N. As printed (with m = 1) it is an undamped \
        oscillation, so that D₀x′ remains: up to a tenth of the force, indefinitely. With the correct roots the \
        residual is zero.",
        ),
    ]);
    checks(page, exhibit_13);

    head(page, exhibit_14);
    let [a, b, c] = three_figures(&oscillator, &linear.exact, 10.0, (&ideal, Some(&linear.runge_kutta)));
    page.figure_row(&[
        (&a, "The first ten seconds of figure 13: the reading overshoots by 85 % and rings at the proof mass's own frequency. \
              Dots: Runge–Kutta with steps of a quarter second."),
        (&b, "The speed lags: on average by D₀/k = 0.1 s of the true one."),
    ]);
    page.figure(&c, "So does the distance, by an increasing amount.");
    checks(page, exhibit_14);

    head(page, exhibit_15);
    page.paragraph(
        "At low frequency the sensor's transfer function is 1 − (D₀/k)s + …: a delay by the time constant D₀/k. The distance is \
         late by that time at the speed reached. No filter, no averaging and no better electronics removes it, only a stiffer \
         or less damped mass.",
    );
    let error: Curve =
        linear.exact.iter().map(|(t, m)| (*t, reading(&oscillator, m).2 - RECTANGLE.ideal(*t).2)).collect();
    // While the force lasts the next term of the transfer function adds −(1 − 4ζ²)/ω₀² times the
    // reading.
    let law = vec![(0.0, 0.0), (1.0, 0.0), (1.0, -0.99), (31.0, -3.99), (31.0, -3.0), (END_S, -3.0)];
    let over_time =
        Chart::new("Distance error over time", Axis::linear("time / s"), Axis::linear("distance error / m"))
            .with("sensor minus ideal", Ink::Green, Mark::Line, thin(&error, 900))
            .with("−(D₀/k) speed − (1 − 4ζ²) reading/ω₀²", Ink::Black, Mark::Dashed, law)
            .draw();
    let constant = Chart::new(
        "Final distance error against time constant",
        Axis::linear("time constant D₀/k / s"),
        Axis::linear("distance error / m"),
    )
    .with("sixteen sensors", Ink::Green, Mark::Dots(3), linear.error_by_time_constant.clone())
    .with("−(D₀/k) a T", Ink::Black, Mark::Dashed, vec![(0.0, 0.0), (1.6, -48.0)])
    .draw();
    page.figure_row(&[
        (
            &over_time,
            "The difference of both curves of figure 13's distance: three metres after half a minute, with \
        the oscillations on top.",
        ),
        (
            &constant,
            "The error that remains long after the rectangle, for dampings from 0.1 to 1.6 kg/s, from the \
        exact solution.",
        ),
    ]);
    checks(page, exhibit_15);
}

fn cubic(page: &mut Page, cubic: &Cubic) {
    head(page, &cubic.exhibit);
    page.paragraph(
        "A real spring stiffens: eq. 6 adds εx³, the Duffing equation. Under the same rectangle the mass settles where kx + εx³ \
         = F₀, at 0.83 m instead of 1 m, and the reading kx is short by 17 % for as long as the force lasts.",
    );
    let [a, b, c] = three_figures(&PAPER, &cubic.cubic, END_S, (&|t| RECTANGLE.ideal(t), None));
    page.figure_row(&[
        (
            &a,
            "Reading of the cubic sensor (ε = 0.3) by Runge–Kutta with steps of 10 ms. The oscillations are faster \
        and no longer sinusoidal.",
        ),
        (&b, "Speed: too slow by a fifth, more than the 17 %, because the oscillations are asymmetric."),
    ]);
    let error = |path: &Path| -> Curve {
        thin(&path.iter().map(|(t, m)| (*t, reading(&PAPER, m).2 - RECTANGLE.ideal(*t).2)).collect::<Vec<_>>(), 700)
    };
    let errors = Chart::new("Distance error", Axis::linear("time / s"), Axis::linear("distance error / m"))
        .with("cubic spring", Ink::Red, Mark::Line, error(&cubic.cubic))
        .with("linear spring", Ink::Green, Mark::Line, error(&cubic.linear));
    page.figure_row(&[
        (&c, "Distance, next to the ideal one."),
        (
            &errors.draw(),
            "Both distance errors: hundreds of metres, where the linear sensor of figure 15 was off by three.",
        ),
    ]);
    checks(page, &cubic.exhibit);
}
