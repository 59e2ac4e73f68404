//! Which columns are a gyroscope's and which an accelerometer's, by their names, and in what unit.

use super::unit::{self, Quantity, Unit};

/// The six columns of an IMU, by their place among the names.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Roles {
    /// Angular rates x, y, z.
    pub gyro: Option<[usize; 3]>,
    /// Specific forces x, y, z.
    pub accelerometer: Option<[usize; 3]>,
}

const GYRO: [&str; 10] =
    ["g", "gyr", "gyro", "gyroscope", "w", "omega", "angular_velocity", "angular_rate", "w_rs_s", "gyro_rad"];
const ACCELEROMETER: [&str; 11] = [
    "a",
    "acc",
    "accel",
    "accelerometer",
    "acceleration",
    "f",
    "linear_acceleration",
    "specific_force",
    "a_rs_s",
    "force",
    "accelerometer_m_s2",
];
/// Words that a unit at the end of a name has at most: `m_per_s_per_s`.
const WORDS: usize = 5;

/// A heading taken apart.
#[derive(Debug, Clone, PartialEq)]
struct Heading {
    /// Lower case, without its unit.
    stem: String,
    /// The unit that it states, as it is written there.
    unit: Option<Stated>,
}

/// A statement of a column's unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Stated {
    /// A unit of an inertial sensor.
    Inertial(Unit),
    /// Counts of a converter, whose size the file does not state.
    Counts,
    /// A unit of something else, or words that are none that is known.
    Other(String),
}

impl Stated {
    /// Words in brackets, in a row of units or in a format's own field.
    fn of_file(text: &str) -> Self {
        match Unit::of_file(text) {
            Some(unit) => Self::Inertial(unit),
            None if unit::is_count(text) => Self::Counts,
            None => Self::Other(unit::without_brackets(text).to_owned()),
        }
    }

    /// The last words of a heading.
    fn of_tail(text: &str) -> Option<Self> {
        match Unit::of_heading(text) {
            Some(unit) => Some(Self::Inertial(unit)),
            None if unit::is_count(text) => Some(Self::Counts),
            None if matches!(text, "m_s" | "mm_s" | "um_s") => Some(Self::Other(text.replace('_', "/"))),
            None => Self::is_symbol(text).then(|| Self::Other(text.to_owned())),
        }
    }

    /// Of single letters only those that are a unit in capitals or a metre: `omega_s` is no time.
    fn is_symbol(text: &str) -> bool {
        unit::is_other(text) && (text.chars().count() > 1 || "VANKCm".contains(text))
    }
}

/// A heading without its unit: the unit stands in brackets, behind the last words or, as in
/// `acc_mps2_x`, before the axis.
fn taken_apart(name: &str) -> Heading {
    let name = name.trim();
    let plain = match name.split_once(['[', '(']) {
        // An index in brackets is part of the name.
        Some((front, rest)) if !rest.starts_with(|c: char| c.is_ascii_digit()) => front.trim(),
        _ => name,
    };
    let cut = |text: &str| {
        let places: Vec<usize> =
            text.char_indices().filter(|(at, c)| "_ ".contains(*c) && *at > 0).map(|(at, _)| at).collect();
        let last = places[places.len().saturating_sub(WORDS)..].iter();
        last.map(|at| (*at, &text[at + 1..])).find_map(|(at, tail)| Some((at, Stated::of_tail(tail)?)))
    };
    if let Some((at, unit)) = cut(plain) {
        return Heading { stem: plain[..at].to_lowercase(), unit: Some(unit) };
    }
    if let Some((front, axis)) = before_axis(plain)
        && let Some((at, unit @ (Stated::Inertial(_) | Stated::Counts))) = cut(front)
    {
        let stem = front[..at].to_lowercase();
        // `imu_g_x` is a gyro's, not an imu's in g.
        if !front[at + 1..].eq_ignore_ascii_case("g") || ACCELEROMETER.contains(&stem.as_str()) {
            return Heading { stem: format!("{stem}{}", axis.to_lowercase()), unit: Some(unit) };
        }
    }
    Heading { stem: plain.to_lowercase(), unit: None }
}

