"""Recordings of a device's raw codes."""

from __future__ import annotations

import os
from dataclasses import dataclass

from . import _device, _zerorate
from ._keywords import checked
from ._settling import Seconds


@dataclass(frozen=True)
class Captured:
    """The result of a recording: the keys of ``zerorate capture --json``. `read_capture` reads the recorded file."""

    file: str
    """Path of the file."""
    samples: int
    """Number of rate samples in the file."""
    lost_samples: int
    """Number of rate samples lost."""
    rate_hz: float
    """Rate samples read per second, without lost ones."""
    rdy_hz: float
    """Data-ready edges per second."""
    duration_s: float
    """Time from the first sample to the last, s."""
    interrupted: bool
    """True if the recording was ended early."""
    impossible_readings: int
    """Number of readings that are impossible for the sensor (bit errors)."""
    impossible_temps: int
    """Number of temperatures that are impossible for the sensor."""
    out_of_range: int
    """Number of readings out of range."""
    unjudged: int
    """Number of readings that were not checked for bit errors: their neighbours are too far away in time, or the
    limits of the sensor are unknown."""
    frozen: bool
    """True if the readings no longer changed at the end; `capture` then raises `Refused`."""
    warnings: list[str]
    """Warnings, each ``code: text``: what was seen and what to do."""


@checked
def capture(
    device: _device.Device,
    output: str | os.PathLike[str],
    /,
    *,
    duration: Seconds | None = None,
    samples: int | None = None,
    part: str | os.PathLike[str] | None = None,
    every_temp: int | None = None,
    divider: int | None = None,
    realtime: bool = False,
    serial: str | None = None,
    supply_note: str | None = None,
    ambient_note: str | None = None,
    operator: str | None = None,
    force: bool = False,
    progress: _device.OnProgress | None = None,
) -> Captured:
    """Records the raw codes of a device with their times, as ``zerorate capture`` does.

    Other threads run meanwhile. Ctrl-C ends the recording early. The file then has all samples until Ctrl-C.

    Parameters
    ----------
    device
        See `calibrate`.
    output
        The file: ``.arrows``, ``.parquet`` or ``.csv``.
    duration
        Duration of the recording in the sensor's time: seconds, or a text such as ``"1h30m"``; None for ten minutes.
    samples
        Number of samples to record instead of a duration.
    part, every_temp, divider, realtime, serial, supply_note, ambient_note, operator, progress
        See `calibrate`.
    force
        Overwrite an existing file, but never the recording that is replayed.

    Returns
    -------
    Captured

    Raises
    ------
    ZerorateError
        If the device cannot be opened or read. The file has the samples up to the error.
    Refused
        If the readings no longer changed at the end. The file is complete.
    ValueError
        For invalid options.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "rest.arrows"
    >>> capture("twin:seed=7", file, samples=1000).samples
    1000
    """
    if duration is not None and samples is not None:
        raise ValueError("give duration= or samples=, not both")
    arguments = {**locals(), "output": os.fspath(output), "duration": "10m" if duration is None else duration}
    read = _device.options(device, part, every_temp, divider, realtime)
    return Captured(**_zerorate.capture(read, arguments, _device.showing(progress)))
