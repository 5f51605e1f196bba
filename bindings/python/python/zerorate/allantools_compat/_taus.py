"""Averaging times, as allantools chooses them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def tau_generator(
    data: Any, rate: float, taus: Any = None, v: bool = False, even: bool = False, maximum_m: int = -1
) -> tuple[NDArray[Any], Floats, Floats]:
    """The requested averaging times that a record of ``len(data)`` phase points allows.

    Parameters
    ----------
    data
        Phase, shape (N,).
    rate
        Samples per second.
    taus
        Seconds; or ``"octave"`` (1, 2, 4 … samples, also for None and an empty list), ``"decade"`` (1, 2, 4, 10 …),
        ``"log10"`` (about ten in a decade), ``"all"``.
    v
        Print the lengths.
    even
        Even lengths only.
    maximum_m
        Longest length in samples; −1: the length of the record.

    Returns
    -------
    (data, m, taus)
        The record; lengths in samples, rounded, without repetition, ascending; the same in seconds.

    Raises
    ------
    RuntimeError
        If the rate is zero.
    """
    if rate == 0:
        raise RuntimeError("rate is 0: give samples per second")
    record = np.asarray(data)
    lengths = np.unique(np.round(_lengths(taus, len(record), float(rate))))
    longest = len(record) if maximum_m == -1 else maximum_m
    lengths = lengths[(lengths > 0) & (lengths < len(record)) & (lengths <= longest)]
    if even:
        lengths = lengths[lengths % 2 == 0]
    if v or not len(lengths):
        print(f"tau_generator: {len(record)} points at {rate} Hz have the averaging lengths {lengths}")
    return record, lengths, lengths / float(rate)


def _lengths(taus: Any, points: int, rate: float) -> Floats:
    if taus is None or (isinstance(taus, (list, tuple)) and not len(taus)):
        taus = "octave"
    if not isinstance(taus, str):
        return np.asarray(taus, dtype=np.float64) * rate
    if points < 1:
        return np.empty(0)
    if taus == "all":
        return np.arange(1.0, points + 1)
    if taus == "octave":
        return 2.0 ** np.arange(np.floor(np.log2(points)) + 1)
    if taus == "log10":
        decades = np.log10(points)
        return np.logspace(0.0, decades, int(10 * decades))
    if taus == "decade":
        return np.outer(10.0 ** np.arange(np.floor(np.log10(points)) + 1), [1.0, 2.0, 4.0]).ravel()
    raise ValueError(f"taus={taus!r}: give 'octave', 'decade', 'log10', 'all', or seconds")


def tau_reduction(ms: Any, rate: float, n_per_decade: int) -> tuple[NDArray[np.int64], Floats]:
    """Thins a list of lengths, as of ``taus="all"``, to about `n_per_decade` in a decade.

    A length stays if the next one in the list lies in the next interval of the logarithmic grid; the last one is
    always removed.

    Returns
    -------
    (m, taus)
        Lengths in samples, and in seconds.
    """
    lengths = np.asarray(ms).astype(np.int64)
    grid = np.rint(n_per_decade * np.log10(lengths))
    kept = lengths[:-1][np.diff(grid) != 0]
    return kept, kept / float(rate)
