"""Allan deviations."""

from __future__ import annotations

import os
import warnings as python_warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, overload

import numpy as np

from . import _filters, _frame, _log, _plot, _records, _zerorate
from ._capture import Capture
from ._model import Cleaned, Fit, fitted

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Picture
    from numpy.typing import ArrayLike, NDArray

Stat = Literal["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
"""The deviations. `oadev` is the one to use unless you know better."""

Taus = Union[str, Sequence[float], "NDArray[np.float64]"]
"""Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N``, or seconds."""


@dataclass(frozen=True)
class Unavailable:
    """An averaging time that was asked for and has no deviation."""

    tau_s: float
    """Averaging time, s."""
    reason: str
    """Why."""


@dataclass(frozen=True, eq=False)
class Allan:
    """A deviation over averaging time: arrays of equal length, one element per averaging time, ascending."""

    tau_s: NDArray[np.float64]
    """Averaging time, s."""
    dev: NDArray[np.float64]
    """Deviation: unit of the rate; TDEV that times s."""
    lo: NDArray[np.float64]
    """Lower confidence limit, same unit."""
    hi: NDArray[np.float64]
    """Upper confidence limit, same unit."""
    edf: NDArray[np.float64]
    """Equivalent degrees of freedom behind the limits."""
    alpha: NDArray[np.int64]
    """Exponent of the noise S_y(f) ∝ f^α identified there: 0 white, −1 flicker, −2 random walk of the rate, 1 and 2
    phase noise."""
    n: NDArray[np.int64]
    """Terms that entered."""
    m: NDArray[np.int64]
    """Samples in each average."""
    stat: str
    """The statistic."""
    rate_hz: float
    """Samples per second."""
    samples: int
    """Samples (phase: points) from the first to the last, the missing ones included."""
    missing: int
    """Samples that are missing."""
    confidence: float
    """Probability with which the limits enclose the true deviation."""
    unavailable: list[Unavailable] = field(repr=False)
    """Averaging times without a deviation, with the reason."""
    fit: Fit | None = field(repr=False)
    """The noise model; None where it was not asked for, or the record is too short."""
    no_fit: str | None = field(default=None, repr=False)
    """Why there is none."""
    model: NDArray[np.float64] | None = field(default=None, repr=False)
    """The model's deviations; None without a model, and for statistics that it does not speak of."""
    model_lo: NDArray[np.float64] | None = field(default=None, repr=False)
    """Lower end of the band in which the model expects 95 % of the deviations."""
    model_hi: NDArray[np.float64] | None = field(default=None, repr=False)
    """Upper end of that band."""
    cleaned: Cleaned | None = field(default=None, repr=False)
    """What was taken out before; None without a model."""
    name: str = "rate"
    """What was analysed: the name of the column or of the Series."""
    unit: str = "°/s"
    """Unit of the rate, and so of `dev` and of the coefficients."""
    warnings: list[str] = field(default_factory=list, repr=False)
    """What is to be said of the log; what there is to say of its noise is in `Fit.warnings`."""
    _core: _zerorate.Model | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        fit = self.fit
        known = [] if fit is None else [(name, getattr(fit, name)) for name in "nbk" if getattr(fit, name).identified]
        told = "".join(f", {name.upper()} = {of.value:.4g} {of.unit}" for name, of in known)
        told = ", model rejected" if fit is not None and fit.rejected else told
        span = f"{len(self.dev)} points of {self.stat} from {self.samples} samples at {self.rate_hz:.6g} Hz"
        return f"<Allan {self.name}: {span}{told}>"

    @property
    def kind(self) -> Literal["gyroscope", "accelerometer"] | None:
        """What `unit` is of."""
        return _zerorate.unit_kind(self.unit)

    def to_frame(self, library: _log.Library = "pandas") -> Any:
        """A DataFrame with a row for each averaging time, of pandas or polars.

        Raises
        ------
        ImportError
            If the library is not installed.
        """
        names = ["tau_s", "m", "dev", "lo", "hi", "edf", "alpha", "n"]
        names += ["model", "model_lo", "model_hi"] if self.model is not None else []
        return _frame.frame({name: getattr(self, name) for name in names}, library)

    def plot(self, ax: Picture | None = None) -> Picture:
        """Draws deviation with limits, model with its band, and coefficients into `ax`, or into a new figure.

        Needs matplotlib. Returns the axes, so that ``result.plot().figure.savefig("allan.png")`` writes a file.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """
        return _plot.curves([self], ax)

    def to_yaml(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        format: _filters.Format = "kalibr",
        inflate: float = 1.0,
        topic: str | None = None,
        force: bool = False,
    ) -> str:
        """The file for a filter, of this one axis. Arguments and result as of `Imu.to_yaml`."""
        return _filters.file([self], path, self.name, format, "worst", inflate, topic, force)


@dataclass(frozen=True, eq=False)
class AllanAxes(Mapping[str, Allan]):
    """The deviations of several columns, by their names, in their order."""

    axes: dict[str, Allan]
    """Each by itself."""

    def __repr__(self) -> str:
        return "".join(["<AllanAxes", *(f"\n  {axis!r}" for axis in self.axes.values()), ">"])

    def __getitem__(self, name: str | int) -> Allan:
        """By name, or by number counted from 0."""
        return list(self.axes.values())[name] if isinstance(name, int) else self.axes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.axes)

    def __len__(self) -> int:
        return len(self.axes)

    def to_frame(self, library: _log.Library = "pandas") -> Any:
        """A DataFrame with a row for each column and averaging time: `name`, `unit`, and the columns of
        `Allan.to_frame`; NaN for what there is no model of.

        Raises
        ------
        ImportError
            If the library is not installed.
        """
        return _frame.frame(_long(self.axes), library)

    def plot(self, ax: Picture | None = None) -> Picture:
        """Draws all into one picture, as `Allan.plot` does. They must have one unit.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        ValueError
            If their units differ.
        """
        return _plot.curves(list(self.axes.values()), ax)


