"""No row is lost if a worker or the driver is killed, or the disk is full. The tests really kill the processes."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable

import loky
import pytest
from fleet_helpers import RECIPE, UNITS, Wrap, held_until, in_thread, wait_for

from zerorate import fleet
from zerorate.fleet import _downloads, _store

DRIVER = "import sys; from zerorate import fleet; from zerorate.fleet import Recipe\n"


def spawned() -> Executor:
    return ProcessPoolExecutor(2, mp_context=get_context("spawn"))


def by_loky() -> Executor:
    pool: Executor = loky.ProcessPoolExecutor(2)
    return pool


def rows(out: Path) -> int:
    return len(_store.row_paths(str(out)))


def children(process: int) -> list[int]:
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # the process ended meanwhile
            parent = int(stat.read_bytes().rpartition(b")")[2].split()[1])
            found += [int(stat.parent.name)] if parent == process else []
    return found


def kill_a_worker(name: str) -> bool:
    """Kills a child process that runs a command and has `name` in its command line. Returns false if there is none."""
    for child in children(os.getpid()):
        # A worker may end between the list and the kill: loky ends all workers when one is lost.
        with suppress(OSError):
            line = Path(f"/proc/{child}/cmdline").read_text()
            if name in line and "resource_tracker" not in line and children(child):
                os.kill(child, signal.SIGKILL)
                return True
    return False


@pytest.mark.parametrize(("engine", "name"), [(spawned, "spawn_main"), (by_loky, "loky")])
def test_killed_workers_cost_nothing(
    engine: Callable[[], Executor], name: str, captures: Path, tmp_path: Path, wrapped: Wrap
) -> None:
    wrapped(held_until(tmp_path / "go"))
    out = tmp_path / "out"
    wait = in_thread(lambda: fleet.run(str(captures), str(out), RECIPE, engine, workers=2))
    wait_for(lambda: rows(out) == 1, "the first row")
    for _ in range(2):
        wait_for(lambda: kill_a_worker(name), "a worker")
    (tmp_path / "go").touch()
    ended = wait()
    assert (ended.states, ended.undone) == ({"ok": UNITS}, {})
    assert fleet.table(str(out)).states == {"ok": UNITS}


@pytest.mark.parametrize("engine", [spawned, by_loky])
def test_a_file_that_kills_its_worker_gets_a_row(
    engine: Callable[[], Executor], captures: Path, tmp_path: Path, wrapped: Wrap
) -> None:
    wrapped('case "$*" in *unit5*) kill -KILL $PPID; sleep 5;; esac')
    ended = fleet.run(str(captures), str(tmp_path / "out"), RECIPE, engine, workers=2)
    assert ended.states == {"ok": UNITS - 1, "killed": 1}
    (reason,) = fleet.table(str(tmp_path / "out")).reasons
    assert reason[:3] == ("killed", "worker-died", 1) and reason[3].endswith("unit5.arrows")


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def stillborn() -> Executor:
    return ProcessPoolExecutor(2, mp_context=get_context("spawn"), initializer=die)


@pytest.mark.parametrize("engine", [stillborn, stillborn()])
def test_an_engine_that_never_works_blames_no_file(engine: Any, captures: Path, tmp_path: Path) -> None:
    with pytest.raises(fleet.EngineLost):
        fleet.run(str(captures), str(tmp_path / "out"), RECIPE, engine, workers=2)
    assert rows(tmp_path / "out") == 0


def start_driver(source: str, out: str) -> subprocess.Popen[bytes]:
    program = f"{DRIVER}fleet.run({source!r}, {out!r}, Recipe(recalibrate={RECIPE.recalibrate!r}), workers=2)"
    return subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.DEVNULL)


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="setpriv of util-linux ends commands whose worker died")
def test_a_killed_driver_leaves_no_command_and_no_half_row(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    wrapped(held_until(tmp_path / "go"))
    out = tmp_path / "out"
    driver = start_driver(str(captures), str(out))
    wait_for(lambda: rows(out) == 1 and len(children(driver.pid)) == 2, "a row, and two commands under way")
    commands = children(driver.pid)
    driver.kill()
    driver.wait()
    files = [Path(f"/proc/{command}/cmdline") for command in commands]
    wait_for(lambda: not any(file.exists() for file in files), "the end of the commands", 10)
    (tmp_path / "go").touch()
    ended = fleet.run(str(captures), str(out), RECIPE)
    assert ended.states == {"there": 1, "ok": UNITS - 1}


def test_ctrl_c_leaves_no_row_of_what_was_under_way(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    wrapped(held_until(tmp_path / "go"))
    out = tmp_path / "out"
    driver = start_driver(str(captures), str(out))
    wait_for(lambda: rows(out) == 1 and len(children(driver.pid)) == 2, "a row, and two commands under way")
    driver.send_signal(signal.SIGINT)
    assert driver.wait(timeout=30) != 0
    assert fleet.table(str(out)).states == {"ok": 1}
    (tmp_path / "go").touch()
    assert fleet.run(str(captures), str(out), RECIPE).undone == {}
    assert fleet.table(str(out)).states == {"ok": UNITS}


def test_downloads_of_the_dead_are_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    holder = "import time; from zerorate.fleet._downloads import folder\nwith folder() as path:\n  "
    holder += "print(path, flush=True); time.sleep(60)"
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    process = subprocess.Popen([sys.executable, "-c", holder], stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    folder = process.stdout.readline().strip()
    assert _downloads.remove_left() == 0 and os.path.isdir(folder)
    process.kill()
    process.wait()
    assert _downloads.remove_left() == 1 and not os.path.exists(folder)


def test_a_full_disk_leaves_files_undone(captures: Path, small_disk: Path) -> None:
    filler = small_disk / "filler"
    filler.write_bytes(b"\0" * 44_000)
    ended = fleet.run(str(captures), str(small_disk / "out"), RECIPE)
    assert ended.undone and all("No space left" in why for why in ended.undone.values())
    assert not list((small_disk / "out").rglob("*.part"))
    filler.unlink()
    ended = fleet.run(str(captures), str(small_disk / "out"), RECIPE)
    assert not ended.undone and sum(ended.states.values()) == UNITS
