"""Records in memory: arrays of every kind, Series and DataFrames, and their time."""

from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import zerorate

RATE_HZ = 100.0


def white(n: int = 4096, columns: int = 3) -> Any:
    return np.random.default_rng(11).normal(size=(n, columns))


def one(values: NDArray[Any], **options: Any) -> NDArray[np.float64]:
    found: zerorate.Allan = zerorate.allan(values, **{"rate_hz": RATE_HZ, **options})
    return found.dev


def test_an_array_of_columns_has_a_result_for_each() -> None:
    rest = white()
    layouts = [rest, np.asfortranarray(rest), np.repeat(rest, 2, axis=0)[::2], rest.astype(">f8"), rest[::-1][::-1]]
    for array in layouts:
        found = zerorate.allan(array, rate_hz=RATE_HZ, columns=["gx", "gy", "gz"])
        assert list(found) == ["gx", "gy", "gz"] and [axis.name for axis in found.values()] == list(found)
        for at, axis in enumerate(found.values()):
            np.testing.assert_array_equal(axis.dev, one(rest[:, at]))
        np.testing.assert_array_equal(found[1].dev, found["gy"].dev)
    assert list(zerorate.allan(rest, rate_hz=RATE_HZ)) == ["0", "1", "2"]
    numbers: list[Any] = [2, np.int64(2), "2"]
    for last in numbers:
        assert isinstance(zerorate.allan(rest, rate_hz=RATE_HZ, column=last), zerorate.Allan)
    chosen = zerorate.allan(rest, rate_hz=RATE_HZ, columns=["gx", "gy", "gz"], column=["gz", "0"])
    assert list(chosen) == ["gz", "gx"]
    codes: Any = np.round(rest * 100).astype(np.int16)
    in_steps = zerorate.allan(codes, rate_hz=RATE_HZ, scale=0.01)
    np.testing.assert_array_equal(in_steps["1"].dev, one(codes[:, 1], scale=0.01))
    running: Any = np.cumsum(codes, axis=0)
    phase = zerorate.allan(running, rate_hz=1.0, data="phase")
    np.testing.assert_allclose(phase["0"].dev, one(codes[1:, 0], rate_hz=1.0), rtol=1e-9)


@pytest.mark.parametrize(
    ("match", "array", "options"),
    [
        ("rows are times", np.zeros((3, 1000)), {}),
        ("array.T", np.zeros((3, 3)), {}),
        ("rows are times", np.zeros((10, 0)), {}),
        ("the array has no rows", np.zeros((0, 3)), {}),
        (r"shape \(4, 3, 2\)", np.zeros((4, 3, 2)), {}),
        ("one value of the type float", 1.0, {}),
        ("one value of the type generator", (x for x in (1.0, 2.0)), {}),
        ("the dict has no columns", {}, {}),
        ("2 names for an array of 3", np.zeros((9, 3)), {"columns": ["a", "b"]}),
        ("several columns a", np.zeros((9, 2)), {"columns": ["a", "a"]}),
        ("no column 'z'", np.zeros((9, 2)), {"column": "z"}),
        ("there is no column 2; choose with column= one of 0, 1", np.zeros((9, 2)), {"column": 2}),
        ("two-dimensional", np.zeros(9), {"columns": ["a"]}),
        ("the record is one column", np.zeros(9), {"column": "a"}),
        ("the record is one column", np.zeros(9), {"time_column": "t"}),
        ("infinite at sample 1", np.array([0.0, np.inf, 1.0]), {}),
        ("not real numbers", np.array([True, False]), {}),
        ("not real numbers", np.array(["2026-01-01"], dtype="datetime64[s]"), {}),
        ("not real numbers", [1j, 2j], {}),
        ("not real numbers", np.array([1, "x"], dtype=object), {}),
        ("infinite at sample 0", np.array([[np.inf], [1.0]]), {}),
    ],
)
def test_an_array_that_is_not_a_record_gets_advice(match: str, array: Any, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=match):
        zerorate.allan(array, **{"rate_hz": 1.0, **options})


