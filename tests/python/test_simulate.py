"""Simulated readings: what the command writes, and the noise that was asked for."""

import numpy
import pytest

import proofmass

STILL = {
    "name": "still",
    "members": 64,
    "duration_s": 200.0,
    "sensor": {"sample_rate_hz": 100.0},
    "step_s": 0.01,
    "accelerometer": {"velocity_random_walk_m_s_rth": 0.06},
    "gyro": {"angle_random_walk_deg_rth": 0.3},
}


def test_the_readings_are_those_that_the_command_writes(command):
    (command.folder / "still.toml").write_text(
        'name = "still"\nmembers = 64\nduration_s = 200.0\nstep_s = 0.01\n[sensor]\nsample_rate_hz = 100.0\n'
        "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.06\n[gyro]\nangle_random_walk_deg_rth = 0.3\n"
    )
    done = command.run("study", "still.toml", "--backend", "cpu", "--samples", 3, "log.npy")
    assert done.returncode == 0, done.stderr
    written = numpy.load(command.folder / "log.npy")
    readings = proofmass.simulate(STILL, members=3)
    assert (numpy.column_stack(list(readings.values())) == written).all()
    assert readings.gyro_rad_s.shape == readings.accelerometer_m_s2.shape == (3, 20_000)
    assert not (proofmass.simulate(STILL, seed=2).gyro_rad_s[0] == readings.gyro_rad_s[0]).any(), "another seed"


def test_the_noise_that_goes_in_comes_out():
    readings = proofmass.simulate(STILL, members=2)
    assert readings.time_s[:2] == pytest.approx([0.01, 0.02])
    found = proofmass.allan(readings.accelerometer_m_s2[1], 100.0, accelerometer=1)
    white = next(term for term in found.channels[0].terms if term.symbol == "N")
    assert white.supported and white.ci95[0] < 0.06 < white.ci95[1] and white.unit == "m/s/√h"
    assert not white.ci95[0] < 0.07 < white.ci95[1], "a sixth more lies outside"


def test_a_frame():
    pandas = pytest.importorskip("pandas")
    readings = proofmass.simulate(STILL, members=2)
    table = readings.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and table.shape == (20_000, 4)
    with pytest.raises(AttributeError):
        readings.gyro_deg_s


def test_arrays_with_names_along_members_and_time():
    xarray = pytest.importorskip("xarray")
    readings = proofmass.simulate(STILL, members=2)
    named = readings.to_xarray()
    assert isinstance(named, xarray.Dataset) and set(named) == {"gyro_rad_s", "accelerometer_m_s2"}
    assert dict(named.sizes) == {"member": 2, "time_s": 20_000}
    assert (named.gyro_rad_s.sel(time_s=0.02) == readings.gyro_rad_s[:, 1]).all()
    assert not (named.gyro_rad_s.isel(member=0) == readings.gyro_rad_s[1]).any(), "another member"


def test_what_is_asked_for_in_vain():
    with pytest.raises(proofmass.Error):
        proofmass.simulate(STILL, members=65)
