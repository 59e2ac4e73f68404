//! Which ticks of an axis are labelled, on a wide page and on a phone, so that no two labels touch.

use super::axis::{Scale, Span};

/// Plots are at least this wide on a desktop (two in a row) and on a phone, px.
const WIDE_PX: f64 = 380.0;
pub(super) const NARROW_PX: f64 = 230.0;
/// Mean advance of the usual sans-serif faces at 12 px, and the air between two labels, px.
pub(super) const ADVANCE_PX: f64 = 6.8;
const AIR_PX: f64 = 12.0;

/// A tick and whether it is labelled.
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
    /// On a page of usual width.
    pub(super) wide: bool,
    pub(super) narrow: bool,
}

/// Ticks of a horizontal axis.
pub(super) fn horizontal(span: &Span) -> Vec<Tick> {
    let values = span.ticks();
    let labels: Vec<String> = values.iter().map(|v| span.tick_label(*v)).collect();
    let wide = labelled(span, &values, &labels, WIDE_PX, &[]);
    let narrow = labelled(span, &values, &labels, NARROW_PX, &wide);
    let ticks = values.into_iter().zip(labels).enumerate();
    ticks.map(|(k, (value, label))| Tick { value, label, wide: wide[k], narrow: narrow[k] }).collect()
}

/// Which labels fit on an axis of this many pixels; only those among `among`, where it is given.
fn labelled(span: &Span, values: &[f64], labels: &[String], px: f64, among: &[bool]) -> Vec<bool> {
    let at = |k: usize| px * span.fraction(values[k]);
    let reach = |k: usize| 0.5 * (ADVANCE_PX * labels[k].chars().count() as f64 + AIR_PX);
    let touch = |a: usize, b: usize| (at(a) - at(b)).abs() < reach(a) + reach(b);
    let mut shown = vec![false; values.len()];
    match span.scale {
        // Evenly: every tick, every second from zero, every fourth …
        Scale::Linear => {
            let step = values.get(1).map_or(1.0, |second| second - values[0]);
            let every = |n: i64| {
                let chosen = |k: &usize| ((values[*k] / step).round() as i64).rem_euclid(n) == 0;
                (0..values.len()).filter(chosen).collect::<Vec<usize>>()
            };
            let fits = |chosen: &Vec<usize>| chosen.windows(2).all(|w| !touch(w[0], w[1]));
            let chosen = [1, 2, 4, 8, 16].into_iter().map(every).find(fits).unwrap_or_default();
            // A single label says no scale: rather the two ends, which lie far apart.
            let chosen = if chosen.len() < 2 && values.len() > 1 { vec![0, values.len() - 1] } else { chosen };
            chosen.into_iter().for_each(|k| shown[k] = true);
        }
        // Powers of ten first, then what finds room between them.
        Scale::Log => {
            let round = |k: &usize| (values[*k].log10() - values[*k].log10().round()).abs() < 1e-9;
            let (first, then): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(round);
            for k in first.into_iter().chain(then) {
                let free = (0..values.len()).all(|other| !shown[other] || !touch(k, other));
                shown[k] = free && among.get(k).is_none_or(|allowed| *allowed);
            }
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_that_are_shown_do_not_touch_and_two_always_stay() {
        for (scale, low, high) in [
            (Scale::Linear, 0.0, 60.0),
            (Scale::Linear, -0.00123, 0.0057),
            (Scale::Linear, 0.0, 1_000_000.0),
            (Scale::Log, 1e-9, 1e7),
            (Scale::Log, 0.02, 0.4),
            (Scale::Log, 1.0, 60.0),
        ] {
            let span = Span { scale, low, high };
            let ticks = horizontal(&span);
            type Shown = fn(&Tick) -> bool;
            for (px, shown) in [(WIDE_PX, (|t| t.wide) as Shown), (NARROW_PX, |t| t.narrow)] {
                let shown: Vec<&Tick> = ticks.iter().filter(|t| shown(t)).collect();
                assert!(shown.len() >= 2, "{low} to {high} on {px} px");
                for pair in shown.windows(2) {
                    let apart = px * (span.fraction(pair[1].value) - span.fraction(pair[0].value));
                    let needs = pair.iter().map(|t| t.label.chars().count() as f64 * ADVANCE_PX / 2.0).sum::<f64>();
                    assert!(apart > needs, "{} and {} on {px} px", pair[0].label, pair[1].label);
                }
            }
        }
    }
}
