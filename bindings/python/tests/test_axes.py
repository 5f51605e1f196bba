"""Captures of parts with several axes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import zerorate

PART = """schema = 1
name = "ADIS16405"
axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16 }
temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12 }
"""

LOG = """t_ms,x,y,z,temp
0,20,-40,3,0
10,21,-41,4,
40,22,-42,32767,-7
50,23,-43,6,7
60,24,-44,7,8
"""


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> zerorate.Capture:
    folder: Path = tmp_path_factory.mktemp("imu")
    (folder / "part.toml").write_text(PART)
    (folder / "log.csv").write_text(LOG)
    device = ["--device", "replay:log.csv", "--part", "part.toml"]
    command = [sys.executable, "-m", "zerorate", "capture", *device, "-o", "imu.parquet"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=120)
    with pytest.warns(UserWarning, match="axis z"):
        return zerorate.read_capture(folder / "imu.parquet")


def test_each_axis_is_a_column(capture: zerorate.Capture) -> None:
    assert (capture.axes, capture.width_bits, len(capture)) == (("x", "y", "z"), 16, 5)
    np.testing.assert_array_equal(capture.rate_code[:, 0], [20, 21, 22, 23, 24])
    np.testing.assert_array_equal(capture.rate_dps[:, 1], [-2, -2.05, -2.1, -2.15, -2.2])
    np.testing.assert_array_equal(capture.lost, [0, 0, 2, 0, 0])
    np.testing.assert_array_equal(capture.status, [-1] * 5)
    assert capture.rate_hz == pytest.approx(100)


def test_readings_out_of_range_become_nan(capture: zerorate.Capture) -> None:
    assert capture.flags.shape == (5, 3) and capture.flags[2, 2] == 2
    np.testing.assert_array_equal(np.isnan(capture.rate_dps).nonzero(), ([2], [2]))


def test_all_have_one_temperature(capture: zerorate.Capture) -> None:
    expected = [25, np.nan, 25 - 7 / 7.14, 25 + 7 / 7.14, 25 + 8 / 7.14]
    np.testing.assert_allclose(capture.temp_c, expected, rtol=1e-15)
    np.testing.assert_allclose(capture.temp_held_c, [25, 25, *expected[2:]], rtol=1e-15)


def test_each_axis_is_analysed(capture: zerorate.Capture) -> None:
    found = zerorate.allan(capture, column="all")
    assert list(found) == ["x", "y", "z"]
    # a lost row is missing in all axes, a reading out of range only in its own
    assert [(axis.samples, axis.missing) for axis in found.values()] == [(7, 2), (7, 2), (7, 3)]
    # the valid codes of z are 3, 4, 6 and 7; a code is 1/20 °/s
    assert zerorate.allan(capture, column="z").dev[0] == pytest.approx(0.05 / 2**0.5)
    assert list(zerorate.imu(capture).gyroscope) == ["x", "y", "z"]
    with pytest.raises(ValueError, match="no column 'w'; choose with column= one of x, y, z"):
        zerorate.allan(capture, column="w")
