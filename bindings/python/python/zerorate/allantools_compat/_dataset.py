"""A record with its results."""

from __future__ import annotations

import os
from typing import Any

from .. import _zerorate
from . import _deviations
from ._offer import NOT_OFFERED, NotOffered


class Dataset:
    """A record, and the deviation that was computed last.

    `inp` holds ``data``, ``rate``, ``data_type``, ``taus``; `out` holds ``taus``, ``stat``, ``stat_err``,
    ``stat_unc``, ``stat_n``, ``stat_id``.
    """

    def __init__(self, data: Any = None, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> None:
        self.inp: dict[str, Any] = {}
        self.out: dict[str, Any] = {}
        self.set_input(data, rate, data_type, taus)

    def set_input(self, data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> None:
        """Sets another record and discards the old results. Arguments are as in `adev`."""
        self.inp = {"data": data, "rate": rate, "data_type": data_type, "taus": taus}
        self.out = dict.fromkeys(("taus", "stat", "stat_err", "stat_unc", "stat_n", "stat_id"))

    def compute(self, function: str) -> dict[str, Any]:
        """Computes the deviation of this name, such as ``"oadev"``, and returns `out`.

        Raises
        ------
        AttributeError
            If there is no such function, here (`NotOffered`) or in allantools.
        RuntimeError
            If the function is not a deviation.
        """
        if function not in _NAMES:
            raise _no_deviation(function)
        times, dev, err, n = getattr(_deviations, function)(**self.inp)
        self.out = {"taus": times, "stat": dev, "stat_err": err, "stat_unc": None, "stat_n": n, "stat_id": function}
        return self.out

    def write_results(
        self, filename: str | os.PathLike[str], digits: int = 5, header_params: dict[str, Any] | None = None
    ) -> None:
        """Writes the result as text: comments with `header_params`, then columns as Stable32 has them.

        The columns are the averaging factor, tau, n, the noise exponent (NaN: unknown), and the deviation less half of
        its error, itself, and plus half of its error.

        Raises
        ------
        ValueError
            If nothing was computed.
        """
        name = self.out["stat_id"]
        if name is None:
            raise ValueError("nothing was computed yet: call compute() first")
        described = {"data type": self.inp["data_type"], "data rate": self.inp["rate"], **(header_params or {})}
        columns = [self.out[column] for column in ("taus", "stat_n", "stat", "stat_err")]
        with open(filename, "w", encoding="utf-8") as file:
            for key, value in described.items():
                print(f"# {key}: {value}", file=file)
            print(f"AF Tau N alpha min_{name} {name} max_{name}", file=file)
            for tau, n, dev, err in zip(*columns):
                limits = (dev - err / 2, dev, dev + err / 2)
                numbers = " ".join(f"{number:.{digits}e}" for number in limits)
                print(f"{round(tau * self.inp['rate'])} {tau:.{digits}e} {n:.0f} NaN {numbers}", file=file)


_NAMES = [*(name for name, *_ in _zerorate.statistics()), "gradev", "mtie"]


def _no_deviation(name: str) -> Exception:
    if name not in NOT_OFFERED:
        return AttributeError(f"no deviation {name!r}; the deviations are {', '.join(_NAMES)}")
    if name.endswith("dev") or name in ("theo1", "mtie", "tierms"):
        return NotOffered(name)
    return RuntimeError(f"{name} is not a deviation; the deviations are {', '.join(_NAMES)}")
