"""Entering a measurement: its rows, and the entry that names them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa

from . import _chain
from ._errors import LineError
from ._limits import Limits, worst
from ._measurement import AxisResult, Measurement, now
from ._tables import CERTIFICATE, NUMBERS, RESULT, RUN, UNIT, VERDICT


@dataclass(frozen=True)
class Added:
    """A measurement that was entered."""

    run: int
    """Its id in the table ``run``."""
    results: list[int]
    """Ids in the table ``result``, one for each axis."""
    superseded: list[int]
    """Ids of the results that they supersede."""
    verdict: str | None
    """The worst verdict; None if nothing was judged."""
    verdicts: Mapping[str, str]
    """The verdict of each quantity, the worst of all axes."""


@dataclass
class Entering:
    """A transaction that enters rows. The caller holds the lock of writers."""

    connection: sa.Connection
    who: str
    at: str = field(default_factory=now)
    names: _chain.Names = field(default_factory=list)

    def insert(self, table: sa.Table, values: Mapping[str, Any]) -> int:
        """Inserts a row with the next id, and notes its digest. The lock of writers makes the id safe."""
        last = self.connection.execute(sa.select(sa.func.max(table.c.id))).scalar() or 0
        row = {column.name: clean(values.get(column.name)) for column in table.c}
        row["id"] = last + 1
        self.connection.execute(table.insert().values(row))
        self.names.append((table.name, last + 1, _chain.digest(table.name, row)))
        return int(row["id"])

    def close(self) -> None:
        """Adds the entry."""
        _chain.append(self.connection, self.at, self.who, self.names)


def clean(value: Any) -> Any:
    """A value as both databases give it back: SQLite has no −0, PostgreSQL no NUL, and UTF-8 no half characters."""
    if isinstance(value, float):
        return value + 0.0
    if isinstance(value, str):
        return value.replace("\0", "\ufffd").encode("utf-8", "replace").decode("utf-8")
    return value


def enter(connection: sa.Connection, one: Measurement, limits: Limits | None, who: str) -> Added | None:
    """Enters a measurement with its verdicts; None if it is in the record already."""
    entering = Entering(connection, clean(who))
    unit = find_unit(connection, one) or entering.insert(UNIT, {"part": one.part, "serial": one.serial})
    known = sa.select(RUN.c.id).where(RUN.c.unit == unit, RUN.c.identity == one.identity)
    if connection.execute(known).first():
        return None
    values = {name: getattr(one, name, None) for name in RUN.c.keys()}
    values.update(unit=unit, identity=one.identity, entered=entering.at, warnings=json.dumps(list(one.warnings)))
    run = entering.insert(RUN, values)
    results, superseded = [], []
    found: dict[str, list[str]] = {}
    for axis in one.results:
        before = superseded_by(connection, unit, one, axis.axis, entering.at)
        superseded += [] if before is None else [before]
        result = entering.insert(RESULT, result_values(one, axis, run, before))
        results.append(result)
        for quantity, verdict in judge(entering, result, axis, one.simulated, limits):
            found.setdefault(quantity, []).append(verdict)
    entering.close()
    verdicts = {quantity: worst(of_axes) or "" for quantity, of_axes in found.items()}
    return Added(run, results, superseded, worst(list(verdicts.values())), verdicts)


def find_unit(connection: sa.Connection, one: Measurement) -> int | None:
    """The id of the unit, if it is known."""
    known = sa.select(UNIT.c.id).where(UNIT.c.part == one.part, UNIT.c.serial == one.serial)
    return connection.execute(known).scalar()


def result_values(one: Measurement, axis: AxisResult, run: int, before: int | None) -> dict[str, Any]:
    """The columns of a result."""
    numbers = {name: None if axis.numbers.get(name) is None else float(axis.numbers[name] or 0) for name in NUMBERS}
    return {
        "run": run,
        "axis": axis.axis,
        "calibration_id": one.calibration_id,
        "toml": one.toml,
        "supersedes": before,
        **numbers,
    }


def superseded_by(connection: sa.Connection, unit: int, one: Measurement, axis: str, at: str) -> int | None:
    """The result that a new one supersedes: the newest of the unit's axis, if that was measured before.

    Simulated results supersede simulated ones only. A measurement that is entered late supersedes nothing.
    """
    time = sa.func.coalesce(RUN.c.measured, RUN.c.entered)
    newest = (
        sa.select(RESULT.c.id, time.label("time"))
        .join(RUN, RESULT.c.run == RUN.c.id)
        .where(RUN.c.unit == unit, RUN.c.simulated == one.simulated, RESULT.c.axis == axis)
        .order_by(time.desc(), RESULT.c.id.desc())
        .limit(1)
    )
    last = connection.execute(newest).first()
    return int(last.id) if last and last.time <= (one.measured or at) else None


def judge(
    entering: Entering, result: int, axis: AxisResult, simulated: bool, limits: Limits | None
) -> list[tuple[str, str]]:
    """Enters the verdicts on a result, and returns them by quantity."""
    verdicts = []
    for quantity, limit in limits.limits.items() if limits else ():
        value, u = axis.numbers.get(quantity), axis.numbers.get(f"u_{quantity}")
        verdict = limit.judge(value, u)
        verdicts.append((quantity, verdict))
        values = {"result": result, "quantity": quantity, "value": value, "u": u, "verdict": verdict}
        values.update(lower=limit.lower, upper=limit.upper, rule=limit.rule, simulated=simulated)
        entering.insert(VERDICT, {**values, "limits_version": limits.version if limits else ""})
    return verdicts


def enter_certificate(connection: sa.Connection, values: Mapping[str, Any], who: str) -> int:
    """Enters a certificate. One that replaces another says why."""
    entering = Entering(connection, clean(who))
    if connection.execute(sa.select(CERTIFICATE.c.id).where(CERTIFICATE.c.number == values["number"])).first():
        raise LineError(f"the record has a certificate {values['number']} already")
    if not connection.execute(sa.select(RESULT.c.id).where(RESULT.c.id == values["result"])).first():
        raise LineError(f"the record has no result {values['result']}")
    replaces = None
    if values["replaces"] is not None:
        old = sa.select(CERTIFICATE.c.id).where(CERTIFICATE.c.number == values["replaces"])
        replaces = connection.execute(old).scalar()
        if replaces is None:
            raise LineError(f"the record has no certificate {values['replaces']} to replace")
    certificate = entering.insert(CERTIFICATE, {**values, "replaces": replaces, "issued": entering.at, "issuer": who})
    entering.close()
    return certificate
