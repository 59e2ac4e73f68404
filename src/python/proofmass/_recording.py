"""Recordings as the native half takes them: arrays with the names of their columns, or a path."""

from __future__ import annotations

import os
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
    """An array that can be read where it lies. Copied are arrays with gaps between their numbers, and other dtypes."""
    import numpy

    array = numpy.asarray(value)
    if (array.dtype.kind, array.dtype.itemsize) not in _READ:
        try:
            array = array.astype(float)
        except (TypeError, ValueError) as error:
            hint = "give numbers; a missing one is NaN"
            raise Error("could not use the array", f"{error} (dtype {array.dtype})", hint) from None
    if not (array.flags.c_contiguous or array.flags.f_contiguous):
        array = numpy.ascontiguousarray(array)
    return array


def _columns(table: Any, keys: Any) -> list[tuple[list[str], Any]]:
    """The columns of numbers of a table, one array each."""
    import numpy

    arrays = []
    for key in keys:
        column = table[key]
        values = column.to_numpy() if hasattr(column, "to_numpy") else numpy.asarray(column)
        if values.dtype.kind in "fiub":
            if values.ndim == 1:
                arrays.append(([str(key)], _array(values)))
            else:
                arrays.append(([f"{key}.{n + 1}" for n in range(values.shape[1])], _array(values)))
    return arrays


def recorded(recording: Any) -> Any:
    """One recording."""
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if isinstance(recording, dict):
        return "the dictionary", _columns(recording, recording)
    if hasattr(recording, "columns") and hasattr(recording, "__getitem__"):
        return "the DataFrame", _columns(recording, recording.columns)
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
