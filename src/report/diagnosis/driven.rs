//! Figures of a diagnosis: input and output of one proof mass, or its free ring-down.
//!
//! The opening shows the stretch of held-out samples where base and repaired model differ most;
//! then the whole stretch, the error in frequency, over the state (the restoring force that is
//! missing) and in time, and the candidates' standing.

use proofmass_diagnosis::driven::Detail;
use proofmass_diagnosis::driven::verdict::surface::Surface;
use proofmass_diagnosis::standing::Gain;
use proofmass_numerics::numerics::moments::rms;
use proofmass_numerics::numerics::order;
use proofmass_numerics::numerics::spectrum;

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark, Raster, labelled};

/// Points that a line needs at most.
const POINTS: usize = 1500;

/// Its figures; one of them is the opening.
pub(crate) fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    let mut all = vec![zoom(detail), zoomed_errors(detail), errors(detail), spectra(detail), states(detail)];
    all.extend(surfaces(detail));
    if detail.candidates.iter().any(|(_, gain, _)| matches!(gain, Gain::HeldOut { .. })) {
        all.push(candidates(detail));
    }
    all.extend(super::form::exhibits(&detail.forms));
    all.extend(super::profile::exhibit(&detail.profiles));
    all
}

fn zoom(detail: &Detail) -> Exhibit {
    let s = &detail.shown;
    let held = |k: usize| s.held_out.iter().any(|r| r.contains(&(s.from + k)));
    let place = |k: usize, value: f64| ((s.from + k) as f64 / detail.rate_hz, value);
    let points = |values: &[f64]| values.iter().enumerate().map(|(k, v)| place(k, *v)).collect::<Vec<_>>();
    let dots = |wanted: bool| {
        let all = s.reading.iter().enumerate().filter(|(k, _)| held(*k) == wanted);
        all.map(|(k, v)| place(k, *v)).collect::<Vec<_>>()
    };
    let mut chart = Chart::new(
        "Recording and models where they differ most",
        Axis::linear("time / s"),
        Axis::linear(&labelled(&detail.output, &detail.unit)),
    );
    let size = if s.reading.len() > 250 { 2 } else { 3 };
    for (name, ink, wanted) in [("recorded, held out", Ink::Blue, true), ("recorded, fitted", Ink::Soft, false)] {
        let dots = dots(wanted);
        if !dots.is_empty() {
            chart.add(name, ink, Mark::Dots(size), dots);
        }
    }
    chart.add("base model", Ink::Black, Mark::Dashed, points(&s.base));
    if detail.named {
        chart.add("repaired model", Ink::Red, Mark::Line, points(&s.repaired));
    }
    chart.size = (620, 400);
    Exhibit {
        part: Part::Opening,
        name: "held-out-zoom".into(),
        figure: chart.draw(),
        caption: if detail.named {
            "Free simulation: no reading corrects either model. Where the dashed line departs from the dots, \
             physics is missing; the orange line includes it."
                .into()
        } else {
            "Free simulation: no reading corrects the model. No effect was identified, so only the base model is \
             drawn."
                .into()
        },
    }
}

/// What the base model does and, where something is named, the repaired one.
fn both(chart: &mut Chart, detail: &Detail, names: [&str; 2], points: [Vec<(f64, f64)>; 2]) {
    let [base, repaired] = points;
    chart.add(names[0], Ink::Soft, Mark::Line, base);
    if detail.named {
        chart.add(names[1], Ink::Red, Mark::Line, repaired);
    }
}

/// What either model gets wrong on the samples of the zoom.
fn zoomed_errors(detail: &Detail) -> Exhibit {
    let s = &detail.shown;
    let errors = |model: &[f64]| -> Vec<(f64, f64)> {
        let rows = s.reading.iter().zip(model).enumerate();
        rows.map(|(k, (y, m))| ((s.from + k) as f64 / detail.rate_hz, y - m)).collect()
    };
    let mut chart = Chart::new(
        "Error there",
        Axis::linear("time / s"),
        Axis::linear(&labelled("recorded − simulated", &detail.unit)),
    );
    both(&mut chart, detail, ["base model", "repaired model"], [&s.base, &s.repaired].map(|m| errors(m)));
    chart.size = (620, 400);
    Exhibit {
        part: Part::Opening,
        name: "held-out-error".into(),
        figure: chart.draw(),
        caption: "The same samples, recording minus simulation: the residual should look like noise.".into(),
    }
}

