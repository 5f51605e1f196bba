"""The database of a record: SQLite by default, PostgreSQL by its URL."""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from alembic.util import CommandError
from sqlalchemy import event
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError

from ._errors import LineError

VERSION_TABLE = "line_version"
LOCK = 16130
"""The key of PostgreSQL's advisory lock that writers hold."""
WAIT_S = 30
"""How long a writer waits for another one."""


class Store:
    """A database whose tables are of this program's version."""

    def __init__(self, url: str, *, create: bool) -> None:
        self.url = parse_url(url)
        self.name = self.url.difference_update_query(["timeout"]).render_as_string(hide_password=True)
        file = self.url.database if self.url.get_backend_name() == "sqlite" else None
        if file and not create and not os.path.exists(file):
            raise LineError(f"there is no record at {file}: `zerorate line import` or `add` begins one; see --db")
        with self.said():
            self.engine = make_engine(self.url)
            self.migrate(create)

    def migrate(self, create: bool) -> None:
        """Brings the tables to the version of this program, where they are older. Two programs wait for each other."""
        if not self.pending(create):
            return
        with self.writing() as connection:
            config = scripts_config()
            config.attributes["connection"] = connection
            command.upgrade(config, "head")

    def pending(self, create: bool) -> bool:
        """Whether tables are to be made or brought up to date; refuses a database of a newer program."""
        with self.reading() as connection:
            context = MigrationContext.configure(connection, opts={"version_table": VERSION_TABLE})
            found = context.get_current_revision()
        scripts = ScriptDirectory.from_config(scripts_config())
        if found is None and not create:
            raise LineError(f"{self.name} holds no record yet: `zerorate line import` or `add` begins one; see --db")
        if found is not None:
            try:
                scripts.get_revision(found)
            except CommandError:
                newest = scripts.get_current_head()
                text = f"{self.name} is of version {found}, and this program knows versions up to {newest}"
                raise LineError(f"{text}: update zerorate") from None
        return found != scripts.get_current_head()

    @contextmanager
    def writing(self) -> Iterator[sa.Connection]:
        """A transaction that writes. There is one at a time, because each entry holds the hash of the last."""
        with self.said(), self.engine.begin() as connection:
            if self.url.get_backend_name() == "postgresql":
                connection.exec_driver_sql(f"SET LOCAL lock_timeout = '{WAIT_S}s'")
                connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({LOCK})")
            yield connection

    @contextmanager
    def reading(self) -> Iterator[sa.Connection]:
        """A transaction that reads one state of the record, and waits for no writer."""
        with self.said(), self.engine.connect() as connection:
            options: dict[str, Any] = {"reads": True}
            if self.url.get_backend_name() == "postgresql":
                options["isolation_level"] = "REPEATABLE READ"
            yield connection.execution_options(**options)

    @contextmanager
    def said(self) -> Iterator[None]:
        """Turns an error of the database into one line that names the record and says what to do."""
        try:
            yield
        except (DBAPIError, sqlite3.Error) as error:
            cause = getattr(error, "orig", None) or error
            lines = str(cause).strip().splitlines() or [type(cause).__name__]
            raise LineError(f"{self.name}: {lines[0]}{advice(lines[0])}") from error

    def close(self) -> None:
        """Closes the connections."""
        self.engine.dispose()


ADVICE = {
    "locked": "another program is writing; close it or try again",
    "readonly": "you may not write there; give another --db, or the right to write to the file and its folder",
    "unable to open": "does the folder exist, and may you write to it? SQLite writes beside the file, even to read",
    "not a database": "give --db a record, or a new name",
    "already exists": "another program's tables are there; give the record a database of its own",
    "is full": "make room and try again; nothing of this step was entered",
    "disk I/O": "is the disk full or failing? Nothing of this step was entered",
    "malformed": "the file is damaged; take the last copy of it, and compare `line verify`",
    "lock timeout": "another program is writing; close it or try again",
    "does not exist": "make the database first, with createdb",
}


def advice(text: str) -> str:
    """What to do about an error of the database."""
    return next((f" ({known})" for word, known in ADVICE.items() if word in text), "")


def parse_url(url: str) -> sa.URL:
    """The address of a database, with the driver that the package uses."""
    try:
        found = sa.make_url(url)
        backend = found.get_backend_name()
    except (ArgumentError, NoSuchModuleError, ValueError):
        backend = ""
    if backend == "sqlite":
        return found if "timeout" in found.query else found.update_query_dict({"timeout": str(WAIT_S)})
    if backend in ("postgresql", "postgres"):
        return found.set(drivername="postgresql+psycopg")
    raise LineError("--db takes sqlite:///FILE or postgresql://USER@HOST/DATABASE")


def make_engine(url: sa.URL) -> sa.Engine:
    """The engine of a database."""
    try:
        engine = sa.create_engine(url)
    except ModuleNotFoundError as error:
        raise LineError(f"PostgreSQL needs {error.name}: pip install 'zerorate[postgres]'") from None
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", prepare_sqlite)
        event.listen(engine, "begin", begin_sqlite)
    return engine


def prepare_sqlite(connection: sqlite3.Connection, _record: object) -> None:
    """Makes each commit reach the disk, and leaves the beginning of transactions to `begin_sqlite`."""
    connection.isolation_level = None
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("PRAGMA foreign_keys = ON")
    # SQLite does not wait for its lock where two programs change the journal of a new file at once.
    last = time.monotonic() + WAIT_S
    while connection.execute("PRAGMA journal_mode").fetchone()[0] == "delete":
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > last:
                raise
            time.sleep(0.02)


def begin_sqlite(connection: sa.Connection) -> None:
    """Takes the lock of writers at once: a read that turns into a write would fail as locked instead of waiting."""
    reads = connection.get_execution_options().get("reads")
    connection.exec_driver_sql("BEGIN" if reads else "BEGIN IMMEDIATE")


def scripts_config() -> Config:
    """Alembic's settings: the migrations are files of this package."""
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations").replace("%", "%%"))
    return config
