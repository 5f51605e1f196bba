"""The test of one unit on one device: probe, calibrate, and what the two left on the disk."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import NoReturn

from ._children import Children, Done
from ._errors import LineError
from ._files import read_calibration
from ._measurement import Measurement

DEFAULT_PART = "ADIS16130"
"""The part of a unit whose calibration was refused; a calibration states it itself."""
OWN = ("--device", "-d", "--serial", "--log", "--output", "-o", "--operator", "--json", "--no-save", "--force")
"""Options of `zerorate calibrate` that the station gives itself."""
USAGE = 2
REFUSED = 3


@dataclass(frozen=True)
class Settings:
    """What is the same for all units of a station."""

    folder: Path
    """Where captures and calibrations go."""
    options: Sequence[str]
    """Options of `zerorate calibrate`."""
    station: str | None
    """Name of the station."""
    operator: str | None
    """Who tests."""

    def __post_init__(self) -> None:
        for option in self.options:
            if option.split("=")[0] in OWN or re.match(r"-[do].", option):
                raise LineError(f"the station gives {option.split('=')[0]} itself: leave it out behind --")

    @property
    def part(self) -> str:
        """The kind of part, for the record of a refusal."""
        return (shared_options(self.options).part or DEFAULT_PART).upper()

    def probe_options(self) -> list[str]:
        """Those of the options that say how to read the device."""
        given = vars(shared_options(self.options))
        named = [(f"--{name.replace('_', '-')}", value) for name, value in given.items() if value]
        return [word for name, value in named for word in ([name] if value is True else [name, value])]


class Lenient(argparse.ArgumentParser):
    """Leaves errors to `zerorate calibrate`, which explains them."""

    def error(self, message: str) -> NoReturn:
        """Called for an option without its value."""
        raise LineError(f"behind --: {message}")


def shared_options(options: Sequence[str]) -> argparse.Namespace:
    """The options that `probe` and `calibrate` share."""
    parser = Lenient(add_help=False, allow_abbrev=False)
    for name in ("--part", "--every-temp", "--divider"):
        parser.add_argument(name)
    parser.add_argument("--realtime", action="store_true")
    return parser.parse_known_args(list(options))[0]


@dataclass(frozen=True)
class Trial:
    """A unit on a device."""

    serial: str
    device: str
    place: int
    """Number of the device in the station."""
    settings: Settings
    stamp: str
    """When it began, as a part of its files' names."""

    def run(self, children: Children, say: Callable[[str], None]) -> Measurement:
        """Tests the unit, and returns what is to be entered.

        Raises
        ------
        LineError
            If it could not be tested for a reason that is not the unit's.
        Stopped
            If the station was told to end.
        """
        say(f"{self.serial}: probing")
        probe = ["probe", "--device", self.device, *self.settings.probe_options()]
        done = children.run(probe, lambda seconds: say(f"{self.serial}: probing for {seconds:.0f} s"))
        if done.code == 0:
            say(f"{self.serial}: calibrating")
            done = children.run(self.command, lambda seconds: say(f"{self.serial}: calibrating for {seconds:.0f} s"))
        if done.code == USAGE:
            raise LineError(f"the options of zerorate are wrong, --device or one behind --: {done.reason()}")
        return self.measurement() if done.code == 0 else self.failure(done)

    @property
    def stem(self) -> str:
        """Name of the files, without their endings: no two trials have the same."""
        safe = re.sub(r"[^A-Za-z0-9._-]", "_", self.serial).lstrip(".-")
        return f"{safe or 'unit'}-{self.stamp}-{self.place}"

    @property
    def command(self) -> list[str]:
        """The arguments of the calibration."""
        operator = self.settings.operator
        named = [f"--operator={operator}"] if operator else []
        files = ["--log", str(self.capture), "-o", str(self.calibration)]
        unit = ["--device", self.device, f"--serial={self.serial}"]
        return ["calibrate", *unit, *files, *named, *self.settings.options]

    @property
    def capture(self) -> Path:
        """The file of the samples."""
        return self.settings.folder / f"{self.stem}.arrows"

    @property
    def calibration(self) -> Path:
        """The file of the calibration."""
        return self.settings.folder / f"{self.stem}.toml"

    def measurement(self) -> Measurement:
        """The measurement behind a calibration that is complete and on the disk."""
        for path in (self.capture, self.calibration, self.settings.folder):
            sync(path)
        found = read_calibration(self.calibration, self.capture)
        if found.serial != self.serial:
            raise LineError(f"{self.calibration} is of {found.serial}, and {self.serial} was tested")
        return replace(found, station=self.settings.station)

    def failure(self, done: Done) -> Measurement:
        """The measurement of a unit that was refused or could not be calibrated."""
        state = "killed" if done.code < 0 else "refused" if done.code == REFUSED else "failed"
        return Measurement(
            serial=self.serial,
            part=self.settings.part,
            recipe=f"trial {self.stem}",
            state=state,
            simulated=self.device.startswith("twin:"),
            code=done.refusal() or (f"signal-{-done.code}" if done.code < 0 else None),
            error=done.reason(),
            measured=datetime.now(timezone.utc).isoformat(timespec="milliseconds"),
            device=self.device,
            station=self.settings.station,
            operator=self.settings.operator,
            capture=os.path.abspath(self.capture) if self.capture.exists() else None,
        )


def stamp() -> str:
    """The time as a part of a file's name."""
    return datetime.now(timezone.utc).strftime("%Y%m%dT%H%M%S%f")[:-3]


def sync(path: Path) -> None:
    """Waits until a file or folder is on the disk."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except PermissionError:
        if path.is_dir() and os.name == "nt":
            return  # Windows opens no folder, and keeps names without this
        raise
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
