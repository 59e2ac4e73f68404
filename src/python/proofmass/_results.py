"""What a computation gives: its document as attributes, its page for a notebook, its tables for pandas and xarray."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ._fields import Fields


def _pandas() -> Any:
    try:
        import pandas  # type: ignore[import-untyped, unused-ignore]
    except ImportError as error:
        from ._error import Error

        raise Error("could not make a DataFrame", "pandas is not installed", "pip install pandas") from error
    return pandas


def _xarray() -> Any:
    try:
        import xarray
    except ImportError as error:
        from ._error import Error

        raise Error("could not make a Dataset", "xarray is not installed", "pip install xarray") from error
    return xarray


class Result(Fields):
    """The JSON document that the command prints with ``--json``: every key is an attribute and an item.

    Lists of numbers are read-only NumPy arrays. ``document`` is the plain ``dict``, ``page`` the report as HTML.
    """

    def __init__(self, answer: Any):
        self._answer = answer
        super().__init__(json.loads(answer.json))

    @property
    def document(self) -> dict:
        """The document itself, as plain Python objects."""
        return self._values

    @property
    def page(self) -> str:
        """The report: one self-contained HTML page."""
        return self._answer.page()

    def save(self, path: Any) -> None:
        """Writes the page; a file of that name is replaced."""
        Path(path).write_text(self.page, encoding="utf-8")

    def _repr_html_(self) -> str:
        style = "width:100%;height:40em;border:1px solid #8884"
        return f'<iframe sandbox="allow-scripts" srcdoc="{html.escape(self.page)}" style="{style}"></iframe>'


class Study(Result):
    """How far the sensors of a study drift; every array runs along ``time_s``."""

    def to_dataframe(self) -> Any:
        """One row per report time: ``position_error_m.sd`` and so on, with the closed forms beside them."""
        columns: dict = {}

        def gather(name: str, value: Any) -> None:
            if isinstance(value, dict):
                for key, inner in value.items():
                    gather(f"{name}.{key}" if name else key, inner)
            elif isinstance(value, list) and len(value) == len(self._values["time_s"]):
                if all(isinstance(item, (int, float)) for item in value):
                    columns[name] = value

        gather("", {key: value for key, value in self._values.items() if key != "time_s"})
        index = _pandas().Index(self._values["time_s"], name="time_s")
        return _pandas().DataFrame(columns, index=index)

    def to_xarray(self) -> Any:
        """The same as a Dataset along ``time_s``."""
        return _xarray().Dataset.from_dataframe(self.to_dataframe())


class Allan(Result):
    """The noise of a sensor at rest, channel by channel: ``allan.channels[0].curve.tau_s``."""

    def channel(self, name: Any) -> Fields:
        """The channel of this name (columns without names are called 1, 2, …)."""
        names = [channel["name"] for channel in self._values["channels"]]
        if str(name) not in names:
            raise KeyError(f"`{name}` is no channel; there are {', '.join(names)}")
        return self.channels[names.index(str(name))]

    def to_dataframe(self) -> Any:
        """One row per channel and averaging time: the Allan deviation with its 95 % interval."""
        rows = [
            (channel["name"], point["tau_s"], point["deviation"], *point["ci95"], point["degrees_of_freedom"])
            for channel in self._values["channels"]
            for point in channel["curve"]
        ]
        names = ["channel", "tau_s", "deviation", "ci95_low", "ci95_high", "degrees_of_freedom"]
        return _pandas().DataFrame(rows, columns=names)

    def to_xarray(self) -> Any:
        """The same as a Dataset along ``channel`` and ``tau_s``, ``NaN`` where a channel has no such averaging time."""
        return _xarray().Dataset.from_dataframe(self.to_dataframe().set_index(["channel", "tau_s"]))

    def coefficients(self) -> Any:
        """A DataFrame with one row per channel and noise term; ``supported`` says whether the data show the term."""
        rows = [
            (channel["name"], term["symbol"], term["name"], term["value"], *term["ci95"], term["unit"], term["supported"])
            for channel in self._values["channels"]
            for term in channel["terms"]
            if term
        ]
        names = ["channel", "symbol", "name", "value", "ci95_low", "ci95_high", "unit", "supported"]
        return _pandas().DataFrame(rows, columns=names)


class Diagnosis(Result):
    """What physics a model of a recording leaves out: the verdict, ``verdict.json`` of the command."""

    @property
    def repaired(self) -> str | None:
        """The sensor with the named physics as a study.toml; ``None`` where there is none that a study could run."""
        return self._answer.toml

    def to_dataframe(self) -> Any:
        """One row per named effect and parameter."""
        rows = [
            (effect["id"], ", ".join(effect["channels"]), parameter["name"], parameter["value"], *parameter["ci95"],
             parameter["unit"], effect["evidence"]["held_out_gain"], effect["evidence"]["p_value"])
            for effect in self._values["effects"]
            for parameter in effect["parameters"]
        ]
        names = ["effect", "channels", "parameter", "value", "ci95_low", "ci95_high", "unit", "held_out_gain", "p_value"]
        return _pandas().DataFrame(rows, columns=names)


class Check(Result):
    """Whether recordings can be trusted: what each can know, and whether they say the same; ``check.json`` of the command."""

    @property
    def sensor(self) -> str | None:
        """The sensor with its spread from run to run as a sensor.toml; ``None`` where nothing was compared that a study has."""
        return self._answer.toml

    def to_dataframe(self) -> Any:
        """One row per recording and parameter, ``NaN`` where it is not determined."""
        rows = [
            (recording["file"], parameter["name"], parameter["value"], *(parameter["ci95"] or (None, None)),
             parameter["unit"], parameter["determined"])
            for recording in self._values["recordings"]
            for parameter in recording["parameters"]
        ]
        names = ["file", "parameter", "value", "ci95_low", "ci95_high", "unit", "determined"]
        return _pandas().DataFrame(rows, columns=names)

    def agreement_to_dataframe(self) -> Any:
        """One row per parameter that was compared: the difference, or of sizes the ratio, and whether it is chance."""
        compared = (self._values["agreement"] or {"parameters": []})["parameters"]
        rows = [
            (line["name"], line["difference"], line["ratio"], *line["ci95"], line["unit"], line["p_value"], line["agrees"])
            for line in compared
        ]
        names = ["parameter", "difference", "ratio", "ci95_low", "ci95_high", "unit", "p_value", "agrees"]
        return _pandas().DataFrame(rows, columns=names)


class Plan(Result):
    """The next experiment and the next best: what each decides, ``plan.json`` of the command."""

    def __init__(self, answer: Any, inputs: list):
        for array in (array for pair in inputs for array in pair):
            array.setflags(write=False)
        self._inputs = inputs
        super().__init__(answer)

    @property
    def inputs(self) -> list:
        """What to play, for each of ``experiments``: time in s, and the input, an array each."""
        return self._inputs

    def to_dataframe(self) -> Any:
        """One row per experiment and truth: how probably that truth is decided."""
        rows = [
            (experiment["kind"], experiment["seconds"], experiment["samples"], experiment["level_m_s2"], truth["id"], truth["decides"])
            for experiment in self._values["experiments"]
            for truth in experiment["between"]
        ]
        return _pandas().DataFrame(rows, columns=["kind", "seconds", "samples", "level_m_s2", "truth", "decides"])


class Simulation(Mapping):
    """Simulated readings: an array per column of the recording, by its name.

    ``time_s`` is the clock; columns of one quantity stand together too, members × samples: ``gyro_rad_s``,
    ``accelerometer_m_s2``.
    """

    def __init__(self, columns: list):
        self._columns = dict(columns)
        self._stacked: dict = {}
        for name, values in columns:
            values.setflags(write=False)
            quantity = re.sub(r"_\d+_", "_", name, count=1)
            self._stacked.setdefault(quantity, []).append(values)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def time_s(self) -> Any:
        """Time of each sample, s."""
        return self._columns["t_s"]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._stacked:
            raise AttributeError(f"`{name}` is no quantity of this simulation")
        import numpy

        array = numpy.stack(self._stacked[name])
        array.setflags(write=False)
        setattr(self, name, array)
        return array

    def to_dataframe(self) -> Any:
        """One row per sample and one column per member and quantity."""
        return _pandas().DataFrame(self._columns).set_index("t_s")

    def to_xarray(self) -> Any:
        """A Dataset of the quantities along ``member`` and ``time_s``."""
        quantities = {name: (("member", "time_s"), getattr(self, name)) for name in self._stacked if name != "t_s"}
        return _xarray().Dataset(quantities, coords={"time_s": self.time_s})

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"Simulation({', '.join(self._columns)})"