_COLUMNS = ("tau_s", "m", "dev", "lo", "hi", "edf", "alpha", "n", "model", "model_lo", "model_hi")


def _long(axes: Mapping[str, Allan]) -> dict[str, Any]:
    def column(name: str) -> NDArray[Any]:
        parts = [getattr(axis, name) for axis in axes.values()]
        there = [np.full(len(axis.dev), np.nan) if part is None else part for axis, part in zip(axes.values(), parts)]
        return np.concatenate(there) if there else np.empty(0)

    rows = [(name, axis.unit) for name, axis in axes.items() for _ in axis.dev]
    return {
        "name": [name for name, _ in rows],
        "unit": [unit for _, unit in rows],
        **{name: column(name) for name in _COLUMNS},
    }


if TYPE_CHECKING:
    from typing_extensions import TypedDict, Unpack

    class _Options(TypedDict, total=False):
        rate_hz: float | None
        stat: Stat
        taus: Taus
        data: Literal["rate", "phase"]
        confidence: float
        scale: float | None
        unit: str | None
        fit: bool
        glitches: Literal["cut", "keep"]
        steps: Literal["remove", "keep"]
        time_column: str | int | None
        time_unit: Literal["s", "ms", "us", "ns"] | None
        decimal: Literal[".", ","] | None
        raw: Literal["i16", "i32", "f32", "f64"] | None
        max_bad: float | None
        topic: str | None

    Several = Union[Literal["all"], list[str], list[int], tuple[str, ...], tuple[int, ...]]


@overload
def allan(
    rate: Any, *, columns: Sequence[str], column: Several | None = ..., **options: Unpack[_Options]
) -> AllanAxes: ...
@overload
def allan(rate: Any, *, column: Several, **options: Unpack[_Options]) -> AllanAxes: ...
@overload
def allan(rate: Any, *, column: str | int, **options: Unpack[_Options]) -> Allan: ...
@overload
def allan(rate: Mapping[str, ArrayLike], **options: Unpack[_Options]) -> AllanAxes: ...
@overload
def allan(
    rate: Capture | str | os.PathLike[str] | Sequence[float] | NDArray[Any], **options: Unpack[_Options]
) -> Allan: ...
@overload
def allan(rate: Any, **options: Unpack[_Options]) -> Any: ...


