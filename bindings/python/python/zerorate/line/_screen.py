"""What a station shows: lines of progress by device, verdicts in large letters, and labels."""

from __future__ import annotations

import sys
import threading
from collections.abc import Sequence
from datetime import datetime, timezone

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from ._letters import large
from ._listing import WORDS, number, printable, word
from ._measurement import Measurement
from ._tables import COEFFICIENTS

COLORS = {"pass": "bold white on green", "fail": "bold white on red", "error": "bold white on red"}
"""Other outcomes are yellow: they need a decision."""


class Screen:
    """The terminal of a station. Each method prints its lines together, whichever thread calls it."""

    def __init__(self) -> None:
        self.console = Console(highlight=False, markup=False, emoji=False, soft_wrap=True)
        self.lock = threading.Lock()

    def say(self, text: str) -> None:
        """Prints a line."""
        self.show([printable(text)])

    def ask(self, text: str) -> None:
        """Prints a question; the answer stands behind it on a terminal."""
        with self.lock:
            self.console.print(printable(text), end=" " if sys.stdin.isatty() else "\n")

    def verdict(self, outcome: str, serial: str, device: str, text: str = "", simulated: bool = False) -> None:
        """Prints the outcome of a unit in large letters."""
        style = COLORS.get(outcome, "bold black on yellow")
        letters = Text(large(WORDS.get(outcome, outcome)), style=style, no_wrap=True)
        words = f"{device}: {serial}: {word(outcome, simulated)}" + (f": {text}" if text else "")
        self.show([Padding(letters, (1, 3), style=style, expand=False), printable(words)])

    def label(self, measurement: Measurement, outcome: str) -> None:
        """Prints the text of the unit's label."""
        self.show(["", *label(measurement, outcome), ""])

    def show(self, lines: Sequence[str | Padding]) -> None:
        """Prints lines together."""
        with self.lock:
            for line in lines:
                self.console.print(line)


def label(one: Measurement, outcome: str) -> list[str]:
    """The text of a label: what a user of the unit needs to correct its rate."""
    lines = [("serial", one.serial), ("part", one.part), ("calibration", one.calibration_id or "-")]
    for result in one.results:
        axis = f" {result.axis}" if len(one.results) > 1 else ""
        for name, unit in zip(COEFFICIENTS, ("°/s", "°/s/°C", "°C")):
            lines.append((f"{name.split('_')[0].upper()}{axis}", f"{number(result.numbers.get(name))} {unit}"))
    date = one.measured or datetime.now(timezone.utc).isoformat()
    lines += [("date", date[:10]), ("verdict", word(outcome, one.simulated))]
    return [f"{name:<12} {value}" for name, value in lines]
