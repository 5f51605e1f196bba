"""What the tests of the fleet share."""

from __future__ import annotations

import socket
import time
from typing import Callable

from zerorate.fleet import Recipe

PLAN = ("--average", "2s", "--warmup", "60s", "--settle", "20s", "--offset", "5s")
RECIPE = Recipe(recalibrate=PLAN)
UNITS = 8

Wrap = Callable[[str], None]


def free_port() -> int:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        return int(server.getsockname()[1])


def is_open(port: int) -> bool:
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


def wait_for(holds: Callable[[], bool], what: str, timeout_s: float = 60.0) -> None:
    until = time.monotonic() + timeout_s
    while not holds():
        assert time.monotonic() < until, f"{what} did not come in {timeout_s:g} s"
        time.sleep(0.05)
