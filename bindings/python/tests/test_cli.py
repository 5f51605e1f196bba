"""The command line tool that comes in the wheel."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sysconfig
import time
from pathlib import Path

import pytest

import zerorate

PROGRAM = shutil.which("zerorate", path=sysconfig.get_path("scripts")) or "zerorate is not installed"


def run(*args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *args], capture_output=True, text=True, timeout=120)


def test_the_version_is_that_of_the_package() -> None:
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"zerorate {zerorate.__version__}\n")


@pytest.mark.parametrize(
    ("code", "args"),
    [
        (0, ["twin"]),
        (1, ["correct", "none.arrows", "--cal=none.toml", "-o", "x"]),
        (2, ["calibrate", "--average=soon"]),
        (3, ["calibrate", "--device=twin:motion=sway,sway_dps=5", "--divider=99", "--average=10s", "--warmup=10s"]),
    ],
)
def test_exit_codes_pass_through(code: int, args: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = run(*args)
    assert done.returncode == code, done.stderr
    assert "Traceback" not in done.stderr


def test_a_closed_pipe_does_not_fail() -> None:
    reading = subprocess.Popen([PROGRAM, "twin"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert reading.stdout is not None and reading.stderr is not None
    reading.stdout.close()
    assert reading.stderr.read() == b""


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_ends_a_command() -> None:
    command = [PROGRAM, "calibrate", "--realtime"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    time.sleep(1.5)
    running.send_signal(signal.SIGINT)
    _, stderr = running.communicate(timeout=10)
    assert running.returncode == 1
    assert b"interrupted after" in stderr
