"""The commands, as a person at a line types them."""

from __future__ import annotations

import json
import os
import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from line_helpers import LIMITS, LIMITS_TOML, line, measurement

from zerorate.line import capability, open_record

COMMANDS = ("import", "add", "history", "show", "spc", "verify", "station")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a record of twelve units, of which two are simulated, and limits."""
    (tmp_path / "limits.toml").write_text(LIMITS_TOML)
    with open_record(f"sqlite:///{tmp_path / 'line.db'}") as record:
        for number in range(12):
            simulated = number in (3, 4)
            measured = None if simulated else f"2026-03-{number + 1:02}T08:00:00.000+00:00"
            value = 0.5 + 0.01 * (number % 3)
            record.add(measurement(f"SN{number}", value, simulated=simulated, measured=measured), LIMITS)
    return tmp_path


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str, tmp_path: Path) -> None:
    done = line(command, "--help", cwd=tmp_path)
    assert done.returncode == 0
    assert f"  zerorate line {command} " in done.stdout and "--db URL" in done.stdout


@pytest.mark.parametrize("arguments", [[], ["shwo"], ["spc", "pbc"], ["add"], ["show", "--", "--average", "5s"]])
def test_usage_is_2(arguments: list[str], tmp_path: Path) -> None:
    assert line(*arguments, cwd=tmp_path).returncode == 2


@pytest.mark.parametrize("command", [["show"], ["history", "SN1"], ["spc", "pbc_dps"], ["verify"]])
def test_reading_makes_no_database(command: list[str], tmp_path: Path) -> None:
    done = line(*command, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("error: there is no record at line.db: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["add", "none.toml"], ["import", "none"], ["add", "x", "--limits", "none"]])
def test_a_wrong_file_makes_no_database(arguments: list[str], tmp_path: Path) -> None:
    done = line(*arguments, cwd=tmp_path)
    assert done.returncode == 1 and done.stderr.startswith("error: ") and "none" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_environment_names_the_record(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    known = {"ZERORATE_LINE_DB": f"sqlite:///{folder / 'line.db'}"}
    assert line("show", cwd=tmp_path / "elsewhere", env=known).stdout.count("\n") == 13


def test_a_calibration_is_added_and_shown(calibration: tuple[Path, Path], limits: Path, tmp_path: Path) -> None:
    toml, capture = calibration
    added = line("add", toml, "--capture", capture, "--limits", limits, cwd=tmp_path)
    assert (added.returncode, added.stderr) == (0, "")
    assert "SN7     ADIS16130  rate" in added.stdout and "pass (simulated)" in added.stdout
    assert "in the record already" in line("add", toml, cwd=tmp_path).stdout
    (shown,) = json.loads(line("show", "SN7", "--json", cwd=tmp_path).stdout)
    assert (shown["simulated"], shown["verdict"], shown["capture"]) == (True, "pass", str(capture))
    text = line("show", "SN7", cwd=tmp_path).stdout
    assert "pass (simulated): -1 to 1, guarded, limits test-1" in text
    assert f"{shown['numbers']['pbc_dps']:.6g}, u = " in text
    checked = line("verify", "--files", cwd=tmp_path)
    assert checked.returncode == 0 and "2 files: 2 same" in checked.stdout


def test_simulated_units_are_marked_in_every_listing(folder: Path) -> None:
    for command in (["show"], ["history", "SN3"], ["spc", "pbc_dps", "--simulated"]):
        lines = [text for text in line(*command, cwd=folder).stdout.splitlines() if "SN3," in text or "SN3 " in text]
        assert lines and all("simulated" in text for text in lines), command
    assert "pass (simulated)" in line("show", "SN3", cwd=folder).stdout.splitlines()[0]


def test_a_repeat_shows_in_the_history(folder: Path) -> None:
    with open_record(f"sqlite:///{folder / 'line.db'}") as record:
        record.add(measurement("SN1", 0.7, measured="2026-04-01T08:00:00.000+00:00"))
    lines = line("history", "SN1", cwd=folder).stdout.splitlines()
    assert lines[1].endswith("2, superseded by 13") and lines[2].endswith("13, current")
    assert line("show", cwd=folder).stdout.count("\n") == 13


def test_an_unknown_unit_is_said(folder: Path) -> None:
    for command in ("show", "history"):
        done = line(command, "SN99", cwd=folder)
        assert done.returncode == 1 and "does not know the unit SN99" in done.stderr


def test_a_chart_leaves_simulated_units_out(folder: Path) -> None:
    found = json.loads(line("spc", "pbc_dps", "--limits", "limits.toml", "--json", cwd=folder).stdout)
    values = [0.5 + 0.01 * (number % 3) for number in range(12) if number not in (3, 4)]
    assert [point["value"] for point in found["points"]] == values
    assert (found["simulated_left_out"], found["simulated"]) == (2, False)
    assert found["capability"]["cpk"] == capability(values, -1.0, 1.0).cpk
    both = json.loads(line("spc", "pbc_dps", "--simulated", "--json", cwd=folder).stdout)
    assert (len(both["points"]), both["simulated"], both["capability"]) == (12, True, None)


def test_a_chart_as_text_names_signals(folder: Path) -> None:
    with open_record(f"sqlite:///{folder / 'line.db'}") as record:
        record.add(measurement("SN99", 0.9, measured="2026-05-01T08:00:00.000+00:00"))
    done = line("spc", "pbc_dps", "--limits", "limits.toml", cwd=folder)
    assert "signal: SN99 (unit 11), rule 1: one value beyond 3 sigma" in done.stdout
    assert "2 simulated left out" in done.stdout and "with 95% confidence" in done.stdout


def test_charts_are_pictures(folder: Path) -> None:
    assert line("spc", "pbc_dps", "--limits", "limits.toml", "-o", "chart.svg", cwd=folder).returncode == 0
    assert ElementTree.parse(folder / "chart.svg").getroot().tag.endswith("svg")
    assert line("spc", "pbc_dps", "-o", "chart.png", cwd=folder).returncode == 0
    assert (folder / "chart.png").read_bytes().startswith(b"\x89PNG")
    again = line("spc", "pbc_dps", "-o", "chart.png", cwd=folder)
    assert again.returncode == 1 and "chart.png exists" in again.stderr
    assert line("spc", "pbc_dps", "-o", "chart.png", "--force", cwd=folder).returncode == 0
    wrong = line("spc", "pbc_dps", "-o", "chart.pdf", cwd=folder)
    assert wrong.returncode == 1 and ".svg or .png" in wrong.stderr
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_a_chart_needs_two_units_of_one_kind(folder: Path) -> None:
    few = line("spc", "n", cwd=folder)
    assert few.returncode == 1 and "needs two results with n, and the record has 0" in few.stderr
    with open_record(f"sqlite:///{folder / 'line.db'}") as record:
        record.add(replace(measurement("SN1"), part="OTHER"))
    mixed = line("spc", "pbc_dps", cwd=folder)
    assert mixed.returncode == 1 and "ADIS16130, OTHER: choose one by --part" in mixed.stderr
    assert line("spc", "pbc_dps", "--part", "ADIS16130", cwd=folder).returncode == 0


def test_verify_says_what_is_wrong(folder: Path) -> None:
    whole = line("verify", cwd=folder)
    head = whole.stdout.split()[-1]
    assert whole.returncode == 0 and "12 entries, 60 rows: whole" in whole.stdout
    assert line("verify", "--head", head, cwd=folder).returncode == 0
    other = line("verify", "--head", "0" * 64, cwd=folder)
    assert other.returncode == 1 and "no entry has the hash 000" in other.stdout
    with sqlite3.connect(folder / "line.db") as connection:
        connection.execute("DROP TRIGGER result_update")
        connection.execute("UPDATE result SET pbc_dps = 0.1 WHERE id = 5")
    changed = line("verify", cwd=folder)
    assert changed.returncode == 1 and "wrong: result 5 is not what entry 5 entered" in changed.stdout
    found = json.loads(line("verify", "--json", cwd=folder).stdout)
    assert (found["whole"], found["findings"][0]["where"]) == (False, "result 5")


def test_a_terminal_does_not_obey_the_record(tmp_path: Path) -> None:
    with open_record(f"sqlite:///{tmp_path / 'line.db'}") as record:
        one = replace(measurement("SN1"), state="failed", results=(), error="\x1b[2Jgone\nSN2  pass")
        record.add(one)
    for command in (["show"], ["history", "SN1"], ["show", "SN1"]):
        assert "\x1b" not in line(*command, cwd=tmp_path).stdout
    assert line("show", cwd=tmp_path).stdout.count("\n") == 2


def test_a_closed_pipe_is_not_a_traceback(folder: Path) -> None:
    command = [sys.executable, "-m", "zerorate", "line", "show"]
    reading = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert reading.stdout is not None and reading.stderr is not None
    reading.stdout.close()
    assert reading.stderr.read() == b""
    reading.stderr.close()
    reading.wait()


def test_importing_the_package_loads_no_large_library(tmp_path: Path) -> None:
    program = "import sys, zerorate.line; print([m for m in ('matplotlib', 'pyarrow', 'rich') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=os.environ)
    assert done.stdout == "[]\n"
