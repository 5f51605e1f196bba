"""Fixtures: a record in each kind of database, limits, and calibrations of the twin."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, os.path.dirname(__file__))

from line_helpers import LIMITS_TOML, calibrate  # noqa: E402

from zerorate.line import Record, open_record  # noqa: E402

if TYPE_CHECKING:
    from line_server import Server


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    """A PostgreSQL server."""
    if os.name == "nt":
        pytest.skip("the server is reached by a unix socket")
    from line_server import make_server, why_not

    reason = why_not()
    if reason is not None:
        pytest.skip(reason)
    made = make_server()
    yield made
    made.stop()


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The address of an empty database, of each kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'line.db'}"
    server: Server = request.getfixturevalue("server")
    return server.database()


@pytest.fixture
def record(url: str) -> Iterator[Record]:
    """An empty record, in each kind of database."""
    with open_record(url) as opened:
        yield opened


@pytest.fixture(scope="session")
def calibration(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A calibration of the twin, serial number SN7, and its capture. Tests do not change them."""
    return calibrate(tmp_path_factory.mktemp("calibration"), 7, "SN7")


@pytest.fixture
def limits(tmp_path: Path) -> Path:
    """A file of limits."""
    path = tmp_path / "limits.toml"
    path.write_text(LIMITS_TOML)
    return path
