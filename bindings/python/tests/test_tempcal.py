"""`zerorate.tempcal`: the bias over temperature of simulated sensors with a known curve."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import zerorate

RATE_HZ = 10.0
SAMPLES = 18_000
"""Half an hour at `RATE_HZ`."""
CUBICS = {"gx_dps": (0.1, 2e-3, 3e-5, 1e-6), "gy_dps": (-0.2, -1e-3, 5e-5, 0.0), "gz_dps": (0.05, 4e-3, 0.0, -2e-6)}
"""The bias of each gyroscope axis, °/s: coefficients of the powers 0 to 3 of T − 25 °C."""
ACCEL = {"ax_mps2": (0.0, 1e-3, 0.0, 0.0), "ay_mps2": (0.3, -2e-3, 2e-5, 0.0), "az_mps2": (9.8, 5e-4, 0.0, 1e-6)}
WHITE = 0.02
"""Standard deviation of the noise of a sample, °/s and m/s²."""

Table = dict[str, NDArray[np.float64]]


def truth(terms: tuple[float, ...], temp_c: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.polynomial.polynomial.polyval(temp_c - 25.0, terms), dtype=np.float64)


def record(seed: int = 1, low_c: float = 5.0, high_c: float = 45.0) -> Table:
    """A record of a sensor that warms and cools again. Its bias follows the temperature without lag."""
    rng, t_s = np.random.default_rng(seed), np.arange(SAMPLES) / RATE_HZ
    temp_c = low_c + (high_c - low_c) * (0.5 - 0.5 * np.cos(2 * np.pi * t_s / t_s[-1]))
    axes = {**CUBICS, **ACCEL}
    columns = {name: truth(terms, temp_c) + rng.normal(scale=WHITE, size=SAMPLES) for name, terms in axes.items()}
    return {"t_s": t_s, **columns, "temp_c": temp_c}


def gyroscopes(columns: Table) -> Table:
    """The record without accelerometers, which halves the time of the fit."""
    return {name: column for name, column in columns.items() if name not in ACCEL}


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path, columns = tmp_path_factory.mktemp("log") / "unit.csv", record()
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.17g")
    return path


@pytest.fixture(scope="module")
def found() -> zerorate.Tempcal:
    return zerorate.tempcal(record(), serial="U7")


def test_each_axis_has_its_means_and_cubic(found: zerorate.Tempcal) -> None:
    assert list(found.axes) == [*CUBICS, *ACCEL]
    for axis in found.axes.values():
        assert axis.spread_of_starts is None and len(axis.means.at_s) == len(axis.means.left)
        assert axis.means.is_warming.any() and not axis.means.is_warming.all()
        assert len(axis.cubic.terms) == 4 and axis.cubic.about_c == 25.0
    assert "gx_dps: +0.002" in repr(found)


def test_the_numbers_are_those_of_the_program(found: zerorate.Tempcal, log: Path, tmp_path: Path) -> None:
    files = {form: tmp_path / form for form in ("toml", "ardupilot")}
    for form, path in files.items():
        command = [sys.executable, "-m", "zerorate", "tempcal", str(log), "--json", "-o", str(path), "--format", form]
        done = subprocess.run([*command, "--serial", "U7"], check=True, capture_output=True, text=True)
    of_program = json.loads(done.stdout)["axes"]
    of_file = zerorate.tempcal(str(log), serial="U7")
    for axis, other, theirs in zip(of_file.axes.values(), found.axes.values(), of_program):
        same = ["name", "kind", "unit", "reference_c", "bias", "u_bias", "slope_per_c", "u_slope_per_c", "lag_s"]
        for key in [*same, "play_c", "hysteresis", "spread_of_starts", "before", "after", "warnings"]:
            assert getattr(axis, key) == theirs[key], key
        points = np.array([list(point.values()) for point in theirs["curve"]])
        np.testing.assert_array_equal(points.T, [axis.curve.temp_c, axis.curve.bias, axis.curve.u])
        assert [*axis.cubic.terms] == theirs["cubic"]["terms"] and axis.cubic.left == theirs["cubic"]["left"]
        assert axis.noise == zerorate.BiasNoise(**theirs["noise"])
        np.testing.assert_array_equal(axis.curve.bias, other.curve.bias)
    assert of_file.calibration.text == files["toml"].read_text(encoding="utf-8")
    assert found.to_ardupilot() == files["ardupilot"].read_text(encoding="utf-8")


@pytest.mark.filterwarnings("error")
def test_tables_in_memory_are_read_as_logs(found: zerorate.Tempcal) -> None:
    pandas, polars, pyarrow = (pytest.importorskip(name) for name in ("pandas", "polars", "pyarrow"))
    columns = gyroscopes(record())
    named = {name: column for name, column in columns.items() if name != "t_s"}
    gyro = np.column_stack([columns[name] for name in CUBICS])
    times = pandas.to_timedelta(np.arange(SAMPLES) * 100, unit="ms")
    inputs: list[tuple[Any, dict[str, Any]]] = [
        (named, {"rate_hz": RATE_HZ}),
        (pandas.DataFrame(named, index=times), {}),
        (polars.DataFrame(columns), {}),
        (pyarrow.table(columns), {}),
        ({"gyro": gyro, "T [°C]": columns["temp_c"]}, {"rate_hz": RATE_HZ, "gyro_unit": "°/s"}),
        (np.column_stack([gyro, columns["temp_c"]]), {"rate_hz": RATE_HZ, "columns": [*CUBICS, "temp_c"]}),
        ({**named, "board_c": columns["temp_c"] + 9.0}, {"rate_hz": RATE_HZ, "temp_column": "temp_c"}),
    ]
    all_again = [zerorate.tempcal(data, **options) for data, options in inputs]
    with pytest.warns(UserWarning, match="units-taken: .* taken in °C"):
        array = np.column_stack([gyro, columns["temp_c"]])
        all_again.append(zerorate.tempcal(array, rate_hz=RATE_HZ, gyro=[0, 1, 2], gyro_unit="dps", temp_column=3))
    for again in all_again:
        for axis, known in zip(again.axes.values(), found.axes.values()):
            np.testing.assert_allclose(axis.curve.bias, known.curve.bias, atol=0.2 * known.u_bias)


def test_several_logs_are_fitted_together() -> None:
    both = zerorate.tempcal([gyroscopes(record()), gyroscopes(record(2, 15.0, 50.0))])
    axis = both["gx_dps"]
    assert axis.spread_of_starts is not None and axis.curve.temp_c[-1] == pytest.approx(50.0, abs=0.5)
    assert np.all(np.abs(axis.curve.bias - truth(CUBICS["gx_dps"], axis.curve.temp_c)) <= 4 * axis.curve.u)
    with pytest.raises(ValueError, match="unit"):
        zerorate.tempcal([record(), {name: column for name, column in record().items() if name != "gy_dps"}])
    with pytest.raises(ValueError, match="the list of logs is empty"):
        zerorate.tempcal([])


def test_the_calibration_corrects(found: zerorate.Tempcal, tmp_path: Path) -> None:
    calibration, columns = found.calibration, record(3)
    assert (calibration.method, calibration.serial) == ("tempcal", "U7")
    assert [axis.name for axis in calibration.axes] == list(CUBICS)
    rates = np.column_stack([columns[name] for name in CUBICS])
    corrected = calibration.correct(rates, columns["temp_c"])
    left = corrected.reshape(18, -1, 3).mean(axis=1)
    assert np.abs(left).max() < 5 * WHITE / np.sqrt(SAMPLES / 18)
    calibration.save(tmp_path / "unit.toml")
    assert zerorate.Calibration.load(tmp_path / "unit.toml").id == calibration.id
    again = pickle.loads(pickle.dumps(found))
    assert again.calibration.id == calibration.id and again.to_ardupilot() == found.to_ardupilot()


def test_files_of_flight_controllers(found: zerorate.Tempcal, tmp_path: Path) -> None:
    path = tmp_path / "tcal.param"
    text = found.to_ardupilot(path)
    assert path.read_text(encoding="utf-8") == text and "INS_TCAL1_ENABLE,1" in text
    with pytest.raises(FileExistsError, match="force=True"):
        found.to_ardupilot(path)
    assert found.to_ardupilot(path, force=True) == text
    with pytest.raises(ValueError, match="device_id"):
        found.to_px4()
    accel = {name: column for name, column in record().items() if name not in CUBICS}
    with pytest.raises(ValueError, match="a calibration holds gyroscopes"):
        zerorate.tempcal(accel).calibration


def test_the_picture_has_a_panel_for_each_axis(found: zerorate.Tempcal) -> None:
    pytest.importorskip("matplotlib").use("Agg")
    figure = found.plot()
    assert [ax.get_title() for ax in figure.axes] == [*CUBICS, *ACCEL]
    assert figure.axes[0].get_ylabel() == "bias / °/s"


@pytest.mark.parametrize(
    ("match", "kind", "change", "options"),
    [
        ("is uncertain by .* above the limit", zerorate.Refused, {}, {"max_u_dps": 1e-9}),
        ("give a number above 0", ValueError, {}, {"max_u_dps": float("nan")}),
        ("goes from .* a curve needs at least 5 °C", zerorate.Refused, {"temp_c": np.linspace(20, 23, SAMPLES)}, {}),
        ("has no temperature.*temp_column=", ValueError, {"temp_c": None}, {}),
        ('temp_column=: the dict has no column "tc"', ValueError, {}, {"temp_column": "tc"}),
        ("looks like kelvins.*temp_column=", ValueError, {"temp_c": np.linspace(280, 320, SAMPLES)}, {}),
        ("several temperatures.*temp_column=", ValueError, {"temp2_c": np.linspace(20, 30, SAMPLES)}, {}),
    ],
)
def test_errors_speak_of_arguments(
    match: str, kind: type[Exception], change: dict[str, Any], options: dict[str, Any]
) -> None:
    columns = {name: column for name, column in {**record(), **change}.items() if column is not None}
    with pytest.raises(kind, match=match) as error:
        zerorate.tempcal(columns, **options)
    assert "--" not in str(error.value)


def test_motion_is_refused_with_arguments() -> None:
    columns, rng = record(), np.random.default_rng(5)
    for name in CUBICS:
        columns[name][3000:11_000] += rng.normal(scale=20.0, size=8_000)
    with pytest.raises(zerorate.Refused, match="skip= and until="):
        zerorate.tempcal(columns)


def test_a_log_needs_a_name_for_each_axis() -> None:
    with pytest.raises(ValueError, match="temp_column=3"):
        zerorate.tempcal(np.zeros((100, 4)), rate_hz=RATE_HZ)
    with pytest.raises(FileNotFoundError):
        zerorate.tempcal("none.csv")