/// Block-wise root mean squares.
fn levels(values: &[f64], rate_hz: f64, from: usize) -> Vec<(f64, f64)> {
    let block = (values.len() / 200).max(1);
    values
        .chunks(block)
        .enumerate()
        .map(|(i, c)| {
            let level = rms(c.iter().copied());
            ((from + i * block + block / 2) as f64 / rate_hz, level)
        })
        .collect()
}

fn errors(detail: &Detail) -> Exhibit {
    let mut chart = Chart::new(
        "Error of free simulation over time",
        Axis::linear("time / s"),
        Axis::log(&labelled("root mean square", &detail.unit)),
    );
    let levels = |values: &Vec<f64>| levels(values, detail.rate_hz, detail.from);
    both(&mut chart, detail, ["base model", "repaired model"], [&detail.before, &detail.after].map(levels));
    chart.add("one step ahead", Ink::Blue, Mark::Line, levels(&detail.innovations));
    Exhibit {
        part: Part::Isolation,
        name: "error-over-time".into(),
        figure: chart.draw(),
        caption: "Root-mean-square error in short blocks of the fitted data. The one-step error is the error when \
                  each reading may correct the next prediction."
            .into(),
    }
}

fn spectra(detail: &Detail) -> Exhibit {
    let segment = (detail.before.len() / 8).clamp(64, 2048);
    let lines = |values: &[f64]| -> Vec<(f64, f64)> {
        let d = spectrum::welch(values, detail.rate_hz, segment);
        let step = d.frequency_hz.len().div_ceil(POINTS).max(1);
        d.frequency_hz.iter().zip(&d.density).step_by(step).map(|(f, d)| (*f, d.sqrt())).collect()
    };
    let mut chart = Chart::new(
        "Error over frequency",
        Axis::log("frequency / Hz"),
        Axis::log(&labelled("one-sided density", &format!("{}/√Hz", detail.unit))),
    )
    .with("displacement", Ink::Blue, Mark::Line, lines(&detail.state));
    let names = ["error of the base model", "error of the repaired model"];
    both(&mut chart, detail, names, [&detail.before, &detail.after].map(|e| lines(e)));
    Exhibit {
        part: Part::Isolation,
        name: "error-over-frequency".into(),
        figure: chart.draw(),
        caption: "Residual by frequency. An error shaped like the resonance entered before the proof mass; a flat \
                  one entered at the readout."
            .into(),
    }
}

fn states(detail: &Detail) -> Exhibit {
    let order = order::ranked(&detail.state[..detail.state.len().min(detail.before.len())]);
    let cells = 40.min(order.len().max(1));
    let profile = |errors: &[f64]| -> Vec<(f64, f64)> {
        (0..cells)
            .map(|i| &order[order.len() * i / cells..order.len() * (i + 1) / cells])
            .filter(|part| !part.is_empty())
            .map(|part| {
                let n = part.len() as f64;
                let x = part.iter().map(|k| detail.state[*k]).sum::<f64>() / n;
                let power = part.iter().map(|k| errors[*k].powi(2)).sum::<f64>() / n;
                (x, power.sqrt())
            })
            .collect()
    };
    let mut chart = Chart::new(
        "Error over displacement",
        Axis::linear(&labelled("displacement", &detail.unit)),
        Axis::log(&labelled("root mean square", &detail.unit)),
    );
    both(&mut chart, detail, ["base model", "repaired model"], [&detail.before, &detail.after].map(|e| profile(e)));
    Exhibit {
        part: Part::Isolation,
        name: "error-over-state".into(),
        figure: chart.draw(),
        caption: "Size of the residual by displacement, in bins of equal sample count. A clipping readout or an end \
                  stop shows only at the ends; noise is the same everywhere."
            .into(),
    }
}

