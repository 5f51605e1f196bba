"""The chain of entries: what was entered, when and by whom.

An entry names its rows with their digests, and its hash includes the hash of the entry before. A row or an entry that
is changed, removed or added behind the triggers' back no longer fits.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa

from ._tables import ENTERED, ENTRY

Names = list[tuple[str, int, str]]
"""Rows by table, id and digest."""


MISFIT = "does not fit its hash: it or the entry before was changed"


@dataclass(frozen=True)
class Finding:
    """Something that is not as it was entered."""

    where: str
    """The row: a table and an id, such as ``result 12``."""
    text: str
    """What is wrong with it."""


@dataclass(frozen=True)
class Verification:
    """What `verify` found in the chain and in the rows."""

    entries: int
    """Entries in the record."""
    rows: int
    """Rows that entries name."""
    head: str
    """Hash of the last entry, or an empty text. Note it elsewhere: only then does a missing end of the chain show."""
    findings: list[Finding] = field(default_factory=list)
    """What is wrong; empty if nothing is."""


def digest(table: str, row: Mapping[str, Any]) -> str:
    """SHA-256 over the table's name and all columns, as JSON with sorted keys."""
    return sha256([table, dict(row)])


def sha256(value: object) -> str:
    """SHA-256 of a value as JSON. Numbers have the digits that restore the same double.

    What JSON has no form for (a foreign program can put bytes into a column of SQLite) counts with its type.
    """
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), default=repr)
    return hashlib.sha256(text.encode()).hexdigest()


def append(connection: sa.Connection, at: str, who: str, rows: Names) -> None:
    """Adds the entry of some rows. The caller holds the lock of writers."""
    newest = sa.select(ENTRY.c.id, ENTRY.c.chain).order_by(ENTRY.c.id.desc()).limit(1)
    last = connection.execute(newest).first()
    number, before = (last.id + 1, last.chain) if last else (1, "")
    what = json.dumps(rows)
    chain = sha256([before, number, at, who, what])
    connection.execute(ENTRY.insert().values(id=number, at=at, who=who, what=what, chain=chain))


def verify(connection: sa.Connection, head: str | None = None) -> Verification:
    """Computes the chain and the digests of all rows again. ``head`` is a hash that was noted before."""
    findings: list[Finding] = []
    named: dict[tuple[str, int], tuple[str, int]] = {}
    before, number, noted = "", 0, head is None
    for entry in connection.execute(sa.select(ENTRY).order_by(ENTRY.c.id)):
        if entry.id != number + 1:
            findings.append(Finding(f"entry {number + 1}", "is missing"))
        if entry.chain != sha256([before, entry.id, entry.at, entry.who, entry.what]):
            findings.append(Finding(f"entry {entry.id}", MISFIT))
        for table, row, found in read_names(entry.what):
            named.setdefault((table, row), (found, entry.id))
        before, number = entry.chain, entry.id
        noted = noted or before == head
    if not noted:
        findings.append(Finding("entry", f"no entry has the hash {head}: entries up to it were removed or changed"))
    findings += compare_rows(connection, named)
    return Verification(number, len(named), before, findings)


def read_names(what: str) -> Names:
    """The rows that an entry names; none if someone made it unreadable, which its hash shows."""
    try:
        return [(str(table), int(row), str(found)) for table, row, found in json.loads(what)]
    except (ValueError, TypeError):
        return []


def compare_rows(connection: sa.Connection, named: dict[tuple[str, int], tuple[str, int]]) -> Iterator[Finding]:
    """Compares all rows with the digests in the entries."""
    missing = dict(named)
    for table in ENTERED:
        for row in connection.execute(sa.select(table).order_by(table.c.id)).mappings():
            found, entry = missing.pop((table.name, row["id"]), ("", 0))
            if not entry:
                yield Finding(f"{table.name} {row['id']}", "has no entry: it was added by another program")
            elif found != digest(table.name, dict(row)):
                yield Finding(f"{table.name} {row['id']}", f"is not what entry {entry} entered: it was changed")
    for (name, number), (_, entry) in missing.items():
        yield Finding(f"{name} {number}", f"is missing: entry {entry} entered it")
