"""`imu`: deviations and noise models of all axes of an IMU."""

from __future__ import annotations

import os
import warnings as python_warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from . import _axes, _filters, _html, _log, _plot, _zerorate
from ._capture import Capture
from ._keywords import checked
from ._result import Allan, AllanAxes
from ._settling import Settling
from ._analysis import AnalysisOptions, Stat, Taus, side_by_side, warn_of_frozen

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Imu:
    """The result of `imu`: the deviation and the noise model of every axis."""

    axes: AllanAxes
    """The axes by the names of their columns, gyroscopes first: the deviations and the noise model of each."""
    rate_hz: float
    """Samples per second."""
    topic: str | None
    """The topic that was read; None if the log is not a bag."""
    log: str
    """The name of the log."""
    warnings: list[str] = field(repr=False)
    """Warnings about the log and about the noise of each axis."""

    def __repr__(self) -> str:
        return f"<Imu {self.log}, {len(self.warnings)} warnings: {self.axes!r}>"

    def _repr_html_(self) -> str:
        return _html.with_figure(self, self.plot)

    def __getitem__(self, name: str | int) -> Allan:
        """An axis by the name of its column, by its number counted from 0, or as ``gyro_x`` … ``accel_z``.

        The last is for a log with three axes of the kind, whatever their columns are called. They are x, y and z as
        their names say, otherwise in their order. A column of this name comes first.
        """
        if isinstance(name, str) and name not in self.axes:
            name = self._column_of_place(name)
        return self.axes[name]

    def _column_of_place(self, name: str) -> str:
        """The column of a place such as ``gyro_x``; `name` itself if it is none, or the kind has not three axes."""
        kind, _, letter = name.rpartition("_")
        of_kind = list({"gyro": self.gyroscope, "accel": self.accelerometer}.get(kind, ()))
        if len(of_kind) != 3 or letter not in ("x", "y", "z"):
            return name
        return _axes.in_order(of_kind)["xyz".index(letter)]

    @property
    def gyroscope(self) -> AllanAxes:
        """The axes of the gyroscope."""
        return AllanAxes({name: axis for name, axis in self.axes.items() if axis.kind == "gyroscope"})

    @property
    def accelerometer(self) -> AllanAxes:
        """The axes of the accelerometer."""
        return AllanAxes({name: axis for name, axis in self.axes.items() if axis.kind == "accelerometer"})

    def to_yaml(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        format: _filters.Format = "kalibr",
        combine: _filters.Combine = "worst",
        horizon_s: float | None = None,
        as_fitted: bool = False,
        inflate: float = 1.0,
        topic: str | None = None,
        force: bool = False,
        accept_rejected: bool = False,
    ) -> str:
        """Makes the file for a filter, as ``zerorate imu LOG -o FILE`` does. A comment explains each number.

        Parameters
        ----------
        path
            The file to write. Without it, the text is only returned.
        format
            The filter: ``kalibr``, ``openvins``, ``vins``, ``orbslam3``, ``kf-gins``, ``ros``. docs/imu.md explains
            the numbers of each file.
        combine
            The value for all axes of a kind, if the filter takes one number: the ``worst``, or their ``mean``.
        horizon_s
            The longest time over which the filter relies on its own uncertainty, s. N and K cover the noise from 1 s
            to this time, at most half of the record, with the least excess; for ``kalibr``, N is the fitted one, and K
            covers nine tenths of the variance. Unless given, a third of the record, at most 1000 s, and at most 100 s
            for ``kalibr``.
        as_fitted
            Give N and K as they were fitted.
        inflate
            Factor on all noise numbers, for effects that a record at rest does not show.
        topic
            The topic that the file names; unless given, the topic of the bag.
        force
            Overwrite an existing file.
        accept_rejected
            Make the file from rejected noise models too. The file then says so.

        Returns
        -------
        str
            The text of the file.

        Raises
        ------
        Refused
            If an axis has no noise model, or a rejected one without ``accept_rejected``.
        ValueError
            For an invalid argument, or a format that does not take this number of axes.
        FileExistsError
            If the file exists, without ``force``.
        """
        axes, topic = list(self.axes.values()), self.topic if topic is None else topic
        asked = (horizon_s, as_fitted, inflate, topic, force, accept_rejected)
        return _filters.file(axes, path, self.log, format, combine, *asked, self.warnings)

    def to_frame(self, library: _log.Library = "pandas") -> Any:
        """A DataFrame with a row for each axis and averaging time, like `AllanAxes.to_frame`."""
        return self.axes.to_frame(library)

    def plot(self) -> Figure:
        """Draws a new figure with a picture for each kind of axis.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        ValueError
            If no deviation of a kind is above zero.
        """
        return _plot.kinds([list(of.values()) for of in (self.gyroscope, self.accelerometer) if of])


