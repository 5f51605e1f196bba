"""The deviations, with allantools' arguments and results."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _zerorate
from ._confidence import confidence_interval, edf_simple
from ._convert import frequency2phase, trim_data
from ._taus import tau_generator

Floats = NDArray[np.float64]
Result = tuple[Floats, Floats, Any, Floats]


def _deviation(stat: str, data: Any, rate: float, data_type: str, taus: Any) -> Result:
    if data_type not in ("phase", "freq"):
        raise Exception(f"unknown data_type: {data_type}")  # what allantools raises
    is_phase = data_type == "phase"
    record = np.asarray(data, dtype=np.float64) if is_phase else trim_data(data)
    # the choice of times needs only the number of points of the phase
    phase = np.broadcast_to(0.0, len(record) + (not is_phase))
    _, lengths, used = tau_generator(phase, rate, taus)
    devs, ns = _zerorate.deviations(
        np.ascontiguousarray(record), is_phase, float(rate), stat, lengths.astype(np.int64).tolist()
    )
    terms = ns.astype(np.float64)
    return remove_small_ns(used, devs, devs / np.sqrt(np.maximum(terms, 1.0)), terms)


def adev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Allan deviation, NIST SP 1065 equation 10.

    Parameters
    ----------
    data
        Phase in seconds, shape (N,), or fractional frequency, shape (N − 1,). NaN is a missing value.
    rate
        Samples per second.
    data_type
        ``phase`` or ``freq``.
    taus
        See `tau_generator`.

    Returns
    -------
    (taus, dev, deverr, n)
        Averaging times, s; deviations; deviation / √n; terms that entered. Times with a single term or none are left
        out.

    Raises
    ------
    UserWarning
        If nothing is left.
    """
    return _deviation("adev", data, rate, data_type, taus)


def oadev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Overlapping Allan deviation, NIST SP 1065 equation 11. Arguments and result are as in `adev`."""
    return _deviation("oadev", data, rate, data_type, taus)


def mdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Modified Allan deviation, NIST SP 1065 equation 14. Arguments and result are as in `adev`."""
    return _deviation("mdev", data, rate, data_type, taus)


def tdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Time deviation, s, NIST SP 1065 equation 15. Arguments and result are as in `adev`."""
    return _deviation("tdev", data, rate, data_type, taus)


def hdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Hadamard deviation, NIST SP 1065 equation 17. Arguments and result are as in `adev`."""
    return _deviation("hdev", data, rate, data_type, taus)


def ohdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Overlapping Hadamard deviation, NIST SP 1065 equation 18. Arguments and result are as in `adev`."""
    return _deviation("ohdev", data, rate, data_type, taus)


def totdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Total deviation, NIST SP 1065 equation 25. Arguments and result are as in `adev`."""
    return _deviation("totdev", data, rate, data_type, taus)


def mtie(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Maximum time interval error, s: the largest excursion of the phase within any τ (ITU-T G.810). Arguments and
    result are as in `adev`.

    A missing value of the phase (NaN) is left out of its windows; in allantools the result is NaN then. A missing
    frequency makes all phase after it unknown.
    """
    phase = np.ascontiguousarray(_phase(data, rate, data_type))
    _, lengths, used = tau_generator(phase, rate, taus)
    devs, ns = _zerorate.mtie(phase, lengths.astype(np.int64).tolist())
    terms = ns.astype(np.float64)
    return remove_small_ns(used, devs, devs / np.sqrt(np.maximum(terms, 1.0)), terms)


_EXPONENTS = {"wp": 2.0, "fp": 1.0, "wf": 0.0, "ff": -1.0, "rf": -2.0}
"""Exponents of the density of the frequency."""


def gradev(
    data: Any,
    rate: float = 1.0,
    data_type: str = "phase",
    taus: Any = None,
    ci: float = 0.9,
    noisetype: str = "wp",
) -> tuple[Floats, Floats, list[Floats], Floats]:
    """Overlapping Allan deviation of a record with gaps (NaN), from the differences whose points are all present.

    Parameters
    ----------
    data, rate, data_type, taus
        See `adev`. Give phase if you can: a missing frequency makes all phase after it unknown. `zerorate.allan`
        handles gaps in a rate better.
    ci
        Probability of the interval.
    noisetype
        The noise that the interval is for: ``wp``, ``fp``, ``wf``, ``ff``, ``rf`` (white and flicker phase, white,
        flicker and random walk frequency). Any other: as many degrees of freedom as points less one.

    Returns
    -------
    (taus, dev, [err_lo, err_hi], n)
        See `adev`; the errors are the distances of the limits below and above the deviation. (allantools 2024.6
        documents this, but passes the degrees of freedom as the probability and returns NaN.)
    """
    phase = np.ascontiguousarray(_phase(data, rate, data_type))
    _, lengths, used = tau_generator(phase, rate, taus)
    devs, ns = _zerorate.deviations(phase, True, float(rate), "oadev", lengths.astype(np.int64).tolist())
    points = int(np.count_nonzero(~np.isnan(phase)))
    alpha = _EXPONENTS.get(noisetype, np.nan)

    def limits(dev: float, n: int, m: float) -> tuple[float, float]:
        # the formulas are for more points than a difference spans
        edf = max(edf_simple(points, m, alpha), 1.0) if points > 2 * m else 1.0
        return confidence_interval(dev, edf, ci) if n > 1 else (dev, dev)

    around = np.array([limits(*of) for of in zip(devs, ns, lengths)]).reshape(-1, 2)
    errors = [devs - around[:, 0], around[:, 1] - devs]
    times, dev, errs, terms = remove_small_ns(used, devs, errors, ns.astype(np.float64))
    return times, dev, errs, terms


def _phase(data: Any, rate: float, data_type: str) -> Floats:
    if data_type not in ("phase", "freq"):
        raise Exception(f"unknown data_type: {data_type}")  # what allantools raises
    return np.asarray(data, dtype=np.float64) if data_type == "phase" else frequency2phase(data, rate)


def remove_small_ns(taus: Any, devs: Any, deverrs: Any, ns: Any) -> Result:
    """Removes times with a single term or none. `deverrs` is an array, or a list of two (lower, upper).

    Raises
    ------
    UserWarning
        If nothing is left.
    """
    enough = np.asarray(ns) > 1
    if not enough.any():
        raise UserWarning("no averaging time has more than one term: the record is too short")
    errors = [part[enough] for part in deverrs] if isinstance(deverrs, list) else deverrs[enough]
    return taus[enough], devs[enough], errors, ns[enough]


def three_cornered_hat_phase(
    phasedata_ab: Any,
    phasedata_bc: Any,
    phasedata_ca: Any,
    rate: float,
    taus: Any,
    function: Callable[..., Result],
) -> Result:
    """Deviation of clock A out of comparisons of three: σ²_A = (σ²_AB + σ²_CA − σ²_BC) / 2; 0 where that is negative.

    `function` is the deviation, such as `oadev`. The result is as in `adev`.
    """
    times, ab, _, ns = function(phasedata_ab, data_type="phase", rate=rate, taus=taus)
    bc = function(phasedata_bc, data_type="phase", rate=rate, taus=taus)[1]
    ca = function(phasedata_ca, data_type="phase", rate=rate, taus=taus)[1]
    dev = np.sqrt(np.maximum((ab**2 + ca**2 - bc**2) / 2, 0.0))
    return times, dev, dev / np.sqrt(ns), ns
