"""A JSON document as attributes, with its lists of numbers as NumPy arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _numeric(value: Any) -> bool:
    """Whether it is a list of numbers, or of lists of numbers of one length; ``None`` is a missing number."""
    if not isinstance(value, list) or not value:
        return False
    if all(isinstance(row, list) for row in value):
        return len({len(row) for row in value}) == 1 and all(map(_numeric, value))
    return any(map(_number, value)) and all(item is None or _number(item) for item in value)


def _table(value: Any) -> bool:
    """Whether it is a list of objects that have the same keys, all of numbers."""
    if not isinstance(value, list) or not value or not all(isinstance(row, dict) and row for row in value):
        return False
    keys = value[0].keys()
    numbers = all(_number(item) or item is None or _numeric(item) for row in value for item in row.values())
    return numbers and all(row.keys() == keys for row in value)


def convert(value: Any) -> Any:
    """Numbers become read-only arrays, objects :class:`Fields`, tables of numbers :class:`Fields` of columns."""
    if _numeric(value):
        import numpy

        array = numpy.array(value, dtype=float)
        array.setflags(write=False)
        return array
    if isinstance(value, dict):
        return Fields(value)
    if _table(value):
        return Fields({key: [row[key] for row in value] for key in value[0]})
    if isinstance(value, list):
        return [convert(item) for item in value]
    return value


class Fields(Mapping):
    """An object of the document: ``fields.key``, ``fields["key"]`` and all of a mapping's methods."""

    def __init__(self, values: dict):
        self._values = values
        self._converted: dict = {}

    def __getitem__(self, key: str) -> Any:
        if key not in self._converted:
            self._converted[key] = convert(self._values[key])
        return self._converted[key]

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            try:
                return self[name]
            except KeyError:
                pass
            known = ", ".join(self._values)
            raise AttributeError(f"`{name}` is not among the fields of this result: {known}")
        raise AttributeError(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fields) and self._values == other._values

    __hash__ = None  # type: ignore[assignment]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._values})

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self._values)})"
