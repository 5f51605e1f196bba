"""The record in SQLite and in PostgreSQL."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import sqlalchemy as sa
from line_helpers import LIMITS, calibrate, measurement

from zerorate.line import AxisResult, LineError, Record, open_record


def test_a_measurement_is_entered_once(record: Record) -> None:
    one = measurement("SN1")
    added = record.add(one, LIMITS)
    assert added is not None
    assert (added.verdict, added.superseded) == ("pass", [])
    assert record.add(one, LIMITS) is None
    assert len(record.history("SN1")) == 1


def test_a_repeat_supersedes(record: Record) -> None:
    first = record.add(measurement("SN1", 0.5))
    second = record.add(measurement("SN1", 0.6))
    assert first is not None and second is not None
    assert second.superseded == first.results
    assert [one.current for one in record.history("SN1")] == [False, True]
    assert [one.numbers["pbc_dps"] for one in record.results() if one.current] == [0.6]


def test_a_late_measurement_supersedes_nothing(record: Record) -> None:
    record.add(measurement("SN1", 0.5, measured="2026-03-02T12:00:00.000+00:00"))
    late = record.add(measurement("SN1", 0.6, measured="2026-03-01T12:00:00.000+00:00"))
    assert late is not None and late.superseded == []
    assert [(one.numbers["pbc_dps"], one.current) for one in record.history("SN1")] == [(0.6, False), (0.5, True)]


def test_simulated_and_measured_do_not_supersede_each_other(record: Record) -> None:
    record.add(measurement("SN1", 0.5))
    added = record.add(measurement("SN1", 0.6, simulated=True), LIMITS)
    assert added is not None and added.superseded == []
    found = record.history("SN1")
    assert [(one.simulated, one.current) for one in found] == [(False, True), (True, True)]
    assert [verdict.simulated for verdict in found[1].verdicts] == [True, True]


def test_verdicts_keep_limits_and_version(record: Record) -> None:
    record.add(measurement("SN1", 0.99), LIMITS)
    (found,) = record.history("SN1")
    assert found.verdict == "conditionalPass"
    pbc, btc = found.verdicts
    assert (pbc.lower, pbc.upper, pbc.rule, pbc.limits_version) == (-1.0, 1.0, "guarded", "test-1")
    assert (pbc.value, pbc.u, pbc.verdict, btc.verdict) == (0.99, 0.01, "conditionalPass", "pass")


def test_a_refusal_is_a_run_without_a_result(record: Record) -> None:
    one = replace(measurement("SN1"), state="refused", results=(), code="small-span", error="hardly changed")
    added = record.add(one, LIMITS)
    assert added is not None and added.results == [] and added.verdict is None
    (found,) = record.history("SN1")
    assert (found.state, found.result, found.fields["code"]) == ("refused", None, "small-span")


def test_each_axis_has_a_result(record: Record) -> None:
    axes = tuple(AxisResult(name, {"pbc_dps": value}) for name, value in (("x", 0.1), ("y", 9.0)))
    added = record.add(replace(measurement("SN1"), results=axes), LIMITS)
    assert added is not None and len(added.results) == 2
    # u is not known, so neither axis can pass; the guarded limit decides nothing
    assert added.verdict == "undecided"
    assert [one.axis for one in record.history("SN1")] == ["x", "y"]


def test_the_parts_of_a_serial_number_are_apart(record: Record) -> None:
    record.add(measurement("SN1", 0.5))
    record.add(replace(measurement("SN1", 0.6), part="OTHER"))
    assert len(record.history("SN1")) == 2
    assert [one.numbers["pbc_dps"] for one in record.history("SN1", "OTHER")] == [0.6]


@pytest.mark.parametrize("serial", ["", "  ", "SN1\n", "SN\x1b[2J", "SN\u202e1", "x" * 81, " SN1"])
def test_a_wrong_serial_number_is_refused(serial: str) -> None:
    with pytest.raises(LineError, match="serial number"):
        measurement(serial, samples="a")


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_number_that_is_not_finite_is_refused(value: float) -> None:
    with pytest.raises(LineError, match="not a finite number"):
        measurement("SN1", value)


def test_numbers_and_texts_come_back_as_they_were(record: Record) -> None:
    """SQLite has no −0, PostgreSQL no NUL; both keep the digits of a double."""
    numbers = {"pbc_dps": -0.0, "t3_c": 0.1 + 0.2, "n": 5e-324, "k": 1.7976931348623157e308, "b": 3.0}
    results = (AxisResult("rate", numbers),)
    one = replace(measurement("SN1"), results=results, program="µ°\0\ud800", warnings=("a\0", "°"))
    record.add(one)
    (found,) = record.history("SN1")
    assert found.numbers == {**numbers, "pbc_dps": 0.0}
    assert found.fields["warnings"] == ["a\0", "°"]
    assert record.verify().findings == []


@pytest.mark.parametrize("statement", ["UPDATE {} SET id = id", "DELETE FROM {}"])
def test_rows_can_be_neither_changed_nor_removed(record: Record, statement: str) -> None:
    added = record.add(measurement("SN1"), LIMITS)
    assert added is not None
    record.add_certificate("C-1", added.results[0])
    for table in ("unit", "run", "result", "verdict", "certificate", "entry"):
        with pytest.raises(sa.exc.DBAPIError, match=f"{table}: append only"):
            with record._store.engine.begin() as connection:
                connection.exec_driver_sql(statement.format(table))
    assert record.verify().findings == []


def test_a_row_cannot_be_replaced_in_sqlite(tmp_path: Path) -> None:
    with open_record(f"sqlite:///{tmp_path / 'line.db'}") as record:
        record.add(measurement("SN1"))
        with pytest.raises(sa.exc.DBAPIError, match="append only"), record._store.engine.begin() as connection:
            connection.exec_driver_sql("INSERT OR REPLACE INTO unit (id, part, serial) VALUES (1, 'ADIS16130', 'SN2')")


def test_tables_cannot_be_emptied_in_postgresql(url: str, record: Record) -> None:
    if url.startswith("sqlite"):
        pytest.skip("SQLite has no TRUNCATE")
    with pytest.raises(sa.exc.DBAPIError, match="append only"), record._store.engine.begin() as connection:
        connection.exec_driver_sql("TRUNCATE unit CASCADE")


def test_certificates_replace_each_other_with_a_reason(record: Record) -> None:
    added = record.add(measurement("SN1"))
    assert added is not None
    (result,) = added.results
    record.add_certificate("C-1", result, dcc_sha256="d" * 64)
    with pytest.raises(LineError, match="has a certificate C-1 already"):
        record.add_certificate("C-1", result)
    with pytest.raises(LineError, match="needs a reason"):
        record.add_certificate("C-2", result, replaces="C-1")
    with pytest.raises(LineError, match="no certificate C-9"):
        record.add_certificate("C-2", result, replaces="C-9", reason="typo")
    with pytest.raises(LineError, match="no result 99"):
        record.add_certificate("C-2", 99)
    record.add_certificate("C-2", result, replaces="C-1", reason="typo")
    assert record.history("SN1")[0].certificates == ["C-1", "C-2"]
    assert record.verify().findings == []


def test_a_calibration_file(record: Record, calibration: tuple[Path, Path]) -> None:
    toml, capture = calibration
    added = record.add_calibration(toml, capture=capture, limits=LIMITS)
    assert added is not None
    (found,) = record.history("SN7")
    assert found.simulated
    assert found.calibration_id and found.calibration_id in run_id(toml)
    assert f"pbc_dps = {found.numbers['pbc_dps']!r}" in toml.read_text()
    assert [one.state for one in record.verify_files()] == ["same", "same"]
    assert record.add_calibration(toml, limits=LIMITS) is None


def run_id(toml: Path) -> str:
    """The identifier of a calibration, from the package's own reader."""
    import zerorate

    return zerorate.Calibration.load(toml).id


