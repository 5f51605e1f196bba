"""The commands for each file of a fleet."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, dataclass, fields
from typing import Any, Optional, Tuple

from . import _program

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Options = Optional[Tuple[str, ...]]


@dataclass(frozen=True)
class Recipe:
    """The commands for each file, each with its options; None leaves a command out.

    A change of the recipe or of the program gives new rows beside the old ones.
    """

    recalibrate: Options = ()
    """Options of ``zerorate recalibrate``. A log that is not a capture goes on to the other commands."""
    allan: Options = ()
    """Options of ``zerorate allan --fit``."""
    imu: Options = None
    """Options of ``zerorate imu``, for logs with several axes."""
    timeout_s: float = 3600.0
    """Time limit of one command, s."""

    def digest(self) -> str:
        """Identifies this recipe together with this version of the program."""
        text = json.dumps([asdict(self), _program.version()], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:12]


DEFAULT = Recipe()


def load(path: str) -> Recipe:
    """Reads a recipe from a TOML file: ``timeout_s``, and a table for each command with the list ``options``.

    A command without a table is left out. Raises ValueError if the recipe is invalid, and OSError if it cannot be
    read.
    """
    with open(path, "rb") as file:
        try:
            found: dict[str, Any] = tomllib.load(file)
        except tomllib.TOMLDecodeError as error:
            raise ValueError(f"{path} is not TOML: {error}") from error
    names = [field.name for field in fields(Recipe)]
    unknown = sorted(set(found) - set(names))
    if unknown:
        raise ValueError(f"{path}: a recipe has no `{unknown[0]}`; it has {', '.join(names)}")
    timeout_s = found.pop("timeout_s", DEFAULT.timeout_s)
    if isinstance(timeout_s, bool) or not isinstance(timeout_s, (int, float)) or timeout_s <= 0:
        raise ValueError(f"{path}: timeout_s must be a number of seconds above 0")
    commands = {name: _options(path, name, table) for name, table in found.items()}
    if not commands:
        raise ValueError(f"{path}: no command; give at least one table of [recalibrate], [allan] and [imu]")
    chosen = {"recalibrate": None, "allan": None, **commands}
    return Recipe(timeout_s=float(timeout_s), **chosen)


def _options(path: str, name: str, table: Any) -> Options:
    options = table.get("options", []) if isinstance(table, dict) else None
    is_list = isinstance(options, list) and all(isinstance(option, str) for option in options)
    if not is_list or set(table) - {"options"}:
        raise ValueError(f'{path}: [{name}] has one key: options = ["--option", "value"]')
    return tuple(options or ())
