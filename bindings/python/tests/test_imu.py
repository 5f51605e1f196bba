"""Logs by their path, and `zerorate.imu`: every axis, and the files for the filters."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

import zerorate

RATE_HZ = 100.0
FIXTURES = Path(__file__).resolve().parents[3] / "crates" / "zerorate-logs" / "fixtures"
GYRO = ["gx [rad/s]", "gy [rad/s]", "gz [rad/s]"]
ACCEL = ["ax [m/s^2]", "ay [m/s^2]", "az [m/s^2]"]
N_GYRO, N_ACCEL = (1e-4, 2e-4, 3e-4), (1e-3, 2e-3, 1.5e-3)


def rest(n: int = 20_000) -> NDArray[np.float64]:
    """White noise of six axes with known N: the standard deviation of a sample is N √rate."""
    white: NDArray[np.float64] = np.random.default_rng(3).normal(size=(n, 6))
    return np.asarray(white * np.array(N_GYRO + N_ACCEL) * np.sqrt(RATE_HZ), dtype=np.float64)


def table(array: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return dict(zip(GYRO + ACCEL, array.T))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "six.csv"
    rows = np.column_stack([np.arange(20_000) / RATE_HZ, rest(), np.full(20_000, 25.0)])
    header = ",".join(["t_s", *GYRO, *ACCEL, "temp_c"])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    return path


@pytest.fixture(scope="module")
def found(log: Path) -> zerorate.Imu:
    return zerorate.imu(log)


def test_every_axis_is_found(found: zerorate.Imu, log: Path) -> None:
    assert list(found.axes) == GYRO + ACCEL and (found.rate_hz, found.topic) == (RATE_HZ, None)
    assert list(found.gyroscope) == GYRO and list(found.accelerometer) == ACCEL
    for name, axis, density in zip(GYRO + ACCEL, found.axes.values(), N_GYRO + N_ACCEL):
        assert axis.name == name and axis.unit == ("rad/s" if name in GYRO else "m/s²")
        assert axis.kind == ("gyroscope" if name in GYRO else "accelerometer")
        assert axis.fit is not None and axis.fit.n.value == pytest.approx(density, rel=0.03)
        np.testing.assert_array_equal(zerorate.allan(log, column=name, time_column="t_s").dev, axis.dev)
    assert not any("temp_c" in text for text in found.warnings) and str(log) in repr(found)


def test_an_axis_is_found_by_its_place(found: zerorate.Imu) -> None:
    places = [f"{kind}_{letter}" for kind in ("gyro", "accel") for letter in "xyz"]
    assert [found[place].name for place in places] == GYRO + ACCEL
    crossed = zerorate.imu(dict(zip(GYRO[::-1], rest().T)), rate_hz=RATE_HZ)
    assert (crossed[0].name, crossed["gyro_x"].name) == (GYRO[2], GYRO[0])
    bag = zerorate.imu(FIXTURES / "imu_lz4.bag")
    assert bag["gyro_y"].name == "/imu.angular_velocity.y"
    with pytest.raises(KeyError, match="no axis accel_x; there are"):
        bag["accel_x"]  # it has the accelerometer's z alone


def test_tables_in_memory_are_read_as_logs(found: zerorate.Imu) -> None:
    pandas, polars = (pytest.importorskip(name) for name in ("pandas", "polars"))
    named = table(rest())
    times = pandas.to_timedelta(np.arange(20_000) * 10, unit="ms")
    inputs: list[tuple[Any, dict[str, Any]]] = [
        (named, {"rate_hz": RATE_HZ}),
        (pandas.DataFrame(named, index=times), {}),
        (polars.DataFrame({"t_s": np.arange(20_000) / RATE_HZ, **named}), {}),
        (rest(), {"rate_hz": RATE_HZ, "columns": GYRO + ACCEL}),
        (named, {"rate_hz": RATE_HZ, "column": [GYRO[0], 1]}),
        (rest()[:, :3], {"rate_hz": RATE_HZ, "columns": ["wx", "wy", "wz"], "gyro_unit": "rad/s"}),
    ]
    for data, options in inputs:
        again = zerorate.imu(data, **options)
        for axis, known in zip(again.axes.values(), found.axes.values()):
            np.testing.assert_allclose(axis.dev, known.dev, rtol=1e-12)
            assert axis.unit == known.unit
    blocks = {"gyro": np.degrees(rest()[:, :3]), "accel": rest()[:, 3:] / 9.80665}
    other = zerorate.imu(blocks, rate_hz=RATE_HZ, gyro_unit="deg/s", accel_unit="g")
    assert list(other.axes) == [f"{kind}_{axis}" for kind in ("gyro", "accel") for axis in "xyz"]
    assert {axis.unit for axis in other.axes.values()} == {"deg/s", "g"}
    mine, theirs = (yaml.safe_load(of.to_yaml()) for of in (other, found))
    for key in ("gyroscope_noise_density", "accelerometer_noise_density", "accelerometer_random_walk"):
        assert mine[key] == pytest.approx(theirs[key], rel=1e-3), key


def test_the_file_is_that_of_the_program(found: zerorate.Imu, log: Path, tmp_path: Path) -> None:
    by_program, by_package = tmp_path / "program.yaml", tmp_path / "package.yaml"
    command = [sys.executable, "-m", "zerorate", "imu", str(log), "-o", str(by_program), "--combine", "mean"]
    subprocess.run([*command, "--as-fitted", "--inflate", "2"], check=True, capture_output=True)
    text = found.to_yaml(by_package, combine="mean", as_fitted=True, inflate=2.0)
    assert by_package.read_text(encoding="utf-8") == text
    theirs, mine = (yaml.safe_load(path.read_text(encoding="utf-8")) for path in (by_program, by_package))
    assert theirs.pop("rostopic") == mine.pop("rostopic") and theirs == pytest.approx(mine, rel=1e-3)
    with pytest.raises(FileExistsError, match="force=True"):
        found.to_yaml(by_package)
    assert "imu7" in found.to_yaml(by_package, topic="/imu7", force=True)


def test_a_file_needs_a_fit_a_unit_and_known_arguments(found: zerorate.Imu) -> None:
    wrong: list[tuple[str, dict[str, Any]]] = [
        ("format='kalib': give 'kalibr', 'openvins'", {"format": "kalib"}),
        ("combine='best'", {"combine": "best"}),
        ("inflate=0", {"inflate": 0}),
        ("the horizon is longer than half of the record", {"horizon_s": 101}),
    ]
    for match, options in wrong:
        with pytest.raises(ValueError, match=match):
            found.to_yaml(**options)
    assert copy.deepcopy(found).to_yaml() == found.to_yaml()
    with pytest.raises(ValueError, match="another process"):
        pickle.loads(pickle.dumps(found)).to_yaml()
    one = zerorate.allan(rest()[:, 0], rate_hz=RATE_HZ, unit="rad/s")
    assert yaml.safe_load(one.to_yaml(as_fitted=True))["gyroscope_noise_density"] == pytest.approx(1e-4, rel=0.03)
    with pytest.raises(ValueError, match="V, which is of no axis"):
        zerorate.allan(rest()[:, 0], rate_hz=RATE_HZ, unit="V").to_yaml()
    with pytest.raises(zerorate.Refused, match="fit=True"):
        zerorate.allan(rest()[:, 0], rate_hz=RATE_HZ, unit="°/s", fit=False).to_yaml()


def test_columns_without_names_are_axes_by_number() -> None:
    found = zerorate.imu(
        rest(), rate_hz=RATE_HZ, gyro=[0, 1, 2], accel=[3, 4, 5], gyro_unit="rad/s", accel_unit="m/s²"
    )
    assert [axis.kind for axis in found.axes.values()] == ["gyroscope"] * 3 + ["accelerometer"] * 3
    first = found.axes[0].fit
    assert first is not None and first.n.value == pytest.approx(N_GYRO[0], rel=0.03)
    with pytest.raises(ValueError, match=r"gyro=\[0, 1, 2\]"):
        zerorate.imu(rest(), rate_hz=RATE_HZ)
    with pytest.raises(ValueError, match="not both"):
        zerorate.imu(rest(), rate_hz=RATE_HZ, gyro=[0], column=[0])


def test_a_drift_with_the_temperature_is_taken_out_of_every_axis(tmp_path: Path) -> None:
    temp_c = 25 + 10 * np.linspace(0, 1, 20_000) ** 2
    warming = table(rest() + 1e-3 * temp_c[:, np.newaxis])
    named = {**warming, "temp_c": temp_c}
    asked: dict[str, Any] = {"rate_hz": RATE_HZ}
    assert any("follows-temperature" in text for text in zerorate.imu(named, **asked).warnings)
    for data, options in ((named, asked), (warming, {**asked, "temp_c": temp_c})):
        found = zerorate.imu(data, detrend=1, **options)
        for name in GYRO:
            detrended = found[name].detrended
            assert detrended is not None and detrended.coefficients[0] == pytest.approx(1e-3, rel=0.05)
    with pytest.raises(ValueError, match="detrend=: the dict has no column"):
        zerorate.imu(warming, detrend=1, **asked)
    recorded = tmp_path / "rest.arrows"
    zerorate.capture("twin:", recorded, samples=6000)
    capture = zerorate.read_capture(recorded)
    assert zerorate.imu(capture, detrend=1, skip=0.5)[0].skipped_s == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(ValueError, match="gyro_unit=, until= is for logs and tables, not for a capture"):
        zerorate.imu(capture, until=3, gyro_unit="dps")


def test_a_rejected_model_gives_a_file_only_if_accepted() -> None:
    t = np.arange(40_000) / RATE_HZ
    rng = np.random.default_rng(8)
    growing = rng.normal(size=len(t)) * np.exp(4 * np.sin(2 * np.pi * t / 50)) + np.sign(np.sin(t)) * 3
    found = zerorate.imu({"gx_dps": growing}, rate_hz=RATE_HZ, glitches="keep", steps="keep")
    fit = found.axes[0].fit
    assert fit is not None and fit.rejected and "rejected" in repr(found)
    assert fit.motion_ratio is not None and fit.motion_ratio > 10
    with pytest.raises(zerorate.Refused, match="the sensor moves: .* so no coefficient is a result"):
        found.to_yaml()
    with pytest.warns(UserWarning, match="made all the same"):
        assert "NOT A RESULT" in found.to_yaml(accept_rejected=True)


@pytest.mark.parametrize(
    ("match", "data", "options"),
    [
        ("columns=", rest(300), {}),
        ("one value of the type NoneType", None, {}),
        ("no column whose name or unit says", {"u": rest(300)[:, 0]}, {}),
        ("gyro_unit=", {"gyro": rest(300)[:, :3]}, {}),
        ("accel_unit=", {"acc_x": rest(300)[:, 0]}, {}),
        ("is not a unit for gyroscopes", {"gyro": rest(300)[:, :3]}, {"gyro_unit": "g"}),
        ("`furlong` is not a unit", {"gyro": rest(300)[:, :3]}, {"gyro_unit": "furlong"}),
        ("gyro_scale=: -1 is not", {"gyro": rest(300)[:, :3]}, {"gyro_unit": "dps", "gyro_scale": -1.0}),
        ("accel_range=: 0 is not", {"gyro": rest(300)[:, :3]}, {"part": "mpu6050", "accel_range": 0.0}),
        ("rate_hz=", {"gx_dps": rest(300)[:, 0]}, {"rate_hz": None}),
        ("time_unit='d'", {"t": np.arange(300.0), "gx_dps": rest(300)[:, 0]}, {"time_column": "t", "time_unit": "d"}),
    ],
)
def test_errors_speak_of_arguments(match: str, data: Any, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=match) as error:
        zerorate.imu(data, **{"rate_hz": None if "time_column" in options else RATE_HZ, **options})
    assert "--" not in str(error.value)


@pytest.mark.filterwarnings("ignore")
def test_integer_codes_get_the_scale_of_their_part() -> None:
    codes = np.round(100.0 * np.random.default_rng(1).normal(size=(2000, 3))).astype(np.int32)
    found = zerorate.imu({"gyro": codes}, rate_hz=RATE_HZ, part="mpu6050", gyro_range=500)
    scaled = zerorate.imu({"gyro": codes}, rate_hz=RATE_HZ, gyro_unit="dps", gyro_scale=1 / 65.5)
    one, other = (imu.axes["gyro_x"].dev for imu in (found, scaled))
    assert np.allclose(one, other, rtol=1e-12)
    with pytest.raises(ValueError, match="gyro_range=300: MPU-6050 has a gyroscope with the full scales 250, 500"):
        zerorate.imu({"gyro": codes}, rate_hz=RATE_HZ, part="mpu6050", gyro_range=300)


def test_logs_are_read_by_their_path(log: Path, tmp_path: Path) -> None:
    whole = zerorate.read_log(log, time_column="t_s")
    assert repr(whole).startswith("<Log of 20000 samples at 100 Hz: gx [rad/s] (rad/s), ")
    assert list(whole) == [*GYRO, *ACCEL, "temp_c"] and whole.rate_hz == RATE_HZ
    assert [whole.units[name] for name in ("gx [rad/s]", "az [m/s^2]", "temp_c")] == ["rad/s", "m/s²", "°C"]
    np.testing.assert_array_equal(whole["gy [rad/s]"], rest()[:, 1])
    frame = whole.to_frame()
    assert list(frame.columns) == ["t_s", *whole] and frame["t_s"].iloc[-1] == pytest.approx(199.99)
    of_log = zerorate.imu(whole)
    assert [axis.unit for axis in of_log.axes.values()] == ["rad/s"] * 3 + ["m/s²"] * 3
    again = zerorate.allan(whole, column="gx [rad/s]")
    assert (again.unit, again.rate_hz) == ("rad/s", RATE_HZ)
    two = zerorate.read_log(str(log), column=["gz [rad/s]", 4], rate_hz=50.0)
    assert list(two) == ["gz [rad/s]", "ax [m/s^2]"] and two.rate_hz == 50.0
    axes = zerorate.allan(log, column=["gx [rad/s]", "gy [rad/s]"], time_column="t_s", fit=False)
    assert [axis.unit for axis in axes.values()] == ["rad/s", "rad/s"]
    np.save(tmp_path / "one.npy", np.round(rest()[:, 0] * 1e5).astype(np.int32))
    codes = zerorate.allan(tmp_path / "one.npy", rate_hz=RATE_HZ, unit="rad/s", scale=1e-5)
    assert codes.fit is not None and codes.fit.n.value == pytest.approx(1e-4, rel=0.03) and codes.unit == "rad/s"
    phase = zerorate.allan(tmp_path / "one.npy", rate_hz=RATE_HZ, unit="rad/s", data="phase", fit=False)
    assert phase.samples == 20_000
    assert zerorate.read_log(tmp_path / "one.npy", rate_hz=1.0).units == {"0": None}
    (tmp_path / "raw.bin").write_bytes(rest()[:, 0].astype("<f8").tobytes())
    raw = zerorate.allan(tmp_path / "raw.bin", rate_hz=RATE_HZ, unit="rad/s", raw="f64")
    np.testing.assert_allclose(raw.dev, zerorate.allan(rest()[:, 0], rate_hz=RATE_HZ).dev, rtol=1e-12)


def test_increments_are_read_as_rates(tmp_path: Path) -> None:
    rate = rest()[:, 0]
    increments = {"dtheta_x": rate / RATE_HZ}
    np.savetxt(tmp_path / "log.csv", increments["dtheta_x"], header="dtheta_x", comments="", fmt="%.17g")
    asked: dict[str, Any] = {"rate_hz": RATE_HZ, "unit": "rad/s"}
    alone = zerorate.allan(rate, **asked)
    sources: list[Any] = [tmp_path / "log.csv", increments]
    for source in sources:
        found = zerorate.allan(source, column="dtheta_x", increments=True, **asked)
        np.testing.assert_allclose(found.dev, alone.dev, rtol=1e-9)
        assert found.unit == "rad/s" and found.fit is not None
    read = zerorate.read_log(tmp_path / "log.csv", increments=True, **asked)
    np.testing.assert_allclose(read["dtheta_x"], rate, rtol=1e-9)
    with pytest.raises(ValueError, match="times their rate"):
        zerorate.allan(rate / RATE_HZ, increments=True, **asked)


@pytest.mark.parametrize("name", ["imu_bz2.bag", "imu_lz4.mcap"])
def test_a_bag_states_all_that_is_asked(name: str) -> None:
    found = zerorate.imu(FIXTURES / name, taus=[0.005])
    assert (found.topic, round(found.rate_hz)) == ("/imu", 200)
    # two axes of the accelerometer are 0 in every message
    assert [axis.unit for axis in found.axes.values()] == ["rad/s"] * 3 + ["m/s²"]
    with pytest.raises(ValueError, match="topic"):
        zerorate.imu(FIXTURES / name, topic="/other")


def test_a_log_that_does_not_say_enough_asks_for_arguments(log: Path, tmp_path: Path) -> None:
    np.save(tmp_path / "one.npy", rest(300)[:, 0])
    wrong: list[tuple[type[Exception], str, Any, dict[str, Any]]] = [
        (ValueError, "choose with column= one of: 0 `t_s`", log, {"rate_hz": 1.0}),
        (ValueError, "rate_hz= in Hz, or time_column=", tmp_path / "one.npy", {}),
        (ValueError, "is not a unit", log, {"column": 1, "rate_hz": 1.0, "unit": "rads"}),
        (ValueError, "decimal=';'", log, {"column": 1, "rate_hz": 1.0, "decimal": ";"}),
        (ValueError, "max_bad=2", log, {"column": 1, "rate_hz": 1.0, "max_bad": 2}),
        (FileNotFoundError, "none.csv", tmp_path / "none.csv", {}),
    ]
    for kind, match, path, options in wrong:
        with pytest.raises(kind, match=match) as error:
            zerorate.allan(path, **options)
        assert "--" not in str(error.value)
    (tmp_path / "junk").write_bytes(bytes(range(256)) * 10)
    with pytest.raises(ValueError, match="junk"):
        zerorate.read_log(tmp_path / "junk")
    backwards = tmp_path / "back.csv"
    t = np.r_[np.arange(500), np.arange(500)] / 100.0
    np.savetxt(backwards, np.column_stack([t, rest(1000)[:, 0]]), delimiter=",", header="t_s,gx_dps", comments="")
    with pytest.raises(zerorate.Refused, match="rate_hz="):
        zerorate.imu(backwards)


def test_a_warning_names_the_unit_of_its_axis() -> None:
    t_s = np.arange(12_000) / 200.0
    gyro = np.random.default_rng(20).normal(0.0, 0.05, (12_000, 3)) + np.sin(40.0 * np.pi * t_s)[:, np.newaxis]
    found = zerorate.imu({"gyro": gyro}, rate_hz=200.0, gyro_unit="dps")
    (said,) = [text for text in found.warnings if text.startswith("gyro_x: lines")]
    assert "dps rms" in said
