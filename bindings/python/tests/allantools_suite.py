"""Runs allantools' own tests against `zerorate.allantools_compat`: python allantools_suite.py SOURCE

SOURCE is an unpacked source distribution of allantools. The script prints the names of the tests that pass, that fail,
and that are skipped, as those of functions that are not offered. It fails if a test fails, or if none passes.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path
from types import ModuleType

import pytest


class Outcomes:
    def __init__(self, asked: list[str]) -> None:
        self.asked = asked
        self.passed: list[str] = []
        self.failed: list[str] = []
        self.skipped: dict[str, list[str]] = defaultdict(list)

    @pytest.hookimpl(wrapper=True)
    def pytest_pyfunc_call(self) -> Generator[None, object, object]:
        self.asked.clear()
        try:
            return (yield)
        except Exception:
            # a test that catches the skip fails later, because the function is missing
            if not self.asked:
                raise
            pytest.skip(f"not offered: {self.asked[0]}")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._count(report, report.when == "call")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        self._count(report, False)

    def _count(self, report: pytest.TestReport | pytest.CollectReport, is_call: bool) -> None:
        if report.skipped:
            reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
            self.skipped[reason.removeprefix("Skipped: ")].append(report.nodeid)
        elif report.failed:
            self.failed.append(report.nodeid)
        elif is_call:
            self.passed.append(report.nodeid)


def noise_of(source: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("allantools.noise", source / "allantools" / "noise.py")
    assert spec is not None and spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main(source: Path) -> int:
    here = Path(__file__).resolve().parent
    sys.path[:0] = [str(here / "shim"), str(source / "tests")]
    # the noise is the input of tests of deviations; the test of the noise itself would only test allantools
    shim = importlib.import_module("allantools")
    shim.noise = noise_of(source)  # type: ignore[attr-defined]
    outcomes = Outcomes(shim.asked)
    arguments = ["-q", "--no-header", "--tb=short", "--no-summary", "-p", "no:cacheprovider"]
    arguments += [f"--rootdir={source}", f"--ignore={source / 'tests' / 'functional_tests' / 'test_noise.py'}"]
    status = pytest.main([*arguments, "-c", str(source / "pytest.ini"), str(source / "tests")], plugins=[outcomes])
    print(f"\nallantools' own tests against zerorate.allantools_compat, {source.name}")
    print(f"\n{len(outcomes.passed)} pass:")
    for name in outcomes.passed:
        print(f"  {name}")
    print("\nNot offered, or skipped by allantools itself:")
    for reason, names in sorted(outcomes.skipped.items()):
        print(f"  {reason}: {len(names)}")
        for name in names:
            print(f"    {name}")
    print(f"\n{len(outcomes.failed)} fail")
    for name in outcomes.failed:
        print(f"  {name}")
    return int(bool(status or outcomes.failed or not outcomes.passed))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
