"""Limits of the quantities, and the decision whether a value keeps them.

Sources: JCGM 106:2012, 8.2 (simple acceptance) and 8.3 (guarded acceptance); ILAC-G8:09/2019, 4.2.3 (the four verdicts
with a guard band w = U).
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ._errors import LineError
from ._tables import QUANTITIES
from ._toml import read_toml

RULES = ("simple", "guarded")
SEVERITY = ("pass", "conditionalPass", "conditionalFail", "undecided", "fail")
"""All verdicts, from good to bad. ``undecided``: the value, or the uncertainty that the rule needs, is not known."""


@dataclass(frozen=True)
class Limit:
    """The limits of one quantity, in its unit."""

    lower: float | None
    """The lowest value that conforms; None if there is no such limit."""
    upper: float | None
    """The highest value that conforms; None if there is no such limit."""
    rule: str
    """``simple`` or ``guarded``."""

    def judge(self, value: float | None, u: float | None) -> str:
        """The verdict on a value with its standard uncertainty ``u``.

        The guard band is U = 2u for guarded acceptance, and 0 for simple acceptance. A value on a limit lies inside
        of it: the acceptance interval holds its ends (JCGM 106, 3.3.8 and 3.3.9).
        """
        if value is None or (self.rule == "guarded" and u is None):
            return "undecided"
        guard = 2 * (u or 0.0) if self.rule == "guarded" else 0.0
        inside = self.margin(value)
        if inside >= guard:
            return "pass"
        if inside >= 0:
            return "conditionalPass"
        return "conditionalFail" if guard and inside >= -guard else "fail"

    def margin(self, value: float) -> float:
        """How far inside of the nearer limit a value is; negative outside."""
        below = math.inf if self.upper is None else self.upper - value
        above = math.inf if self.lower is None else value - self.lower
        return min(below, above)


@dataclass(frozen=True)
class Limits:
    """The limits of a product, as a file holds them."""

    version: str
    """The version of the limits; each verdict names it."""
    limits: Mapping[str, Limit] = field(default_factory=dict)
    """The limits by quantity."""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Limits:
        """Reads limits from a TOML file.

        Raises
        ------
        LineError
            If the file cannot be read, or a key is missing, unknown or of the wrong kind.
        """
        content = read_toml(Path(path))
        version = content.pop("version", None)
        if not isinstance(version, str) or not version.strip():
            raise LineError(f'{path}: a text `version` is missing, such as version = "2026-11"')
        if not content:
            raise LineError(f"{path} limits no quantity: add a table such as [pbc_dps] with lower, upper and rule")
        return cls(version, {name: parse_limit(f"{path}, [{name}]", name, content[name]) for name in content})


def parse_limit(where: str, name: str, table: Any) -> Limit:
    """The limit of one quantity."""
    if name not in QUANTITIES:
        raise LineError(f"{where}: unknown quantity; there are {', '.join(QUANTITIES)}")
    if not isinstance(table, dict) or set(table) - {"lower", "upper", "rule"}:
        raise LineError(f"{where}: a limit is a table with the keys lower, upper and rule")
    if table.get("rule") not in RULES:
        raise LineError(f"{where}: rule must be one of {', '.join(RULES)}")
    lower, upper = (number(where, table, key) for key in ("lower", "upper"))
    if lower is None and upper is None:
        raise LineError(f"{where}: give lower, upper or both")
    if lower is not None and upper is not None and lower >= upper:
        raise LineError(f"{where}: lower must be below upper")
    return Limit(lower, upper, table["rule"])


def number(where: str, table: dict[str, Any], key: str) -> float | None:
    """A finite number of a table, or None if it has no such key."""
    value = table.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise LineError(f"{where}: {key} must be a finite number")
    return float(value)


def worst(verdicts: list[str]) -> str | None:
    """The worst of some verdicts; None if there are none."""
    return max(verdicts, key=SEVERITY.index, default=None)
