//! Power against size, and the detection limit of each effect.

use crate::interval::{Power, Proportion};
use crate::outcome::{Limit, Outcome, Planted};
use proofmass_numerics::numerics::order;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark};

/// Edges of the size bins, visible rms over noise rms.
const EDGES: [f64; 9] = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 40.0];

/// Fractions noticed and named against size, all effects planted alone taken together, with the
/// fitted curves.
pub fn power(outcome: &Outcome) -> Figure {
    let all: Vec<Planted> = outcome.detection_limit.iter().flat_map(|l| l.cases.iter().copied()).collect();
    let x = Axis::log("visible size of the effect / noise (rms)").within(EDGES[0], EDGES[EDGES.len() - 1]);
    let mut chart = Chart::new("Detection limit", x, Axis::linear("fraction of cases").within(0.0, 1.05));
    let noticed: Vec<(f64, bool)> = all.iter().map(|c| (c.size, c.noticed)).collect();
    let named: Vec<(f64, bool)> = all.iter().map(|c| (c.size, c.named)).collect();
    for (name, ink, pairs, beside) in [("detected", Ink::Blue, noticed, 0.95), ("named", Ink::Red, named, 1.05)] {
        if let Some(power) = Power::fit(&pairs) {
            let sizes = (0..=120).map(|k| EDGES[0] * (EDGES[8] / EDGES[0]).powf(f64::from(k) / 120.0));
            let (mut low, mut high, mut line) = (Vec::new(), Vec::new(), Vec::new());
            for size in sizes {
                let [below, above] = power.power_ci95(size);
                low.push((size, below));
                high.push(above);
                line.push((size, power.best.power_at(size)));
            }
            chart.add("", ink, Mark::Band(high), low);
            chart.add(name, ink, Mark::Line, line);
        }
        let (mut middles, mut lows, mut highs) = (Vec::new(), Vec::new(), Vec::new());
        for edge in EDGES.windows(2) {
            let proportion = Proportion::over(pairs.iter().filter(|c| (edge[0]..edge[1]).contains(&c.0)).map(|c| c.1));
            if proportion.cases > 0 {
                let at = (edge[0] * edge[1]).sqrt() * beside;
                middles.push((at, proportion.value));
                lows.push((at, proportion.ci95[0]));
                highs.push(proportion.ci95[1]);
            }
        }
        chart.add("", ink, Mark::Whiskers(highs), lows);
        chart.add("", ink, Mark::Dots(4), middles);
    }
    chart.add("nine of ten", Ink::Soft, Mark::Dashed, vec![(EDGES[0], 0.9), (EDGES[8], 0.9)]);
    chart.draw()
}

/// The size that is noticed in nine of ten recordings, per effect with its interval, smallest at
/// the bottom.
pub fn limits(outcome: &Outcome) -> Figure {
    let of = |l: &Limit| Some((format!("{} ({})", l.id, l.kind.name()), l.effect_over_noise?, l.ci95?));
    let mut found: Vec<(String, f64, [f64; 2])> = outcome.detection_limit.iter().filter_map(of).collect();
    order::sort_by_key(&mut found, |f| f.1);
    let names = found.iter().enumerate().map(|(n, f)| (n as f64 + 1.0, f.0.clone())).collect();
    let (least, most) = (0.003, 100.0);
    let x = Axis::log("size detected in 9 of 10 / noise (rms)").within(least, most);
    let y = Axis::linear("most visible lowest").named(names).within(0.0, found.len() as f64 + 1.0);
    let mut chart = Chart::new("Detection limit of each effect", x, y);
    let mut points = Vec::new();
    for (n, (_, limit, [low, high])) in found.iter().enumerate() {
        let rank = n as f64 + 1.0;
        chart.add("", Ink::Blue, Mark::Line, vec![(low.max(least), rank), (high.min(most), rank)]);
        points.push((*limit, rank));
    }
    chart.add("", Ink::Blue, Mark::Dots(4), points);
    chart.size = (560, 110 + 18 * found.len().max(4) as u32);
    chart.draw()
}
