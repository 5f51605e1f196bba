"""`allan`: deviations of records in any form."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, Union, overload

from . import _log, _records, _zerorate
from ._capture import Capture
from ._keywords import checked
from ._result import Allan, AllanAxes
from ._settling import Seconds, Settling
from ._analysis import LONG, AnalysisOptions, Stat, Taus, side_by_side, warn_of_frozen

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import TypedDict, Unpack

    class _Options(TypedDict, total=False):
        rate_hz: float | None
        stat: Stat
        taus: Taus
        data: Literal["rate", "phase"]
        confidence: float
        scale: float | None
        unit: str | None
        force_unit: bool
        fit: bool
        glitches: Literal["cut", "keep"]
        steps: Literal["remove", "keep"]
        max_freq_hz: float | None
        temp_c: ArrayLike | str | None
        detrend: Literal[1, 2, 3] | None
        skip: _log.CutTime | None
        until: _log.CutTime | None
        time_column: str | int | None
        time_unit: Literal["s", "ms", "us", "ns", "min", "h"] | None
        increments: bool | None
        decimal: Literal[".", ","] | None
        raw: str | None
        max_bad: float | None
        topic: str | None
        where: str | None

    Several = Union[Literal["all"], list[str], list[int], tuple[str, ...], tuple[int, ...]]

ASSUMED_UNIT = "°/s"
"""The unit of an array or Series if nothing states it."""


@overload
def allan(
    rate: Any, /, *, columns: Sequence[str], column: Several | None = ..., **options: Unpack[_Options]
) -> AllanAxes: ...
@overload
def allan(rate: Any, /, *, column: Several, **options: Unpack[_Options]) -> AllanAxes: ...
@overload
def allan(rate: Any, /, *, column: str | int, **options: Unpack[_Options]) -> Allan: ...
@overload
def allan(rate: Mapping[str, ArrayLike], /, **options: Unpack[_Options]) -> AllanAxes: ...
@overload
def allan(
    rate: Capture | str | os.PathLike[str] | Sequence[float] | NDArray[Any], /, **options: Unpack[_Options]
) -> Allan: ...
@overload
def allan(rate: Any, /, **options: Unpack[_Options]) -> Any: ...


@checked
def allan(
    rate: Any,
    /,
    *,
    rate_hz: float | None = None,
    column: _log.Column | None = None,
    columns: Sequence[str] | None = None,
    stat: Stat = "oadev",
    taus: Taus = "octave",
    data: Literal["rate", "phase"] = "rate",
    confidence: float = 0.683,
    scale: float | None = None,
    unit: str | None = None,
    force_unit: bool = False,
    fit: bool = True,
    glitches: Literal["cut", "keep"] = "cut",
    steps: Literal["remove", "keep"] = "remove",
    max_freq_hz: float | None = None,
    temp_c: ArrayLike | str | None = None,
    detrend: Literal[1, 2, 3] | None = None,
    skip: _log.CutTime | None = None,
    until: _log.CutTime | None = None,
    time_column: str | int | None = None,
    time_unit: Literal["s", "ms", "us", "ns", "min", "h"] | None = None,
    increments: bool | None = None,
    decimal: Literal[".", ","] | None = None,
    raw: str | None = None,
    max_bad: float | None = None,
    topic: str | None = None,
    where: str | None = None,
) -> Allan | AllanAxes:
    """Allan deviation of a record at rest, with confidence limits and a noise model.

    The GIL is released, so that other Python threads run meanwhile. A record that never changes gives a UserWarning.

    Parameters
    ----------
    rate
        The record. One value per sample: numpy array (a contiguous one of float64 or int32 is used in place), list,
        pandas or polars Series, xarray DataArray, or a `Capture`. Or several columns: a two-dimensional array with
        times along axis 0 and columns along axis 1, a DataFrame, a dictionary of arrays. Or a log: its path, or the
        result of `read_log`. Integers are summed exactly; give their `scale`. NaN and masked values are missing
        samples and stay gaps.
    rate_hz
        Samples per second. A `Capture` knows it. Otherwise it comes from a DatetimeIndex, `time_column`, or the log,
        which also tell where samples are missing.
    column
        Column of a log, DataFrame or dictionary, or axis of a `Capture`: its name, or its number counted from 0.
        A list or ``"all"`` gives an `AllanAxes`, and so do several columns in memory without `column`. A log with one
        column needs none.
    columns
        Names for the columns of a two-dimensional array. Without `rate_hz`, the column whose name states a unit of
        time (``t_s``) is the time.
    stat
        ``adev``, ``oadev``, ``mdev``, ``tdev``, ``hdev``, ``ohdev``, ``totdev``.
    taus
        Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N`` for N of them, or seconds. Times that
        cannot be computed are in `Allan.unavailable`.
    data
        ``rate``, or ``phase`` if the values are the integral of the rate (for a gyroscope: the angle).
    confidence
        Probability with which `Allan.lo` and `Allan.hi` enclose the true deviation.
    scale
        The value of the number 1 in the record, in `unit`. Unless given, that of the `Capture` or log, or 1.
    unit
        Unit of the rate and of the results: ``rad/s``, ``m/s²``, ``g`` …; for values in memory, any other text too.
        Unless given, as the column's name or the log states; else °/s for an array or Series, ``unit`` for others.
    fit
        Fit a noise model. If false, neither glitches nor steps are removed from the record.
    glitches
        ``cut``: samples that cannot be noise are replaced before the fit. ``keep``: they stay.
    steps
        ``remove``: up to three jumps of the level are removed before the fit. ``keep``: they stay.
    max_freq_hz
        The frequency up to which the noise model holds, Hz. Unless given, the data choose it: `Fit.f_max_hz`.
    temp_c
        The temperature of each sample, °C, NaN where it was not read; for a log or table, the name of its column.
        Unless given, it is the temperature of a `Capture`, or the column ``temp_code``, ``temp_c``, ``temp`` or
        ``temperature`` of a log or table. A rate that follows the temperature is not noise: see
        ``follows-temperature`` in `Fit.warnings`.
    detrend
        Subtract a polynomial of this order, 1 to 3, over the temperature before anything else; `Allan.detrended` holds
        the polynomial. The intervals of long averages and of K allow for the noise that it may have removed.
    skip
        Length of the beginning to leave out while the sensor warms: seconds, or a duration such as ``"45m"``; for a
        log also a clock time, see `read_log`.
    until
        The time after which a log or table is left out: see `read_log`.
    force_unit, time_column, time_unit, increments, decimal, raw, max_bad, topic, where
        See `read_log`.

    Returns
    -------
    Allan or AllanAxes
        `Allan` for one column, `AllanAxes` for several. For type checkers, an array without `columns` is one column.

    Raises
    ------
    ValueError
        For arguments with which nothing can be computed; the text says what to do.
    Refused
        For a log whose numbers must not become a result.
    OSError
        For a log that cannot be read.

    Notes
    -----
    Deviations by NIST SP 1065, equations 10, 11, 14, 15, 17, 18, 25. Limits from χ² with the degrees of freedom of
    Greenhall and Riley (PTTI 2003). ``import zerorate; help(zerorate)`` lists the other functions.

    Examples
    --------
    >>> import numpy as np
    >>> white = np.random.default_rng(1).normal(size=100_000)
    >>> result = allan(white, rate_hz=100.0)
    >>> bool(0.098 < result.fit.n.value < 0.102)
    True
    """
    options = AnalysisOptions.of(stat, taus, data, confidence, fit, glitches, steps, max_freq_hz)
    is_read = isinstance(rate, (Capture, _log.Log)) or not (_records.is_path(rate) or _records.is_table(rate))
    if increments and is_read:
        raise ValueError("increments= is for the path of a log and for tables: give these values times their rate")
    if not isinstance(rate, (Capture, _log.Log)) and _records.is_array(rate):
        _records.check_exact(rate)
    is_timed = time_column is not None or (columns is not None and rate_hz is None)
    is_file_or_table = _records.is_path(rate) or _records.is_table(rate) or (_records.is_wide(rate) and is_timed)
    is_indexed = _records.has_time_index(rate) and rate_hz is None
    is_cut_on_reading = not isinstance(rate, (Capture, _log.Log)) and (is_file_or_table or is_indexed)
    if until is not None and not is_cut_on_reading:
        raise ValueError("until= is for the path of a log and for tables: leave the end out of these values")
    settling = Settling.of(temp_c, detrend, None if is_cut_on_reading else skip, options.is_phase)
    options = replace(options, settling=settling)
    if isinstance(rate, Capture):
        axes = _chosen({name: at for at, name in enumerate(rate.axes)}, column)
        found = side_by_side(lambda at: options.capture(rate, at, rate_hz, scale, unit or "°/s"), list(axes.values()))
        return _answer(found, len(rate.axes) > 1 if column is None else _log.is_several(column))
    if isinstance(rate, _log.Log) or (_records.is_wide(rate) and not is_timed):
        return _answer(*_of_arrays(options, rate, column, columns, rate_hz, scale, unit))
    if columns is not None and not _records.is_wide(rate):
        raise ValueError("columns= names the columns of a two-dimensional array; choose other columns with column=")
    given = _log.options(locals())
    if _records.is_path(rate) or _records.is_table(rate) or _records.is_wide(rate):
        is_several = _log.is_several(column) or (column is None and not _records.is_path(rate))
        wanted = _log.ALL if column is None and is_several else column
        return _answer(options.read(_records.table(rate, columns), wanted, given), is_several)
    if column is not None or time_column is not None:
        raise ValueError("the record is one column: leave out column= and time_column=, which choose among several")
    name = getattr(rate, "name", None)
    name = name if isinstance(name, str) and name else "rate"
    stated = unit or _zerorate.column_unit(name)
    unit = stated or ASSUMED_UNIT
    if _records.has_time_index(rate) and rate_hz is None:
        found = options.read(_records.indexed(rate, name), name, {**given, "unit": unit})
        return _answer([_guessed(found[0], stated)])
    values, said = options.checked(name, _records.record(rate, data), stacklevel=3)
    temperature = options.settling.of_array(len(values)) if options.settling else None

    def analysed(values: NDArray[Any]) -> Allan:
        return options.analysed(values, rate_hz, [], scale, name, unit, said, temperature)

    found = [analysed(values)] if len(values) < LONG else side_by_side(analysed, [values])
    return _answer([_guessed(found[0], stated)])


def _of_arrays(
    options: AnalysisOptions,
    data: Any,
    column: _log.Column | None,
    columns: Sequence[str] | None,
    rate_hz: float | None,
    scale: float | None,
    unit: str | None,
) -> tuple[list[Allan], bool]:
    """Analyses the columns of an array, or of a log that was read. True if the answer has an axis for each."""
    log = data if isinstance(data, _log.Log) else None
    each = _records.array_columns(data, columns) if log is None else log.columns
    chosen = _chosen(each, column)
    hz = log.rate_hz if log is not None and rate_hz is None else rate_hz
    temperature = None
    if options.settling and not options.is_phase and hz is not None:
        source = ("the array" if log is None else "the log", list(each.items()))
        temperature = options.settling.of_source(source, _log.options({"rate_hz": hz}))

    def read(name: str) -> tuple[NDArray[Any], list[str]]:
        values = _records.record(chosen[name], "phase" if options.is_phase else "rate")
        return options.checked(name, values, stacklevel=5) if log is None else (values, [])

    records = {name: read(name) for name in chosen}

    def analysed(name: str) -> Allan:
        stated = unit or (_zerorate.column_unit(name) if log is None else log.units[name] or "unit")
        values, said = records[name]
        found = options.analysed(values, hz, [], scale, name, stated or ASSUMED_UNIT, said, temperature)
        return _guessed(found, stated)

    return side_by_side(analysed, list(chosen)), column is None or _log.is_several(column)


def _guessed(found: Allan, stated: str | None) -> Allan:
    return found if stated else replace(found, _is_unit_assumed=True)


def _answer(found: Sequence[Allan], is_several: bool = False) -> Allan | AllanAxes:
    warn_of_frozen(found, stacklevel=4)
    return AllanAxes(_log.by_name((axis.name, axis) for axis in found)) if is_several else found[0]


def _chosen(each: dict[str, Any], column: _log.Column | None) -> dict[str, Any]:
    if column is None or _log.is_all(column):
        return each
    names = list(each)

    def name_of(wanted: str | int) -> str:
        at = int(wanted) if str(wanted).isdecimal() and str(wanted) not in each else -1
        name = names[at] if 0 <= at < len(names) else str(wanted)
        if name not in each:
            raise ValueError(f"there is no column {wanted!r}; choose with column= one of {', '.join(names)}")
        return name

    return {name: each[name] for name in map(name_of, _log.listed(column))}
