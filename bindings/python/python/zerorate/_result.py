"""The results of `allan`: the deviation of one column over averaging time, or of several columns."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _filters, _frame, _html, _log, _plot, _zerorate
from ._model import Cleaned, Detrended, Fit

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Picture
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Unavailable:
    """A requested averaging time without a deviation."""

    tau_s: float
    """Averaging time, s."""
    reason: str
    """The reason why there is no deviation."""


@dataclass(frozen=True, eq=False)
class Allan:
    """A deviation over averaging time: arrays of equal length, one element per averaging time, ascending."""

    tau_s: NDArray[np.float64]
    """Averaging time, s."""
    dev: NDArray[np.float64]
    """Deviation, in the unit of the rate; for TDEV, in that unit times s."""
    lo: NDArray[np.float64]
    """Lower confidence limit of `dev`, in the same unit."""
    hi: NDArray[np.float64]
    """Upper confidence limit of `dev`, in the same unit."""
    edf: NDArray[np.float64]
    """Equivalent degrees of freedom behind the limits."""
    alpha: NDArray[np.int64]
    """Exponent of the identified noise S_y(f) ∝ f^α: 0 white, −1 flicker, −2 random walk of the rate, 1 and 2
    phase noise."""
    n: NDArray[np.int64]
    """Number of terms from which the deviation was computed."""
    m: NDArray[np.int64]
    """Number of samples in each average."""
    stat: str
    """The statistic, such as ``oadev``."""
    rate_hz: float
    """Samples per second."""
    samples: int
    """Number of samples (for phase: points) from the first to the last, including missing ones."""
    missing: int
    """Number of missing samples."""
    confidence: float
    """Probability with which the limits enclose the true deviation."""
    unavailable: list[Unavailable] = field(repr=False)
    """Requested averaging times without a deviation, each with the reason."""
    fit: Fit | None = field(repr=False)
    """The noise model; None if it was not requested or could not be fitted (`no_fit` has the reason)."""
    no_fit: str | None = field(default=None, repr=False)
    """The reason why the noise model could not be fitted; None if it was fitted or not requested."""
    model: NDArray[np.float64] | None = field(default=None, repr=False)
    """The model's deviations; None without a model, and for statistics that the model does not cover."""
    model_lo: NDArray[np.float64] | None = field(default=None, repr=False)
    """Lower end of the band in which the model expects 95 % of the deviations of this record."""
    model_hi: NDArray[np.float64] | None = field(default=None, repr=False)
    """Upper end of the band of `model_lo`."""
    predicted_lo: NDArray[np.float64] | None = field(default=None, repr=False)
    """Lower end of the band in which the model expects 95 % of the deviations of another record of this sensor, as
    long as this one. NaN above 1/128 of the record, and for statistics other than ``oadev``."""
    predicted_hi: NDArray[np.float64] | None = field(default=None, repr=False)
    """Upper end of the band of `predicted_lo`."""
    cleaned: Cleaned | None = field(default=None, repr=False)
    """The glitches and steps that were removed before the fit; None without a model."""
    detrended: Detrended | None = field(default=None, repr=False)
    """The polynomial over temperature that was subtracted; None without `detrend`."""
    skipped_s: float = field(default=0.0, repr=False)
    """Length of the beginning that was left out, s."""
    name: str = "rate"
    """The name of the column or Series."""
    unit: str = "°/s"
    """Unit of the rate, and so of `dev` and of the coefficients."""
    warnings: list[str] = field(default_factory=list, repr=False)
    """Warnings about the log and frozen samples, and without a fit the warning ``follows-temperature``. Other warnings
    about the noise are in `Fit.warnings`."""
    _core: _zerorate.Model | None = field(default=None, repr=False)
    _is_unit_assumed: bool = field(default=False, repr=False)

    def __repr__(self) -> str:
        fit = self.fit
        known = [] if fit is None else [(name, getattr(fit, name)) for name in "nbk" if getattr(fit, name).identified]
        told = "".join(f", {name.upper()} = {of.value:.4g} {of.unit}" for name, of in known)
        told = ", model rejected" if fit is not None and fit.rejected else told
        span = f"{len(self.dev)} points of {self.stat} from {self.samples} samples at {self.rate_hz:.6g} Hz"
        return f"<Allan {self.name}: {span}{told}>"

    def _repr_html_(self) -> str:
        return _html.with_figure(self, self.plot)

    @property
    def kind(self) -> Literal["gyroscope", "accelerometer"] | None:
        """The kind of sensor that has this unit, ``gyroscope`` or ``accelerometer``; None for any other unit."""
        return _zerorate.unit_kind(self.unit)

    def to_frame(self, library: _log.Library = "pandas") -> Any:
        """A DataFrame of pandas or polars with a row for each averaging time.

        Raises
        ------
        ImportError
            If the library is not installed.
        """
        names = [*_POINT, *(_MODEL if self.model is not None else ())]
        return _frame.frame({name: getattr(self, name) for name in names}, library)

    def plot(self, ax: Picture | None = None) -> Figure:
        """Draws deviation with limits, model with its band, and coefficients into `ax`, or into a new figure.

        Returns the figure, so that ``result.plot().savefig("allan.png")`` writes a file.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        ValueError
            If no deviation is above zero.
        """
        return _plot.curves([self], ax)

    def to_yaml(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        format: _filters.Format = "kalibr",
        horizon_s: float | None = None,
        as_fitted: bool = False,
        inflate: float = 1.0,
        topic: str | None = None,
        force: bool = False,
        accept_rejected: bool = False,
    ) -> str:
        """Makes the file for a filter from this axis. Arguments and result are as in `Imu.to_yaml`.

        Raises
        ------
        ValueError
            If nothing states the unit, because the assumed °/s could be wrong, or for an invalid argument.
        """
        said = self.warnings + (self.fit.warnings if self.fit else [])
        asked = (horizon_s, as_fitted, inflate, topic, force, accept_rejected)
        return _filters.file([self], path, self.name, format, "worst", *asked, said)


