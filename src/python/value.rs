//! Dictionaries of Python as TOML: a study or a model that was never a file.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyString};
use toml::{Table, Value};

use proofmass_base::error::{Error, Result};

/// A document: the path of a file, or a dictionary.
#[derive(FromPyObject)]
pub(super) enum Document<'py> {
    /// A dictionary with the keys of the file.
    Table(Bound<'py, PyDict>),
    /// Path of a TOML file.
    Path(PathBuf),
}

/// So deep may values lie in each other, as in a file of TOML; what holds itself lies deeper.
const DEEPEST: usize = 80;

/// A dictionary as a table; a key without a value (`None`) is left out.
///
/// # Errors
/// A value that TOML has no word for, with its key; one that holds itself.
pub(super) fn table(dictionary: &Bound<'_, PyDict>, within: &str) -> Result<Table> {
    table_within(dictionary, within, 0)
}

fn table_within(dictionary: &Bound<'_, PyDict>, within: &str, depth: usize) -> Result<Table> {
    let mut table = Table::new();
    for (key, value) in dictionary.iter().filter(|(_, value)| !value.is_none()) {
        let key: String = key.extract().map_err(|_| refused(within, &format!("the key {key} is not a word")))?;
        let whole = if within.is_empty() { key.clone() } else { format!("{within}.{key}") };
        table.insert(key, value_within(&value, &whole, depth + 1)?);
    }
    Ok(table)
}

/// One value; `key` stands in messages.
///
/// # Errors
/// As [`table`].
pub(super) fn one(value: &Bound<'_, PyAny>, key: &str) -> Result<Value> {
    value_within(value, key, 0)
}

fn value_within(value: &Bound<'_, PyAny>, key: &str, depth: usize) -> Result<Value> {
    if depth > DEEPEST {
        let top = key.split('.').next().unwrap_or_default();
        return Err(refused(top, &format!("values lie in each other more than {DEEPEST} deep: does one hold itself?")));
    }
    if let Ok(dictionary) = value.cast::<PyDict>() {
        return Ok(Value::Table(table_within(dictionary, key, depth)?));
    }
    if value.is_instance_of::<PyBool>() {
        return value.extract().map(Value::Boolean).map_err(|e| refused(key, &e.to_string()));
    }
    if value.is_instance_of::<PyString>() {
        return value.extract().map(Value::String).map_err(|e| refused(key, &e.to_string()));
    }
    if value.is_instance_of::<PyFloat>() {
        return value.extract().map(Value::Float).map_err(|e| refused(key, &e.to_string()));
    }
    // Arrays and scalars of NumPy.
    if let Ok(plain) = value.call_method0("tolist") {
        return value_within(&plain, key, depth + 1);
    }
    if let Ok(whole) = value.extract::<i64>() {
        return Ok(Value::Integer(whole));
    }
    if let Ok(items) = value.try_iter() {
        let items = items.map(|item| value_within(&item.map_err(|e| refused(key, &e.to_string()))?, key, depth + 1));
        return Ok(Value::Array(items.collect::<Result<_>>()?));
    }
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok(Value::String(path.to_string_lossy().into_owned()));
    }
    let kind = value.get_type().to_string();
    Err(refused(key, &format!("a {kind} is not a TOML value")))
}

fn refused(key: &str, cause: &str) -> Error {
    let cause = if key.is_empty() { cause.to_owned() } else { format!("`{key}`: {cause}") };
    Error::new("could not read the dictionary", cause, "give numbers, words, lists and dictionaries")
}
