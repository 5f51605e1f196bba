"""The types of the package and of its tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent


def test_the_package_and_its_tests_type_check() -> None:
    command = [sys.executable, "-m", "mypy", "src", "tests"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=FOLDER)
    assert done.returncode == 0, done.stdout + done.stderr
