"""Four stations enter 50 units each into one record at once, and are killed at random moments."""

from __future__ import annotations

import random
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from line_helpers import LIMITS

from zerorate.line import open_record

STATIONS = 4
UNITS = 50
KILLS = 2
"""How often each station is killed."""


def start(url: str, station: str) -> subprocess.Popen[str]:
    worker = Path(__file__).with_name("line_worker.py")
    return subprocess.Popen([sys.executable, str(worker), url, station, str(UNITS)], stdout=subprocess.PIPE, text=True)


def drive(url: str, station: str, seed: int) -> tuple[set[str], int]:
    """Runs a station, killed and started again; returns what it entered, and how often a kill met it at work."""
    source, said, met = random.Random(seed), set(), 0
    for _ in range(KILLS):
        worker = start(url, station)
        assert worker.stdout is not None
        for _ in range(source.randrange(1, UNITS - 10)):
            said.add(worker.stdout.readline().strip())
        time.sleep(source.uniform(0.0, 0.02))
        met += worker.poll() is None
        worker.kill()
        said.update(worker.communicate()[0].split())
    worker = start(url, station)
    said.update(worker.communicate(timeout=60)[0].split())
    assert worker.returncode == 0
    return said, met


def test_killed_stations_lose_and_double_nothing(url: str) -> None:
    names = [f"S{number}" for number in range(STATIONS)]
    with ThreadPoolExecutor(STATIONS) as pool:
        answers = list(pool.map(lambda name: drive(url, name, hash_seed(name)), names))
    assert sum(met for _, met in answers) > KILLS, "hardly any kill met a station at work"
    expected = {f"{name}-{number}" for name in names for number in range(UNITS)}
    assert set().union(*(said for said, _ in answers)) == expected
    with open_record(url, create=False) as record:
        results = record.results()
        found = record.verify()
    assert sorted(one.serial for one in results) == sorted(expected)
    assert all(len(one.verdicts) == len(LIMITS.limits) for one in results)
    assert (found.findings, found.entries) == ([], STATIONS * UNITS)
    assert found.rows == STATIONS * UNITS * (3 + len(LIMITS.limits))


def hash_seed(name: str) -> int:
    """A seed that a run of the tests can be repeated with."""
    return sum(map(ord, name)) * 16130
