"""One measurement of a unit, as it is entered into the record."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone

from ._chain import sha256
from ._errors import LineError
from ._tables import NUMBERS

SERIAL_LENGTH = 80
PART_LENGTH = 40
STATES = ("ok", "refused", "failed", "killed")


@dataclass(frozen=True)
class AxisResult:
    """The numbers of one axis."""

    axis: str
    """Its name; an ADIS16130 has only ``rate``."""
    numbers: Mapping[str, float | None]
    """Values and standard uncertainties, with the names and units of `zerorate.line._tables`."""

    def __post_init__(self) -> None:
        for name, value in self.numbers.items():
            if name not in NUMBERS:
                raise LineError(f"{name} is not a number of a result")
            if value is not None and not math.isfinite(value):
                raise LineError(f"{name} of the axis {self.axis} is not a finite number")


@dataclass(frozen=True)
class Measurement:
    """A measurement of one unit: what was done, when, with which result.

    The same samples by the same recipe are the same measurement, so that entering them again adds nothing.
    """

    serial: str
    """Serial number of the unit."""
    part: str
    """Kind of the part, such as ``ADIS16130``."""
    recipe: str
    """What was done to the samples: with them it identifies the measurement."""
    state: str = "ok"
    """``ok``, ``refused`` (must not become a calibration), ``failed`` or ``killed``."""
    simulated: bool = False
    """Whether the part was the software twin."""
    results: tuple[AxisResult, ...] = ()
    """One for each axis; none unless the state is ``ok``."""
    code: str | None = None
    """Code of the refusal or error."""
    error: str | None = None
    """Its text."""
    measured: str | None = None
    """When the samples were recorded, RFC 3339; None if it is not known."""
    method: str | None = None
    """The method, such as ``an1042``."""
    program: str | None = None
    """The program that computed the results."""
    device: str | None = None
    """Where the samples came from."""
    station: str | None = None
    """Name of the station."""
    operator: str | None = None
    """Name of the person who measured."""
    warnings: tuple[str, ...] = field(default=())
    """Warnings of the measurement."""
    calibration_id: str | None = None
    """Short identifier of the calibration."""
    capture: str | None = None
    """File or address of the samples."""
    capture_sha256: str | None = None
    """Hash of the samples."""
    calibration: str | None = None
    """The calibration's file."""
    calibration_sha256: str | None = None
    """Hash of this file's bytes."""
    toml: str | None = None
    """Text of this file."""

    def __post_init__(self) -> None:
        wrong = serial_problem(self.serial)
        if wrong:
            raise LineError(f"the serial number {self.serial!r} {wrong}")
        if not 0 < len(self.part) <= PART_LENGTH:
            raise LineError(f"the unit {self.serial} has no kind of part, or one longer than {PART_LENGTH} characters")
        if self.state not in STATES:
            raise LineError(f"the state {self.state!r} is not one of {', '.join(STATES)}")
        if bool(self.results) != (self.state == "ok"):
            raise LineError(f"a measurement that is {self.state} has {len(self.results)} results")

    @property
    def identity(self) -> str:
        """What tells this measurement of the unit from others."""
        return sha256([self.capture_sha256 or self.capture or self.calibration_sha256, self.recipe])


def serial_problem(serial: str) -> str | None:
    """What is wrong with a serial number; None if nothing is."""
    if not serial.strip():
        return "is empty"
    if serial != serial.strip():
        return "begins or ends with a blank"
    if len(serial) > SERIAL_LENGTH:
        return f"is longer than {SERIAL_LENGTH} characters"
    if any(unicodedata.category(letter) in ("Cc", "Cf", "Cs", "Zl", "Zp") for letter in serial):
        return "has control characters"
    return None


def utc(text: str | None) -> str | None:
    """A time of RFC 3339 in UTC, so that times sort as texts; None if there is none."""
    if not text:
        return None
    try:
        time = datetime.fromisoformat(re.sub(r"\.\d+", "", text).replace("Z", "+00:00"))
    except ValueError:
        raise LineError(f"{text!r} is not a time as RFC 3339 writes it, such as 2026-11-25T14:03:00Z") from None
    if time.tzinfo is None:
        raise LineError(f"the time {text!r} has no zone; write Z for UTC")
    return time.astimezone(timezone.utc).isoformat(timespec="milliseconds")


def now() -> str:
    """The time in UTC."""
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")
