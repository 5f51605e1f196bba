"""What a record says of its units."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from ._checks import Named
from ._limits import worst
from ._tables import CERTIFICATE, NUMBERS, RESULT, RUN, UNIT, VERDICT


@dataclass(frozen=True)
class Verdict:
    """The verdict on one quantity of a result."""

    quantity: str
    """Its name, with the unit."""
    value: float | None
    """The value that was judged."""
    u: float | None
    """Its standard uncertainty."""
    lower: float | None
    """Lower limit."""
    upper: float | None
    """Upper limit."""
    rule: str
    """``simple`` or ``guarded``."""
    verdict: str
    """``pass``, ``conditionalPass``, ``conditionalFail``, ``fail`` or ``undecided``."""
    simulated: bool
    """Whether the part was the software twin: then the verdict says nothing about a product."""
    limits_version: str
    """Version of the limits."""


@dataclass(frozen=True)
class Result:
    """A result of a unit, with its run and verdicts. A run without a result (refused, failed) has no numbers."""

    serial: str
    """Serial number of the unit."""
    part: str
    """Kind of the part."""
    run: int
    """Id of the run."""
    result: int | None
    """Id of the result; None if the run gave none."""
    axis: str | None
    """Axis of the result."""
    state: str
    """``ok``, ``refused``, ``failed`` or ``killed``."""
    simulated: bool
    """Whether the part was the software twin."""
    current: bool
    """Whether this is the newest result of the unit's axis."""
    calibration_id: str | None
    """Short identifier of the calibration."""
    supersedes: int | None
    """Id of the result that it superseded."""
    verdict: str | None
    """The worst of the verdicts; None if nothing was judged."""
    verdicts: list[Verdict]
    """The verdict on each quantity."""
    numbers: dict[str, float | None]
    """Values and standard uncertainties by their names, which have the units."""
    fields: dict[str, Any]
    """The other columns of the run."""
    certificates: list[str]
    """Numbers of the certificates of the result."""


FIELDS = [name for name in RUN.c.keys() if name not in ("id", "unit", "identity", "state", "simulated", "warnings")]


def results(connection: sa.Connection, serial: str | None = None, part: str | None = None) -> list[Result]:
    """All runs and results of one unit, or of all, in the order in which they were measured."""
    time = sa.func.coalesce(RUN.c.measured, RUN.c.entered)
    query = (
        sa.select(
            UNIT.c.serial,
            UNIT.c.part,
            RUN.c.id.label("run_id"),
            RESULT.c.id.label("result_id"),
            *(column for column in RUN.c if column.name not in ("id", "unit")),
            *(column for column in RESULT.c if column.name not in ("id", "run")),
        )
        .join(RUN, RUN.c.unit == UNIT.c.id)
        .outerjoin(RESULT, RESULT.c.run == RUN.c.id)
        .order_by(time, RUN.c.id, RESULT.c.id)
    )
    if serial is not None:
        query = query.where(UNIT.c.serial == serial)
    if part is not None:
        query = query.where(UNIT.c.part == part)
    rows = list(connection.execute(query).mappings())
    newest = {axis_key(row): row["result_id"] for row in rows if row["result_id"] is not None}
    verdicts, certificates = all_verdicts(connection), all_certificates(connection)
    return [
        one_result(row, newest.get(axis_key(row)), verdicts.get(row["result_id"], []), certificates) for row in rows
    ]


def axis_key(row: Any) -> tuple[Any, ...]:
    """What has one current result: an axis of a unit, measured or simulated."""
    return row["part"], row["serial"], row["axis"], row["simulated"]


def one_result(row: Any, newest: int | None, verdicts: list[Verdict], certificates: dict[int, list[str]]) -> Result:
    """A result from the columns of its unit, its run and itself."""
    return Result(
        serial=row["serial"],
        part=row["part"],
        run=row["run_id"],
        result=row["result_id"],
        axis=row["axis"],
        state=row["state"],
        simulated=bool(row["simulated"]),
        current=row["result_id"] is not None and row["result_id"] == newest,
        calibration_id=row["calibration_id"],
        supersedes=row["supersedes"],
        verdict=worst([verdict.verdict for verdict in verdicts]),
        verdicts=verdicts,
        numbers={name: row[name] for name in NUMBERS if row[name] is not None},
        fields={**{name: row[name] for name in FIELDS}, "warnings": json.loads(row["warnings"])},
        certificates=certificates.get(row["result_id"], []),
    )


def all_verdicts(connection: sa.Connection) -> dict[int, list[Verdict]]:
    """The verdicts by the id of their result."""
    found: dict[int, list[Verdict]] = {}
    for row in connection.execute(sa.select(VERDICT).order_by(VERDICT.c.id)).mappings():
        values = {name: row[name] for name in VERDICT.c.keys() if name not in ("id", "result")}
        found.setdefault(row["result"], []).append(Verdict(**values))
    return found


def all_certificates(connection: sa.Connection) -> dict[int, list[str]]:
    """The numbers of certificates by the id of their result."""
    found: dict[int, list[str]] = {}
    for row in connection.execute(sa.select(CERTIFICATE).order_by(CERTIFICATE.c.id)):
        found.setdefault(row.result, []).append(row.number)
    return found


def files(connection: sa.Connection) -> list[Named]:
    """The files that runs name together with a hash."""
    query = sa.select(UNIT.c.serial, RUN).join(RUN, RUN.c.unit == UNIT.c.id).order_by(RUN.c.id)
    return [
        Named(row[kind], row[f"{kind}_sha256"], kind, row["serial"])
        for row in connection.execute(query).mappings()
        for kind in ("capture", "calibration")
        if row[kind] and row[f"{kind}_sha256"]
    ]
