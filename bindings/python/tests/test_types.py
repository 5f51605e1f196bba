"""The stubs match the extension, and the package offers every statistic of the core."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import get_args

from zerorate import _zerorate, allan, allantools_compat
from zerorate._analysis import Stat

PACKAGE = Path(__file__).resolve().parent.parent


def check(*command: str) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=PACKAGE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_the_extension() -> None:
    check("mypy.stubtest", "zerorate._zerorate")


def test_the_package_and_its_tests_type_check() -> None:
    check("mypy", "python/zerorate", "benches", *map(str, (PACKAGE / "tests").glob("*.py")))
    check("mypy", "tests/fleet")  # which has a module `conftest` of its own


def test_every_statistic_of_the_core_is_offered_and_documented() -> None:
    names = [name for name, _ in _zerorate.statistics()]
    assert list(get_args(Stat)) == names
    readme = (PACKAGE / "README.md").read_text(encoding="utf-8")
    for name in names:
        assert f"``{name}``" in (allan.__doc__ or "")
        assert f"`{name}`" in readme or f'`stat="{name}"`' in readme
        assert callable(getattr(allantools_compat, name)) and name in allantools_compat.__all__
