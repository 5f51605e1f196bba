"""allantools' name for `zerorate.allantools_compat`: allantools' own tests import this instead.

A test that asks for what is not offered is skipped by name. The random records that some tests draw come from
allantools' own `noise`, out of the source distribution that `ALLANTOOLS_SOURCE` names; `allantools.allantools` is the
module that the functions stand in there.
"""

import importlib.util
import os
import sys

import pytest

from zerorate import allantools_compat
from zerorate.allantools_compat import *  # noqa: F403
from zerorate.allantools_compat import NOT_OFFERED, __all__  # noqa: F401

_file = os.path.join(os.environ["ALLANTOOLS_SOURCE"], "allantools", "noise.py")
_spec = importlib.util.spec_from_file_location("allantools.noise", _file)
assert _spec is not None and _spec.loader is not None
noise = sys.modules["allantools.noise"] = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(noise)
allantools = sys.modules["allantools.allantools"] = sys.modules[__name__]
dataset = sys.modules["allantools.dataset"] = allantools_compat._dataset


def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        pytest.skip(f"not offered: {name}", allow_module_level=True)
    raise AttributeError(name)
