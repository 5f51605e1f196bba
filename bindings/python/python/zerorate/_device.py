"""Devices, and the progress of work with them."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, Union

from ._twin import Twin

if TYPE_CHECKING:
    from . import _zerorate

Device = Union[str, Twin]
"""An address as in ``zerorate help device``, such as ``"spi:/dev/spidev0.0?rdy=gpiochip0:25"``, or a `Twin`."""


class Progress(NamedTuple):
    """Progress of a measurement."""

    step: str
    """The step, in words."""
    done: float
    """Time since the first sample, s of the sensor's time; with ``samples=``, the number of samples so far."""
    total: float
    """The value that `done` has at the end."""


OnProgress = Callable[[Progress], object]
"""Called at most ten times a second and once at the end, in the thread of the caller. An exception ends the work."""


def options(
    device: Device,
    part: str | os.PathLike[str] | None,
    every_temp: int | None,
    divider: int | None,
    realtime: bool,
) -> _zerorate._Device:
    """The device in the form that the extension takes."""
    if not isinstance(device, (str, Twin)):
        raise TypeError(f"a device is a text such as 'spi:/dev/spidev0.0?rdy=gpiochip0:25', or a Twin, not {device!r}")
    return {
        "device": device if isinstance(device, str) else device.device,
        "part": None if part is None else os.fspath(part),
        "every_temp": every_temp,
        "divider": divider,
        "realtime": realtime,
    }


def showing(progress: OnProgress | None) -> Callable[[str, float, float], Any] | None:
    return None if progress is None else lambda *step: progress(Progress(*step))
