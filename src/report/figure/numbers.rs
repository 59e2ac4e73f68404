//! The numbers behind a chart, as columns in the chart's own units.
//!
//! Series of one abscissa share it; where some have points that others lack, cells are missing.
//! Paths, which turn back, keep an abscissa each. Lists, whose places are names, become rows of
//! names.

use super::chart::{Chart, Mark, Series};
use super::name;
use super::raster::{Raster, Shown};
use proofmass_base::columns::Columns;

/// The numbers behind a figure, or behind a part of it.
#[derive(Debug, Clone)]
pub struct Numbers {
    /// File name without ending.
    pub name: String,
    /// Columns in the figure's units.
    pub columns: Columns,
}

/// The tables of a chart: of its picture and of its series.
pub(crate) fn behind(chart: &Chart) -> Vec<Numbers> {
    let title = name::file(&chart.title);
    let named = |name: String, columns: Columns| Numbers { name, columns };
    let series = columns(chart);
    match &chart.raster {
        None => series.map(|c| named(title, c)).into_iter().collect(),
        Some(raster) => {
            let marks = series.map(|c| named(format!("{title}-marks"), c));
            std::iter::once(named(title, picture(chart, raster))).chain(marks).collect()
        }
    }
}

/// One series as columns next to an abscissa.
struct Part<'a> {
    /// Name that tells it from the others.
    called: &'a str,
    series: &'a Series,
    x: Vec<f64>,
    /// Name and values of each.
    columns: Vec<(String, Vec<f64>)>,
}

/// Returns what a series is called: by its legend, or by that of the next one of its colour, which
/// it belongs to.
fn called(chart: &Chart, place: usize) -> &str {
    let all = &chart.series;
    let same = |s: &&Series| s.ink == all[place].ink && !s.name.is_empty();
    let before = all[..=place].iter().rev().find(same);
    before.or_else(|| all[place..].iter().find(same)).map_or("", |s| s.name.as_str())
}

fn part<'a>(chart: &Chart, series: &'a Series, called: &'a str) -> Part<'a> {
    // Words with a unit of their own stand for the axis.
    let named = |more: &[&str]| match name::has_unit(called) {
        true => name::column(called, more),
        false => name::column(&chart.y.label, &[&[called], more].concat()),
    };
    let y: Vec<f64> = series.points.iter().map(|p| p.1).collect();
    let columns = match &series.mark {
        Mark::Band(upper) => vec![(named(&["low"]), y), (named(&["high"]), upper.clone())],
        Mark::Whiskers(upper) => {
            vec![(named(&["interval", "low"]), y), (named(&["interval", "high"]), upper.clone())]
        }
        _ => vec![(named(&[]), y)],
    };
    Part { called, series, x: series.points.iter().map(|p| p.0).collect(), columns }
}

