"""Reads a TOML file that people write, and reports all its errors at once."""

from __future__ import annotations

import difflib
import math
import re
import sys
from datetime import date, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    import os

# Control characters except tab and line feed, and two other characters that XML 1.0 forbids.
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ufffe\uffff]")

MAX_CHARACTERS = 2000
"""Largest length of a text by default, in characters. It limits the number of pages of a certificate."""


class Problems(ValueError):
    """The errors of a file."""


class Table:
    """A table of the file. Its methods note a missing or wrong key and return a placeholder."""

    def __init__(self, content: dict[str, Any], path: str, problems: dict[str, list[str]]) -> None:
        self._content = content
        self._path = path
        self._problems = problems
        self._asked: list[str] = []
        self._inner: list[Table] = []

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Table:
        """Reads the file and returns its root table."""
        try:
            content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise Problems(f"this is not TOML: {error}") from None
        except UnicodeDecodeError:
            raise Problems("this is not text in UTF-8") from None
        return cls(content, "", {"missing": [], "unknown": [], "": []})

    def text(self, key: str, *, limit: int = MAX_CHARACTERS, pattern: str = ".*", rule: str = "") -> str:
        """A text that is not empty; ``rule`` says in words what ``pattern`` means."""
        value = self._take(key)
        if value is None:
            return ""
        if not isinstance(value, str):
            return self._wrong(key, "must be a text in quotes")
        if not value.strip():
            return self._wrong(key, "is empty")
        if _UNPRINTABLE.search(value):
            return self._wrong(key, "contains a control character")
        if len(value) > limit:
            return self._wrong(key, f"is longer than {limit} characters")
        if not re.fullmatch(pattern, value.strip(), re.DOTALL):
            return self._wrong(key, rule)
        return value.strip()

    def text_or_none(self, key: str) -> str | None:
        return self.text(key) if self._offered(key) else None

    def choice(self, key: str, options: list[str]) -> str:
        """A text that must be one of ``options``."""
        value = self.text(key)
        return value if not value or value in options else self._wrong(key, f"must be one of {', '.join(options)}")

    def day(self, key: str) -> date:
        """A date, written without quotes."""
        value = self._take(key)
        if value is not None and (not isinstance(value, date) or isinstance(value, datetime)):
            self._wrong(key, "must be a date without quotes, such as 2026-03-01")
        return value if isinstance(value, date) else date.min

    def day_or_none(self, key: str) -> date | None:
        return self.day(key) if self._offered(key) else None

    def number(self, key: str) -> float:
        """A finite number."""
        value = self._take(key)
        if value is None:
            return math.nan
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self._wrong(key, "must be a number without quotes")
            return math.nan
        return value

    def table(self, key: str) -> Table:
        """A table inside this table. If the table is missing, all its mandatory keys are reported as missing."""
        self._asked.append(key)
        value = self._content.get(key, {})
        if not isinstance(value, dict):
            self._wrong(key, f"must be a table: [{key}]")
        return self._open(value if isinstance(value, dict) else {}, f"{self._name(key)}.")

    def table_or_none(self, key: str) -> Table | None:
        return self.table(key) if self._offered(key) else None

    def tables(self, key: str) -> list[Table]:
        """A list of tables; empty if there is none."""
        self._asked.append(key)
        value = self._content.get(key, [])
        if not isinstance(value, list) or not all(isinstance(row, dict) for row in value):
            self._wrong(key, f"must be a list of tables: [[{key}]]")
            return []
        names = [f"{self._name(key)}[{number}]." for number in range(1, len(value) + 1)]
        return [self._open(row, name) for row, name in zip(value, names)]

    def missing(self, key: str) -> None:
        self._problems["missing"].append(self._name(key))

    def finish(self) -> None:
        """Notes the keys of this table and of its tables that were never asked for, which are unknown."""
        for table in self._inner:
            table.finish()
        for key in self._content:
            if key not in self._asked:
                near = difflib.get_close_matches(key, self._asked, n=1)
                advice = f" (did you mean {self._name(near[0])}?)" if near else ""
                self._problems["unknown"].append(self._name(key) + advice)

    def raise_problems(self) -> None:
        """Raises `Problems` with everything that was noted about this file, in one line."""
        lists = [(kind, found) for kind, found in self._problems.items() if found]
        if lists:
            texts = [f"{kind}: {', '.join(found)}" if kind else "; ".join(found) for kind, found in lists]
            raise Problems("; ".join(texts))

    def _open(self, content: dict[str, Any], path: str) -> Table:
        self._inner.append(Table(content, path, self._problems))
        return self._inner[-1]

    def _offered(self, key: str) -> bool:
        self._asked.append(key)
        return key in self._content

    def _take(self, key: str) -> Any:
        if not self._offered(key):
            self.missing(key)
        return self._content.get(key)

    def _wrong(self, key: str, why: str) -> str:
        self._problems[""].append(f"{self._name(key)} {why}")
        return ""

    def _name(self, key: str) -> str:
        return self._path + key
