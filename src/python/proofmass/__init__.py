"""How far will this inertial sensor drift, which error is to blame, and what physics does the model leave out?

>>> import numpy, proofmass
>>> drift = proofmass.study({"members": 1000, "duration_s": 10.0, "accelerometer": {"bias_mg": {"mean": 0.0, "sd": 1.0}}})
>>> drift.time_s, drift.position_error_m.sd
>>> proofmass.allan(numpy.random.normal(size=100_000), rate_hz=100).to_dataframe()

Results have the names of the command's ``--json`` documents; NumPy arrays hold their numbers, and in a notebook they show
their page. Arrays are read where they lie: contiguous ones (C or Fortran order, integers or floats of any width) are never
copied, others are made contiguous first. Do not write into an array while it is being read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._error import Error

if TYPE_CHECKING:
    from ._results import Allan, Check, Diagnosis, Plan, Simulation, Study

__all__ = ["Error", "allan", "check", "diagnose", "main", "plan", "simulate", "study"]


def study(
    study: Any = None,
    *,
    members: int | None = None,
    seed: int | None = None,
    preset: str | None = None,
    set: dict | None = None,
    backend: str = "auto",
) -> Study:
    """Simulates an ensemble and says how far it drifts: ``proofmass study``.

    ``study`` is a dictionary with the keys of study.toml or the path of such a file; without one, the default study.
    ``set`` changes keys by their dotted path, ``{"gyro.bias_deg_h": 4}``; ``backend`` is "auto", "gpu" or "cpu".
    """
    from . import _proofmass
    from ._results import Study

    changes = {"members": members, "seed": seed, "preset": preset, "set": set}
    return Study(_proofmass.study(study, changes, backend))


def simulate(
    study: Any = None,
    *,
    members: int = 1,
    seed: int | None = None,
    preset: str | None = None,
    set: dict | None = None,
) -> Simulation:
    """Readings of the first ``members`` sensors of a study, as they would have been logged: ``proofmass study --samples``.

    ``study``, ``preset`` and ``set`` as for :func:`study`. Of a still start, too, every sample is given.
    """
    from . import _proofmass
    from ._results import Simulation

    changes = {"members": None, "seed": seed, "preset": preset, "set": set}
    return Simulation(_proofmass.simulate(study, changes, members))


def allan(
    recording: Any,
    rate_hz: float | None = None,
    *,
    columns: Any = (),
    time: str | None = None,
    gyro: Any = (),
    gyro_scale: str | None = None,
    accelerometer: Any = (),
    accelerometer_scale: str | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    topic: str | None = None,
    force_rate: bool = False,
) -> Allan:
    """The noise of a sensor at rest: Allan deviations and the coefficients that they support, ``proofmass allan``.

    ``recording`` is an array (samples, or samples × channels), a DataFrame, a dictionary of arrays, or the path of a file.
    An index of times is the clock of a DataFrame. Columns of an array are called 1, 2, …; ``gyro`` and ``accelerometer`` name those of a sensor and ``…_scale`` their
    unit: "mg", "deg/s", "0.05deg/s"; without one, the unit that the heading states holds, else rad/s and m/s². A
    ``rate_hz`` that contradicts the recording's own clock is an error unless ``force_rate``.
    """
    from . import _proofmass
    from ._recording import names, recorded
    from ._results import Allan

    request = {
        "topic": topic, "columns": names(columns), "rate_hz": rate_hz, "force_rate": force_rate, "time": time, "from_s": from_s, "to_s": to_s,
    }
    scales = {
        "gyro": names(gyro), "gyro_scale": gyro_scale,
        "accelerometer": names(accelerometer), "accelerometer_scale": accelerometer_scale,
    }
    return Allan(_proofmass.allan(recorded(recording), request, scales))


def diagnose(
    recording: Any,
    model: Any,
    *,
    test: Any = (),
    from_s: float | None = None,
    to_s: float | None = None,
    topic: str | None = None,
    trace: bool = False,
) -> Diagnosis:
    """What physics a model of a recording leaves out: ``proofmass diagnose``.

    ``recording`` is a DataFrame, an array, a dictionary of arrays or the path of a file, or a list of several that are
    fitted together; ``test`` only judge. ``model`` is a dictionary with the keys of model.toml or the path of such a file.
    With ``trace`` the verdict lists which rules acted, what each changed and on what number.
    """
    from . import _proofmass
    from ._recording import all_recorded
    from ._results import Diagnosis

    part = {"topic": topic, "from_s": from_s, "to_s": to_s, "trace": trace}
    return Diagnosis(_proofmass.diagnose(all_recorded(recording), all_recorded(test), model, part))


def check(
    recording: Any,
    model: Any,
    *,
    from_s: float | None = None,
    to_s: float | None = None,
    topic: str | None = None,
) -> Check:
    """Whether a recording can be trusted: ``proofmass check``.

    ``recording`` is a DataFrame, an array, a dictionary of arrays or the path of a file, which is compared by its halves, or
    a list of several of one sensor, which are compared with one another. ``model`` as for :func:`diagnose`.
    """
    from . import _proofmass
    from ._recording import all_recorded
    from ._results import Check

    part = {"topic": topic, "from_s": from_s, "to_s": to_s, "trace": False}
    return Check(_proofmass.check(all_recorded(recording), model, part))


def plan(
    question: Any,
    limits: Any,
    *,
    show: str | None = None,
    probability: float = 0.95,
    confirm: int = 0,
) -> Plan:
    """The next experiment: ``proofmass plan``.

    ``question`` is what :func:`diagnose` gave, a model that ``show`` names a law for (``"cubic-stiffness=1%"``), or the path
    of verdict.json or model.toml. ``limits`` is a dictionary with the keys of limits.toml or the path of such a file.
    """
    from . import _proofmass
    from ._results import Diagnosis, Plan

    wanted = {
        "verdict": question._answer.json if isinstance(question, Diagnosis) else None,
        "given": None if isinstance(question, Diagnosis) else question,
        "show": show, "probability": probability, "confirm": confirm,
    }
    return Plan(*_proofmass.plan(wanted, limits))


def main() -> None:
    """The command ``proofmass``; ends the process with the command's exit code."""
    import os
    import signal
    import sys

    # Signals are the command's own, as in the program without Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Silences a line that Mesa's device selection prints on machines without a desktop.
    os.environ["NODEVICE_SELECT"] = "1"
    from . import _proofmass

    sys.exit(_proofmass.main(sys.argv))


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("proofmass")
    if name in ("Allan", "Check", "Diagnosis", "Plan", "Simulation", "Study"):
        from . import _results

        return getattr(_results, name)
    raise AttributeError(f"module 'proofmass' has no attribute '{name}'")
