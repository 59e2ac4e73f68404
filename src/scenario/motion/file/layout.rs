//! Which columns of a file hold the pose, by their headings.

use super::format::{Format, Order};
use super::part::{Part, Wanted};
use super::refusal::{Refusal, refusal};
use crate::recording::headings::Headings;
use crate::recording::time_unit::TimeUnit;
use crate::units::DEGREE;

/// Form in which a row states its attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rotation {
    /// Four numbers, given here with the scalar first; and where it stands in the file.
    Quaternion(Order),
    /// Roll, pitch and yaw; what one unit is in rad, where the headings say it.
    Euler(Option<f64>),
    /// A matrix, row by row.
    Matrix,
}

/// The axes of the positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axes {
    /// x, y, z.
    Xyz,
    /// North, east, down.
    NorthEastDown,
    /// East, north, up.
    EastNorthUp,
}

/// Places of time, position and attitude among the columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Format of the file.
    pub format: Format,
    /// Heading of the stamps, and their unit where it is known.
    pub time: Option<(String, Option<TimeUnit>)>,
    /// Headings of the numbers wanted: position, then attitude.
    pub columns: Vec<String>,
    /// Says whether position is among them.
    pub has_position: bool,
    /// Form of the attitude; none where it is not among them.
    pub rotation: Option<Rotation>,
    /// The axes of position.
    pub axes: Axes,
    /// Unit of latitude and longitude, rad, where they state the position.
    pub geodetic: Option<f64>,
}

const NUMBERED: &str = "columns without headings are read as TUM (8 numbers) or KITTI (12 numbers); give the file a header, \
                        e.g. t_s,x,y,z,qw,qx,qy,qz";

impl Layout {
    /// Of a file with these headings; `insisted` is what the user says it is.
    ///
    /// # Errors
    /// Columns that are not there.
    pub(super) fn of(headings: &Headings, insisted: Option<Format>, wanted: Wanted) -> Result<Self, Refusal> {
        let names = &headings.names;
        let counted = (1..).zip(names).all(|(k, name): (usize, _)| *name == k.to_string());
        let matrix = names.iter().any(|n| n == "r11");
        let format = insisted.unwrap_or(match (counted, names.len()) {
            _ if matrix => Format::Kitti,
            (true, 8) => Format::Tum,
            (true, 12) => Format::Kitti,
            _ if names.iter().any(|n| clean(n) == "p_rs_r_x") => Format::Euroc,
            _ if names.iter().map(String::as_str).eq(TUM) => Format::Tum,
            _ => Format::Csv,
        });
        let place = |k: usize| names.get(k).cloned();
        let all = |places: &[usize]| places.iter().map(|k| place(*k)).collect::<Option<Vec<_>>>();
        let few = || refusal(format!("a {} file needs more columns than {}", format.name(), names.len()), NUMBERED);
        let by_place = |unit, order: [usize; 4], says| -> Result<Self, Refusal> {
            let columns = all(&[1, 2, 3].iter().chain(&order).copied().collect::<Vec<_>>()).ok_or_else(few)?;
            let time = place(0).map(|name| (name, Some(unit)));
            let rotation = Some(Rotation::Quaternion(says));
            Ok(Self { format, time, columns, has_position: true, rotation, axes: Axes::Xyz, geodetic: None })
        };
        let layout = match format {
            Format::Kitti => {
                let columns = all(&[3, 7, 11, 0, 1, 2, 4, 5, 6, 8, 9, 10]).ok_or_else(few)?;
                let rotation = Some(Rotation::Matrix);
                Ok(Self { format, time: None, columns, has_position: true, rotation, axes: Axes::Xyz, geodetic: None })
            }
            Format::Tum => by_place(TimeUnit::Second, [7, 4, 5, 6], Order::ScalarLast),
            Format::Euroc if counted => by_place(TimeUnit::Nanosecond, [4, 5, 6, 7], Order::ScalarFirst),
            Format::Csv if counted => Err(refusal("its columns have no headings", NUMBERED)),
            Format::Euroc | Format::Csv => by_heading(headings, format, wanted),
        }?;
        Ok(layout.taking(wanted))
    }

    /// Returns the number of columns that hold the position.
    pub(super) fn numbers_of_position(&self) -> usize {
        if self.has_position { 3 } else { 0 }
    }

    /// Without the columns that are not wanted.
    fn taking(mut self, wanted: Wanted) -> Self {
        if !wanted.takes(Part::Attitude) {
            self.columns.truncate(self.numbers_of_position());
            self.rotation = None;
        }
        if self.has_position && !wanted.takes(Part::Position) {
            self.columns.drain(..3);
            self.has_position = false;
            self.geodetic = None;
        }
        self
    }
}

const TUM: [&str; 8] = ["timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"];

/// A heading without its unit and in small letters.
fn clean(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default().trim();
    let name = name.trim_start_matches(['#', '%']).trim().to_lowercase();
    name.strip_suffix("_m").map_or(name.clone(), str::to_owned)
}

