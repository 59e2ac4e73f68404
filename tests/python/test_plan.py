"""Plans: what the command proposes, from a model, a diagnosis and files."""

import numpy
import pytest

import proofmass

MODEL = {
    "kind": "driven", "rate_hz": 200.0, "columns": {"input": "u", "output": "y"},
    "start": {"resonance_hz": 8.0, "damping_ratio": 0.03},
}
TOML = (
    'kind = "driven"\nrate_hz = 200.0\n[columns]\ninput = "u"\noutput = "y"\n[start]\nresonance_hz = 8.0\ndamping_ratio = 0.03\n'
)
LIMITS = {
    "largest_input_m_s2": 2.0, "rate_hz": 200.0, "longest_s": 10.0, "vary": ["sine-ladder", "multisine"],
    "sensor": {"noise": 0.01},
}


def toml(limits):
    top = [f"{key} = {str(value)}".replace("'", '"') for key, value in limits.items() if key != "sensor"]
    return "\n".join(top) + f"\n[sensor]\nnoise = {limits['sensor']['noise']}\n"


def test_a_plan_is_the_commands_and_has_the_input_to_play(command):
    (command.folder / "model.toml").write_text(TOML)
    (command.folder / "limits.toml").write_text(toml(LIMITS))
    told = command.json("plan", "model.toml", "--limits", "limits.toml", "--show", "cubic-stiffness=1%")
    found = proofmass.plan(MODEL, LIMITS, show="cubic-stiffness=1%")

    def without_files(document):
        return {**document, "experiments": [{**one, "file": None} for one in document["experiments"]]}

    assert without_files(found.document) == without_files(told)
    time, played = found.inputs[0]
    assert len(time) == len(played) == found.experiments[0].samples
    assert numpy.abs(played).max() <= 2.0 + 1e-9 and not played.flags.writeable
    assert "<svg" in found.page


def test_a_plan_follows_a_diagnosis_and_tables_say_what_it_decides():
    pandas = pytest.importorskip("pandas")
    rate, omega, zeta = 200.0, 2 * numpy.pi * 8.0, 0.03
    time = numpy.arange(4000) / rate
    drive = numpy.random.default_rng(3).normal(size=4000)
    # x'' = u - 2 zeta omega x' - omega^2 x by its impulse response, a sample late.
    damped = omega * numpy.sqrt(1 - zeta**2)
    response = numpy.exp(-zeta * omega * time) * numpy.sin(damped * time) / damped / rate
    reading = numpy.convolve(drive, response)[:4000]
    reading += 0.001 * reading.std() * numpy.random.default_rng(4).normal(size=4000)
    verdict = proofmass.diagnose({"u": drive, "y": reading}, {key: MODEL[key] for key in ("kind", "rate_hz", "columns")})
    found = proofmass.plan(verdict, {**LIMITS, "sensor": None}, show="quadratic-damping=1%")
    table = found.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and set(table["truth"]) == {"quadratic-damping", "none"}


def test_a_question_that_is_none_is_said():
    with pytest.raises(proofmass.Error, match="leaves no question open"):
        proofmass.plan(MODEL, LIMITS)
    with pytest.raises(proofmass.Error, match="rate_hz"):
        proofmass.plan(MODEL, {**LIMITS, "rate_hz": -1.0}, show="cubic-stiffness=1%")
