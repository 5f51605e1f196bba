"""Importing the table of a fleet."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from line_helpers import LIMITS, line

from zerorate.fleet._row import SCHEMA
from zerorate.line import LineError, Record

EMPTY: dict[str, Any] = dict.fromkeys(
    ["pbc_dps", "u_pbc_dps", "btc_dps_per_c", "u_btc_dps_per_c", "t3_c", "n", "n_lo", "n_hi"]
)


def row(serial: str | None, number: int, **values: Any) -> dict[str, Any]:
    """A row of a fleet."""
    known = {"serial": serial, "part": "ADIS16130", "state": "ok", "code": "", "error": "", "method": "an1042"}
    known.update(url=f"s3://line/{number}.arrows", version="1", recipe="r" * 12, program="zerorate 0.1.0")
    known.update(capture_sha256=f"{number:064x}", calibration_id=f"{number:012x}")
    known.update(created=f"2026-03-01T12:{number:02}:00Z")
    numbers = {"pbc_dps": 0.5, "u_pbc_dps": 0.01, "btc_dps_per_c": -0.04, "u_btc_dps_per_c": 0.002, "t3_c": 31.5}
    noise = {"n": 0.0088, "n_lo": 0.0086, "n_hi": 0.0090}
    ended = {"ended": datetime(2026, 3, 2, tzinfo=timezone.utc), "simulated": False, "warnings": ["earth-included: …"]}
    return {**known, **numbers, **noise, **ended, **values}


def write(folder: Path, rows: list[dict[str, Any]]) -> Path:
    """The folder of a fleet."""
    folder.mkdir(exist_ok=True)
    pq.write_table(pa.Table.from_pylist(rows, schema=SCHEMA), folder / "rows.parquet")
    return folder


def test_rows_are_entered_once(record: Record, tmp_path: Path) -> None:
    folder = write(tmp_path / "fleet", [row(f"SN{number}", number) for number in range(5)])
    first, again = record.import_rows(folder, LIMITS), record.import_rows(folder / "rows.parquet", LIMITS)
    assert (first.added, first.known, again.added, again.known) == (5, 0, 0, 5)
    found = record.history("SN3")[0]
    assert (found.verdict, found.fields["capture"]) == ("pass", "s3://line/3.arrows")
    assert found.calibration_id == f"{3:012x}"
    assert found.fields["measured"] == "2026-03-01T12:03:00.000+00:00"
    assert found.numbers["u_n"] == pytest.approx(0.0004 / 3.92, rel=1e-4)
    assert record.verify().findings == []


def test_the_same_capture_elsewhere_is_the_same_measurement(record: Record, tmp_path: Path) -> None:
    record.import_rows(write(tmp_path / "fleet", [row("SN1", 1)]))
    moved = record.import_rows(write(tmp_path / "moved", [row("SN1", 1, url="s3://archive/1.arrows")]))
    assert (moved.added, moved.known) == (0, 1)


def test_rows_are_entered_in_the_order_of_measurement(record: Record, tmp_path: Path) -> None:
    record.import_rows(write(tmp_path / "fleet", [row("SN1", 9, pbc_dps=0.9), row("SN1", 2, pbc_dps=0.2)]))
    first, second = record.history("SN1")
    assert (first.numbers["pbc_dps"], second.numbers["pbc_dps"]) == (0.2, 0.9)
    assert (second.supersedes, second.current) == (first.result, True)


def test_rows_that_cannot_be_entered_are_named(tmp_path: Path) -> None:
    rows = [row("SN1", 1), row(None, 2), row("", 3), row("SN\n4", 4), row("SN5", 5, part=None)]
    rows += [row("SN6", 6, pbc_dps=float("nan")), row("SN7", 7, created="yesterday")]
    rows += [row("SN8", 8, **EMPTY)]
    write(tmp_path, rows)
    done = line("import", ".", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stdout == "1 entered, 0 in the record already, 2 without a serial number, 5 not usable\n"
    assert all(f"s3://line/{number}.arrows" in done.stderr for number in range(2, 9))
    assert done.stderr.count("\n") == 7


def test_refused_failed_and_killed_rows_are_runs(record: Record, tmp_path: Path) -> None:
    states = ["refused", "failed", "killed"]
    rows = [row("SN1", n, state=state, code=f"code-{n}", error="why") for n, state in enumerate(states)]
    assert record.import_rows(write(tmp_path / "fleet", rows), LIMITS).added == 3
    found = record.history("SN1")
    assert [(one.state, one.result, one.fields["code"]) for one in found] == [
        ("refused", None, "code-0"),
        ("failed", None, "code-1"),
        ("killed", None, "code-2"),
    ]


def test_simulated_rows_are_marked(record: Record, tmp_path: Path) -> None:
    rows = [row("SN1", 1, simulated=True, created=None), row("SN2", 2, created="SIMULATED")]
    record.import_rows(write(tmp_path / "fleet", rows), LIMITS)
    assert [one.simulated for one in record.results()] == [True, True]


def test_axes_that_measure_a_rate_are_entered(record: Record, tmp_path: Path) -> None:
    axes = [{"name": name, "unit": unit, "n": 0.01} for name, unit in (("gx", "°/s"), ("gy", "°/s"), ("ax", "m/s²"))]
    record.import_rows(write(tmp_path / "fleet", [row("SN1", 1, axes=axes, **EMPTY)]))
    assert [(one.axis, one.numbers) for one in record.results()] == [("gx", {"n": 0.01}), ("gy", {"n": 0.01})]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: None, "there is no"),
        (lambda path: path.write_text("rows"), "not a Parquet file"),
        (lambda path: path.write_bytes(b""), "not a Parquet file"),
        (lambda path: pq.write_table(pa.table({"serial": ["SN1"]}), path), "has no column url, part"),
    ],
)
def test_a_wrong_table_is_explained(make: Any, said: str, record: Record, tmp_path: Path) -> None:
    make(tmp_path / "rows.parquet")
    with pytest.raises(LineError, match=said):
        record.import_rows(tmp_path)
