"""Diagnoses: the verdict of the command, from arrays and from files."""

import json

import numpy
import pytest

import proofmass

MODEL = {"kind": "static", "rate_hz": 100.0, "columns": {"channels": ["ax"]}}
TOML = 'kind = "static"\nrate_hz = 100.0\n[columns]\nchannels = ["ax"]\n'


def at_rest(amplitude):
    """White noise of unit deviation and a sine of 3 Hz."""
    random = numpy.random.default_rng(7)
    return random.normal(size=8192) + amplitude * numpy.sin(2 * numpy.pi * 3.0 * numpy.arange(8192) / 100.0)


def comparable(document):
    recording = {key: value for key, value in document["recording"].items() if key not in ("file", "sha256")}
    document = {**document, "recording": recording}
    document["fit"] = {key: value for key, value in document["fit"].items() if key != "recordings"}
    return json.loads(json.dumps(document))


def test_a_sine_is_named_and_the_digits_are_the_commands(command):
    values = at_rest(0.5)
    (command.folder / "log.csv").write_text("ax\n" + "\n".join(map(repr, map(float, values))) + "\n")
    (command.folder / "model.toml").write_text(TOML)
    told = command.json("diagnose", "log.csv", "--model", "model.toml")
    found = proofmass.diagnose({"ax": values}, MODEL)
    assert found.verdict == "explained" and [effect.id for effect in found.effects] == ["sinusoid"]
    assert comparable(found.document) == comparable(told)
    by_path = proofmass.diagnose(command.folder / "log.csv", command.folder / "model.toml")
    assert comparable(by_path.document) == comparable(told)
    planted = {"amplitude": 0.5, "frequency": 3.0}
    for parameter in found.effects[0].parameters:
        # An interval of 95 % holds the truth or misses it by a little: one and a half of its width, here.
        half = (parameter.ci95[1] - parameter.ci95[0]) / 2
        assert abs(parameter.value - planted.get(parameter.name, parameter.value)) < 1.5 * half
    assert "sine" in found.page and found._repr_html_().startswith("<iframe")


def test_nothing_is_named_where_nothing_is_left_out():
    assert proofmass.diagnose({"ax": at_rest(0.0)}, MODEL).effects == []


def test_frames_arrays_and_tables():
    pandas = pytest.importorskip("pandas")
    values = at_rest(0.5)
    from_frame = proofmass.diagnose(pandas.DataFrame({"ax": values, "note": "x"}), MODEL)
    unnamed = {**MODEL, "columns": {"channels": ["1"]}}
    from_array = proofmass.diagnose(values, unnamed)
    assert from_frame.verdict == from_array.verdict == "explained"
    table = from_frame.to_dataframe()
    assert set(table["effect"]) == {"sinusoid"} and table["unit"].notna().all()


def test_a_model_that_is_wrong_is_said():
    with pytest.raises(proofmass.Error) as said:
        proofmass.diagnose({"ax": at_rest(0.0)}, {**MODEL, "columns": {"chanels": ["ax"]}})
    assert "`channels`" in said.value.hint
    with pytest.raises(proofmass.Error) as said:
        proofmass.diagnose({"bx": at_rest(0.0)}, MODEL)
    assert "ax" in said.value.cause
