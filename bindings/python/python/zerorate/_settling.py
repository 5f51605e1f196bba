"""The options for the temperature of a record, and for its beginning, which can be left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _log, _records, _zerorate
from ._capture import Capture

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Temperature = tuple[str, NDArray[np.float64]]
    """Name of the temperature, and its value for each sample, °C."""

Seconds = Union[float, str]
"""Seconds as a number, or a duration as the command line takes it: ``"10m"``, ``"1h30m"``."""

_OWN = "temp_c"
"""The name of a temperature that is given beside the record, or is from a capture."""


@dataclass(frozen=True)
class Settling:
    """The arguments ``temp_c``, ``detrend`` and ``skip`` of `allan` and `imu`."""

    temp_c: Any = None
    detrend: int | None = None
    skip: Seconds = 0.0

    @classmethod
    def of(cls, temp_c: Any, detrend: int | None, skip: Seconds | None, is_phase: bool) -> Settling:
        if detrend is not None and detrend not in (1, 2, 3):
            raise ValueError(f"detrend={detrend!r}: give 1, 2 or 3, the order of a polynomial over temperature")
        if is_phase and (detrend is not None or temp_c is not None):
            raise ValueError("detrend= and temp_c= need a rate, not data='phase'")
        return cls(temp_c, detrend, 0.0 if skip is None else skip)

    def of_array(self, samples: int) -> Temperature | None:
        """The temperature of a record without columns."""
        if isinstance(self.temp_c, str):
            raise ValueError("temp_c= is the name of a column, and the record has none: give the temperatures")
        if self.temp_c is None:
            return None
        temps = np.asarray(_records.record(self.temp_c, "phase", "temp_c"), dtype=np.float64)
        if len(temps) != samples:
            raise ValueError(f"temp_c has {len(temps)} values for {samples} samples: give one for each")
        return _OWN, temps

    def of_source(self, source: _records.Source, given: _zerorate._Options) -> Temperature | None:
        name = self.temp_c if isinstance(self.temp_c, str) else None
        label = source if isinstance(source, str) else source[0]
        if self.temp_c is not None and name is None:
            if isinstance(source, str):
                raise ValueError("for a log, temp_c= is the name of a column in it")
            cells = next((len(cells) for _, cells in source[1] if not isinstance(cells, int)), 0)
            temperature = self.of_array(cells)
            others = [(key, cells) for key, cells in source[1] if key != _OWN]
            source, name = (label, others + ([temperature] if temperature else [])), _OWN
        found = _zerorate.read_temperature(source, name, _log.with_time(source, given))
        if found is None and name is not None:
            raise ValueError(f"temp_c=: {label} has no column {name!r} of numbers")
        if found is None and self.detrend is not None:
            names = ", ".join(_zerorate.temperatures())
            raise ValueError(f"detrend=: {label} has no column {names}; give temp_c=")
        return found

    def of_capture(self, capture: Capture, axis: int) -> Temperature | None:
        """The temperature from the first valid rate of an axis of a capture to the last."""
        given = self.of_array(len(capture))
        return _OWN, capture._temps_c(axis, capture.temp_c if given is None else given[1])

    def asked(self, name: str, temperature: Temperature | None) -> _zerorate._Settling | None:
        """The temperature and the options for the extension; None if the column `name` needs neither."""
        if temperature is None and self.detrend is not None:
            raise ValueError("detrend= needs the temperature of each sample: give temp_c=")
        temps = None if temperature is None or temperature[0] == name else temperature[1]
        if temps is None and not self.skip:
            return None
        return {"temps_c": temps, "detrend": self.detrend, "skip": str(self.skip)}
