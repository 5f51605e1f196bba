"""`tempcal`: the bias over temperature of all axes of an IMU."""

from __future__ import annotations

import os
import warnings as python_warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Union

from . import _axes, _html, _log, _plot, _records, _zerorate
from ._calibration import Calibration
from ._keywords import checked

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    _Log = Union[str, os.PathLike[str], Mapping[str, ArrayLike], ArrayLike, Any]


@dataclass(frozen=True, eq=False)
class BiasCurve:
    """The bias at evenly spaced temperatures: arrays of equal length. The bias is in the unit of the axis."""

    temp_c: NDArray[np.float64]
    """Temperature, °C, ascending."""
    bias: NDArray[np.float64]
    """Bias at `temp_c`."""
    u: NDArray[np.float64]
    """Standard uncertainty of `bias`; bias ± 1.96 u is the 95 % band."""


@dataclass(frozen=True, eq=False)
class BiasMeans:
    """The means of an axis over parts of the logs, from which its curve comes: arrays of equal length."""

    at_s: NDArray[np.float64]
    """Time since the first sample of the log that the mean is from, s."""
    temp_c: NDArray[np.float64]
    """Temperature, °C."""
    bias: NDArray[np.float64]
    """Mean of the axis without the removed steps, in the unit of the axis. For an accelerometer, the curve's value at
    the reference temperature is subtracted."""
    left: NDArray[np.float64]
    """The mean without the removed steps, minus the curve at the temperature that the bias follows (`lag_s`)."""
    is_warming: NDArray[np.bool_]
    """True if the sensor was warming or kept its temperature, false if it was cooling."""


@dataclass(frozen=True)
class BiasCubic:
    """The polynomial of order 3 that flight controllers and calibration files hold.

    bias = Σ ``terms[k]`` · (T − ``about_c``)ᵏ
    """

    about_c: float
    """Temperature about which the polynomial is expanded, °C."""
    terms: tuple[float, float, float, float]
    """The coefficients, the constant first."""
    left: float
    """Largest distance of the polynomial from the curve, in the unit of the axis."""


@dataclass(frozen=True)
class BiasNoise:
    """The noise about the curve, with coefficients as in `Fit`."""

    n: float
    """White noise N, in the unit of the axis times √s."""
    b: float
    """Bias instability B, in the unit of the axis."""
    k: float
    """Random walk K, in the unit of the axis per √s."""


@dataclass(frozen=True, eq=False)
class BiasAxis:
    """The bias of an axis over temperature. Values are in `unit` unless another unit is stated."""

    name: str
    """Name of the axis."""
    sensor: str
    """Name of the sensor: its topic or log, and the kind."""
    kind: Literal["gyroscope", "accelerometer"]
    """The kind of axis."""
    unit: str
    """``°/s`` or ``m/s²``, whatever the unit of the log."""
    reference_c: float
    """Temperature at which the bias is stated, °C."""
    bias: float
    """Bias at `reference_c`; 0 for an accelerometer, whose bias cannot be told from gravity."""
    u_bias: float
    """Standard uncertainty of `bias`."""
    slope_per_c: float
    """Change of the bias per °C at `reference_c`."""
    u_slope_per_c: float
    """Standard uncertainty of `slope_per_c`."""
    curve: BiasCurve = field(repr=False)
    """The bias over temperature."""
    cubic: BiasCubic = field(repr=False)
    """The polynomial of order 3."""
    lag_s: float
    """Time constant with which the bias follows the thermometer, s; negative if the thermometer lags."""
    play_c: float
    """Half width of the backlash between bias and thermometer, °C."""
    u_if_on_before: float | None
    """Largest standard uncertainty of the bias in case the sensor was on before the log began and its bias lags. None
    if the probability of this case is at most 1 %."""
    hysteresis: float | None
    """Half of the difference between warming and cooling; None if the temperature only rose or only fell."""
    spread_of_starts: float | None
    """Standard deviation of the bias between starts of the sensor, one per log; None with one log."""
    before: float
    """Span of the means before the correction, largest minus smallest."""
    after: float
    """Span of the means after the correction. Each part of the record is corrected with the curve of the other parts
    (cross-validation)."""
    noise: BiasNoise = field(repr=False)
    """The noise about the curve."""
    means: BiasMeans = field(repr=False)
    """The means from which the curve comes."""
    warnings: list[str] = field(repr=False)
    """Warnings about the axis, each ``code: text``."""
    device_id: int | None = None
    """The number by which PX4 identifies the sensor; None unless a log of PX4 states it."""

    def __repr__(self) -> str:
        return f"<BiasAxis {_line(self)}>"