def test_masked_samples_are_missing() -> None:
    rate, mask = white(512, 1)[:, 0], np.zeros(512, dtype=bool)
    mask[100:110] = True
    missing = np.where(mask, np.nan, rate)
    np.testing.assert_array_equal(one(np.ma.masked_array(rate, mask)), one(missing))
    codes = np.ma.masked_array(np.round(rate * 100).astype(np.int32), mask)
    np.testing.assert_allclose(one(codes), one(np.where(mask, np.nan, codes.data)), rtol=1e-12)
    assert zerorate.allan(np.ma.masked_array(rate), rate_hz=1.0).missing == 0


def test_tables_are_read_by_their_names() -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    rest = white()
    columns = {"gx [rad/s]": rest[:, 0], "gy [rad/s]": rest[:, 1]}
    structured = np.zeros(len(rest), dtype=[("gx [rad/s]", "<f4"), ("gy [rad/s]", ">f8")])
    for name, values in columns.items():
        structured[name] = values
    tables = [columns, pandas.DataFrame(columns), polars.DataFrame(columns), structured]
    for table in tables:
        found = zerorate.allan(table, rate_hz=RATE_HZ, column="all")
        assert [(axis.name, axis.unit, axis.kind) for axis in found.values()] == [
            (name, "rad/s", "gyroscope") for name in columns
        ]
        np.testing.assert_allclose(found["gy [rad/s]"].dev, one(rest[:, 1]), rtol=1e-12)
        gy = zerorate.allan(table, rate_hz=RATE_HZ, column="gy [rad/s]")
        np.testing.assert_array_equal(gy.dev, found["gy [rad/s]"].dev)
        assert gy.fit is not None and gy.fit.n.unit == "rad/s·√s"
    volts = zerorate.allan({"out": rest[:, 0]}, rate_hz=RATE_HZ, unit="V", scale=2.0)["out"]
    np.testing.assert_array_equal(volts.dev, one(rest[:, 0], scale=2.0))
    assert volts.unit == "V" and volts.kind is None
    with pytest.warns(UserWarning, match="unit of column out is not stated"):
        assert zerorate.allan({"out": rest[:, 0]}, rate_hz=RATE_HZ)["out"].unit == "unit"


def test_columns_that_are_no_numbers_are_not_asked_for_by_chance() -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    columns = {"label": ["a"] * 512, "gx_dps": white(512)[:, 0], "is_ok": [True] * 512, "none": [None] * 512}
    for table in (pandas.DataFrame(columns), polars.DataFrame(columns), columns):
        assert list(zerorate.allan(table, rate_hz=1.0, column=["gx_dps"])) == ["gx_dps"]
        with pytest.raises(ValueError, match="holds no numbers"):
            zerorate.allan(table, rate_hz=1.0, column="is_ok")
    table = pandas.DataFrame({"label": ["a"] * 512, "gx_dps": columns["gx_dps"]})
    assert list(zerorate.allan(table, rate_hz=1.0)) == ["gx_dps"]
    for wrong, match in (("label", "holds no numbers"), ("gz", "choose with column= one of: 0 `label`, 1 `gx_dps`")):
        with pytest.raises(ValueError, match=match):
            zerorate.allan(table, rate_hz=1.0, column=wrong)
    with pytest.raises(ValueError, match="differ in length"):
        zerorate.allan({"a": np.zeros(3), "b": np.zeros(4)}, rate_hz=1.0)
    with pytest.raises(ValueError, match="rate_hz="):
        zerorate.allan({"gx_dps": white(512)[:, 0]})


def even(n: int, step_ns: int = 10_000_000) -> NDArray[Any]:
    return np.datetime64("2026-03-01T00:00:00", "ns") + np.arange(n) * np.timedelta64(step_ns, "ns")


