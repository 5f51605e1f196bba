"""Replaces allantools when its own tests import it, and offers `zerorate.allantools_compat` in its place.

A test that needs a name that is not offered is skipped, and the name is printed. `allantools.allantools` and
`allantools.dataset` are the modules in which allantools defines its functions and classes.
"""

import sys

import pytest

from zerorate.allantools_compat import *  # noqa: F403
from zerorate.allantools_compat import NOT_OFFERED, __all__  # noqa: F401

# the requested names that are not offered
asked: list[str] = []

allantools = sys.modules["allantools.allantools"] = sys.modules["allantools.dataset"] = sys.modules[__name__]


def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        asked.append(name)
        pytest.skip(f"not offered: {name}", allow_module_level=True)
    raise AttributeError(name)
