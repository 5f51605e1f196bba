"""What the tests of a line share: limits, measurements, calibrations of the twin, and the command line."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from zerorate.line import AxisResult, Limit, Limits, Measurement
from zerorate.line._cli import main

LIMITS_TOML = """\
version = "test-1"
[pbc_dps]
lower = -1.0
upper = 1.0
rule = "guarded"
[btc_dps_per_c]
upper = 0.1
rule = "simple"
"""

LIMITS = Limits("test-1", {"pbc_dps": Limit(-1.0, 1.0, "guarded"), "btc_dps_per_c": Limit(None, 0.1, "simple")})

# A calibration of the twin that takes a second.
SHORT = ["--average", "5s", "--warmup", "60s", "--settle", "60s", "--offset", "10s"]


def measurement(
    serial: str, pbc_dps: float = 0.5, *, samples: str = "", simulated: bool = False, measured: str | None = None
) -> Measurement:
    """A measurement whose samples have a hash of their own."""
    numbers = {"pbc_dps": pbc_dps, "u_pbc_dps": 0.01, "btc_dps_per_c": -0.04, "u_btc_dps_per_c": 0.002, "t3_c": 31.5}
    return Measurement(
        serial=serial,
        part="ADIS16130",
        recipe="test",
        simulated=simulated,
        results=(AxisResult("rate", numbers),),
        measured=measured,
        capture_sha256=(samples or f"{serial} {pbc_dps}").ljust(64, "0")[:64],
    )


@dataclass(frozen=True)
class Answer:
    """How a command ended, and what it said."""

    returncode: int
    stdout: str
    stderr: str


def run(
    *arguments: str | os.PathLike[str], cwd: Path, text: str = "", env: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Runs ``zerorate`` to its end. A traceback is never an answer."""
    done = subprocess.run(
        [sys.executable, "-m", "zerorate", *(os.fspath(one) for one in arguments)],
        cwd=cwd,
        input=text,
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        env={**os.environ, **(env or {})},
    )
    assert "Traceback" not in done.stderr, done.stderr
    return done


def line(*arguments: str | os.PathLike[str], cwd: Path, env: dict[str, str] | None = None) -> Answer:
    """Runs ``zerorate line`` in this process, which saves the start of another one."""
    out, error, before = io.StringIO(), io.StringIO(), os.getcwd()
    os.chdir(cwd)
    try:
        with redirect_stdout(out), redirect_stderr(error), patch.dict(os.environ, env or {}):
            code = main([os.fspath(one) for one in arguments])
    finally:
        os.chdir(before)
    return Answer(code, out.getvalue(), error.getvalue())


def calibrate(folder: Path, seed: int, serial: str | None) -> tuple[Path, Path]:
    """A calibration of the twin with its capture."""
    toml, capture = folder / f"{seed}.toml", folder / f"{seed}.arrows"
    named = ["--serial", serial] if serial else []
    device = f"twin:seed={seed}"
    done = run("calibrate", "--device", device, *SHORT, *named, "--log", capture, "-o", toml, cwd=folder)
    assert done.returncode == 0, done.stderr
    return toml, capture
