"""Recordings as the native half takes them: arrays with the names of their columns, or a path."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Any

from ._error import Error

#: dtypes that are read as they are: kind and bytes.
_READ = {("f", 2), ("f", 4), ("f", 8)} | {(kind, width) for kind in "iu" for width in (1, 2, 4, 8)} | {("b", 1)}


def names(columns: Any) -> list[str]:
    """One name or several; numbers are places, counted from 1."""
    if isinstance(columns, (str, int)):
        columns = [columns]
    return [str(name) for name in columns]


def _array(value: Any) -> Any:
    """An array that can be read where it lies. Copied are arrays with gaps between their numbers, masked ones, whose
    hidden numbers are NaN, dates, which become nanoseconds since 1970, times, which become seconds, and other dtypes."""
    import numpy

    hint = "give numbers; a missing one is NaN"
    try:
        array = numpy.asanyarray(value)
    except ValueError as error:
        raise Error("could not use the array", str(error), hint) from None
    if isinstance(array, numpy.ma.MaskedArray):
        array = numpy.ma.filled(array.astype(float), numpy.nan) if numpy.ma.is_masked(array) else array.data
    array = numpy.asarray(array)
    if array.dtype.kind in "mM" and numpy.isnat(array).any():
        raise Error("could not use the array", "a date or time is missing (NaT)", "leave its rows out")
    if array.dtype.kind == "M":
        array = array.astype("datetime64[ns]").astype("int64")
    elif array.dtype.kind == "m":
        array = array / numpy.timedelta64(1, "s")
    elif array.dtype.kind == "c":
        raise Error("could not use the array", "its numbers are complex", "give array.real, array.imag or abs(array)")
    if (array.dtype.kind, array.dtype.itemsize) not in _READ:
        try:
            array = array.astype(float)
        except (TypeError, ValueError) as error:
            raise Error("could not use the array", f"{error} (dtype {array.dtype})", hint) from None
    if not (array.flags.c_contiguous or array.flags.f_contiguous):
        array = numpy.ascontiguousarray(array)
    return array


def _values(column: Any) -> Any:
    """The values of a column of a table; where pandas has a missing number, NaN."""
    import numpy

    dtype = getattr(column, "dtype", None)
    if getattr(dtype, "na_value", None) is not None and getattr(dtype, "kind", "O") in "fiub":
        return column.to_numpy(dtype=float, na_value=numpy.nan)
    return column.to_numpy() if hasattr(column, "to_numpy") else numpy.asanyarray(column)


def _columns(table: Any, keys: Any) -> list[tuple[list[str], Any]]:
    """The columns of numbers of a table, one array each; a warning names the others."""
    arrays, unread = [], []
    for key in keys:
        try:
            values = _array(_values(table[key]))
        except (Error, TypeError, ValueError):
            unread.append(str(key))
            continue
        if values.ndim == 0:
            cause = f"`{key}` is {values}, not a column"
            raise Error("could not use the recording", cause, "give as many values as there are samples")
        if values.ndim == 1:
            arrays.append(([str(key)], values))
        else:
            arrays.append(([f"{key}.{n + 1}" for n in range(values.shape[1])], values))
    if unread:
        warnings.warn(f"not read, because they are no numbers: {', '.join(unread)}", stacklevel=4)
    return arrays


def _clock(table: Any) -> list[tuple[list[str], Any]]:
    """The index of a table where it holds times: dates, time differences, or numbers under a clock's name."""
    index = getattr(table, "index", None)
    kind = getattr(getattr(index, "dtype", None), "kind", "")
    name = getattr(index, "name", None)
    if name is not None and name in table.columns:
        return []
    word = str(name).lower().partition("_")[0] if name is not None else ""
    if kind in ("M", "m"):
        unnamed = "timestamp_ns" if kind == "M" else "t_s"
        return [([unnamed if name is None else str(name)], _array(_values(index)))]
    if kind in ("f", "i", "u") and word in ("t", "time", "timestamp"):
        return [([str(name)], _array(_values(index)))]
    return []


def recorded(recording: Any) -> Any:
    """One recording."""
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if isinstance(recording, Mapping):
        return "the dictionary", _columns(recording, recording)
    if hasattr(recording, "columns") and hasattr(recording, "__getitem__"):
        return "the DataFrame", _clock(recording) + _columns(recording, recording.columns)
    fields = getattr(getattr(recording, "dtype", None), "names", None)
    if fields:
        return "the array", _columns(recording, fields)
    if hasattr(recording, "name") and hasattr(recording, "to_numpy"):
        named = [str(recording.name)] if recording.name is not None else []
        return "the series", [(named, _array(recording.to_numpy()))]
    return "the array", [([], _array(recording))]


def all_recorded(recordings: Any) -> list:
    """One recording or a list of several; a list of numbers is one."""
    if isinstance(recordings, (list, tuple)) and not any(isinstance(one, (int, float)) for one in recordings):
        return [recorded(one) for one in recordings]
    return [recorded(recordings)]
