"""Converts records to the form that the extension takes."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _zerorate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Cells = Union[NDArray[np.int32], NDArray[np.float64], NDArray[np.int64], int]
    """Codes, numbers, times in ns, or the number of rows of anything else."""
    Source = Union[str, tuple[str, list[tuple[str, Cells]]]]
    """The path of a log, or a table: its name in messages, and its columns."""

TIME_INDEX = "index"
"""The column name for an index without a name."""

LARGEST_EXACT = 2**53
"""Up to here, float64 holds every integer."""

LETTERS = "xyz"
"""The names of the axes in a block of three columns."""


def is_path(data: Any) -> bool:
    return isinstance(data, (str, os.PathLike))


def is_table(data: Any) -> bool:
    """True if the data have named columns: a dictionary, a DataFrame, a structured array."""
    if isinstance(data, np.ndarray):
        return data.dtype.names is not None
    return isinstance(data, Mapping) or _is_lazy(data) or (hasattr(data, "columns") and hasattr(data, "__getitem__"))


def has_time_index(data: Any) -> bool:
    """True if the data is a pandas Series or DataFrame with the time in its index: instants, durations, or numbers
    under a name that states a unit of time."""
    index = getattr(data, "index", None)
    kind, name = getattr(getattr(index, "dtype", None), "kind", ""), getattr(index, "name", None)
    return kind in ("M", "m") or (kind in ("i", "u", "f") and isinstance(name, str) and _zerorate.is_time(name))


def is_array(data: Any) -> bool:
    """True if the data are numbers without column names."""
    return not is_path(data) and not is_table(data) and np.ndim(data) > 0


def is_wide(data: Any) -> bool:
    """True if the data is a two-dimensional array."""
    return is_array(data) and not isinstance(data, (list, tuple)) and np.ndim(data) == 2


def record(values: Any, data: str = "rate", what: str = "the record") -> NDArray[Any]:
    """One column as the extension takes it: contiguous int32 or float64, copied only if necessary."""
    array = _array(values)
    if array.ndim == 0:
        raise ValueError(f"{what} is one value of the type {type(values).__name__}: give an array, a table or a path")
    if array.ndim != 1:
        raise ValueError(f"{what} has the shape {array.shape}: give one column, for example record[:, 0]")
    if not array.size:
        raise ValueError(f"{what} is empty: give a value for each sample")
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{what} holds {array.dtype}, not real numbers: convert it to numbers first")
    if data == "rate" and array.dtype.kind in "iu" and _fits_int32(array):
        return np.ascontiguousarray(array, dtype=np.int32)
    numbers = np.ascontiguousarray(array, dtype=np.float64)
    infinite = np.isinf(numbers)
    if infinite.any():
        at = int(np.argmax(infinite))
        raise ValueError(f"{what} is infinite at sample {at}, which cannot be averaged: use NaN for a missing sample")
    return numbers


def check_exact(values: Any) -> None:
    """Refuses integers that float64 would round."""
    array = np.asarray(values.to_numpy() if hasattr(values, "to_numpy") else values)
    is_whole = array.dtype.kind in "iu" or (array.dtype.kind == "O" and all(isinstance(v, int) for v in array.flat))
    is_large = is_whole and array.size and max(-int(array.min()), int(array.max())) > LARGEST_EXACT
    if is_large and any(int(float(value)) != int(value) for value in array.flat):
        raise ValueError("the record has integers beyond 2^53, whose last digits are lost: subtract one of them first")


def table(data: Any, columns: Any = None) -> Source:
    """Converts a path or a table to a source: named columns, with the time in the index if there is one.

    `columns` names the columns of a two-dimensional array, whose rows are times.
    """
    if is_path(data):
        return os.fspath(data) if isinstance(os.fspath(data), str) else os.fsdecode(data)
    if not is_table(data):
        return "the array", list(array_columns(data, columns).items())
    if columns is not None:
        raise ValueError("columns= names the columns of an array, but these have names: choose with column=")
    if _is_lazy(data):
        data = data.collect()
    name = type(data).__name__
    named = [(str(key), data[key]) for key in _keys(data)]
    if not named:
        raise ValueError(f"the {name} has no columns")
    found = [pair for key, values in named for pair in _columns_of(key, values, f"the {name}")]
    if has_time_index(data):
        found.insert(0, _index(data))
    _check_names([key for key, _ in found], name)
    lengths = {key: cells if isinstance(cells, int) else len(cells) for key, cells in found}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise ValueError(f"the columns of the {name} differ in length ({told}): give the columns of one record")
    return f"the {name}", found


def indexed(series: Any, name: str) -> Source:
    """The source for a Series with the time in its index."""
    return "the Series", [_index(series), (name, record(series))]


def _index(data: Any) -> tuple[str, Cells]:
    index, name = data.index, str(data.index.name or TIME_INDEX)
    return name, _times(index) if index.dtype.kind in ("M", "m") else record(index, what=f"the index {name}")


def _is_lazy(data: Any) -> bool:
    return hasattr(data, "collect_schema") and hasattr(data, "lazy") and not hasattr(data, "to_numpy")


def _keys(data: Any) -> list[Any]:
    if isinstance(data, np.ndarray):
        return list(data.dtype.names or ())
    if hasattr(data, "column_names"):  # a table of pyarrow
        return list(data.column_names)
    return list(data) if isinstance(data, Mapping) else list(data.columns)


def _columns_of(key: str, values: Any, name: str) -> list[tuple[str, Cells]]:
    """A column, or a block of columns under one name. Three columns are x, y and z."""
    array = _array(values)
    what = f"column {key} of {name}"
    if array.ndim == 2:
        _check_shape(array, what)
        letters = LETTERS if array.shape[1] == len(LETTERS) else [str(at) for at in range(array.shape[1])]
        return [(f"{key}_{letter}", record(array[:, at], what=what)) for at, letter in enumerate(letters)]
    if array.ndim != 1:
        raise ValueError(f"{what} has the shape {array.shape}: give one value for each row")
    if array.dtype.kind in "Mm":
        return [(key, _times(values))]
    if array.dtype.kind not in "iuf":
        return [(key, len(array))]
    return [(key, record(array, what=what))]


def array_columns(data: Any, columns: Any) -> dict[str, Cells]:
    """The columns of an array, under the given names or their numbers."""
    array = _array(data)
    if array.ndim == 0:
        return {"": record(data)}
    if array.ndim == 1:
        array = array.reshape(-1, 1)
    _check_shape(array, "the array")
    names = [str(at) for at in range(array.shape[1])] if columns is None else [str(name) for name in columns]
    if len(names) != array.shape[1]:
        raise ValueError(f"columns= has {len(names)} names for an array of {array.shape[1]} columns")
    _check_names(names, "array")
    return {name: record(array[:, at], what=f"column {name}") for at, name in enumerate(names)}


def _check_shape(array: NDArray[Any], what: str) -> None:
    """Checks that rows are times. An array that may be transposed is refused."""
    if array.ndim != 2:
        raise ValueError(f"{what} has the shape {array.shape}: give times along axis 0 and axes along axis 1")
    rows, columns = array.shape
    if rows == 0:
        raise ValueError(f"{what} has no rows")
    if columns == 0 or rows <= columns:
        raise ValueError(
            f"{what} has {rows} rows and {columns} columns, but rows are times: if these are {rows} channels, "
            "give its transpose, array.T"
        )


def _check_names(names: list[str], what: str) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"the {what} has several columns {', '.join(twice)}: rename them")


def _array(values: Any) -> NDArray[Any]:
    """The values as a numpy array, with NaN for masked or missing ones."""
    if isinstance(values, np.ma.MaskedArray):
        return _unmasked(values)
    array = np.asarray(values.to_numpy() if hasattr(values, "to_numpy") else values)
    if array.dtype.kind == "O" and array.size:  # pandas' missing values, mixed lists
        try:
            return _floats(values, array)
        except (TypeError, ValueError):
            pass
    return array


def _floats(values: Any, array: NDArray[Any]) -> NDArray[Any]:
    if hasattr(getattr(values, "dt", None), "tz_convert"):  # instants with a time zone
        return np.asarray(values.dt.tz_convert(None).to_numpy())
    try:
        return array.astype(np.float64)
    except TypeError:
        if not hasattr(values, "to_numpy"):
            raise
        return np.asarray(values.to_numpy(dtype=np.float64, na_value=np.nan))


def _unmasked(values: Any) -> NDArray[Any]:
    if values.dtype.kind not in "iuf" or not np.ma.is_masked(values):
        return np.asarray(values.data)
    return np.asarray(values.astype(np.float64).filled(np.nan))


def _times(values: Any) -> NDArray[np.int64]:
    """Instants or durations in ns."""
    if getattr(values, "tz", None) is not None:
        values = values.tz_convert(None)
    array = _array(values)
    if np.isnat(array).any():
        raise ValueError(f"row {int(np.argmax(np.isnat(array)))} has no time: every row must have one")
    unit = "datetime64[ns]" if array.dtype.kind == "M" else "timedelta64[ns]"
    return np.ascontiguousarray(array.astype(unit)).view(np.int64)


def _fits_int32(array: NDArray[Any]) -> bool:
    limits = np.iinfo(np.int32)
    if array.dtype.itemsize < 4 or array.dtype == np.int32:
        return True
    return bool(array.min() >= limits.min and array.max() <= limits.max)
