"""Noise of different colours, with allantools' arguments.

Drawn from numpy's global generator, as allantools does: after the same ``numpy.random.seed`` both give the same
numbers. Densities are one-sided, in unit²/Hz.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _frame

Floats = NDArray[np.float64]

__all__ = ["brown", "iterpink", "numpy_psd", "pink", "scipy_psd", "violet", "white"]


def white(num_points: int = 1024, b0: float = 1.0, fs: float = 1.0) -> Floats:
    """White noise of the density `b0` up to fs/2: its variance is b0 fs/2."""
    return math.sqrt(b0 * fs / 2) * np.random.randn(num_points)


def brown(num_points: int = 1024, b_minus2: float = 1.0, fs: float = 1.0) -> Floats:
    """A random walk of the density ``b_minus2``/f²: the integral of white noise."""
    steps = white(num_points, b0=b_minus2 * (4 * math.pi * math.pi), fs=fs)
    return np.asarray(1 / float(fs) * np.cumsum(steps), dtype=np.float64)


def violet(num_points: int = 1024, b2: float = 1, fs: float = 1) -> Floats:
    """Noise of the density `b2` f²: the derivative of white noise."""
    return np.asarray(float(fs) * np.diff(white(num_points + 1, b0=b2 / (2 * math.pi) ** 2, fs=fs)), dtype=np.float64)


def pink(num_points: int = 1024, depth: int = 80) -> Floats:
    """About 1/f noise by the method of Voss and McCartney. Its density is not normalised.

    The sources that change with every 1, 2, 4 … samples are 1 + ⌊log₂(depth − 1)⌋, whatever `num_points` is: below
    their slowest the noise is white.
    """
    found: list[Floats] = []
    blocks = _blocks(depth)
    while depth * len(found) < num_points:
        found.append(next(blocks))
    return np.concatenate(found)[:num_points] if found else np.empty(0)


def iterpink(depth: int = 20) -> Iterator[float]:
    """The samples of `pink` one by one, without an end."""
    for block in _blocks(depth):
        yield from block


def numpy_psd(x: Any, f_sample: float = 1.0) -> tuple[Floats, Floats]:
    """Frequencies and one-sided density of `x`, unit²/Hz, from one Fourier transform of all of it."""
    values = np.asarray(x)
    density = 2 / (float(len(values)) * f_sample) * np.abs(np.fft.rfft(values)) ** 2
    return np.linspace(0, f_sample / 2, len(density)), density


def scipy_psd(x: Any, f_sample: float = 1.0, nr_segments: int = 4) -> tuple[Floats, Floats]:
    """Frequencies and one-sided density of `x`, unit²/Hz, by Welch's method. Needs scipy."""
    signal = _frame.needed("scipy.signal", "scipy_psd()")
    frequencies, density = signal.welch(x, f_sample, nperseg=len(x) // nr_segments)
    return frequencies, density


def _blocks(depth: int) -> Iterator[Floats]:
    """Stretches of `depth` samples of pink noise.

    A sample is the sum of `depth` held values and one more of its own. Before sample i of a stretch, i > 0, the held
    value of the number of trailing zeros of i is drawn anew.
    """
    if depth < 1:
        raise ValueError(f"depth={depth}: give at least 1")
    held, own, drawn = np.random.randn(depth), np.random.randn(depth), np.random.randn(depth)
    total = held.sum()
    places = np.arange(1, depth)
    zeros = np.array([(int(i) & -int(i)).bit_length() - 1 for i in places], dtype=np.int64)
    before = places - 2 ** (zeros + 1)
    while True:
        replaced = np.where(before > 0, drawn[before], held[zeros])
        totals = np.cumsum(np.concatenate([[total], drawn[places] - replaced]))
        yield totals + own
        total = totals[-1]
        held[zeros] = drawn[places]
        own, drawn = np.random.randn(depth), np.random.randn(depth)
