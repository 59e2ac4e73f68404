//! A channel's Allan curve with its fitted terms, and its spectrum.

use super::words;
use crate::figure::{Axis, Chart, Ink, Mark, labelled};
use proofmass_base::number::significant;
use proofmass_numerics::numerics::moments::mean;
use proofmass_recording::noise::{Channel, Deviation, Noise};
use proofmass_recording::unit::Quantity;

pub(super) const TOGETHER: &str =
    "Overlapping Allan deviation of each axis. Filled dots: its value at 1 s and its minimum.";

/// The curves of the gyros and of the accelerometers, each on one plot; a channel alone has its
/// own.
pub(super) fn together(noise: &Noise) -> Vec<Chart> {
    let of = |(quantity, name): (Quantity, &str)| {
        let channels: Vec<&Channel> =
            noise.channels.iter().filter(|c| c.unit.quantity == quantity && !c.curve.is_empty()).collect();
        let (unit, _) = channels.first().filter(|_| channels.len() > 1)?.unit.signal();
        let mut chart = Chart::new(
            &format!("Allan deviation of the {name}s"),
            Axis::log("averaging time τ / s"),
            Axis::log(&labelled("Allan deviation", unit)),
        );
        for (n, channel) in channels.iter().enumerate() {
            let (_, factor) = channel.unit.signal();
            let point = |d: &Deviation| (d.tau_s, d.value * factor);
            let ink = Ink::nth(n);
            chart.add(&channel.name, ink, Mark::Line, channel.curve.iter().map(point).collect());
            let marks: Vec<_> = channel.at_one_second().iter().chain(&channel.minimum).map(point).collect();
            if !marks.is_empty() {
                chart.add("", ink, Mark::Dots(5), marks);
            }
        }
        Some(chart)
    };
    [(Quantity::Gyro, "gyro"), (Quantity::Accelerometer, "accelerometer")].into_iter().filter_map(of).collect()
}

pub(super) fn curve(channel: &Channel) -> Chart {
    let (unit, factor) = channel.unit.signal();
    let points = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        channel.curve.iter().enumerate().map(|(i, d)| (d.tau_s, value(i) * factor)).collect()
    };
    // A deviation of exactly 0, of readings that repeat, has no place on a logarithmic axis.
    let values = channel.curve.iter().map(|d| d.value * factor).filter(|v| *v > 0.0);
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    let mut chart = Chart::new(
        &format!("Allan deviation of {}", channel.name),
        Axis::log("averaging time τ / s"),
        Axis::log(&labelled("Allan deviation", unit)).within(low / 2.5, high * 2.0),
    );
    if let Some(fit) = &channel.fit {
        for term in words::dominant(channel) {
            let square = fit.squares()[term as usize];
            let inside = |p: &(f64, f64)| p.1 > low / 2.5 && p.1 < high * 2.0;
            let line = points(&|i| (square * term.variance(channel.curve[i].tau_s)).sqrt());
            let ink = [Ink::Sky, Ink::Green, Ink::Orange, Ink::Purple, Ink::Soft][term as usize];
            chart.add(term.symbol(), ink, Mark::Dashed, line.into_iter().filter(inside).collect());
        }
        let fitted: Vec<_> = points(&|i| fit.deviation(channel.curve[i].tau_s));
        let fitted = fitted.into_iter().filter(|p| p.0 >= fit.from_s).collect();
        chart.add(if fit.good() { "fit" } else { "best fit (bad)" }, Ink::Red, Mark::Line, fitted);
    }
    let upper = points(&|i| channel.curve[i].ci95[1]).into_iter().map(|p| p.1.min(high * 2.0)).collect();
    let lower = points(&|i| channel.curve[i].ci95[0]).into_iter().map(|p| (p.0, p.1.max(low / 2.5))).collect();
    chart.add("", Ink::Blue, Mark::Whiskers(upper), lower);
    chart.add("recorded, 95 %", Ink::Blue, Mark::Dots(3), points(&|i| channel.curve[i].value));
    chart
}

pub(super) fn curve_caption(channel: &Channel) -> String {
    let drawn: Vec<String> = words::dominant(channel)
        .into_iter()
        .map(|t| format!("{} {}", t.symbol(), words::name(t).to_lowercase()))
        .collect();
    match (drawn.is_empty(), channel.fit.is_some()) {
        (_, false) => "Dots: overlapping Allan deviation with 95 % intervals. Too short for a fit.".into(),
        (true, _) => "Dots: overlapping Allan deviation with 95 % intervals. No single term dominates anywhere.".into(),
        (false, _) => format!(
            "Dots: overlapping Allan deviation with 95 % intervals. Dashed: the supported terms that dominate \
             somewhere on the curve ({}).",
            drawn.join("; ")
        ),
    }
}

pub(super) fn density(channel: &Channel) -> Chart {
    let (unit, factor) = channel.unit.density();
    let density = &channel.density;
    let mut chart = Chart::new(
        &format!("Noise density of {}", channel.name),
        Axis::log("frequency / Hz"),
        Axis::log(&labelled("density", unit)),
    );
    // Twenty points per decade read better than thousands; each is the mean of the bins it stands
    // for.
    let mut thinned: Vec<(f64, f64)> = Vec::new();
    let mut from = 0;
    while from < density.density.len() {
        let to = (((from + 1) as f64 * 1.06).ceil() as usize).min(density.density.len()).max(from + 1);
        let mean = mean(&density.density[from..to]);
        let middle = (density.frequency_hz[from] * density.frequency_hz[to - 1]).sqrt();
        thinned.push((middle, mean.sqrt() * factor));
        from = to;
    }
    chart.add("recorded (Welch)", Ink::Blue, Mark::Line, thinned);
    if let Some(fit) = &channel.fit
        && words::dominant(channel).contains(&proofmass_numerics::numerics::allan::law::Term::White)
        && let (Some(first), Some(last)) = (density.frequency_hz.first(), density.frequency_hz.last())
    {
        let level = fit.coefficients[1].value * 2f64.sqrt() * factor;
        chart.add("n = √2 N", Ink::Green, Mark::Dashed, vec![(*first, level), (*last, level)]);
    }
    let peaks: Vec<(f64, f64)> = channel
        .lines
        .iter()
        .filter_map(|line| {
            let bin = density.frequency_hz.iter().position(|f| *f >= line.frequency_hz)?;
            Some((line.frequency_hz, density.density[bin].sqrt() * factor))
        })
        .collect();
    if !peaks.is_empty() {
        chart.add("lines", Ink::Red, Mark::Dots(4), peaks);
    }
    chart
}

pub(super) fn density_caption(channel: &Channel) -> String {
    let averages = significant(channel.density.averages, 3);
    format!("One-sided density, {averages} independent averages; means of neighbouring bins where the curve is dense.")
}
