//! Propose the model of a proof mass: which column drives it, which is read, and what is read of it.

use super::parts::{Named, environment, refused};
use crate::document::toml_string;
use crate::error::Result;
use crate::escape::word;
use crate::recording::inspection::{Column, Rows};

/// Words in a heading that say which end of a proof mass it is.
const INPUTS: [&str; 10] =
    ["input", "in", "u", "force", "drive", "excitation", "control", "command", "torque", "kraft"];
const OUTPUTS: [&str; 13] = [
    "output",
    "out",
    "y",
    "x",
    "displacement",
    "position",
    "deflection",
    "response",
    "reading",
    "angle",
    "roll",
    "velocity",
    "weg",
];

fn says(column: &Column, words: &[&str]) -> bool {
    let lower = column.name.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
}

/// The input and the output among these columns; no input where a single column decays.
pub(super) fn driven(file: &str, rows: &Rows, named: &Named) -> Result<String> {
    let columns: Vec<&Column> = rows.columns.iter().filter(|c| !c.is_environment).collect();
    let known = |name: &Option<String>| match name {
        Some(name) => match rows.columns.iter().find(|c| c.name == *name) {
            Some(column) => Ok(Some(column)),
            None => {
                let there: Vec<&str> = rows.columns.iter().map(|c| c.name.as_str()).collect();
                Err(refused(
                    file,
                    format!("it has no column `{name}`"),
                    format!("its columns of numbers are: {}", there.join(", ")),
                ))
            }
        },
        None => Ok(None),
    };
    let (input, output) = (known(&named.input)?, known(&named.output)?);
    let one = |words: &[&str], taken: Option<&Column>| -> Option<&Column> {
        let mut all = columns.iter().filter(|c| says(c, words) && taken != Some(**c));
        all.next().filter(|_| all.next().is_none()).copied()
    };
    let other = |taken: &Column| columns.iter().find(|c| **c != taken).filter(|_| columns.len() == 2).copied();
    let by_name = match (input, output) {
        (None, None) if rows.given.is_some() => followed(rows).unzip(),
        (None, None) if columns.len() == 1 => return Ok(of_driven(None, columns[0], rows)),
        (None, None) => (one(&INPUTS, None), one(&OUTPUTS, None)),
        (Some(input), None) => (Some(input), one(&OUTPUTS, Some(input))),
        // An output alone, asked for as such, is a free decay unless a force is recorded with it.
        (None, Some(output)) => match one(&INPUTS, Some(output)) {
            None => return Ok(of_driven(None, output, rows)),
            input => (input, Some(output)),
        },
        both => both,
    };
    let pair = match by_name {
        (Some(input), Some(output)) if input != output => Some((input, output)),
        (Some(input), None) => other(input).map(|output| (input, output)),
        (None, Some(output)) => other(output).map(|input| (input, output)),
        _ => None,
    };
    match (pair, &columns[..]) {
        (Some((input, output)), _) => Ok(of_driven(Some(input), output, rows)),
        (None, [first, second]) => {
            let said = format!("`{}` and `{}` may each be the input: neither heading says so", first.name, second.name);
            let [a, b, subject] = [&first.name, &second.name, file].map(word);
            Err(refused(
                file,
                said,
                format!(
                    "proofmass diagnose {subject} --input {a} --output {b}, or proofmass diagnose {subject} --input {b} --output {a}; \
                     of a sensor at rest, neither: --model with kind = \"static\" (`proofmass template static`)"
                ),
            ))
        }
        (None, []) => Err(refused(
            file,
            "its columns are the surroundings of a sensor, and none is a reading".into(),
            "record these columns with the sensor's readings, and name them under environment in [columns] of its model".into(),
        )),
        (None, several) => {
            let names: Vec<&str> = several.iter().map(|c| c.name.as_str()).collect();
            let subject = word(file);
            Err(refused(
                file,
                format!("the headings of its {} columns do not say which are a sensor's readings", several.len()),
                format!(
                    "of a proof mass, name the force and the reading: proofmass diagnose {subject} --input COLUMN --output \
                     COLUMN; of an inertial sensor, its axes: proofmass allan {subject} --gyro X,Y,Z --accelerometer X,Y,Z; \
                     the columns are {}",
                    names.join(", ")
                ),
            ))
        }
    }
}

/// The motion that was given, and the axis of its sensor that follows it most.
fn followed(rows: &Rows) -> Option<(&Column, &Column)> {
    let given = &rows.columns[rows.given?];
    let axes = rows.sensors.iter().flatten().map(|place| &rows.columns[*place]);
    let most = axes.filter(|c| c.quantity == given.quantity).max_by(|a, b| a.deviation.total_cmp(&b.deviation));
    Some((given, most?))
}

/// Words and units of velocities and of accelerations.
const VELOCITY: (&[&str], &[&str]) =
    (&["velocity", "vel", "speed"], &["m/s", "mm/s", "um/s", "µm/s", "in/s", "rad/s", "°/s"]);
const ACCELERATION: (&[&str], &[&str]) = (&["acceleration", "accel", "acc"], &["m/s²", "mm/s²", "g", "mg"]);
const FORCE: (&[&str], &[&str]) = (&["force"], &["N", "mN", "kN", "lbf"]);

/// The key that states what is read of a mass, where the headings say it: its velocity, or next to a force
/// its acceleration. An accelerometer's reading is its proof mass' displacement, whatever it is called.
fn read_of_the_mass(input: Option<&Column>, output: &Column) -> &'static str {
    let is = |column: &Column, (words, units): (&[&str], &[&str])| {
        says(column, words) || column.stated.as_deref().is_some_and(|unit| units.contains(&unit))
    };
    let drives = |what: (&[&str], &[&str])| input.is_some_and(|input| is(input, what));
    if is(output, VELOCITY) && !drives(VELOCITY) {
        "output_is = \"velocity\"\n"
    } else if is(output, ACCELERATION) && drives(FORCE) {
        "output_is = \"acceleration\"\n"
    } else {
        ""
    }
}

fn of_driven(input: Option<&Column>, output: &Column, rows: &Rows) -> String {
    let is = read_of_the_mass(input, output);
    let input = input.map_or(String::new(), |c| format!("input = {}\n", toml_string(&c.name)));
    format!("kind = \"driven\"\n{is}[columns]\n{input}output = {}\n{}", toml_string(&output.name), environment(rows))
}
