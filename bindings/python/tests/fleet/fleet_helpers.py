from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any, Callable

from zerorate.fleet import Recipe

PLAN = ("--average", "2s", "--warmup", "60s", "--settle", "20s", "--offset", "5s")
RECIPE = Recipe(recalibrate=PLAN)
UNITS = 8

Wrap = Callable[[str], None]


def wait_for(holds: Callable[[], bool], what: str, timeout_s: float = 60.0) -> None:
    until = time.monotonic() + timeout_s
    while not holds():
        assert time.monotonic() < until, f"{what} did not come in {timeout_s:g} s"
        time.sleep(0.05)


def trapped(folder: Path) -> Path:
    """Makes a folder of modules that write the file ``ran`` into it if anything imports them."""
    folder.mkdir()
    for name in ("distributed", "fsspec", "json", "multiprocessing", "numpy", "socket", "zerorate"):
        (folder / f"{name}.py").write_text(f"open({str(folder / 'ran')!r}, 'a').write(__file__)\n")
    return folder


def held_until(go: Path) -> str:
    """Lines of shell that hold commands until `go` exists, at most 60 s, except ``--version`` and those on unit1."""
    wait = f"for i in $(seq 600); do [ -e '{go}' ] && break; sleep 0.1; done"
    return f'case "$*" in *--version*|*unit1*) ;; *) {wait};; esac'


def in_thread(work: Callable[[], Any]) -> Callable[[], Any]:
    """Begins `work` in a thread. Returns a function that waits for the thread and returns the result of `work`."""
    done: list[Any] = []
    thread = threading.Thread(target=lambda: done.append(work()))
    thread.start()

    def wait() -> Any:
        thread.join(120)
        return done[0]

    return wait
