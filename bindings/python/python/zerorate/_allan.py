"""Allan deviations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np

from . import _zerorate
from ._capture import Capture

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Stat = Literal["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
"""The deviations. `oadev` is the one to use unless you know better."""

Taus = Union[str, Sequence[float], "NDArray[np.float64]"]
"""Averaging times: ``octave``, ``decade``, ``all``, ``log:N``, or seconds."""


@dataclass(frozen=True)
class Coefficient:
    """A noise coefficient with its 95 % interval."""

    value: float
    """Best value; never NaN, but see `identified`."""
    lo: float
    """Lower end of the 95 % interval."""
    hi: float
    """Upper end of the 95 % interval."""
    unit: str
    """Unit of these three."""
    identified: bool
    """Whether the record shows this noise at all: zero is outside of the interval."""
    needed_s: float | None
    """How long a record would have to be to identify it, s; None where it is identified."""


@dataclass(frozen=True)
class Fit:
    """Noise coefficients: σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2 (IEEE Std 952-1997 C.1).

    Fitted to the overlapping Allan deviation at octaves, whatever statistic was asked for, by least squares with the
    covariance that the fitted noise gives the estimates.
    """

    n: Coefficient
    """Angle random walk N; for a rate in °/s times 60 in °/√h. The white noise has the one-sided density √2·N, in
    unit/√Hz."""
    b: Coefficient
    """Bias instability B; for a rate in °/s times 3600 in °/h. The floor of the curve is 0.664 B."""
    k: Coefficient
    """Rate random walk K."""
    q: Coefficient | None
    """Angle quantisation Q, only where significant."""
    r: Coefficient | None
    """Rate ramp R, only where significant."""
    warnings: list[str] = field(default_factory=list)
    """``code: text`` each: what was seen, why it matters, what to do."""

    def dev(self, tau_s: ArrayLike) -> NDArray[np.float64]:
        """The Allan deviation of the fitted noise at the averaging times `tau_s`, in the unit of B."""
        tau = np.asarray(tau_s, dtype=np.float64)
        n, b, k = self.n.value, self.b.value, self.k.value
        q = 0.0 if self.q is None else self.q.value
        r = 0.0 if self.r is None else self.r.value
        flicker = 2 * np.log(2) / np.pi * b**2
        variance = 3 * q**2 / tau**2 + n**2 / tau + flicker + k**2 * tau / 3 + r**2 * tau**2 / 2
        return np.asarray(np.sqrt(variance))


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
    """Noise coefficients; None where the record is too short for any."""
    no_fit: str | None = field(default=None, repr=False)
    """Why there are none."""


def allan(
    rate: ArrayLike | Capture,
    *,
    rate_hz: float | None = None,
    stat: Stat = "oadev",
    taus: Taus = "octave",
    data: Literal["rate", "phase"] = "rate",
    confidence: float = 0.683,
    scale: float | None = None,
    unit: str = "°/s",
) -> Allan:
    """Allan deviation of a record at rest, with confidence limits and noise coefficients.

    Other threads run meanwhile.

    Parameters
    ----------
    rate
        The record, one value per sample: numpy array (a contiguous one of float64 or int32 is used in place), list,
        pandas or polars Series, xarray DataArray, or a `Capture`. Integers are summed exactly; give their `scale`. NaN
        is a missing sample and stays a gap.
    rate_hz
        Samples per second. A `Capture` knows it.
    stat
        ``adev``, ``oadev``, ``mdev``, ``tdev``, ``hdev``, ``ohdev``, ``totdev``.
    taus
        Averaging times: ``octave``, ``decade``, ``all``, ``log:N`` for N of them, or seconds. What cannot be computed
        is in `Allan.unavailable`.
    data
        ``rate``, or ``phase`` if the values are the integral of the rate (for a gyroscope: the angle).
    confidence
        Probability with which `Allan.lo` and `Allan.hi` enclose the true deviation.
    scale
        What one step of the values is in `unit`; 1 unless given.
    unit
        Unit of the rate, for the units of the coefficients.

    Returns
    -------
    Allan

    Raises
    ------
    ValueError
        For arguments that nothing can be computed with; the text says what to do.

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
    gaps: list[tuple[int, int]] = []
    record: Any = rate
    if isinstance(rate, Capture):
        record, gaps = rate._codes()
        scale = rate._dps_per_code if scale is None else scale
        rate_hz = rate.rate_hz if rate_hz is None else rate_hz
    if rate_hz is None:
        raise ValueError("the record does not say how fast it was sampled: give rate_hz=, samples per second")
    found = _zerorate.analyse(
        _record(record, data),
        _is_phase(data),
        gaps,
        float(rate_hz),
        stat,
        taus if isinstance(taus, str) else np.asarray(taus, dtype=np.float64).reshape(-1).tolist(),
        float(confidence),
        1.0 if scale is None else float(scale),
    )
    fit = found.pop("fit", None)
    unavailable = [Unavailable(*point) for point in found.pop("unavailable")]
    return Allan(
        **found, confidence=confidence, unavailable=unavailable, fit=None if fit is None else _fit(fit, unit)
    )


def _is_phase(data: str) -> bool:
    if data not in ("rate", "phase"):
        raise ValueError(f"data={data!r}: give 'rate', or 'phase' for the integral of the rate")
    return data == "phase"


def _record(values: Any, data: str) -> NDArray[Any]:
    """The values as the extension takes them: contiguous int32 or float64, without a copy where they are that."""
    array = np.asarray(values.to_numpy() if hasattr(values, "to_numpy") else values)
    if array.ndim != 1:
        shape = array.shape
        raise ValueError(f"the record has the shape {shape}: give one column or channel, for example record[:, 0]")
    if array.dtype.kind not in "iuf" and array.size:
        array = _numbers(array)
    if data == "rate" and array.dtype.kind in "iu" and _fits_int32(array):
        return np.ascontiguousarray(array, dtype=np.int32)
    return np.ascontiguousarray(array, dtype=np.float64)


def _numbers(array: NDArray[Any]) -> NDArray[np.float64]:
    if array.dtype.kind == "O":  # pandas' missing values, mixed lists
        try:
            return array.astype(np.float64)
        except (TypeError, ValueError):
            pass
    raise ValueError(f"the record holds {array.dtype}, not real numbers: convert it to numbers first")


def _fits_int32(array: NDArray[Any]) -> bool:
    limits = np.iinfo(np.int32)
    if array.dtype.itemsize < 4 or array.dtype == np.int32 or not array.size:
        return True
    return bool(array.min() >= limits.min and array.max() <= limits.max)


def _fit(found: _zerorate._Fit, unit: str) -> Fit:
    units = {"n": f"{unit}·√s", "b": unit, "k": f"{unit}/√s", "q": f"{unit}·s", "r": f"{unit}/s"}
    values: dict[str, Any] = dict(found)
    coefficients = {
        name: None if values[name] is None else Coefficient(**values[name], unit=units[name]) for name in units
    }
    return Fit(**coefficients, warnings=values["warnings"])  # type: ignore[arg-type]
