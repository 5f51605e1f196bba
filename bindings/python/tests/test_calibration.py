"""The procedure on the twin, calibration files, captures."""

from __future__ import annotations

import copy
import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import zerorate

BY_HAND = """schema = 1
part = "ADIS16130"
[correction]
pbc_dps = -0.25
btc_dps_per_c = -0.04
t3_c = 31.5
[validity]
temp_min_c = 25.0
temp_max_c = 35.0
"""


@pytest.fixture(scope="module")
def unit(tmp_path_factory: pytest.TempPathFactory) -> tuple[zerorate.Calibrated, Path]:
    """A short calibration with samples at 1/100 of the conversion rate, and the folder with its log and its file."""
    folder = tmp_path_factory.mktemp("unit")
    found = zerorate.calibrate(
        zerorate.Twin(seed=7),
        average="10s",
        warmup="1m",
        settle="1m",
        offset=20,
        divider=99,
        log=folder / "unit.arrows",
        output=folder / "unit.toml",
        serial="SN17",
        max_u_btc=1.0,
    )
    return found, folder


def test_the_report_has_the_keys_of_the_command_line(unit: tuple[zerorate.Calibrated, Path]) -> None:
    found, folder = unit
    command = [sys.executable, "-m", "zerorate", "recalibrate", str(folder / "unit.arrows"), "--json", "--max-u-btc=1"]
    command += ["--average=10s", "--warmup=1m", "--settle=1m", "--offset=20s"]
    report = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    different = {"device", "file", "warnings", "remarks", "curve"}
    for key in report.keys() - different:
        assert getattr(found, key) == report[key], key
    assert found.curve == [zerorate.CurvePoint(**point) for point in report["curve"]]
    # the same warnings, but each front end names its own settings
    for own, theirs in [(found.warnings, report["warnings"]), (found.remarks, report["remarks"])]:
        assert [text.split(":")[0] for text in own] == [text.split(":")[0] for text in theirs]
        assert not any("--" in text for text in own)
    assert any("(earth_dps=)" in remark for remark in found.remarks)
    of_curves = {
        "order",
        "order_weights",
        "btc2_dps_per_c2",
        "btc3_dps_per_c3",
        "lag_s",
        "play_c",
        "bias_instability_dps",
        "rate_random_walk_dps_per_rt_s",
        "steps",
        "sway_probability",
    }
    assert not report.keys() & of_curves
    assert report.keys() | of_curves | {"truth", "calibration", "axes"} == set(vars(found))


def test_a_sensor_with_several_axes_has_a_result_of_each() -> None:
    found = zerorate.calibrate("twin:axes=3", average="2s", warmup="20s", settle="20s", offset="5s", max_u_btc=1.0)
    assert list(found.axes) == [axis.name for axis in found.calibration.axes] and len(found.axes) == 3
    for name, axis in found.axes.items():
        assert axis.pbc_dps == found.calibration[name].correction.pbc_dps
        assert len(axis.curve) == 9 and axis.truth is not None and axis.samples == found.samples
    with pytest.raises(AttributeError, match=r"pbc_dps belongs to one axis of .*result\.axes\["):
        found.pbc_dps  # noqa: B018
    assert "the axes" in repr(found)


def test_the_file_is_the_calibration(unit: tuple[zerorate.Calibrated, Path]) -> None:
    found, folder = unit
    loaded = zerorate.Calibration.load(folder / "unit.toml")
    assert loaded == found.calibration
    assert loaded.id == found.calibration_id
    assert loaded.serial == "SN17"
    assert loaded.correction.pbc_dps == found.pbc_dps
    assert loaded.run is not None and loaded.run.samples == found.samples
    loaded.save(folder / "copy.toml")
    with pytest.raises(FileExistsError, match="force"):
        loaded.save(folder / "copy.toml")
    with pytest.raises(FileExistsError, match="is a capture"):
        loaded.save(folder / "unit.arrows", force=True)
    loaded.save(folder / "copy.toml", force=True)
    assert zerorate.Calibration.load(folder / "copy.toml") == loaded


def test_the_pictures_are_those_of_the_report(
    unit: tuple[zerorate.Calibrated, Path], two: zerorate.Calibration, tmp_path: Path
) -> None:
    found, folder = unit
    command = [sys.executable, "-m", "zerorate", "report", str(folder / "unit.toml"), "-o", str(tmp_path / "unit.svg")]
    subprocess.run(command, capture_output=True, check=True)
    assert found.calibration.pictures() == [(tmp_path / "unit.svg").read_text(encoding="utf-8")]
    assert len(two.pictures()) == 2