@checked
def imu(
    log: str | os.PathLike[str] | Mapping[str, ArrayLike] | ArrayLike | Any,
    /,
    *,
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
    stat: Stat = "oadev",
    taus: Taus = "octave",
    confidence: float = 0.683,
    glitches: Literal["cut", "keep"] = "cut",
    steps: Literal["remove", "keep"] = "remove",
    max_freq_hz: float | None = None,
    temp_c: ArrayLike | str | None = None,
    detrend: Literal[1, 2, 3] | None = None,
) -> Imu:
    """Deviations and noise models of all axes of an IMU at rest, and the noise file for a filter.

    Gravity does not disturb the analysis, because the mean of a column does not matter. Other Python threads run
    meanwhile. An axis that never changes gives a UserWarning.

    Parameters
    ----------
    log
        The path of a log in any format that `read_log` reads: a ``sensor_msgs/Imu`` topic of a bag, or the
        columns whose names and units say what they are (``gyro_x``, ``wx``, ``ax [m/s^2]``). Or a DataFrame or a
        dictionary of such columns, in which a block of three columns is x, y and z:
        ``{"gyro": w, "accel": a}``. Or the result of `read_log` or `read_capture`, or an array with times along axis 0
        and axes along axis 1.
    column
        The axes, by name or by number counted from 0; otherwise all columns that are axes.
    columns
        Names for the axes of an array: ``["gx", "gy", "gz", "ax", "ay", "az"]``.
    gyro, accel
        The columns of each kind, by name or by number counted from 0, where their names do not say so: ``[0, 1, 2]``.
    rate_hz
        Samples per second. Otherwise it comes from a DatetimeIndex, `time_column`, or the log, which also tell where
        samples are missing.
    topic
        The topic or message to read, if the log has several IMUs.
    gyro_unit, accel_unit
        Unit of the columns, if their names do not state it, and of the results: ``rad/s``, ``°/s``, ``m/s²``,
        ``g``, ``mg`` …
    force_unit
        Use these units even if the names of columns state other ones, which is an error otherwise.
    gyro_scale, accel_scale
        The value of the number 1 in a column, in `gyro_unit` or `accel_unit`.
    part
        The sensor whose integer codes the columns hold, by a name of ``zerorate parts`` or by its file. It gives the
        scales of each kind without a unit, at the full scale after power-up or at `gyro_range` and `accel_range`.
    gyro_range, accel_range
        Full scale of integer codes of 16 bits, °/s and g: ``250`` means 250/32768 °/s for each, or the sensitivity of
        `part` there.
    increments
        True if the columns hold increments of the angle and of the velocity instead of rates. Unless given, names or
        gravity that indicate increments are an error.
    time_column, time_unit
        The column with the time of each row, and its unit; otherwise the only column whose name states a unit of time.
    decimal, raw, max_bad, where, skip, until
        See `read_log`.
    stat, taus, confidence, glitches, steps, max_freq_hz, temp_c, detrend
        See `allan`.

    Returns
    -------
    Imu

    Raises
    ------
    ValueError
        If there is no axis, or the log does not state enough; the text says what to give.
    Refused
        If the numbers of the log are not a valid result.
    OSError
        If the log cannot be read.

    Examples
    --------
    >>> import numpy as np
    >>> rest = np.random.default_rng(1).normal(size=(20_000, 3))
    >>> found = imu({"gyro": 1e-3 * rest}, rate_hz=100.0, gyro_unit="rad/s")
    >>> list(found.axes), found.axes["gyro_x"].fit.n.unit
    (['gyro_x', 'gyro_y', 'gyro_z'], 'rad/s·√s')
    >>> print(next(line for line in found.to_yaml().splitlines() if line[0] != "#").split()[0])
    gyroscope_noise_density:
    """
    arguments = locals()
    options = AnalysisOptions.of(stat, taus, "rate", confidence, True, glitches, steps, max_freq_hz)
    settling = Settling.of(temp_c, detrend, skip if isinstance(log, Capture) else None, False)
    options = replace(options, settling=settling)
    if isinstance(log, Capture):
        named = [name for name in (*_axes.OF_AXES, *_axes.OF_READING) if name not in ("rate_hz", "skip")]
        others = [name for name in named if arguments[name] is not None and arguments[name] is not False]
        if others:
            raise ValueError(f"{'=, '.join(others)}= is for logs and tables, not for a capture: leave it out")
        return _of_capture(log, options, log.rate_hz if rate_hz is None else rate_hz)
    asked = _axes.AskedAxes.of(arguments, [log])
    source = asked.source(log, _ARRAY)
    given = _log.with_time(source, asked.options)
    found, of_bag, said = _zerorate.read_imu(source, asked.names, asked.gyro, asked.accel, asked.codes, given)
    for text in said:
        python_warnings.warn(text, stacklevel=3)
    temperature = settling.of_source(source, given)
    given_units = {"gyroscope": gyro_unit, "accelerometer": accel_unit}
    for one in found:
        kind = _zerorate.unit_kind(one["unit"] or "")
        one["unit"] = (given_units[kind] if kind else None) or one["unit"]
    analysed = side_by_side(lambda one: options.of_column(one, temperature), found)
    warn_of_frozen(analysed, stacklevel=3)
    axes = _log.by_name((axis.name, axis) for axis in analysed)
    name = source if isinstance(source, str) else source[0]
    return Imu(AllanAxes(axes), found[0]["rate_hz"], of_bag, name, said + _said(axes))


_ARRAY = (
    "gyro=[0, 1, 2], accel=[3, 4, 5], or columns=, such as ['gx', 'gy', 'gz', 'ax', 'ay', 'az'], or a dictionary "
    "{'gyro': …, 'accel': …}"
)
"""Advice on how to say which columns of an array are axes."""


def _of_capture(capture: Capture, options: AnalysisOptions, rate_hz: float) -> Imu:
    """Analyses all axes of a capture, which are in °/s."""
    found = side_by_side(lambda at: options.capture(capture, at, rate_hz, None, "°/s"), range(len(capture.axes)))
    warn_of_frozen(found, stacklevel=4)
    axes = {axis.name: axis for axis in found}
    return Imu(AllanAxes(axes), rate_hz, None, "the capture", _said(axes))


def _said(axes: Mapping[str, Allan]) -> list[str]:
    of_axes = [(name, axis.warnings + (axis.fit.warnings if axis.fit else [])) for name, axis in axes.items()]
    skipped_s = max((axis.skipped_s for axis in axes.values()), default=0.0)
    moved = _zerorate.motion([(name, axis._core) for name, axis in axes.items() if axis._core is not None], skipped_s)
    return moved + [f"{name}: {text}" for name, texts in of_axes for text in texts]
