"""Fixtures: calibrations of the twin, and an invented laboratory."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from sealing import as_measured

from zerorate_certificate import Lab

SCRIPTS = sysconfig.get_path("scripts")
ZERORATE = shutil.which("zerorate", path=SCRIPTS) or "zerorate is not installed"
PROGRAM = shutil.which("zerorate-certificate", path=SCRIPTS) or "zerorate-certificate is not installed"

TIMES = ["--average", "5s", "--warmup", "60s", "--settle", "120s", "--offset", "30s"]
KINDS = {
    "an1042": ["--device", "twin:seed=7"],
    "warmup": ["--method", "warmup", "--device", "twin:seed=7"],
    "imu": ["--device", "twin:seed=7,axes=3"],
}


@dataclass(frozen=True)
class Made:
    """A calibration file, and the JSON that the program printed when it wrote the file."""

    path: Path
    report: Any
    """None for `cycle.toml`, which is a stored file."""


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Made]:
    """Calibrations of the twin, by name: one axis, three axes, and curves."""
    folder = tmp_path_factory.mktemp("made")
    calibrations = {kind: _calibrate(folder / f"{kind}.toml", options) for kind, options in KINDS.items()}
    # zerorate calibrate --method cycle --device twin:seed=7,profile=oven --settle 10500s --divider 64 --serial SN7
    calibrations["cycle"] = Made(Path(__file__).with_name("cycle.toml"), None)
    return calibrations


def _calibrate(path: Path, options: list[str]) -> Made:
    command = [ZERORATE, "calibrate", *options, *TIMES, "--serial", "SN7", "--json"]
    done = subprocess.run([*command, "-o", str(path)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return Made(path, json.loads(done.stdout))


@pytest.fixture(scope="session")
def simulated(made: dict[str, Made]) -> Path:
    """The calibration of the twin by AN-1042."""
    return made["an1042"].path


@pytest.fixture(scope="session")
def measured(made: dict[str, Made], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The calibration by AN-1042, edited as if a real part had been measured around midnight."""
    text = as_measured(made["an1042"].path.read_text(encoding="utf-8"))
    return write(tmp_path_factory.mktemp("measured") / "unit.toml", text)


@pytest.fixture(scope="session")
def example_lab() -> str:
    """The text of the example ``lab.toml`` that the command prints."""
    return subprocess.run([PROGRAM, "--example-lab"], capture_output=True, check=True).stdout.decode("utf-8")


@pytest.fixture(scope="session")
def lab_file(example_lab: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of the example laboratory, with every optional key."""
    return write(tmp_path_factory.mktemp("lab") / "lab.toml", full(example_lab))


@pytest.fixture(scope="session")
def lab(lab_file: Path) -> Lab:
    return Lab.load(lab_file)


def full(example: str) -> str:
    """The example, with its optional keys and tables no longer commented out."""
    return re.sub(r"^# (?=\[|\w+ = )", "", example, flags=re.MULTILINE)


def write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with the schemas of PTB, which are not part of the project."""
    root = Path(__file__).resolve().parents[3]
    folder = Path(os.environ.get("ZERORATE_SHARED", root.parent / "shared")) / "data" / "dcc"
    if not folder.is_dir():
        pytest.skip(f"the schemas of the DCC are not in {folder}: set ZERORATE_SHARED to the folder above data/dcc")
    return folder
