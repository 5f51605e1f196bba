"""The noise model of a record: its coefficients, its other terms, and what was removed before the fit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Union

from . import _zerorate


@dataclass(frozen=True)
class Coefficient:
    """A noise coefficient with its 95 % interval."""

    value: float
    """The most likely value, never NaN. It has a meaning only if `identified` is true."""
    lo: float
    """Lower end of the 95 % interval."""
    hi: float
    """Upper end of the 95 % interval."""
    unit: str
    """Unit of `value`, `lo` and `hi`."""
    identified: bool
    """True if zero is outside the interval, the model is accepted and no other explanation fits as well."""
    needed_s: float | None
    """Length of a record that would identify the coefficient, s; infinite if none would. None if it is identified, if
    the model is rejected or ambiguous, and for R."""


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
    """Correlated noise: a Gauss–Markov process of first order."""

    sigma: Estimate
    """Standard deviation, in the unit of the rate."""
    tau_s: Estimate
    """Correlation time, s."""


@dataclass(frozen=True)
class BandShape:
    """The effect of a filter on all noise but quantisation, or on the white noise alone. The density is multiplied by
    exp Σ a_j (cos jθ − 1), with sin(θ/2) = sin(πf/rate)/sin(πf_max/rate) and f_max = `Fit.f_max_hz`. A pole p
    multiplies it by (1 − p)²/(1 + p² − 2p cos θ), and a corner f_c with the damping c by 1/(1 + cx + x²), where
    x = (sin(πf/rate)/sin(πf_c/rate))²."""

    cosines: list[float]
    """The coefficients a_1, a_2 …"""
    pole: float | None
    """p, the pole of a first-order low-pass; None without one."""
    corner: tuple[float, float] | None
    """f_c in Hz and c of a second-order low-pass: c is 0 for a Butterworth filter and 2 for two equal poles."""
    of_white: bool
    """True if the filter shapes the white noise alone, and the slow noise is not filtered."""


@dataclass(frozen=True)
class Line:
    """A disturbance or resonance. The coefficients do not include it."""

    frequency_hz: float
    """Frequency at which the line is seen, Hz: its own frequency, or the one to which it is aliased."""
    width_hz: float
    """Width of the spectral line, Hz."""
    rms: float
    """Root mean square, in the unit of the rate."""


@dataclass(frozen=True)
class WarmUp:
    """A decay of the level from the start of the record: ``size · exp(−t/tau_s)``."""

    size: Estimate
    """Size, in the unit of the rate."""
    tau_s: float
    """Time constant, s, chosen from a few fixed values."""


Term = Union[GaussMarkov, BandShape, Line, WarmUp]
"""A term of the model other than N, B, K, Q and R."""


@dataclass(frozen=True)
class Cleaned:
    """The samples and steps that were removed from the record before the fit. The deviations do not include them."""

    glitches: int
    """Number of glitches (one or more adjacent samples) that were replaced by the line between their neighbours."""
    steps: list[tuple[float, float]]
    """Jumps of the level: time, s, and size, in the unit of the rate."""


@dataclass(frozen=True)
class Detrended:
    """A polynomial over temperature that was subtracted: least squares over means of up to 128 parts of the record.

    `Fit.k` allows for the random walk that the polynomial removed, and long averages have fewer degrees of freedom.
    """

    order: int
    """Order of the polynomial, 1 to 3."""
    coefficients: list[float]
    """Coefficients of T − `mean_c` and its powers: the unit of the rate per °C, °C², °C³."""
    mean_c: float
    """Mean temperature, °C."""
    explained: float
    """Share of the variance of the slow rate that the polynomial explains."""
    lost_dof: int
    """Degrees of freedom that the polynomial takes besides the mean."""
    walk_kept: float
    """Share of the variance of a random walk that is left after the subtraction."""


@dataclass(frozen=True)
class Fit:
    """A noise model, fitted by the likelihood of the record's cosine spectrum.

    The Allan variance of its coefficients is 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2 (IEEE Std 952-1997 C.1).
    `Allan.model` includes all terms.
    """

    n: Coefficient
    """Angle random walk N; for a rate in °/s, N times 60 is in °/√h. The white noise has the one-sided density √2·N,
    in unit/√Hz."""
    b: Coefficient
    """Bias instability B; for a rate in °/s, B times 3600 is in °/h. The floor of the curve is 0.664 B."""
    k: Coefficient
    """Rate random walk K."""
    q: Coefficient | None
    """Angle quantisation Q; None if not significant."""
    r: Coefficient | None
    """Rate ramp R; None if not significant."""
    model_error: float
    """Relative error of the model, from the scatter of the spectrum about it: 0.016 is 1.6 %."""
    motion_ratio: float | None
    """The standard deviation of loud windows of ten seconds over that of quiet ones; None if no motion was found."""
    p_value: float
    """Probability of more scatter than was measured, if the model is right within `model_error`."""
    f_max_hz: float
    """The frequency up to which the model holds, Hz. Above it, the sensor's filter shapes the noise, and `Allan.model`
    uses the measured spectrum."""
    rejected: bool
    """True if the model is off by more than 10 % or the sensor moves. No coefficient is identified then."""
    terms: list[Term] = field(default_factory=list)
    """The other terms that are significant: Gauss–Markov noise, the sensor's filter, spectral lines, warm-up."""
    warnings: list[str] = field(default_factory=list)
    """Warnings, each ``code: text``: what was seen and what to do."""

    def __repr__(self) -> str:
        named = [(name, getattr(self, name.lower())) for name in "NBKQR"]
        told = [f"{name} = {of.value:.4g} {of.unit}" for name, of in named if of is not None and of.identified]
        told += [type(term).__name__ for term in self.terms]
        return f"<Fit {'REJECTED: ' if self.rejected else ''}{', '.join(told)}; {len(self.warnings)} warnings>"


def fitted(found: _zerorate._Fit, warnings: list[str], unit: str) -> Fit:
    """Converts the fit of the extension, and adds the units of its coefficients."""
    units = {"n": f"{unit}·√s", "b": unit, "k": f"{unit}/√s", "q": f"{unit}·s", "r": f"{unit}/s"}
    coefficients: dict[str, Any] = {name: _coefficient(found.get(name), units[name]) for name in units}
    names = ("model_error", "motion_ratio", "p_value", "f_max_hz", "rejected")
    others: dict[str, Any] = {name: found.get(name) for name in names}
    return Fit(**coefficients, **others, terms=[_term(**term) for term in found["terms"]], warnings=warnings)


def _coefficient(found: Any, unit: str) -> Coefficient | None:
    if found is None:
        return None
    of = {name: found[name] for name in ("value", "lo", "hi", "identified", "needed_s")}
    return Coefficient(unit=unit, **of)


def cleaned(found: dict[str, Any]) -> Cleaned:
    return Cleaned(found["glitches"], [(step["at_s"], step["size"]) for step in found["steps"]])


def detrended(found: dict[str, Any]) -> Detrended:
    return Detrended(**{name: found[name] for name in Detrended.__dataclass_fields__})


def _term(kind: str, **values: Any) -> Term:
    if kind == "gauss-markov":
        return GaussMarkov(Estimate(**values["sigma"]), Estimate(**values["tau_s"]))
    if kind == "warm-up":
        return WarmUp(Estimate(**values["size"]), values["tau_s"])
    if kind == "line":
        return Line(**values)
    corner = values.pop("corner")
    return BandShape(**values, corner=corner and (corner["frequency_hz"], corner["damping"]))
