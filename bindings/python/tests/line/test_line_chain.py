"""What is done behind the triggers' back shows, in SQLite and in PostgreSQL."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
import sqlalchemy as sa
from line_helpers import LIMITS, measurement

from zerorate.line import Record
from zerorate.line._chain import sha256
from zerorate.line._tables import METADATA


Execute = Callable[..., "sa.CursorResult[object]"]


@pytest.fixture
def filled(record: Record) -> Record:
    """A record of five entries; the last is a certificate."""
    for number in range(4):
        added = record.add(measurement(f"SN{number}"), LIMITS)
    assert added is not None
    record.add_certificate("C-1", added.results[0])
    assert record.verify().findings == []
    return record


@contextmanager
def behind(record: Record) -> Iterator[Execute]:
    """Statements that no trigger and no foreign key sees, as an administrator can run them."""
    engine = sa.create_engine(record._store.url)
    with engine.begin() as connection:
        if engine.dialect.name == "sqlite":
            names = connection.exec_driver_sql("SELECT name FROM sqlite_master WHERE type = 'trigger'").scalars().all()
            for name in names:
                connection.exec_driver_sql(f"DROP TRIGGER {name}")
        else:
            connection.exec_driver_sql("SET LOCAL session_replication_role = replica")
        yield lambda statement, **values: connection.execute(sa.text(statement), values)
    engine.dispose()


def wrong(record: Record, head: str | None = None) -> dict[str, str]:
    return {finding.where: finding.text for finding in record.verify(head).findings}


COLUMNS = [(table, column) for table in METADATA.sorted_tables for column in table.c if column.name != "id"]


def test_a_change_of_any_column_is_named(filled: Record) -> None:
    for table, column in COLUMNS:
        row = 1 if table.name == "certificate" else 2
        of_row = f"FROM {table.name} WHERE id = {row}"
        with behind(filled) as execute:
            old = execute(f"SELECT {column.name} {of_row}").scalar()
            change = f"UPDATE {table.name} SET {column.name} = :value WHERE id = {row}"
            execute(change, value=other(column))
        assert f"{table.name} {row}" in wrong(filled), column
        with behind(filled) as execute:
            execute(change, value=old)
        assert wrong(filled) == {}, column


def other(column: sa.Column[object]) -> object:
    """A value that the column of no row has."""
    kinds: dict[type, object] = {str: "x", float: 123.25, int: 99, bool: True}
    return kinds[column.type.python_type]


def test_the_last_digit_of_a_number_counts(filled: Record) -> None:
    with behind(filled) as execute:
        execute("UPDATE result SET pbc_dps = 0.5000000000000001 WHERE id = 3")
    assert wrong(filled) == {"result 3": "is not what entry 3 entered: it was changed"}


def test_an_added_row_is_named(filled: Record) -> None:
    with behind(filled) as execute:
        execute("INSERT INTO unit (id, part, serial) VALUES (99, 'ADIS16130', 'SN99')")
    assert wrong(filled) == {"unit 99": "has no entry: it was added by another program"}


def test_a_removed_row_is_named(filled: Record) -> None:
    with behind(filled) as execute:
        execute("DELETE FROM certificate")
    assert wrong(filled) == {"certificate 1": "is missing: entry 5 entered it"}


@pytest.mark.parametrize("entry", [1, 3])
def test_a_removed_entry_is_named(filled: Record, entry: int) -> None:
    with behind(filled) as execute:
        execute(f"DELETE FROM entry WHERE id = {entry}")
    found = wrong(filled)
    assert found[f"entry {entry}"] == "is missing"
    assert "does not fit" in found[f"entry {entry + 1}"]
    assert "has no entry" in found[f"result {entry}"]


def test_a_removed_last_entry_shows_by_its_rows(filled: Record) -> None:
    with behind(filled) as execute:
        execute("DELETE FROM entry WHERE id = 5")
    assert wrong(filled) == {"certificate 1": "has no entry: it was added by another program"}


def test_a_removed_end_shows_only_by_a_noted_head(filled: Record) -> None:
    head = filled.verify().head
    with behind(filled) as execute:
        execute("DELETE FROM entry WHERE id = 5")
        execute("DELETE FROM certificate")
    assert wrong(filled) == {}
    assert "no entry has the hash" in wrong(filled, head)["entry"]


def test_a_noted_head_holds_when_entries_follow(filled: Record) -> None:
    head = filled.verify().head
    filled.add(measurement("SN9"))
    found = filled.verify(head)
    assert (found.findings, found.entries, found.head != head) == ([], 6, True)


def test_a_chain_forged_from_the_first_entry_shows_only_by_a_noted_head(filled: Record) -> None:
    """Whoever can write to the database can compute all hashes again. Only a head that was noted elsewhere helps."""
    head = filled.verify().head
    with behind(filled) as execute:
        execute("UPDATE entry SET who = 'someone else' WHERE id = 1")
        before = ""
        for row in execute("SELECT id, at, who, what FROM entry ORDER BY id").all():
            chain = sha256([before, row.id, row.at, row.who, row.what])
            execute(f"UPDATE entry SET chain = '{chain}' WHERE id = {row.id}")
            before = chain
    assert wrong(filled) == {}
    assert list(wrong(filled, head)) == ["entry"]


def test_an_unreadable_entry_is_named(filled: Record) -> None:
    with behind(filled) as execute:
        execute("UPDATE entry SET what = '[[[' WHERE id = 2")
    assert "entry 2" in wrong(filled)


def test_what_entries_say(filled: Record) -> None:
    with filled._store.reading() as connection:
        what = connection.exec_driver_sql("SELECT what FROM entry WHERE id = 1").scalar()
    assert [name for name, _, _ in json.loads(str(what))] == ["unit", "run", "result", "verdict", "verdict"]


@pytest.mark.parametrize("value", ["'text'", "x'00ff'", "1e999", "7"])
def test_a_foreign_kind_of_value_in_sqlite_is_named(filled: Record, url: str, value: str) -> None:
    if not url.startswith("sqlite"):
        pytest.skip("PostgreSQL has types")
    with behind(filled) as execute:
        execute(f"UPDATE result SET pbc_dps = {value} WHERE id = 2")
    assert "result 2" in wrong(filled)
    with behind(filled) as execute:
        execute(f"UPDATE run SET simulated = {value} WHERE id = 3")
    assert "run 3" in wrong(filled)
