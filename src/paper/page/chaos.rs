//! Figures 17 to 20 and the maps on the page.

use super::mechanics::three_figures;
use super::section::{checks, head, thin};
use crate::Paper;
use crate::attractor::{Attractor, View};
use crate::bifurcation::Bifurcation;
use crate::forcing::Scan;
use crate::linear::END_S;
use crate::parting::{NOISE_N_RTS, Parting};
use proofmass_base::number::{significant, with_uncertainty};
use proofmass_map::page as map;
use proofmass_physics::dynamics::duffing::PAPER;
use proofmass_physics::dynamics::estimate::Estimate;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark, Raster};
use proofmass_report::html::Page;

pub(super) fn write(page: &mut Page, paper: &Paper) {
    figure_17(page, &paper.attractor);
    figure_18(page, &paper.attractor);
    figure_19(page, &paper.attractor);
    if let Some(atlas) = &paper.atlas {
        page.section("The map: where chaos begins");
        page.paragraph(
            "One force and one frequency are one point. The maps show what surrounds it: every cell is a proof mass of its own, \
             started from rest. Noise does not destroy the pattern: it blurs its edges and closes the narrow windows.",
        );
        page.prefix(String::new());
        map::write(page, atlas);
    }
    figure_20(page, &paper.bifurcation, &paper.parting, &paper.attractor);
}

fn pair(e: Estimate) -> String {
    with_uncertainty(e.value, e.standard_error)
}

fn scan(title: &str, scan: &Scan) -> Figure {
    let most = |e: &Vec<f64>| e.last().copied().unwrap_or(f64::NAN);
    let any = scan.exponents.iter().map(|(f, e)| (*f, most(e))).collect();
    Chart::new(title, Axis::linear("amplitude of the force F₀ / N"), Axis::linear("largest exponent / (1/s)"))
        .with("first 600 periods, from rest", Ink::Sky, Mark::Dots(2), scan.early.clone())
        .with("after 1500 periods, largest of 8 starts", Ink::Red, Mark::Dots(2), any)
        .draw()
}

fn figure_17(page: &mut Page, attractor: &Attractor) {
    head(page, &attractor.exhibits[0]);
    let (radian, hertz) = (&attractor.radian, &attractor.hertz);
    let (fraction, fading) = hertz.early_and_fading();
    let newton = |v: Option<f64>| v.map_or("none".to_owned(), |v| format!("{} N", significant(v, 3)));
    page.paragraph(
        "Drive the same proof mass with a periodic force F₀ cos ωt, and for some F₀ its motion never repeats. \
        Neighbouring orbits diverge exponentially; the rate is the largest Lyapunov exponent, positive if and only if \
        the motion is chaotic.",
    );
    page.paragraph(&format!(
        "The paper gives D₀ = 0.1, k = 1, ε = 0.3 and \"f = 1.5 Hz\", but no F₀, and its frequency can be read in two ways. At \
         ω = 1.5 rad/s lasting chaos first appears in a narrow window at {}, on one of several coexisting orbits, and in a \
         band from {} on. At 1.5 Hz (9.42 rad/s) nothing below 60 N is chaotic; lasting chaos first appears at {}, and of the \
         {} % of forces up to 6000 N that look chaotic over the first 600 periods, {} % are only long transients that \
         end periodic. The figures here therefore read 1.5 rad/s, at F₀ = {} N: the most chaotic force at which every \
         start tried \
         ends on the same attractor.",
        newton(radian.first_n()),
        newton(radian.band_n()),
        newton(hertz.first_n()),
        significant(100.0 * fraction, 2),
        significant(100.0 * fading, 2),
        significant(attractor.drive.amplitude_n, 4),
    ));
    let orbit: Vec<(f64, f64)> = attractor.portrait.iter().map(|s| (s.x_m, s.v_m_s)).collect();
    let mut portrait = Chart::new("Phase portrait", Axis::linear("displacement / m"), Axis::linear("velocity / (m/s)"))
        .with("", Ink::Blue, Mark::Line, orbit);
    portrait.size = (640, 460);
    page.figure(
        &portrait.draw(),
        &format!(
            "Thirty periods of eq. 6 by Runge–Kutta after two hundred to settle, F₀ = {} N, ω = 1.5 rad/s. Largest Lyapunov \
             exponent {} 1/s from 512 independent orbits: two neighbours are e times farther apart every {} s.",
            significant(attractor.drive.amplitude_n, 4),
            pair(attractor.exponent),
            significant(1.0 / attractor.exponent.value, 2),
        ),
    );
    page.figure_row(&[
        (&scan("ω = 1.5 rad/s", radian), "Largest exponent along F₀, read as an angular frequency."),
        (
            &scan("ω = 2π·1.5 rad/s", hertz),
            "Read as printed, 1.5 Hz: blue dots above zero without an orange one are chaos that \
                   does not last.",
        ),
    ]);
    checks(page, &attractor.exhibits[0]);
}

