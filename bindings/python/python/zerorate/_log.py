"""Reads logs of any form as columns."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union

import numpy as np

from . import _frame, _records, _zerorate
from ._keywords import checked

if TYPE_CHECKING:
    from numpy.typing import NDArray

Column = Union[str, int, Sequence[Union[str, int]]]
"""A column by its name or its number counted from 0, several of them, or ``"all"``."""

CutTime = Union[float, str]
"""A time in a log: seconds since its first sample, a duration as in ``"45m"``, or a clock time or date."""

_T = TypeVar("_T")

ALL = "all"
"""The value of `column` for all columns that hold numbers."""

Library = Literal["pandas", "polars"]
"""The library of a DataFrame."""


@dataclass(frozen=True, eq=False)
class Log(Mapping[str, "NDArray[np.float64]"]):
    """Columns of a log, by their names: a number for each sample, NaN where one is missing."""

    columns: dict[str, NDArray[np.float64]]
    """The numbers of each column, in its unit in `units`."""
    units: dict[str, str | None]
    """The unit of each column; None if nothing states it."""
    rate_hz: float
    """Sample rate, Hz, with missing samples counted."""
    warnings: list[str] = field(repr=False)
    """Warnings about the log."""

    def __repr__(self) -> str:
        columns = ", ".join(f"{name} ({self.units[name] or 'no unit'})" for name in self)
        return f"<Log of {self._samples} samples at {self.rate_hz:.6g} Hz: {columns}>"

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def t_s(self) -> NDArray[np.float64]:
        """Time of each sample since the first, on an even clock, s."""
        return np.arange(self._samples) / self.rate_hz

    @property
    def _samples(self) -> int:
        return max(map(len, self.columns.values()), default=0)

    def _stating_units(self) -> dict[str, NDArray[np.float64]]:
        """The columns under names that state their units."""
        units = {name: self.units[name] for name in self if _zerorate.column_unit(name) is None}
        names = {name: f"{name} [{unit}]" for name, unit in units.items() if unit and _zerorate.unit_kind(unit)}
        return {names.get(name, name): column for name, column in self.items()}

    def to_frame(self, library: Library = "pandas") -> Any:
        """A DataFrame of pandas or polars with `t_s` and the columns.

        Raises
        ------
        ImportError
            If the library is not installed.
        """
        return _frame.frame({"t_s": self.t_s, **self.columns}, library)


@checked
def read_log(
    log: str | os.PathLike[str],
    /,
    column: Column | None = ALL,
    *,
    rate_hz: float | None = None,
    time_column: str | int | None = None,
    time_unit: Literal["s", "ms", "us", "ns", "min", "h"] | None = None,
    unit: str | None = None,
    force_unit: bool = False,
    scale: float | None = None,
    increments: bool | None = None,
    decimal: Literal[".", ","] | None = None,
    raw: str | None = None,
    max_bad: float | None = None,
    topic: str | None = None,
    where: str | None = None,
    skip: CutTime | None = None,
    until: CutTime | None = None,
) -> Log:
    """Reads columns of a log, in every format that ``zerorate allan`` reads, in one pass.

    Formats: captures, CSV and text of any dialect, Parquet, Arrow, NumPy, MATLAB, HDF5, bags of ROS 1 and 2 (files and
    folders), PX4 ULog, ArduPilot DataFlash; compressed or not. docs/logs.md describes each format.

    Parameters
    ----------
    log
        The file, or the folder of a bag.
    column
        A name, a number counted from 0, a list of these, or ``"all"``. None means the only column.
    rate_hz
        Samples per second; otherwise it comes from the time column or the stamps.
    time_column, time_unit
        The column with the time of each row, and its unit: ``s``, ``ms``, ``us``, ``ns``, ``min``, ``h``; otherwise
        as its name states.
    unit
        Unit of the columns: ``°/s``, ``rad/s``, ``m/s²``, ``g`` …; otherwise as each column states.
    force_unit
        Use `unit` even if the name of a column states another one, which is an error otherwise.
    scale
        The value of the number 1 in a column, in `unit`.
    increments
        True if the columns hold increments of the angle and of the velocity instead of rates. `unit` is then the unit
        of an increment per second, ``rad/s`` for rad.
    decimal
        The decimal mark of a text: ``.`` or ``,``.
    raw
        The file has only numbers of this type, little endian: ``i16``, ``i32``, ``f32``, ``f64``; or big endian,
        ``i16be``; or in records of several, ``6xi16be``, whose columns are 0 to 5.
    max_bad
        Largest share of broken lines of a text that are skipped; 0.01 unless given.
    topic
        The topic or message to read, if the log has several IMUs.
    where
        Read only the rows in which a column has this value, as in ``"SensorId=1"``, or several columns have theirs,
        as in ``"bus=0,sensor=1"``: for a table or text with the rows of several sensors. The value ``*`` stands for
        all, as in ``"idx=*"``: the rows are of one sensor.
    skip, until
        Leave out everything before, or after, this time: seconds since the first sample, a duration such as ``"45m"``,
        or a clock time or date of the log's timestamps, as in ``"12:30:00"`` (UTC if they state no time zone).

    Returns
    -------
    Log

    Raises
    ------
    ValueError
        If the log does not state enough, or has no such column; the text says what to give.
    Refused
        If the numbers of the log are not a valid result.
    OSError
        If the log cannot be read.
    """
    given = options(locals())
    found = columns_of(_records.table(log), column, True, given)
    # the last warning of a column without a unit is about the missing unit, which `Log.units` shows as well
    said = [text for one in found for text in one["warnings"][: None if one["unit"] else -1]]
    for text in said:
        warnings.warn(text, stacklevel=3)
    return Log(
        columns=by_name((one["name"], np.asarray(one["values"] * one["scale"], dtype=np.float64)) for one in found),
        units={one["name"]: one["unit"] for one in found},
        rate_hz=found[0]["rate_hz"],
        warnings=said,
    )


def options(arguments: Mapping[str, Any]) -> _zerorate._Options:
    """The options of a log among the arguments of a function, in the form that the extension takes."""

    def given(name: str, form: Callable[[Any], Any] = lambda value: value) -> Any:
        value = arguments.get(name)
        return None if value is None else form(value)

    return {
        "rate_hz": given("rate_hz", float),
        "time_column": given("time_column", str),
        "time_unit": given("time_unit"),
        "unit": given("unit"),
        "force_unit": arguments.get("force_unit", False),
        "scale": given("scale", float),
        "increments": given("increments"),
        "decimal": given("decimal"),
        "raw": given("raw"),
        "max_bad": given("max_bad", float),
        "topic": given("topic"),
        "where": given("where"),
        "skip": given("skip", str),
        "until": given("until", str),
    }


def with_time(source: _records.Source, given: _zerorate._Options) -> _zerorate._Options:
    """Adds the time column to the options, if a table has one column of times and no time column or rate is given."""
    if isinstance(source, str) or given["rate_hz"] is not None or given["time_column"] is not None:
        return given
    times = [name for name, cells in source[1] if not isinstance(cells, int) and cells.dtype == np.int64]
    if len(times) > 1:
        raise ValueError(f"{source[0]} has the time in several columns, {', '.join(times)}: give time_column=")
    return {**given, "time_column": times[0]} if times else given


def columns_of(
    source: _records.Source, column: Column | None, points: bool, given: _zerorate._Options
) -> list[_zerorate._Column]:
    names = None if column is None or is_all(column) else [str(name) for name in listed(column)]
    given = with_time(source, given)
    return _zerorate.read_columns(source, names, column is not None and is_all(column), points, given)


def is_all(column: Column) -> bool:
    return isinstance(column, str) and column == ALL


def is_several(column: Column | None) -> bool:
    """True if `column` is a list or ``"all"``, so that the result has its columns by name, even a single one."""
    return column is not None and (is_all(column) or not isinstance(column, (str, int, np.integer)))


def listed(column: Column) -> list[str | int]:
    return [column] if isinstance(column, (str, int, np.integer)) else list(column)


def by_name(found: Iterable[tuple[str, _T]]) -> dict[str, _T]:
    """A dictionary by name. Raises ValueError if two items have the same name."""
    named: dict[str, _T] = {}
    for name, one in found:
        if name in named:
            raise ValueError(f"two columns have the name {name}: read one by its number, or rename them")
        named[name] = one
    return named