/// A name without its axis, and the axis: `_x`, `.1`, `[0]`.
fn before_axis(name: &str) -> Option<(&str, &str)> {
    let (at, bare) = match name.strip_suffix(']') {
        Some(open) => (open.rfind('[')?, &open[open.rfind('[')? + 1..]),
        None => (name.rfind(['_', '.'])?, &name[name.rfind(['_', '.'])? + 1..]),
    };
    let is_axis = matches!(bare, "x" | "y" | "z" | "X" | "Y" | "Z" | "0" | "1" | "2" | "3");
    is_axis.then(|| name.split_at(at))
}

/// The unit that a file states for a column: in a row of units, in brackets or by its format
/// (`stated`), else at the end of its name. One letter at the end of a name says nothing unless it
/// is `g`.
pub fn stated(name: &str, stated: Option<&str>) -> Option<Stated> {
    match stated {
        Some(text) => Some(Stated::of_file(text)),
        None => taken_apart(name).unit.filter(|unit| !matches!(unit, Stated::Other(_))),
    }
}

/// The words for that unit, whatever it measures; `None` where nothing states one.
pub fn unit_words(name: &str, stated: Option<&str>) -> Option<String> {
    let unit = stated.map(Stated::of_file).or_else(|| taken_apart(name).unit)?;
    Some(match unit {
        Stated::Inertial(unit) => unit.symbol().unwrap_or(unit.name),
        Stated::Counts => "count".to_owned(),
        Stated::Other(text) => text,
    })
}

/// Returns what a column measures and along which axis.
fn role(name: &str) -> Option<(Quantity, usize)> {
    let Heading { stem, .. } = taken_apart(name);
    let plain = stem.replace('[', ".").replace(']', "");
    let last = plain.chars().last()?;
    let front = &plain[..plain.len() - last.len_utf8()];
    let counted = front.ends_with('.');
    let axis = match last {
        'x' | 'y' | 'z' => "xyz".find(last)?,
        '1'..='3' if counted && !stem.contains('[') => last as usize - '1' as usize,
        '0'..='2' if counted => last as usize - '0' as usize,
        _ => return None,
    };
    let front = front.trim_end_matches(['.', '_', '-', ' ']).replace([' ', '-'], "_");
    // The last name of a path: imu.gyro.1.
    let front = front.rsplit(['.', '/']).next().unwrap_or_default();
    let among = |names: &[&str]| names.contains(&front);
    match () {
        () if among(&GYRO) => Some((Quantity::Gyro, axis)),
        () if among(&ACCELEROMETER) => Some((Quantity::Accelerometer, axis)),
        () => None,
    }
}

/// The roles of these columns: three of each kind, each axis once.
pub fn of(names: &[String]) -> Roles {
    let roles: Vec<(usize, Quantity, usize, usize)> = names
        .iter()
        .enumerate()
        .filter_map(|(place, name)| {
            role(name).map(|(quantity, axis)| (place, quantity, axis, name.matches('.').count()))
        })
        .collect();
    let triple = |quantity: Quantity| {
        let mut places = [None; 3];
        // A variable wins over a field within one.
        let depth = roles.iter().filter(|r| r.1 == quantity).map(|r| r.3).min();
        for (place, _, axis, _) in roles.iter().copied().filter(|r| r.1 == quantity && Some(r.3) == depth) {
            if places[axis].replace(place).is_some() {
                return None;
            }
        }
        let [Some(x), Some(y), Some(z)] = places else { return None };
        Some([x, y, z])
    };
    Roles { gyro: triple(Quantity::Gyro), accelerometer: triple(Quantity::Accelerometer) }
}

/// Beginnings of the names of a sensor's surroundings.
const SURROUNDINGS: [&str; 6] = ["temp", "press", "baro", "humid", "supply", "vbat"];
/// Units in which those are measured.
const SURROUNDING_UNITS: [&str; 9] = ["degc", "°c", "c", "k", "kelvin", "pa", "hpa", "kpa", "mbar"];

/// Returns whether a heading states a unit of a sensor's surroundings: `T [°C]` is no time.
pub(super) fn has_unit_of_surroundings(name: &str) -> bool {
    let inside = name.split_once(['[', '(']).map(|(_, rest)| rest.trim_end_matches([']', ')', ' ']));
    unit_words(name, inside).is_some_and(|unit| SURROUNDING_UNITS.contains(&unit.to_lowercase().as_str()))
}