fn cloud(title: &str, view: &View, inner: Option<&View>) -> Figure {
    let (x, y) = (view.window.x_m, view.window.v_m_s);
    let mut chart = Chart::new(
        title,
        Axis::linear("displacement / m").within(x.0, x.1),
        Axis::linear("velocity / (m/s)").within(y.0, y.1),
    );
    let points = view.cloud.iter().map(|p| (f64::from(p[0]), f64::from(p[1])));
    // Pixels so large that those hit make sheets, and no smaller than the screen's.
    let side = (3 * view.cloud.len().isqrt()).clamp(200, 800) as u32;
    chart.raster = Some(Raster::cloud(points, (side, side * 3 / 4), x, y));
    if let Some(inner) = inner {
        let (a, b) = (inner.window.x_m, inner.window.v_m_s);
        let frame = vec![(a.0, b.0), (a.1, b.0), (a.1, b.1), (a.0, b.1), (a.0, b.0)];
        chart.add("enlarged next", Ink::Black, Mark::Line, frame);
    }
    chart.size = (640, 500);
    chart.draw()
}

fn figure_18(page: &mut Page, attractor: &Attractor) {
    head(page, &attractor.exhibits[1]);
    page.paragraph(
        "Sample the motion once per period of the force. A periodic motion would give one dot or a few; this one \
        gives an infinitely folded curve, a strange attractor. How much of the plane it fills is its dimension, more \
        than a curve's 1 and \
         less than the plane's 2.",
    );
    page.figure(
        &cloud("Poincaré section", &attractor.views[0], Some(&attractor.views[1])),
        "100,000 strobes at the beginning of the force's period, from 512 orbits of eq. 6 in f32 lanes after 1500 periods.",
    );
    let dimension = |values: &[(f64, f64)], sign: f64| -> Vec<(f64, f64)> {
        let first = values.first().map_or(0.0, |v| v.1);
        values.iter().map(|v| (v.0, sign * (v.1 - first))).collect()
    };
    let chart = Chart::new(
        "Two dimensions as slopes",
        Axis::linear("−log₂ of the scale"),
        Axis::linear("log₂, from the first scale on"),
    )
    .with("boxes needed", Ink::Blue, Mark::Dots(4), dimension(&attractor.boxes.curve, 1.0))
    .with("pairs closer, inverse", Ink::Green, Mark::Dots(4), dimension(&attractor.views[0].correlation.curve, -1.0))
    .draw();
    page.figure(
        &chart,
        &format!(
            "Box-counting dimension {} (5.1 million strobes), correlation dimension {} (eight groups of 6000), Kaplan–Yorke \
             dimension 1 + λ₁/|λ₂| = {} from the exponents alone.",
            pair(attractor.boxes.estimate),
            pair(attractor.views[0].correlation.estimate),
            pair(attractor.kaplan_yorke),
        ),
    );
    checks(page, &attractor.exhibits[1]);
}

fn figure_19(page: &mut Page, attractor: &Attractor) {
    head(page, &attractor.exhibits[2]);
    page.paragraph(
        "A part, enlarged eight times, shows the same folded sheets; a part of the part, enlarged eight times again, \
        still does. To quantify this, the dimension of 48 parts at each scale is compared with the whole below.",
    );
    let [_, first, second] = &attractor.views;
    page.figure_row(&[
        (&cloud("Enlarged 8 times", first, Some(second)), "The frame of figure 18, up to 100,000 strobes inside it."),
        (
            &cloud("Enlarged 64 times", second, None),
            "The frame of the previous figure: strobes become sparse, sheets do not.",
        ),
    ]);
    page.paragraph(&format!(
        "Mean correlation dimension of parts: {} at 1/8, {} at 1/64 of the size; of the whole: {}.",
        pair(attractor.parts[0]),
        pair(attractor.parts[1]),
        pair(attractor.views[0].correlation.estimate)
    ));
    checks(page, &attractor.exhibits[2]);
}

