"""The conventions of `zerorate.allantools_compat`. allantools' own tests check its numbers
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
    frequency = np.diff(PHASE)
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


def test_missing_functions_say_so() -> None:
    for name in at.NOT_OFFERED:
        with pytest.raises(AttributeError, match="take it from allantools"):
            getattr(at, name)
    assert not set(at.NOT_OFFERED) & set(at.__all__)


@pytest.mark.allantools
@pytest.mark.parametrize("taus", [None, "all", "decade", "log10", [1, 3, 7, 100]])
@pytest.mark.parametrize("name", DEVIATIONS)
def test_the_deviations_are_those_of_allantools(name: str, taus: Any) -> None:
    theirs: Any = importlib.import_module("allantools")
    phase = np.cumsum(np.random.default_rng(1).normal(size=700))
    mine, known = (getattr(module, name)(phase, 10.0, taus=taus) for module in (at, theirs))
    for place in (0, 1):
        np.testing.assert_allclose(mine[place], known[place], rtol=1e-9)
