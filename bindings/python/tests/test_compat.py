"""`zerorate.allantools_compat`: the conventions. Its numbers are tested by allantools' own tests
(`cargo xtask python allantools`)."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pytest

import zerorate.allantools_compat as at

# NIST SP 1065 section 12.4: the 10 phase points and their deviations at τ = 1 and 2
PHASE = [0.0, 103.11111, 123.22222, 157.33333, 166.44444, 48.55555, -96.33333, -2.22222, 111.88889, 0.0]
DEVIATIONS = {
    "adev": (91.22945, 115.8082),
    "oadev": (91.22945, 85.95287),
    "mdev": (91.22945, 74.78849),
    "tdev": (52.67135, 86.35831),
    "hdev": (70.80608, 116.7980),
    "ohdev": (70.80607, 85.61487),
    "totdev": (91.22945, 93.90379),
}


@pytest.mark.parametrize("name", DEVIATIONS)
def test_the_ten_points_of_nist(name: str) -> None:
    taus, dev, err, n = getattr(at, name)(PHASE, taus=[2, 1, 1])
    known = [1.0, 2.0][: len(taus)]
    assert taus.tolist() == known
    np.testing.assert_allclose(dev, DEVIATIONS[name][: len(known)], rtol=2e-7)
    np.testing.assert_allclose(err, dev / np.sqrt(n))


def test_frequency_is_the_difference_of_phase() -> None:
    frequency = at.phase2frequency(PHASE, 1.0)
    for name in DEVIATIONS:
        by_phase = getattr(at, name)(PHASE, taus=[1])[1]
        by_frequency = getattr(at, name)(frequency, data_type="freq", taus=[1])[1]
        np.testing.assert_allclose(by_frequency, by_phase, rtol=1e-12)


def test_averaging_times() -> None:
    phase = np.random.default_rng(1).normal(size=101)
    assert at.oadev(phase)[0].tolist() == [1, 2, 4, 8, 16, 32]
    assert at.oadev(phase, rate=10.0, taus="decade")[0].tolist() == [0.1, 0.2, 0.4, 1.0, 2.0, 4.0]
    assert at.oadev(phase, taus="all")[0].tolist() == list(range(1, 50))
    assert at.oadev(phase, taus=np.array([3.4, 3.3, 0.0, 1000.0]))[0].tolist() == [3.0]
    with pytest.raises(UserWarning):
        at.oadev(phase, taus=[1000.0])
    with pytest.raises(RuntimeError):
        at.oadev(phase, rate=0)
    with pytest.raises(Exception, match="data_type"):
        at.oadev(phase, data_type="angle")


def test_missing_values_at_the_ends_are_cut_off() -> None:
    frequency = np.random.default_rng(1).normal(size=100)
    padded = np.concatenate([[np.nan], frequency, [np.nan, np.nan]])
    for whole, cut in zip(at.oadev(frequency, data_type="freq"), at.oadev(padded, data_type="freq")):
        np.testing.assert_array_equal(whole, cut)


def test_what_is_not_offered_says_so() -> None:
    for name in at.NOT_OFFERED:
        with pytest.raises(AttributeError, match="take it from allantools"):
            getattr(at, name)
    assert not set(at.NOT_OFFERED) & set(at.__all__)


def theirs() -> Any:
    """allantools itself."""
    return importlib.import_module("allantools")


@pytest.mark.allantools
@pytest.mark.parametrize("taus", [None, "all", "decade", [1, 3, 7, 100]])
@pytest.mark.parametrize("data_type", ["phase", "freq"])
def test_mtie_is_that_of_allantools(taus: Any, data_type: str) -> None:
    data = np.random.default_rng(1).normal(size=700)
    data = np.cumsum(data) if data_type == "phase" else data
    arguments = {"rate": 10.0, "data_type": data_type, "taus": taus}
    for mine, known in zip(at.mtie(data, **arguments), theirs().mtie(data, **arguments)):
        np.testing.assert_allclose(mine, known, rtol=1e-12)


def test_mtie_by_its_definition() -> None:
    taus, dev, err, n = at.mtie(PHASE, taus=[1, 2, 9])
    # the largest step, 166.44 to 48.56 to −96.33; all of it within nine, which is a single window and left out
    assert taus.tolist() == [1.0, 2.0] and n.tolist() == [9, 8]
    np.testing.assert_allclose(dev, [144.88888, 262.77777], rtol=1e-6)
    np.testing.assert_allclose(err, dev / np.sqrt(n))
    with_gap = np.array(PHASE)
    with_gap[5] = np.nan
    assert at.mtie(with_gap, taus=[2])[1][0] == pytest.approx(166.44444 + 96.33333, rel=1e-6)


@pytest.mark.allantools
@pytest.mark.parametrize("taus", [None, "all", [1, 3, 7, 100]])
def test_gradev_is_that_of_allantools(taus: Any) -> None:
    phase = np.cumsum(np.random.default_rng(2).normal(size=900))
    for gap in (slice(100, 160), slice(500, 501), slice(700, 704)):
        phase[gap] = np.nan
    with np.errstate(all="ignore"):
        known = theirs().gradev(phase, rate=10.0, taus=taus)
    mine = at.gradev(phase, rate=10.0, taus=taus)
    for place in (0, 1, 3):
        np.testing.assert_allclose(mine[place], known[place], rtol=1e-9)


def test_gradev_has_limits() -> None:
    phase = np.cumsum(np.random.default_rng(2).normal(size=900))
    phase[100:160] = np.nan
    taus, dev, (below, above), n = at.gradev(phase, ci=0.9, noisetype="wf")
    for tau, one, down, up in zip(taus, dev, below, above):
        lo, hi = at.confidence_interval(one, at.edf_simple(840, tau, 0), 0.9)
        assert (one - lo, hi - one) == (pytest.approx(down), pytest.approx(up))
    wider = at.gradev(phase, ci=0.99, noisetype="wf")[2]
    assert (wider[0] > below).all() and (wider[1] > above).all()
    sparse = np.where(np.random.default_rng(1).random(900) < 0.6, np.nan, np.cumsum(np.ones(900)) ** 1.5)
    for noise in ("wp", "fp", "wf", "ff", "rf", "?"):
        with np.errstate(all="raise"):
            errors = at.gradev(sparse, taus="all", noisetype=noise)[2]
        assert np.isfinite(errors).all() and (np.array(errors) >= 0).all()
    by_frequency = at.gradev(np.diff(np.cumsum(np.ones(50)) ** 1.5), data_type="freq", noisetype="?")
    assert len(by_frequency[0]) and (by_frequency[2][1] > 0).all()
    with pytest.raises(Exception, match="data_type"):
        at.gradev(phase, data_type="angle")
