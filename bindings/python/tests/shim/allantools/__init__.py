"""allantools' name for `zerorate.allantools_compat`: allantools' own tests import this instead.

A test that asks for what is not offered is skipped by name. `allantools.allantools` is the module that the functions
stand in there.
"""

import sys

import pytest

from zerorate import allantools_compat
from zerorate.allantools_compat import *  # noqa: F403
from zerorate.allantools_compat import NOT_OFFERED, __all__  # noqa: F401

sys.modules["allantools.noise"] = allantools_compat.noise
allantools = sys.modules["allantools.allantools"] = sys.modules[__name__]
dataset = sys.modules["allantools.dataset"] = allantools_compat._dataset


def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        pytest.skip(f"not offered: {name}", allow_module_level=True)
    raise AttributeError(name)
