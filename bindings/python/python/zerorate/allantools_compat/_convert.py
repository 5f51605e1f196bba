"""Phase and frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def trim_data(x: Any) -> Floats:
    """The record without the missing values (NaN) at its two ends."""
    values = np.asarray(x, dtype=np.float64)
    if not len(values) or not np.isnan(values[[0, -1]]).any():
        return values
    present = np.flatnonzero(~np.isnan(values))
    return values[present[0] : present[-1] + 1] if len(present) else values[:0]


def frequency2phase(freqdata: Any, rate: float) -> Floats:
    """Phase in seconds of fractional frequency: its integral less the mean, from 0 on; one point more than samples."""
    values = trim_data(freqdata)
    if not len(values):
        return np.zeros(1)
    return np.concatenate([[0.0], np.cumsum(values - np.nanmean(values))]) / float(rate)


def phase2frequency(phase: Any, rate: float) -> Floats:
    """Fractional frequency of phase in seconds: its difference times the rate; one sample less than points."""
    values = np.asarray(phase, dtype=np.float64)
    difference: Floats = (values[1:] - values[:-1]) * float(rate)
    return difference


def phase2radians(phasedata: Any, v0: float) -> Floats:
    """Phase in radians of phase in seconds at the carrier frequency `v0`, Hz."""
    return np.asarray(phasedata, dtype=np.float64) * (2 * np.pi * v0)


def frequency2fractional(frequency: Any, mean_frequency: float = -1) -> Floats:
    """Fractional frequency of a frequency in Hz: relative to `mean_frequency`, or to its own mean."""
    values = np.asarray(frequency, dtype=np.float64)
    nominal = values.mean() if mean_frequency == -1 else mean_frequency
    return (values - nominal) / nominal
