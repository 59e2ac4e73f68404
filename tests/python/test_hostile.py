"""What Python may hold besides plain arrays: read as what it is, or refused in words, and never dropped without one."""

import numpy
import pytest

import proofmass

pandas = pytest.importorskip("pandas")

RATE_HZ = 100.0


@pytest.fixture
def noise():
    return numpy.random.default_rng(2).normal(size=4000)


def white(answer, channel="1"):
    return next(term for term in answer.channel(channel).terms if term.symbol == "N").value


def test_what_holds_itself_is_refused():
    study = {"members": 10, "duration_s": 1.0}
    study["gyro"] = study
    with pytest.raises(proofmass.Error, match="hold itself"):
        proofmass.study(study)
    times = []
    times.append(times)
    with pytest.raises(proofmass.Error, match="hold itself"):
        proofmass.study({"report": {"times_s": times}})


def test_a_masked_number_is_missing(noise):
    spoilt = noise.copy()
    spoilt[100:110] = 1e6
    masked = numpy.ma.masked_array(spoilt, mask=spoilt > 1e3)
    expected = white(proofmass.allan(numpy.where(spoilt > 1e3, numpy.nan, spoilt), RATE_HZ))
    assert white(proofmass.allan(masked, RATE_HZ)) == expected
    seen = "\n".join(proofmass.allan(masked.data, RATE_HZ).findings)
    assert "1 knock of" in seen and "10 rows were not used" not in seen, "the masked numbers would be seen"
    assert "knock" not in "\n".join(proofmass.allan(masked, RATE_HZ).findings)


def test_numbers_of_pandas_are_read_whatever_their_dtype(noise):
    expected = white(proofmass.allan(noise, RATE_HZ))
    for dtype in ("Float64", object):
        table = pandas.DataFrame({"1": pandas.Series(noise).astype(dtype)})
        assert white(proofmass.allan(table, RATE_HZ)) == expected
    stamps = pandas.to_datetime(1_700_000_000_000_000_000 + 10_000_000 * numpy.arange(noise.size))
    told = proofmass.allan(pandas.DataFrame({"time": stamps, "1": noise}))
    assert white(told) == pytest.approx(expected, rel=1e-6) and told.document["recording"]["rate_hz"] == RATE_HZ


def test_an_index_of_times_is_the_clock(noise):
    by_column = white(proofmass.allan(pandas.DataFrame({"t_s": numpy.arange(noise.size) / RATE_HZ, "1": noise})))
    dates = pandas.date_range("2026-01-01", periods=noise.size, freq="10ms")
    for index in (dates, dates - dates[0], pandas.Index(numpy.arange(noise.size) / RATE_HZ, name="t_s")):
        table = pandas.DataFrame({"1": noise}, index=index)
        assert white(proofmass.allan(table)) == pytest.approx(by_column, rel=1e-6)
        with pytest.raises(proofmass.Error, match="Hz"):
            proofmass.allan(table, 2 * RATE_HZ)
    # Control: numbers of rows are no clock.
    with pytest.raises(proofmass.Error, match="sampling rate"):
        proofmass.allan(pandas.DataFrame({"1": noise}))


def test_a_column_that_is_not_read_is_named(noise):
    table = pandas.DataFrame({"1": noise, "note": ["x"] * noise.size})
    with pytest.warns(UserWarning, match="note"):
        proofmass.allan(table, RATE_HZ)
    with pytest.raises(proofmass.Error, match="not a column"):
        proofmass.allan({"1": noise, "rate": 100.0}, RATE_HZ)


@pytest.mark.parametrize("wrong", [[[1.0, 2.0], [3.0]], numpy.ones(9) * 1j, None, b"log.csv", numpy.ones((2, 2, 2))])
def test_what_is_no_table_of_numbers_is_refused_in_words(wrong):
    with pytest.raises(proofmass.Error, match="cause"):
        proofmass.allan(wrong, RATE_HZ)
