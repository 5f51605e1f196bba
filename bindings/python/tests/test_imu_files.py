"""The six files of `zerorate imu`, each read with the parser of its filter.

Kalibr reads with PyYAML. OpenVINS, VINS and ORB-SLAM3 read with OpenCV's `FileStorage`, which needs `%YAML 1.0`.
KF-GINS reads with yaml-cpp, which ruamel.yaml replaces here (both are YAML 1.2). The keys of the numbers are typed
again from docs/imu.md.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any, Callable

import cv2
import numpy as np
import pytest
import yaml
from ruamel.yaml import YAML

PROGRAM = shutil.which("zerorate", path=sysconfig.get_path("scripts")) or "zerorate is not installed"
RATE_HZ = 125.0
FORMATS = ["kalibr", "openvins", "vins", "orbslam3", "kf-gins", "ros"]
# N by axis, °/s/√Hz and m/s²/√Hz (two-sided). The first gyroscope and the last accelerometer also have a random walk.
N_GYRO, N_ACCEL = (0.01, 0.02, 0.015), (1e-3, 3e-3, 2e-3)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("imu")
    random = np.random.default_rng(11)
    axes = random.normal(size=(15_000, 6)) * np.array(N_GYRO + N_ACCEL) * math.sqrt(RATE_HZ)
    axes[:, [0, 5]] += np.cumsum(random.normal(size=(15_000, 2)) * [2e-3, 2e-4], axis=0)
    axes[:, 5] += 9.81
    rows = np.column_stack([np.arange(15_000) / RATE_HZ, axes])
    header = "t_s,gx_dps,gy_dps,gz_dps,ax [m/s^2],ay [m/s^2],az [m/s^2]"
    np.savetxt(folder / "imu.csv", rows, delimiter=",", header=header, comments="", fmt="%.7f")
    for name in FORMATS:
        subprocess.run(
            [PROGRAM, "imu", "imu.csv", "--as-fitted", "--format", name, "-o", f"{name}.yaml"],
            cwd=folder,
            check=True,
            timeout=120,
        )
    return folder


@pytest.fixture(scope="module")
def axes(log: Path) -> list[tuple[float, float]]:
    """N and K of each axis in the units of the files, rad and m. For a K that is not identified, its upper limit."""
    done = subprocess.run(
        [PROGRAM, "imu", "imu.csv", "--json"], cwd=log, check=True, capture_output=True, text=True, timeout=120
    )
    found = []
    for axis in json.loads(done.stdout)["axes"]:
        fit = axis["fit"]
        si = math.pi / 180 if axis["kind"] == "gyroscope" else 1.0
        k = fit["k"]["value"] if fit["k"]["identified"] else fit["k"]["hi"]
        found.append((fit["n"]["value"] * si, k * si))
    assert len(found) == 6
    return found


KALIBR = ["gyroscope_noise_density", "accelerometer_noise_density"]
KALIBR += ["gyroscope_random_walk", "accelerometer_random_walk"]


def worst(axes: list[tuple[float, float]]) -> list[float]:
    """N of the worst gyroscope and accelerometer, then K of the worst ones."""
    return [max(axis[which] for axis in kind) for which in (0, 1) for kind in (axes[:3], axes[3:])]


def close(values: list[float]) -> Any:
    """Approximately `values`, because the numbers in the files are rounded."""
    return pytest.approx(values, rel=2e-6)


def of_pyyaml(path: Path) -> Any:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def of_yaml_12(path: Path) -> Any:
    return YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))


def opened(path: Path) -> Callable[[str], Any]:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    assert storage.isOpened(), path
    return storage.getNode


@pytest.mark.parametrize("name", FORMATS)
def test_every_parser_reads_the_same(log: Path, name: str) -> None:
    def numbers(tree: Any) -> list[float]:
        if isinstance(tree, dict):
            return [number for value in tree.values() for number in numbers(value)]
        if isinstance(tree, list):
            return [number for value in tree for number in numbers(value)]
        # a text that begins with a digit would be a number for some version of YAML
        assert isinstance(tree, (float, str)) and (isinstance(tree, float) or not tree[:1].isdigit()), tree
        return [tree] if isinstance(tree, float) else []

    ours = of_pyyaml(log / f"{name}.yaml")
    assert len(numbers(ours)) >= 4
    if not (log / f"{name}.yaml").read_text(encoding="utf-8").startswith("%YAML 1.0"):
        assert ours == of_yaml_12(log / f"{name}.yaml")


def test_kalibr(log: Path, axes: list[tuple[float, float]]) -> None:
    read = of_pyyaml(log / "kalibr.yaml")
    assert [read[key] for key in KALIBR] == close(worst(axes))
    assert worst(axes)[:2] == pytest.approx([math.radians(0.02), 3e-3], rel=0.03)
    assert read["update_rate"] == pytest.approx(RATE_HZ, rel=1e-6) and read["rostopic"] == "/imu0"


def test_openvins(log: Path, axes: list[tuple[float, float]]) -> None:
    root = opened(log / "openvins.yaml")
    node = root("imu0")
    assert [node.getNode(key).real() for key in KALIBR] == close(worst(axes))
    assert (node.getNode("model").string(), node.getNode("rostopic").string()) == ("kalibr", "/imu0")
    rotation = node.getNode("T_i_b")
    assert [rotation.at(row).at(row).real() for row in range(4)] == [1.0] * 4


def test_vins(log: Path, axes: list[tuple[float, float]]) -> None:
    node, keys = opened(log / "vins.yaml"), ("gyr_n", "acc_n", "gyr_w", "acc_w")
    assert [node(key).real() for key in keys] == close([value * math.sqrt(RATE_HZ) for value in worst(axes)])
    assert node("g_norm").real() == 9.80665


def test_orbslam3(log: Path, axes: list[tuple[float, float]]) -> None:
    node, keys = opened(log / "orbslam3.yaml"), ("IMU.NoiseGyro", "IMU.NoiseAcc", "IMU.GyroWalk", "IMU.AccWalk")
    assert [node(key).real() for key in keys] == close(worst(axes))
    # ORB-SLAM3 reads the rate with or without a decimal point
    assert node("IMU.Frequency").real() == pytest.approx(RATE_HZ, rel=1e-6)


def test_kf_gins(log: Path, axes: list[tuple[float, float]]) -> None:
    noise = of_yaml_12(log / "kf-gins.yaml")["imunoise"]
    # rad/√s to °/√h, m/s/√s to m/s/√h
    assert noise["arw"] == close([math.degrees(n) * 60 for n, _ in axes[:3]])
    assert noise["vrw"] == close([n * 60 for n, _ in axes[3:]])
    for key in ("gbstd", "abstd", "gsstd", "asstd"):
        assert len(noise[key]) == 3 and all(value > 0 for value in noise[key]), key
    assert 0 < noise["corrtime"] < 15_000 / RATE_HZ / 3600


def test_ros(log: Path, axes: list[tuple[float, float]]) -> None:
    read = of_pyyaml(log / "ros.yaml")
    for key, kind in [("angular_velocity_covariance", axes[:3]), ("linear_acceleration_covariance", axes[3:])]:
        matrix = np.array(read[key]).reshape(3, 3)
        np.testing.assert_allclose(np.diag(matrix), [n * n * RATE_HZ for n, _ in kind], rtol=4e-6)
        assert np.count_nonzero(matrix) == 3
    assert read["orientation_covariance"][0] == -1.0