fn figure_20(page: &mut Page, bifurcation: &Bifurcation, parting: &Parting, attractor: &Attractor) {
    head(page, &parting.exhibit);
    page.paragraph(
        "The rectangle of figure 13 once more, on the cubic spring of figure 16, while the periodic force of figure 17 acts: a \
         vehicle that accelerates for half a minute and vibrates meanwhile. The paper does not say how the two forces \
         combine; here they add.",
    );
    let [a, b, c] = three_figures(&PAPER, &bifurcation.path, END_S, (&|t| bifurcation.ideal(t), None));
    page.figure_row(&[
        (
            &a,
            "Reading kx/m. The stiff range of the spring turns a force of tens of newtons into a reading of a few \
        m/s², which \
              never repeats.",
        ),
        (&b, "Speed: the rectangle's ramp of 30 m/s is lost among the oscillations."),
        (&c, "Displacement: the error is huge after a few seconds, as the paper says."),
    ]);
    page.paragraph(&format!(
        "What does chaos do to sensors that are alike? Two hundred sensors start alike and differ only in a force noise of {} N·√s, \
         a hundred-millionth of the drive. On a linear spring they stay together; on the cubic one every Lyapunov time \
         multiplies their differences by e, until noise decides where they are.",
        significant(NOISE_N_RTS, 1),
    ));
    let paths = |title: &str, spread: &crate::parting::Spread| {
        let mut chart = Chart::new(title, Axis::linear("time / s"), Axis::linear("distance error / m"));
        for (i, member) in spread.distance_error_m.iter().take(6).enumerate() {
            let path: Vec<(f64, f64)> = spread.time_s.iter().copied().zip(member.iter().copied()).collect();
            chart.add("", Ink::nth(i), Mark::Line, thin(&path, 500));
        }
        chart.draw()
    };
    page.figure_row(&[
        (
            &paths("Cubic spring, six members", &parting.cubic),
            "Distance error (reading minus true force, integrated twice). At first all members have the same error; \
            then they diverge.",
        ),
        (
            &paths("Linear spring, the same", &parting.linear),
            "Under the same force and noise the six curves of the linear sensor \
                   lie on one another: wrong, but predictably wrong.",
        ),
    ]);
    let curve = |s: &crate::parting::Spread| -> Vec<(f64, f64)> {
        thin(&s.time_s.iter().copied().zip(s.sd_m.iter().copied()).skip(8).collect::<Vec<_>>(), 600)
    };
    let law: Vec<(f64, f64)> =
        parting.linear.time_s.iter().skip(8).map(|t| (*t, NOISE_N_RTS * t.powf(1.5) / 3f64.sqrt())).collect();
    let spread =
        Chart::new("Spread over 200 members", Axis::linear("time / s"), Axis::log("distance, standard deviation / m"))
            .with("cubic", Ink::Red, Mark::Line, curve(&parting.cubic))
            .with("linear", Ink::Blue, Mark::Line, curve(&parting.linear))
            .with("N√(t³/3)", Ink::Black, Mark::Dashed, thin(&law, 200))
            .draw();
    let apart: Vec<(f64, f64)> = parting.separation.iter().map(|p| (p.0, p.1.exp())).collect();
    let anchor = parting.separation.iter().find(|p| p.1 > -18.0).copied().unwrap_or((0.0, 0.0));
    let line = |t: f64| (t, (anchor.1 + attractor.exponent.value * (t - anchor.0)).exp());
    let end = anchor.0 + 16.0 / attractor.exponent.value;
    let separation = Chart::new("Diverging pairs", Axis::linear("time / s"), Axis::log("distance in the phase plane"))
        .with("128 pairs, geometric mean", Ink::Red, Mark::Line, thin(&apart, 800))
        .with("e^(λ₁t), λ₁ of figure 17", Ink::Black, Mark::Dashed, vec![line(anchor.0), line(end)])
        .draw();
    page.figure_row(&[
        (
            &spread,
            "Standard deviation of the distance over the ensemble. Linear: the law of integrated white noise. Cubic: \
                   exponential, then as fast as a random reading can take it.",
        ),
        (
            &separation,
            "Pairs with the same initial state that differ in an even smaller noise, from 128 points on the attractor.",
        ),
    ]);
    page.paragraph(&format!(
        "Pairs diverge at {} 1/s, the exponent is {} 1/s: the Lyapunov time is {} s. Noise a thousand times smaller \
        would gain only {} s.",
        pair(parting.rate),
        pair(attractor.exponent),
        significant(1.0 / attractor.exponent.value, 2),
        significant(1000f64.ln() / attractor.exponent.value, 2),
    ));
    checks(page, &parting.exhibit);
}
