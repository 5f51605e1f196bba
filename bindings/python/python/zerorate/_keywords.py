"""Suggests the right keyword for a wrong one, and refuses an empty serial number."""

from __future__ import annotations

import difflib
import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar, cast

_F = TypeVar("_F", bound=Callable[..., Any])

_RATE = "rate_hz=, samples per second"
_MEANT = {
    **dict.fromkeys(["rate", "fs", "sample_rate", "sampling_rate", "sr", "freq", "frequency", "hz"], _RATE),
    **dict.fromkeys(["dt", "ts", "period"], "rate_hz=1/dt, samples per second"),
    "latitude": "earth_dps=, the component of the Earth's rotation along the axis",
    "units": "unit=",
    "statistic": "stat=",
    "tau": "taus=",
}
"""Our keywords for the keywords of other packages."""


def checked(function: _F) -> _F:
    """Wraps a function: a wrong keyword raises an error that suggests the right one, and so does ``serial=""``."""
    parameters = inspect.signature(function).parameters.values()
    has_named_alone = not any(one.kind is one.POSITIONAL_OR_KEYWORD for one in parameters)
    data = [one.name for one in parameters if one.kind is one.POSITIONAL_ONLY]
    known = [one.name for one in parameters if one.kind is not one.POSITIONAL_ONLY]

    @functools.wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        if len(args) < len(data):
            named = [name for name in data if name in kwargs]
            needed = f"it needs {' and '.join(data[len(args) :])}"
            fault = f"give {' and '.join(named)} without a name" if named else needed
            raise TypeError(f"{function.__name__}({', '.join(data)}, …): {fault}")
        if len(args) > len(data) and has_named_alone:
            raise TypeError(f"{function.__name__}() takes {', '.join(data)} without a name, and all else by name")
        for name in kwargs:
            if name not in known:
                raise TypeError(f"{function.__name__}() has no argument {name}={_hint(name, known)}")
        serial = kwargs.get("serial")
        if isinstance(serial, str) and not serial.strip():
            raise ValueError(f"serial={serial!r}: it is empty; leave the argument out")
        if not callable(kwargs.get("progress", print)) and kwargs["progress"] is not None:
            raise TypeError("progress= takes a function, which is called with each step")
        return function(*args, **kwargs)

    return cast(_F, called)


def _hint(name: str, known: list[str]) -> str:
    meant = _MEANT.get(name)
    if meant is not None and meant.partition("=")[0] in known:
        return f": give {meant}"
    near = difflib.get_close_matches(name, known, n=1)
    return f": did you mean {near[0]}=?" if near else f"; it has {', '.join(known)}"