def test_a_calibration_corrects_the_same_after_pickling(unit: tuple[zerorate.Calibrated, Path]) -> None:
    calibration = unit[0].calibration
    correction = calibration.correction
    assert calibration.correct(1.0, correction.t3_c) == 1.0 + correction.pbc_dps
    for again in (pickle.loads(pickle.dumps(calibration)), copy.deepcopy(calibration)):
        assert again == calibration and repr(again) == repr(calibration)
        assert again.correct(1.0, correction.t3_c) == 1.0 + correction.pbc_dps
        taken = zerorate.Corrector(again).take([1.0], [correction.t3_c])
        assert taken.rate_dps[0] == 1.0 + correction.pbc_dps and not taken.extrapolated[0]


def test_the_log_gives_back_what_was_measured(unit: tuple[zerorate.Calibrated, Path]) -> None:
    found, folder = unit
    log = zerorate.read_capture(folder / "unit.arrows")
    # the log also has the sample that ends the last step, which belongs to no step
    assert len(log) == found.samples + 1
    assert log.metadata["zerorate.serial"] == "SN17"
    assert log.rate_hz == pytest.approx(found.rate_hz, rel=1e-3)
    assert log.t_s[0] == 0.0
    # the scale of the data sheet, typed again: 23 488 LSB per °/s, 14 093 LSB per °C around 25 °C
    codes = log.rate_code.astype(np.float64)
    np.testing.assert_array_equal(log.rate_dps, (codes - 2**23) / 23488)
    np.testing.assert_allclose(log.temp_c, (log.temp_code - 2**23) / 14093 + 25, rtol=1e-15)
    np.testing.assert_array_equal(log.temp_held_c, log.temp_c)
    # step 4 is the first 10 s
    assert log.rate_dps[log.t_s <= 10].mean() == pytest.approx(found.b1_dps, abs=1e-3)


def test_a_warm_up_gives_a_curve(tmp_path: Path) -> None:
    twin = zerorate.Twin(seed=6, warmup_s=40, curvature=0.003)
    short: dict[str, Any] = {"average": 2, "warmup": 60, "settle": 120, "offset": 20}
    found = zerorate.calibrate(twin, method="warmup", max_u_btc=0.2, output=tmp_path / "unit.toml", **short)
    assert (found.method, found.b1_dps, found.order >= 2) == ("warmup", None, True)
    assert found.calibration.uncertainty is None
    assert found.calibration.curve is not None and found.calibration.curve.order == found.order
    assert found.truth is not None
    for point, truth in zip(found.curve, found.truth.curve):
        assert point.u_dps is not None
        assert abs(point.correction_dps - truth.correction_dps) < 4 * point.u_dps
        assert found.calibration.correct(0.0, point.temp_c) == pytest.approx(point.correction_dps, abs=1e-12)
    assert zerorate.Calibration.load(tmp_path / "unit.toml") == found.calibration


