from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Union

from numpy import float64
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, PathLike[str]]
_Array = NDArray[float64]
_Names = Union[str, int, Sequence[Union[str, int]]]

__version__: str

class Error(Exception):
    attempt: str
    cause: str
    hint: str
    def __init__(self, attempt: str, cause: str, hint: str) -> None: ...

class _Fields(Mapping[str, Any]):
    def __getitem__(self, key: str) -> Any: ...
    def __getattr__(self, name: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

class _Result(_Fields):
    @property
    def document(self) -> dict[str, Any]: ...
    @property
    def page(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def to_dataframe(self) -> Any: ...

class _Distribution(_Fields):
    mean: _Array
    sd: _Array
    min: _Array
    max: _Array
    p01: _Array
    p05: _Array
    p50: _Array
    p95: _Array
    p99: _Array

class Study(_Result):
    name: str
    seed: int
    members: int
    failed: int
    time_s: _Array
    position_error_m: _Distribution
    velocity_error_m_s: _Distribution
    acceleration_error_m_s2: _Distribution
    tilt_error_rad: _Distribution
    closed_form: _Fields
    error_budget: list[_Fields]
    findings: list[str]
    def to_xarray(self) -> Any: ...

class _Curve(_Fields):
    tau_s: _Array
    deviation: _Array
    ci95: _Array
    degrees_of_freedom: _Array

class _Channel(_Fields):
    name: str
    quantity: str
    unit: str
    terms: list[Any]
    curve: _Curve
    statements: list[str]

class Allan(_Result):
    recording: _Fields
    findings: list[str]
    channels: list[_Channel]
    def channel(self, name: Union[str, int]) -> _Channel: ...
    def coefficients(self) -> Any: ...
    def to_xarray(self) -> Any: ...

class Diagnosis(_Result):
    kind: str
    verdict: str
    sentence: str
    effects: list[_Fields]
    fit: _Fields
    findings: list[str]
    next_experiment: str
    @property
    def repaired(self) -> Union[str, None]: ...

class Check(_Result):
    answer: str
    recordings: list[_Fields]
    compared: Union[str, None]
    agreement: Union[_Fields, None]
    next: list[str]
    @property
    def sensor(self) -> Union[str, None]: ...
    def agreement_to_dataframe(self) -> Any: ...

class Plan(_Result):
    answer: str
    purpose: str
    rivals: list[_Fields]
    reached: bool
    experiments: list[_Fields]
    def __init__(self, answer: Any, inputs: list[tuple[_Array, _Array]]) -> None: ...
    @property
    def inputs(self) -> list[tuple[_Array, _Array]]: ...

class Simulation(Mapping[str, _Array]):
    accelerometer_m_s2: _Array
    gyro_rad_s: _Array
    def __init__(self, columns: list[tuple[str, _Array]]) -> None: ...
    @property
    def time_s(self) -> _Array: ...
    def __getitem__(self, name: str) -> _Array: ...
    def __getattr__(self, name: str) -> _Array: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def to_dataframe(self) -> Any: ...
    def to_xarray(self) -> Any: ...

def study(
    study: Union[dict[str, Any], _Path, None] = None,
    *,
    members: Union[int, None] = None,
    seed: Union[int, None] = None,
    preset: Union[str, None] = None,
    set: Union[dict[str, Any], None] = None,
    backend: str = "auto",
) -> Study: ...
def simulate(
    study: Union[dict[str, Any], _Path, None] = None,
    *,
    members: int = 1,
    seed: Union[int, None] = None,
    preset: Union[str, None] = None,
    set: Union[dict[str, Any], None] = None,
) -> Simulation: ...
def allan(
    recording: Union[ArrayLike, Mapping[str, ArrayLike], _Path, Any],
    rate_hz: Union[float, None] = None,
    *,
    columns: _Names = (),
    time: Union[str, None] = None,
    gyro: _Names = (),
    gyro_scale: Union[str, None] = None,
    accelerometer: _Names = (),
    accelerometer_scale: Union[str, None] = None,
    from_s: Union[float, None] = None,
    to_s: Union[float, None] = None,
    topic: Union[str, None] = None,
    force_rate: bool = False,
) -> Allan: ...
def diagnose(
    recording: Any,
    model: Union[dict[str, Any], _Path],
    *,
    test: Any = (),
    from_s: Union[float, None] = None,
    to_s: Union[float, None] = None,
    topic: Union[str, None] = None,
    trace: bool = False,
) -> Diagnosis: ...
def check(
    recording: Any,
    model: Union[dict[str, Any], _Path],
    *,
    from_s: Union[float, None] = None,
    to_s: Union[float, None] = None,
    topic: Union[str, None] = None,
) -> Check: ...
def plan(
    question: Union[Diagnosis, dict[str, Any], _Path],
    limits: Union[dict[str, Any], _Path],
    *,
    show: Union[str, None] = None,
    probability: float = 0.95,
    confirm: int = 0,
) -> Plan: ...
def main() -> None: ...
