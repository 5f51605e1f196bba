"""What the stubs say is what is there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent


def check(*command: str) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=PACKAGE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_the_extension() -> None:
    check("mypy.stubtest", "zerorate._zerorate")


def test_the_package_and_its_tests_type_check() -> None:
    check("mypy", "python/zerorate", "tests")
