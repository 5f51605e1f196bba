"""`Twin`: a simulated ADIS16130."""

from __future__ import annotations

from typing import NamedTuple

from . import _zerorate


class TwinKey(NamedTuple):
    """A property of the twin."""

    name: str
    """The key; its unit is in the name."""
    default: str
    """The default value, in words if the seed draws it."""
    allowed: str
    """The allowed values."""
    help: str
    """What the property does."""


class Twin:
    """A simulated ADIS16130. The same seed gives the same samples, byte for byte, on every machine.

    Parameters
    ----------
    seed
        Seed of the random numbers, which determine the errors of this sensor and its noise.
    **keys
        Other properties, as `zerorate twin` lists them, for example ``bias_dps=0.8``, ``motion="sway"``,
        ``noise=False``; `Twin.keys` returns the list.

    Raises
    ------
    ValueError
        For a key or value that the twin does not have; the text says which are right.

    Examples
    --------
    >>> Twin(seed=7, bias_dps=0.8)
    Twin('twin:seed=7,bias_dps=0.8')
    """

    def __init__(self, seed: int = 1, **keys: float | str | bool) -> None:
        pairs = {"seed": int(seed), **keys}
        self._device = _zerorate.twin_device(",".join(f"{name}={_text(value)}" for name, value in pairs.items()))

    @property
    def device(self) -> str:
        """The twin's name on the command line: ``zerorate calibrate --device …``."""
        return self._device

    @staticmethod
    def keys() -> list[TwinKey]:
        """Every property that can be set."""
        return [TwinKey(*key) for key in _zerorate.twin_keys()]

    def __repr__(self) -> str:
        return f"Twin({self._device!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Twin) and self._device == other._device

    def __hash__(self) -> int:
        return hash(self._device)


def _text(value: float | str | bool) -> str:
    return str(int(value)) if isinstance(value, bool) else str(value)
