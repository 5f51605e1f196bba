"""Devices: the procedure, recordings and streams, on the twin. No test needs a real sensor."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import zerorate

SHORT: dict[str, Any] = {"average": 5, "warmup": 30, "settle": 10, "offset": 15, "max_u_btc": 1.0}


@pytest.fixture(scope="module")
def calibration() -> zerorate.Calibration:
    return zerorate.calibrate("twin:seed=7", serial="A7", **SHORT).calibration


def test_a_twin_is_a_device_by_its_word() -> None:
    shown: list[zerorate.Progress] = []
    by_word = zerorate.calibrate("twin:seed=7", divider=99, progress=shown.append, **SHORT)
    by_object = zerorate.calibrate(zerorate.Twin(seed=7), divider=99, **SHORT)
    assert by_word == by_object and by_word.simulated
    assert all(0 < one.done <= one.total == 66 and "step" in one.step for one in shown)
    with pytest.raises(ValueError, match="target_dph is for"):
        zerorate.calibrate("twin:seed=7", target_dph=50, **SHORT)


def test_a_recording_is_that_of_the_program(tmp_path: Path) -> None:
    mine, theirs = tmp_path / "mine.arrows", tmp_path / "theirs.arrows"
    found = zerorate.capture("twin:seed=3", mine, duration="2s", serial="A3", every_temp=10)
    command = [sys.executable, "-m", "zerorate", "capture", "-d", "twin:seed=3", "-o", str(theirs), "--json"]
    command += ["--duration=2s", "--serial=A3", "--every-temp=10"]
    report = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    assert vars(found) == {**report, "file": str(mine)}
    with pytest.raises(ValueError, match="not both"):
        zerorate.capture("twin:seed=3", tmp_path / "both.arrows", duration="2s", samples=10)
    one, other = zerorate.read_capture(mine), zerorate.read_capture(theirs)
    np.testing.assert_array_equal(one.rate_code, other.rate_code)
    assert one.metadata["zerorate.serial"] == "A3" and len(one) == found.samples
    with pytest.raises(FileExistsError, match="force=True"):
        zerorate.capture("twin:seed=3", mine)
    replayed = zerorate.capture(f"replay:{mine}", theirs, force=True)
    assert replayed.samples == found.samples
    with pytest.raises(FileExistsError, match="while it is read"):
        zerorate.capture(f"replay:{mine}", mine, force=True)


def test_a_stream_gives_the_rows_of_the_program(calibration: zerorate.Calibration, tmp_path: Path) -> None:
    calibration.save(tmp_path / "unit.toml")
    command = [sys.executable, "-m", "zerorate", "stream", "-d", "twin:seed=7", "--cal", str(tmp_path / "unit.toml")]
    command += ["--serial=A7", "--rate=20", "--duration=1s", "--format=jsonl"]
    printed = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    with zerorate.stream("twin:seed=7", tmp_path / "unit.toml", rate_hz=20, duration=1, serial="A7") as rows:
        assert rows.axes == ["rate"] and "twin:seed=7" in repr(rows)
        found = [(row.t_s, row.rate_dps, row.temp_c, row.lost, row.flags) for row in rows]
    assert found == [
        (row["t_s"], row["rate_dps"], row["temp_c"], row["lost"], row["flags"])
        for row in map(json.loads, printed.splitlines())
    ]
    assert len(found) == 20 and next(rows, None) is None


@pytest.mark.filterwarnings("ignore:unknown-serial")
def test_a_stream_ends_when_it_is_closed(calibration: zerorate.Calibration) -> None:
    with zerorate.stream("twin:seed=7", calibration) as rows:
        assert next(rows).t_s >= 0
    assert list(rows) == []
    waiting = zerorate.stream("twin:seed=7", calibration, rate_hz=0.01, realtime=True)
    threading.Timer(0.3, waiting.close).start()
    assert list(waiting) == []


def interrupted(work: Callable[[], object]) -> None:
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        work()


@pytest.mark.filterwarnings("ignore:unknown-serial")
def test_ctrl_c_ends_a_wait_at_once(calibration: zerorate.Calibration, tmp_path: Path) -> None:
    # all take longer than the 0.5 s until Ctrl-C; the divider gives a reading every 0.9 s (F-56)
    interrupted(lambda: zerorate.calibrate("twin:", settle="24h"))
    interrupted(lambda: zerorate.calibrate("twin:", realtime=True))
    interrupted(lambda: zerorate.calibrate("twin:", realtime=True, divider=9999))
    interrupted(lambda: zerorate.capture("twin:", tmp_path / "whole.arrows", realtime=True))
    assert len(zerorate.read_capture(tmp_path / "whole.arrows")) > 100
    with zerorate.stream("twin:", calibration, rate_hz=0.01, realtime=True) as rows:
        interrupted(lambda: next(rows))


def test_an_exception_of_the_progress_ends_the_work(tmp_path: Path) -> None:
    def fail(_: zerorate.Progress) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        zerorate.capture("twin:", tmp_path / "whole.arrows", realtime=True, progress=fail)
    assert len(zerorate.read_capture(tmp_path / "whole.arrows")) > 100


@pytest.mark.filterwarnings("ignore:unknown-serial", "ignore:not-believed")
def test_each_error_has_its_family(calibration: zerorate.Calibration, tmp_path: Path) -> None:
    file = tmp_path / "one.arrows"
    wrong: list[tuple[type[Exception], str, Callable[[], object]]] = [
        (zerorate.ZerorateError, "plug the bridge in", lambda: zerorate.calibrate("bridge:/dev/ttyACM99")),
        (zerorate.ZerorateError, "no such SPI device", lambda: zerorate.capture("spi:/dev/spidev9.9?rdy=g:1", file)),
        (zerorate.ZerorateError, "nothing answers", lambda: zerorate.stream("tcp:127.0.0.1:1", calibration)),
        (ValueError, "the device 'foo': no such kind", lambda: zerorate.calibrate("foo")),
        (ValueError, "part=adxrs29: .* did you mean adxrs290", lambda: zerorate.calibrate("twin:", part="adxrs29")),
        (ValueError, "samples=0", lambda: zerorate.capture("twin:", file, samples=0)),
        (ValueError, "rate_hz=0: give", lambda: zerorate.stream("twin:", calibration, rate_hz=0)),
        (ValueError, "every part has its own bias", lambda: zerorate.stream("twin:", calibration, serial="B")),
        (TypeError, "or a Twin, not 7", lambda: zerorate.calibrate(7)),  # type: ignore[arg-type]
        (FileNotFoundError, "make it, or", lambda: zerorate.capture("twin:", tmp_path / "no" / "x.arrows", samples=9)),
        (IsADirectoryError, "it is a folder", lambda: zerorate.capture("twin:", tmp_path, samples=9)),
        (FileNotFoundError, "none.arrows", lambda: zerorate.calibrate(f"replay:{tmp_path}/none.arrows")),
    ]
    for family, match, work in wrong:
        with pytest.raises(family, match=match):
            work()
    assert not file.exists()
    for read in (zerorate.read_capture, zerorate.read_log, zerorate.allan, zerorate.imu, zerorate.tempcal):
        with pytest.raises(IsADirectoryError, match="name the file"):
            read(tmp_path)
    frozen = "twin:fault=frozen,fault_at_s=1"
    with pytest.raises(zerorate.Refused, match=r"one\.arrows holds the raw codes"):
        zerorate.capture(frozen, file, duration=3)
    with pytest.raises(zerorate.Refused, match="have not changed"), zerorate.stream(frozen, calibration) as rows:
        list(rows)
    assert issubclass(zerorate.Refused, zerorate.ZerorateError)
    with pytest.raises(zerorate.ZerorateError, match="check the RDY wire"):
        zerorate.capture("twin:fault=rdy_lost,fault_at_s=1", file, duration=3, force=True)


def test_a_warning_belongs_to_the_line_of_the_user(calibration: zerorate.Calibration) -> None:
    with pytest.warns(UserWarning, match="give serial=") as warned:
        zerorate.stream("twin:seed=7", calibration).close()
    assert warned[0].filename == __file__
