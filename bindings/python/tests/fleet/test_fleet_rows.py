"""The row of a file, and the table of all rows."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from fleet_helpers import PLAN, RECIPE, UNITS, Wrap, trapped

import zerorate
from zerorate import fleet
from zerorate.fleet import _cli, _store
from zerorate.fleet._program import version


PROGRAM = shutil.which("zerorate", path=sysconfig.get_path("scripts")) or "zerorate is not installed"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "zerorate", "fleet", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def rows_of(out: Path) -> dict[str, dict[str, Any]]:
    """The rows of a table by the names of their files."""
    fleet.table(str(out))
    return {os.path.basename(row["url"]): row for row in pq.read_table(out / "rows.parquet").to_pylist()}


def test_a_row_is_what_the_program_says_of_the_file(captures: Path, recorded: Path, tmp_path: Path) -> None:
    ended = fleet.run(str(captures), str(tmp_path / "out"), RECIPE)
    assert (ended.states, ended.undone) == ({"ok": UNITS}, {})
    for name, row in rows_of(tmp_path / "out").items():
        calibration = zerorate.Calibration.load(recorded / name.replace("arrows", "toml"))
        assert row["serial"] == calibration.serial and row["part"] == "ADIS16130" and row["simulated"]
        correction = calibration.axes[0].correction
        assert (row["pbc_dps"], row["btc_dps_per_c"]) == (correction.pbc_dps, correction.btc_dps_per_c)
        fit = zerorate.allan(captures / name, fit=True).fit
        assert fit is not None
        assert (row["n"], row["b"], row["k_hi"]) == (fit.n.value, fit.b.value, fit.k.hi)
        assert not any(warning.startswith("earth-included: ") for warning in row["warnings"])


def test_other_files_beside_captures_are_left_out(recorded: Path, tmp_path: Path) -> None:
    ended = fleet.run(str(recorded), str(tmp_path / "out"), RECIPE)
    assert (ended.states, ended.left_out) == ({"ok": UNITS}, UNITS)  # the calibration file of each capture is left out


def test_links_are_followed(captures: Path, tmp_path: Path) -> None:
    links = tmp_path / "links"
    links.mkdir()
    for path in captures.iterdir():
        (links / path.name).symlink_to(path)
    (links / "gone.arrows").symlink_to(tmp_path / "nowhere")
    ended = fleet.run(str(links), str(tmp_path / "out"), RECIPE)
    assert (ended.states, list(ended.undone)) == ({"ok": UNITS}, [str(links / "gone.arrows")])


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes")
def test_each_name_of_a_folder_has_a_row_or_a_line(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    (folder / "empty.csv").touch()
    os.mkfifo(folder / "fifo.csv")
    for name, target in (("zero.csv", "/dev/zero"), ("loop", "."), ("self.csv", "self.csv"), ("gone.csv", "nowhere")):
        (folder / name).symlink_to(target)
    done = run("run", str(folder), str(tmp_path / "out"))
    assert done.returncode == 1 and "1 failed" in done.stdout, done.stderr
    for name, why in (
        ("fifo.csv", "it is a pipe, and not a file"),
        ("zero.csv", "it is a device, and not a file"),
        ("loop", "it is a link to a folder, and not a file"),
        ("self.csv", ""),
        ("gone.csv", ""),
    ):
        assert f"{folder / name} has no row: {why}" in done.stderr, done.stderr
    assert rows_of(tmp_path / "out").keys() == {"empty.csv"}


def test_another_recipe_or_content_is_another_row(captures: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    fleet.run(str(captures), str(out), RECIPE)
    assert fleet.run(str(captures), str(out), fleet.Recipe(recalibrate=None)).states == {"ok": UNITS}
    shutil.copy(captures / "unit1.arrows", captures / "unit2.arrows")
    assert fleet.run(str(captures), str(out), RECIPE).states == {"ok": 1, "there": UNITS - 1}
    assert fleet.table(str(out)).rows == 2 * UNITS + 1


def test_bad_files_are_rows_with_their_reason(captures: Path, tmp_path: Path) -> None:
    whole = (captures / "unit1.arrows").read_bytes()
    (captures / "flipped.arrows").write_bytes(whole[:400_000] + bytes([whole[400_000] ^ 4]) + whole[400_001:])
    (captures / "torn.arrows").write_bytes(whole[: len(whole) // 2])
    (captures / "foreign.arrows").write_bytes(b"\x00" * 5000)
    (captures / "empty.arrows").write_bytes(b"")
    out = tmp_path / "out"
    ended = fleet.run(str(captures), str(out), RECIPE)
    assert ended.states == {"ok": UNITS, "failed": 4} and not ended.undone
    rows = rows_of(out)
    assert rows["flipped.arrows"]["code"] == "damaged" and "its check differs" in rows["flipped.arrows"]["error"]
    torn = rows["torn.arrows"]
    assert (torn["serial"], torn["code"]) == ("SN1", "torn-tail") and "recording ends" in torn["error"]
    assert "was not closed" in torn["error"]
    for name in ("foreign.arrows", "empty.arrows"):
        assert rows[name]["state"] == "failed" and rows[name]["error"]


def test_a_refusal_keeps_the_serial_number(tmp_path: Path) -> None:
    twin = ["--device", "twin:motion=sway,sway_dps=5", "--divider", "20", "--serial", "SHAKY"]
    log = ["--log", str(tmp_path / "shaky.arrows"), "--no-save"]
    subprocess.run(
        [sys.executable, "-m", "zerorate", "calibrate", *twin, *PLAN, *log], capture_output=True, timeout=60
    )
    row = fleet.one(str(tmp_path / "shaky.arrows"), str(tmp_path / "out"), RECIPE)
    assert (row["state"], row["serial"], row["pbc_dps"]) == ("refused", "SHAKY", None)
    assert row["code"] and row["error"]


def test_logs_and_their_axes(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    columns = np.column_stack([np.arange(20_000) / 100, random.normal(0, 0.1, (20_000, 3))])
    log = tmp_path / "log.csv"
    np.savetxt(log, columns, fmt="%.6f", delimiter=",", header="t_s,gx_dps,gy_dps,gz_dps", comments="")
    row = fleet.one(str(log), str(tmp_path / "out"), fleet.Recipe(allan=None, imu=()))
    assert row["state"] == "ok" and row["method"] is None
    assert [axis["name"] for axis in row["axes"]] == ["gx_dps", "gy_dps", "gz_dps"]
    for axis in row["axes"]:
        assert axis["n_lo"] < 0.1 / np.sqrt(100) * 1.02 and axis["n_hi"] > 0.1 / np.sqrt(100) * 0.98
    several = fleet.one(str(log), str(tmp_path / "out"))
    assert several["state"] == "failed" and "--column" in several["error"]


def test_a_log_without_a_noise_model_is_refused(tmp_path: Path) -> None:
    rate = np.random.default_rng(4).normal(0.3, 0.05, 4000)
    t_s = np.arange(4000) / 100
    huge = np.where(t_s == 20, 1e200, rate)
    logs = {"huge": (t_s, huge), "gap": (t_s + 3600 * (t_s > 18), rate), "short": (t_s[:40], rate[:40])}
    for name, columns in logs.items():
        log = tmp_path / f"{name}.csv"
        np.savetxt(log, np.column_stack(columns), fmt="%.9g", delimiter=",", header="t_s,gz_dps", comments="")
        row = fleet.one(str(log), str(tmp_path / "out"), fleet.Recipe(recalibrate=None, allan=("--column", "gz_dps")))
        assert (row["state"], row["code"]) == ("refused", "no-model"), row
        assert [row[key] for key in ("n", "n_lo", "n_hi", "b", "k")] == [None] * 5


def test_a_row_states_its_sensor_whatever_the_recipe(captures: Path, tmp_path: Path) -> None:
    one = str(captures / "unit3.arrows")
    rows = [fleet.one(one, str(tmp_path / "out"), recipe) for recipe in (RECIPE, fleet.Recipe(recalibrate=None))]
    for key in ("part", "serial", "created", "simulated", "capture_sha256", "n", "k_hi"):
        assert rows[0][key] == rows[1][key], key
    assert rows[1]["serial"] == "SN3" and rows[1]["part"] == "ADIS16130" and rows[1]["pbc_dps"] is None


def test_every_axis_of_a_capture_by_the_default_commands(tmp_path: Path) -> None:
    log = tmp_path / "three.arrows"
    twin = ["--device", "twin:seed=11,axes=3,warmup_s=20", "--divider", "20", "--serial", "IMU-7"]
    command = [sys.executable, "-m", "zerorate", "calibrate", *twin, *PLAN, "--log", str(log), "--no-save"]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    row = fleet.one(str(log), str(tmp_path / "out"), RECIPE)
    assert (row["state"], row["serial"], row["samples"] > 0) == ("ok", "IMU-7", True), row
    assert [axis["name"] for axis in row["axes"]] == ["x", "y", "z"]
    assert all(axis["pbc_dps"] and axis["u_pbc_dps"] and axis["n"] and axis["unit"] == "°/s" for axis in row["axes"])


def noise(samples: int = 2000) -> str:
    values = np.random.default_rng(4).normal(0.3, 0.05, samples)
    return "t_s,gz_dps\n" + "".join(f"{n / 100:.2f},{value:.6f}\n" for n, value in enumerate(values))


NAMES = [b"good.csv", b"esc\x1b]0;owned\x07\x1b[31mred.csv", b"nl\nnew.csv", b"-o.csv", b"--help", b"q?[x].csv"]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_not_text_fails_its_own_row(tmp_path: Path) -> None:
    folder, out, recipe = tmp_path / "captures", str(tmp_path / "out"), tmp_path / "recipe.toml"
    folder.mkdir()
    recipe.write_text('[allan]\noptions = ["--column", "gz_dps"]\n')
    for name in [*NAMES, b"M\xfcller.csv"]:
        Path(os.path.join(folder, os.fsdecode(name))).write_text(noise())
    (folder / "bad\x1b[31m.csv").write_text("hello\n")
    done = run("run", str(folder), out, "--recipe", str(recipe))
    assert done.returncode == 0 and f"2 failed, {len(NAMES)} ok" in done.stdout, done.stderr
    assert f"{len(NAMES) + 2} had a row before" in run("run", str(folder), out, "--recipe", str(recipe)).stdout
    table = run("table", out)
    assert table.returncode == 0 and "failed: file-name" in table.stdout, table.stderr
    assert "M\\xfcller.csv: its name is not UTF-8" in table.stdout and "bad\\u{1b}[31m.csv: " in table.stdout
    assert "\x1b" not in table.stdout
    rows = rows_of(tmp_path / "out")
    assert {name: row["state"] for name, row in rows.items() if name in map(os.fsdecode, NAMES)} == dict.fromkeys(
        map(os.fsdecode, NAMES), "ok"
    )
    one = run("one", os.path.join(folder, os.fsdecode(b"M\xfcller.csv")), out)
    assert one.returncode == 1 and json.loads(one.stdout)["code"] == "file-name", one.stderr
    gone = run("one", str(folder / "gone\x1b[2J.csv"), out)
    assert gone.returncode == 1 and "gone\\u{1b}[2J.csv: there is no such file" in gone.stderr, gone.stderr


def test_a_folder_is_a_folder_whatever_letters_its_name_has(tmp_path: Path) -> None:
    for name in ("d[1]", "d1"):
        (tmp_path / name / "below").mkdir(parents=True)
        (tmp_path / name / "below" / "log.csv").write_text(noise())
    found = [file.url for file in _store.find(str(tmp_path / "d[1]")).files]
    assert found == [str(tmp_path / "d[1]" / "below" / "log.csv")]
    assert [file.url for file in _store.find(found[0]).files] == found
    assert [file.url for file in _store.find(str(tmp_path / "d[0-9]" / "*" / "*.csv")).files] == [
        str(tmp_path / "d1" / "below" / "log.csv")
    ]


def test_a_program_that_dies_or_hangs(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    wrapped('case "$*" in *unit1*) kill -SEGV $$;; *unit2*) exec sleep 60;; esac')
    quick = fleet.Recipe(recalibrate=PLAN, timeout_s=5)
    ended = fleet.run(str(captures), str(tmp_path / "out"), quick)
    assert ended.states == {"ok": UNITS - 2, "killed": 1, "failed": 1}
    rows = rows_of(tmp_path / "out")
    assert rows["unit1.arrows"]["code"] == "SIGSEGV" and "said: nothing" in rows["unit1.arrows"]["error"]
    assert rows["unit2.arrows"]["code"] == "timeout"


def test_states_are_made_anew_where_asked(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    flag = tmp_path / "mended"
    wrapped(f'[ -e {flag} ] || case "$*" in *unit1*) kill -SEGV $$;; esac')
    out = str(tmp_path / "out")
    assert fleet.run(str(captures), out, RECIPE).states["killed"] == 1
    flag.touch()
    assert fleet.run(str(captures), out, RECIPE).states == {"there": UNITS}
    assert fleet.run(str(captures), out, RECIPE, again=["killed"]).states == {"ok": 1, "there": UNITS - 1}
    assert fleet.table(out).states == {"ok": UNITS}


def test_too_little_memory_leaves_no_row(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    said = "error: it takes more than the 256 MiB of max_memory: give more"
    wrapped(f'case "$*" in *unit1*) echo "{said}" >&2; exit 1;; esac')
    ended = fleet.run(str(captures), str(tmp_path / "out"), RECIPE)
    assert ended.states == {"ok": UNITS - 1} and "--max-memory" in ended.undone[str(captures / "unit1.arrows")]


def test_a_worker_of_another_version_makes_no_row(captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    flag = tmp_path / "asked"
    wrapped(f'case "$*" in *--version*) [ -e {flag} ] && echo "zerorate 9" && exit; touch {flag};; esac')

    def other_host() -> ThreadPoolExecutor:
        version.cache_clear()
        return ThreadPoolExecutor(1)

    ended = fleet.run(str(captures), str(tmp_path / "out"), RECIPE, other_host, workers=1)
    assert not ended.states and all(
        "has zerorate 9, and this run has zerorate" in why for why in ended.undone.values()
    )


def test_a_file_that_is_replaced_while_it_is_read(
    captures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fetch, out = _store.fetch, tmp_path / "out"

    def replaced(file: _store.File, folder: str) -> str:
        path = fetch(file, folder)
        if path.endswith("unit1.arrows") and Path(path).read_bytes() != (captures / "unit2.arrows").read_bytes():
            shutil.copy(captures / "unit2.arrows", path)
        return path

    monkeypatch.setattr(_store, "fetch", replaced)
    assert fleet.run(str(captures), str(out), RECIPE).states == {"ok": UNITS}
    assert rows_of(out)["unit1.arrows"]["serial"] == "SN2"
    assert fleet.run(str(captures), str(out), RECIPE).states == {"there": UNITS}


def test_one_file_that_changes_while_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fetch, log = _store.fetch, tmp_path / "log.csv"
    log.write_text(noise())

    def grown(file: _store.File, folder: str) -> str:
        log.write_text(noise(2001))
        return fetch(file, folder)

    monkeypatch.setattr(_store, "fetch", grown)
    assert _cli.main(["one", str(log), str(tmp_path / "out")]) == 1
    assert "log.csv has no row: it changed while it was read; start again" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_packed_rows_are_the_same_table(captures: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    fleet.run(str(captures), str(out), RECIPE)
    loose = rows_of(out)
    fleet.table(str(out), pack_from=1)
    assert not list(out.rglob("*.json")) and len(list(out.glob("parts/*.parquet"))) == 1
    assert rows_of(out) == loose
    assert fleet.run(str(captures), str(out), RECIPE).states == {"there": UNITS}
    assert fleet.run(str(captures), str(out), RECIPE, again=["ok"]).states == {"ok": UNITS}
    assert fleet.table(str(out)).rows == UNITS


def test_the_command_line(captures: Path, tmp_path: Path) -> None:
    out, recipe = str(tmp_path / "out"), tmp_path / "recipe.toml"
    recipe.write_text(f"[recalibrate]\noptions = {json.dumps(PLAN)}\n[allan]\n")
    done = run("run", str(captures), out, "--recipe", str(recipe))
    assert done.returncode == 0 and f"{UNITS} ok" in done.stdout, done.stderr
    table = run("table", out)
    assert table.returncode == 0 and f"{UNITS} rows" in table.stdout
    assert json.loads(run("table", out, "--json").stdout)["states"] == {"ok": UNITS}
    one = run("one", str(captures / "unit3.arrows"), out, "--recipe", str(recipe))
    assert one.returncode == 0 and json.loads(one.stdout)["serial"] == "SN3"


@pytest.mark.parametrize("engine", [[], pytest.param(["--dask", "local", "--workers", "1"], marks=pytest.mark.stores)])
def test_code_in_the_current_folder_does_not_run(engine: list[str], captures: Path, tmp_path: Path) -> None:
    if engine and sys.version_info < (3, 11):
        pytest.skip("this Python cannot leave out the current folder")
    folder = trapped(tmp_path / "foreign")
    command = [PROGRAM, "fleet", "run", str(captures / "unit1.arrows"), str(tmp_path / "out"), *engine]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert not (folder / "ran").exists(), (folder / "ran").read_text()


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["run", "nowhere", "out"], 1, "nowhere: there is no such file or folder"),
        (["run", "*.csv", "out"], 1, "no file fits *.csv"),
        (["run", "empty", "out"], 1, "empty holds no file"),
        (["run", ".", "out"], 1, ". holds no log; not logs by their names: 1"),
        (["run", "s4://bucket/x", "out"], 1, "s4"),
        (["one", "nowhere.arrows", "out"], 1, "there is no such file"),
        (["table", "nowhere"], 1, "has no rows; `zerorate fleet run SOURCE nowhere`"),
        (["run", ".", "out", "--recipe", "recipe.toml"], 1, "a recipe has no `alan`; it has recalibrate, allan, imu"),
        (["run", ".", "out", "--max-memory", "much"], 2, "give one such as 500M or 8G"),
        (["run", ".", "out", "--workers", "0"], 2, "above 0"),
        (["rnu"], 2, "invalid choice"),
    ],
)
def test_each_error_is_named(
    arguments: list[str], code: int, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "recipe.toml").write_text("[alan]\n")
    (tmp_path / "empty").mkdir()
    done = run(*arguments)
    assert (done.returncode, "Traceback" in done.stderr) == (code, False), done.stderr
    assert said in done.stderr


@pytest.mark.skipif(shutil.which("xargs") is None, reason="xargs starts the jobs")
def test_jobs_of_a_scheduler(captures: Path, tmp_path: Path) -> None:
    """A scheduler that starts two jobs for each file, and four jobs at once, gets one row for each file."""
    recipe = tmp_path / "recipe.toml"
    recipe.write_text(f"[recalibrate]\noptions = {json.dumps(PLAN)}\n[allan]\n")
    job = [sys.executable, "-m", "zerorate", "fleet", "one", "{}", str(tmp_path / "out"), "--recipe", str(recipe)]
    files = "".join(f"{path}\n" for path in [*captures.iterdir()] * 2)
    done = subprocess.run(
        ["xargs", "-P", "4", "-I", "{}", *job], input=files, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert fleet.table(str(tmp_path / "out")).states == {"ok": UNITS}
