"""Captures of simulated sensors, and programs that die on some of them."""

from __future__ import annotations

import shutil
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from fleet_helpers import PLAN, UNITS, Wrap

from zerorate.fleet._program import _own, version


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with captures and calibrations of eight simulated sensors, recorded once for all tests."""
    folder = tmp_path_factory.mktemp("recorded")
    for seed in range(1, UNITS + 1):
        twin = ["--device", f"twin:seed={seed}", "--divider", "20", "--serial", f"SN{seed}"]
        files = ["--log", str(folder / f"unit{seed}.arrows"), "-o", str(folder / f"unit{seed}.toml")]
        command = [sys.executable, "-m", "zerorate", "calibrate", *twin, *PLAN, *files]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
    return folder


@pytest.fixture()
def captures(recorded: Path, tmp_path: Path) -> Path:
    folder = tmp_path / "captures"
    folder.mkdir()
    for path in recorded.glob("*.arrows"):
        shutil.copy(path, folder)
    return folder


@pytest.fixture()
def wrapped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Wrap]:
    """Returns a function that puts lines of shell before the program. In these lines, ``$*`` are its arguments."""

    def wrap(lines: str) -> None:
        program = " ".join(f"'{word}'" for word in _own())
        script = tmp_path / "wrapped"
        script.write_text(f'#!/bin/sh\n{lines}\nexec {program} "$@"\n')
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("ZERORATE_PROGRAM", str(script))
        _forget()

    yield wrap
    monkeypatch.undo()
    _forget()


def _forget() -> None:
    _own.cache_clear()
    version.cache_clear()


@pytest.fixture()
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB in memory, for tests of a full disk."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)], capture_output=True)
    if mounted.returncode:
        pytest.skip(f"only root can mount a small disk: {mounted.stderr.decode().strip()}")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)
