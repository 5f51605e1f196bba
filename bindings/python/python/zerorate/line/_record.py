"""The record of a production line."""

from __future__ import annotations

import getpass
import hashlib
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from types import TracebackType

from . import _chain, _entering, _reading
from ._chain import Verification
from ._certificates import read_bytes, read_certificate
from ._checks import Checked, check_files
from ._entering import Added
from ._errors import LineError
from ._files import read_calibration
from ._limits import Limits
from ._measurement import Measurement
from ._reading import Result
from ._store import Store

BATCH = 100
"""Measurements of an import that are entered in one transaction, so that stations wait for a moment only."""


@dataclass(frozen=True)
class Imported:
    """What an import did with the rows of a table."""

    added: int = 0
    """Rows that were entered."""
    known: int = 0
    """Rows that the record had already."""
    without_serial: list[str] = field(default_factory=list)
    """Addresses of the rows without a serial number, which were not entered."""
    unusable: list[str] = field(default_factory=list)
    """Address and reason of other rows that were not entered."""


class Record:
    """Units, their measurements, results, verdicts and certificates. Rows are added, and never changed or removed.

    `open_record` opens one. It may be used by several threads, and many programs may use one record at once.
    """

    def __init__(self, store: Store, who: str | None = None) -> None:
        self._store = store
        self._who = who or user()

    def __enter__(self) -> Record:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections to the database."""
        self._store.close()

    def add(self, measurement: Measurement, limits: Limits | None = None) -> Added | None:
        """Enters a measurement and its verdicts in one transaction; returns None if the record has it already.

        A second result of a unit supersedes the first. When this returns, the rows are on the disk.
        """
        with self._store.writing() as connection:
            return _entering.enter(connection, measurement, limits, measurement.operator or self._who)

    def add_calibration(
        self,
        path: str | os.PathLike[str],
        *,
        capture: str | os.PathLike[str] | None = None,
        limits: Limits | None = None,
    ) -> Added | None:
        """Enters a calibration file, like `add`.

        Parameters
        ----------
        path
            The calibration of a unit with a serial number.
        capture
            The file of its samples, whose hash must be the one that the calibration states.
        limits
            The limits to judge it by.

        Raises
        ------
        LineError
            If a file is damaged, or the capture holds other samples.
        """
        measurement = read_calibration(Path(path), None if capture is None else Path(capture))
        return self.add(measurement, limits)

    def import_rows(self, path: str | os.PathLike[str], limits: Limits | None = None) -> Imported:
        """Enters the rows of a fleet's table: ``rows.parquet``, or the folder that contains it.

        Importing a table again adds nothing. The answer names the rows that cannot be entered.
        """
        from ._rows import read_rows

        rows, added = read_rows(Path(path)), 0
        for batch in batches(rows.measurements):
            with self._store.writing() as connection:
                answers = [_entering.enter(connection, one, limits, self._who) for one in batch]
            added += sum(answer is not None for answer in answers)
        return Imported(added, len(rows.measurements) - added, rows.without_serial, rows.unusable)

    def add_certificate(
        self,
        number: str,
        result: int,
        *,
        dcc_sha256: str | None = None,
        pdf_sha256: str | None = None,
        replaces: str | None = None,
        reason: str | None = None,
    ) -> int:
        """Enters a certificate of a result, and returns its id.

        Parameters
        ----------
        number
            Its number, which is unique.
        result
            Id of the result.
        dcc_sha256, pdf_sha256
            Hashes of its files.
        replaces, reason
            The number of the certificate that it replaces, and why.
        """
        if (replaces is None) != (reason is None):
            raise LineError("a certificate that replaces another one needs a reason, and only such a one has a reason")
        values = {"number": number, "result": result, "dcc_sha256": dcc_sha256, "pdf_sha256": pdf_sha256}
        with self._store.writing() as connection:
            return _entering.enter_certificate(
                connection, {**values, "replaces": replaces, "reason": reason}, self._who
            )

    def certify(
        self, dcc: str | os.PathLike[str], *, pdf: str | os.PathLike[str] | None = None, reason: str | None = None
    ) -> int:
        """Enters the certificate whose XML `dcc` is, for the calibration that it states; returns its id.

        Parameters
        ----------
        dcc, pdf
            The files that ``zerorate certificate`` wrote.
        reason
            Why it replaces another certificate, if it does.
        """
        found = read_certificate(Path(dcc))
        ids = [one.result for one in self.results() if one.calibration_id == found.calibration_id]
        if not ids or ids[0] is None:
            raise LineError(f"the record has no calibration {found.calibration_id}: `zerorate line add` enters it")
        pdf_sha256 = None if pdf is None else hashlib.sha256(read_bytes(Path(pdf))).hexdigest()
        hashes = {"dcc_sha256": found.sha256, "pdf_sha256": pdf_sha256}
        return self.add_certificate(found.number, ids[0], replaces=found.replaces, reason=reason, **hashes)

    def history(self, serial: str, part: str | None = None) -> list[Result]:
        """All that was measured of a unit, from the first to the last; empty if the record does not know the unit."""
        with self._store.reading() as connection:
            return _reading.results(connection, serial, part)

    def results(self, part: str | None = None) -> list[Result]:
        """All that was measured of all units, in the order of measurement."""
        with self._store.reading() as connection:
            return _reading.results(connection, part=part)

    def verify(self, head: str | None = None) -> Verification:
        """Computes the chain and the digests of all rows again.

        Parameters
        ----------
        head
            The hash of the last entry at an earlier time. Only with it does a removed end of the record show.
        """
        with self._store.reading() as connection:
            return _chain.verify(connection, head)

    def verify_files(self) -> list[Checked]:
        """Compares the captures and calibration files that the record names with their hashes."""
        with self._store.reading() as connection:
            named = _reading.files(connection)
        return check_files(named)


def open_record(url: str, *, create: bool = True, who: str | None = None) -> Record:
    """Opens the record at an address, and brings its tables to the version of this program.

    Parameters
    ----------
    url
        ``sqlite:///line.db`` (a file), or ``postgresql://user@host/database``.
    create
        Begin a record where there is none.
    who
        Name for the entries; the user of this computer if not given.

    Raises
    ------
    LineError
        If there is no record and none may be begun, a newer program wrote it, or the database cannot be used.
    """
    return Record(Store(url, create=create), who)


def batches(measurements: Iterable[Measurement]) -> Iterator[list[Measurement]]:
    """Measurements in lists of `BATCH`."""
    left = iter(measurements)
    while batch := list(islice(left, BATCH)):
        yield batch


def user() -> str:
    """The name of the user; a process without one is known by its number."""
    try:
        return getpass.getuser()
    except (KeyError, OSError, ImportError):
        return f"user {os.getuid()}" if hasattr(os, "getuid") else "unknown"
