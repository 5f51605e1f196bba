"""Measurements from the table of a fleet, ``rows.parquet``. `zerorate.fleet` describes its columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from ._errors import LineError
from ._measurement import AxisResult, Measurement, utc
from ._tables import NOISE, NUMBERS

FILE = "rows.parquet"
NEEDED = ("url", "serial", "part", "state", "recipe", "simulated", "created", "capture_sha256", "pbc_dps", "axes")
INTERVALS_PER_U = 2 * 1.959963984540054
"""A 95 % interval is as wide as so many standard uncertainties."""


@dataclass(frozen=True)
class Rows:
    """The rows of a table: what can be entered, and what cannot."""

    measurements: list[Measurement] = field(default_factory=list)
    """In the order in which they were measured."""
    without_serial: list[str] = field(default_factory=list)
    """Addresses of the rows without a serial number."""
    unusable: list[str] = field(default_factory=list)
    """Address and reason of the rows that cannot be entered for another reason."""


def read_rows(path: Path) -> Rows:
    """Reads the table of a fleet: the file, or the folder that contains it."""
    found = Rows()
    for row in table_rows(path / FILE if path.is_dir() else path):
        address = row["url"] or row.get("key") or "a row without an address"
        if not row["serial"]:
            found.without_serial.append(address)
            continue
        try:
            found.measurements.append(measurement(row))
        except LineError as error:
            found.unusable.append(f"{address}: {error}")
    found.measurements.sort(key=lambda one: one.measured or "")
    return found


def table_rows(file: Path) -> Iterator[dict[str, Any]]:
    """The rows of a Parquet file with the columns of a fleet."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not file.exists():
        raise LineError(f"there is no {file}: `zerorate fleet run` writes it")
    try:
        parquet = pq.ParquetFile(file)
        missing = [name for name in NEEDED if name not in parquet.schema_arrow.names]
        if missing:
            raise LineError(f"{file} is not the table of a fleet: it has no column {', '.join(missing)}")
        for batch in parquet.iter_batches():
            yield from batch.to_pylist()
    except (pa.ArrowException, OSError) as error:
        raise LineError(f"{file} is not a Parquet file that can be read: {str(error).splitlines()[0]}") from None


def measurement(row: Mapping[str, Any]) -> Measurement:
    """The measurement of one row."""
    created = row["created"]
    return Measurement(
        serial=row["serial"],
        part=row["part"] or "",
        recipe=row["recipe"] or "",
        state=row["state"],
        simulated=bool(row["simulated"]) or created == "SIMULATED",
        results=axis_results(row) if row["state"] == "ok" else (),
        code=row.get("code") or None,
        error=row.get("error") or None,
        measured=None if created == "SIMULATED" else utc(created) or ended(row),
        method=row.get("method"),
        program=row.get("program"),
        device=None,
        warnings=tuple(row.get("warnings") or ()),
        calibration_id=row.get("calibration_id"),
        capture=row["url"],
        capture_sha256=row["capture_sha256"],
    )


def ended(row: Mapping[str, Any]) -> str | None:
    """When the analysis ended, for a capture that does not state its time."""
    time = row.get("ended")
    return time.isoformat(timespec="milliseconds") if isinstance(time, datetime) else None


def axis_results(row: Mapping[str, Any]) -> tuple[AxisResult, ...]:
    """The results of a row: of its only axis, or of each axis that measures a rate."""
    axes = row["axes"] or []
    if not axes:
        return (AxisResult("rate", numbers(row)),)
    shared = {name: row.get(name) for name in ("temp_min_c", "temp_max_c")}
    rates = [axis for axis in axes if axis.get("unit") in (None, "°/s")]
    if not rates:
        raise LineError("none of its axes measures a rate")
    return tuple(AxisResult(axis["name"], numbers({**shared, **axis})) for axis in rates)


def numbers(row: Mapping[str, Any]) -> dict[str, float | None]:
    """The numbers of an axis, with the standard uncertainties of its noise from their intervals."""
    found = {name: row.get(name) for name in NUMBERS}
    for name in NOISE:
        low, high = row.get(f"{name}_lo"), row.get(f"{name}_hi")
        if low is not None and high is not None:
            found[f"u_{name}"] = (high - low) / INTERVALS_PER_U
    if all(value is None for value in found.values()):
        raise LineError("it is ok, but has no number")
    return found