def test_a_capture_of_other_samples_is_refused(record: Record, calibration: tuple[Path, Path], tmp_path: Path) -> None:
    _, other = calibrate(tmp_path, 8, "SN8")
    with pytest.raises(LineError, match="holds other samples"):
        record.add_calibration(calibration[0], capture=other)
    damaged = tmp_path / "damaged.arrows"
    content = bytearray(calibration[1].read_bytes())
    content[len(content) // 2] ^= 1
    damaged.write_bytes(content)
    with pytest.raises(LineError, match="check differs"):
        record.add_calibration(calibration[0], capture=damaged)
    assert record.results() == []


def test_an_edited_calibration_is_refused(record: Record, calibration: tuple[Path, Path], tmp_path: Path) -> None:
    edited = tmp_path / "edited.toml"
    edited.write_text(calibration[0].read_text().replace('serial = "SN7"', 'serial = "SN8"'))
    with pytest.raises(LineError, match="edited.toml"):
        record.add_calibration(edited)


def test_a_calibration_without_serial_or_checks_is_refused(record: Record, tmp_path: Path) -> None:
    toml, _ = calibrate(tmp_path, 9, None)
    with pytest.raises(LineError, match="no serial number"):
        record.add_calibration(toml)
    by_hand = tmp_path / "hand.toml"
    correction = "[correction]\npbc_dps = 0.0\nbtc_dps_per_c = 0.0\nt3_c = 30.0\n"
    by_hand.write_text(f'schema = 1\npart = "ADIS16130"\nserial = "SN1"\n{correction}')
    with pytest.raises(LineError, match="measured calibrations only"):
        record.add_calibration(by_hand)


def test_changed_and_missing_files_show(record: Record, tmp_path: Path) -> None:
    toml, capture = calibrate(tmp_path, 9, "SN9")
    record.add_calibration(toml, capture=capture)
    toml.write_text(toml.read_text() + "\n")
    capture.unlink()
    assert [one.state for one in record.verify_files()] == ["missing", "differs"]
