//! The map as figures and a page: exponent, period, bifurcation diagrams with both sweeps.

use crate::document::{Document, Quantity};
use crate::grid::Grid;
use crate::{Atlas, Bifurcation};
use proofmass_base::number::significant;
use proofmass_numerics::numerics::order;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark, Raster};
use proofmass_report::html::Page;
use proofmass_report::table::Table;

/// A line per map and diagram.
pub fn table(atlas: &Atlas) -> Table {
    let mut table =
        Table::new(&["what", "cells", "chaotic", "largest exponent / (1/s)", "steps per period", "hysteresis"]);
    for g in &atlas.grids {
        let largest = g.exponent_per_s.iter().copied().filter(|e| e.is_finite()).fold(f64::NAN, f64::max);
        let lost = match g.lost() {
            0 => String::new(),
            lost => format!(", {lost} lost"),
        };
        table.row([
            g.map.title.clone(),
            format!("{}{lost}", g.exponent_per_s.len()),
            format!("{} %", significant(100.0 * g.chaotic_share(), 2)),
            significant(largest, 3),
            format!("{} to {}", g.steps.0, g.steps.1),
        ]);
    }
    for b in &atlas.diagrams {
        let apart = b.hysteresis_n().len();
        table.row([
            format!("bifurcation, {}", b.diagram.title),
            b.diagram.points.to_string(),
            String::new(),
            String::new(),
            String::new(),
            apart.to_string(),
        ]);
    }
    table
}

fn mark(atlas: &Atlas, quantity: Quantity) -> f64 {
    let (oscillator, drive) = (&atlas.document.oscillator, &atlas.document.drive);
    match quantity {
        Quantity::AmplitudeN => drive.amplitude_n,
        Quantity::OmegaRadS => drive.omega_rad_s(),
        Quantity::FrequencyHz => drive.omega_rad_s() / (2.0 * std::f64::consts::PI),
        Quantity::CubicNM3 => oscillator.cubic_n_m3,
        Quantity::DampingKgS => oscillator.damping_kg_s,
        Quantity::StiffnessNM => oscillator.stiffness_n_m,
    }
}

/// A heat map over a grid with the document's point marked.
fn heat(atlas: &Atlas, grid: &Grid, title: &str, values: &[f64], limits: (f64, f64), label: &str) -> Figure {
    let (x, y) = (&grid.map.x, &grid.map.y);
    let mut chart = Chart::new(
        title,
        Axis::linear(x.quantity.label()).within(x.from, x.to),
        Axis::linear(y.quantity.label()).within(y.from, y.to),
    );
    chart.raster = Some(Raster::heat_map(values, x.points as usize, (x.from, x.to), (y.from, y.to), limits, label));
    let at = (mark(atlas, x.quantity), mark(atlas, y.quantity));
    if grid.cell(at.0, at.1).is_some() {
        let (w, h) = (0.02 * (x.to - x.from), 0.025 * (y.to - y.from));
        chart.add("the point plotted", Ink::Orange, Mark::Line, vec![(at.0 - w, at.1), (at.0 + w, at.1)]);
        chart.add("", Ink::Orange, Mark::Line, vec![(at.0, at.1 - h), (at.0, at.1 + h)]);
    }
    chart.draw()
}

/// Exponent and period of one grid.
pub(crate) fn grid(atlas: &Atlas, grid: &Grid) -> [Figure; 2] {
    let mut sorted: Vec<f64> = grid.exponent_per_s.iter().copied().filter(|e| e.is_finite()).collect();
    order::sort(&mut sorted);
    // All but a few cells at either end, so that single ones do not take the ramp.
    let high = sorted.get(sorted.len() * 999 / 1000).copied().unwrap_or(1.0).max(0.02);
    let low = sorted.get(sorted.len() / 50).copied().unwrap_or(-1.0).min(-0.25 * high);
    let exponent = heat(atlas, grid, &grid.map.title, &grid.exponent_per_s, (low, high), "largest exponent / (1/s)");
    let period: Vec<f64> = grid.period.iter().map(|p| if *p == 0 { f64::NAN } else { f64::from(*p).log2() }).collect();
    let period = heat(atlas, grid, "Period (blank: none up to 16)", &period, (0.0, 4.0), "log₂ of the period");
    [exponent, period]
}

