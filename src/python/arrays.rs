//! Recordings that Python holds: NumPy arrays where they lie, or the path of a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use proofmass_base::error::{Error, Result};
use proofmass_recording::array::Shape;
use proofmass_recording::element::{Element, Kind};
use proofmass_recording::memory::{Memory, Numbers};

/// A recording as the package hands it over.
#[derive(FromPyObject)]
pub(super) enum Given<'py> {
    /// A name for messages, and arrays with the names of their columns (none: 1, 2, …).
    Arrays(String, Vec<(Vec<String>, Bound<'py, PyUntypedArray>)>),
    /// Path of a recording on disk.
    Path(PathBuf),
}

/// A recording that needs no lock of Python's.
pub(super) struct Recorded {
    /// The file, or a name for messages.
    pub path: PathBuf,
    /// Holds what is read in place of a file.
    pub memory: Option<Memory>,
}

impl Given<'_> {
    /// Its place, without a copy of its numbers.
    ///
    /// # Errors
    /// Numbers of a kind that is not read, or no table.
    pub(super) fn recorded(self) -> Result<Recorded> {
        match self {
            Self::Path(path) => Ok(Recorded { path, memory: None }),
            Self::Arrays(name, arrays) => {
                let path = PathBuf::from(name);
                let numbers = arrays.iter().map(|(names, array)| numbers(&path, names, array));
                let memory = Memory::new(&path, numbers.collect::<Result<_>>()?)?;
                Ok(Recorded { path, memory: Some(memory) })
            }
        }
    }
}

fn numbers(path: &Path, names: &[String], array: &Bound<'_, PyUntypedArray>) -> Result<Numbers> {
    let fail = |cause: String, hint: &str| Err(Error::new(format!("could not use {}", path.display()), cause, hint));
    let dtype = array.dtype();
    let (kind, bytes) = (dtype.kind(), dtype.itemsize());
    let kind = match (kind, bytes) {
        (b'f', 2 | 4 | 8) => Kind::Float,
        (b'i', 1 | 2 | 4 | 8) => Kind::Signed,
        (b'u' | b'b', 1 | 2 | 4 | 8) => Kind::Unsigned,
        _ => return fail(format!("its numbers are of dtype {dtype}"), "convert it: array.astype(float)"),
    };
    let big_endian = match dtype.byteorder() {
        b'>' => true,
        b'<' => false,
        _ => cfg!(target_endian = "big"),
    };
    let (rows, columns) = match *array.shape() {
        [rows] => (rows, 1),
        [rows, columns] => (rows, columns),
        ref other => return fail(format!("it has {} dimensions", other.len()), "give one or two: samples × channels"),
    };
    if !array.is_contiguous() {
        return fail("its numbers are not contiguous".into(), "numpy.ascontiguousarray(array)");
    }
    Ok(Numbers {
        names: names.to_vec(),
        element: Element { kind, bytes, big_endian },
        shape: Shape { rows: rows as u64, columns: columns as u64, in_columns: !array.is_c_contiguous() },
        bytes: Arc::new(Kept::of(array, rows * columns * bytes)),
    })
}

/// The bytes of an array that Python keeps as long as this lives.
struct Kept {
    at: *const u8,
    length: usize,
    _array: Py<PyUntypedArray>,
}

impl Kept {
    fn of(array: &Bound<'_, PyUntypedArray>, length: usize) -> Self {
        // SAFETY: the pointer is that of a living array; `data` of an array is never null.
        let at = unsafe { (*array.as_array_ptr()).fields.data }.cast::<u8>().cast_const();
        Self { at, length, _array: array.clone().unbind() }
    }
}

// SAFETY: the bytes are only read, and they stay where they are while the array is held: NumPy
// refuses to resize an array that is referred to from elsewhere.
unsafe impl Send for Kept {}
// SAFETY: as above.
unsafe impl Sync for Kept {}

impl AsRef<[u8]> for Kept {
    fn as_ref(&self) -> &[u8] {
        // SAFETY: the array is contiguous and has this many bytes. A program that writes into it
        // from another thread meanwhile gets the noise of a mixture; the documentation says so.
        unsafe { std::slice::from_raw_parts(self.at, self.length) }
    }
}
