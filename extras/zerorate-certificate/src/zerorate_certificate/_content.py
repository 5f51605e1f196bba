"""The content of a certificate. Page and XML are made from the same content, so that both state the same."""

from __future__ import annotations

import os
import re
import warnings
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import TypeVar

from zerorate import Calibration, Run, Validity

from ._lab import Lab
from ._quantity import CELSIUS, DPS, Quantity
from ._results import AxisResult, axis_result
from ._statements import Statement, statements_of

SIMULATED = "SIMULATED"

_Stated = TypeVar("_Stated")


@dataclass(frozen=True)
class Content:
    """A calibration, the laboratory's part, and values derived from both."""

    calibration: Calibration
    run: Run
    validity: Validity
    lab: Lab
    simulated: bool
    serial: str
    begin: date
    """First day of the measurement; the day of issue if the item was simulated."""
    end: date
    """Last day of the measurement; the day of issue if the item was simulated."""
    axes: list[AxisResult]
    statements: list[Statement]

    @classmethod
    def load(cls, calibration_path: str | os.PathLike[str], lab: Lab) -> Content:
        """Reads and checks the content. Raises ValueError for the same reasons as `certificate_xml`."""
        try:
            return cls._of(_load(calibration_path), lab)
        except UnicodeDecodeError:
            name = os.fspath(calibration_path)
            raise ValueError(f"{name}: this is not text in UTF-8, so not a calibration") from None
        except ValueError as error:
            raise ValueError(f"{os.fspath(calibration_path)}: {error}") from None

    @classmethod
    def _of(cls, calibration: Calibration, lab: Lab) -> Content:
        run = _stated(calibration.run, "[run]")
        validity = _stated(calibration.validity, "[validity]")
        _stated(calibration.method, "method")
        simulated = is_simulated(calibration)
        begin, end = (lab.issued, lab.issued) if simulated else _days(calibration, run, lab)
        return cls(
            calibration=calibration,
            run=run,
            validity=validity,
            lab=lab,
            simulated=simulated,
            serial=_serial(calibration, lab),
            begin=begin,
            end=end,
            axes=[axis_result(axis, validity, alone=len(calibration.axes) == 1) for axis in calibration.axes],
            statements=statements_of(calibration, run, validity, lab, simulated),
        )

    @property
    def item_name(self) -> str:
        """The item in words."""
        if self.simulated:
            return f"{SIMULATED}: the software twin of a gyroscope"
        return "Gyroscope" if len(self.axes) == 1 else f"Gyroscope with {len(self.axes)} axes"

    @property
    def title(self) -> str:
        """The title of the certificate, which says if the item was simulated."""
        return f"{SIMULATED}: calibration certificate" if self.simulated else "Calibration certificate"

    @property
    def measured_conditions(self) -> list[Quantity]:
        """The conditions that the calibration file states as numbers."""
        lowest, highest = self.validity.temp_min_c, self.validity.temp_max_c
        known = [
            Quantity("Temperature of the part's own sensor, lowest", lowest, CELSIUS, decimals=2),
            Quantity("Temperature of the part's own sensor, highest", highest, CELSIUS, decimals=2),
        ]
        if self.run.earth_dps is not None:
            known.append(Quantity("Component of the Earth's rotation, subtracted", self.run.earth_dps, DPS))
        return known

    @property
    def settings(self) -> str:
        """Settings with which the method was carried out."""
        run, calibration = self.run, self.calibration
        texts = [
            f"Recorded for {run.duration_s:.0f} s: {run.samples} samples at {run.rate_hz:.6g} Hz, "
            f"{run.lost_samples} lost."
        ]
        if run.average_s:
            texts.append(
                f"Averages of {run.average_s:g} s, warm-up {run.warmup_s:g} s, settling {run.settle_s:g} s, "
                f"average for PBC {run.offset_s:g} s."
            )
        texts += [f"Read from {calibration.device}."] if calibration.device else []
        texts += [f"Settings: {calibration.config}."] if calibration.config else []
        texts += [f"Measured by {calibration.operator}."] if calibration.operator else []
        return " ".join(texts)

    @property
    def notes(self) -> list[tuple[str, str]]:
        """The conditions that were noted in words."""
        calibration = self.calibration
        named = [("Supply", calibration.supply_note), ("Surroundings", calibration.ambient_note)]
        return [(name, note) for name, note in named if note]

    @property
    def warnings(self) -> list[str]:
        """The text of each warning of the measurement, without its code."""
        of_axes = [
            _words(warning) if result.name is None else f"axis {result.name}: {_words(warning)}"
            for axis, result in zip(self.calibration.axes, self.axes)
            for warning in axis.warnings
        ]
        return [*map(_words, self.calibration.warnings), *of_axes]


def _words(warning: str) -> str:
    return re.sub(r"^[a-z][a-z0-9-]*: ", "", warning)


def is_simulated(calibration: Calibration) -> bool:
    """True if the software twin was calibrated: the file is marked as simulated, or its device is the twin."""
    device = calibration.device or ""
    return calibration.created == SIMULATED or device == "twin" or device.startswith("twin:")


def _load(path: str | os.PathLike[str]) -> Calibration:
    text = Path(path).read_text(encoding="utf-8")
    with warnings.catch_warnings():
        # the only possible warning is a missing checksum, without which the numbers may not be measured ones
        warnings.simplefilter("error", UserWarning)
        try:
            return Calibration.parse(text)
        except UserWarning:
            raise ValueError(
                "this calibration has no check lines, so it was written or changed by hand. "
                "A certificate needs the file that a measurement wrote"
            ) from None


def _stated(value: _Stated | None, key: str) -> _Stated:
    if value is None:
        raise ValueError(f"this calibration has no {key}. A certificate needs the file that a measurement wrote")
    return value


def _serial(calibration: Calibration, lab: Lab) -> str:
    measured = (calibration.serial or "").strip()
    if measured and lab.item.serial and measured != lab.item.serial:
        raise ValueError(
            f"the serial number is {measured!r} here and {lab.item.serial!r} in the laboratory's file. "
            "Take the file of the right item"
        )
    serial = measured or lab.item.serial
    if not serial:
        raise ValueError("this calibration has no serial number: state item.serial in the laboratory's file")
    return serial


def _days(calibration: Calibration, run: Run, lab: Lab) -> tuple[date, date]:
    created = _stated(calibration.created, "time (created)")
    try:
        began = datetime.fromisoformat(created.replace("Z", "+00:00"))
        ended = began + timedelta(seconds=run.duration_s)
    except (ValueError, OverflowError):
        raise ValueError(f"the time of the measurement, {created!r}, is not an RFC 3339 time") from None
    begin, end = began.date(), ended.date()
    if lab.issued < end:
        raise ValueError(f"dates.issued, {lab.issued}, is before the end of the measurement, {end}")
    if lab.received is not None and lab.received > begin:
        raise ValueError(f"dates.received, {lab.received}, is after the begin of the measurement, {begin}")
    return begin, end
