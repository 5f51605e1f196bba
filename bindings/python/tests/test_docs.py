"""The examples in the documentation do what they show."""

from __future__ import annotations

import doctest

from zerorate import _allan, _imu, _tempcal, _twin


def test_the_examples() -> None:
    for module in (_allan, _imu, _tempcal, _twin):
        tried = doctest.testmod(module)
        assert tried.attempted and not tried.failed
