"""Comparing the files that a record names with the hashes that were entered."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote, urlparse

from ._errors import LineError
from ._files import read_bytes, sample_hash


@dataclass(frozen=True)
class Named:
    """A file that a run names."""

    file: str
    """Its path or address."""
    sha256: str
    """The hash that was entered: of the samples of a capture, or of the bytes of a calibration."""
    kind: str
    """``capture`` or ``calibration``."""
    serial: str
    """Serial number of the unit."""


@dataclass(frozen=True)
class Checked:
    """A file that was compared."""

    named: Named
    """The file."""
    state: str
    """``same``, ``differs``, ``missing``, or ``elsewhere`` if it is not on this computer's disks."""
    text: str
    """What is wrong."""


def check_files(named: Iterable[Named]) -> list[Checked]:
    """Compares each file once."""
    return [check(one) for one in dict.fromkeys(named)]


def check(one: Named) -> Checked:
    """Compares one file."""
    path = local_path(one.file)
    if path is None:
        return Checked(one, "elsewhere", "it is not on a disk of this computer, and was not compared")
    if not path.exists():
        return Checked(one, "missing", "there is no such file")
    try:
        found, problem = sample_hash(path) if one.kind == "capture" else (bytes_hash(path), "")
    except LineError as error:
        found, problem = None, str(error)
    if found is None:
        return Checked(one, "differs", problem)
    if found != one.sha256:
        return Checked(one, "differs", f"its hash is {found}, and {one.sha256} was entered")
    return Checked(one, "same", "")


def local_path(address: str) -> Path | None:
    """The path of a local file; None for an address of another kind."""
    if not re.match(r"[A-Za-z][A-Za-z0-9+.-]+://", address):
        return Path(address)
    parsed = urlparse(address)
    return Path(unquote(parsed.path)) if parsed.scheme in ("file", "local") else None


def bytes_hash(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    return hashlib.sha256(read_bytes(path)).hexdigest()
