//! Which series have a name, and which unnamed ones belong to them.

use super::chart::{Chart, Mark, Series};
use super::marks::kind;
use super::theme::Ink;

pub(super) struct Entry<'a> {
    pub(super) name: &'a str,
    /// Class of its swatch.
    pub(super) kind: &'static str,
    pub(super) ink: Ink,
    /// The band that its own band lies on, if any: what shines through in the plot shines through
    /// in the legend.
    pub(super) behind: Option<Ink>,
}

/// The named series of a chart, in order.
pub(super) struct Legend<'a> {
    pub(super) entries: Vec<Entry<'a>>,
}

impl<'a> Legend<'a> {
    pub(super) fn of(chart: &'a Chart) -> Self {
        let entry = |s: &'a Series| Entry {
            name: &s.name,
            kind: kind(&s.mark),
            ink: s.ink,
            behind: chart.series.iter().find(|b| encloses(b, s)).map(|b| b.ink),
        };
        Self { entries: chart.series.iter().filter(|s| !s.name.is_empty()).map(entry).collect() }
    }

    /// The entry of every series: its own, or that of the nearest named series of its colour.
    pub(super) fn groups(&self, chart: &Chart) -> Vec<Option<usize>> {
        let mut own = 0;
        let named: Vec<Option<usize>> = chart
            .series
            .iter()
            .map(|s| {
                (!s.name.is_empty()).then(|| {
                    own += 1;
                    own - 1
                })
            })
            .collect();
        let nearest = |k: usize| {
            let alike = (0..named.len()).filter(|j| named[*j].is_some() && chart.series[*j].ink == chart.series[k].ink);
            alike.min_by_key(|j| j.abs_diff(k)).and_then(|j| named[j])
        };
        (0..named.len()).map(|k| named[k].or_else(|| nearest(k))).collect()
    }
}

/// Returns whether a band lies wholly within another one.
fn encloses(outer: &Series, inner: &Series) -> bool {
    let (Mark::Band(outer_top), Mark::Band(inner_top)) = (&outer.mark, &inner.mark) else { return false };
    let inside = |n: usize| outer.points[n].1 <= inner.points[n].1 && inner_top[n] <= outer_top[n];
    outer != inner && outer_top.len() == inner_top.len() && (0..inner_top.len()).all(inside)
}
