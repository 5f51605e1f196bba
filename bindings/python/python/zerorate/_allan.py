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
"""Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N``, or seconds."""


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
class Estimate:
    """A parameter with its 95 % interval."""

    value: float
    """The most likely value."""
    lo: float
    """Lower end of the 95 % interval."""
    hi: float
    """Upper end of the 95 % interval."""


@dataclass(frozen=True)
class GaussMarkov:
    """Noise with a memory: a Gauss–Markov process of first order."""

    sigma: Estimate
    """Its standard deviation, in the unit of the rate."""
    tau_s: Estimate
    """Its correlation time, s."""


@dataclass(frozen=True)
class BandShape:
    """White noise behind a filter: its density is N² exp Σ a_j (cos 2πjf/rate − 1), and with a pole p that times
    (1 − p)²/(1 + p² − 2p cos 2πf/rate)."""

    cosines: list[float]
    """a_1, a_2 …"""
    pole: float | None
    """p, of a low-pass of the first order."""


@dataclass(frozen=True)
class Line:
    """A disturbance or resonance; it was left out of the coefficients."""

    frequency_hz: float
    """Where it is, or where it folds to."""
    width_hz: float
    """How broad it is."""
    rms: float
    """Root mean square, in the unit of the rate."""


@dataclass(frozen=True)
class WarmUp:
    """The level goes as ``size · exp(−t/tau_s)`` from the start."""

    size: Estimate
    """In the unit of the rate."""
    tau_s: float
    """Time constant, one of a few that are tried, s."""


Term = Union[GaussMarkov, BandShape, Line, WarmUp]
"""What a record has beside N, B, K, Q and R."""


@dataclass(frozen=True)
class Cleaned:
    """What was taken out of the record before the fit, and so out of the deviations."""

    glitches: int
    """Glitches whose samples were replaced by the line between their neighbours."""
    steps: list[tuple[float, float]]
    """Jumps of the level: when, s, and by how much, in the unit of the rate."""


@dataclass(frozen=True)
class Fit:
    """A noise model, from the likelihood of the record's cosine spectrum.

    The Allan variance of its coefficients is 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2 (IEEE Std 952-1997 C.1);
    `Allan.model` has that of all terms.
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
    model_error: float
    """The spectrum scatters about the model as if this were off by so much: 0.016 is 1.6 %."""
    p_value: float
    """Probability of more scatter than there is, `model_error` included."""
    rejected: bool
    """The model is off by more than 10 %: nothing is identified."""
    terms: list[Term] = field(default_factory=list)
    """Gauss–Markov terms, the sensor's band, lines, warm-up, where significant."""
    warnings: list[str] = field(default_factory=list)
    """``code: text`` each: what was seen, why it matters, what to do."""


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
    fit: bool = True,
    glitches: Literal["cut", "keep"] = "cut",
    steps: Literal["remove", "keep"] = "remove",
) -> Allan:
    """Allan deviation of a record at rest, with confidence limits and a noise model.

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
        Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N`` for N of them, or seconds. What cannot be computed
        is in `Allan.unavailable`.
    data
        ``rate``, or ``phase`` if the values are the integral of the rate (for a gyroscope: the angle).
    confidence
        Probability with which `Allan.lo` and `Allan.hi` enclose the true deviation.
    scale
        What one step of the values is in `unit`; 1 unless given.
    unit
        Unit of the rate, for the units of the coefficients.
    fit
        Whether to fit a noise model. Without one nothing is taken out of the record.
    glitches
        ``cut``: before the fit, samples that cannot be noise are replaced. ``keep`` them.
    steps
        ``remove``: before the fit, up to three jumps of the level are taken out. ``keep`` them.

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
        _cleaning(glitches, steps) if fit else None,
    )
    model = found.pop("fit", None)
    cleaned = found.pop("cleaned", None)
    unavailable = [Unavailable(*point) for point in found.pop("unavailable")]
    return Allan(
        **found,
        confidence=confidence,
        unavailable=unavailable,
        fit=None if model is None else _fit(model, unit),
        cleaned=None if cleaned is None else Cleaned(*cleaned),
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
    others = {name: values[name] for name in ("model_error", "p_value", "rejected", "warnings")}
    return Fit(**coefficients, **others, terms=[_term(**term) for term in values["terms"]])  # type: ignore[arg-type]


def _term(kind: str, **values: Any) -> Term:
    if kind == "gauss-markov":
        return GaussMarkov(Estimate(*values["sigma"]), Estimate(*values["tau_s"]))
    if kind == "warm-up":
        return WarmUp(Estimate(*values["size"]), values["tau_s"])
    return BandShape(**values) if kind == "band-shape" else Line(**values)
