"""allantools' name for `zerorate.allantools_compat`: allantools' own tests import this instead.

A test that asks for what is not offered is skipped by name. `allantools.allantools` and `allantools.dataset` are the
modules that functions and classes stand in there.
"""

import sys

import pytest

from zerorate.allantools_compat import *  # noqa: F403
from zerorate.allantools_compat import NOT_OFFERED, __all__  # noqa: F401

# the names that were asked for and are not offered
asked: list[str] = []

allantools = sys.modules["allantools.allantools"] = sys.modules["allantools.dataset"] = sys.modules[__name__]


def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        asked.append(name)
        pytest.skip(f"not offered: {name}", allow_module_level=True)
    raise AttributeError(name)
