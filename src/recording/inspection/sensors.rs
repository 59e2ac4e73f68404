//! The inertial columns of a file, and what one unit of each is: stated, counted, or judged by
//! size.

use super::given::is_given;
use super::rest::Rest;
use crate::finding::Finding;
use crate::roles::{self, Stated};
use crate::scale::{self, Measured};
use crate::unit::Quantity;

/// Gyros and accelerometers among the columns.
pub(super) struct Sensors {
    /// Places of the columns of gyros and of accelerometers.
    pub places: [Vec<usize>; 2],
    /// The column of a rate or an acceleration that was given to the sensor, where there is one.
    pub given: Option<usize>,
    stated: Vec<Option<Stated>>,
}

/// The only column that is given, of a quantity that a sensor there reads.
fn given(names: &[String], stated: &[Option<Stated>], places: &[Vec<usize>; 2]) -> Option<usize> {
    let is_read = |unit: &Stated| match unit {
        Stated::Inertial(unit) => {
            KINDS.iter().zip(places).any(|(kind, own)| kind.0 == unit.quantity && !own.is_empty())
        }
        _ => false,
    };
    let mut all =
        (0..names.len()).filter(|place| is_given(&names[*place]) && stated[*place].as_ref().is_some_and(is_read));
    all.next().filter(|_| all.next().is_none())
}

/// Units of both sensors, as far as they are known.
pub(super) struct Scaled {
    /// One unit of gyros and of accelerometers in rad/s and m/s².
    pub si: [Option<f64>; 2],
    pub findings: Vec<Finding>,
}

/// Kinds of sensor, with the option of `allan` that states a scale.
const KINDS: [(Quantity, &str); 2] =
    [(Quantity::Gyro, "--gyro-scale"), (Quantity::Accelerometer, "--accelerometer-scale")];

impl Sensors {
    /// Three columns of a sensor by their names. Without any such, the columns whose unit or name is
    /// one of such a sensor, where no other column is a reading: next to a displacement, a force
    /// drives it.
    pub(super) fn of(names: &[String], texts: &[Option<String>]) -> Self {
        let stated: Vec<Option<Stated>> =
            names.iter().zip(texts).map(|(name, text)| roles::stated(name, text.as_deref())).collect();
        let found = roles::of(names);
        let mut places = [found.gyro, found.accelerometer].map(|p| p.map_or(Vec::new(), Vec::from));
        if places.iter().all(Vec::is_empty) {
            let alone = |place: usize| match &stated[place] {
                Some(Stated::Inertial(unit)) if texts[place].is_some() => Some(unit.quantity),
                _ if texts[place].is_some() => None,
                _ => roles::alone(&names[place])
                    .map(|unit| unit.quantity)
                    .or_else(|| roles::alone_without_unit(&names[place])),
            };
            let readings = || {
                (0..names.len())
                    .filter(|place| !roles::is_environment(&names[*place], texts[*place].as_deref()))
                    .filter(|place| !is_given(&names[*place]) || names.iter().all(|name| is_given(name)))
            };
            if readings().all(|place| alone(place).is_some()) {
                places = KINDS.map(|(kind, _)| readings().filter(|place| alone(*place) == Some(kind)).collect());
            }
        }
        let given = given(names, &stated, &places);
        Self { places, given, stated }
    }

    /// Quantity that a column measures.
    pub(super) fn quantity(&self, place: usize) -> Quantity {
        let kind = KINDS.iter().zip(&self.places).find(|(_, places)| places.contains(&place)).map(|(kind, _)| kind.0);
        match (&self.stated[place], kind) {
            (Some(Stated::Inertial(unit)), _) => unit.quantity,
            (_, Some(kind)) => kind,
            _ => Quantity::Unknown,
        }
    }

    /// One unit of each sensor, by what the file states, else by the size of its readings.
    pub(super) fn scaled(&self, names: &[String], rest: &Rest, rate_hz: f64) -> Scaled {
        let mut scaled = Scaled { si: [None; 2], findings: Vec::new() };
        let measured = Measured { length: rest.gravity(rate_hz), walk: rest.walk(rate_hz) };
        for (sensor, (kind, option)) in KINDS.into_iter().enumerate() {
            let columns = || self.places[sensor].iter().map(|place| names[*place].clone()).collect::<Vec<String>>();
            let Some(first) = self.places[sensor].first() else { continue };
            // By gravity's length where a count is of no known size.
            let by_gravity = measured.length.filter(|_| kind == Quantity::Accelerometer).filter(|l| *l > 0.0);
            match &self.stated[*first] {
                Some(Stated::Inertial(unit)) if unit.quantity == kind => scaled.si[sensor] = Some(unit.si),
                Some(Stated::Counts) => {
                    if let Some(per_g) = by_gravity {
                        let (unit, finding) = scale::counted(columns(), per_g);
                        scaled.si[sensor] = Some(unit.si);
                        scaled.findings.push(finding);
                    }
                }
                Some(_) => {}
                None => {
                    let (unit, finding) = scale::assumed(columns(), kind, option, &measured);
                    // Degrees for radians would make rest look like motion.
                    let is_sure = !finding.is_questionable();
                    scaled.si[sensor] = Some(unit.si).filter(|_| is_sure);
                    scaled.findings.push(finding);
                }
            }
        }
        scaled
    }
}
