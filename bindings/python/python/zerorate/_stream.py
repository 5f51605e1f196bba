"""The corrected rate of a device, row by row."""

from __future__ import annotations

import os
from collections.abc import Iterator
from types import TracebackType
from typing import NamedTuple

from . import _device, _zerorate
from ._calibration import Calibration
from ._keywords import checked
from ._settling import Seconds


class StreamRow(NamedTuple):
    """A row of a `Stream`: the corrected rates at one time."""

    t_s: float
    """Time of the middle of the row's samples, s since the first sample."""
    rates_dps: list[float]
    """Corrected rate of each axis, °/s, in the order of `Stream.axes`; NaN without a good reading."""
    temp_c: float
    """Temperature with which the row was corrected, °C."""
    lost: int
    """Samples lost since the previous row."""
    flags: str
    """The faults of readings that were left out: ``impossible``, ``out-of-range``, ``impossible-temperature``,
    ``frozen``, joined by ``+``; empty for none."""

    @property
    def rate_dps(self) -> float:
        """Corrected rate of the only axis, °/s.

        Raises
        ------
        ValueError
            If there are several axes.
        """
        if len(self.rates_dps) != 1:
            raise ValueError(f"the part has {len(self.rates_dps)} axes: take one of rates_dps")
        return self.rates_dps[0]


class Stream(Iterator[StreamRow]):
    """Iterates over the corrected rows of a device that `stream` opened. ``with`` closes the stream at its end, and so
    does a loop over all rows.

    A thread reads the device. Rows wait while the program is busy. If it is busy for too long, samples of a real
    sensor are lost, and `StreamRow.lost` counts them.
    """

    def __init__(self, inner: _zerorate.Stream, device: str) -> None:
        self._inner, self._device = inner, device

    @property
    def axes(self) -> list[str]:
        """Names of the axes of the part."""
        return self._inner.axes

    def __next__(self) -> StreamRow:
        row = self._inner.next()
        if row is None:
            raise StopIteration
        return StreamRow(*row)

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the device; no more rows follow. A second call does nothing."""
        self._inner.close()

    def __repr__(self) -> str:
        return f"<Stream of {self._device}: {', '.join(self.axes)}>"


@checked
def stream(
    device: _device.Device,
    calibration: Calibration | str | os.PathLike[str],
    /,
    *,
    rate_hz: float | None = None,
    duration: Seconds | None = None,
    part: str | os.PathLike[str] | None = None,
    every_temp: int | None = None,
    divider: int | None = None,
    realtime: bool = False,
    serial: str | None = None,
) -> Stream:
    """Opens a device and gives its corrected rate row by row, as ``zerorate stream`` does.

    Ctrl-C ends a wait for the next row. To learn the bias at rest, use ``zerorate stream --track``.

    Parameters
    ----------
    device
        See `calibrate`.
    calibration
        The calibration to apply, or the path of its file.
    rate_hz
        Rows per second, each the mean of all samples in its interval; unless given, a row for each sample.
    duration
        Duration of the stream in the sensor's time: seconds, or a text such as ``"10m"``. Unless given, only the end
        of a replayed recording ends the stream.
    part, every_temp, divider, realtime
        See `calibrate`.
    serial
        The serial number of the sensor. A calibration with another serial number is an error.

    Returns
    -------
    Stream
        An iterator of `StreamRow`, and a context manager.

    Raises
    ------
    ZerorateError
        If the device cannot be opened or read.
    Refused
        If the sensor is frozen.
    ValueError
        For invalid options, or if the sensor has another serial number than the calibration.

    Examples
    --------
    >>> known = calibrate("twin:seed=7", average=5, warmup=30, settle=10, offset=15, max_u_btc=1).calibration
    >>> with stream("twin:seed=7", known, rate_hz=10, duration=1) as rows:
    ...     len([row.rate_dps for row in rows])
    10
    """
    read = _device.options(device, part, every_temp, divider, realtime)
    known = calibration if isinstance(calibration, Calibration) else Calibration.load(calibration)
    inner = _zerorate.Stream(read, known._core, serial, None if rate_hz is None else float(rate_hz), duration)
    return Stream(inner, read["device"])