fn columns(chart: &Chart) -> Option<Columns> {
    let drawn = || chart.series.iter().enumerate().filter(|(_, s)| !s.points.is_empty());
    drawn().next()?;
    if !chart.y.names.is_empty() {
        return Some(list(chart));
    }
    let mut names: Vec<&str> = drawn().map(|(place, _)| called(chart, place)).collect();
    names.dedup();
    // The only thing that is drawn is what the axis says.
    let alone = names.len() == 1;
    let parts: Vec<Part<'_>> =
        drawn().map(|(place, s)| part(chart, s, if alone { "" } else { called(chart, place) })).collect();
    let x_name = name::column(&chart.x.label, &[]);
    let mut out = Columns::default();
    if parts.iter().all(|p| p.x == parts[0].x) {
        out.numbers(&x_name, parts[0].x.clone());
        parts.into_iter().flat_map(|p| p.columns).for_each(|(name, values)| out.numbers(&name, values));
    } else if parts.iter().all(|p| p.x.windows(2).all(|w| w[0] < w[1])) {
        let mut x: Vec<f64> = parts.iter().flat_map(|p| p.x.iter().copied()).collect();
        x.sort_by(f64::total_cmp);
        x.dedup();
        out.numbers(&x_name, x.clone());
        for part in &parts {
            let place = |value: &f64| part.x.binary_search_by(|own| own.total_cmp(value)).ok();
            let places: Vec<Option<usize>> = x.iter().map(place).collect();
            for (name, values) in &part.columns {
                let cell = |place: &Option<usize>| place.and_then(|k| values.get(k)).copied().unwrap_or(f64::NAN);
                out.numbers(name, places.iter().map(cell).collect());
            }
        }
    } else {
        let mut lines: Vec<(&str, Vec<f64>)> = Vec::new();
        for part in parts {
            // A vertical line says where it stands, and nothing by its ends; those of one legend
            // are one column.
            match part.x[..] {
                [x, end] if x == end => match lines.iter_mut().find(|(called, _)| *called == part.called) {
                    Some((_, all)) => all.push(x),
                    None => lines.push((part.called, vec![x])),
                },
                _ => {
                    out.numbers(&name::column(&chart.x.label, &[&part.series.name]), part.x);
                    part.columns.into_iter().for_each(|(name, values)| out.numbers(&name, values));
                }
            }
        }
        lines.into_iter().for_each(|(called, x)| out.numbers(&name::column(&chart.x.label, &[called]), x));
    }
    Some(out)
}

/// A chart whose vertical places are names: a row per point.
fn list(chart: &Chart) -> Columns {
    let label = |y: f64| {
        let near = chart.y.names.iter().min_by(|a, b| (a.0 - y).abs().total_cmp(&(b.0 - y).abs()));
        near.map_or(String::new(), |(_, name)| name.clone())
    };
    let rows = || {
        let places = chart.series.iter().enumerate();
        places.flat_map(|(place, s)| s.points.iter().map(move |p| (place, *p)))
    };
    let kind = |place: usize| match (&chart.series[place].mark, called(chart, place)) {
        (Mark::Line, _) => "end of the interval",
        (_, "") => "value",
        (_, name) => name,
    };
    let mut out = Columns::default();
    out.words("name", rows().map(|(_, p)| label(p.1)).collect());
    out.words("what", rows().map(|(place, _)| kind(place).to_owned()).collect());
    out.numbers(&name::column(&chart.x.label, &[]), rows().map(|(_, p)| p.0).collect());
    out
}