/// The missing force over displacement and velocity, before and after, in the same colours.
fn surfaces(detail: &Detail) -> Vec<Exhibit> {
    let [before, after] = &detail.surfaces;
    let forces = || before.cells.iter().filter(|c| c.force.is_finite());
    let most = forces().map(|c| c.force.abs()).fold(0.0, f64::max);
    if most == 0.0 {
        return Vec::new();
    }
    let draw = |surface: &Surface, name: &str, title: &str| {
        let values: Vec<f64> = surface.cells.iter().map(|c| c.force).collect();
        let label = format!("missing force over ω₀² / {}", detail.unit);
        let mut raster = Raster::heat_map(&values, surface.side, surface.x, surface.v, (-most, most), &label);
        // Cells that noise alone may make stand back. Pixels go from the top, cells from the
        // bottom.
        for (i, cell) in surface.cells.iter().enumerate() {
            let pixel = (surface.side - 1 - i / surface.side) * surface.side + i % surface.side;
            if !cell.found && cell.force.is_finite() {
                raster.pixels[4 * pixel + 3] = 70;
            }
        }
        let mut chart = Chart::new(
            title,
            Axis::linear(&labelled("displacement", &detail.unit)).within(surface.x.0, surface.x.1),
            Axis::linear(&labelled("velocity", &format!("{}/s", detail.unit))).within(surface.v.0, surface.v.1),
        );
        chart.raster = Some(raster);
        let (found, judged) = surface.found();
        Exhibit {
            part: Part::Isolation,
            name: name.into(),
            figure: chart.draw(),
            caption: format!(
                "Mean force missing from the model at each displacement and velocity. Full colour: significant \
                 ({found} of {judged} cells, false discovery rate 5 %); pale: may be noise; empty: rarely visited. \
                 Vertical bands indicate a spring, horizontal ones a damper."
            ),
        }
    };
    let mut all = vec![draw(before, "missing-force-before", "Force that the base model lacks")];
    if detail.named && !after.cells.is_empty() {
        all.push(draw(after, "missing-force-after", "Force that the repaired model lacks"));
    }
    all
}

fn candidates(detail: &Detail) -> Exhibit {
    // What was screened out by a linear step has no held-out gain, and noise no error that it removes.
    let held_out = detail.candidates.iter().filter(|(_, gain, _)| matches!(gain, Gain::HeldOut { .. }));
    let shown: Vec<_> = held_out.take(12).collect();
    let place = |i: usize| (shown.len() - i) as f64;
    let clip = |v: f64| v.clamp(-0.2, 1.0);
    let names = shown.iter().enumerate().map(|(i, (id, ..))| (place(i), id.to_string())).collect();
    let mut chart = Chart::new(
        "Fraction of the held-out error above the noise that each candidate removes",
        Axis::linear("gain on validation samples").within(-0.22, 1.02),
        Axis::linear("best first").named(names).within(0.3, shown.len() as f64 + 0.7),
    );
    for (ink, named, words) in [(Ink::Red, true, "named"), (Ink::Soft, false, "not named")] {
        let dots: Vec<(f64, f64)> = shown
            .iter()
            .enumerate()
            .filter(|(_, c)| c.2 == named)
            .map(|(i, c)| (clip(c.1.value()), place(i)))
            .collect();
        if !dots.is_empty() {
            chart.add(words, ink, Mark::Dots(5), dots);
        }
    }
    for (i, (_, gain, named)) in shown.iter().enumerate() {
        if let Some([low, high]) = gain.ci95() {
            let ink = if *named { Ink::Red } else { Ink::Soft };
            chart.add("", ink, Mark::Line, vec![(clip(low), place(i)), (clip(high), place(i))]);
        }
    }
    chart.size = (720, 110 + 24 * shown.len().max(4) as u32);
    Exhibit {
        part: Part::Identification,
        name: "candidates".into(),
        figure: chart.draw(),
        caption: "Identified effects: gain when added to the others; all other candidates: gain alone on the base \
                  model. 95 % intervals from the scatter between blocks. A high bar alone does not identify an \
                  effect: the residual must also be unpredictable, and no rival may do as well."
            .into(),
    }
}