def allan(
    rate: Any,
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
    fit: bool = True,
    glitches: Literal["cut", "keep"] = "cut",
    steps: Literal["remove", "keep"] = "remove",
    time_column: str | int | None = None,
    time_unit: Literal["s", "ms", "us", "ns"] | None = None,
    decimal: Literal[".", ","] | None = None,
    raw: Literal["i16", "i32", "f32", "f64"] | None = None,
    max_bad: float | None = None,
    topic: str | None = None,
) -> Allan | AllanAxes:
    """Allan deviation of a record at rest, with confidence limits and a noise model.

    Other threads run meanwhile.

    Parameters
    ----------
    rate
        The record. One value per sample: numpy array (a contiguous one of float64 or int32 is used in place), list,
        pandas or polars Series, xarray DataArray, or a `Capture`. Or several columns: a two-dimensional array with
        times along axis 0 and columns along axis 1, a DataFrame, a dictionary of arrays. Or a log: its path, or what
        `read_log` made of it. Integers are summed exactly; give their `scale`. What is NaN or masked is a missing
        sample and stays a gap.
    rate_hz
        Samples per second. A `Capture` knows it; else a DatetimeIndex, `time_column`, or the log tells it, as it tells
        where samples are missing.
    column
        Which column of a log, DataFrame or dictionary, or axis of a `Capture`: its name, or its number counted from 0.
        A list or ``"all"`` gives an `AllanAxes`, and so do several columns in memory without it. A log with one column
        needs none.
    columns
        Names for the columns of a two-dimensional array.
    stat
        ``adev``, ``oadev``, ``mdev``, ``tdev``, ``hdev``, ``ohdev``, ``totdev``.
    taus
        Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N`` for N of them, or seconds. What cannot be
        computed is in `Allan.unavailable`.
    data
        ``rate``, or ``phase`` if the values are the integral of the rate (for a gyroscope: the angle).
    confidence
        Probability with which `Allan.lo` and `Allan.hi` enclose the true deviation.
    scale
        What one step of the values is in `unit`; 1 unless given.
    unit
        Unit of the rate, which is that of the results too: ``rad/s``, ``m/s²``, ``g`` …; of arrays any other as well.
        Unless given, what the name of a column or the log states; of values without a name °/s.
    fit
        Whether to fit a noise model. Without one nothing is taken out of the record.
    glitches
        ``cut``: before the fit, samples that cannot be noise are replaced. ``keep`` them.
    steps
        ``remove``: before the fit, up to three jumps of the level are taken out. ``keep`` them.
    time_column, time_unit, decimal, raw, max_bad, topic
        As of `read_log`.

    Returns
    -------
    Allan or AllanAxes
        `Allan` of one column, `AllanAxes` of several. (To a type checker an array without `columns` is one.)

    Raises
    ------
    ValueError
        For arguments that nothing can be computed with; the text says what to do.
    Refused
        For a log whose numbers must not become a result.
    OSError
        For a log that cannot be read.

    Notes
    -----
    NIST SP 1065, equations 10, 11, 14, 15, 17, 18, 25; limits from χ² with the degrees of freedom of Greenhall and
    Riley (PTTI 2003). ``import zerorate; help(zerorate)`` lists what else there is.

    Examples
    --------
    >>> import numpy as np
    >>> white = np.random.default_rng(1).normal(size=100_000)
    >>> result = allan(white, rate_hz=100.0)
    >>> bool(0.098 < result.fit.n.value < 0.102)
    True
    """
    way = Way(stat, taus, _is_phase(data), confidence, _cleaning(glitches, steps) if fit else None)
    given = _log.options(rate_hz, time_column, time_unit, unit, scale, decimal, raw, max_bad, topic)
    if isinstance(rate, Capture):
        of_axes = _chosen({name: at for at, name in enumerate(rate.axes)}, column)

        def of_capture(name: str) -> Allan:
            codes, gaps = rate._codes(of_axes[name])
            step = rate._dps_per_code(of_axes[name]) if scale is None else scale
            return way.analysed(codes, rate.rate_hz if rate_hz is None else rate_hz, gaps, step, name, unit or "°/s")

        found = dict(zip(of_axes, side_by_side(of_capture, list(of_axes))))
        is_several = len(rate.axes) > 1 if column is None else _log.is_several(column)
        return AllanAxes(found) if is_several else found[next(iter(found))]
    if isinstance(rate, _log.Log) or _records.is_wide(rate):
        log = rate if isinstance(rate, _log.Log) else None
        chosen = _chosen(_records.array_columns(rate, columns) if log is None else log.columns, column)
        hz = log.rate_hz if log is not None and rate_hz is None else rate_hz

        def analysed(name: str) -> Allan:
            stated = "°/s" if log is None else log.units[name] or "unit"
            return way.analysed(_records.record(chosen[name], data), hz, [], scale, name, unit or stated)

        each = dict(zip(chosen, side_by_side(analysed, list(chosen))))
        return AllanAxes(each) if column is None or _log.is_several(column) else each[next(iter(each))]
    if columns is not None:
        raise ValueError("columns= names those of a two-dimensional array; choose others with column=")
    if _records.is_path(rate) or _records.is_table(rate):
        is_several = _log.is_several(column) or (column is None and not _records.is_path(rate))
        read = way.read(_records.table(rate), "all" if column is None and is_several else column, given)
        return AllanAxes(_log.by_name(read)) if is_several else read[0]["of"]
    name = getattr(rate, "name", None)
    name = name if isinstance(name, str) and name else "rate"
    unit = unit or _zerorate.column_unit(name) or "°/s"
    if _records.has_time_index(rate) and rate_hz is None:
        indexed = _records.indexed(rate, name)
        return way.read(indexed, name, {**given, "unit": unit})[0]["of"]  # type: ignore[no-any-return]
    if column is not None:
        raise ValueError(f"column={column!r}: the record is one column")
    values = _records.record(rate, data)
    return side_by_side(lambda of: way.analysed(of, rate_hz, [], scale, name, unit), [values])[0]