@dataclass(frozen=True, eq=False)
class Tempcal:
    """The result of `tempcal`: the bias over temperature of every axis, and the files made from it."""

    axes: dict[str, BiasAxis]
    """The axes by the names of their columns, sensor by sensor."""
    warnings: list[str] = field(repr=False)
    """Warnings about the logs and about each axis."""
    _calibration: tuple[Calibration | None, str | None] = field(repr=False)
    _px4: tuple[str | None, str | None] = field(repr=False)
    _ardupilot: tuple[str | None, str | None] = field(repr=False)

    def __repr__(self) -> str:
        axes = "".join(f"\n  {_line(axis)}" for axis in self.axes.values())
        return f"<Tempcal {len(self.warnings)} warnings:{axes}>"

    def _repr_html_(self) -> str:
        return _html.with_figure(self, self.plot)

    def __getitem__(self, name: str) -> BiasAxis:
        """The axis with this name."""
        return self.axes[name]

    @property
    def calibration(self) -> Calibration:
        """The calibration of the gyroscopes, which can correct rates and be saved.

        Raises
        ------
        ValueError
            If the logs have no gyroscope, or more axes than a calibration holds.
        """
        known, why_not = self._calibration
        if known is None:
            raise ValueError(why_not)
        return known

    def to_px4(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Makes the parameters of PX4: TC_Gn and TC_An of all sensors in the logs.

        Parameters
        ----------
        path
            The file to write. Without it, the text is only returned.
        force
            Overwrite an existing file.

        Raises
        ------
        ValueError
            If a sensor does not have three axes, has a number above 3, or has no device id, by which PX4 finds it.
            Logs of PX4 have the id.
        FileExistsError
            If the file exists, without ``force``.
        """
        return _written(self._px4, path, force)

    def to_ardupilot(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Makes the parameters of ArduPilot: INS_TCALn of all IMUs in the logs.

        Parameters
        ----------
        path
            The file to write. Without it, the text is only returned.
        force
            Overwrite an existing file.

        Raises
        ------
        ValueError
            If a sensor does not have three axes, or an IMU has a number above 2, counted from 0.
        FileExistsError
            If the file exists, without ``force``.
        """
        return _written(self._ardupilot, path, force)

    def plot(self) -> Figure:
        """Draws a new figure: for each axis the means and the curve with its 95 % band, a row for each sensor.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """
        return _plot.biases(list(self.axes.values()))


@checked
def tempcal(
    log: _Log | Sequence[_Log],
    /,
    *,
    temp_column: str | int | None = None,
    reference_c: float | None = None,
    max_u_dps: float | None = None,
    serial: str | None = None,
    column: Sequence[str | int] | None = None,
    columns: Sequence[str] | None = None,
    gyro: Sequence[str | int] | None = None,
    accel: Sequence[str | int] | None = None,
    rate_hz: float | None = None,
    topic: str | None = None,
    where: str | None = None,
    gyro_unit: str | None = None,
    accel_unit: str | None = None,
    force_unit: bool = False,
    gyro_scale: float | None = None,
    accel_scale: float | None = None,
    part: str | os.PathLike[str] | None = None,
    gyro_range: float | None = None,
    accel_range: float | None = None,
    increments: bool | None = None,
    time_column: str | int | None = None,
    time_unit: Literal["s", "ms", "us", "ns", "min", "h"] | None = None,
    decimal: Literal[".", ","] | None = None,
    raw: str | None = None,
    max_bad: float | None = None,
    skip: _log.CutTime | None = None,
    until: _log.CutTime | None = None,
) -> Tempcal:
    """The bias over temperature of all axes in logs of any IMU at rest.

    The sensor must lie still while it warms or cools by at least 5 °C, or better does both. The bias of an
    accelerometer cannot be told from gravity, so only its change over temperature is known. Other threads run
    meanwhile.

    Parameters
    ----------
    log
        A log or table with a temperature, in any form that `imu` takes. Of a flight controller's log, all IMUs are
        read. Or a list of logs of the same sensors, such as several starts, or a cold and a warm day, which are fitted
        together.
    temp_column
        The column with the temperature, °C, by name or by number counted from 0. Unless given, the only column whose
        unit or name states a temperature.
    reference_c
        The temperature at which the bias is stated, °C. Unless given, it is 25 °C, or if the logs do not reach 25 °C,
        the middle of the temperatures in whole degrees.
    max_u_dps
        The largest accepted standard uncertainty of a gyroscope's bias over the temperatures of the logs, °/s.
    serial
        The serial number that the calibration states.
    column, columns, gyro, accel, rate_hz, topic, gyro_unit, accel_unit, force_unit, gyro_scale, accel_scale
        See `imu`.
    part, gyro_range, accel_range, increments, time_column, time_unit
        See `imu`.
    decimal, raw, max_bad, where, skip, until
        See `read_log`.

    Returns
    -------
    Tempcal

    Raises
    ------
    Refused
        If the temperature spans too little, the sensor moves, no model explains the logs, or the bias is more
        uncertain than `max_u_dps`.
    ValueError
        If a log has no temperature, or does not state enough; the text says what to give.
    OSError
        If a log cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(0.0, 1800.0, 0.1)
    >>> temp_c = 25 - 20 * np.cos(2 * np.pi * t_s / 1800)
    >>> noise = np.random.default_rng(1).normal(scale=0.02, size=(len(t_s), 3))
    >>> gyro = 0.1 + 0.002 * (temp_c[:, np.newaxis] - 25) + noise
    >>> found = tempcal({"gyro": gyro, "temp_c": temp_c}, rate_hz=10.0, gyro_unit="°/s")
    >>> list(found.axes), round(found["gyro_x"].slope_per_c, 4)
    (['gyro_x', 'gyro_y', 'gyro_z'], 0.002)
    """
    logs = _listed(log)
    asked = _axes.AskedAxes.of(locals(), logs)
    sources = _numbered([asked.source(one, _ARRAY) for one in logs])
    found = _zerorate.tempcal(
        sources,
        asked.names,
        asked.gyro,
        asked.accel,
        asked.codes,
        None if temp_column is None else str(temp_column),
        _axes.number(reference_c),
        _axes.number(max_u_dps),
        serial,
        _with_time(sources, asked.options),
    )
    for text in found["warnings"]:
        python_warnings.warn(text, stacklevel=3)
    axes = _log.by_name((axis["name"], _axis(axis)) for axis in found["axes"])
    of_axes = [f"{name}: {text}" for name, axis in axes.items() for text in axis.warnings]
    core, why_not = found["calibration"]
    calibration = None if core is None else Calibration._of(core)
    return Tempcal(axes, found["warnings"] + of_axes, (calibration, why_not), found["px4"], found["ardupilot"])


_ARRAY = (
    "gyro=[0, 1, 2] and temp_column=3, or columns= such as ['gx', 'gy', 'gz', 'temp_c'], or a dictionary "
    "{'gyro': …, 'temp_c': …}"
)
"""Advice on how to say which columns of an array are axes."""


def _listed(log: Any) -> list[Any]:
    """Lists the logs. A list of numbers is one log, not several."""

    def is_log(one: Any) -> bool:
        return _records.is_path(one) or _records.is_table(one) or isinstance(one, _log.Log)

    if isinstance(log, (list, tuple)):
        if not log:
            raise ValueError("the list of logs is empty: give one or more")
        if all(is_log(one) for one in log):
            return list(log)
    return [log]


def _numbered(sources: list[_records.Source]) -> list[_records.Source]:
    """The sources, with a number in the name of each table if there are several."""
    if len(sources) == 1:
        return sources
    return [
        source if isinstance(source, str) else (f"{source[0]} {number}", source[1])
        for number, source in enumerate(sources, start=1)
    ]


def _with_time(sources: list[_records.Source], given: _zerorate._Options) -> _zerorate._Options:
    """The options with the column of times, which all tables must share."""
    of_each = [_log.with_time(source, given) for source in sources]
    if any(other != of_each[0] for other in of_each):
        raise ValueError("the tables have the time under several names: give time_column=, the name in all of them")
    return of_each[0]


def _axis(axis: dict[str, Any]) -> BiasAxis:
    tables = {
        "curve": BiasCurve(**axis["curve"]),
        "cubic": BiasCubic(**axis["cubic"]),
        "noise": BiasNoise(**axis["noise"]),
        "means": BiasMeans(**axis["means"]),
    }
    return BiasAxis(**{**axis, **tables})


def _written(made: tuple[str | None, str | None], path: str | os.PathLike[str] | None, force: bool) -> str:
    text, why_not = made
    if text is None:
        raise ValueError(why_not)
    if path is not None:
        _zerorate.save_text(path, text, force)
    return text


def _line(axis: BiasAxis) -> str:
    unit, low_c, high_c = axis.unit, axis.curve.temp_c[0], axis.curve.temp_c[-1]
    span = f"span {axis.before:.3g} {unit} before, {axis.after:.3g} {unit} after"
    return f"{axis.name}: {axis.slope_per_c:+.3g} {unit}/°C, {low_c:.1f} to {high_c:.1f} °C, {span}"
