"""Checks: what the command says of halves and of several recordings, from arrays and from files."""

import numpy
import pytest

import proofmass

MODEL = {"kind": "static", "rate_hz": 100.0, "columns": {"channels": ["gx", "gy", "gz"]}}
TOML = 'kind = "static"\nrate_hz = 100.0\n[columns]\nchannels = ["gx", "gy", "gz"]\n'


def at_rest(seed, mean=0.0):
    """Three gyros with white noise of unit deviation."""
    values = mean + numpy.random.default_rng(seed).normal(size=(3, 16384))
    return dict(zip(["gx", "gy", "gz"], values))


def without_files(document):
    recordings = [{key: value for key, value in one.items() if key != "file"} for one in document["recordings"]]
    told = {key: value for key, value in document.items() if key not in ("answer", "next", "recordings")}
    return {**told, "recordings": recordings}


def test_halves_agree_and_the_digits_are_the_commands(command):
    log = at_rest(1)
    rows = numpy.column_stack(list(log.values())).tolist()
    text = "gx,gy,gz\n" + "\n".join(",".join(map(repr, row)) for row in rows) + "\n"
    (command.folder / "log.csv").write_text(text)
    (command.folder / "model.toml").write_text(TOML)
    told = command.json("check", "log.csv", "--model", "model.toml")
    found = proofmass.check(log, MODEL)
    assert found.compared == "halves" and found.agreement.joint.agrees
    assert without_files(found.document) == without_files(told)
    assert "<svg" in found.page and found._repr_html_().startswith("<iframe")


def test_the_odd_recording_is_found_and_tables_say_so():
    pandas = pytest.importorskip("pandas")
    found = proofmass.check([at_rest(1), at_rest(2), at_rest(3), at_rest(4, mean=1.0)], MODEL)
    assert found.compared == "recordings" and not found.agreement.joint.agrees
    table = found.agreement_to_dataframe()
    assert isinstance(table, pandas.DataFrame)
    assert not table.set_index("parameter").loc["gx mean", "agrees"]
    determined = found.to_dataframe().query("determined == 'well' and parameter == 'gx mean'")
    assert len(determined) == 4 and determined["ci95_low"].notna().all()


def test_a_kind_that_is_not_checked_is_said():
    model = {"kind": "driven", "columns": {"input": "u", "output": "x"}, "rate_hz": 100.0}
    log = {"u": numpy.sin(numpy.arange(4096)), "x": numpy.cos(numpy.arange(4096))}
    with pytest.raises(proofmass.Error, match="driven"):
        proofmass.check(log, model)
