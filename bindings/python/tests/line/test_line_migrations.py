"""The tables of a record: made by migrations, refused where a newer program wrote them."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from line_helpers import line, measurement

from zerorate.line import LineError, Record, open_record
from zerorate.line._tables import METADATA


def test_the_migrations_make_the_tables_of_the_program(record: Record) -> None:
    with record._store.engine.begin() as connection:
        context = MigrationContext.configure(connection, opts={"version_table": "line_version", "compare_type": True})
        assert compare_metadata(context, METADATA) == []


def test_a_record_is_opened_again(url: str) -> None:
    with open_record(url) as record:
        record.add(measurement("SN1"))
    with open_record(url, create=False) as record:
        assert len(record.history("SN1")) == 1


def test_a_record_of_a_newer_program_is_refused(url: str) -> None:
    with open_record(url) as record, record._store.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE line_version SET version_num = '0999'")
    with pytest.raises(LineError, match="of version 0999, and this program knows versions up to .*update zerorate"):
        open_record(url)


def test_an_empty_database_is_not_a_record(url: str) -> None:
    if url.startswith("sqlite"):
        Path(url[len("sqlite:///") :]).touch()
    with pytest.raises(LineError, match="holds no record yet"):
        open_record(url, create=False)


def test_a_missing_file_is_not_made_by_reading(tmp_path: Path) -> None:
    with pytest.raises(LineError, match="there is no record at"):
        open_record(f"sqlite:///{tmp_path / 'line.db'}", create=False)
    assert list(tmp_path.iterdir()) == []


def test_a_database_of_another_program_is_left_alone(url: str) -> None:
    engine = sa.create_engine(url.replace("postgresql:", "postgresql+psycopg:"))
    with engine.begin() as connection:
        connection.exec_driver_sql("CREATE TABLE unit (name TEXT)")
    engine.dispose()
    with pytest.raises(LineError, match="already exists.*a database of its own"):
        open_record(url)
    with engine.begin() as connection:
        assert sa.inspect(connection).get_table_names() == ["unit"]


def test_sqlite_reaches_the_disk_at_each_commit(tmp_path: Path) -> None:
    with open_record(f"sqlite:///{tmp_path / 'line.db'}") as record, record._store.reading() as connection:
        values = [connection.exec_driver_sql(f"PRAGMA {name}").scalar() for name in ("journal_mode", "synchronous")]
        assert values == ["wal", 2]  # 2 is FULL


@pytest.mark.parametrize(
    "url", ["line.db", "mysql://host/line", "sqlite", "postgresql+psycopg2x://", "://", "sqlite:///nowhere/line.db"]
)
def test_a_wrong_address_is_explained(url: str, tmp_path: Path) -> None:
    done = line("add", __file__, "--db", url, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("error: ") and done.stderr.count("\n") == 1


def test_a_server_that_does_not_answer_is_explained_without_the_password(tmp_path: Path) -> None:
    pytest.importorskip("psycopg", exc_type=ImportError)
    done = line("show", "--db", "postgresql://me:secret@127.0.0.1:1/line", cwd=tmp_path)
    assert done.returncode == 1
    assert "refused" in done.stderr and "secret" not in done.stderr and done.stderr.count("\n") == 1


def test_any_file_is_not_a_database(tmp_path: Path) -> None:
    (tmp_path / "line.db").write_bytes(b"This is not a database. " * 100)
    done = line("show", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert "not a database" in done.stderr
    assert (tmp_path / "line.db").read_bytes().startswith(b"This is")


def test_a_damaged_database_is_explained(tmp_path: Path) -> None:
    file = tmp_path / "line.db"
    with open_record(f"sqlite:///{file}") as record:
        for number in range(200):
            record.add(measurement(f"SN{number}"))
    content = bytearray(file.read_bytes())
    content[len(content) // 2 :] = b"\xff" * (len(content) - len(content) // 2)
    file.write_bytes(content)
    done = line("verify", cwd=tmp_path)
    assert done.returncode == 1
    assert "malformed" in done.stderr or "wrong: " in done.stdout


def test_a_locked_database_waits_and_then_says_so(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'line.db'}?timeout=0.2"
    with open_record(url) as record:
        other = sqlite3.connect(tmp_path / "line.db", isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        assert record.results() == []  # readers do not wait
        with pytest.raises(LineError, match="locked .another program is writing"):
            record.add(measurement("SN1"))
        other.close()
        assert record.add(measurement("SN1")) is not None
