"""The columns of a log that are the axes of an IMU: arguments that `imu` and `tempcal` share."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _log, _records

if TYPE_CHECKING:
    from . import _zerorate

    OfKind = tuple[list[str], str | None, float | None]

OF_READING = (
    "rate_hz", "time_column", "time_unit", "force_unit", "increments", "decimal", "raw", "max_bad", "topic", "where",
    "skip", "until",
)
"""Names of the arguments for reading any log."""

OF_AXES = (
    "column", "columns", "gyro", "accel", "gyro_unit", "accel_unit", "gyro_scale", "accel_scale", "part", "gyro_range",
    "accel_range",
)
"""Names of the arguments for the axes in a log."""


PLACES = (("x", "y", "z"), ("X", "Y", "Z"), ("roll", "pitch", "yaw"))
"""Words by which the names of three axes state their places."""


def in_order(names: list[str]) -> list[str]:
    """Three names in the order x, y, z if they differ in a word of `PLACES` alone; otherwise in their own order."""
    first = names[0]
    for words in PLACES:
        for own, at in ((own, at) for own in words for at in range(len(first)) if first.startswith(own, at)):
            ordered = [first[:at] + word + first[at + len(own) :] for word in words]
            if sorted(ordered) == sorted(names):
                return ordered
    return names


@dataclass(frozen=True)
class AskedAxes:
    """The axes in the form that the extension takes."""

    names: list[str] | None
    gyro: OfKind
    accel: OfKind
    codes: tuple[str | None, float | None, float | None]
    columns: Sequence[str] | None
    options: _zerorate._Options

    @classmethod
    def of(cls, arguments: Mapping[str, Any], logs: Sequence[Any]) -> AskedAxes:
        """Converts the arguments, by their names. A `Log` among the logs states its rate."""
        column, part = arguments["column"], arguments["part"]
        gyro, accel = ([str(name) for name in arguments[kind] or ()] for kind in ("gyro", "accel"))
        if column is not None and (gyro or accel):
            raise ValueError("give column, or gyro and accel, not both")
        reading = {name: arguments[name] for name in OF_READING}
        if reading["rate_hz"] is None:
            reading["rate_hz"] = next((one.rate_hz for one in logs if isinstance(one, _log.Log)), None)
        return cls(
            None if column is None else [str(name) for name in _log.listed(column)],
            (gyro, arguments["gyro_unit"], number(arguments["gyro_scale"])),
            (accel, arguments["accel_unit"], number(arguments["accel_scale"])),
            (
                None if part is None else os.fspath(part),
                number(arguments["gyro_range"]),
                number(arguments["accel_range"]),
            ),
            arguments["columns"],
            _log.options(reading),
        )

    def source(self, log: Any, example: str) -> _records.Source:
        """A log in the form that the extension takes. `example` shows how to name the columns of an array."""
        if isinstance(log, _log.Log):
            log = log._stating_units()
        columns = self.columns
        if _records.is_array(log) and columns is None:
            if not (self.gyro[0] or self.accel[0]):
                raise ValueError(f"an array does not say which column is which axis: give {example}")
            columns = [f"column_{index}" for index in range(np.atleast_2d(np.asarray(log)).shape[1])]
        return _records.table(log, columns)


def number(given: float | None) -> float | None:
    return None if given is None else float(given)
