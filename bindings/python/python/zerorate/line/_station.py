"""A station: reads serial numbers, tests one unit on each device, judges and records."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from types import FrameType

from ._children import Children, Stopped
from ._errors import LineError
from ._limits import Limits
from ._measurement import Measurement, serial_problem
from ._record import Record
from ._screen import Screen
from ._trial import Settings, Trial, stamp


@dataclass
class Station:
    """The devices of a station and the units on them."""

    record: Record
    limits: Limits
    settings: Settings
    devices: Sequence[str]
    once: bool = False
    """Test one unit on each device."""
    screen: Screen = field(default_factory=Screen)
    children: Children = field(default_factory=Children)
    testing: dict[Future[str], Trial] = field(default_factory=dict)
    outcomes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        if len(set(self.devices)) < len(self.devices):
            raise LineError("a device was given twice: each has one unit at a time")

    def run(self) -> int:
        """Tests units until the input ends, or one on each device. Returns the exit code."""
        prepare(self.settings)
        with ThreadPoolExecutor(len(self.devices)) as pool:
            try:
                self.test_units(pool)
            except BaseException:
                self.children.stop()
                raise
        return exit_code(self.outcomes)

    def test_units(self, pool: ThreadPoolExecutor) -> None:
        """Starts a trial for each serial number, and waits for the last."""
        for place in self.places():
            serial = self.ask(place)
            if serial is None:
                break
            trial = Trial(serial, self.devices[place], place, self.settings, stamp())
            self.testing[pool.submit(self.test, trial)] = trial
        while self.testing:
            self.collect()

    def places(self) -> Iterator[int]:
        """The devices that are free, one after the other; waits where none is."""
        if self.once:
            yield from range(len(self.devices))
            return
        while True:
            busy = {trial.place for trial in self.testing.values()}
            free = [place for place in range(len(self.devices)) if place not in busy]
            if free:
                yield free[0]
            else:
                self.collect()

    def collect(self) -> None:
        """Waits for the end of a trial, and takes all that have ended."""
        for future in wait(self.testing, return_when=FIRST_COMPLETED).done:
            self.testing.pop(future)
            self.outcomes.append(future.result())

    def ask(self, place: int) -> str | None:
        """A serial number that can be one; None at the end of the input."""
        while True:
            self.screen.ask(f"serial number for {self.devices[place]}:")
            line = sys.stdin.readline()
            if not line:
                self.end_of_input(place)
                return None
            serial = line.strip()
            problem = serial_problem(serial) or self.elsewhere(serial)
            if problem is None:
                return serial
            self.screen.say(f"the serial number {problem}: give it again")

    def end_of_input(self, place: int) -> None:
        """The end of the input is an error where a unit was expected."""
        if self.once:
            self.screen.say(f"error: the input ended before a serial number for {self.devices[place]}")
            self.outcomes.append("error")

    def elsewhere(self, serial: str) -> str | None:
        """The other device on which a unit is under test."""
        trials = [trial for future, trial in self.testing.items() if not future.done()]
        devices = [trial.device for trial in trials if trial.serial == serial]
        return f"{serial} is under test on {devices[0]}" if devices else None

    def test(self, trial: Trial) -> str:
        """Tests a unit and records it; returns the outcome."""
        try:
            measurement = trial.run(self.children, lambda text: self.screen.say(f"{trial.device}: {text}"))
            outcome = self.enter(trial, measurement)
        except Stopped:
            return "stopped"
        except (LineError, OSError) as error:
            self.screen.verdict("error", trial.serial, trial.device, f"nothing was recorded: {error}")
            return "error"
        text = measurement.error or ""
        self.screen.verdict(outcome, trial.serial, trial.device, text, measurement.simulated)
        if measurement.state == "ok":
            self.screen.label(measurement, outcome)
        return outcome

    def enter(self, trial: Trial, measurement: Measurement) -> str:
        """Records a measurement; returns the outcome of the unit."""
        try:
            added = self.record.add(measurement, self.limits)
        except LineError as error:
            again = f". Enter it later: zerorate line add {trial.calibration}" if measurement.state == "ok" else ""
            raise LineError(f"{error}{again}") from None
        if measurement.state != "ok":
            return "refused" if measurement.state == "refused" else "error"
        return (added.verdict if added else self.known_verdict(trial, measurement)) or "undecided"

    def known_verdict(self, trial: Trial, measurement: Measurement) -> str | None:
        """The verdict on a measurement that the record has: a twin gives the same samples again."""
        self.screen.say(f"{trial.device}: {trial.serial}: the record has these samples already")
        found = self.record.history(measurement.serial, measurement.part)
        same = [one for one in found if one.fields["calibration_sha256"] == measurement.calibration_sha256]
        return same[0].verdict if same else None


def prepare(settings: Settings) -> None:
    """Makes the folder, lets any input be read, and turns the end of a session into Ctrl-C."""
    try:
        settings.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LineError(f"the folder {settings.folder}: {error.strerror or error}; give another --folder") from None
    if hasattr(sys.stdin, "reconfigure"):
        sys.stdin.reconfigure(encoding="utf-8", errors="surrogateescape")
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), interrupt)


def interrupt(_number: int, _frame: FrameType | None) -> None:
    """Ends the station as Ctrl-C does: the programs of the units end first."""
    raise KeyboardInterrupt


def exit_code(outcomes: Sequence[str]) -> int:
    """0 if all units passed, 1 if one did not or could not be tested, otherwise 3: one was refused."""
    others = set(outcomes) - {"pass"}
    return 0 if not others else 3 if others == {"refused"} else 1
