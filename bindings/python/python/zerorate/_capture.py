"""Captures: raw codes on disk. The format is specified in docs/formats/capture.md of the project."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from . import _zerorate
from ._keywords import checked

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture as columns of equal length, one row per rate sample.

    For a part with several axes, `rate_code`, `flags`, `good` and `rate_dps` are tables with a column for each axis,
    in the order of `axes`.
    """

    t_ns: NDArray[np.uint64]
    """Time of the data-ready edge, ns."""
    edge_seq: NDArray[np.uint32]
    """Running number of the data-ready edge."""
    rate_code: NDArray[np.uint32] | NDArray[np.int64]
    """Raw rate code."""
    status: NDArray[np.int16] | NDArray[np.int64]
    """Status register of the channel; −1 where it was not read."""
    temp_code: NDArray[np.int32] | NDArray[np.int64]
    """Raw temperature code; −1 where it was not read, or −2⁶³ for parts other than the ADIS16130."""
    lost: NDArray[np.uint32]
    """Samples lost right before the row."""
    flags: NDArray[np.uint8]
    """Faults of the reading, 0 for none: the sum of 1 (impossible for the part: a bit error), 2 (out of
    range), 4 (frozen) and 8 (impossible temperature). The codes stay as they were read; `good` tells which rates to
    use."""
    width_bits: int
    """Width of the rate codes. For an ADIS16130 it is 16 or 24, and the temperature codes have the same width."""
    metadata: dict[str, str] = field(repr=False)
    """The description of the recording in the file: device, serial number, registers, …"""
    calibration_id: str | None = None
    """The id of the calibration that was applied; None if the file is not corrected. The codes are always raw."""
    warning: str | None = None
    """Warnings about the file and its readings, each ``code: text``, joined by ``; ``; None if there are none."""
    axes: tuple[str, ...] = ("rate",)
    """Names of the axes of the part."""
    rate_scales: tuple[tuple[float, int], ...] | None = field(default=None, repr=False)
    """Codes per °/s and code at zero of each axis; None for an ADIS16130."""
    temp_scale: tuple[float, int, float] | None = field(default=None, repr=False)
    """Codes per °C, a code, and the temperature that this code means, °C; None for an ADIS16130."""

    @cached_property
    def good(self) -> NDArray[np.bool_]:
        """True for each rate that is possible, in range and not frozen."""
        return np.asarray((self.flags & 7) == 0, dtype=np.bool_)

    def __repr__(self) -> str:
        lost, warned = int(self.lost.sum(dtype=np.uint64)), "" if self.warning is None else ", with a warning"
        span = f"{len(self)} samples at {self.rate_hz:.6g} Hz, {lost} lost{warned}"
        return f"<Capture of {span}: {', '.join(self.axes)}>"

    def __len__(self) -> int:
        return len(self.t_ns)

    @cached_property
    def rate_hz(self) -> float:
        """Samples per second by the timestamps, lost samples counted; NaN for fewer than two rows."""
        if len(self) < 2:
            return float("nan")
        intervals = len(self) - 1 + int(self.lost[1:].sum(dtype=np.uint64))
        return intervals * 1e9 / int(self.t_ns[-1] - self.t_ns[0])

    @cached_property
    def t_s(self) -> NDArray[np.float64]:
        """Time since the first row, s."""
        since_first: NDArray[np.uint64] = self.t_ns - self.t_ns[:1].sum(dtype=np.uint64)
        return np.asarray(since_first * 1e-9, dtype=np.float64)

    @cached_property
    def rate_dps(self) -> NDArray[np.float64]:
        """Rate before any correction, °/s: (code − 2²³) / 23 488 for the 24-bit codes of an ADIS16130. NaN where
        `good` is false."""
        if self.rate_scales is None:
            rates = _zerorate.rate_dps(np.asarray(self.rate_code, dtype=np.uint32), self.width_bits)
        else:
            lsb_per_dps, zero_code = np.array(self.rate_scales, dtype=np.float64).T
            rates = np.asarray((self.rate_code - zero_code) / lsb_per_dps, dtype=np.float64)
        return np.where(self.good, rates, np.nan)

    @cached_property
    def temp_c(self) -> NDArray[np.float64]:
        """Temperature, °C: (code − 2²³) / 14 093 + 25 for the 24-bit codes of an ADIS16130. NaN where it was not read
        or is impossible."""
        if self.temp_scale is None:
            temps = _zerorate.temp_c(np.asarray(self.temp_code, dtype=np.int32), self.width_bits)
        else:
            lsb_per_c, zero_code, zero_c = self.temp_scale
            temps = (self.temp_code - np.float64(zero_code)) / lsb_per_c + zero_c
        return np.where(self._temp_read, temps, np.nan)

    @cached_property
    def _temp_read(self) -> NDArray[np.bool_]:
        """True for each row in which a temperature was read that is possible for the part. All axes share it."""
        not_read = -1 if self.temp_scale is None else np.iinfo(np.int64).min
        flags = self.flags if self.flags.ndim == 1 else self.flags[:, 0]
        return np.asarray((self.temp_code != not_read) & (flags & 8 == 0), dtype=np.bool_)

    @cached_property
    def temp_held_c(self) -> NDArray[np.float64]:
        """Temperature, °C. A row without one has the last temperature that was read; NaN before the first."""
        read = np.where(self._temp_read, np.arange(len(self)), -1)
        last = np.maximum.accumulate(read) if len(read) else read
        return np.where(last >= 0, self.temp_c[np.maximum(last, 0)], np.nan)

    def _dps_per_code(self, axis: int) -> float:
        if self.rate_scales is not None:
            return 1 / self.rate_scales[axis][0]
        step = np.array([0, 1], dtype=np.uint32)
        return float(np.diff(_zerorate.rate_dps(step, self.width_bits))[0])

    def _codes(self, axis: int = 0) -> tuple[NDArray[np.int32], list[tuple[int, int]]]:
        """The good rate codes of an axis, and the gaps: index of the next code, number of missing codes."""
        is_good = self.good.reshape(len(self), -1)[:, axis]
        codes = self.rate_code.reshape(len(self), -1)[:, axis]
        good = np.flatnonzero(is_good)
        before = np.cumsum(self.lost, dtype=np.int64) + np.cumsum(~is_good)
        missing = np.diff(before[good])
        at = np.flatnonzero(missing) + 1
        return codes[good].astype(np.int32), list(zip(at.tolist(), missing[at - 1].tolist()))

    def _temps_c(self, axis: int, temps_c: NDArray[np.float64]) -> NDArray[np.float64]:
        """The temperature of each sample of an axis, from its first good one to its last; NaN where it is unknown."""
        at = np.arange(len(self)) + np.cumsum(self.lost, dtype=np.int64)
        good = np.flatnonzero(self.good.reshape(len(self), -1)[:, axis])
        if not len(good):
            return np.empty(0)
        rows = slice(good[0], good[-1] + 1)
        temps = np.full(at[good[-1]] - at[good[0]] + 1, np.nan)
        temps[at[rows] - at[good[0]]] = temps_c[rows]
        return temps


@checked
def read_capture(path: str | os.PathLike[str], /) -> Capture:
    """Reads a capture of ``zerorate capture`` or ``calibrate --log``: Arrow stream, Parquet or CSV.

    A file whose end is missing is read up to its last whole batch, with a UserWarning. A file with invalid readings
    gives a UserWarning too, and `Capture.flags` marks these readings.

    Raises
    ------
    ValueError
        If the file is not a capture, or is damaged; the text says where.
    OSError
        If the file cannot be read.
    """
    capture = Capture(**_zerorate.read_capture(os.fspath(path)))
    if capture.warning is not None:
        warnings.warn(capture.warning, stacklevel=3)
    return capture
