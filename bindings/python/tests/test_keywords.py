"""The names of arguments, and the error texts about wrong names."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

import zerorate
from zerorate import _axes


@pytest.mark.parametrize(
    ("match", "options"),
    [
        (r"no argument rate=: give rate_hz=", {"rate": 200.0}),
        (r"no argument fs=: give rate_hz=", {"fs": 200.0}),
        (r"no argument dt=: give rate_hz=1/dt", {"dt": 0.005}),
        (r"did you mean detrend=\?", {"detrends": 1}),
        (r"no argument rms=; it has rate_hz, column", {"rms": 1}),
    ],
)
def test_another_name_says_which_was_meant(match: str, options: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match=match):
        zerorate.allan(np.ones(100), **options)


def test_a_serial_number_is_not_empty() -> None:
    for function, data in (("calibrate", 1), ("capture", 2), ("stream", 2), ("tempcal", 1)):
        for serial in ("", " \t"):
            with pytest.raises(ValueError, match="it is empty; leave the argument out"):
                getattr(zerorate, function)(*["none"] * data, serial=serial)


def test_the_names_of_the_package() -> None:
    names = """
    Allan AllanAxes BandShape BiasAxis BiasCubic BiasCurve BiasMeans BiasNoise Calibrated CalibratedAxis
    Calibration Capture Captured Cleaned Coefficient Corrected Correction Corrector CurvePoint CurveRecord
    Detrended Estimate Fit GaussMarkov Imu Line Log Measured NoiseRecord Progress Refused Run Scale Stream
    StreamRow Tempcal Truth Twin TwinKey Unavailable Uncertainties Validity WarmUp ZerorateError __version__
    allan calibrate capture imu read_capture read_log stream tempcal
    """
    assert zerorate.__all__ == names.split() and all(hasattr(zerorate, name) for name in names.split())


def test_data_have_no_name() -> None:
    data = {"allan": ["rate"], "imu": ["log"], "tempcal": ["log"], "read_log": ["log"], "read_capture": ["path"]}
    data.update({"calibrate": ["device"], "capture": ["device", "output"], "stream": ["device", "calibration"]})
    for name, expected in data.items():
        parameters = inspect.signature(getattr(zerorate, name)).parameters.values()
        assert [one.name for one in parameters if one.kind is one.POSITIONAL_ONLY] == expected
    with pytest.raises(TypeError, match=r"allan\(rate, …\): give rate without a name"):
        zerorate.allan(rate=np.ones(100))  # type: ignore[call-overload]
    with pytest.raises(TypeError, match=r"stream\(device, calibration, …\): it needs calibration"):
        zerorate.stream("twin:")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="progress= takes a function"):
        zerorate.calibrate("twin:", progress=True)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="takes rate without a name, and all else by name"):
        zerorate.allan(np.ones(100), 100.0)  # type: ignore[call-overload]


def test_imu_and_tempcal_have_the_same_arguments_for_a_log() -> None:
    imu, tempcal = (inspect.signature(of).parameters for of in (zerorate.imu, zerorate.tempcal))
    shared = [*_axes.OF_READING, *_axes.OF_AXES]
    assert sorted(shared) == sorted(imu.keys() & tempcal.keys() - {"log"})
    assert all(imu[name] == tempcal[name] for name in shared)
