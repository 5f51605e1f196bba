"""`zerorate.allan`: numbers from the definition, inputs of every kind, errors."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import zerorate


def white(n: int = 4096) -> NDArray[np.float64]:
    return np.random.default_rng(42).normal(size=n)


def oadev_by_definition(rate: NDArray[np.float64], m: int) -> float:
    """Overlapping Allan deviation by its definition: the root of half the mean square of differences of adjacent
    averages."""
    means = np.convolve(rate, np.ones(m) / m, mode="valid")
    return float(np.sqrt(np.mean((means[m:] - means[:-m]) ** 2) / 2))


def test_the_deviation_is_its_definition() -> None:
    rate = white()
    result = zerorate.allan(rate, rate_hz=100.0)
    assert result.m.tolist() == [2**k for k in range(12)]
    np.testing.assert_allclose(result.tau_s, result.m / 100.0)
    for m, dev in zip(result.m.tolist(), result.dev.tolist()):
        assert dev == pytest.approx(oadev_by_definition(rate, m), rel=1e-12)
    assert result.n.tolist() == [4096 - 2 * m + 1 for m in result.m.tolist()]
    assert (result.lo < result.dev).all() and (result.dev < result.hi).all()
    assert result.alpha[0] == 0
    assert (result.edf >= 1).all()
    assert (result.stat, result.samples, result.missing) == ("oadev", 4096, 0)


def test_white_noise_has_an_angle_random_walk_and_nothing_else() -> None:
    fit = zerorate.allan(white(200_000), rate_hz=100.0).fit
    assert fit is not None
    assert fit.n.identified and fit.n.lo < 0.1 < fit.n.hi
    assert (fit.n.unit, fit.b.unit, fit.k.unit) == ("°/s·√s", "°/s", "°/s/√s")
    assert fit.n.needed_s is None
    assert not fit.k.identified and fit.k.needed_s is not None and fit.k.needed_s > 2000
    result = zerorate.allan(white(200_000), rate_hz=100.0, taus=[1.0])
    assert result.model is not None and result.model[0] == pytest.approx(0.1, rel=0.05)
    assert result.model_lo is not None and result.model_hi is not None
    assert result.model_lo[0] < result.model[0] < result.model_hi[0]
    assert zerorate.allan(white(1000), rate_hz=1.0, stat="mdev").model is None


def test_each_noise_of_a_record_has_its_term() -> None:
    rate = white(200_000)
    rate += 2.0 * np.sin(2 * np.pi * 3.0 * np.arange(len(rate)) / 100.0)
    rate[1000] = 1e4
    rate[100_000:] += 0.5
    result = zerorate.allan(rate, rate_hz=100.0)
    assert result.fit is not None and result.cleaned is not None
    assert result.fit.n.value == pytest.approx(0.1, rel=0.01) and not result.fit.rejected
    lines = [term for term in result.fit.terms if isinstance(term, zerorate.Line)]
    assert lines[0].frequency_hz == pytest.approx(3.0, rel=1e-3) and lines[0].rms == pytest.approx(2**0.5, rel=0.02)
    assert result.cleaned.glitches == 1
    [(at_s, size)] = result.cleaned.steps
    assert at_s == pytest.approx(1000.0, rel=0.01) and size == pytest.approx(0.5, rel=0.2)
    kept = zerorate.allan(rate, rate_hz=100.0, glitches="keep", steps="keep")
    assert kept.dev[0] > 5 * result.dev[0] and kept.cleaned == zerorate.Cleaned(0, [])
    bare = zerorate.allan(rate, rate_hz=100.0, fit=False)
    assert bare.fit is None and bare.no_fit is None and bare.cleaned is None and bare.dev[0] == kept.dev[0]


def test_correlated_noise_is_a_gauss_markov_term() -> None:
    rng = np.random.default_rng(3)
    memory, level = np.empty(100_000), 0.0
    for i, draw in enumerate(rng.normal(size=len(memory))):
        level = 0.998 * level + draw * np.sqrt(1 - 0.998**2)
        memory[i] = level
    fit = zerorate.allan(memory + rng.normal(size=len(memory)), rate_hz=100.0).fit
    assert fit is not None
    [term] = [term for term in fit.terms if isinstance(term, zerorate.GaussMarkov)]
    assert term.sigma.lo < 1.0 < term.sigma.hi and term.tau_s.lo < 5.0 < term.tau_s.hi


def test_a_filter_of_the_second_order_has_its_corner() -> None:
    k = np.tan(np.pi * 2.0 / 100.0)  # Butterworth, 2 Hz
    norm = 1 / (1 + np.sqrt(2) * k + k * k)
    rate, x1, x2, y1, y2 = np.empty(200_000), 0.0, 0.0, 0.0, 0.0
    for i, draw in enumerate(np.random.default_rng(4).normal(size=len(rate))):
        old = 2 * (k * k - 1) * y1 + (1 - np.sqrt(2) * k + k * k) * y2
        rate[i] = norm * (k * k * (draw + 2 * x1 + x2) - old)
        x1, x2, y1, y2 = draw, x1, rate[i], y1
    fit = zerorate.allan(rate, rate_hz=100.0).fit
    assert fit is not None and fit.n.lo < 0.1 < fit.n.hi
    [shape] = [term for term in fit.terms if isinstance(term, zerorate.BandShape)]
    assert shape.pole is None and shape.corner is not None
    assert abs(shape.corner[0] / 2.0 - 1) < 0.1 and abs(shape.corner[1]) < 0.2


def test_a_record_too_short_for_coefficients_says_so() -> None:
    result = zerorate.allan(white(5), rate_hz=1.0)
    assert result.fit is None
    assert result.no_fit is not None and "record longer" in result.no_fit


def test_times_without_a_deviation_are_reported() -> None:
    result = zerorate.allan(white(1000), rate_hz=10.0, taus=[0.1, 1.0, 1000.0])
    assert result.tau_s.tolist() == [0.1, 1.0]
    assert [point.tau_s for point in result.unavailable] == [1000.0]
    assert "too short" in result.unavailable[0].reason


def test_codes_are_exact_in_every_width() -> None:
    codes = np.random.default_rng(1).integers(-(2**15), 2**15, size=1001)
    exact = zerorate.allan(codes.astype(np.int32), rate_hz=1.0, scale=0.05)
    means = codes.astype(np.int64)
    squares = sum(int(d) ** 2 for d in np.diff(means))
    assert exact.dev[0] == pytest.approx(0.05 * np.sqrt(squares / 1000 / 2), rel=1e-15)
    for kind in (np.int16, np.int64, ">i2"):
        np.testing.assert_array_equal(zerorate.allan(codes.astype(kind), rate_hz=1.0, scale=0.05).dev, exact.dev)
    wide = zerorate.allan(codes.astype(np.int64) * 2**40, rate_hz=1.0)
    np.testing.assert_allclose(wide.dev * 0.05 / 2**40, exact.dev, rtol=1e-12)


def test_inputs_of_every_kind() -> None:
    rate = white(512)
    expected = zerorate.allan(rate, rate_hz=1.0).dev
    pandas, polars, xarray = (pytest.importorskip(name) for name in ("pandas", "polars", "xarray"))
    strided = np.empty(1024)
    strided[::2] = rate
    inputs: list[Any] = [
        rate.tolist(),
        tuple(rate.tolist()),
        strided[::2],
        np.array([rate, rate]).T[:, 0],
        rate.astype(">f8"),
        pandas.Series(rate),
        pandas.Series(rate, dtype="Float64"),
        polars.Series(rate),
        xarray.DataArray(rate),
    ]
    for values in inputs:
        np.testing.assert_array_equal(zerorate.allan(values, rate_hz=1.0).dev, expected, err_msg=repr(type(values)))
    single = rate.astype(np.float32)
    np.testing.assert_array_equal(
        zerorate.allan(single, rate_hz=1.0).dev, zerorate.allan(single.astype(np.float64), rate_hz=1.0).dev
    )


def test_missing_samples_are_gaps() -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    rate = white(512)
    rate[100:110] = np.nan
    result = zerorate.allan(rate, rate_hz=1.0)
    assert (result.samples, result.missing) == (512, 10)
    assert result.n[0] == 512 - 1 - 11
    with_none: Any = [None if np.isnan(value) else value for value in rate.tolist()]
    inputs = [pandas.Series(rate), pandas.Series(with_none, dtype="Float64"), polars.Series(with_none), with_none]
    for values in inputs:
        np.testing.assert_array_equal(zerorate.allan(values, rate_hz=1.0).dev, result.dev)


@pytest.mark.parametrize(
    ("match", "values", "options"),
    [
        ("rate_hz", [1.0, 2.0], {"rate_hz": None}),
        ("sample rate must be positive", [1.0, 2.0], {"rate_hz": 0.0}),
        ("not a statistic", [1.0, 2.0], {"stat": "theo1"}),
        ("averaging time", [1.0, 2.0], {"taus": "often"}),
        ("no averaging time", [1.0, 2.0], {"taus": [1.0, -1.0]}),
        ("confidence", [1.0, 2.0], {"confidence": 1.5}),
        ("scale", [1.0, 2.0], {"scale": 0.0}),
        ("data='angle'", [1.0, 2.0], {"data": "angle"}),
        ("glitches='drop'", [1.0, 2.0], {"glitches": "drop"}),
        ("steps='cut'", [1.0, 2.0], {"steps": "cut"}),
        ("one column", [[1.0, 2.0]], {}),
    ],
)
def test_each_error_is_named(match: str, values: Any, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=match):
        zerorate.allan(values, **{"rate_hz": 1.0, **options})


def test_an_empty_record_is_refused() -> None:
    empty: list[Any] = [[], {"gx_dps": []}]
    for nothing in empty:
        with pytest.raises(ValueError, match="is empty: give a value for each sample"):
            zerorate.allan(nothing, rate_hz=1.0)
    for record in ([1.0], [float("nan")] * 100):
        with pytest.raises(ValueError, match="fewer than 2 of its samples are numbers"):
            zerorate.allan(record, rate_hz=1.0)
    with pytest.raises(KeyError, match="no axis gz; there are gx_dps, gy_dps"):
        zerorate.allan({"gx_dps": [1.0, 2.0, 4.0], "gy_dps": [3.0, 1.0, 2.0]}, rate_hz=1.0)["gz"]


def test_other_threads_run_meanwhile() -> None:
    rate = white(3_000_000)
    stopped = threading.Event()

    def work() -> None:
        zerorate.allan(rate, rate_hz=1.0, taus="log:300", stat="mdev")
        stopped.set()

    worker = threading.Thread(target=work)
    worker.start()
    ticks = 0
    while not stopped.is_set():
        ticks += 1
        time.sleep(0.001)
    worker.join()
    assert ticks > 20


def test_ctrl_c_ends_a_long_one() -> None:
    program = """
