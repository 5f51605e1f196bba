"""Shows progress: a bar on a terminal, or elsewhere a line every ten seconds."""

from __future__ import annotations

import sys
import time

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

LINE_EVERY_S = 10.0


class Progress:
    """Counts files, with their rate and the time to the end."""

    def __init__(self, total: int, is_shown: bool) -> None:
        self.total = total
        self.is_shown = is_shown
        self.done = 0
        self.began = self.said = time.monotonic()
        columns = (
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("files, {task.fields[rate]:.1f}/s"),
            TimeRemainingColumn(),
        )
        self.bar = Bar(*columns, console=Console(stderr=True)) if is_shown and sys.stderr.isatty() else None
        self.task = self.bar.add_task("", total=total, rate=0.0) if self.bar else None

    def __enter__(self) -> Progress:
        if self.bar:
            self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.bar:
            self.bar.stop()

    def advance(self) -> None:
        self.done += 1
        now = time.monotonic()
        rate = self.done / max(now - self.began, 1e-9)
        if self.bar and self.task is not None:
            self.bar.update(self.task, advance=1, rate=rate)
        elif self.is_shown and now - self.said > LINE_EVERY_S:
            self.said = now
            left_s = (self.total - self.done) / rate
            print(f"{self.done} of {self.total} files, {rate:.1f}/s, {left_s:.0f} s left", file=sys.stderr, flush=True)