def test_an_index_of_instants_tells_rate_and_gaps() -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    rate, times = white(4096)[:, 0], even(4096)
    known = one(rate)
    stamps = pandas.DatetimeIndex(times)
    since = pandas.TimedeltaIndex(times - times[0])
    indices = [stamps, stamps.tz_localize("Europe/Berlin"), stamps.as_unit("us"), since]
    for index in indices:
        found = zerorate.allan(pandas.Series(rate, index=index))
        assert found.rate_hz == pytest.approx(RATE_HZ, rel=1e-12) and found.unit == "°/s" and found.name == "rate"
        np.testing.assert_allclose(found.dev, known, rtol=1e-12)
        frame = zerorate.allan(pandas.DataFrame({"gx_dps": rate}, index=index))
        np.testing.assert_array_equal(frame["gx_dps"].dev, found.dev)
    counted = pandas.Index(np.arange(4096) / RATE_HZ, name="t_s")
    np.testing.assert_allclose(zerorate.allan(pandas.Series(rate, index=counted)).dev, known, rtol=1e-12)
    frame = zerorate.allan(pandas.DataFrame({"gx_dps": rate}, index=counted))
    assert list(frame) == ["gx_dps"] and frame["gx_dps"].rate_hz == pytest.approx(RATE_HZ, rel=1e-12)
    in_column = polars.DataFrame({"when": times, "gx_dps": rate})
    np.testing.assert_array_equal(zerorate.allan(in_column.lazy())["gx_dps"].dev, zerorate.allan(in_column)[0].dev)
    np.testing.assert_allclose(zerorate.allan(in_column)["gx_dps"].dev, known, rtol=1e-12)
    seconds = {"t": np.arange(4096) / RATE_HZ, "gx_dps": rate}
    by_column = zerorate.allan(seconds, column="gx_dps", time_column="t", time_unit="s")
    np.testing.assert_allclose(by_column.dev, known, rtol=1e-12)
    array = np.column_stack([np.arange(4096) / RATE_HZ, rate])
    named = {"columns": ["t_s", "gx_dps"]}
    stated = {"columns": ["t", "gx_dps"], "time_column": "t", "time_unit": "s"}
    for options in (named, stated):
        of_array: Any = zerorate.allan(array, **options)
        np.testing.assert_array_equal(of_array["gx_dps"].dev, by_column.dev)
    assert zerorate.allan(array, rate_hz=1.0, columns=["a [g]", "b"])["a [g]"].unit == "g"
    # rows 1000 to 1099 are missing
    kept = np.r_[0:1000, 1100:4096]
    gapped = zerorate.allan(pandas.Series(rate[kept], index=stamps[kept]))
    assert (gapped.samples, gapped.missing) == (4096, 100)
    given = zerorate.allan(pandas.Series(rate[kept], index=stamps[kept]), rate_hz=50.0)
    assert (given.rate_hz, given.missing) == (50.0, 0)


def test_a_clock_that_is_uneven_is_judged_as_that_of_a_log() -> None:
    pandas = pytest.importorskip("pandas")
    rng, rate = np.random.default_rng(5), white(4096)[:, 0]

    def with_jitter(share: float) -> Any:
        off = (rng.normal(size=4096) * share * 1e7).astype(np.int64).astype("timedelta64[ns]")
        return pandas.Series(rate, index=pandas.DatetimeIndex(even(4096) + off))

    with pytest.warns(UserWarning, match="off an even clock by 1[456] % of an interval"):
        found = zerorate.allan(with_jitter(0.15))
    assert found.rate_hz == pytest.approx(RATE_HZ, rel=1e-4) and found.warnings
    stepped = even(4096).copy()
    stepped[2000:] += np.timedelta64(10**9, "s")
    with pytest.raises(zerorate.Refused, match="rate_hz="):
        zerorate.allan(pandas.Series(rate, index=stepped))
    without = pandas.DatetimeIndex(np.where(np.arange(4096) == 7, np.datetime64("NaT"), even(4096)))
    with pytest.raises(ValueError, match="row 7 has no time"):
        zerorate.allan(pandas.Series(rate, index=without))
    twice = {"a": even(4096), "b": even(4096), "gx_dps": rate}
    with pytest.raises(ValueError, match="several columns, a, b: give time_column="):
        zerorate.allan(twice)


