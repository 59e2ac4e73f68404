"""Allan deviations: the definition, a closed form, and the numbers of the command."""

import numpy
import pytest

import proofmass

RATE_HZ = 100.0


def defined(values, factor):
    """The overlapping Allan deviation by its definition (IEEE 952, NIST SP 1065)."""
    phase = numpy.concatenate([[0.0], numpy.cumsum(values - values[0])])
    second = phase[2 * factor:] - 2 * phase[factor:-factor] + phase[:-2 * factor]
    return numpy.sqrt(numpy.mean(second**2) / (2 * factor**2))


@pytest.fixture
def noise():
    random = numpy.random.default_rng(1)
    return random.normal(scale=0.3, size=50_000)


def test_the_curve_is_the_definitions(noise):
    curve = proofmass.allan(noise, RATE_HZ).channels[0].curve
    factors = numpy.rint(curve.tau_s * RATE_HZ).astype(int)
    # Up to 128 samples every start is used; above, starts are thinned, and the estimate is another one of equal worth.
    short = factors <= 128
    by_definition = numpy.array([defined(noise, m) for m in factors])
    assert numpy.abs(curve.deviation / by_definition - 1)[short].max() < 1e-9
    assert numpy.abs(curve.deviation / by_definition - 1)[~short].max() < 0.1
    shuffled = numpy.array([defined(numpy.cumsum(noise), m) for m in factors])
    assert numpy.abs(curve.deviation / shuffled - 1).min() > 0.1, "another signal is another curve"


def test_white_noise_has_the_closed_form(noise):
    channel = proofmass.allan(noise, RATE_HZ).channel("1")
    white = next(term for term in channel.terms if term.symbol == "N")
    # sigma(tau) = N / sqrt(tau), with N = sd / sqrt(rate).
    expected = 0.3 / numpy.sqrt(RATE_HZ)
    # Five standard errors of a standard deviation of so many samples.
    tolerance = 5 / numpy.sqrt(2 * noise.size)
    assert white.supported and abs(white.value / expected - 1) < tolerance
    assert abs(white.value / (1.05 * expected) - 1) > tolerance, "a twentieth more is seen"


def comparable(document):
    recording = {key: value for key, value in document["recording"].items() if key not in ("file", "sha256")}
    return {**document, "recording": recording}


def test_arrays_of_any_layout_give_the_commands_digits(command, noise):
    table = numpy.column_stack([noise, numpy.cumsum(noise) * 1e-3])
    numpy.save(command.folder / "log.npy", table)
    told = comparable(command.json("allan", "log.npy", "--rate-hz", RATE_HZ))
    wide = numpy.repeat(table, 2, axis=1)
    layouts = [table, numpy.asfortranarray(table), wide[:, ::2], table.astype(">f8"), {"1": noise, "2": table[:, 1]}]
    for given in [*layouts, command.folder / "log.npy"]:
        assert comparable(proofmass.allan(given, RATE_HZ).document) == told
    single = comparable(proofmass.allan(table.astype("f4"), RATE_HZ).document)
    assert single != told and single["channels"][0]["curve"][5]["deviation"] == pytest.approx(
        told["channels"][0]["curve"][5]["deviation"], rel=1e-5
    )


def test_columns_have_the_units_that_are_said(command, noise):
    numpy.save(command.folder / "log.npy", noise)
    scaled = ["--accelerometer", "1", "--accelerometer-scale", "mg"]
    told = comparable(command.json("allan", "log.npy", "--rate-hz", RATE_HZ, *scaled))
    found = proofmass.allan(noise, RATE_HZ, accelerometer=1, accelerometer_scale="mg")
    assert comparable(found.document) == told and found.channels[0].quantity == "accelerometer"


def test_missing_readings_are_dropped_and_said(command, noise):
    noise[1000] = numpy.nan
    noise[2000:2100] = numpy.nan
    numpy.save(command.folder / "log.npy", noise)
    found = proofmass.allan(noise, RATE_HZ)
    assert comparable(found.document) == comparable(command.json("allan", "log.npy", "--rate-hz", RATE_HZ))
    assert found.findings and found.recording.rows == noise.size


def test_frames_and_clocks():
    pandas = pytest.importorskip("pandas")
    random = numpy.random.default_rng(2)
    frame = pandas.DataFrame({
        "t_s": numpy.arange(20_000) / RATE_HZ,
        "gyro_x_rad_s": random.normal(size=20_000),
        "note": ["a"] * 20_000,
    })
    found = proofmass.allan(frame)
    assert [c.name for c in found.channels] == ["gyro_x_rad_s"] and found.recording.rate_hz == pytest.approx(RATE_HZ)
    curve = found.to_dataframe()
    assert (curve["deviation"].to_numpy() == found.channels[0].curve.deviation).all()
    assert set(found.coefficients()["symbol"]) >= {"N", "B", "K"}
    xarray = pytest.importorskip("xarray")
    named = found.to_xarray()
    assert isinstance(named, xarray.Dataset) and set(named.sizes) == {"channel", "tau_s"}
    of_x = named.deviation.sel(channel="gyro_x_rad_s")
    assert (of_x.values == found.channels[0].curve.deviation).all()


def test_large_arrays_are_not_copied():
    import resource

    values = numpy.random.default_rng(3).normal(size=30_000_000)
    proofmass.allan(values[:100_000], RATE_HZ)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    proofmass.allan(values, RATE_HZ)
    more_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert more_mb < values.nbytes / 1e6 / 4, f"{more_mb} MB more for an array of {values.nbytes / 1e6} MB"


def test_what_is_no_recording_is_refused():
    for wrong in (["a", "b"], numpy.zeros((3, 3, 3)), numpy.zeros(0), {}, {"a": [1.0, 2.0], "b": [1.0]}, "nowhere.csv"):
        with pytest.raises(proofmass.Error):
            proofmass.allan(wrong, RATE_HZ)
    with pytest.raises(proofmass.Error) as said:
        proofmass.allan(numpy.random.normal(size=1000), RATE_HZ, gyro="gx")
    assert "gx" in said.value.cause
