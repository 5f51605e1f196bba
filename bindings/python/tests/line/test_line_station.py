"""A station with twins in its places."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from line_helpers import SHORT, run

from zerorate.line import Record, open_record

REFUSED = ["--average", "1s", "--warmup", "1s", "--settle", "1s", "--offset", "1s"]


def station(
    folder: Path, limits: Path, text: str, *options: str, devices: tuple[str, ...] = ("twin:seed=7",)
) -> subprocess.CompletedProcess[str]:
    """Runs a station on some devices, with the input ``text``."""
    named = [word for device in devices for word in ("--device", device)]
    return run("line", "station", *named, "--limits", limits, *options, cwd=folder, text=text)


def record_of(folder: Path) -> Record:
    return open_record(f"sqlite:///{folder / 'line.db'}", create=False)


def test_a_unit_is_tested_judged_recorded_and_labelled(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", "--station", "A", "--operator", "Ida", "--", *SHORT)
    assert done.returncode == 0, done.stdout + done.stderr
    with record_of(tmp_path) as record:
        (found,) = record.history("SN7")
        assert [one.state for one in record.verify_files()] == ["same", "same"]
        assert record.verify().findings == []
    assert (found.verdict, found.simulated) == ("pass", True)
    assert (found.fields["station"], found.fields["operator"]) == ("A", "Ida")
    assert "█████" in done.stdout and "twin:seed=7: SN7: pass (simulated)" in done.stdout
    label = done.stdout[done.stdout.index("\nserial ") :]
    pbc = f"{found.numbers['pbc_dps']:.6g} °/s"
    assert all(text in label for text in ("SN7", "ADIS16130", str(found.calibration_id), pbc, "pass (simulated)"))


def test_several_devices_at_once(tmp_path: Path, limits: Path) -> None:
    devices = ("twin:seed=7", "twin:seed=8,bias_dps=0.2")
    done = station(tmp_path, limits, "SN7\nSN8\n", "--once", "--", *SHORT, devices=devices)
    assert done.returncode == 0, done.stdout + done.stderr
    with record_of(tmp_path) as record:
        assert {one.serial: one.fields["device"] for one in record.results()} == dict(zip(("SN7", "SN8"), devices))


def test_wrong_serial_numbers_are_asked_for_again(tmp_path: Path, limits: Path) -> None:
    text = f"\n   \nSN\x07\n{'x' * 81}\nSN7\nSN7\nSN8\r\n"
    devices = ("twin:seed=7", "twin:seed=8,bias_dps=0.2")
    done = station(tmp_path, limits, text, "--once", "--", *SHORT, devices=devices)
    assert done.returncode == 0, done.stdout + done.stderr
    problems = ("is empty", "has control characters", "is longer than 80 characters")
    for said in (*problems, "SN7 is under test on twin:seed=7"):
        assert f"{said}: give it again" in done.stdout
    with record_of(tmp_path) as record:
        assert {one.serial for one in record.results()} == {"SN7", "SN8"}


def test_units_until_the_input_ends_and_repeats(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\nSN8\nSN7\n", "--", *SHORT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "the record has these samples already" in done.stdout  # a twin repeats its samples
    with record_of(tmp_path) as record:
        assert [one.serial for one in record.results()] == ["SN7", "SN8"]
    assert len(list((tmp_path / "captures").glob("*.toml"))) == 3


def test_a_unit_outside_its_limits_fails(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", "--", *SHORT, devices=("twin:seed=7,bias_dps=-2.5",))
    assert done.returncode == 1
    assert "SN7: fail (simulated)" in done.stdout
    with record_of(tmp_path) as record:
        assert record.history("SN7")[0].verdict == "fail"


def test_a_refusal_is_recorded(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", "--", *REFUSED)
    assert done.returncode == 3
    with record_of(tmp_path) as record:
        (found,) = record.history("SN7")
    assert (found.state, found.part, found.simulated) == ("refused", "ADIS16130", True)
    assert found.fields["code"] and f"refused (simulated): {found.fields['error']}" in done.stdout


def test_a_calibration_that_could_not_be_recorded_is_not_lost(tmp_path: Path, limits: Path) -> None:
    open_record(f"sqlite:///{tmp_path / 'line.db'}").close()
    other = sqlite3.connect(tmp_path / "line.db", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    url = "sqlite:///line.db?timeout=0.2"
    done = station(tmp_path, limits, "SN7\n", "--once", "--db", url, "--", *SHORT)
    other.close()
    assert done.returncode == 1 and "nothing was recorded: sqlite:///line.db: database is locked" in done.stdout
    later = done.stdout[done.stdout.index("Enter it later: zerorate ") :].split()[4:7]
    assert run(*later, cwd=tmp_path).returncode == 0
    with record_of(tmp_path) as record:
        assert [one.state for one in record.history("SN7")] == ["ok"]


def test_a_device_that_does_not_answer_is_a_failed_run(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", devices=("tcp:127.0.0.1:1",))
    assert done.returncode == 1
    with record_of(tmp_path) as record:
        (found,) = record.history("SN7")
    assert (found.state, found.verdict, found.simulated) == ("failed", None, False)
    assert found.fields["error"]


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["--", "--serial", "SN1"], 1, "the station gives --serial itself"),
        (["--", "-ox.toml"], 1, "the station gives -ox.toml itself"),
        (["--device", "twin:seed=7"], 1, "a device was given twice"),
        (["--folder", "limits.toml/x"], 1, "give another --folder"),
        (["--db", "line"], 1, "--db takes"),
    ],
)
def test_a_wrong_station_starts_nothing(
    options: list[str], code: int, said: str, tmp_path: Path, limits: Path
) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", *options)
    assert (done.returncode, said in done.stderr) == (code, True), done.stderr
    assert not (tmp_path / "captures").exists()


def test_a_wrong_option_of_calibrate_records_nothing(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "SN7\n", "--once", "--", "--averge", "5s")
    assert done.returncode == 1 and "unexpected argument '--averge'" in done.stdout
    with record_of(tmp_path) as record:
        assert record.results() == []


def test_no_serial_number_is_an_error_for_a_script(tmp_path: Path, limits: Path) -> None:
    assert station(tmp_path, limits, "", "--once").returncode == 1
    assert station(tmp_path, limits, "").returncode == 0


def test_a_scanner_that_sends_bytes_is_not_a_traceback(tmp_path: Path, limits: Path) -> None:
    command = [sys.executable, "-m", "zerorate", "line", "station", "--device", "twin:", "--limits", str(limits)]
    done = subprocess.run(command, cwd=tmp_path, input=b"\xff\xfe\x80\n", capture_output=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert b"has control characters: give it again" in done.stdout


def start(folder: Path, limits: Path) -> subprocess.Popen[str]:
    """A station whose calibration takes an hour, at work."""
    command = [sys.executable, "-m", "zerorate", "line", "station", "--device", "twin:seed=7", "--limits", str(limits)]
    pipe = subprocess.PIPE
    running = subprocess.Popen(
        [*command, "--", "--realtime"], cwd=folder, stdin=pipe, stdout=pipe, stderr=pipe, encoding="utf-8"
    )
    assert running.stdin is not None and running.stdout is not None
    running.stdin.write("SN7\n")
    running.stdin.flush()
    for line in running.stdout:
        if "calibrating" in line:
            break
    return running


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_station_that_ends_leaves_no_program_and_no_record(number: int, tmp_path: Path, limits: Path) -> None:
    running = start(tmp_path, limits)
    child = only_child(running.pid)
    time.sleep(1)
    running.send_signal(number)
    _, error = running.communicate(timeout=20)
    assert (running.returncode, error) == (130, "error: interrupted\n")
    with pytest.raises(ProcessLookupError):
        os.kill(child, 0)
    with record_of(tmp_path) as record:
        assert record.results() == []
    assert list((tmp_path / "captures").glob("*.toml")) == []


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_a_killed_station_leaves_the_unit_untested_and_the_record_whole(tmp_path: Path, limits: Path) -> None:
    running = start(tmp_path, limits)
    child = only_child(running.pid)
    running.kill()
    running.communicate(timeout=20)
    os.kill(child, signal.SIGKILL)
    with record_of(tmp_path) as record:
        assert record.results() == [] and record.verify().findings == []
    assert station(tmp_path, limits, "SN7\n", "--once", "--", *SHORT).returncode == 0


def test_a_serial_number_may_look_like_an_option(tmp_path: Path, limits: Path) -> None:
    done = station(tmp_path, limits, "-ü/7\n", "--once", "--", *SHORT)
    assert done.returncode == 0, done.stdout + done.stderr
    with record_of(tmp_path) as record:
        assert [one.state for one in record.history("-ü/7")] == ["ok"]


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_a_killed_calibration_is_a_killed_run(tmp_path: Path, limits: Path) -> None:
    running = start(tmp_path, limits)
    child = only_child(running.pid)
    os.kill(child, signal.SIGKILL)
    output, _ = running.communicate(timeout=20)
    assert running.returncode == 1 and "ended by signal 9" in output
    with record_of(tmp_path) as record:
        assert [one.state for one in record.history("SN7")] == ["killed"]


def only_child(pid: int) -> int:
    """The process that a process starts, once it is there."""
    until = time.monotonic() + 60
    while not (found := children(pid)):
        assert time.monotonic() < until, "the station starts no program"
        time.sleep(0.05)
    (child,) = found
    return child


def children(pid: int) -> list[int]:
    """The processes that a process started."""
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True)
    if found.returncode not in (0, 1):
        pytest.skip("there is no ps that knows --ppid")
    return [int(word) for word in found.stdout.split()]