fn by_heading(headings: &Headings, format: Format, wanted: Wanted) -> Result<Layout, Refusal> {
    let names: Vec<String> = headings.names.iter().map(|n| clean(n)).collect();
    let find = |holds: &dyn Fn(&str) -> bool| names.iter().position(|n| holds(n));
    let triple = |of: [&dyn Fn(&str) -> bool; 3]| Some([find(of[0])?, find(of[1])?, find(of[2])?]);
    let turns = |n: &str| n.starts_with('q') || n.contains("quat") || n.contains("orient") || n.starts_with("rot");
    let place = |n: &str, axis: char| {
        let front = n.strip_suffix(axis).unwrap_or("-").trim_end_matches(['_', '.', ' ']);
        let known = ["", "t", "p", "pos", "position", "translation"];
        n.ends_with(axis)
            && !turns(n)
            && (known.contains(&front) || front.starts_with("p_") || front.ends_with("position"))
    };
    let begins = |n: &str, word: &str| n == word || n.strip_prefix(word).is_some_and(|rest| rest.starts_with('_'));
    let position = [
        (Axes::Xyz, triple([&|n| place(n, 'x'), &|n| place(n, 'y'), &|n| place(n, 'z')])),
        (Axes::NorthEastDown, triple([&|n| begins(n, "north"), &|n| begins(n, "east"), &|n| begins(n, "down")])),
        (Axes::EastNorthUp, triple([&|n| begins(n, "east"), &|n| begins(n, "north"), &|n| begins(n, "up")])),
    ];
    let latitude = triple([
        &|n| begins(n, "lat") || begins(n, "latitude"),
        &|n| ["lon", "long", "lng", "longitude"].iter().any(|word| begins(n, word)),
        &|n| ["alt", "altitude", "height", "hgt"].iter().any(|word| begins(n, word)),
    ]);
    // A compass heading counts from north; a yaw given with latitudes counts from east.
    let from_north = names.iter().any(|n| begins(n, "heading"));
    let axes_of_attitude = if from_north { Axes::NorthEastDown } else { Axes::EastNorthUp };
    let position = position.into_iter().chain([(axes_of_attitude, latitude)]);
    let known = || format!("it has: {}", headings.names.iter().take(20).cloned().collect::<Vec<_>>().join(", "));
    let found = position.into_iter().find_map(|(axes, places)| Some((axes, places?)));
    let geodetic = latitude.filter(|places| found.is_some_and(|(_, found)| found == *places));
    let geodetic = geodetic.map(|places| angle_unit(headings, places[0]).unwrap_or(DEGREE));
    if found.is_none() && wanted.needs(Part::Position) {
        return Err(refusal(
            "no columns x, y, z (or north, east, down, or latitude, longitude, height) hold a position",
            known(),
        ));
    }
    let position = found.map_or(Vec::new(), |(_, places)| places.to_vec());
    let axes = found.map_or(Axes::Xyz, |(axes, _)| axes);
    let of_angle = if geodetic.is_some() { 2 } else { 0 };
    for k in position.iter().copied().skip(of_angle).filter(|_| wanted.takes(Part::Position)) {
        let unit = headings.units[k].as_deref().unwrap_or("m");
        if !["m", "meter", "meters", "metre", "metres"].contains(&unit) {
            return Err(refusal(
                format!("column `{}` is in {unit}: need m", headings.names[k]),
                "convert it to metres",
            ));
        }
    }
    let part = |axis: char| find(&|n| turns(n) && n.ends_with(axis));
    let scalar = part('w').or_else(|| find(&|n| n == "q0" || n == "q_0"));
    let numbered = |digit: char, axis: char| part(axis).or_else(|| find(&|n| turns(n) && n.ends_with(digit)));
    let quaternion = [scalar, numbered('1', 'x'), numbered('2', 'y'), numbered('3', 'z')];
    let euler =
        triple([&|n| begins(n, "roll"), &|n| begins(n, "pitch"), &|n| begins(n, "yaw") || begins(n, "heading")]);
    let (rotation, attitude) = match (quaternion, euler) {
        ([Some(w), Some(x), Some(y), Some(z)], _) => {
            let order = if w < x { Order::ScalarFirst } else { Order::ScalarLast };
            (Some(Rotation::Quaternion(order)), vec![w, x, y, z])
        }
        (_, Some(places)) => (Some(Rotation::Euler(angle_unit(headings, places[0]))), places.to_vec()),
        _ if !wanted.needs(Part::Attitude) && !position.is_empty() => (None, Vec::new()),
        _ => {
            let attitude = "an attitude: qw, qx, qy, qz, or roll, pitch, yaw";
            let cause = if wanted == Wanted::Any {
                format!("no columns hold a position (x, y, z, or north, east, down) or {attitude}")
            } else {
                format!("no columns hold {attitude}")
            };
            return Err(refusal(cause, known()));
        }
    };
    let clock = |n: &str| ["t", "time", "timestamp", "stamp"].iter().any(|word| begins(n, word)) || n == "secs";
    let time = find(&clock).ok_or_else(|| refusal("no column `t_s` or `timestamp` holds the time", known()))?;
    let heading = headings.clock_heading(time);
    Ok(Layout {
        format,
        time: Some((headings.names[time].clone(), TimeUnit::of_heading(&heading))),
        columns: position.iter().chain(&attitude).map(|k| headings.names[*k].clone()).collect(),
        has_position: !position.is_empty(),
        rotation,
        axes,
        geodetic,
    })
}

/// Returns the unit of an angle's column, rad, where its heading says it.
fn angle_unit(headings: &Headings, place: usize) -> Option<f64> {
    let name = headings.names[place].to_lowercase();
    let unit = headings.units[place].as_deref().unwrap_or(&name);
    match unit {
        u if u.contains("deg") || u.contains('°') => Some(DEGREE),
        u if u.contains("rad") => Some(1.0),
        _ => None,
    }
}
