"""The programs that a station starts. Each is a process of its own, which ends when the station is told to end."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

LIFE_SIGN_S = 60
"""A program that is still at work is mentioned this often."""
GRACE_S = 10
"""How long a program may take to end after it was interrupted."""


class Stopped(Exception):
    """The station ends: what a program says now does not count."""


@dataclass(frozen=True)
class Done:
    """How a program ended."""

    code: int
    """Exit code; negative for a signal."""
    error: str
    """What it wrote to stderr."""

    def reason(self) -> str:
        """The line that says what went wrong. A program that a signal ended says nothing itself."""
        if self.code < 0:
            return f"ended by signal {-self.code}"
        lines = [line for line in self.error.splitlines() if line.strip()]
        said = [line for line in lines if line.startswith(("error: ", "refused: "))]
        return (said or lines or [f"ended with {self.code} and said nothing"])[-1].split(": ", 1)[-1]

    def refusal(self) -> str | None:
        """The code of a refusal, such as ``small-span``."""
        codes = [line[6:].split(" ")[0] for line in self.error.splitlines() if line.startswith("code: ")]
        return codes[0] if codes else None


@dataclass
class Children:
    """The programs at work, on any number of threads."""

    running: set[subprocess.Popen[str]] = field(default_factory=set)
    lock: threading.Lock = field(default_factory=threading.Lock)
    stopping: bool = False

    def run(self, arguments: Sequence[str], alive: Callable[[float], None]) -> Done:
        """Runs ``zerorate`` to its end; calls ``alive`` with the seconds now and then."""
        child = self.start(arguments)
        began = time.monotonic()
        try:
            while True:
                try:
                    _, error = child.communicate(timeout=LIFE_SIGN_S)
                    break
                except subprocess.TimeoutExpired:
                    alive(time.monotonic() - began)
        finally:
            with self.lock:
                self.running.discard(child)
        if self.stopping:
            raise Stopped
        return Done(child.returncode, error)

    def start(self, arguments: Sequence[str]) -> subprocess.Popen[str]:
        """Starts a program in a session of its own: Ctrl-C reaches the station alone, which then ends the program."""
        with self.lock:
            if self.stopping:
                raise Stopped
            child = subprocess.Popen(
                [sys.executable, "-m", "zerorate", *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                start_new_session=True,
            )
            self.running.add(child)
            return child

    def stop(self) -> None:
        """Interrupts all programs, and kills those that do not end."""
        with self.lock:
            self.stopping = True
            running = list(self.running)
        for child in running:
            child.send_signal(signal.SIGINT)
        last = time.monotonic() + GRACE_S
        while any(child.poll() is None for child in running) and time.monotonic() < last:
            time.sleep(0.05)
        for child in running:
            if child.poll() is None:
                child.kill()