/// Tells a column of a sensor's surroundings, as temperature is, from one of its readings.
pub(crate) fn is_environment(name: &str, stated: Option<&str>) -> bool {
    let lower = name.trim().to_lowercase();
    let unit = unit_words(name, stated).unwrap_or_default().to_lowercase();
    let words = || lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty());
    lower == "t"
        || SURROUNDING_UNITS.contains(&unit.as_str())
        || words().any(|w| SURROUNDINGS.iter().any(|s| w.starts_with(s)))
}

/// The surroundings among the columns of an inertial sensor; none where no column is one's, or
/// where headings repeat and cannot be named apart.
pub fn surroundings(names: &[String], stated: &[Option<String>]) -> Vec<String> {
    let is_environment = |(name, text): &(&String, &Option<String>)| is_environment(name, text.as_deref());
    let twice = (1..names.len()).any(|i| names[..i].contains(&names[i]));
    if twice || of(names) == Roles::default() {
        return Vec::new();
    }
    names.iter().zip(stated).filter(is_environment).map(|(name, _)| name.clone()).collect()
}

/// Tells a file of poses by its headings: an attitude as a quaternion, a matrix or angles, or a
/// position that is named as one.
pub(crate) fn is_pose(names: &[String]) -> bool {
    let stems: Vec<String> = names
        .iter()
        .map(|name| taken_apart(name.trim_start_matches(['#', '%'])).stem)
        .map(|stem| stem.replace(['[', ']'], "."))
        .collect();
    let all = |axes: &str, begins: &dyn Fn(&str) -> bool| {
        let of = |axis: char| {
            move |stem: &String| stem.strip_suffix(axis).is_some_and(|f| begins(f.trim_end_matches(['_', '.', ' '])))
        };
        axes.chars().all(|axis| stems.iter().any(of(axis)))
    };
    let turns =
        |front: &str| front.starts_with('q') || ["quat", "orient", "rot"].iter().any(|word| front.contains(word));
    let places = |front: &str| {
        front == "t"
            || front == "p"
            || front.starts_with("p_")
            || front.starts_with("pos")
            || front.ends_with("position")
    };
    let named = |words: [&str; 3]| words.iter().all(|word| stems.iter().any(|stem| stem.starts_with(word)));
    all("wxyz", &turns)
        || all("xyz", &places)
        || named(["roll", "pitch", "yaw"])
        || named(["north", "east", "down"])
        || named(["r11", "r12", "r13"])
}

/// The unit of a column that is one of an inertial sensor's by its name alone, which says unit and
/// quantity: `gyro_rad_s`, with an axis `gz_rad_s`, or with a sensor's number `accelerometer_2_m_s2`.
pub fn alone(name: &str) -> Option<Unit> {
    let Some(Stated::Inertial(unit)) = taken_apart(name).unit else { return None };
    (named(name) == Some(unit.quantity)).then_some(unit)
}

/// The sensor that a column belongs to by its name alone, which states no other unit: `gz`, `gyro`, `acc_x_lsb`.
/// A force without a unit, or one letter without an axis, is no sensor.
pub fn alone_without_unit(name: &str) -> Option<Quantity> {
    let Heading { stem, unit: None | Some(Stated::Counts) } = taken_apart(name) else { return None };
    let is_force = stem == "fx" || stem == "fy" || stem == "fz" || stem.starts_with("f_") || stem.starts_with("force");
    named(name).filter(|_| !is_force && !stem.ends_with("rate") && stem.len() > 1)
}

