//! Which columns are a gyroscope's and which an accelerometer's, by their names, and in what unit.

use super::unit::{Quantity, Unit};

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
/// Units at the end of a name.
const SUFFIXES: [(&str, &str); 17] = [
    ("_rad_s", "rad/s"),
    ("_rads", "rad/s"),
    ("_rad_per_s", "rad/s"),
    ("_deg_s", "deg/s"),
    ("_deg_per_s", "deg/s"),
    ("_dps", "deg/s"),
    ("_mdps", "mdeg/s"),
    ("_m_s2", "m/s2"),
    ("_ms2", "m/s2"),
    ("_mss", "m/s2"),
    ("_mps2", "m/s2"),
    ("_mg", "mg"),
    ("_g", "g"),
    ("_lsb", "LSB"),
    ("_cnt", "LSB"),
    ("_counts", "LSB"),
    ("_raw", "LSB"),
];

/// A name without its unit, and the unit.
fn stem(name: &str) -> (String, Option<&'static str>) {
    let name = name.trim().to_lowercase();
    let plain = match name.split_once(['[', '(']) {
        // An index in brackets is part of the name.
        Some((front, rest)) if !rest.starts_with(|c: char| c.is_ascii_digit()) => front.trim().to_owned(),
        _ => name,
    };
    let suffix = SUFFIXES.iter().find(|(end, _)| plain.len() > end.len() + 1 && plain.ends_with(end));
    suffix.map_or((plain.clone(), None), |(end, unit)| (plain[..plain.len() - end.len()].to_owned(), Some(*unit)))
}

/// What a column measures and along which axis.
fn role(name: &str) -> Option<(Quantity, usize)> {
    let (stem, _) = stem(name);
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

/// The unit of a column that is one of an inertial sensor's by its name alone, which says unit and
/// quantity: `gyro_rad_s`, or with a sensor's number `accelerometer_2_m_s2`.
pub fn alone(name: &str) -> Option<Unit> {
    let (stem, unit) = stem(name);
    let unit = Unit::of_file(unit?)?;
    let plain = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let of = plain.strip_suffix('_').unwrap_or(plain);
    let names = match unit.quantity {
        Quantity::Gyro => &GYRO[..],
        Quantity::Accelerometer => &ACCELEROMETER[..],
        Quantity::Unknown => &[],
    };
    names.contains(&of).then_some(unit)
}

/// The unit of a column of this name: what its file states, else what its name ends with.
/// `Some(None)` where that is no unit of an inertial sensor, as counts are.
pub fn unit(name: &str, stated: Option<&str>) -> Option<Option<Unit>> {
    stated.or(stem(name).1).map(Unit::of_file)
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
        for other in ["gyro_1", "t_s", "temperature_1_g", "gyro_m_s2", "x_mg"] {
            assert_eq!(quantity(other), None, "{other}");
        }
    }

    #[test]
    fn units_stand_in_the_file_or_in_the_name() {
        let known = |name, stated| unit(name, stated).flatten().map(|u| u.quantity);
        assert_eq!(known("wx_deg_s", None), Some(Quantity::Gyro));
        assert_eq!(known("wx", Some("m s^-2")), Some(Quantity::Accelerometer));
        assert_eq!((unit("gx", None), unit("gx_lsb", None)), (None, Some(None)));
    }
}
