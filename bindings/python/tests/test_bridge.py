"""The firmware of the bridge in an emulator, with the twin as its part: `cargo xtask python bridge`."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import zerorate

pytestmark = pytest.mark.bridge
SHORT: dict[str, Any] = {"average": 1, "warmup": 10, "settle": 10, "offset": 5, "max_u_btc": 1.0, "serial": "A7"}
SEED = 7


@pytest.fixture(scope="module")
def emulator() -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """The address of the bridge on a pseudo-terminal, and the emulator."""
    command = ["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "pty"]
    command += ["-semihosting-config", f"enable=on,target=native,arg=bridge,arg={SEED}"]
    command += ["-kernel", os.environ["ZERORATE_BRIDGE"]]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE) as qemu:
        assert qemu.stdout is not None
        port = next(word for word in qemu.stdout.readline().decode().split() if word.startswith("/dev/"))
        yield f"bridge:{port}", qemu
        qemu.kill()


def test_a_bridge_is_calibrated_recorded_and_streamed(
    emulator: tuple[str, subprocess.Popen[bytes]], tmp_path: Path
) -> None:
    device, _ = emulator
    found = zerorate.calibrate(device, **SHORT)
    assert found.device == device and not found.simulated and found.truth is None
    twin = zerorate.calibrate(f"twin:seed={SEED}", **SHORT)
    assert abs(found.pbc_dps - twin.pbc_dps) < 5 * twin.u_pbc_dps
    recorded = zerorate.capture(device, tmp_path / "rest.arrows", samples=5000)
    assert (recorded.samples, recorded.lost_samples) == (5000, 0)
    with zerorate.stream(device, found.calibration, rate_hz=10, duration=1, serial="A7") as rows:
        assert [row.lost for row in rows] == [0] * 10


def test_a_bridge_that_falls_silent_is_an_error(emulator: tuple[str, subprocess.Popen[bytes]]) -> None:
    device, qemu = emulator
    calibration = zerorate.calibrate(device, **SHORT).calibration
    with zerorate.stream(device, calibration, serial="A7") as rows:
        next(rows)
        qemu.send_signal(signal.SIGSTOP)
        with pytest.raises(zerorate.ZerorateError, match="does not answer"):
            list(rows)
    qemu.send_signal(signal.SIGCONT)
    with zerorate.stream(device, calibration, serial="A7") as rows:
        next(rows)
        qemu.kill()
        with pytest.raises(zerorate.ZerorateError, match="is gone"):
            list(rows)
