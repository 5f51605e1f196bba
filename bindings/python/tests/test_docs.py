"""The examples in the documentation give the results that they show."""

from __future__ import annotations

import doctest
import inspect
import sys
from collections.abc import Callable

import pytest

import zerorate


@pytest.mark.filterwarnings("ignore:unknown-serial")
def test_the_examples() -> None:
    shown: list[Callable[..., object]] = [zerorate.allan, zerorate.imu, zerorate.tempcal, zerorate.Twin]
    for one in [*shown, zerorate.capture, zerorate.stream]:
        inner = inspect.unwrap(one)
        known = {**vars(sys.modules[inner.__module__]), "calibrate": zerorate.calibrate}
        (tests,) = [found for found in doctest.DocTestFinder(recurse=False).find(inner, globs=known) if found.examples]
        assert doctest.DocTestRunner().run(tests).failed == 0
