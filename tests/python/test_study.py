"""Studies: the numbers of the command, and of the closed forms."""

import numpy
import pytest

import proofmass

BIAS = {
    "name": "bias",
    "members": 4096,
    "duration_s": 10.0,
    "accelerometer": {"bias_mg": {"mean": 0.0, "sd": 1.0}},
    "report": {"times_s": numpy.array([1.0, 5.0, 10.0])},
}
TOML = """
name = "bias"
members = 4096
duration_s = 10.0
[accelerometer]
bias_mg = { mean = 0.0, sd = 1.0 }
[report]
times_s = [1.0, 5.0, 10.0]
"""


def without_time(document):
    return {key: value for key, value in document.items() if key != "seconds"}


def test_a_dictionary_a_file_and_the_command_give_the_same_digits(command):
    (command.folder / "study.toml").write_text(TOML)
    told = without_time(command.json("study", "study.toml", "--backend", "cpu"))
    for given in (BIAS, command.folder / "study.toml", str(command.folder / "study.toml")):
        assert without_time(proofmass.study(given, backend="cpu").document) == told
    other = proofmass.study(BIAS, seed=2, backend="cpu")
    assert without_time(other.document) != told, "another seed gives other numbers"


def test_a_bias_grows_with_the_square_of_time():
    drift = proofmass.study(BIAS, backend="cpu")
    # sd of ½ b t² for b of 1 mg; five standard errors of a standard deviation over 4096 members.
    expected = 0.5 * 9.80665e-3 * drift.time_s**2
    assert numpy.abs(drift.position_error_m.sd / expected - 1).max() < 5 / numpy.sqrt(2 * 4096)
    assert not numpy.allclose(drift.position_error_m.sd, expected * 1.2, rtol=0.08), "a fifth more is seen"
    assert isinstance(drift.time_s, numpy.ndarray) and not drift.time_s.flags.writeable


def test_keys_are_set_by_path_and_grades_lie_under():
    drift = proofmass.study(BIAS, set={"accelerometer.bias_mg.sd": 2}, backend="cpu")
    twice = drift.position_error_m.sd / proofmass.study(BIAS, backend="cpu").position_error_m.sd
    assert numpy.allclose(twice, 2, rtol=1e-5)
    tactical = proofmass.study(preset="tactical", members=256, backend="cpu")
    assert tactical.name == "tactical" and tactical.members == 256


def test_what_is_wrong_is_said_with_cause_and_hint():
    with pytest.raises(proofmass.Error) as said:
        proofmass.study({"membrs": 3})
    assert "membrs" in said.value.cause and "`members`" in said.value.hint
    assert said.value.attempt in str(said.value) and "hint:" in str(said.value)
    for wrong in ({"seed": object()}, "nowhere.toml", {"gyro": {"bias_deg_h": "four"}}):
        with pytest.raises(proofmass.Error):
            proofmass.study(wrong)
    for options in ({"preset": "tactcal"}, {"backend": "tpu"}, {"set": {"gyro..x": 1}}):
        with pytest.raises(proofmass.Error):
            proofmass.study(BIAS, **options)


def test_page_and_table():
    drift = proofmass.study(BIAS, backend="cpu")
    shown = drift._repr_html_()
    assert shown.startswith("<iframe") and "srcdoc=" in shown and "<svg" not in shown, "the page is escaped"
    assert drift.page.startswith("<!doctype html>") and "bias: how far it drifts" in drift.page
    pandas = pytest.importorskip("pandas")
    table = drift.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and list(table.index) == [1.0, 5.0, 10.0]
    assert (table["position_error_m.sd"].to_numpy() == drift.position_error_m.sd).all()
    assert "closed_form.position_error_m.sd" in table
    xarray = pytest.importorskip("xarray")
    named = drift.to_xarray()
    assert isinstance(named, xarray.Dataset) and list(named.time_s.values) == [1.0, 5.0, 10.0]
    assert (named["position_error_m.sd"].values == drift.position_error_m.sd).all()
    with pytest.raises(AttributeError, match="position_error_m"):
        drift.position_errors


def test_ctrl_c_stops_a_run_and_the_next_one_runs():
    import signal
    import threading
    import time

    # Some minutes if nothing stops it.
    long = {**BIAS, "members": 200_000, "duration_s": 1000.0, "step_s": 0.001}
    # A shell's background jobs start with SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        threading.Timer(1.0, signal.raise_signal, [signal.SIGINT]).start()
        began = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            proofmass.study(long, backend="cpu")
        assert time.monotonic() - began < 30
    finally:
        signal.signal(signal.SIGINT, before)
    assert proofmass.study(BIAS, backend="cpu").failed == 0


def test_other_threads_run_meanwhile():
    import threading

    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            stop.wait(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    proofmass.study({**BIAS, "members": 65536, "step_s": 0.001}, backend="cpu")
    stop.set()
    thread.join()
    assert counted[0] > 20, "the lock of Python is given up"