/// Strobed displacement against the force, up and down.
pub(crate) fn diagram(b: &Bifurcation) -> [Figure; 2] {
    let cloud = |points: &[(f64, f64)], way: &str| {
        let (low, high) =
            b.up.iter().chain(&b.down).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.1), h.max(p.1)));
        let (x, y) = ((b.diagram.from_n, b.diagram.to_n), (low, high));
        let mut chart = Chart::new(
            &format!("{}, {way}", b.diagram.title),
            Axis::linear("amplitude of the force F₀ / N").within(x.0, x.1),
            Axis::linear("displacement at the strobe / m").within(y.0, y.1),
        );
        // A pixel of the picture for one on the screen: finer ones would fade where sixty strobes
        // fall on one.
        chart.raster = Some(Raster::cloud(points.iter().copied(), (480, 320), x, y));
        chart.draw()
    };
    [cloud(&b.up, "force rising"), cloud(&b.down, "force falling")]
}

/// File names of the figures, a pair for each map and then for each diagram.
pub fn file_names(document: &Document) -> Vec<[String; 2]> {
    let names = |what: &'static str, count: usize, pair: [&'static str; 2]| {
        (1..=count).map(move |n| pair.map(|which| format!("{what}-{n}-{which}.svg")))
    };
    let maps = names("map", document.map.len(), ["exponent", "period"]);
    maps.chain(names("bifurcation", document.bifurcation.len(), ["up", "down"])).collect()
}

/// Every figure with its file name.
pub fn figures(atlas: &Atlas) -> Vec<(String, Figure)> {
    let figures = atlas.grids.iter().map(|g| grid(atlas, g)).chain(atlas.diagrams.iter().map(diagram));
    file_names(&atlas.document).into_iter().zip(figures).flat_map(|(names, pair)| names.into_iter().zip(pair)).collect()
}

/// Writes maps and diagrams onto a page.
pub fn write(page: &mut Page, atlas: &Atlas) {
    let mut names = file_names(&atlas.document).into_iter();
    let mut named = |figures: [Figure; 2]| {
        let names = names.next().unwrap_or_default();
        let [first, second] = figures;
        [first.named(names[0].trim_end_matches(".svg")), second.named(names[1].trim_end_matches(".svg"))]
    };
    for g in &atlas.grids {
        page.subsection(&g.map.title);
        let [exponent, period] = named(grid(atlas, g));
        let noise = if g.map.noise_n_rts > 0.0 {
            format!(" White force noise of {} N·√s acts throughout.", significant(g.map.noise_n_rts, 2))
        } else {
            String::new()
        };
        let first = format!(
            "Largest Lyapunov exponent of the Duffing equation, each cell from rest, averaged over {} periods after \
            {}; {} to {} \
             Runge–Kutta steps a period in f32. Below zero the motion is periodic, above it neighbouring orbits \
             diverge: {} % of the cells are chaotic.{noise}",
            g.map.periods,
            g.map.transient_periods,
            g.steps.0,
            g.steps.1,
            significant(100.0 * g.chaotic_share(), 2),
        );
        let second = "Smallest number of forcing periods after which the strobed orbit repeats.";
        if g.map.noise_n_rts > 0.0 {
            // Nothing repeats under noise.
            page.figure(&exponent, &first);
        } else {
            page.figure_row(&[(&exponent, &first), (&period, second)]);
        }
    }
    for b in &atlas.diagrams {
        page.subsection(&format!("Bifurcation diagram: {}", b.diagram.title));
        let [up, down] = named(diagram(b));
        let apart = b.hysteresis_n();
        let words = match (apart.first(), apart.last()) {
            (Some(first), Some(last)) => format!(
                "Force falling. At {} of {} amplitudes between {} and {} N the means of the two sweeps lie more than {} m \
                 apart (a twentieth of the range): coexisting attractors (hysteresis), or windows where the sampled chaos differs.",
                apart.len(),
                b.diagram.points,
                significant(*first, 3),
                significant(*last, 3),
                significant(b.apart_m(), 2)
            ),
            _ => "Force falling: everywhere the same as with the force rising.".into(),
        };
        let rising = format!(
            "Force rising: {} strobes at each of {} amplitudes, the state carried from one to the next.",
            b.diagram.strobes, b.diagram.points
        );
        page.figure_row(&[(&up, &rising), (&down, &words)]);
    }
}