def test_the_unit_that_goes_in_comes_out() -> None:
    pandas = pytest.importorskip("pandas")
    rest = white(20_000)[:, 0]
    in_dps = zerorate.allan(rest, rate_hz=RATE_HZ).fit
    in_rad = zerorate.allan(np.radians(rest), rate_hz=RATE_HZ, unit="rad/s").fit
    assert in_dps is not None and in_rad is not None and in_rad.n.unit == "rad/s·√s"
    assert in_rad.n.value == pytest.approx(np.radians(in_dps.n.value), rel=1e-6)
    named = zerorate.allan(pandas.Series(np.radians(rest), name="gz [rad/s]"), rate_hz=RATE_HZ)
    assert (named.name, named.unit) == ("gz [rad/s]", "rad/s")
    assert "gyroscope_noise_density" in named.to_yaml()
    series = pandas.Series(rest, name="gz", index=pandas.date_range("2026", periods=len(rest), freq="10ms"))
    unnamed = zerorate.allan(white(), rate_hz=RATE_HZ)["0"]
    for guessed in (unnamed, zerorate.allan(rest, rate_hz=RATE_HZ), zerorate.allan(series)):
        with pytest.raises(ValueError, match="nothing states its unit, so °/s is a guess: give unit="):
            guessed.to_yaml()


def test_results_become_frames() -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    found = zerorate.allan(white(), rate_hz=RATE_HZ)
    frame = found["0"].to_frame()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(found["0"].dev)
    np.testing.assert_array_equal(frame["dev"], found["0"].dev)
    assert {"tau_s", "lo", "hi", "model", "model_lo", "model_hi"} <= set(frame.columns)
    every = found.to_frame("polars")
    assert isinstance(every, polars.DataFrame) and every["name"].unique().sort().to_list() == ["0", "1", "2"]
    assert zerorate.allan(white(64)[:, 0], rate_hz=1.0).to_frame().shape == (6, 8)
    with pytest.raises(ValueError, match="library='arrow'"):
        found.to_frame("arrow")


def test_libraries_that_are_missing_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    found = zerorate.allan(white(64)[:, 0], rate_hz=1.0)
    for module in ("pandas", "polars", "matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(ImportError, match="needs polars, which is not installed: pip install polars"):
        found.to_frame("polars")
    with pytest.raises(ImportError, match="pip install pandas"):
        found.to_frame()
    with pytest.raises(ImportError, match="pip install matplotlib"):
        found.plot()


def test_rows_of_one_sensor_are_chosen_among_several(tmp_path: pathlib.Path) -> None:
    first, second = np.random.default_rng(7).normal(scale=[0.1, 0.4], size=(4000, 2)).T
    times = [f"{at / RATE_HZ:.2f}" for at in range(4000)]
    rows = [f"{t_s},1,{a:.6f}\n{t_s},2,{b:.6f}" for t_s, a, b in zip(times, first, second)]
    log = tmp_path / "two.csv"
    log.write_text("\n".join(["t_s,SensorId,gz_dps", *rows]) + "\n")
    by_sensor = [zerorate.allan(log, column="gz_dps", where=f"SensorId={sensor}") for sensor in (1, 2)]
    assert [found.samples for found in by_sensor] == [4000, 4000]
    assert 3.6 < by_sensor[1].dev[0] / by_sensor[0].dev[0] < 4.4
    assert zerorate.read_log(log, "gz_dps", where="SensorId=2").rate_hz == pytest.approx(RATE_HZ)
    with pytest.raises(ValueError, match="where=: give a column and its value"):
        zerorate.allan(log, where="SensorId")