/// The sensor whose name this is, with an axis, a sensor's number or neither.
fn named(name: &str) -> Option<Quantity> {
    let Heading { stem, .. } = taken_apart(name);
    let plain = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let of = plain.strip_suffix('_').unwrap_or(plain);
    let among = |names: &[&str]| names.contains(&of);
    match role(name) {
        Some((quantity, _)) => Some(quantity),
        None if among(&GYRO) || of == "rate" || of.ends_with("_rate") => Some(Quantity::Gyro),
        None => among(&ACCELEROMETER).then_some(Quantity::Accelerometer),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roles(names: &[&str]) -> Roles {
        of(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn inertial_columns_are_known_in_every_spelling() {
        let both = Roles { gyro: Some([0, 1, 2]), accelerometer: Some([3, 4, 5]) };
        for names in [
            ["gx", "gy", "gz", "ax", "ay", "az"],
            ["GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"],
            ["GyroX", "GyroY", "GyroZ", "AccelX", "AccelY", "AccelZ"],
            ["gyro.1", "gyro.2", "gyro.3", "acc.1", "acc.2", "acc.3"],
            ["imu.w.1", "imu.w.2", "imu.w.3", "imu.f.1", "imu.f.2", "imu.f.3"],
            ["wx_deg_s", "wy_deg_s", "wz_deg_s", "fx_m_s2", "fy_m_s2", "fz_m_s2"],
            ["gx_lsb", "gy_lsb", "gz_lsb", "ax_lsb", "ay_lsb", "az_lsb"],
            ["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]", "acc[0]", "acc[1]", "acc[2]"],
            [
                "w_RS_S_x [rad s^-1]",
                "w_RS_S_y [rad s^-1]",
                "w_RS_S_z [rad s^-1]",
                "a_RS_S_x [m s^-2]",
                "a_RS_S_y [m s^-2]",
                "a_RS_S_z [m s^-2]",
            ],
        ] {
            assert_eq!(roles(&names), both, "{names:?}");
        }
        assert_eq!(roles(&["gx", "gy", "temp", "max", "tax"]), Roles::default());
        assert_eq!(roles(&["gx", "gy", "gz", "wx"]).gyro, None, "two columns for one axis");
        let nested = ["gyro.1", "gyro.2", "gyro.3", "imu.gyro.1", "imu.gyro.2", "imu.gyro.3"];
        assert_eq!(roles(&nested).gyro, Some([0, 1, 2]), "a variable wins over a field");
    }

    #[test]
    fn a_lone_column_is_known_where_its_name_says_quantity_and_unit() {
        let quantity = |name| alone(name).map(|u| u.quantity);
        assert_eq!(quantity("gyro_12_rad_s"), Some(Quantity::Gyro));
        assert_eq!(quantity("accelerometer_m_s2"), Some(Quantity::Accelerometer));
        assert_eq!(quantity("gz_rad_s"), Some(Quantity::Gyro));
        assert_eq!((quantity("rate_dps"), quantity("yaw_rate_deg_s")), (Some(Quantity::Gyro), Some(Quantity::Gyro)));
        assert_eq!(quantity("accel_x_g"), Some(Quantity::Accelerometer));
        for other in ["gyro_1", "t_s", "temperature_1_g", "gyro_m_s2", "x_mg"] {
            assert_eq!(quantity(other), None, "{other}");
        }
        for (name, known) in [("gz", Quantity::Gyro), ("gyro", Quantity::Gyro), ("acc_x_lsb", Quantity::Accelerometer)]
        {
            assert_eq!(alone_without_unit(name), Some(known), "{name}");
        }
        for other in [
            "fx",
            "force",
            "force_x",
            "f_x",
            "x",
            "a",
            "w",
            "ax_V",
            "gz_rad_s",
            "velocity",
            "u",
            "ay_N",
            "rate",
            "flow_rate",
        ] {
            assert_eq!(alone_without_unit(other), None, "{other}");
        }
    }

    #[test]
    fn units_stand_in_the_file_or_in_the_name() {
        let known = |name, text| match stated(name, text) {
            Some(Stated::Inertial(unit)) => Some(unit.quantity),
            _ => None,
        };
        assert_eq!(known("wx_deg_s", None), Some(Quantity::Gyro));
        assert_eq!(known("wx", Some("m s^-2")), Some(Quantity::Accelerometer));
        assert_eq!((stated("gx", None), stated("gx_lsb", None)), (None, Some(Stated::Counts)));
        assert_eq!((stated("omega_s", None), stated("V2_V", None)), (None, None), "no unit of an inertial sensor");
        assert_eq!(stated("gx", Some("V")), Some(Stated::Other("V".into())));
    }

    #[test]
    fn words_for_a_unit_are_the_headings_own() {
        for (name, text, words) in [
            ("V2_V", None, Some("V")),
            ("force_m_s2", None, Some("m/s²")),
            ("x_um", None, Some("um")),
            ("v_m_s", None, Some("m/s")),
            ("force_g", None, Some("g")),
            ("a", Some("m/s^2"), Some("m/s²")),
            ("wx_deg_s", None, Some("°/s")),
            ("y_lsb", None, Some("count")),
            ("temp_degC", None, Some("degC")),
            ("force_x", None, None),
        ] {
            assert_eq!(unit_words(name, text).as_deref(), words, "{name}");
        }
    }
}
