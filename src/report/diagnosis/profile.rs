//! One figure: how the misfit rises around each named parameter of a driven recording, next to the
//! interval stated.

use proofmass_diagnosis::driven::identification::profile::{FALL, Profile};

use super::exhibit::{Exhibit, Part};
use crate::figure::{Axis, Chart, Ink, Mark};

/// Parameters that can be told apart in one figure.
const MOST: usize = 6;
/// Log-likelihood at which the axis ends.
const HIGHEST: f64 = 6.0;
/// The figure; `None` where nothing was named that has a profile.
pub(crate) fn exhibit(profiles: &[Profile]) -> Option<Exhibit> {
    if profiles.is_empty() {
        return None;
    }
    let mut chart = Chart::new(
        "Profile likelihood of the identified parameters",
        Axis::linear("distance from the stated value / half its 95 % interval").within(-2.0, 2.0),
        Axis::linear("log-likelihood lost").within(0.0, HIGHEST),
    );
    chart.add("95 % line", Ink::Soft, Mark::Dashed, vec![(-2.0, FALL), (2.0, FALL)]);
    let edge = |x: f64| vec![(x, 0.0), (x, HIGHEST)];
    chart.add("interval stated", Ink::Soft, Mark::Line, edge(-1.0));
    chart.add("", Ink::Soft, Mark::Line, edge(1.0));
    for (n, profile) in profiles.iter().take(MOST).enumerate() {
        let [low, high] = profile.ci95;
        let place = |v: f64| {
            let side = if v < profile.value { profile.value - low } else { high - profile.value };
            (v - profile.value) / side
        };
        let points = profile.points.iter().map(|(v, loss)| (place(*v), *loss)).filter(|p| p.1 <= HIGHEST);
        chart.add(&profile.label, Ink::nth(n), Mark::Line, points.collect());
    }
    chart.size = (620, 390);
    Some(Exhibit {
        part: Part::Identification,
        name: "how-sure".into(),
        figure: chart.draw(),
        caption: "Each identified parameter is held at other values while all others are refitted, with the \
                  recording simulated freely; the curve is the loss of likelihood. A curve that crosses the dashed \
                  line inside the two vertical lines means that the stated interval is conservative; outside, that \
                  it is too short."
            .into(),
    })
}