import os, threading, numpy, zerorate
begun = threading.Timer(1.0, lambda: os.kill(os.getpid(), 2))
begun.start()
try:
    zerorate.allan(numpy.random.default_rng(1).normal(size=3_000_000), rate_hz=1.0, taus="all", stat="mdev")
except KeyboardInterrupt:
    os._exit(7)
"""
    assert subprocess.run([sys.executable, "-c", program], timeout=60).returncode == 7


@pytest.mark.parametrize("analyse", [zerorate.allan, zerorate.imu])
def test_a_record_that_never_changes_is_warned_of(analyse: Callable[..., Any]) -> None:
    with pytest.warns(UserWarning, match="frozen: .* all 10000 samples of column gz_dps are the same") as warned:
        found = analyse({"gz_dps": np.ones(10_000)}, rate_hz=200.0)
    assert not found[0].dev.any() and [one.filename for one in warned] == [__file__]


def test_a_contiguous_record_is_not_copied() -> None:
    rate = white(1000)
    from zerorate._records import record

    assert np.shares_memory(record(rate), rate)
    codes = np.arange(1000, dtype=np.int32)
    assert np.shares_memory(record(codes), codes)
    rate.flags.writeable = False
    assert len(zerorate.allan(rate, rate_hz=1.0).dev) == 9


def test_a_capture_knows_its_rate_scale_and_gaps() -> None:
    codes = (2**23 + 100 * white(1000)).astype(np.uint32)
    lost = np.zeros(1000, dtype=np.uint32)
    lost[[0, 500]] = [7, 3]
    capture = zerorate.Capture(
        t_ns=(np.arange(1000) * 10_000_000).astype(np.uint64),
        edge_seq=np.arange(1000, dtype=np.uint32),
        rate_code=codes,
        status=np.zeros(1000, dtype=np.int16),
        temp_code=np.full(1000, -1, dtype=np.int32),
        lost=lost,
        flags=np.zeros(1000, dtype=np.uint8),
        width_bits=24,
        metadata={},
    )
    result = zerorate.allan(capture)
    assert result.missing == 3
    assert result.rate_hz == pytest.approx(1002 / 9.99)
    # 23 488 LSB per °/s
    assert result.dev[0] == pytest.approx(100 / 23488, rel=0.1)
    assert np.isnan(capture.temp_c).all() and np.isnan(capture.temp_held_c).all()


@pytest.mark.parametrize("offset", [2**53, 2**62, 2**63])
def test_integers_that_would_be_rounded_are_refused(offset: int) -> None:
    values = [offset + at % 7 for at in range(1000)]
    for record in (values, np.array(values), np.array(values, dtype=object)):
        with pytest.raises(ValueError, match="beyond 2\\^53"):
            zerorate.allan(record, rate_hz=100.0)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.uint32])
def test_codes_that_lost_their_sign_get_it_again(kind: type[np.unsignedinteger[Any]]) -> None:
    codes = np.round(np.random.default_rng(1).normal(0.0, 5.0, 20_000)).astype(np.int64)
    plain = zerorate.allan(codes, rate_hz=100.0)
    for values in (codes.astype(kind), np.column_stack([codes.astype(kind)] * 2)):
        with pytest.warns(UserWarning, match="codes-unsigned"):
            found = zerorate.allan(values, rate_hz=100.0)
        np.testing.assert_array_equal((found if isinstance(found, zerorate.Allan) else found["0"]).dev, plain.dev)
