"""Captures: raw codes on disk. The format is specified in docs/formats/capture.md of the project."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from . import _zerorate

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture as columns of equal length, one row per rate sample."""

    t_ns: NDArray[np.uint64]
    """Time of the data-ready edge, ns."""
    edge_seq: NDArray[np.uint32]
    """Number of the edge."""
    rate_code: NDArray[np.uint32]
    """Raw rate code."""
    status: NDArray[np.int16]
    """Status register of the channel; −1 where it was not read."""
    temp_code: NDArray[np.int32]
    """Raw temperature code; −1 where it was not read."""
    lost: NDArray[np.uint32]
    """Samples lost right before the row."""
    flags: NDArray[np.uint8]
    """What is wrong with the reading, 0 for nothing: the sum of 1 (impossible for the part: a bit error), 2 (out of
    range), 4 (frozen) and 8 (impossible temperature). The codes stay as they were read; `good` says which rates to
    use."""
    width_bits: int
    """Width of both codes: 16 or 24."""
    metadata: dict[str, str] = field(repr=False)
    """The description in the file: device, serial number, registers, …"""
    calibration_id: str | None = None
    """The calibration that was applied, if the file is a corrected one; its raw columns are untouched."""
    warning: str | None = None
    """What is to be said of the file: a tail that was torn off by a power cut, rows that nothing checks."""

    @cached_property
    def good(self) -> NDArray[np.bool_]:
        """Which rates are to be believed."""
        return np.asarray((self.flags & 7) == 0, dtype=np.bool_)

    def __len__(self) -> int:
        return len(self.t_ns)

    @cached_property
    def rate_hz(self) -> float:
        """Samples per second by the timestamps, lost samples counted; NaN for less than two rows."""
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
        """Rate before any correction, °/s: (code − 2²³) / 23 488 for 24-bit codes (data sheet); NaN where it is not
        to be believed."""
        rates = _zerorate.rate_dps(self.rate_code, self.width_bits)
        return np.where(self.good, rates, np.nan)

    @cached_property
    def temp_c(self) -> NDArray[np.float64]:
        """Temperature, °C: (code − 2²³) / 14 093 + 25 for 24-bit codes (data sheet); NaN where it was not read or is
        impossible."""
        temps = _zerorate.temp_c(self.temp_code, self.width_bits)
        return np.where(self.flags & 8, np.nan, temps)

    @cached_property
    def temp_held_c(self) -> NDArray[np.float64]:
        """Temperature, °C, with the last one read standing in where it was not; NaN before the first."""
        read = np.where((self.temp_code >= 0) & (self.flags & 8 == 0), np.arange(len(self)), -1)
        last = np.maximum.accumulate(read) if len(read) else read
        return np.where(last >= 0, self.temp_c[np.maximum(last, 0)], np.nan)

    @property
    def _dps_per_code(self) -> float:
        step = np.array([0, 1], dtype=np.uint32)
        return float(np.diff(_zerorate.rate_dps(step, self.width_bits))[0])

    def _codes(self) -> tuple[NDArray[np.int32], list[tuple[int, int]]]:
        """The rate codes, and where samples are missing between them: index of the next row, how many."""
        good = np.flatnonzero(self.good)
        before = np.cumsum(self.lost, dtype=np.int64) + np.cumsum(~self.good)
        missing = np.diff(before[good])
        at = np.flatnonzero(missing) + 1
        return self.rate_code[good].astype(np.int32), list(zip(at.tolist(), missing[at - 1].tolist()))


def read_capture(path: str | os.PathLike[str]) -> Capture:
    """Reads a capture of ``zerorate capture`` or ``calibrate --log``, in any of its forms: Arrow stream, Parquet, CSV.

    A file whose end was torn off is read up to its last whole batch, with a UserWarning. So is one with readings that
    are not to be believed: `Capture.flags` marks them.

    Raises
    ------
    ValueError
        If the file is no capture, or is damaged; the text says where.
    OSError
        If it cannot be read.
    """
    capture = Capture(**_zerorate.read_capture(os.fspath(path)))
    if capture.warning is not None:
        warnings.warn(capture.warning, stacklevel=2)
    return capture
