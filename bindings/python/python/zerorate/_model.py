"""Noise models."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Union

from . import _zerorate


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
class Detrended:
    """A polynomial over temperature that was taken out, by least squares over means of 128 parts of the record.

    `Fit.k` is stated with what it took of a random walk, and long averages have fewer degrees of freedom.
    """

    order: int
    """Its order."""
    coefficients: list[float]
    """Of T − `mean_c` and its powers: the unit of the rate per °C, °C², °C³."""
    mean_c: float
    """Mean temperature, °C."""
    explained: float
    """Share of the variance of the slow rate that it explains."""
    lost_dof: int
    """Degrees of freedom that it took, beside that of the mean."""
    walk_kept: float
    """Share of the variance of a random walk that is left."""


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


def fitted(found: _zerorate._Fit, unit: str) -> Fit:
    """What the extension found, with the units of its coefficients."""
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