fn picture(chart: &Chart, raster: &Raster) -> Columns {
    let [x_name, y_name] = [&chart.x, &chart.y].map(|axis| name::column(&axis.label, &[]));
    let mut out = Columns::default();
    match &raster.shown {
        Shown::Points(points) => {
            out.numbers(&x_name, points.iter().map(|p| p.0).collect());
            out.numbers(&y_name, points.iter().map(|p| p.1).collect());
        }
        Shown::Cells(values) => {
            let (columns, rows) = (raster.shape.0.max(1) as usize, raster.shape.1.max(1) as usize);
            let middle =
                |(from, to): (f64, f64), k: usize, of: usize| from + (to - from) * (k as f64 + 0.5) / of as f64;
            out.numbers(&x_name, (0..values.len()).map(|i| middle(raster.x, i % columns, columns)).collect());
            out.numbers(&y_name, (0..values.len()).map(|i| middle(raster.y, i / columns, rows)).collect());
            let label = raster.bar.as_ref().map_or("value", |bar| bar.0.as_str());
            out.numbers(&name::column(label, &[]), values.clone());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Ink};
    use proofmass_base::columns::{Format, Values};

    fn names(columns: &Columns) -> Vec<&str> {
        columns.all().iter().map(|c| c.name.as_str()).collect()
    }

    fn text(columns: &Columns) -> String {
        String::from_utf8(Format::Csv.bytes(columns)).expect("UTF-8")
    }

    fn chart() -> Chart {
        Chart::new("What it is", Axis::linear("time / s"), Axis::linear("error / m"))
    }

    #[test]
    fn series_share_an_abscissa_and_miss_what_they_lack() {
        let drawn = chart().with("5–95 %", Ink::Blue, Mark::Band(vec![3.0, 4.0]), vec![(0.0, 1.0), (1.0, 2.0)]).with(
            "recorded",
            Ink::Red,
            Mark::Dots(3),
            vec![(1.0, 9.0), (2.0, 8.0)],
        );
        let [numbers] = &behind(&drawn)[..] else { panic!("one table") };
        assert_eq!(numbers.name, "what-it-is");
        let names = names(&numbers.columns);
        assert_eq!(names, ["time_s", "error_5_95_percent_low_m", "error_5_95_percent_high_m", "error_recorded_m"]);
        let csv = text(&numbers.columns);
        assert_eq!(csv.lines().skip(1).collect::<Vec<_>>(), ["0.0,1.0,3.0,", "1.0,2.0,4.0,9.0", "2.0,,,8.0"]);
    }

    #[test]
    fn a_path_that_turns_back_keeps_its_order_and_a_lone_series_the_name_of_the_axis() {
        let alone = behind(&chart().with("simulated", Ink::Blue, Mark::Line, vec![(0.0, 1.0)]));
        assert_eq!(names(&alone[0].columns), ["time_s", "error_m"]);
        let paths = chart().with("a", Ink::Blue, Mark::Line, vec![(0.0, 1.0), (2.0, 2.0), (1.0, 3.0)]).with(
            "b",
            Ink::Red,
            Mark::Line,
            vec![(5.0, 1.0)],
        );
        let paths = behind(&paths);
        assert_eq!(names(&paths[0].columns), ["time_a_s", "error_a_m", "time_b_s", "error_b_m"]);
        assert_eq!(paths[0].columns.all()[0].values, Values::Numbers(vec![0.0, 2.0, 1.0]));
    }

    #[test]
    fn vertical_lines_of_one_legend_are_one_column_of_where_they_stand() {
        let line = |x: f64| vec![(x, 0.0), (x, 1.0)];
        let chart = chart().with("members", Ink::Blue, Mark::Line, vec![(0.0, 0.1), (1.0, 0.2)]);
        let chart =
            chart.with("5, 95 %", Ink::Red, Mark::Dashed, line(0.3)).with("", Ink::Red, Mark::Dashed, line(0.7));
        let columns = &behind(&chart)[0].columns;
        assert_eq!(names(columns), ["time_members_s", "error_members_m", "time_5_95_percent_s"]);
        assert_eq!(columns.all()[2].values, Values::Numbers(vec![0.3, 0.7]));
    }

    #[test]
    fn a_list_is_rows_of_names_and_a_map_cells() {
        let names = vec![(2.0, "cubic-stiffness".to_owned()), (1.0, "feedthrough".to_owned())];
        let mut list = Chart::new("Which", Axis::linear("gain"), Axis::linear("best first").named(names));
        list.add("named", Ink::Red, Mark::Dots(4), vec![(0.9, 2.0)]);
        list.add("", Ink::Soft, Mark::Dots(4), vec![(0.1, 1.0)]);
        let csv = text(&behind(&list)[0].columns);
        assert_eq!(csv, "name,what,gain\ncubic-stiffness,named,0.9\nfeedthrough,value,0.1\n");
        let mut map = chart();
        let values = [1.0, 2.0, 3.0, f64::NAN];
        map.raster = Some(Raster::heat_map(&values, 2, (0.0, 4.0), (0.0, 2.0), (0.0, 3.0), "exponent / (1/s)"));
        let csv = text(&behind(&map)[0].columns);
        assert_eq!(csv, "time_s,error_m,exponent_per_s\n1.0,0.5,1.0\n3.0,0.5,2.0\n1.0,1.5,3.0\n3.0,1.5,\n");
    }
}