@dataclass(frozen=True, eq=False)
class AllanAxes(Mapping[str, Allan]):
    """The deviations of several columns, by name and in order."""

    axes: dict[str, Allan]
    """The deviation of each column."""

    def __repr__(self) -> str:
        return "".join(["<AllanAxes", *(f"\n  {axis!r}" for axis in self.axes.values()), ">"])

    def _repr_html_(self) -> str:
        return _html.with_figure(self, self.plot)

    def __getitem__(self, name: str | int) -> Allan:
        """The deviation of a column, by its name or its number counted from 0."""
        if isinstance(name, int):
            return list(self.axes.values())[name]
        if name not in self.axes:
            raise KeyError(f"no axis {name}; there are {', '.join(self.axes)}")
        return self.axes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.axes)

    def __len__(self) -> int:
        return len(self.axes)

    def to_frame(self, library: _log.Library = "pandas") -> Any:
        """A DataFrame with a row for each column and averaging time: `name`, `unit`, and the columns of
        `Allan.to_frame`; NaN where there is no model.

        Raises
        ------
        ImportError
            If the library is not installed.
        """
        return _frame.frame(_long(self.axes), library)

    def plot(self, ax: Picture | None = None) -> Figure:
        """Draws all columns in one picture, as `Allan.plot` does. They must have the same unit.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        ValueError
            If their units differ, or no deviation is above zero.
        """
        return _plot.curves(list(self.axes.values()), ax)


_POINT = ("tau_s", "m", "dev", "lo", "hi", "edf", "alpha", "n")
_MODEL = ("model", "model_lo", "model_hi", "predicted_lo", "predicted_hi")


def _long(axes: Mapping[str, Allan]) -> dict[str, Any]:
    def column(name: str) -> NDArray[Any]:
        parts = [getattr(axis, name) for axis in axes.values()]
        there = [np.full(len(axis.dev), np.nan) if part is None else part for axis, part in zip(axes.values(), parts)]
        return np.concatenate(there) if there else np.empty(0)

    rows = [(name, axis.unit) for name, axis in axes.items() for _ in axis.dev]
    return {
        "name": [name for name, _ in rows],
        "unit": [unit for _, unit in rows],
        **{name: column(name) for name in (*_POINT, *_MODEL)},
    }