def _chosen(each: dict[str, Any], column: _log.Column | None) -> dict[str, Any]:
    """Those of several columns that are asked for, by name or by number."""
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


_Of = TypeVar("_Of")
_To = TypeVar("_To")


def side_by_side(work: Callable[[_Of], _To], all_of: Sequence[_Of]) -> list[_To]:
    """Work that leaves the interpreter to others, on as many threads as there are processors. Ctrl-C ends it after
    what has begun."""
    pool = ThreadPoolExecutor(max_workers=max(1, min(len(all_of), os.cpu_count() or 1)))
    try:
        return [begun.result() for begun in [pool.submit(work, one) for one in all_of]]
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True)
class Way:
    """How records are analysed."""

    stat: str
    taus: Taus
    is_phase: bool
    confidence: float
    cleaning: tuple[bool, bool] | None

    def read(
        self, source: _records.Source, column: _log.Column | None, given: _zerorate._Options
    ) -> list[dict[str, Any]]:
        """The columns of a log or table: the name of each, and what it is ``of``."""
        label = given["unit"]
        is_other = label is not None and not isinstance(source, str) and _zerorate.unit_kind(label) is None
        if is_other:
            # of a table in memory a unit of any other quantity is a name
            given = {**given, "unit": None, "scale": given["scale"] or 1.0}
        found = _log.columns_of(source, column, self.is_phase, given)
        if label is not None:
            scales = [given["scale"] or 1.0 if is_other else one["scale"] for one in found]
            found = [{**one, "unit": label, "scale": scale} for one, scale in zip(found, scales)]
        for text in (text for one in found for text in one["warnings"]):
            python_warnings.warn(text, stacklevel=3)
        return [{"name": axis.name, "of": axis} for axis in side_by_side(self.of_column, found)]

    def of_column(self, column: _zerorate._Column) -> Allan:
        """Of a column that was read."""
        return self.analysed(
            column["values"],
            column["rate_hz"],
            column["gaps"],
            column["scale"],
            column["name"],
            column["unit"] or "unit",
            column["warnings"],
        )

    def analysed(
        self,
        values: NDArray[Any],
        rate_hz: float | None,
        gaps: list[tuple[int, int]],
        scale: float | None,
        name: str,
        unit: str,
        said: list[str] | None = None,
    ) -> Allan:
        """Of a record as the extension takes it."""
        if rate_hz is None:
            raise ValueError("the record does not say how fast it was sampled: give rate_hz=, samples per second")
        taus = self.taus
        found = _zerorate.analyse(
            values,
            self.is_phase,
            gaps,
            float(rate_hz),
            self.stat,
            taus if isinstance(taus, str) else np.asarray(taus, dtype=np.float64).reshape(-1).tolist(),
            float(self.confidence),
            1.0 if scale is None else float(scale),
            self.cleaning,
        )
        model, cleaned, core = (found.pop(key, None) for key in ("fit", "cleaned", "core"))
        unavailable = [Unavailable(*point) for point in found.pop("unavailable")]
        return Allan(
            **found,
            unavailable=unavailable,
            confidence=self.confidence,
            fit=None if model is None else fitted(model, unit),
            cleaned=None if cleaned is None else Cleaned(*cleaned),
            name=name,
            unit=unit,
            warnings=said or [],
            _core=core,
        )


def _cleaning(glitches: str, steps: str) -> tuple[bool, bool]:
    if glitches not in ("cut", "keep"):
        raise ValueError(f"glitches={glitches!r}: give 'cut' or 'keep'")
    if steps not in ("remove", "keep"):
        raise ValueError(f"steps={steps!r}: give 'remove' or 'keep'")
    return glitches == "cut", steps == "remove"


def _is_phase(data: str) -> bool:
    if data not in ("rate", "phase"):
        raise ValueError(f"data={data!r}: give 'rate', or 'phase' for the integral of the rate")
    return data == "phase"