def test_correct_is_the_formula_of_the_note() -> None:
    with pytest.warns(UserWarning, match="no checksum"):
        calibration = zerorate.Calibration.parse(BY_HAND)
    assert calibration.correct(1.0, 31.5) == 0.75
    assert calibration.correct(1.0, 30.5) == 1.0 - 0.25 + 0.04
    rate = np.linspace(-1, 1, 6).reshape(2, 3)
    temp = np.array([30.0, 31.0, 32.0])
    expected = rate - 0.25 - 0.04 * (temp - 31.5)
    np.testing.assert_allclose(calibration.correct(rate, temp), expected, rtol=0, atol=1e-15)
    np.testing.assert_allclose(calibration.correct(rate[:, ::2], 31.5), rate[:, ::2] - 0.25)
    assert np.isnan(calibration.correct(1.0, float("nan")))
    assert calibration.correct([], []).shape == (0,)
    with pytest.warns(UserWarning, match="leaves the"):
        calibration.correct(rate, 60.0)
    with pytest.raises(ValueError, match="shape"):
        calibration.correct([1.0, 2.0], [1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="one temperature"):
        calibration.correct(rate[:1].T, temp)
    assert calibration.correct(1.0, temp).shape == (3,)


AXES = """schema = 2
part = "ADIS16405"
[temperature]
lsb_per_c = 7.14
zero_code = 0
zero_c = 25
width_bits = 12
[[axis]]
name = "x"
correction = { pbc_dps = -0.25, btc_dps_per_c = -0.04, t3_c = 31.5 }
[[axis]]
name = "y"
warnings = ["own"]
rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 14 }
correction = { pbc_dps = 0.75, btc_dps_per_c = 0.02, t3_c = 31.25 }
[validity]
temp_min_c = 25.0
temp_max_c = 35.0
margin_c = 1.5
"""


@pytest.fixture
def two() -> zerorate.Calibration:
    with pytest.warns(UserWarning, match="no checksum"):
        return zerorate.Calibration.parse(AXES)


def test_the_only_axis_is_the_calibration() -> None:
    with pytest.warns(UserWarning, match="no checksum"):
        calibration = zerorate.Calibration.parse(BY_HAND)
    assert calibration["rate"].correction == calibration.correction == zerorate.Correction(-0.25, -0.04, 31.5)
    assert calibration["rate"].rate == zerorate.Scale(23488, 2**23, 0, 24, False)
    assert calibration.validity == zerorate.Validity(25, 35)


def test_a_curve_has_its_terms() -> None:
    text = BY_HAND.replace("schema = 1", "schema = 3").replace(
        "t3_c = 31.5\n", "t3_c = 31.5\nbtc2_dps_per_c2 = 0.001\nbtc3_dps_per_c3 = -1e-5\n"
    )
    with pytest.warns(UserWarning, match="no checksum"):
        curved = zerorate.Calibration.parse(text)
    assert (curved.schema, curved.correction) == (3, zerorate.Correction(-0.25, -0.04, 31.5, 0.001, -1e-5))
    d = np.array([-4.0, 0.0, 2.5])
    wanted = 1.0 - 0.25 - 0.04 * d + 0.001 * d**2 - 1e-5 * d**3
    np.testing.assert_allclose(curved.correct(np.ones(3), 31.5 + d), wanted, rtol=0, atol=1e-12)
    taken = zerorate.Corrector(curved).take(np.ones(3), 31.5 + d)
    np.testing.assert_allclose(taken.rate_dps, wanted, rtol=0, atol=1e-12)


def test_axes_are_called_by_their_names(two: zerorate.Calibration) -> None:
    assert (two.schema, two.part, [axis.name for axis in two.axes]) == (2, "ADIS16405", ["x", "y"])
    assert two["y"].correction == zerorate.Correction(0.75, 0.02, 31.25) and two["y"].warnings == ["own"]
    assert two["x"].rate is None and two["y"].rate == zerorate.Scale(20, 0, 0, 14, True)
    assert two.temp == zerorate.Scale(7.14, 0, 25, 12, True)
    with pytest.raises(KeyError, match="it is of x, y"):
        two["z"]
    with pytest.raises(ValueError, match=r"calibration\['x'\]\.correction"):
        two.correction  # noqa: B018
    with pytest.raises(ValueError, match="line 15, axis y: pbc_dps"):
        zerorate.Calibration.parse(AXES.replace("pbc_dps = 0.75", "pbc_dps = nan"))


def test_several_axes_are_corrected_at_once(two: zerorate.Calibration) -> None:
    rates = np.linspace(-1, 1, 8).reshape(4, 2)
    temps = np.array([30.0, 31.0, 32.0, 36.0])
    corrected = two.correct(rates, temps)
    np.testing.assert_allclose(corrected[:, 0], rates[:, 0] - 0.25 - 0.04 * (temps - 31.5), rtol=0, atol=1e-15)
    np.testing.assert_allclose(corrected[:, 1], rates[:, 1] + 0.75 + 0.02 * (temps - 31.25), rtol=0, atol=1e-15)
    np.testing.assert_array_equal(two.correct(rates[0], 31.5), two.correct(rates[:1], 31.5)[0])
    np.testing.assert_array_equal(two.correct(rates, temps[:, np.newaxis]), corrected)
    assert two.correct(rates[0], temps).shape == (4, 2)
    with pytest.raises(ValueError, match="one temperature"):
        two.correct(temps[:2], rates)
    with pytest.raises(ValueError, match="2 axes x, y"):
        two.correct(rates[:, :1], temps)
    with pytest.raises(ValueError, match="2 axes x, y"):
        two.correct(1.0, 25.0)


def test_a_stream_takes_the_last_temperature(two: zerorate.Calibration) -> None:
    nan = float("nan")
    corrector = zerorate.Corrector(two, ["y"])
    first = corrector.take([1.0, 1.0, 1.0], [nan, 31.25, nan])
    np.testing.assert_array_equal(first.rate_dps, [nan, 1.75, 1.75])
    np.testing.assert_array_equal(first.temp_c, [nan, 31.25, 31.25])
    second = corrector.take([0.0, nan], [nan, 36.6])
    np.testing.assert_array_equal(second.rate_dps, [0.75, nan])
    assert second.extrapolated.tolist() == [False, True] and first.extrapolated.dtype == np.bool_
    assert corrector.warning is not None and "36.6" in corrector.warning
    both = zerorate.Corrector(two).take([[0.0, 0.0]], [31.5])
    np.testing.assert_array_equal(both.rate_dps, two.correct([[0.0, 0.0]], 31.5))
    with pytest.raises(ValueError, match="no axis"):
        zerorate.Corrector(two, ["z"])
    with pytest.raises(ValueError, match="a row of 2 rates"):
        zerorate.Corrector(two).take([0.0], [31.5])


def test_each_error_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        zerorate.Calibration.load(tmp_path / "none.toml")
    with pytest.raises(FileNotFoundError, match=r"none\.arrows"):
        zerorate.read_capture(tmp_path / "none.arrows")
    bad = tmp_path / "bad.toml"
    bad.write_text(BY_HAND.replace("t3_c = 31.5", "t3_c = 3150"))
    with pytest.raises(ValueError, match=r"bad\.toml: line 6: t3_c"):
        zerorate.Calibration.load(bad)
    (tmp_path / "rest.arrows").write_bytes(b"\xff\xff\xff\xff")
    with pytest.raises(ValueError, match=r"rest\.arrows is not a calibration file: give the TOML file"):
        zerorate.Calibration.load(tmp_path / "rest.arrows")
    with pytest.raises(ValueError, match="not a capture"):
        zerorate.read_capture(bad)
    with pytest.raises(ValueError, match="bias_dsp"):
        zerorate.Twin(bias_dsp=1)
    with pytest.raises(ValueError, match="average=soon"):
        zerorate.calibrate(zerorate.Twin(), average="soon")
    with pytest.raises(ValueError, match="earth_dps=5; it must be a number"):
        zerorate.calibrate(zerorate.Twin(), earth_dps=5)
    with pytest.raises(zerorate.Refused, match="mov"):
        zerorate.calibrate(zerorate.Twin(motion="sway", sway_dps=5), divider=99, average=10, warmup=10)


def test_twins() -> None:
    assert zerorate.Twin(seed=3, noise=False).device == "twin:seed=3,noise=0"
    assert zerorate.Twin(seed=3) == zerorate.Twin(3) != zerorate.Twin(seed=4)
    assert {"seed", "bias_dps", "motion"} <= {key.name for key in zerorate.Twin.keys()}


def test_readings_that_are_not_to_be_believed_are_marked(tmp_path: Path) -> None:
    # the readings are 175.667 µs apart; bit 18 of reading 20 is flipped (11 °/s), and temperature 30 is off by 64 °C
    codes = [2**23 + (k % 3) for k in range(40)]
    codes[20] ^= 2**18
    rows = [f"{175_667 * (k + 1)},{k},{code},8,{2**23},0" for k, code in enumerate(codes)]
    rows[30] = rows[30].replace(f",{2**23},0", f",{2**23 + 900_000},0")
    keys = {"capture_schema": 1, "width_bits": 24, "rate_conversion": 5, "temp_conversion": 5}
    description = "".join(f"# zerorate.{key} = {value}\n" for key, value in keys.items())
    file = tmp_path / "spoilt.csv"
    file.write_text(description + "t_ns,edge_seq,rate_code,status,temp_code,lost\n" + "\n".join(rows) + "\n")
    with pytest.warns(UserWarning, match="impossible-readings"):
        capture = zerorate.read_capture(file)
    assert np.flatnonzero(capture.flags).tolist() == [20, 30]
    assert (capture.flags[20], capture.flags[30]) == (1, 8)
    assert np.flatnonzero(~capture.good).tolist() == [20]
    assert np.isnan(capture.rate_dps[20]) and capture.rate_code[20] == codes[20]
    assert np.isnan(capture.temp_c[30]) and capture.temp_held_c[30] == 25.0
    assert capture._codes()[1] == [(20, 1)]


def test_a_torn_capture_is_read_with_a_warning(unit: tuple[zerorate.Calibrated, Path]) -> None:
    _, folder = unit
    whole = (folder / "unit.arrows").read_bytes()
    torn = folder / "torn.arrows"
    torn.write_bytes(whole[: len(whole) * 2 // 3])
    with pytest.warns(UserWarning, match="was not closed"):
        assert 0 < len(zerorate.read_capture(torn)) < len(zerorate.read_capture(folder / "unit.arrows"))
